//! What the ranks of MPI tell each other: few numbers, from all to all.

use mpi::datatype::PartitionMut;
use mpi::topology::SimpleCommunicator;
use mpi::traits::{Communicator, CommunicatorCollectives};

/// The number of this rank, and how many there are.
pub(super) fn place() -> (usize, usize) {
    let world = SimpleCommunicator::world();
    (world.rank() as usize, world.size() as usize)
}

/// The numbers of all ranks in their order; a rank has so many.
pub(super) fn gathered(own: &[f64], count: impl Fn(usize) -> usize) -> Vec<f64> {
    let world = SimpleCommunicator::world();
    let counts: Vec<i32> = (0..world.size() as usize)
        .map(|rank| count(rank) as i32)
        .collect();
    let places: Vec<i32> = { counts.iter() }
        .scan(0, |sum, count| {
            let place = *sum;
            *sum += count;
            Some(place)
        })
        .collect();
    let mut all = vec![0.0; counts.iter().sum::<i32>() as usize];
    let mut parts = PartitionMut::new(&mut all[..], counts, places);
    world.all_gather_varcount_into(own, &mut parts);
    all
}
