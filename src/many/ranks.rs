//! What the ranks of MPI tell each other: few numbers, from all to all.

use mpi::datatype::PartitionMut;
use mpi::topology::SimpleCommunicator;
use mpi::traits::{Communicator, CommunicatorCollectives, Root};

/// The number of this rank, and how many there are.
pub(super) fn place() -> (usize, usize) {
    let world = SimpleCommunicator::world();
    (world.rank() as usize, world.size() as usize)
}

/// The numbers of all ranks in their order, at the first rank; none at the others.
pub(super) fn gathered_at_first(own: &[f64], count: impl Fn(usize) -> usize) -> Vec<f64> {
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

/// How many numbers each rank has, and where they begin.
fn parts(world: &SimpleCommunicator, count: impl Fn(usize) -> usize) -> (Vec<i32>, Vec<i32>) {
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

/// The numbers of all ranks in their order; a rank has so many.
pub(super) fn gathered(own: &[f64], count: impl Fn(usize) -> usize) -> Vec<f64> {
    let world = SimpleCommunicator::world();
    let (counts, places) = parts(&world, count);
    let mut all = vec![0.0; counts.iter().sum::<i32>() as usize];
    let mut partition = PartitionMut::new(&mut all[..], counts, places);
    world.all_gather_varcount_into(own, &mut partition);
    all
}
