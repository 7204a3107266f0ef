//! Why a curve was followed no further.

use crate::error::Error;
use std::fmt;

/// Why a curve was followed no further.
#[derive(Debug, Clone, PartialEq)]
pub enum Stop {
    /// lambda reached an end of its range.
    RangeEnd,
    /// The test function of this number, which ends the curve, is zero.
    Ended(usize),
    /// The curve is closed: it came back to its first point.
    Closed,
    /// As many points as allowed.
    MaxPoints(usize),
    /// The observer had seen enough.
    Observer,
    /// Newton's method fails, or the tangent turns, down to steps of this length.
    StepTooSmall {
        /// The length of the last step that was tried.
        length: f64,
        /// The error, if it was one and not that the tangent turned.
        because: Option<Error>,
    },
    /// Steps succeed, but lead nowhere.
    NoProgress {
        /// The number of the last steps.
        steps: usize,
        /// What they add up to.
        length: f64,
        /// The length of the whole way.
        travelled: f64,
    },
    /// For a reason of the curve's own.
    Failed(String),
}

impl fmt::Display for Stop {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Stop::RangeEnd => write!(f, "the range ends"),
            Stop::Ended(_) => write!(f, "the curve ends"),
            Stop::Closed => write!(f, "the curve is closed"),
            Stop::MaxPoints(most) => write!(f, "the limit of {most} points was reached"),
            Stop::Observer => write!(f, "no more was asked for"),
            Stop::StepTooSmall {
                length,
                because: None,
            } => write!(
                f,
                "Newton's method converges, but the direction of the curve changes at every point, down to steps of {length:.1e}: it is lost in the error of the points"
            ),
            Stop::StepTooSmall { length, .. } => write!(
                f,
                "Newton's method finds no further point, down to steps of {length:.1e}"
            ),
            Stop::NoProgress {
                steps,
                length,
                travelled,
            } => write!(
                f,
                "no progress: the last {steps} steps together have length {length:.1e}, the path before them {travelled:.1e}"
            ),
            Stop::Failed(why) => write!(f, "{why}"),
        }
    }
}
