//! Which method integrates along an orbit: Taylor's, or an implicit one where strong damping would hold its steps short.

use super::arc::Tracer;
use super::shooting_nodes::ShootingNodes;
use crate::error::Result;
use crate::field::Vector;
use crate::integrate::{AnyField, Choice};
use crate::number::eigenvalues;

/// The fastest decay rate, integrated over a period, above which the implicit method takes less time. Stability bounds the product of this rate and
/// a Taylor step by a few units; a Taylor step takes a hundredth of the time of an implicit one, of which an orbit needs some hundreds.
const STIFF: f64 = 2e5;
/// Of the larger rate at the two ends of an arc: at one of them, just behind a fold of a slow manifold, nothing may decay at all.
const LEAST_DECAY: f64 = 1e-3;
/// The least tolerance of the implicit method: below it rounding is the larger error.
const LEAST: f64 = 1e-13;

/// The method for this orbit.
pub fn method_for(field: &AnyField<'_>, orbit: &ShootingNodes) -> Choice {
    let nodes = || orbit.nodes.iter().zip(&orbit.durations);
    // No eigenvalue is larger than the largest sum of a row.
    let at_most = |(x, duration): (_, &f64)| {
        let rows = field.jacobian(x);
        let sums = rows.row_iter().map(|row| row.abs().sum());
        duration.abs() * sums.fold(0.0, f64::max)
    };
    if nodes().map(at_most).sum::<f64>() < STIFF {
        return Choice::Taylor;
    }
    let decay = |x: &Vector| {
        let rates = eigenvalues(&field.jacobian(x)).into_iter().flatten();
        let sign = orbit.period().signum();
        rates.fold(0.0, |most, rate| f64::max(most, -sign * rate.re))
    };
    let decays: Vec<f64> = orbit.nodes.iter().map(decay).collect();
    // Of both ends of an arc the mean on a logarithmic scale: what decays fast at a peak does not do so all along the arc.
    let next = decays.iter().cycle().skip(1);
    let arcs = decays.iter().zip(next).zip(&orbit.durations);
    let mean = |a: f64, b: f64| (a.max(b) * a.min(b).max(LEAST_DECAY * a.max(b))).sqrt();
    let all: f64 = arcs.map(|((a, b), t)| mean(*a, *b) * t.abs()).sum();
    match all < STIFF {
        true => Choice::Taylor,
        false => Choice::Radau,
    }
}

impl Tracer {
    /// By the method for an orbit, with this tolerance, for no more than so many steps in an arc and about so many in all.
    ///
    /// # Errors
    /// [`crate::Error::Parameter`] for a tolerance outside its domain.
    pub(crate) fn for_orbit(
        method: Choice,
        tolerance: f64,
        (arc, all): (usize, usize),
    ) -> Result<Self> {
        let tolerance = match method {
            Choice::Radau => tolerance.max(LEAST),
            _ => tolerance,
        };
        Self::limited_by(method, tolerance, arc, all)
    }
}
