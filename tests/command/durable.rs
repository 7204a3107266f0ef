//! Runs that are begun, watched and ended, and the bytes that they leave.

use super::twinslip;
use std::fs;
use std::path::{Path, PathBuf};
use std::process::{Child, Stdio};
use std::time::{Duration, Instant};

// Quick runs.
pub const SWEEP: &str = "sweep -q --driving 0.14:0.5:6 --stiffness 0.3:0.5:4";
pub const BRANCH: &str = "branch equilibria -q --stiffness 0.14";
pub const LOCUS: &str = "locus hopf -q --step-limit 0.5";
pub const RUN: &str = "integrate -q --driving 10 --stiffness 0.14 --until 40 --rtol 1e-10";

pub fn begin(arguments: &str) -> Child {
    super::program()
        .args(arguments.split_whitespace())
        .stdout(Stdio::null())
        .stderr(Stdio::piped())
        .spawn()
        .expect("the program starts")
}

/// Waits until a file has so many bytes.
pub fn grown(path: &Path, bytes: u64) {
    let begun = Instant::now();
    while fs::metadata(path).map_or(0, |data| data.len()) < bytes {
        assert!(begun.elapsed() < Duration::from_secs(120), "no row came");
        std::thread::sleep(Duration::from_millis(2));
    }
}

pub fn done(arguments: &str) {
    let ended = twinslip(arguments);
    assert_eq!((ended.code, ended.err.as_str()), (0, ""), "{arguments}");
}

/// The bytes of a file, without the command, which names the file.
pub fn read(path: &Path) -> String {
    let text = fs::read_to_string(path).expect("written");
    let lines = text.split_inclusive('\n');
    lines
        .filter(|line| !line.starts_with("# command:"))
        .collect()
}

pub fn special(path: &Path) -> PathBuf {
    path.with_extension("special.csv")
}
