//! Stick-slip events: excursions in which the interfaces together slip faster than they are driven, so that stress falls.
//!
//! An event lasts from a maximum of the stress to the next minimum, both zeros of V_H - v_1 - v_2, found on the series of a
//! step where it has one (`series`) and else on its dense output (`dense`). It counts if the total slip rate v_1 + v_2
//! exceeds a threshold in between. An excursion that the run begins or ends in is none: its onset or its end is not known.

mod dense;
mod series;

use super::plan::Plan;
use super::slip::Slips;
use crate::error::Result;
use crate::integrate::Step;
use crate::model::{Driven, Loading};
use crate::number::DoubleDouble;
use crate::number::polynomial::Root;
use crate::series::Zeros;

/// One stick-slip event, dimensionless.
#[derive(Debug, Clone, Copy, PartialEq)]
#[non_exhaustive]
pub struct SlipEvent {
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

impl SlipEvent {
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

/// A stress maximum or minimum. An event is short and its slips are small against the run's: their differences are taken in
/// 31 digits.
#[derive(Debug, Clone, Copy)]
struct Moment {
    time: DoubleDouble,
    stress: f64,
    slips: Slips,
}

/// The events of a run, from the stress maxima and minima as they come.
#[derive(Debug)]
struct Log {
    threshold: f64,
    last_onset: Option<DoubleDouble>,
    open: Option<Open>,
    events: Vec<SlipEvent>,
}

#[derive(Debug, Clone, Copy)]
struct Open {
    from: Moment,
    peak: f64,
}

impl Log {
    /// The slip is faster than V_H from now on.
    fn open(&mut self, from: Moment) {
        self.open = Some(Open { from, peak: 0.0 });
    }

    /// The total slip rate at some time in between.
    fn raise(&mut self, total: f64) {
        if let Some(open) = &mut self.open {
            open.peak = open.peak.max(total);
        }
    }

    /// It is no longer.
    fn close(&mut self, end: Moment) {
        let Some(Open { from, peak }) = self.open.take() else {
            return;
        };
        if peak <= self.threshold {
            return;
        }
        let last_onset = self.last_onset.replace(from.time);
        self.events.push(SlipEvent {
            onset: from.time.hi(),
            recurrence: last_onset.map(|last| (from.time - last).hi()),
            duration: (end.time - from.time).hi(),
            stress_drop: from.stress - end.stress,
            peak_slip_rate: peak,
            slip: [0, 1].map(|i| (end.slips[i] - from.slips[i]).hi()),
        });
    }
}

/// Watches the steps of a run for events.
pub(super) struct Detector<'a, const N: usize> {
    field: &'a dyn Driven<N>,
    loading: Loading,
    interfaces: usize,
    /// Of v_1 + v_2 - V_H; its sign is carried over the steps of either kind.
    zeros: Zeros,
    turnings: Vec<Root>,
    log: Log,
}

impl<'a, const N: usize> Detector<'a, N> {
    pub fn new(field: &'a dyn Driven<N>, plan: &'a Plan, threshold: f64) -> Self {
        let loading = plan.loading;
        Detector {
            field,
            loading,
            interfaces: plan.system.interfaces,
            zeros: Zeros::default(),
            turnings: Vec::new(),
            log: Log {
                threshold: threshold * loading.driving,
                last_onset: None,
                open: None,
                events: Vec::new(),
            },
        }
    }

    /// Looks at one step, from the slips at its beginning.
    pub fn see(&mut self, step: &Step<'_, N>, before: &Slips) -> Result<()> {
        match step.series() {
            Some(series) => {
                self.see_series(series, before);
                Ok(())
            }
            None => self.see_dense(step, before),
        }
    }

    /// All events found.
    pub fn into_events(self) -> Vec<SlipEvent> {
        self.log.events
    }
}
