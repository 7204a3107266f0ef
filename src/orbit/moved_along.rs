//! Predicted nodes are moved along the flow, so that the relative changes of the arcs' durations are small. Moving a node along the flow changes no
//! orbit.
//!
//! Without this a node keeps its plane in space while the orbit changes. Where a slow motion ends soon after the node, as at a fold of a slow manifold,
//! the duration of the arc from the node to the end then changes by a large factor in a small step.

use super::continuation_point::ContinuationPoint;
use super::spread::extents;
use crate::field::Vector;

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
        let mut diagonal = vec![0.0; count];
        let mut beside = vec![0.0; count];
        let mut right = vec![0.0; count];
        for (k, &duration) in durations.iter().enumerate() {
            let next = (k + 1) % count;
            let weight = duration.powi(-2);
            let change = self.shooting.durations[k] - duration;
            diagonal[k] += weight;
            diagonal[next] += weight;
            beside[k] = -weight;
            right[k] += weight * change;
            right[next] -= weight * change;
            let speed = FAR * flows[k].component_div(&extents).amax();
            diagonal[k] += speed * speed;
        }
        let times = solve_around(&diagonal, &beside, &right);
        if !times.iter().all(|t| t.is_finite()) {
            return self;
        }
        for (k, flow) in flows.iter().enumerate() {
            self.shooting.nodes[k].axpy(times[k], flow, 1.0);
            self.shooting.durations[k] += times[(k + 1) % count] - times[k];
        }
        self
    }
}

/// The solution of symmetric positive definite equations in which each unknown meets the next one alone, and the last one the first: `beside[k]` is between k and
/// k + 1. The last unknown is eliminated last.
fn solve_around(diagonal: &[f64], beside: &[f64], right: &[f64]) -> Vec<f64> {
    let last = diagonal.len() - 1;
    // What the last unknown is multiplied by in the equations of the others.
    let mut column = vec![0.0; last];
    if last == 0 {
        return vec![right[0] / (diagonal[0] + 2.0 * beside[0])];
    }
    column[0] += beside[last];
    column[last - 1] += beside[last - 1];
    // Of the others, the solutions for their right-hand sides and for that column.
    let (mut pivots, mut known, mut of_last) =
        (diagonal.to_vec(), right[..last].to_vec(), column.clone());
    for k in 1..last {
        let part = beside[k - 1] / pivots[k - 1];
        pivots[k] -= part * beside[k - 1];
        known[k] -= part * known[k - 1];
        of_last[k] -= part * of_last[k - 1];
    }
    for k in (0..last).rev() {
        let (next, next_of_last) = match k + 1 < last {
            true => (beside[k] * known[k + 1], beside[k] * of_last[k + 1]),
            false => (0.0, 0.0),
        };
        known[k] = (known[k] - next) / pivots[k];
        of_last[k] = (of_last[k] - next_of_last) / pivots[k];
    }
    let product = |all: &[f64]| -> f64 { column.iter().zip(all).map(|(a, b)| a * b).sum() };
    let end = (right[last] - product(&known)) / (diagonal[last] - product(&of_last));
    let others = known.iter().zip(&of_last);
    let mut solution: Vec<f64> = others
        .map(|(known, of_last)| known - of_last * end)
        .collect();
    solution.push(end);
    solution
}

#[cfg(test)]
mod tests {
    use super::solve_around;
    use crate::field::{Matrix, Vector};

    #[test]
    fn a_ring_is_solved_as_its_matrix_is() {
        for count in [1, 2, 3, 7] {
            let beside: Vec<f64> = (0..count).map(|k| -1.0 / (k as f64 + 0.7)).collect();
            let right: Vec<f64> = (0..count).map(|k| (k as f64).sin() + 0.2).collect();
            let mut matrix = Matrix::zeros(count, count);
            for (k, beside) in beside.iter().enumerate() {
                let next = (k + 1) % count;
                matrix[(k, k)] += 0.01 - beside;
                matrix[(next, next)] -= beside;
                matrix[(k, next)] += beside;
                matrix[(next, k)] += beside;
            }
            let diagonal: Vec<f64> = (0..count)
                .map(|k| 0.01 - beside[k] - beside[(k + count - 1) % count])
                .collect();
            let found = Vector::from_vec(solve_around(&diagonal, &beside, &right));
            let off = matrix * &found - Vector::from_vec(right);
            assert!(off.amax() < 1e-12 * found.amax(), "{count}: {off}");
        }
    }
}
