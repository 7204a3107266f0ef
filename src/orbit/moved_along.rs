//! Predicted nodes moved along the flow, which changes no orbit: so that durations change by about the same parts.
//!
//! A node on a slow motion stands in a plane that is fixed in space, and where the slow motion ends soon after it, as at a fold, it may end
//! much sooner or later, in parts of that arc's duration, on the next orbit. The node had better stay as far from the end as it was.

use super::continuation_point::ContinuationPoint;
use super::spread::extents;
use crate::field::{Matrix, Vector};

/// What a node moved by all of the extents counts beside an arc that lasts twice as long, or no time.
const FAR: f64 = 10.0;

impl ContinuationPoint {
    /// This prediction from an orbit with its nodes moved along the flow, which is known at the nodes of the orbit: the sum of the squares of
    /// the relative changes of durations, and of the ways that the nodes are moved, is as small as can be.
    pub(super) fn moved_along(mut self, orbit: &Self, flows: &[Vector]) -> Self {
        let count = flows.len();
        let extents = extents(orbit.shooting.nodes.iter());
        let durations = &orbit.shooting.durations;
        // The times t_k minimise sum ((change_k + t_(k+1) - t_k) / T_k)^2 + sum (way_k t_k)^2.
        let mut matrix = Matrix::zeros(count, count);
        let mut right = Vector::zeros(count);
        for (k, &duration) in durations.iter().enumerate() {
            let next = (k + 1) % count;
            let weight = duration.powi(-2);
            let change = self.shooting.durations[k] - duration;
            for (row, column, sign) in [
                (k, k, 1.0),
                (next, next, 1.0),
                (k, next, -1.0),
                (next, k, -1.0),
            ] {
                matrix[(row, column)] += sign * weight;
            }
            right[k] += weight * change;
            right[next] -= weight * change;
            let speed = FAR * flows[k].component_div(&extents).amax();
            matrix[(k, k)] += speed * speed;
        }
        let Some(factors) = matrix.cholesky() else {
            return self;
        };
        factors.solve_mut(&mut right);
        if !right.iter().all(|t| t.is_finite()) {
            return self;
        }
        for (k, flow) in flows.iter().enumerate() {
            self.shooting.nodes[k].axpy(right[k], flow, 1.0);
            self.shooting.durations[k] += right[(k + 1) % count] - right[k];
        }
        self
    }
}
