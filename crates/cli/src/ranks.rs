//! Joining the ranks that mpirun has started, and what they tell each other: few numbers, from all to all.

use mpi::datatype::PartitionMut;
use mpi::environment::Universe;
use mpi::topology::SimpleCommunicator;
use mpi::traits::{Communicator, CommunicatorCollectives, Root};
use twinslip::error::{Error, Result};
use twinslip::many::Gather;

/// This process among others. MPI ends when it is dropped.
pub struct Joined(Universe);

impl Joined {
    /// The ranks that mpirun has started; `None` without mpirun, and if there is just this one.
    ///
    /// # Errors
    /// [`Error::Input`] if MPI does not start.
    pub fn join() -> Result<Option<Self>> {
        let started = ["OMPI_COMM_WORLD_SIZE", "PMIX_RANK", "PMI_RANK", "PMI_SIZE"];
        if !started.iter().any(|name| std::env::var_os(name).is_some()) {
            return Ok(None);
        }
        let universe = mpi::initialize()
            .ok_or_else(|| Error::Input("MPI is installed but does not start".into()))?;
        if universe.world().size() < 2 {
            return Ok(None);
        }
        // A rank that only unwinds would leave the others waiting.
        let told = std::panic::take_hook();
        std::panic::set_hook(Box::new(move |panic| {
            told(panic);
            std::process::abort();
        }));
        Ok(Some(Joined(universe)))
    }

    /// All ranks.
    pub fn world(&self) -> SimpleCommunicator {
        self.0.world()
    }
}

/// The ranks of MPI, which has been started.
#[derive(Debug)]
pub struct Ranks;

impl Gather for Ranks {
    fn place(&self) -> (usize, usize) {
        let world = SimpleCommunicator::world();
        (world.rank() as usize, world.size() as usize)
    }

    fn gathered(&self, own: &[f64], count: &dyn Fn(usize) -> usize) -> Vec<f64> {
        let world = SimpleCommunicator::world();
        let (counts, places) = parts(&world, count);
        let mut all = vec![0.0; counts.iter().sum::<i32>() as usize];
        let mut partition = PartitionMut::new(&mut all[..], counts, places);
        world.all_gather_varcount_into(own, &mut partition);
        all
    }

    fn gathered_at_first(&self, own: &[f64], count: &dyn Fn(usize) -> usize) -> Vec<f64> {
        let world = SimpleCommunicator::world();
        let first = world.process_at_rank(0);
        if world.rank() != 0 {
            first.gather_varcount_into(own);
            return Vec::new();
        }
        let (counts, places) = parts(&world, count);
        let mut all = vec![0.0; counts.iter().sum::<i32>() as usize];
        let mut partition = PartitionMut::new(&mut all[..], counts, places);
        first.gather_varcount_into_root(own, &mut partition);
        all
    }
}

/// How many numbers each rank has, and where they begin.
fn parts(world: &SimpleCommunicator, count: &dyn Fn(usize) -> usize) -> (Vec<i32>, Vec<i32>) {
    let counts: Vec<i32> = (0..world.size() as usize)
        .map(|rank| count(rank) as i32)
        .collect();
    let places = { counts.iter() }.scan(0, |sum, count| {
        let place = *sum;
        *sum += count;
        Some(place)
    });
    let places = places.collect();
    (counts, places)
}
