//! A run of a fault in a few numbers: its stiffness against the critical one, and its events.

use super::event::SlipEvent;
use super::plan::{EVENT_THRESHOLD, Plan, Sampling};
use super::run::RunOutcome;
use super::system::Described;
use super::units::Quantity;
use twinslip::friction::critical_stiffness;

/// The mean of some numbers, the smallest and the largest.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Spread {
    /// Their sum over their number.
    pub mean: f64,
    /// The smallest.
    pub least: f64,
    /// The largest.
    pub most: f64,
}

impl Spread {
    fn of(numbers: impl Iterator<Item = f64>) -> Option<Self> {
        let all: Vec<f64> = numbers.collect();
        let bound = |pick: fn(f64, f64) -> f64| all.iter().copied().reduce(pick);
        Some(Spread {
            mean: all.iter().sum::<f64>() / all.len() as f64,
            least: bound(f64::min)?,
            most: bound(f64::max)?,
        })
    }
}

/// The critical stiffness of a spring that loads equal interfaces, in the user's units.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Criticality {
    /// k_c: on a stiffer spring the interfaces slide steadily, all at the same rate. Below 0 they do on every spring.
    pub stiffness: f64,
    /// k/k_c, where k_c is positive.
    pub ratio: Option<f64>,
}

/// A run of interfaces in SI, in the user's units.
#[derive(Debug, Clone, PartialEq)]
pub struct FaultSummary {
    /// At the rate of steady sliding; `None` where the interfaces differ.
    pub criticality: Option<Criticality>,
    /// How many events began and ended in the run.
    pub events: usize,
    /// The times from one onset to the next.
    pub recurrence: Option<Spread>,
    /// Of all events but the first, which depends on the start; of that where there is no other.
    pub stress_drop: Option<Spread>,
    /// Whether the stress drop of the first event is left out.
    pub first_left_out: bool,
    /// The largest of all events.
    pub peak_slip_rate: Option<f64>,
}

impl FaultSummary {
    /// The summary of a run in SI that is watched between its start and its end; `None` for another one. Under a program events are those that
    /// are asked for, and have no recurrence, as they answer to the program; k_c changes with V_H.
    pub fn new(plan: &Plan, outcome: &RunOutcome) -> Option<Self> {
        plan.detected()?;
        let units = plan.system.units();
        if !units.si() {
            return None;
        }
        let steady = plan.program.is_none();
        let spread = |quantity, number: fn(&SlipEvent) -> Option<f64>| {
            let numbers = outcome.events.iter().filter_map(number);
            Spread::of(numbers.map(|x| units.outward(quantity, x)))
        };
        let peak = spread(Quantity::SlipRate, |event| Some(event.peak_slip_rate));
        let later = spread(Quantity::Stress, |event| {
            event.recurrence.map(|_| event.stress_drop)
        });
        Some(FaultSummary {
            criticality: criticality(plan).filter(|_| steady),
            events: outcome.events.len(),
            recurrence: spread(Quantity::Time, |event| event.recurrence).filter(|_| steady),
            first_left_out: later.is_some(),
            stress_drop: later
                .or_else(|| spread(Quantity::Stress, |event| Some(event.stress_drop))),
            peak_slip_rate: peak.map(|peak| peak.most),
        })
    }
}

fn criticality(plan: &Plan) -> Option<Criticality> {
    let (system, loading) = plan.system.closed_forms()?;
    if system.unequal.is_some() {
        return None;
    }
    // The stress of one spring falls with the slip of all interfaces.
    let count = system.interfaces as f64;
    let critical = critical_stiffness(&system.law, loading.driving / count) / count;
    Some(Criticality {
        stiffness: system.units.outward(Quantity::Stiffness, critical),
        ratio: (critical > 0.0).then(|| loading.stiffness / critical),
    })
}

impl Plan {
    /// The threshold of the events that a run looks for: those that are asked for, and of a run in SI those of its summary.
    pub fn detected(&self) -> Option<f64> {
        let summarised = self.system.units().si()
            && self.program.is_none()
            && self.sampling != Sampling::FinalOnly;
        self.events.or(summarised.then_some(EVENT_THRESHOLD))
    }
}
