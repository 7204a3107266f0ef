//! What there is at the points of a grid.

use crate::error::Result;
use crate::friction::AnyLaw;
use crate::model::Loading;
use rand_chacha::ChaCha8Rng;
use rand_chacha::rand_core::{Rng, SeedableRng};
use std::fmt::Debug;

/// Two equal interfaces by the values of the parameters that vary.
pub trait LawPoints: Debug + Send + Sync {
    /// What rows tell of a point, dimensionless: V_H and K, then the other parameters that vary.
    fn parameters(&self, values: &[f64]) -> Vec<f64>;

    /// The law of both, and their loading.
    ///
    /// # Errors
    /// [`crate::Error::Parameter`] for values outside their domain.
    fn at(&self, values: &[f64]) -> Result<(AnyLaw, Loading)>;
}

/// A stream of random numbers that follows from a seed and the number of a point alone: the generator counts, and each point has
/// a stream of its own.
#[derive(Debug)]
pub struct RandomStart(ChaCha8Rng);

impl RandomStart {
    /// The stream of this point.
    pub fn new(seed: u64, number: usize) -> Self {
        let mut generator = ChaCha8Rng::seed_from_u64(seed);
        generator.set_stream(number as u64);
        RandomStart(generator)
    }

    /// The same stream behind so many numbers.
    #[must_use]
    pub fn after(mut self, numbers: usize) -> Self {
        // a number is two words of the generator
        self.0.set_word_pos(2 * numbers as u128);
        self
    }

    /// The next number, equally likely anywhere between two.
    pub fn between(&mut self, (low, high): (f64, f64)) -> f64 {
        let part = (self.0.next_u64() >> 11) as f64 / (1_u64 << 53) as f64;
        low + part * (high - low)
    }
}
