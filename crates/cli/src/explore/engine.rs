//! The page without a server: its script, its styles and what it begins with, and answers to its questions, for programs that show it in
//! a page of their own and carry questions and answers themselves. The widget of a notebook is one.

use super::outbox::Outbox;
use super::queue::Queue;
use super::work::{LONGEST, Work, begin, options, too_many_waiting};
use super::{assets, bundle};
use crate::call::Call;
use crate::failure::Failure;
use std::sync::atomic::{AtomicBool, Ordering};
use std::sync::{Arc, Condvar, Mutex, MutexGuard, PoisonError};
use std::task::{Wake, Waker};
use std::time::{Duration, Instant};
use twinslip::error::Result;

/// The least time between two pieces of an answer: servers of notebooks drop messages where there are more than 1000 a second.
const BETWEEN: Duration = Duration::from_millis(40);

/// The script of the page as a module that exports `render`, as anywidget has it.
///
/// # Errors
/// A sentence with file and line, where the files of the page are read from a folder and one of them can't be read as a module.
pub fn widget_module() -> std::result::Result<String, String> {
    let script = bundle::bundle(&assets::modules(), assets::MAIN)?;
    let name = bundle::NAME;
    Ok(format!(
        "{script}export default {{ render: {name}.render }};\n"
    ))
}

/// The styles of the page, which are of elements in `.twinslip` alone.
pub fn widget_style() -> String {
    assets::style().into_owned()
}

/// What the page begins with, a JSON object, for the options of a model as words of a command line.
///
/// # Errors
/// Those of the options and of the model that they make.
pub fn widget_begin(words: &[String]) -> Result<String> {
    let name = ["twinslip", "explore"].map(str::to_owned);
    let call = Call {
        words: name.into_iter().chain(words.iter().cloned()).collect(),
        outlet: None,
    };
    let begin = super::begin::begin(None, &call)?;
    super::check(&begin)?;
    Ok(begin.to_string())
}

/// Runs commands for pages, with the bounds that a server has: a few at once, the newest first, background work while no other runs.
pub struct Engine {
    queue: Arc<Queue>,
}

impl Default for Engine {
    fn default() -> Self {
        Engine {
            queue: Arc::new(Queue::new()),
        }
    }
}

impl Engine {
    /// Asks a command, or for the description of a `model`, with options as a JSON object. What is refused is told by the answer.
    pub fn ask(&self, command: &str, options: &str, background: bool) -> Asked {
        let behind = background.then(|| Arc::clone(&self.queue));
        let outbox = Arc::new(Outbox::new(true, behind));
        if let Err(refused) = self.begin(&outbox, command, options) {
            outbox.end(Err(refused));
        }
        Asked {
            outbox,
            bell: Arc::default(),
            next: Mutex::new(Instant::now()),
            ended: AtomicBool::new(false),
        }
    }

    fn begin(
        &self,
        outbox: &Arc<Outbox>,
        command: &str,
        text: &str,
    ) -> std::result::Result<(), Failure> {
        let refused = |words| Failure {
            kind: "input",
            field: None,
            words,
        };
        if text.len() > LONGEST {
            return Err(refused(format!(
                "the options are longer than {LONGEST} bytes"
            )));
        }
        let options = options(text.as_bytes()).map_err(refused)?;
        let work = Work::new(command, &options).map_err(|error| Failure::of(&error))?;
        match begin(&self.queue, outbox, work) {
            true => Ok(()),
            false => Err(refused(too_many_waiting())),
        }
    }
}

/// A question on its way; its command is stopped when it is dropped.
pub struct Asked {
    outbox: Arc<Outbox>,
    bell: Arc<Bell>,
    /// When the next piece of the answer may be taken.
    next: Mutex<Instant>,
    ended: AtomicBool,
}

impl Asked {
    /// Waits for lines of the answer, at most for so long; none if none came. Each is a JSON object; the last one has `ended` or `error`.
    pub fn lines(&self, patience: Duration) -> Vec<String> {
        let mut next = self.next.lock().unwrap_or_else(PoisonError::into_inner);
        let waker = Waker::from(Arc::clone(&self.bell));
        let end = Instant::now() + patience;
        loop {
            self.bell.silence();
            if self.ended() {
                return Vec::new();
            }
            let (some, last) = self.outbox.is_ready(&waker);
            let now = Instant::now();
            // The last piece does not wait.
            if last || some && now >= *next {
                break;
            }
            let until = if some { end.min(*next) } else { end };
            if until <= now {
                return Vec::new();
            }
            self.bell.wait(until - now);
        }
        *next = Instant::now() + BETWEEN;
        let (text, last) = self.outbox.take();
        if last {
            self.ended.store(true, Ordering::Relaxed);
        }
        let text = String::from_utf8_lossy(&text);
        text.lines().map(str::to_owned).collect()
    }

    /// Stops the command; no lines come any more.
    pub fn stop(&self) {
        self.ended.store(true, Ordering::Relaxed);
        self.outbox.leave();
        self.bell.wake_by_ref();
    }

    /// Whether the last line was taken, or the command was stopped.
    pub fn ended(&self) -> bool {
        self.ended.load(Ordering::Relaxed)
    }
}

impl Drop for Asked {
    fn drop(&mut self) {
        self.outbox.leave();
    }
}

/// Wakes the thread that waits for lines.
#[derive(Default)]
struct Bell {
    rung: Mutex<bool>,
    heard: Condvar,
}

impl Bell {
    fn rung(&self) -> MutexGuard<'_, bool> {
        self.rung.lock().unwrap_or_else(PoisonError::into_inner)
    }

    /// It has not rung from now on.
    fn silence(&self) {
        *self.rung() = false;
    }

    /// Waits until it has rung, at most for so long.
    fn wait(&self, patience: Duration) {
        let silent = |rung: &mut bool| !*rung;
        let waited = self.heard.wait_timeout_while(self.rung(), patience, silent);
        drop(waited);
    }
}

impl Wake for Bell {
    fn wake(self: Arc<Self>) {
        self.wake_by_ref();
    }

    fn wake_by_ref(self: &Arc<Self>) {
        *self.rung() = true;
        self.heard.notify_all();
    }
}
