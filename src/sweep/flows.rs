//! How the runs of a sweep are advanced: those of two equal interfaces side by side in the lanes of the processor, others one after the other.

use super::SweepSettings;
use crate::error::Result;
use crate::field::{Vector, state, vector};
use crate::friction::AnyLaw;
use crate::integrate::{
    AnyField, AnyIntegrator, AnyStep, Batch, BatchRun, Choice, Control, Step, Tolerances,
};
use crate::model::Loading;
use std::rc::Rc;

/// The integrators that advance runs.
pub(super) struct Flows {
    /// Lanes have one law.
    lanes: Option<(AnyLaw, Batch)>,
    one: AnyIntegrator,
}

/// From a state at one time to another time.
pub(super) struct Leg {
    pub field: Rc<AnyField<'static>>,
    /// The law and loading of two equal interfaces.
    pub lane: Option<(AnyLaw, Loading)>,
    pub start: Vector,
    pub t: (f64, f64),
}

/// Sees the steps of the leg of a number.
pub(super) type LegObserver<'a> = &'a mut dyn FnMut(usize, &AnyStep<'_>) -> Result<Control>;

impl Flows {
    pub fn new(settings: &SweepSettings) -> Result<Self> {
        let tolerances = Tolerances::equal(settings.rtol)?;
        let batch = |law| Batch::new(law, tolerances, settings.max_steps);
        let lanes = settings.grid.law();
        Ok(Flows {
            lanes: lanes.map(|law| Ok((law, batch(law)?))).transpose()?,
            one: AnyIntegrator::new(Choice::Taylor, tolerances, settings.max_steps)?,
        })
    }

    /// Takes runs one after the other from now on.
    pub fn without_lanes(&mut self) {
        self.lanes = None;
    }

    /// The integrator of a single run.
    pub fn one(&mut self) -> &mut AnyIntegrator {
        &mut self.one
    }

    /// Where the legs end, in their order; as [`Batch::flow`].
    pub fn flow(&mut self, legs: &[Leg], observer: LegObserver<'_>) -> Vec<Result<Vector>> {
        let law = self.lanes.as_ref().map(|(law, _)| *law);
        let in_lanes = |leg: &Leg| leg.lane.filter(|(of_leg, _)| Some(*of_leg) == law);
        let runs: Option<Vec<BatchRun>> = legs
            .iter()
            .map(|leg| {
                in_lanes(leg).map(|(_, loading)| BatchRun {
                    loading,
                    start: state(leg.start.as_slice()),
                    t: leg.t,
                })
            })
            .collect();
        if let (Some(runs), Some((_, batch))) = (runs, &mut self.lanes) {
            let mut see =
                |k: usize, step: &Step<'_, 3>| AnyStep::of(step, 3, |step| observer(k, step));
            let ends = batch.flow(&runs, Some(&mut see));
            return ends.into_iter().map(|end| Ok(vector(&end?))).collect();
        }
        let one = |(k, leg): (usize, &Leg)| {
            let mut see = |step: &AnyStep<'_>| observer(k, step);
            self.one.flow(&leg.field, leg.t, &leg.start, Some(&mut see))
        };
        legs.iter().enumerate().map(one).collect()
    }
}
