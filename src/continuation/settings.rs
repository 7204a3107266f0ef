//! How far, how fine and how exactly a curve is followed, checked.

use crate::error::{Error, Result};

/// Limits of the steps, range of lambda, values to land on. All lengths are in the units of (u, lambda).
#[derive(Debug, Clone, PartialEq)]
pub struct Settings {
    /// The first step.
    pub first_step: f64,
    /// Below this the curve is given up.
    pub shortest_step: f64,
    /// Never longer.
    pub longest_step: f64,
    /// The tangent turns by no more than this in a step, in radians.
    pub largest_turn: f64,
    /// Points, special ones not counted.
    pub max_points: usize,
    /// A Newton correction relative to 1 + |(u, lambda)| that is small enough; where rounding stops the corrections before,
    /// ten thousand times this is accepted.
    pub tolerance: f64,
    /// lambda from, to.
    pub range: (f64, f64),
    /// Values of lambda to land on.
    pub wanted: Vec<f64>,
    /// Where the unknowns are larger than this the longest step grows with the square of their norm: the curve comes to infinity in a finite number of steps.
    pub size: f64,
}

impl Settings {
    /// Steps up to `longest_step` over this range, everything else as it usually suits.
    ///
    /// # Errors
    /// [`Error::Parameter`] unless the step is positive and the range not empty.
    pub fn new(range: (f64, f64), longest_step: f64) -> Result<Self> {
        Settings {
            first_step: 0.1 * longest_step,
            shortest_step: 1e-9 * longest_step.min(1.0),
            longest_step,
            largest_turn: 0.3,
            max_points: 100_000,
            tolerance: 1e-13,
            range,
            wanted: Vec::new(),
            size: f64::INFINITY,
        }
        .checked()
    }

    /// The same, if it makes sense.
    ///
    /// # Errors
    /// [`Error::Parameter`] that names what doesn't.
    pub fn checked(self) -> Result<Self> {
        let positive = |name: &'static str, x: f64| {
            if x > 0.0 && x.is_finite() {
                Ok(())
            } else {
                Err(Error::parameter(name, x, "positive and finite"))
            }
        };
        positive("longest step", self.longest_step)?;
        positive("shortest step", self.shortest_step)?;
        positive("first step", self.first_step)?;
        positive("tolerance", self.tolerance)?;
        positive("largest turn", self.largest_turn)?;
        if self.shortest_step > self.first_step || self.first_step > self.longest_step {
            return Err(Error::parameter(
                "first step",
                self.first_step,
                "between the shortest and the longest step",
            ));
        }
        let (from, to) = self.range;
        // NaN fails too
        let forward = from < to && from.is_finite() && to.is_finite();
        if !forward {
            return Err(Error::parameter(
                "range",
                format!("{from} to {to}"),
                "finite and ascending",
            ));
        }
        if let Some(x) = self.wanted.iter().find(|x| !x.is_finite()) {
            return Err(Error::parameter("wanted value", x, "finite"));
        }
        Ok(self)
    }
}
