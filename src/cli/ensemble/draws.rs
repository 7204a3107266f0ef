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

#[cfg(test)]
mod test {
    use super::*;

    #[test]
    fn they_have_the_moments_of_a_normal_distribution() {
        let all: Vec<f64> = (0..20_000).map(|draw| normal(draw, 2)[1]).collect();
        let mean = |power: i32| all.iter().map(|x| x.powi(power)).sum::<f64>() / all.len() as f64;
        // Five standard errors of each: of x, x^2, x^3 and x^4, whose variances are 1, 2, 15 and 96.
        let bound = |variance: f64| 5.0 * (variance / all.len() as f64).sqrt();
        assert!(mean(1).abs() < bound(1.0));
        assert!((mean(2) - 1.0).abs() < bound(2.0));
        assert!(mean(3).abs() < bound(15.0));
        assert!((mean(4) - 3.0).abs() < bound(96.0));
    }
}
