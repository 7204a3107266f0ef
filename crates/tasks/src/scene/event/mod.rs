//! Stick-slip events: excursions in which the interfaces together slip faster than they are driven, so that stress falls.
//!
//! An event lasts from a maximum of the stress to the next minimum, both zeros of V_H - v_1 - v_2, found on the series of a
//! step where it has one (`series`) and else on its dense output (`dense`). It counts if the total slip rate v_1 + v_2
//! exceeds a threshold in between, a multiple of V_H. An excursion that the run begins or ends in is none: its onset or its end is
//! not known. Where V_H jumps, the stress has a corner that may be such a maximum or minimum.

mod dense;
mod series;

use super::any_system::AnySystem;
use super::program::Stretch;
use super::slip::SlipRates;
use twinslip::error::Result;
use twinslip::integrate::{AnyField, AnyStep};
use twinslip::number::DoubleDouble;
use twinslip::number::polynomial::Root;
use twinslip::series::Zeros;

/// One stick-slip event, dimensionless.
#[derive(Debug, Clone, Copy, PartialEq)]
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
    /// Slip of each interface within the event; a single one stands in both places.
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
    slips: [DoubleDouble; 2],
}

impl Moment {
    fn new(time: DoubleDouble, stress: f64, slips: &[DoubleDouble]) -> Self {
        Moment {
            time,
            stress,
            slips: [slips[0], slips[slips.len() - 1]],
        }
    }
}

/// The events of a run, from the stress maxima and minima as they come.
#[derive(Debug)]
struct Log {
    last_onset: Option<DoubleDouble>,
    open: Option<Open>,
    events: Vec<SlipEvent>,
    /// The times and values of all maxima of the stress, where they are asked for.
    maxima: Option<Vec<(f64, f64)>>,
}

#[derive(Debug, Clone, Copy)]
struct Open {
    /// The stress maximum; `None` where the run begins within the excursion.
    from: Option<Moment>,
    peak: f64,
    /// Whether it is fast enough for an event.
    counts: bool,
}

impl Log {
    /// The slip is faster than V_H from now on.
    fn open(&mut self, from: Option<Moment>) {
        if let (Some(maxima), Some(from)) = (&mut self.maxima, from) {
            maxima.push((from.time.hi(), from.stress));
        }
        self.open = Some(Open {
            from,
            peak: 0.0,
            counts: false,
        });
    }

    /// The total slip rate at some time in between, with the rate beyond which it is an event.
    fn raise(&mut self, total: f64, threshold: f64) {
        if let Some(open) = &mut self.open {
            open.peak = open.peak.max(total);
            open.counts |= total > threshold;
        }
    }

    /// It is no longer.
    fn close(&mut self, end: Moment) {
        let Some(Open {
            from: Some(from),
            peak,
            counts: true,
        }) = self.open.take()
        else {
            return;
        };
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
pub(super) struct Detector {
    rates: SlipRates,
    stiffness: f64,
    /// Over V_H.
    threshold: f64,
    /// How V_H is here; `None` before the run.
    stretch: Option<Stretch>,
    /// Of v_1 + v_2 - V_H; its sign is carried over the steps of either kind.
    zeros: Zeros,
    turnings: Vec<Root>,
    log: Log,
}

impl Detector {
    pub fn new(system: &AnySystem, rates: &SlipRates, threshold: f64) -> Self {
        Detector {
            rates: rates.clone(),
            stiffness: system.stiffness(),
            threshold,
            stretch: None,
            zeros: Zeros::default(),
            turnings: Vec::new(),
            log: Log {
                last_onset: None,
                open: None,
                events: Vec::new(),
                maxima: None,
            },
        }
    }

    /// The same, which also keeps all maxima of the stress.
    pub fn with_maxima(mut self) -> Self {
        self.log.maxima = Some(Vec::new());
        self
    }

    /// A stretch begins, at this state and these slips: where V_H jumps, an event may begin or end there.
    pub fn begin(&mut self, stretch: &Stretch, y: &[f64], slips: &[DoubleDouble]) {
        /// Excursions that are less faster than V_H, relative to it, are steady sliding but for the errors of the run: where V_H falls
        /// after one the event begins.
        const STEADY: f64 = 1e-6;
        let total = self.rates.total(y);
        let reached = sign(total - stretch.driving.0);
        let Some(before) = self.stretch.replace(*stretch) else {
            self.zeros.sign = reached.unwrap_or(0.0);
            if self.zeros.sign > 0.0 {
                self.log.open(None);
            }
            return;
        };
        let was = before.driving.1;
        if was == stretch.driving.0 {
            return;
        }
        let here = Moment::new(DoubleDouble::from(stretch.span.0), y[0], slips);
        let steady = |open: &Open| open.peak <= was * (1.0 + STEADY);
        if self.log.open.as_ref().is_some_and(steady) {
            self.log.open = None;
        }
        match (reached, self.log.open.is_some()) {
            (Some(1.0), false) => self.log.open(Some(here)),
            (Some(-1.0), true) => self.log.close(here),
            _ => {}
        }
        self.zeros.sign = reached.unwrap_or(self.zeros.sign);
    }

    /// V_H at a time of this stretch.
    fn driving_at(&self, t: f64) -> f64 {
        self.stretch
            .map_or(f64::NAN, |stretch| stretch.driving_at(t))
    }

    /// dV_H/dt.
    fn rate(&self) -> f64 {
        self.stretch.map_or(0.0, |stretch| stretch.rate())
    }

    /// Looks at one step, from the slips at its beginning.
    pub fn see(
        &mut self,
        field: &AnyField<'_>,
        step: &AnyStep<'_>,
        before: &[DoubleDouble],
    ) -> Result<()> {
        match step.series() {
            Some(series) => {
                self.see_series(series, before);
                Ok(())
            }
            None => self.see_dense(field, step, before),
        }
    }

    /// All events found, and all maxima of the stress that were kept.
    pub fn into_found(self) -> (Vec<SlipEvent>, Vec<(f64, f64)>) {
        (self.log.events, self.log.maxima.unwrap_or_default())
    }
}

/// 1 or -1; `None` of zero, and of what is no number.
fn sign(x: f64) -> Option<f64> {
    (x != 0.0 && !x.is_nan()).then(|| x.signum())
}
