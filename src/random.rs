//! Random numbers that follow from a seed.

use rand_chacha::ChaCha8Rng;
use rand_chacha::rand_core::{Rng, SeedableRng};

/// Numbers of 53 bits.
const NUMBERS: f64 = (1_u64 << 53) as f64;

/// A stream of random numbers that follows from a seed and its own number alone: the generator counts, and each number has a stream of its own.
#[derive(Debug)]
pub struct Random(ChaCha8Rng);

impl Random {
    /// The stream of this number.
    pub fn new(seed: u64, number: usize) -> Self {
        let mut generator = ChaCha8Rng::seed_from_u64(seed);
        generator.set_stream(number as u64);
        Random(generator)
    }

    /// The same stream behind so many numbers.
    #[must_use]
    pub fn after(mut self, numbers: usize) -> Self {
        // a number is two words of the generator
        self.0.set_word_pos(2 * numbers as u128);
        self
    }

    fn bits(&mut self) -> f64 {
        (self.0.next_u64() >> 11) as f64
    }

    /// The next number, equally likely anywhere in [0, 1).
    pub fn uniform(&mut self) -> f64 {
        self.bits() / NUMBERS
    }

    /// The next number, equally likely anywhere between two.
    pub fn between(&mut self, (low, high): (f64, f64)) -> f64 {
        low + self.uniform() * (high - low)
    }

    /// The next standard normal number (Box and Muller 1958), of two.
    pub fn normal(&mut self) -> f64 {
        // In (0, 1]: it has a logarithm.
        let mut part = || (self.bits() + 1.0) / NUMBERS;
        let radius = (-2.0 * part().ln()).sqrt();
        radius * (std::f64::consts::TAU * part()).cos()
    }
}
