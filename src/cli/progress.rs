//! A bar on standard error for runs that take long, if somebody looks at it.

use indicatif::{ProgressBar, ProgressStyle};
use std::io::IsTerminal;
use std::sync::mpsc::{self, RecvTimeoutError};
use std::thread;
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
}

impl Progress {
    /// Silent if asked to be, or if standard error is no terminal.
    pub fn new(quiet: bool) -> Self {
        Progress {
            begun: Instant::now(),
            wanted: !quiet && std::io::stderr().is_terminal(),
            calls: 0,
            bar: None,
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

    /// A run whose end can't be foreseen has come so far; each call stands for much work.
    pub fn reached_at(&mut self, place: impl FnOnce() -> String) {
        if !self.wanted || self.begun.elapsed() < PATIENCE {
            return;
        }
        let bar = self.bar.get_or_insert_with(|| {
            let style = ProgressStyle::with_template("{spinner} {msg}  {elapsed}")
                .expect("the template is valid");
            ProgressBar::new_spinner().with_style(style)
        });
        bar.set_message(place());
        bar.tick();
    }

    /// Removes the bar.
    pub fn finish(&mut self) -> Duration {
        if let Some(bar) = self.bar.take() {
            bar.finish_and_clear();
        }
        self.begun.elapsed()
    }
}

/// Shows these words while something runs of which nothing is known but that it has not ended.
pub fn during<T>(quiet: bool, words: &str, run: impl FnOnce() -> T) -> T {
    /// Between two turns of the spinner.
    const TURN: Duration = Duration::from_millis(120);
    if quiet || !std::io::stderr().is_terminal() {
        return run();
    }
    let (done, end) = mpsc::channel::<()>();
    thread::scope(|scope| {
        scope.spawn(move || {
            if end.recv_timeout(PATIENCE) != Err(RecvTimeoutError::Timeout) {
                return;
            }
            let style = ProgressStyle::with_template("{spinner} {msg}  {elapsed}")
                .expect("the template is valid");
            let bar = ProgressBar::new_spinner()
                .with_style(style)
                .with_message(words.to_owned());
            while end.recv_timeout(TURN) == Err(RecvTimeoutError::Timeout) {
                bar.tick();
            }
            bar.finish_and_clear();
        });
        let made = run();
        drop(done);
        made
    })
}
