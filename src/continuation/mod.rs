//! Pseudo-arclength continuation (Keller 1977) of anything that is a curve of solutions: one step control, one detection of
//! zeros, one landing on them.
//!
//! [`Continuation`] follows what implements [`SolutionCurve`]; it knows neither equilibria nor orbits. The step is measured along
//! the tangent of the point that it starts from, so that folds are passed like any other point, and the direction is kept.
//! Along the curve [`WatchedFunction`]s are watched; their zeros are located on the way. An early end is a [`Stop`] and no error.
//!
//! Here too are the curves of zeros (u, lambda) of N equations G(u, lambda) = 0, [`follow()`]. All their matrices are dense, so N
//! should be small.
//!
//! Limits: what branches off is not followed, and two sign changes within one step are found only if a cubic through the values
//! and slopes at both ends shows them.

mod correct;
mod curve;
mod detect;
mod driver;
mod land;
mod settings;
mod stop;
mod zero_curve;
mod zero_problem;

use curve::Watched;
pub use curve::{CurveStep, SolutionCurve, WatchedFunction};
pub use driver::{Continuation, Met, MetObserver, StepControl};
pub(crate) use land::changes_sign;
pub use settings::Settings;
pub use stop::Stop;
pub use zero_curve::follow;
pub use zero_problem::{Branch, CurveObserver, CurvePoint, PointKind, Start, ZeroProblem};
