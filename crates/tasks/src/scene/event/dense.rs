//! Events on the dense output of a step: knots, and zeros in the brackets between them.

use super::super::slip::{Slips, slips};
use super::{Detector, Moment, sign};
use twinslip::error::Result;
use twinslip::field::Vector;
use twinslip::integrate::{AnyField, AnyStep};
use twinslip::number::{DoubleDouble, bracketed_root};

/// Parts of a step. Between two knots the sign of the slope shows whether an extremum lies there, so an excursion is missed
/// only if the dense output turns three times within a part, which the error test of a step does not let pass.
const PARTS: usize = 4;

/// A point of the dense output, with V_H, the excess of the total slip rate over it and its slope in time.
#[derive(Clone, Copy)]
struct Knot {
    time: f64,
    driving: f64,
    excess: f64,
    slope: f64,
}

/// A step as it is seen from the slips at its beginning.
#[derive(Clone, Copy)]
struct Seen<'a, 's> {
    field: &'a AnyField<'a>,
    step: &'a AnyStep<'s>,
    before: &'a [DoubleDouble],
}

impl Seen<'_, '_> {
    /// The dense output, and exactly the step's own states at its ends.
    fn at(&self, t: f64) -> Vector {
        let step = self.step;
        if t == step.t1 {
            Vector::from_column_slice(step.y1)
        } else if t == step.t0 {
            Vector::from_column_slice(step.y0)
        } else {
            step.dense(t)
        }
    }
}

impl Detector {
    pub(super) fn see_dense(
        &mut self,
        field: &AnyField<'_>,
        step: &AnyStep<'_>,
        before: &[DoubleDouble],
    ) -> Result<()> {
        let seen = Seen {
            field,
            step,
            before,
        };
        let mut left = self.knot(&seen, step.t0);
        if self.zeros.sign == 0.0 {
            self.zeros.sign = sign(left.excess).or(sign(left.slope)).unwrap_or(0.0);
        }
        for part in 1..=PARTS {
            let time = if part == PARTS {
                step.t1
            } else {
                step.t0 + (step.t1 - step.t0) * part as f64 / PARTS as f64
            };
            let right = self.knot(&seen, time);
            for turning in self.turnings_between(&seen, left, right) {
                self.between(&seen, left, turning)?;
                left = turning;
            }
            self.between(&seen, left, right)?;
            left = right;
        }
        Ok(())
    }

    /// Where the excess turns and, where V_H is not constant, the total slip rate and what it exceeds the threshold by.
    fn turnings_between(&self, seen: &Seen<'_, '_>, left: Knot, right: Knot) -> Vec<Knot> {
        let rate = self.rate();
        let all = [0.0, rate, (1.0 - self.threshold) * rate];
        let offsets = if rate == 0.0 { &all[..1] } else { &all };
        let turns = |&offset: &f64| {
            let slope = |t: f64| (self.knot(seen, t).slope + offset, f64::NAN);
            if (left.slope + offset) * (right.slope + offset) >= 0.0 {
                return None;
            }
            let found = bracketed_root("the largest slip rate", left.time, right.time, slope);
            Some(found.map_or(right, |t| self.knot(seen, t)))
        };
        let mut turnings: Vec<Knot> = offsets.iter().filter_map(turns).collect();
        turnings.sort_by(|a, b| a.time.total_cmp(&b.time));
        turnings
    }

    /// A part in which the excess is monotonic.
    fn between(&mut self, seen: &Seen<'_, '_>, left: Knot, right: Knot) -> Result<()> {
        // At 0 the next knot decides.
        let carried = self.zeros.sign;
        let reached = sign(right.excess).unwrap_or(carried);
        self.zeros.sign = reached;
        if reached > carried {
            let onset = self.crossing(seen, left, right)?;
            self.log.open(Some(self.moment(seen, onset)));
        }
        for knot in [left, right] {
            let threshold = self.threshold * knot.driving;
            self.log.raise(knot.excess + knot.driving, threshold);
        }
        if reached < carried && self.log.open.is_some() {
            let end = self.crossing(seen, left, right)?;
            self.log.close(self.moment(seen, end));
        }
        Ok(())
    }

    fn moment(&self, seen: &Seen<'_, '_>, t: f64) -> Moment {
        let mut there = Slips::new();
        slips(&self.rates, seen.step, seen.before, t, &mut there);
        Moment::new(DoubleDouble::from(t), seen.at(t)[0], &there)
    }

    // dtau/dt = K (V_H - v_1 - v_2) and its derivative J f hold the excess and its slope, for every system.
    fn knot(&self, seen: &Seen<'_, '_>, time: f64) -> Knot {
        let (field, y) = (seen.field, seen.at(time));
        let curvature = (field.jacobian(&y) * field.f(&y))[0];
        let total = self.rates.total(y.as_slice());
        let driving = self.driving_at(time);
        Knot {
            time,
            driving,
            excess: total - driving,
            slope: -curvature / self.stiffness,
        }
    }

    /// Where the sign changes that `right` no longer has: at the left knot, if that lost it at the joint of two steps.
    fn crossing(&self, seen: &Seen<'_, '_>, left: Knot, right: Knot) -> Result<f64> {
        if sign(left.excess) == sign(right.excess) {
            return Ok(left.time);
        }
        bracketed_root("the onset of an event", left.time, right.time, |t| {
            let knot = self.knot(seen, t);
            (knot.excess, knot.slope)
        })
    }
}
