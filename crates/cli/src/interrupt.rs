//! Ctrl-C: a run that is watched ends after its current step and keeps its rows; one that is not, or whose step takes long, ends at
//! once, as what is in files is complete to its last row.

use super::say;
use std::sync::atomic::{AtomicBool, Ordering};
use std::sync::{Mutex, PoisonError};
use std::time::{Duration, Instant};
use twinslip_output::remove_temporary;

static WATCHED: AtomicBool = AtomicBool::new(false);
static ASKED: AtomicBool = AtomicBool::new(false);
/// Whether the run knows that Ctrl-C was pressed.
static HEARD: AtomicBool = AtomicBool::new(false);
/// Whether something would be lost if the process ended in the midst of a step.
static HOLDS: AtomicBool = AtomicBool::new(false);
/// What stays.
static KEPT: Mutex<String> = Mutex::new(String::new());

/// So long a step may take on.
const PATIENCE: Duration = Duration::from_millis(300);

/// From now on Ctrl-C comes here.
pub fn listen() {
    let handler = || {
        if !WATCHED.load(Ordering::Relaxed) || ASKED.swap(true, Ordering::Relaxed) {
            leave();
        }
        let begun = Instant::now();
        while begun.elapsed() < PATIENCE {
            std::thread::sleep(Duration::from_millis(10));
            if HEARD.load(Ordering::Relaxed) {
                return;
            }
        }
        if HOLDS.load(Ordering::Relaxed) {
            say(
                "interrupted; results so far are written when the current step is done; Ctrl-C again quits without them",
            );
        } else {
            leave();
        }
    };
    // Without a handler Ctrl-C just ends the process: rows already written stay, so this is no reason not to run.
    let _ = ctrlc::set_handler(handler);
}

fn leave() -> ! {
    remove_temporary();
    say(words());
    std::process::exit(i32::from(super::INTERRUPTED))
}

/// From now on somebody asks [`asked`] after every step. A second Ctrl-C ends the process in any case.
pub fn watch() {
    WATCHED.store(true, Ordering::Relaxed);
}

/// Nobody asks any more.
pub fn unwatch() {
    HEARD.store(true, Ordering::Relaxed);
    WATCHED.store(false, Ordering::Relaxed);
}

/// Whether Ctrl-C was pressed.
pub fn asked() -> bool {
    let asked = ASKED.load(Ordering::Relaxed);
    if asked {
        HEARD.store(true, Ordering::Relaxed);
    }
    asked
}

/// What is set then, for those who ask it themselves.
pub fn flag() -> &'static AtomicBool {
    &ASKED
}

/// What was found is in memory alone: a step is waited for.
pub fn holds() {
    HOLDS.store(true, Ordering::Relaxed);
}

/// What stays of a run that is interrupted, in words.
pub fn keeps(what: impl Into<String>) {
    *KEPT.lock().unwrap_or_else(PoisonError::into_inner) = what.into();
}

/// What is said of an interruption.
pub fn words() -> String {
    let kept = KEPT.lock().unwrap_or_else(PoisonError::into_inner);
    match kept.as_str() {
        "" => "interrupted".into(),
        kept => format!("interrupted; {kept}"),
    }
}
