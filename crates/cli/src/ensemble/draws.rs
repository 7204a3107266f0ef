//! Normally distributed numbers, from a seed.

use nalgebra::DVector;
use twinslip::random::Random;

/// The seed of all ensembles: the same command gives the same rows.
pub const SEED: u64 = 1;

/// Independent standard normal numbers for a draw, which follow from its number alone.
pub fn normal(draw: usize, count: usize) -> DVector<f64> {
    let mut random = Random::new(SEED, draw);
    DVector::from_fn(count, |_, _| random.normal())
}
