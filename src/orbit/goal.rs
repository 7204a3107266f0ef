//! When Newton's method for a periodic orbit ends.

/// When Newton's method has converged, and when it is given up.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Goal {
    /// The size of a correction that is the last. It is made, and the error left is of the order of its square.
    pub done: f64,
    /// Iterations, at most.
    pub iterations: usize,
    /// The largest correction.
    pub largest: f64,
}

impl Goal {
    /// For the steps of a continuation.
    pub const STEP: Goal = Goal {
        done: 1e-6,
        iterations: 12,
        largest: 1.0,
    };
    /// To the last digits.
    pub const SHARP: Goal = Goal {
        done: 2e-14,
        iterations: 20,
        largest: 1.0,
    };
}
