//! What it means when a step has become too small to change t.

use crate::error::Error;
use crate::field::{State, VectorField};
use nalgebra::SVector;

/// Spacings of the numbers around t within which a singularity is at t, to rounding.
const NEAR: f64 = 1e5;
/// Length of a probing step, relative to the state.
const PACE: f64 = 1e-2;
/// Bound on them. From 1 to the largest number there are 710 / `PACE`.
const PACES: usize = 100_000;

/// Acceleration that no burst shows which ends within the numbers, if its derivatives have already left them.
const RUNAWAY: f64 = 1e100;

/// Spacings of the numbers around t within which a state that changes by its own size leaves no room for steps, whatever the
/// tolerance: between the strictest and the loosest of them steps differ by less.
const NO_ROOM: f64 = 1e3;

/// Names the reason for a step that has become too small to change t. If the solution, followed further, accelerates until it
/// leaves the numbers, and does so within the rounding of t, that is a finite-time singularity, unless the field is known to
/// have none. If it changes by its own size within a few spacings of t no tolerance helps. Else a larger one does.
///
/// A burst that ends, however violent, is no singularity: where beta < 1 the state falls by dozens of decades at once, but
/// stops above zero; and where the solutions of a law exist for all time slip rates of e^1000 last but for a moment.
pub(crate) fn step_underflow<const N: usize>(
    field: &dyn VectorField<N>,
    t: f64,
    h: f64,
    y: &State<N>,
) -> Error {
    let f = field.f(y);
    let rate = f.amax();
    let direction = h.signum();
    let lasting = field.lasting().filter(|_| direction > 0.0);
    let spacing = (t.abs() * f64::EPSILON).max(f64::MIN_POSITIVE);
    if !rate.is_finite() {
        return match lasting {
            Some(_) => Error::TooFast {
                t,
                uncertainty: None,
                rate: f64::MAX,
                overflows: true,
                lasting,
            },
            None => Error::NonFinite {
                what: "the right-hand side",
                t,
            },
        };
    }
    let singular = time_to_singularity(field, y, direction, NEAR * spacing);
    let relative = (0..N)
        .map(|i| f[i].abs() / (1.0 + y[i].abs()))
        .fold(0.0, f64::max);
    match singular {
        Some(left) if lasting.is_none() => Error::BlowUp {
            t: t + left * direction,
            uncertainty: None,
            rate,
        },
        None if relative * NO_ROOM * spacing < 1.0 => Error::StepTooSmall { t, h },
        left => Error::TooFast {
            t: t + left.unwrap_or(0.0) * direction,
            uncertainty: None,
            rate,
            overflows: left.is_some(),
            lasting,
        },
    }
}

/// Whether steps too short to change t, for this reason, may go on in time of 31 digits: the solution may go through a spike. Where it ends, or has rates that
/// leave the numbers, it is not followed any nearer.
pub(crate) fn may_be_spike(why: &Error) -> bool {
    match why {
        Error::StepTooSmall { .. } => true,
        Error::TooFast {
            overflows, lasting, ..
        } => !overflows && lasting.is_none(),
        _ => false,
    }
}

/// The time in which the solution from y leaves the numbers, if it accelerates all the way and that takes no longer than
/// `most`.
///
/// Followed over its own length instead of time, dy/ds = f / |f|, where the length of a change is relative to the state. So
/// near a singularity nothing is stiff, nothing overflows, and each step of a fixed length adds a time to the sum that is
/// smaller than the last one.
pub fn time_to_singularity<const N: usize>(
    field: &dyn VectorField<N>,
    y: &State<N>,
    direction: f64,
    most: f64,
) -> Option<f64> {
    // The state's change over a unit of its length, and the time that it takes; none where the rate is no number.
    let pace = |y: &State<N>| -> Option<(State<N>, f64)> {
        let f = field.f(y);
        let rate = f.amax();
        let along = f / rate;
        let speed: State<N> = SVector::from_fn(|i, _| along[i].abs() / (1.0 + y[i].abs()));
        let time = 1.0 / (rate * speed.amax());
        (rate.is_finite() && time > 0.0).then(|| (along * (direction / speed.amax()), time))
    };
    let (_, first) = pace(y)?;
    let (mut y, mut left) = (*y, 0.0);
    for _ in 0..PACES {
        let Some((k1, time)) = pace(&y) else {
            return Some(left);
        };
        let unit = k1 / k1.amax();
        // d|f|^2/dt = 2 f . J f, with f scaled: its square may overflow.
        let growth = unit.dot(&(field.jacobian(&y) * unit)) * direction;
        if !growth.is_finite() {
            // The derivatives overflow, or make inf * 0, where the field itself does not yet.
            return (first / time > RUNAWAY && left <= most).then_some(left);
        }
        if growth <= 0.0 || left.is_nan() || left > most {
            return None;
        }
        // The method of Runge (1895): the solution is only looked at, not computed.
        let Some((k2, time)) = pace(&(y + k1 * (0.5 * PACE))) else {
            return Some(left);
        };
        left += PACE * time;
        if k2.dot(&k1) <= 0.0 {
            return None;
        }
        y += k2 * PACE;
    }
    None
}
