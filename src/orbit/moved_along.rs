//! Predicted nodes are moved along the flow, so that the relative changes of the arcs' durations are small. Moving a node along the flow changes no
//! orbit.
//!
//! Without this a node keeps its plane in space while the orbit changes. Where a slow motion ends soon after the node, as at a fold of a slow manifold,
//! the duration of the arc from the node to the end then changes by a large factor in a small step.

use super::continuation_point::ContinuationPoint;
use super::spread::extents;
use crate::field::{Matrix, Vector};

/// Weight of a node's motion, as a part of the orbit's extents, beside the relative change of a duration.
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
