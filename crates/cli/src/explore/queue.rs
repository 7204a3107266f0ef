//! Which commands run now, and which wait.
//!
//! A page asks for a picture at every move of the pointer: what was asked for last is wanted first, and what nobody waits for any
//! more is never begun. Background work has threads of its own, and waits at its next row while other work runs.

use super::outbox::Outbox;
use crate::failure::Failure;
use std::panic::{AssertUnwindSafe, catch_unwind};
use std::sync::atomic::{AtomicBool, Ordering};
use std::sync::{Arc, Condvar, Mutex, MutexGuard, PoisonError};
use std::thread;
use std::time::Duration;

/// Commands that wait; one more is refused.
pub const MOST_WAITING: usize = 48;
/// Room for the calls of a command: searches go deep.
const STACK: usize = 64 << 20;
/// Background work looks again after so long whether other work runs.
const GLANCE: Duration = Duration::from_millis(50);

/// What a thread of a command does.
type Job = Box<dyn FnOnce(&Arc<Outbox>) + Send>;

/// Commands that run and commands that wait.
pub struct Queue {
    state: Mutex<State>,
    changed: Condvar,
    /// Commands that may run at once: urgent ones, and ones in the background.
    places: [usize; 2],
}

#[derive(Default)]
struct State {
    /// The newest last; urgent ones, and ones in the background.
    waiting: [Vec<(Arc<Outbox>, Job)>; 2],
    running: [usize; 2],
}

/// The place of urgent work in the pairs above, and of background work.
const URGENT: usize = 0;
const BACKGROUND: usize = 1;

impl Queue {
    /// An empty one for this machine.
    pub fn new() -> Self {
        let cores = thread::available_parallelism().map_or(2, |cores| cores.get());
        Queue {
            state: Mutex::default(),
            changed: Condvar::new(),
            // Two more than cores: what is stopped may need a while to end, and most of what is urgent takes a millisecond.
            places: [cores.max(2) + 2, if cores > 2 { 2 } else { 1 }],
        }
    }

    fn state(&self) -> MutexGuard<'_, State> {
        self.state.lock().unwrap_or_else(PoisonError::into_inner)
    }

    /// Runs this on a thread of its own as soon as there is a place, unless nobody waits for it by then. False if too many wait
    /// already.
    pub fn add(
        self: &Arc<Self>,
        outbox: Arc<Outbox>,
        job: impl FnOnce(&Arc<Outbox>) + Send + 'static,
    ) -> bool {
        let mut state = self.state();
        for waiting in &mut state.waiting {
            waiting.retain(|(outbox, _)| !outbox.is_stopped());
        }
        let kind = usize::from(outbox.is_background());
        let free = state.running[kind] < self.places[kind];
        if !free && state.waiting.iter().map(Vec::len).sum::<usize>() >= MOST_WAITING {
            return false;
        }
        state.waiting[kind].push((outbox, Box::new(job)));
        drop(state);
        self.start();
        true
    }

    /// Begins what there are places for.
    fn start(self: &Arc<Self>) {
        while let Some((outbox, job, kind)) = self.next() {
            let queue = Arc::clone(self);
            let own = Arc::clone(&outbox);
            let work = move || {
                if kind == BACKGROUND {
                    be_nice();
                }
                let ended = catch_unwind(AssertUnwindSafe(|| job(&own)));
                if let Err(panic) = ended {
                    own.end(Err(Failure::of_panic(&*panic)));
                }
                queue.state().running[kind] -= 1;
                queue.changed();
                queue.start();
            };
            let begun = thread::Builder::new()
                .name("twinslip".into())
                .stack_size(STACK)
                .spawn(work);
            if let Err(error) = begun {
                self.state().running[kind] -= 1;
                outbox.end(Err(Failure {
                    kind: "numerical",
                    field: None,
                    words: format!("no thread could be begun: {error}"),
                }));
            }
        }
    }

    /// The newest one that waits and has a place, which it takes.
    fn next(&self) -> Option<(Arc<Outbox>, Job, usize)> {
        let mut state = self.state();
        for kind in [URGENT, BACKGROUND] {
            while state.running[kind] < self.places[kind] {
                let Some((outbox, job)) = state.waiting[kind].pop() else {
                    break;
                };
                if !outbox.is_stopped() {
                    state.running[kind] += 1;
                    return Some((outbox, job, kind));
                }
            }
        }
        None
    }

    /// Waits while urgent work runs, unless this is set.
    pub fn wait_for_others(&self, stop: &AtomicBool) {
        let mut state = self.state();
        while state.running[URGENT] > 0 && !stop.load(Ordering::Relaxed) {
            let waited = self.changed.wait_timeout(state, GLANCE);
            (state, _) = waited.unwrap_or_else(PoisonError::into_inner);
        }
    }

    /// Those who wait look again.
    pub fn changed(&self) {
        self.changed.notify_all();
    }
}

/// Gives this thread, and those that it begins, less of the processor than others have.
fn be_nice() {
    #[cfg(target_os = "linux")]
    let _ = rustix::process::setpriority_process(None, 10);
}
