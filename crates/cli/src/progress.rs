//! A bar on standard error for runs that take long, if somebody looks at it.

use super::call::Outlet;
use super::report::Report;
use indicatif::{ProgressBar, ProgressStyle};
use std::io::IsTerminal;
use std::sync::mpsc::{self, Receiver, RecvTimeoutError, Sender};
use std::sync::{Arc, Mutex, PoisonError};
use std::thread::{self, JoinHandle};
use std::time::{Duration, Instant};

/// Runs shorter than this show nothing.
const PATIENCE: Duration = Duration::from_millis(800);
/// Steps between two looks at the clock.
const STEPS: u32 = 64;
/// Ticks of the bar.
const TICKS: u64 = 1000;

/// Shows how far a run has come.
pub struct Progress {
    begun: Instant,
    wanted: bool,
    calls: u32,
    bar: Option<ProgressBar>,
    spinner: Option<Spinner>,
    outlet: Option<Arc<dyn Outlet>>,
}

impl Progress {
    /// Silent if asked to be, or if standard error is no terminal.
    pub fn new(quiet: bool) -> Self {
        Progress {
            begun: Instant::now(),
            wanted: !quiet && std::io::stderr().is_terminal(),
            calls: 0,
            bar: None,
            spinner: None,
            outlet: None,
        }
    }

    /// Shows nothing, and tells somebody else.
    pub fn handed_on(outlet: Arc<dyn Outlet>) -> Self {
        Progress {
            wanted: false,
            outlet: Some(outlet),
            ..Progress::new(true)
        }
    }

    /// The run has come so far.
    pub fn reached(&mut self, fraction: f64) {
        self.calls += 1;
        if self.calls.is_multiple_of(STEPS) {
            self.come(fraction);
        }
    }

    /// The same for calls that stand for much work each.
    pub fn come(&mut self, fraction: f64) {
        if let Some(outlet) = &self.outlet {
            outlet.reached(fraction);
        }
        if !self.wanted || self.begun.elapsed() < PATIENCE {
            return;
        }
        let bar = self.bar.get_or_insert_with(|| {
            let style =
                ProgressStyle::with_template("{bar:40} {percent:>3} %  {elapsed}, {eta} to go")
                    .expect("the template is valid");
            ProgressBar::new(TICKS).with_style(style)
        });
        bar.set_position((fraction * TICKS as f64) as u64);
    }

    /// A run whose end can't be foreseen has begun with this, and nothing may be heard of it for long.
    pub fn begin(&mut self, words: &str) {
        self.spinner = self.wanted.then(|| Spinner::new(words));
    }

    /// It has come so far.
    pub fn reached_at(&self, place: impl FnOnce() -> String) {
        if let Some(spinner) = &self.spinner {
            spinner.say(place());
        }
    }

    /// Removes bar and spinner.
    pub fn finish(&mut self) -> Duration {
        self.spinner = None;
        if let Some(bar) = self.bar.take() {
            bar.finish_and_clear();
        }
        self.begun.elapsed()
    }
}

/// Shows these words while something runs of which nothing is known but that it has not ended.
pub fn during<T>(report: &Report<'_>, words: &str, run: impl FnOnce() -> T) -> T {
    let mut progress = report.progress();
    progress.begin(words);
    run()
}

/// Words with a spinner that turns by itself, on a thread of its own, after a moment of patience.
struct Spinner {
    words: Arc<Mutex<String>>,
    ended: Option<Sender<()>>,
    thread: Option<JoinHandle<()>>,
}

impl Spinner {
    fn new(words: &str) -> Self {
        let shared = Arc::new(Mutex::new(words.to_owned()));
        let (ended, end) = mpsc::channel();
        let words = Arc::clone(&shared);
        let thread = thread::Builder::new().spawn(move || turn(&words, &end));
        Spinner {
            words: shared,
            ended: Some(ended),
            // Without a thread the run goes on unseen.
            thread: thread.ok(),
        }
    }

    fn say(&self, words: String) {
        *self.words.lock().unwrap_or_else(PoisonError::into_inner) = words;
    }
}

impl Drop for Spinner {
    fn drop(&mut self) {
        drop(self.ended.take());
        if let Some(thread) = self.thread.take() {
            // It only draws: what goes wrong there is nobody's concern.
            let _ = thread.join();
        }
    }
}

/// Until the other end of the channel is gone.
fn turn(words: &Mutex<String>, end: &Receiver<()>) {
    /// Between two turns of the spinner.
    const TURN: Duration = Duration::from_millis(120);
    if end.recv_timeout(PATIENCE) != Err(RecvTimeoutError::Timeout) {
        return;
    }
    let style =
        ProgressStyle::with_template("{spinner} {msg}  {elapsed}").expect("the template is valid");
    let bar = ProgressBar::new_spinner().with_style(style);
    while end.recv_timeout(TURN) == Err(RecvTimeoutError::Timeout) {
        let words = words.lock().unwrap_or_else(PoisonError::into_inner).clone();
        bar.set_message(words);
        bar.tick();
    }
    bar.finish_and_clear();
}
