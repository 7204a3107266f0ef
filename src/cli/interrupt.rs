//! Ctrl-C: a run that is watched ends after its current step and keeps its rows; one that is not ends at once.

use std::sync::atomic::{AtomicBool, Ordering};

static WATCHED: AtomicBool = AtomicBool::new(false);
static ASKED: AtomicBool = AtomicBool::new(false);

/// From now on somebody asks [`asked`] after every step. A second Ctrl-C ends the process in any case.
pub fn watch() {
    WATCHED.store(true, Ordering::Relaxed);
    let handler = || {
        if !WATCHED.load(Ordering::Relaxed) || ASKED.swap(true, Ordering::Relaxed) {
            std::process::exit(i32::from(super::INTERRUPTED));
        }
    };
    // Without a handler Ctrl-C just ends the process: rows already written stay, so this is no reason not to run.
    let _ = ctrlc::set_handler(handler);
}

/// Nobody asks any more.
pub fn unwatch() {
    WATCHED.store(false, Ordering::Relaxed);
}

/// Whether Ctrl-C was pressed.
pub fn asked() -> bool {
    ASKED.load(Ordering::Relaxed)
}

/// What is set then, for those who ask it themselves.
pub fn flag() -> &'static AtomicBool {
    &ASKED
}
