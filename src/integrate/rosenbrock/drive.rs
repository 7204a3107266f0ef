//! Adaptive steps from one time to another, whatever is carried along: the state alone or with its tangent.

use super::control::Controller;
use crate::error::{Error, Result};
use crate::integrate::{Control, Work};

/// Something that can be moved by a step, and stays where it is until the step is accepted.
pub(crate) trait Steppable {
    /// Order of the error estimate in h, that is order of the lower of the two solutions, plus one.
    fn error_order(&self) -> u32;
    /// The largest step.
    fn max_step(&self) -> f64 {
        f64::INFINITY
    }

    fn work(&mut self) -> &mut Work;
    /// Why steps of about h no longer change t.
    fn underflow(&self, t: f64, h: f64) -> Error;
    /// Tries a step; the norm of its error, or `None` if something was not finite.
    fn attempt(&mut self, h: f64) -> Option<f64>;
    /// |J| where it is, and where the tried step ends, which must have been looked at.
    fn fastest(&self) -> (f64, f64);
    /// Evaluates at the end of the tried step what the next one needs; false if something is not finite.
    fn look_ahead(&mut self) -> bool;
    /// Moves to the end of the tried step.
    fn advance(&mut self);
}

/// From `t.0` to `t.1` with the first step `h`, signed; `seen` is told of each step before the carried advances.
#[inline]
pub(crate) fn drive<M: Steppable>(
    carried: &mut M,
    t: (f64, f64),
    mut h: f64,
    limit: usize,
    mut seen: impl FnMut(&M, f64, f64) -> Result<Control>,
) -> Result<()> {
    let (mut now, end) = t;
    let mut controller = Controller::new(carried.error_order());
    let mut tried = 0;
    let mut refused = None;
    while now != end {
        if tried == limit {
            return Err(Error::TooManySteps { t: now, end, limit });
        }
        tried += 1;
        let longest = carried.max_step();
        let next = next_time(now, end, h.clamp(-longest, longest));
        // As the sum of times is rounded, so is the step: no error of time builds up.
        let step = next - now;
        // Nothing, or rounded up again to what was just refused: no shorter step can be added to t.
        if step == 0.0 || refused == Some(step) || !step.is_finite() {
            return Err(carried.underflow(now, h));
        }
        let error = carried.attempt(step);
        let accepted = error.is_some_and(|error| error <= 1.0);
        let first = carried.work().steps == 0;
        let seen_to_end = accepted && (next == end && !first || carried.look_ahead());
        if seen_to_end && first && outgrown(step, carried.fastest()) {
            h = controller.refused(step, None);
            refused = Some(step);
            carried.work().rejected += 1;
        } else if seen_to_end {
            h = controller.accepted(step, error.unwrap_or(0.0));
            refused = None;
            carried.work().steps += 1;
            let control = seen(carried, now, next)?;
            carried.advance();
            now = next;
            if control == Control::Stop {
                return Ok(());
            }
        } else {
            h = controller.refused(step, error.filter(|_| !accepted));
            refused = Some(step);
            carried.work().rejected += 1;
        }
    }
    Ok(())
}

/// Whether the rates have grown within a step beyond what one without a history can be trusted with. All stages stand on the
/// Jacobian at its beginning, and so does the error estimate, which a growth by e^30 can escape: a stress that is loaded from
/// -50 to -20 at once. Later steps are as long as the errors of those before have let them.
fn outgrown(h: f64, (before, after): (f64, f64)) -> bool {
    /// Growth of |J|.
    const MUCH: f64 = 10.0;
    /// |h J| below which J does nothing yet.
    const NOTICEABLE: f64 = 0.01;
    after > MUCH * before && h.abs() * after > NOTICEABLE
}

/// Where a step of about h ends: at the end exactly if that is near, and never so close to it that a sliver remains.
#[inline]
fn next_time(now: f64, end: f64, h: f64) -> f64 {
    /// A last step may be this much longer than the error allows.
    const STRETCH: f64 = 1.01;
    let left = end - now;
    if STRETCH * h.abs() >= left.abs() {
        end
    } else if 2.0 * h.abs() > left.abs() {
        now + 0.5 * left
    } else {
        now + h
    }
}
