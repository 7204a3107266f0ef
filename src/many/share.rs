//! Which interfaces a process holds, and sums over those of all processes.
//!
//! Sums are taken chunk by chunk, and then group by group, in the order of the interfaces. Chunks and groups depend on the number of
//! interfaces alone, and a process holds whole groups: so do all digits, whatever the number of processes and cores.

use super::block::{Extent, larger};
use super::constants::LANES;
use rayon::prelude::*;
use std::ops::Range;

/// Blocks whose numbers are added up together.
pub(super) const CHUNK: usize = 64;
/// Interfaces in a chunk.
const HELD: usize = CHUNK * LANES;
/// Groups of chunks, at most: so many numbers the processes tell each other for a sum.
const GROUPS: usize = 4096;
/// Interfaces from which on several cores pay.
pub(super) const MANY: usize = 8192;

/// What the processes of a run tell each other.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Processes {
    /// There is one alone.
    One,
    /// The ranks of MPI.
    #[cfg(feature = "mpi")]
    Ranks,
}

/// The interfaces that a process holds of all.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Share {
    count: usize,
    held: Range<usize>,
    chunks_in_group: usize,
    processes: Processes,
}

impl Share {
    /// All interfaces, in one process.
    pub fn all(count: usize) -> Self {
        Share::of(count, 0, 1, Processes::One)
    }

    /// Those of a rank of some.
    pub(super) fn of(count: usize, rank: usize, ranks: usize, processes: Processes) -> Self {
        let chunks = count.div_ceil(HELD);
        let chunks_in_group = chunks.div_ceil(GROUPS);
        let groups = chunks.div_ceil(chunks_in_group.max(1));
        let begin = |rank: usize| (groups * rank / ranks * chunks_in_group * HELD).min(count);
        Share {
            count,
            held: begin(rank)..begin(rank + 1),
            chunks_in_group,
            processes,
        }
    }

    /// How many there are in all processes.
    pub fn count(&self) -> usize {
        self.count
    }

    /// The numbers, from 0, of those held here.
    pub fn held(&self) -> Range<usize> {
        self.held.clone()
    }

    /// Whether several cores pay.
    pub(super) fn is_large(&self) -> bool {
        self.held.len() >= MANY
    }

    /// Results of work on the chunks, in their order.
    pub(super) fn by_chunks<T: Send>(&self, work: impl Fn(usize) -> T + Send + Sync) -> Vec<T> {
        let chunks = self.held.len().div_ceil(HELD);
        if self.is_large() {
            (0..chunks).into_par_iter().map(work).collect()
        } else {
            (0..chunks).map(work).collect()
        }
    }

    /// The sum over the chunks of all processes.
    pub(super) fn sum(&self, of_chunks: &[f64]) -> f64 {
        let [sum] = self.sums(of_chunks.iter().map(|x| [*x]));
        sum
    }

    /// Several sums at once.
    pub(super) fn sums<const N: usize>(
        &self,
        mut of_chunks: impl ExactSizeIterator<Item = [f64; N]>,
    ) -> [f64; N] {
        let add = |sum: [f64; N], x: [f64; N]| std::array::from_fn(|i| sum[i] + x[i]);
        if self.processes == Processes::One && self.chunks_in_group <= 1 {
            return of_chunks.fold([0.0; N], add);
        }
        let mut groups =
            Vec::with_capacity(N * of_chunks.len().div_ceil(self.chunks_in_group.max(1)));
        while of_chunks.len() > 0 {
            let group = of_chunks.by_ref().take(self.chunks_in_group);
            groups.extend(group.fold([0.0; N], add));
        }
        let all = self.gathered(groups);
        all.as_chunks::<N>().0.iter().copied().fold([0.0; N], add)
    }

    /// What all processes have, in their order.
    pub(super) fn gathered(&self, own: Vec<f64>) -> Vec<f64> {
        match self.processes {
            Processes::One => own,
            #[cfg(feature = "mpi")]
            Processes::Ranks => super::ranks::gathered(own),
        }
    }

    /// What the chunks of all processes do together.
    pub(super) fn extent(&self, of_chunks: &[Extent]) -> Extent {
        let own = of_chunks.iter().copied().fold(Extent::NONE, Extent::and);
        if self.processes == Processes::One && self.chunks_in_group <= 1 {
            return own;
        }
        let slip_rates = of_chunks.iter().map(|extent| [extent.slip_rate]);
        let [slip_rate] = self.sums(slip_rates);
        let parts = [
            own.state[0],
            own.state[1],
            own.slip_rate_max,
            own.sliding as f64,
        ];
        let all = self.gathered(parts.to_vec());
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
    pub(super) fn largest<const N: usize>(&self, own: [f64; N]) -> [f64; N] {
        if self.processes == Processes::One {
            return own;
        }
        let all = self.gathered(own.to_vec());
        let both = |a: [f64; N], b: &[f64; N]| std::array::from_fn(|i| larger(a[i], b[i]));
        all.as_chunks::<N>().0.iter().fold([0.0; N], both)
    }
}
