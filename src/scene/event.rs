//! Stick-slip events: excursions in which the interfaces together slip faster than they are driven, so that stress falls.
//!
//! An event lasts from a maximum of the stress to the next minimum, both zeros of V_H - v_1 - v_2, found on the dense output.
//! It counts if the total slip rate v_1 + v_2 exceeds a threshold in between. An excursion that the run begins or ends in is
//! none: its onset or its end is not known.

use super::column::Instant;
use super::plan::Plan;
use crate::error::Result;
use crate::field::State;
use crate::integrate::Step;
use crate::model::{Driven, Loading};
use crate::number::bracketed_root;

/// Parts of a step. Between two knots the sign of the slope shows whether an extremum lies there, so an excursion is missed
/// only if the dense output turns three times within a part, which the error test of a step does not let pass.
const PARTS: usize = 4;

/// One stick-slip event, dimensionless.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Event {
    /// Time of the stress maximum.
    pub onset: f64,
    /// Time since the onset of the event before.
    pub recurrence: Option<f64>,
    /// Time from the stress maximum to the stress minimum.
    pub duration: f64,
    /// Fall of the stress.
    pub stress_drop: f64,
    /// Largest total slip rate v_1 + v_2.
    pub peak_slip_rate: f64,
    /// Slip of each interface within the event.
    pub slip: [f64; 2],
}

impl Event {
    /// Which interface slipped more, 1 or 2; `None` if neither did.
    pub fn leader(&self) -> Option<usize> {
        let [first, second] = self.slip;
        if first > second {
            Some(1)
        } else if second > first {
            Some(2)
        } else {
            None
        }
    }
}

/// A point of the dense output, with the excess of the total slip rate over V_H and its slope in time.
#[derive(Clone, Copy)]
struct Knot {
    time: f64,
    excess: f64,
    slope: f64,
}

struct Open {
    from: Instant,
    peak: f64,
}

/// Watches the steps of a run for events.
pub(super) struct Detector<'a, const N: usize> {
    field: &'a dyn Driven<N>,
    loading: Loading,
    interfaces: usize,
    threshold: f64,
    open: Option<Open>,
    /// All events found.
    pub events: Vec<Event>,
}

impl<'a, const N: usize> Detector<'a, N> {
    pub fn new(field: &'a dyn Driven<N>, plan: &'a Plan, threshold: f64) -> Self {
        let loading = plan.loading;
        Detector {
            field,
            loading,
            interfaces: plan.system.interfaces,
            threshold: threshold * loading.driving,
            open: None,
            events: Vec::new(),
        }
    }

    /// Looks at one step; `slip` gives the slip since the start at a time in it.
    pub fn see(&mut self, step: &Step<'_, N>, slip: &dyn Fn(f64) -> [f64; 2]) -> Result<()> {
        let instant = |t: f64| Instant::new(t, &at(step, t), slip(t));
        let mut left = self.knot(step, step.t0);
        for part in 1..=PARTS {
            let time = if part == PARTS {
                step.t1
            } else {
                step.t0 + (step.t1 - step.t0) * part as f64 / PARTS as f64
            };
            let right = self.knot(step, time);
            if left.slope * right.slope < 0.0 {
                let turning = self.turning(step, left, right);
                self.between(step, left, turning, &instant)?;
                left = turning;
            }
            self.between(step, left, right, &instant)?;
            left = right;
        }
        Ok(())
    }

    /// A stretch in which the total slip rate is monotonic.
    fn between(
        &mut self,
        step: &Step<'_, N>,
        left: Knot,
        right: Knot,
        instant: &dyn Fn(f64) -> Instant,
    ) -> Result<()> {
        if left.excess <= 0.0 && right.excess > 0.0 {
            let onset = self.crossing(step, left, right)?;
            self.open = Some(Open {
                from: instant(onset),
                peak: 0.0,
            });
        }
        if let Some(open) = &mut self.open {
            let faster = left.excess.max(right.excess) + self.loading.driving;
            open.peak = open.peak.max(faster);
        }
        if left.excess > 0.0 && right.excess <= 0.0 && self.open.is_some() {
            let end = self.crossing(step, left, right)?;
            if let Some(open) = self.open.take()
                && open.peak > self.threshold
            {
                self.close(&open, &instant(end));
            }
        }
        Ok(())
    }

    fn close(&mut self, open: &Open, end: &Instant) {
        let from = &open.from;
        self.events.push(Event {
            onset: from.time,
            recurrence: self.events.last().map(|last| from.time - last.onset),
            duration: end.time - from.time,
            stress_drop: from.stress - end.stress,
            peak_slip_rate: open.peak,
            slip: [0, 1].map(|i| end.slip[i] - from.slip[i]),
        });
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

    fn crossing(&self, step: &Step<'_, N>, left: Knot, right: Knot) -> Result<f64> {
        bracketed_root("the onset of an event", left.time, right.time, |t| {
            let knot = self.knot(step, t);
            (knot.excess, knot.slope)
        })
    }
}

/// The dense output, and exactly the step's own states at its ends.
pub(super) fn at<const N: usize>(step: &Step<'_, N>, t: f64) -> State<N> {
    if t == step.t0 {
        *step.y0
    } else if t == step.t1 {
        *step.y1
    } else {
        (step.dense)(t)
    }
}
