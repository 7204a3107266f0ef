//! Which interfaces a process holds, and sums over those of all processes.
//!
//! Sums are taken chunk by chunk, and then group by group, in the order of the interfaces. Chunks and groups depend on the number of
//! interfaces alone, and a process holds whole groups: so do all digits, whatever the number of processes and cores.

use super::block::{Extent, larger};
use super::constants::LANES;
use rayon::prelude::*;
use std::fmt;
use std::ops::Range;

/// Blocks whose numbers are added up together.
pub(super) const CHUNK: usize = 64;
/// Interfaces in a chunk.
const HELD: usize = CHUNK * LANES;
/// Groups of chunks, at most: so many numbers the processes tell each other for a sum.
const GROUPS: usize = 4096;
/// Interfaces from which on several cores pay.
pub(super) const MANY: usize = 8192;

/// What the processes of a run tell each other, all of them in the same order: the ranks of MPI.
pub trait Gather: fmt::Debug + Send + Sync {
    /// The number of this process, and how many there are.
    fn place(&self) -> (usize, usize);

    /// The numbers of all processes in their order; a process has so many.
    fn gathered(&self, own: &[f64], count: &dyn Fn(usize) -> usize) -> Vec<f64>;

    /// The same at the first process; nothing at the others.
    fn gathered_at_first(&self, own: &[f64], count: &dyn Fn(usize) -> usize) -> Vec<f64>;
}

/// The processes of a run.
#[derive(Debug, Clone, Copy)]
pub enum Processes {
    /// There is one alone.
    One,
    /// There are several.
    Several(&'static dyn Gather),
}

impl Processes {
    fn is_one(self) -> bool {
        matches!(self, Processes::One)
    }
}

/// The interfaces that a process holds of all.
#[derive(Debug, Clone)]
pub struct Share {
    count: usize,
    rank: usize,
    ranks: usize,
    processes: Processes,
}

impl Share {
    /// All interfaces, in one process.
    pub fn all(count: usize) -> Self {
        Share::new(count, Processes::One)
    }

    /// What this one of the processes holds of so many interfaces.
    pub fn new(count: usize, processes: Processes) -> Self {
        let (rank, ranks) = match processes {
            Processes::One => (0, 1),
            Processes::Several(processes) => processes.place(),
        };
        Share {
            count,
            rank,
            ranks,
            processes,
        }
    }

    /// How many there are in all processes.
    pub fn count(&self) -> usize {
        self.count
    }

    /// The number of this process among all.
    pub fn rank(&self) -> usize {
        self.rank
    }

    /// How many processes there are.
    pub fn ranks(&self) -> usize {
        self.ranks
    }

    fn chunks_in_group(&self) -> usize {
        self.count.div_ceil(HELD).div_ceil(GROUPS).max(1)
    }

    /// The groups of a process.
    fn groups(&self, rank: usize) -> Range<usize> {
        let groups = self.count.div_ceil(HELD).div_ceil(self.chunks_in_group());
        let begin = |rank: usize| groups * rank / self.ranks;
        begin(rank)..begin(rank + 1)
    }

    /// The numbers, from 0, of the interfaces that a process holds.
    fn held_by(&self, rank: usize) -> Range<usize> {
        let groups = self.groups(rank);
        let place = |group: usize| (group * self.chunks_in_group() * HELD).min(self.count);
        place(groups.start)..place(groups.end)
    }

    /// The numbers, from 0, of those held here.
    pub fn held(&self) -> Range<usize> {
        self.held_by(self.rank)
    }

    /// Whether several cores pay.
    pub(super) fn is_large(&self) -> bool {
        self.held().len() >= MANY
    }

    /// Results of work on the chunks, in their order.
    pub(super) fn by_chunks<T: Send>(&self, work: impl Fn(usize) -> T + Send + Sync) -> Vec<T> {
        let chunks = self.held().len().div_ceil(HELD);
        if self.is_large() {
            (0..chunks).into_par_iter().map(work).collect()
        } else {
            (0..chunks).map(work).collect()
        }
    }

    /// The sum over the chunks of all processes.
    pub(super) fn sum(&self, of_chunks: &[f64]) -> f64 {
        let chunks = self.chunks_in_group();
        if chunks == 1 && self.processes.is_one() {
            return of_chunks.iter().sum();
        }
        let groups: Vec<f64> = of_chunks
            .chunks(chunks)
            .map(|group| group.iter().sum())
            .collect();
        self.gathered(&groups, |rank| self.groups(rank).len())
            .iter()
            .sum()
    }

    /// What all processes have, in their order, of which each has so many.
    fn gathered(&self, own: &[f64], count: impl Fn(usize) -> usize) -> Vec<f64> {
        match self.processes {
            Processes::One => {
                debug_assert_eq!(own.len(), count(0));
                own.to_vec()
            }
            Processes::Several(processes) => processes.gathered(own, &count),
        }
    }

    /// A number of every interface, in the first process, of which each knows its own.
    pub fn at_first(&self, held: Vec<f64>) -> Vec<f64> {
        match self.processes {
            Processes::One => held,
            Processes::Several(processes) => {
                processes.gathered_at_first(&held, &|rank| self.held_by(rank).len())
            }
        }
    }

    /// What one process knows, and all others have zeros for.
    pub fn told(&self, own: &mut [f64]) {
        if self.processes.is_one() {
            return;
        }
        let all = self.gathered(own, |_| own.len());
        own.fill(0.0);
        for of_rank in all.chunks(own.len().max(1)) {
            for (sum, x) in own.iter_mut().zip(of_rank) {
                *sum += x;
            }
        }
    }

    /// What the chunks of all processes do together.
    pub(super) fn extent(&self, of_chunks: &[Extent]) -> Extent {
        let own = of_chunks.iter().copied().fold(Extent::NONE, Extent::and);
        if self.chunks_in_group() == 1 && self.processes.is_one() {
            return own;
        }
        let slip_rates: Vec<f64> = of_chunks.iter().map(|extent| extent.slip_rate).collect();
        let slip_rate = self.sum(&slip_rates);
        let sliding = own.sliding as f64;
        let parts = [own.state[0], own.state[1], own.slip_rate_max, sliding];
        let all = self.gathered(&parts, |_| parts.len());
        let all = all.as_chunks::<4>().0.iter();
        let all = all.map(|&[low, high, fastest, sliding]| Extent {
            state: [low, high],
            slip_rate: 0.0,
            slip_rate_max: fastest,
            sliding: sliding as usize,
        });
        Extent {
            slip_rate,
            ..all.fold(Extent::NONE, Extent::and)
        }
    }

    /// The largest of all processes, or what is not a number.
    pub fn largest<const N: usize>(&self, own: [f64; N]) -> [f64; N] {
        if self.processes.is_one() {
            return own;
        }
        let all = self.gathered(&own, |_| N);
        let both = |a: [f64; N], b: &[f64; N]| std::array::from_fn(|i| larger(a[i], b[i]));
        all.as_chunks::<N>()
            .0
            .iter()
            .fold([f64::NEG_INFINITY; N], both)
    }
}
