//! Opens an address in the browser of whoever sits at the machine.

use std::io;
use std::process::{Command, Stdio};
use std::thread;

/// Whether there is a screen that a browser could show a page on.
pub fn has_display() -> bool {
    let set = |name: &str| std::env::var_os(name).is_some_and(|value| !value.is_empty());
    cfg!(any(windows, target_os = "macos")) || set("DISPLAY") || set("WAYLAND_DISPLAY")
}

/// Opens the address by the program that the system has for this.
///
/// # Errors
/// The system's, where there is no such program.
pub fn open(address: &str) -> io::Result<()> {
    let mut command = if cfg!(windows) {
        let mut command = Command::new("rundll32");
        command.arg("url.dll,FileProtocolHandler");
        command
    } else if cfg!(target_os = "macos") {
        Command::new("open")
    } else {
        Command::new("xdg-open")
    };
    let quiet = command
        .arg(address)
        .stdin(Stdio::null())
        .stdout(Stdio::null())
        .stderr(Stdio::null());
    let mut opened = quiet.spawn()?;
    // Some of these programs stay as long as the browser does.
    thread::spawn(move || opened.wait());
    Ok(())
}
