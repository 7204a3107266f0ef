//! Events on the dense output of a step: knots, and zeros in the brackets between them.

use super::super::slip::{Slips, at, slips};
use super::{Detector, Moment};
use crate::error::Result;
use crate::integrate::Step;
use crate::number::{DoubleDouble, bracketed_root};

/// Parts of a step. Between two knots the sign of the slope shows whether an extremum lies there, so an excursion is missed
/// only if the dense output turns three times within a part, which the error test of a step does not let pass.
const PARTS: usize = 4;

/// A point of the dense output, with the excess of the total slip rate over V_H and its slope in time.
#[derive(Clone, Copy)]
struct Knot {
    time: f64,
    excess: f64,
    slope: f64,
}

impl<const N: usize> Detector<'_, N> {
    pub(super) fn see_dense(&mut self, step: &Step<'_, N>, before: &Slips) -> Result<()> {
        let mut left = self.knot(step, step.t0);
        if self.zeros.sign == 0.0 {
            self.zeros.sign = sign(left.excess).or(sign(left.slope)).unwrap_or(0.0);
        }
        for part in 1..=PARTS {
            let time = if part == PARTS {
                step.t1
            } else {
                step.t0 + (step.t1 - step.t0) * part as f64 / PARTS as f64
            };
            let right = self.knot(step, time);
            if left.slope * right.slope < 0.0 {
                let turning = self.turning(step, left, right);
                self.between(step, before, left, turning)?;
                left = turning;
            }
            self.between(step, before, left, right)?;
            left = right;
        }
        Ok(())
    }

    /// A stretch in which the total slip rate is monotonic.
    fn between(
        &mut self,
        step: &Step<'_, N>,
        before: &Slips,
        left: Knot,
        right: Knot,
    ) -> Result<()> {
        // At 0 the next knot decides.
        let carried = self.zeros.sign;
        let reached = sign(right.excess).unwrap_or(carried);
        self.zeros.sign = reached;
        if reached > carried {
            let onset = self.crossing(step, left, right)?;
            self.log.open(self.moment(step, before, onset));
        }
        let faster = left.excess.max(right.excess) + self.loading.driving;
        self.log.raise(faster);
        if reached < carried && self.log.open.is_some() {
            let end = self.crossing(step, left, right)?;
            self.log.close(self.moment(step, before, end));
        }
        Ok(())
    }

    fn moment(&self, step: &Step<'_, N>, before: &Slips, t: f64) -> Moment {
        Moment {
            time: DoubleDouble::from(t),
            stress: at(step, t)[0],
            slips: slips(self.field, step, before, t),
        }
    }

    // dtau/dt = K (V_H - v_1 - v_2) and its derivative J f hold the total slip rate and its slope, for every system.
    fn knot(&self, step: &Step<'_, N>, time: f64) -> Knot {
        let y = at(step, time);
        let curvature = (self.field.jacobian(&y) * self.field.f(&y))[0];
        let v = self.field.slip_rates(&y);
        let total = v[..self.interfaces].iter().sum::<f64>();
        Knot {
            time,
            excess: total - self.loading.driving,
            slope: -curvature / self.loading.stiffness,
        }
    }

    fn turning(&self, step: &Step<'_, N>, left: Knot, right: Knot) -> Knot {
        let slope = |t: f64| (self.knot(step, t).slope, f64::NAN);
        bracketed_root("the largest slip rate", left.time, right.time, slope)
            .map_or(right, |t| self.knot(step, t))
    }

    /// Where the sign changes that `right` no longer has: at the left knot, if that lost it at the joint of two steps.
    fn crossing(&self, step: &Step<'_, N>, left: Knot, right: Knot) -> Result<f64> {
        if sign(left.excess) == sign(right.excess) {
            return Ok(left.time);
        }
        bracketed_root("the onset of an event", left.time, right.time, |t| {
            let knot = self.knot(step, t);
            (knot.excess, knot.slope)
        })
    }
}

/// 1 or -1; `None` of zero, and of what is no number.
fn sign(x: f64) -> Option<f64> {
    (x != 0.0 && !x.is_nan()).then(|| x.signum())
}
