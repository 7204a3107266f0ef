//! A sweep over the ranks of MPI: the first hands out units and writes rows in their order, the others compute.
//!
//! Each of the others asks for work by sending the rows of the last, none at first; the answer is what to compute next, or
//! nothing when all is done. A rank that dies ends the run, as MPI has it; what is written stays.

use super::wire;
use crate::ranks::Joined;
use mpi::topology::SimpleCommunicator;
use mpi::traits::{Communicator, Destination, Source};
use std::collections::BTreeMap;
use std::ops::ControlFlow;
use std::sync::atomic::{AtomicBool, Ordering};
use std::time::Duration;
use twinslip::error::{Error, Result};
use twinslip::sweep::{SweepRow, SweepSettings, Sweeper, UnitShare};
use twinslip_tasks::scene::SweepPlan;

/// Points handed out at once: so many that lanes are seldom empty.
const CHUNK: usize = 512;
/// Chunks for each rank, where there are not enough for full ones.
const SHARES: usize = 4;
/// Chunks that may be done before one that they must wait for, for each rank.
const AHEAD: usize = 8;
/// Between two looks for rows that have come.
const PAUSE: Duration = Duration::from_micros(200);

/// This process among others.
pub struct Ranks {
    world: SimpleCommunicator,
    /// Of the other ranks those that wait for an answer.
    idle: Vec<i32>,
    // Ends MPI when it is dropped, after all else.
    _joined: Joined,
}

impl Ranks {
    /// The ranks that mpirun has started; `None` without mpirun, and if there is just this one.
    ///
    /// # Errors
    /// [`Error::Input`] if MPI does not start.
    pub fn join() -> Result<Option<Self>> {
        Ok(Joined::join()?.map(|joined| Ranks {
            world: joined.world(),
            idle: Vec::new(),
            _joined: joined,
        }))
    }

    /// Whether this rank hands out and writes.
    pub fn leads(&self) -> bool {
        self.world.rank() == 0
    }

    /// Computes what the first rank asks for, until it asks for nothing. Without a plan it never does: it has none either.
    pub fn serve(&self, plan: Option<&SweepPlan>) {
        let leader = self.world.process_at_rank(0);
        let mut sweeper = plan.and_then(|plan| Sweeper::new(&plan.settings).ok());
        let mut rows = Vec::new();
        loop {
            leader.send(&wire::pack(&rows)[..]);
            rows.clear();
            let (task, _) = leader.receive_vec::<u64>();
            let (Some(sweeper), &[first, every, count]) = (&mut sweeper, &task[..]) else {
                return;
            };
            let units = (0..count).map(|n| (first + n * every) as usize);
            sweeper.rows(units, &mut rows);
        }
    }

    /// As [`twinslip::sweep::run`].
    pub fn run(
        &mut self,
        settings: &SweepSettings,
        units: UnitShare,
        stop: &AtomicBool,
        seen: &mut dyn FnMut(&[SweepRow]) -> ControlFlow<()>,
    ) -> Result<()> {
        let others = self.world.size() as usize - 1;
        let all = settings.units().saturating_sub(units.first);
        let all = all.div_ceil(units.every);
        let full = CHUNK.div_ceil(settings.points_per_unit());
        let size = full.min(all.div_ceil(SHARES * others)).max(1);
        let chunks = all.div_ceil(size);
        let (mut given, mut next) = (0, 0);
        let mut at_work = BTreeMap::new();
        let mut waiting: BTreeMap<usize, Vec<SweepRow>> = BTreeMap::new();
        while next < chunks {
            while given < chunks.min(next + AHEAD * others) {
                let Some(rank) = self.idle.pop() else { break };
                let begin = given * size;
                let count = size.min(all - begin);
                let first = units.first + begin * units.every;
                let task = [first, units.every, count].map(|n| n as u64);
                self.world.process_at_rank(rank).send(&task[..]);
                at_work.insert(rank, given);
                given += 1;
            }
            let Some((rank, bytes)) = self.answer(stop) else {
                return Ok(());
            };
            self.idle.push(rank);
            let Some(index) = at_work.remove(&rank) else {
                continue;
            };
            let rows = wire::unpack(&bytes)
                .ok_or_else(|| Error::Input(format!("rank {rank} sent no rows")))?;
            waiting.insert(index, rows);
            while let Some(rows) = waiting.remove(&next) {
                if seen(&rows).is_break() {
                    return Ok(());
                }
                next += 1;
            }
        }
        Ok(())
    }

    /// What some other rank sends next; `None` when the sweep is to stop.
    fn answer(&self, stop: &AtomicBool) -> Option<(i32, Vec<u8>)> {
        loop {
            if stop.load(Ordering::Relaxed) {
                return None;
            }
            if let Some(status) = self.world.any_process().immediate_probe() {
                let rank = status.source_rank();
                let (bytes, _) = self.world.process_at_rank(rank).receive_vec::<u8>();
                return Some((rank, bytes));
            }
            // This rank may share its processor with one that computes.
            std::thread::sleep(PAUSE);
        }
    }

    /// Tells the others that all is done, once they have finished what they are at.
    pub fn dismiss(&mut self) {
        for rank in 1..self.world.size() {
            let other = self.world.process_at_rank(rank);
            if !self.idle.contains(&rank) {
                drop(other.receive_vec::<u8>());
            }
            other.send(&[0u64; 0][..]);
        }
    }
}
