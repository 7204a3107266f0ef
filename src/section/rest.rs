//! Equilibria that a run comes to: near ones, and those that it spirals into so slowly that it would take too long to wait.

use crate::field::Vector;
use crate::integrate::AnyField;
use crate::number::eigenvalues;

/// Newton's method from a spiral ends at this step, or fails.
const CONVERGED: f64 = 1e-10;
const ITERATIONS: usize = 20;
/// What a spiral has shrunk by between two windows, in the logarithm, lies between these parts of what the slowest eigenvalue
/// says.
const AS_SAID: std::ops::Range<f64> = 0.6..1.6;
/// A spiral that shrinks by less than this shows nothing.
const LEAST: f64 = 0.02;

/// The equilibrium within `distance` of a state in every component, by a step of Newton's method, and whether it is stable.
pub(crate) fn equilibrium_near(
    field: &AnyField<'_>,
    y: &[f64],
    distance: f64,
) -> Option<(Vector, bool)> {
    let step = field.newton_step(y)?;
    if !step.iter().all(|x| x.abs() < distance) {
        return None;
    }
    Some((Vector::from_column_slice(y) - step, growth(field, y) < 0.0))
}

/// The stable equilibrium that a run spirals into: it swung by the first of `swings` in one window of time and by the second in
/// the next, and that is how fast the slowest eigenvalue lets it.
pub(super) fn spirals_into(
    field: &AnyField<'_>,
    y: &[f64],
    swings: (f64, f64),
    window: f64,
) -> Option<Vector> {
    let shrunk = (swings.0 / swings.1).ln();
    let mut at = Vector::from_column_slice(y);
    for _ in 0..ITERATIONS {
        let step = field.newton_step(at.as_slice())?;
        at -= &step;
        if step.amax() < CONVERGED {
            let said = -growth(field, at.as_slice()) * window;
            let agrees = shrunk > LEAST && AS_SAID.contains(&(shrunk / said));
            return agrees.then_some(at);
        }
    }
    None
}

/// The largest real part of the eigenvalues; infinite where they are not known, which is not stable.
pub(crate) fn growth(field: &AnyField<'_>, y: &[f64]) -> f64 {
    let jacobian = field.jacobian(&Vector::from_column_slice(y));
    eigenvalues(&jacobian).map_or(f64::INFINITY, |all| {
        let parts = all.iter().map(|z| z.re);
        parts.fold(f64::NEG_INFINITY, f64::max)
    })
}
