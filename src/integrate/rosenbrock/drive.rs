//! Adaptive steps from one time to another, whatever is carried along: the state alone or with its tangent.

use super::control::Controller;
use crate::error::{Error, Result};
use crate::integrate::{Control, Work, may_be_spike};
use crate::number::DoubleDouble;

/// Something that can be moved by a step, and stays where it is until the step is accepted.
pub(crate) trait Steppable {
    /// Order of the error estimate in h, that is order of the lower of the two solutions, plus one.
    fn error_order(&self) -> u32;
    /// The largest step.
    fn max_step(&self) -> f64 {
        f64::INFINITY
    }

    fn work(&mut self) -> &mut Work;
    /// Whether steps may be too short to change the double next to the time.
    fn goes_through_spikes(&self) -> bool {
        true
    }
    /// Why steps of about h at t are too short.
    fn underflow(&self, t: f64, h: f64) -> Error;
    /// Tries a step in which the double next to the time grows by `clock`; the norm of its error, or `None` if something was not finite.
    fn attempt(&mut self, h: f64, clock: f64) -> Option<f64>;
    /// |J| where it is, and where the tried step ends, which must have been looked at.
    fn fastest(&self) -> (f64, f64);
    /// Evaluates at the end of the tried step what the next one needs; false if something is not finite.
    fn look_ahead(&mut self) -> bool;
    /// Moves to the end of the tried step.
    fn advance(&mut self);
}

/// A step in time, in 31 digits: at the end of a long wait a spike may last for less than the spacing of the doubles there.
#[derive(Debug, Clone, Copy)]
pub(crate) struct TimeStep {
    pub begin: DoubleDouble,
    pub end: DoubleDouble,
    /// From the one to the other, signed.
    pub length: f64,
}

/// From `t.0` to `t.1` with the first step `h`, signed; `seen` is told of each step before the carried advances.
#[inline]
pub(crate) fn drive<M: Steppable>(
    carried: &mut M,
    t: (f64, f64),
    mut h: f64,
    limit: usize,
    mut seen: impl FnMut(&M, &TimeStep) -> Result<Control>,
) -> Result<()> {
    let (mut now, end) = (DoubleDouble::from(t.0), t.1);
    let mut controller = Controller::new(carried.error_order());
    let mut tried = 0;
    let mut refused = None;
    // Whether steps are too short for the doubles around the time; and whether the last one was refused as it led where there are no numbers.
    let (mut within_spike, mut beyond) = (false, false);
    while now != DoubleDouble::from(end) {
        let t = now.hi();
        if tried == limit {
            return Err(Error::TooManySteps { t, end, limit });
        }
        tried += 1;
        let longest = carried.max_step();
        let time = next_step(now, end, h.clamp(-longest, longest));
        let (step, is_last) = (time.length, time.end == DoubleDouble::from(end));
        // No shorter step can be added to the time.
        let stays = time.end == now;
        if step == 0.0 || refused == Some(step) || stays || !step.is_finite() {
            return Err(carried.underflow(t, h));
        }
        let is_short = step.abs() < f64::EPSILON * t.abs() && !is_last;
        if is_short && (!within_spike || beyond) {
            let why = carried.underflow(t, h);
            // Nor is there a spike where the solution has no numbers a step ahead.
            if beyond || !carried.goes_through_spikes() || !may_be_spike(&why) {
                return Err(why);
            }
            within_spike = true;
        }
        let error = carried.attempt(step, time.end.hi() - t);
        let accepted = error.is_some_and(|error| error <= 1.0);
        let first = carried.work().steps == 0;
        let seen_to_end = accepted && (is_last && !first || carried.look_ahead());
        if seen_to_end && first && outgrown(step, carried.fastest()) {
            h = controller.refused(step, None);
            refused = Some(step);
            carried.work().rejected += 1;
        } else if seen_to_end {
            h = controller.accepted(step, error.unwrap_or(0.0));
            (refused, beyond) = (None, false);
            carried.work().steps += 1;
            within_spike &= is_short;
            let control = seen(carried, &time)?;
            carried.advance();
            now = time.end;
            if control == Control::Stop {
                return Ok(());
            }
        } else {
            beyond |= accepted || error.is_none();
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

/// A step of about h: to the end exactly if that is near, and never so close to it that a sliver remains.
#[inline]
fn next_step(begin: DoubleDouble, end: f64, h: f64) -> TimeStep {
    /// A last step may be this much longer than the error allows.
    const STRETCH: f64 = 1.01;
    /// By this part a step may be longer or shorter for its end to be a double.
    const ROUNDED: f64 = 1e-3;
    let left = -(begin - end).hi();
    if STRETCH * h.abs() >= left.abs() {
        return TimeStep {
            begin,
            end: DoubleDouble::from(end),
            length: left,
        };
    }
    let h = if 2.0 * h.abs() > left.abs() {
        0.5 * left
    } else {
        h
    };
    // As the sum of times is rounded, so is the step: no error of time builds up.
    let next = begin.hi() + h;
    let rounded = (next - begin.hi()) - begin.lo();
    let (length, end) = if (rounded - h).abs() <= ROUNDED * h.abs() {
        (rounded, DoubleDouble::from(next))
    } else {
        (h, begin + h)
    };
    TimeStep { begin, end, length }
}
