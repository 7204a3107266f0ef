//! Flows: from a vector field and a state at one time to the state, and its tangent, at another.
//!
//! Everything above speaks to an integrator through [`Integrator`], or where the number of variables is known when the program runs
//! through [`AnyIntegrator`]. What a caller does not ask for is not done: with
//! no observer nothing is stored and no dense output is evaluated, and a tangent is only carried by [`Integrator::tangent_flow`].

mod any_field;
mod any_integrator;
mod any_step;
mod auto;
mod choice;
#[cfg(feature = "sundials")]
mod cvode;
mod motion_units;
mod radau;
pub(crate) mod rosenbrock;
pub(crate) mod singularity;
mod static_field;
mod tableau;
mod taylor;

pub use any_field::AnyField;
pub(crate) use any_field::{AnyExact, of_dimension};
pub use any_integrator::{AnyIntegrator, DerivativesAlongArcs, FlowDerivatives};
pub use any_step::{AnyObserver, AnyStep, StepSeries};
pub use auto::Auto;
pub use choice::{Choice, HasSeries};
#[cfg(feature = "sundials")]
pub use cvode::CvodeIntegrator;
pub use motion_units::MotionUnits;
pub use radau::Radau;
pub use rosenbrock::{Rosenbrock, RosenbrockMethod};
#[doc(hidden)]
pub use tableau::Tableau;
pub use taylor::{Batch, BatchObserver, BatchRun, Taylor};

pub use crate::contract::{MAX_STEPS, Tolerances, Work};
use crate::error::Result;
use crate::field::{Jacobian, State, VectorField};
use crate::number::DoubleDouble;
use crate::series::Expansion;
#[doc(hidden)]
pub use crate::series::{COMPILE, allowed_compiling, used_compiling};
pub use crate::series::{VECTORS, Vectors, allowed_vectors, used_vectors};
pub(crate) use singularity::{may_be_spike, step_underflow};
use std::ops::Deref;

/// One accepted step, as an observer sees it.
#[non_exhaustive]
pub struct Step<'a, const N: usize> {
    /// Time and state at the beginning.
    pub t0: f64,
    /// State at `t0`.
    pub y0: &'a State<N>,
    /// Time at the end.
    pub t1: f64,
    /// State at `t1`.
    pub y1: &'a State<N>,
    /// `t0` in 31 digits. Steps may be shorter than the spacing of the doubles around `t0`.
    pub begin: DoubleDouble,
    /// The time from the beginning to the end, signed.
    pub length: f64,
    /// [`Step::after`]
    pub(crate) continuous: &'a dyn Fn(f64) -> State<N>,
    /// A bound on how far the first component strays from its value at `t0`, of methods to which it costs nothing; else
    /// infinity.
    pub reach: f64,
    /// The series at `t0`, of methods that step by one; made only when asked for.
    pub(crate) expansion: Option<&'a dyn Deref<Target = &'a Expansion<N>>>,
    /// [`Step::slips`]
    pub(crate) slips: Option<&'a dyn Fn() -> Option<[DoubleDouble; 2]>>,
}

impl<'a, const N: usize> Step<'a, N> {
    /// The continuous solution so long after the beginning, from 0 to `length`; evaluated only when called.
    pub fn after(&self, time: f64) -> State<N> {
        (self.continuous)(time)
    }

    /// The same at a time, as near to it as this step comes.
    pub fn dense(&self, t: f64) -> State<N> {
        self.after(self.since_begin(t))
    }

    /// The time from the beginning to this time, within the step. Its end is known better than to the rounding of the time.
    pub fn since_begin(&self, t: f64) -> f64 {
        since((self.begin, self.t1, self.length), t)
    }

    /// The series at `t0`, of methods that step by one.
    pub fn series(&self) -> Option<&'a Expansion<N>> {
        self.expansion.map(|made| **made)
    }

    /// The slips of both interfaces since the step that was seen before, of methods that have them without all of the series.
    pub fn slips(&self) -> Option<[DoubleDouble; 2]> {
        self.slips.and_then(|slips| slips())
    }
}

/// [`Step::since_begin`] of a step with this beginning, end and length.
fn since((begin, end, length): (DoubleDouble, f64, f64), t: f64) -> f64 {
    if t == end {
        return length;
    }
    let time = (DoubleDouble::from(t) - begin).hi();
    time.clamp(length.min(0.0), length.max(0.0))
}

/// Whether to go on after a step.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Control {
    /// Go on.
    Continue,
    /// Stop here: the flow returns the state at the end of this step.
    Stop,
    /// Go on; so many steps need not be seen, as long as the last one is and none of their slips is lost. A method may show them all
    /// the same.
    Rest(u32),
}

/// Sees every accepted step; an error from it ends the flow.
pub type Observer<'a, const N: usize> = &'a mut dyn FnMut(&Step<'_, N>) -> Result<Control>;

/// A method that integrates dy/dt = f(y).
pub trait Integrator<const N: usize> {
    /// The name by which the command line knows the method.
    fn name(&self) -> &'static str;

    /// The state at `t.1` from `y0` at `t.0`; backwards in time if `t.1 < t.0`.
    ///
    /// # Errors
    /// [`StepTooSmall`](crate::Error::StepTooSmall), [`BlowUp`](crate::Error::BlowUp),
    /// [`TooFast`](crate::Error::TooFast),
    /// [`TooManySteps`](crate::Error::TooManySteps), [`NonFinite`](crate::Error::NonFinite) (at the start), those of
    /// SUNDIALS, and those of the observer. Never returns a state that is not finite.
    fn flow(
        &mut self,
        field: &dyn VectorField<N>,
        t: (f64, f64),
        y0: &State<N>,
        observer: Option<Observer<'_, N>>,
    ) -> Result<State<N>>;

    /// The state at `t.1` and the tangent flow dy(t.1)/dy(t.0), with the tangent inside the error test.
    fn tangent_flow(
        &mut self,
        field: &dyn VectorField<N>,
        t: (f64, f64),
        y0: &State<N>,
    ) -> Result<(State<N>, Jacobian<N>)>;

    /// The work of the last call, finished or failed.
    fn work(&self) -> Work;
}
