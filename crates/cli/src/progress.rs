//! Progress of long runs on standard error: a bar or a spinner on a terminal, elsewhere a line every ten seconds.

use super::call::Outlet;
use super::report::Report;
use super::say;
use super::words::time;
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

/// The environment variable that sets the seconds between two lines of progress where standard error is no terminal.
pub const VARIABLE: &str = "TWINSLIP_PROGRESS";
/// Seconds between two lines, and before the first one.
const PAUSE: f64 = 10.0;

/// How progress is shown.
#[derive(Clone)]
enum Shown {
    /// Not at all.
    Silent,
    /// By what a terminal redraws.
    Drawn,
    /// By lines of this command with pauses between.
    Lines(String, Duration),
}

impl Shown {
    fn now(quiet: bool, command: &str) -> Self {
        if quiet {
            return Shown::Silent;
        }
        if std::io::stderr().is_terminal() {
            return Shown::Drawn;
        }
        let given = std::env::var(VARIABLE).ok();
        let seconds = given.and_then(|text| text.trim().parse().ok());
        let pause = seconds.and_then(|seconds: f64| {
            Duration::try_from_secs_f64(seconds)
                .ok()
                .filter(|pause| !pause.is_zero())
        });
        let pause = pause.unwrap_or(Duration::from_secs_f64(PAUSE));
        Shown::Lines(command.to_owned(), pause)
    }
}

/// `branch: 120 points, B = 37.2, 31 s`.
fn line(command: &str, reached: &str, begun: Instant) {
    say(format_args!(
        "{command}: {reached}, {}",
        time(begun.elapsed().as_secs_f64())
    ));
}

/// Shows how far a run has come.
pub struct Progress {
    begun: Instant,
    shown: Shown,
    calls: u32,
    /// The last line, as a number of pauses since the beginning.
    lines: u32,
    bar: Option<ProgressBar>,
    spinner: Option<Spinner>,
    outlet: Option<Arc<dyn Outlet>>,
}

impl Progress {
    /// Silent if asked to be; `command` is the name with which lines begin.
    pub fn new(quiet: bool, command: &str) -> Self {
        Progress {
            begun: Instant::now(),
            shown: Shown::now(quiet, command),
            calls: 0,
            lines: 0,
            bar: None,
            spinner: None,
            outlet: None,
        }
    }

    /// Shows nothing, and reports to another program.
    pub fn handed_on(outlet: Arc<dyn Outlet>) -> Self {
        Progress {
            outlet: Some(outlet),
            ..Progress::new(true, "")
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
        match &self.shown {
            Shown::Silent => return,
            Shown::Lines(command, pause) => {
                let elapsed = self.begun.elapsed().as_secs_f64();
                let pauses = (elapsed / pause.as_secs_f64()) as u32;
                if pauses > self.lines {
                    self.lines = pauses;
                    line(command, &format!("{:.0} %", 100.0 * fraction), self.begun);
                }
                return;
            }
            Shown::Drawn if self.begun.elapsed() < PATIENCE => return,
            Shown::Drawn => {}
        }
        let bar = self.bar.get_or_insert_with(|| {
            let style =
                ProgressStyle::with_template("{bar:40} {percent:>3} %  {elapsed}, {eta} to go")
                    .expect("the template is valid");
            ProgressBar::new(TICKS).with_style(style)
        });
        bar.set_position((fraction * TICKS as f64) as u64);
    }

    /// A run begins of which no fraction is known.
    pub fn begin(&mut self, words: &str) {
        self.spinner = match &self.shown {
            Shown::Silent => None,
            shown => Some(Spinner::new(words, shown, self.begun)),
        };
    }

    /// Where it is.
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

/// Shows the last words from a thread of its own, as the run itself may be silent for long.
struct Spinner {
    words: Arc<Mutex<String>>,
    ended: Option<Sender<()>>,
    thread: Option<JoinHandle<()>>,
}

impl Spinner {
    fn new(words: &str, shown: &Shown, begun: Instant) -> Self {
        let shared = Arc::new(Mutex::new(words.to_owned()));
        let (ended, end) = mpsc::channel();
        let (words, shown) = (Arc::clone(&shared), shown.clone());
        let thread = thread::Builder::new().spawn(move || match shown {
            Shown::Lines(command, pause) => lines(&command, pause, begun, &words, &end),
            _ => turn(&words, &end),
        });
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

fn held(words: &Mutex<String>) -> String {
    words.lock().unwrap_or_else(PoisonError::into_inner).clone()
}

/// Writes a line after each pause, until the other end of the channel is gone.
fn lines(
    command: &str,
    pause: Duration,
    begun: Instant,
    words: &Mutex<String>,
    end: &Receiver<()>,
) {
    let left = |begun: Instant| {
        let over = begun.elapsed().as_secs_f64() % pause.as_secs_f64();
        pause.saturating_sub(Duration::from_secs_f64(over))
    };
    while end.recv_timeout(left(begun)) == Err(RecvTimeoutError::Timeout) {
        line(command, &held(words), begun);
    }
}

/// Turns a spinner until the other end of the channel is gone.
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
        bar.set_message(held(words));
        bar.tick();
    }
    bar.finish_and_clear();
}
