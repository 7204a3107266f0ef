//! Threads that run commands one after the other: to begin one takes about as long as a short run.

use std::sync::mpsc::{Sender, channel};
use std::sync::{Mutex, MutexGuard, PoisonError};
use std::{io, thread};

/// Room for the calls of a command: searches go deep.
pub const STACK: usize = 64 << 20;
/// No more threads wait for work.
const MOST: usize = 16;

type Job = Box<dyn FnOnce() + Send>;

/// The threads that have nothing to do.
struct Idle {
    /// Of which process: another one that was forked from it has none of its threads.
    process: u32,
    /// Where they take their next work from.
    threads: Vec<Sender<Job>>,
}

static IDLE: Mutex<Idle> = Mutex::new(Idle {
    process: 0,
    threads: Vec::new(),
});

fn idle() -> MutexGuard<'static, Idle> {
    let mut idle = IDLE.lock().unwrap_or_else(PoisonError::into_inner);
    let process = std::process::id();
    if idle.process != process {
        // Not dropped: their other ends are held by nobody who could answer.
        std::mem::forget(std::mem::take(&mut idle.threads));
        idle.process = process;
    }
    idle
}

fn pop() -> Option<Sender<Job>> {
    idle().threads.pop()
}

/// Runs this on a thread of its own, which must not panic.
///
/// # Errors
/// The system's, where it has no more threads.
pub fn run(job: impl FnOnce() + Send + 'static) -> io::Result<()> {
    let mut job: Job = Box::new(job);
    while let Some(thread) = pop() {
        match thread.send(job) {
            Ok(()) => return Ok(()),
            // It has ended.
            Err(back) => job = back.0,
        }
    }
    let (own, next) = channel::<Job>();
    let work = move || {
        job();
        loop {
            {
                let mut idle = idle();
                if idle.threads.len() >= MOST {
                    return;
                }
                idle.threads.push(own.clone());
            }
            let Ok(job) = next.recv() else {
                return;
            };
            job();
        }
    };
    thread::Builder::new()
        .name("twinslip".into())
        .stack_size(STACK)
        .spawn(work)
        .map(drop)
}
