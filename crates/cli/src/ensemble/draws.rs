//! Normally distributed numbers, from a seed.

use nalgebra::DVector;
use rand_chacha::ChaCha8Rng;
use rand_chacha::rand_core::{Rng, SeedableRng};

/// The seed of all ensembles: the same command gives the same rows.
pub const SEED: u64 = 1;

/// Independent standard normal numbers for a draw, which follow from its number alone.
pub fn normal(draw: usize, count: usize) -> DVector<f64> {
    let mut generator = ChaCha8Rng::seed_from_u64(SEED);
    generator.set_stream(draw as u64);
    // In (0, 1]: it has a logarithm.
    let mut uniform = || ((generator.next_u64() >> 11) + 1) as f64 / (1_u64 << 53) as f64;
    // Box and Muller (1958).
    let mut one = || {
        let radius = (-2.0 * uniform().ln()).sqrt();
        radius * (std::f64::consts::TAU * uniform()).cos()
    };
    DVector::from_fn(count, |_, _| one())
}
