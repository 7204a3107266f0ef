//! What is fitted: a slider on a spring, with one state variable or two.

use crate::error::Result;
use crate::field::{State, VectorField};
use crate::model::{Slider, Smooth};

/// A family of sliders that differ by parameters: the friction coefficient is the first of the N variables, V/V* the last.
pub trait Sliders<const N: usize>: Sync {
    /// The names of the parameters.
    fn names(&self) -> Vec<&'static str>;

    /// V* in m/s.
    fn reference_rate(&self) -> f64;

    /// The equations at these parameters, the load point being accelerated by so many V* per second.
    ///
    /// # Errors
    /// [`crate::Error::Parameter`] for a value outside its domain.
    fn field(&self, parameters: &[f64], acceleration: f64) -> Result<Box<dyn VectorField<N> + '_>>;

    /// Steady sliding at v V*.
    ///
    /// # Errors
    /// Those of [`Sliders::field`]; [`crate::Error::NotConverged`] where there is none.
    fn steady(&self, parameters: &[f64], v: f64) -> Result<State<N>>;
}

/// Built-in laws.
macro_rules! built_in {
    ($n:literal, $steady:ident) => {
        impl Sliders<$n> for Slider {
            fn names(&self) -> Vec<&'static str> {
                Slider::NAMES.to_vec()
            }

            fn reference_rate(&self) -> f64 {
                self.reference_rate
            }

            fn field(
                &self,
                parameters: &[f64],
                acceleration: f64,
            ) -> Result<Box<dyn VectorField<$n> + '_>> {
                Ok(Box::new(Smooth {
                    equations: Slider {
                        acceleration,
                        ..*self
                    },
                    parameters: all(parameters),
                }))
            }

            fn steady(&self, parameters: &[f64], v: f64) -> Result<State<$n>> {
                Ok(self.$steady(all(parameters), v))
            }
        }
    };
}
built_in!(3, steady_one);
built_in!(4, steady_two);

fn all(parameters: &[f64]) -> [f64; Slider::NAMES.len()] {
    std::array::from_fn(|i| parameters[i])
}

/// A stretch of constant acceleration of the load point.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Stretch {
    /// When it begins and ends, in s.
    pub span: (f64, f64),
    /// The velocity of the load point at both, in m/s.
    pub velocity: (f64, f64),
}

/// How the load point moves: one stretch after the other, without gaps.
#[derive(Debug, Clone, PartialEq)]
pub struct Motion {
    /// The steady velocity before it, at which all begins, in m/s.
    pub before: f64,
    /// The stretches, at least one.
    pub stretches: Vec<Stretch>,
}

impl Motion {
    /// How far the load point has moved at these times, which ascend, since the beginning, in m.
    pub fn displacement(&self, times: &[f64]) -> Vec<f64> {
        let mut moved = 0.0;
        let mut stretches = self.stretches.iter().peekable();
        let mut of = |t: f64| {
            while let Some(Stretch { span, velocity }) = stretches.next_if(|s| s.span.1 < t) {
                moved += 0.5 * (velocity.0 + velocity.1) * (span.1 - span.0);
            }
            stretches
                .peek()
                .map_or(moved, |Stretch { span, velocity }| {
                    let (since, lasts) = (t - span.0, span.1 - span.0);
                    let gained = (velocity.1 - velocity.0) * since / lasts;
                    moved + (velocity.0 + 0.5 * gained) * since
                })
        };
        times.iter().map(|&t| of(t)).collect()
    }
}
