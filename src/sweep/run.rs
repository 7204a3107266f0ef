//! All units of a sweep, over the cores of a machine, handed on in order.

use super::{SweepRow, SweepSettings, Sweeper};
use crate::error::{Error, Result};
use std::collections::BTreeMap;
use std::num::NonZero;
use std::ops::{ControlFlow, Range};
use std::sync::atomic::{AtomicBool, Ordering};
use std::sync::{Mutex, mpsc};

/// Points of the first chunk, which are soon there, and of later ones: so many that lanes are seldom empty, so few that they are
/// flushed often.
const FIRST_CHUNK: usize = 16;
const CHUNK: usize = 512;
/// Chunks that may be done before one that they must wait for, for each thread.
const AHEAD: usize = 8;
/// More threads than this are a slip of the pen.
const MOST_THREADS: usize = 1024;

/// Which units: `first`, and then every `every`-th.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
#[non_exhaustive]
pub struct UnitShare {
    /// The first one.
    pub first: usize,
    /// From one to the next, at least 1.
    pub every: usize,
}

impl UnitShare {
    /// All from the first one on.
    pub fn from(first: usize) -> Self {
        UnitShare { first, every: 1 }
    }

    /// Those of the shard number `index` of `count`, counted from 1, without the first `done` of them.
    pub fn shard(index: usize, count: usize, done: usize) -> Self {
        UnitShare {
            first: index - 1 + done * count,
            every: count,
        }
    }

    /// How many there are of `all`.
    fn count(&self, all: usize) -> usize {
        all.saturating_sub(self.first).div_ceil(self.every)
    }
}

/// Whether there may be so many threads: `None` is as many as there are cores.
///
/// # Errors
/// [`Error::Parameter`] for none, and for more than any machine has use for.
pub fn threads_checked(threads: Option<usize>) -> Result<()> {
    match threads {
        Some(n) if !(1..=MOST_THREADS).contains(&n) => Err(Error::parameter(
            "threads",
            n,
            "at least 1 and at most 1024",
        )),
        _ => Ok(()),
    }
}

/// Computes these units over so many threads, as many as there are cores if `None`, but no more than units. Rows are given to `seen` in the order of their
/// units as soon as all before them are there, on the thread that calls; it may end the sweep, and so may `stop`, after the rows
/// that are on their way. Rows held back for their order are bounded in number.
///
/// # Errors
/// Those of [`SweepSettings::checked`] and [`threads_checked`]. What fails at a point is in its row.
pub fn run(
    settings: &SweepSettings,
    units: UnitShare,
    threads: Option<usize>,
    stop: &AtomicBool,
    seen: &mut dyn FnMut(&[SweepRow]) -> ControlFlow<()>,
) -> Result<()> {
    settings.checked()?;
    if units.every == 0 {
        return Err(Error::parameter("every", 0, "at least 1"));
    }
    threads_checked(threads)?;
    let all = units.count(settings.units());
    let cores = || std::thread::available_parallelism().map_or(1, NonZero::get);
    let pool = rayon::ThreadPoolBuilder::new()
        .num_threads(threads.unwrap_or_else(cores).min(all).max(1))
        .build()
        .map_err(|error| Error::Input(format!("cannot start threads: {error}")))?;
    let threads = pool.current_num_threads();
    let mut chunks = chunks(settings, all, threads).enumerate().fuse().peekable();
    // One for each thread that is at work at the same time.
    let idle: Mutex<Vec<Sweeper>> = Mutex::default();
    let compute = |chunk: Range<usize>| -> Result<Vec<SweepRow>> {
        let mut rows = Vec::new();
        if stop.load(Ordering::Relaxed) {
            return Ok(rows);
        }
        let spare = idle.lock().expect("no thread panicked").pop();
        let mut sweeper = spare.map_or_else(|| Sweeper::new(settings), Ok)?;
        sweeper.rows(chunk.map(|n| units.first + n * units.every), &mut rows);
        idle.lock().expect("no thread panicked").push(sweeper);
        Ok(rows)
    };
    let compute = &compute;
    pool.in_place_scope(|scope| {
        let (done, results) = mpsc::channel();
        let mut waiting = BTreeMap::new();
        let mut begun = 0;
        for next in 0.. {
            while let Some((index, chunk)) = chunks.next_if(|(i, _)| *i < next + AHEAD * threads) {
                let done = done.clone();
                begun = index + 1;
                // Nobody listens any more to what comes after the end.
                scope.spawn(move |_| drop(done.send((index, compute(chunk)))));
            }
            if next == begun {
                break;
            }
            let rows = loop {
                if let Some(rows) = waiting.remove(&next) {
                    break rows;
                }
                let Ok((index, rows)) = results.recv() else {
                    return Ok(());
                };
                waiting.insert(index, rows);
            };
            let rows: Vec<SweepRow> = rows?;
            if rows.is_empty() || seen(&rows).is_break() {
                stop.store(true, Ordering::Relaxed);
                return Ok(());
            }
        }
        Ok(())
    })
}

/// The chunks of so many units, one after the other: small ones first, so that the first rows are soon there, and last, so that no
/// thread waits long for another.
fn chunks(
    settings: &SweepSettings,
    all: usize,
    threads: usize,
) -> impl Iterator<Item = Range<usize>> {
    /// Chunks for each thread, of what is left.
    const SHARES: usize = 4;
    let each = settings.points_per_unit();
    let (first, full) = (FIRST_CHUNK.div_ceil(each), CHUNK.div_ceil(each));
    let mut begin = 0;
    std::iter::from_fn(move || {
        let left = all - begin;
        let share = left.div_ceil(SHARES * threads).max(first);
        let size = share.min(begin.max(first)).min(full).min(left);
        begin += size;
        (size > 0).then(|| begin - size..begin)
    })
}
