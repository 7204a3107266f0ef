//! From a plan to rows: one flow, watched only as far as the plan needs.

use super::column::Column;
use super::estimate::{estimate, timed};
use super::event::{Detector, SlipEvent};
use super::instant::{Instant, pictured_columns};
use super::plan::{Dimension, Plan, Sampling};
use super::slip::{Slips, at, slips};
use crate::error::{Error, Result};
use crate::field::State;
use crate::integrate::{Control, Step, Work};
use crate::model::{self, Driven};
use crate::number::DoubleDouble;

/// Points of a picture in each step: steps are long where the solution is smooth, and a polygon would show.
pub(super) const PICTURED: usize = 4;

/// Steps that pass unseen where only the end is shown: some microseconds.
pub(super) const RESTS: u32 = 63;

/// Takes what a run yields, as it comes.
pub trait Sink {
    /// A row, in the plan's columns and the user's units.
    fn row(&mut self, row: &[f64]) -> Control;
    /// A point of the picture, in the columns [`pictured_columns`] and the user's units.
    fn drawn(&mut self, _point: &[f64]) {}
    /// The run has come to this fraction of its time.
    fn reached(&mut self, fraction: f64) -> Control;
}

/// What a run came to.
#[derive(Debug, Clone, PartialEq)]
#[non_exhaustive]
pub struct RunOutcome {
    /// The last row, in all columns asked for; `None` if a run that nobody watched failed.
    pub last: Option<Vec<f64>>,
    /// The events, dimensionless.
    pub events: Vec<SlipEvent>,
    /// What it cost, the second run of an error estimate included.
    pub work: Work,
    /// Estimate of the relative global error of the last row, largest of stress and states, not below it; `None` where not
    /// asked for or not known.
    pub error_estimate: Option<f64>,
    /// Why the error could not be estimated.
    pub estimate_failure: Option<Error>,
    /// Why it ended early, in the user's units.
    pub failure: Option<Error>,
    /// Whether the sink stopped it.
    pub stopped: bool,
}

/// Runs a plan.
///
/// # Errors
/// [`Error::Parameter`] if the integrator refuses its settings; a failure on the way is in [`RunOutcome::failure`].
pub fn run(plan: &Plan, sink: &mut dyn Sink) -> Result<RunOutcome> {
    let (law, loading) = (plan.system.law, plan.loading);
    let (tau, [first, second]) = plan.start;
    let y = State::<2>::new(tau, first);
    match plan.dimension {
        Dimension::Single => flow(plan, &*model::single_interface(law, loading), y, sink),
        Dimension::Symmetric => flow(plan, &*model::symmetric(law, loading), y, sink),
        Dimension::Full => {
            let y = State::<3>::new(tau, first, second);
            flow(plan, &*model::two_interfaces(law, loading), y, sink)
        }
    }
}

fn flow<const N: usize>(
    plan: &Plan,
    field: &dyn Driven<N>,
    y0: State<N>,
    sink: &mut dyn Sink,
) -> Result<RunOutcome> {
    let mut integrator = plan
        .method
        .integrator::<N>(plan.tolerances, plan.max_steps)?;
    let mut watch = RunObserver::new(plan, field, &y0, &mut *sink);
    watch.start();
    let span = (0.0, plan.until);
    let end = if plan.observed() {
        let mut observer = |step: &Step<'_, N>| watch.see(step);
        integrator.flow(as_field(field), span, &y0, Some(&mut observer))
    } else {
        integrator.flow(as_field(field), span, &y0, None)
    };
    let mut outcome = watch.finish(&end);
    outcome.work = integrator.work();
    match (end, plan.estimate) {
        (Ok(y), Some(companion)) if !outcome.stopped => estimate(
            companion,
            plan,
            as_field(field),
            &y0,
            &y,
            &mut outcome,
            sink,
        )?,
        (Err(error @ (Error::BlowUp { .. } | Error::TooFast { .. })), _) => {
            let timed = timed(error, plan, as_field(field), &y0, &mut outcome, sink)?;
            outcome.failure = Some(timed);
        }
        _ => {}
    }
    let told = |error: Error| plan.system.units.told(error);
    outcome.failure = outcome.failure.map(told);
    outcome.estimate_failure = outcome.estimate_failure.map(told);
    Ok(outcome)
}

fn as_field<const N: usize>(field: &dyn Driven<N>) -> &dyn crate::field::VectorField<N> {
    field
}

/// Sees the steps of a run and makes rows, slips and events of them.
struct RunObserver<'a, const N: usize> {
    plan: &'a Plan,
    field: &'a dyn Driven<N>,
    sink: &'a mut dyn Sink,
    detector: Option<Detector<'a, N>>,
    /// Whether nothing but the end is shown.
    only_end: bool,
    /// The end of the last step seen.
    here: Instant,
    /// The slips there, in all digits.
    slips: Slips,
    row: Vec<f64>,
    pictured: Vec<Column<Instant>>,
    /// Rows at fixed times made so far.
    sampled: usize,
    stopped: bool,
}

impl<'a, const N: usize> RunObserver<'a, N> {
    fn new(
        plan: &'a Plan,
        field: &'a dyn Driven<N>,
        y0: &State<N>,
        sink: &'a mut dyn Sink,
    ) -> Self {
        RunObserver {
            plan,
            field,
            sink,
            detector: plan
                .events
                .map(|threshold| Detector::new(field, plan, threshold)),
            only_end: plan.sampling == Sampling::FinalOnly
                && plan.events.is_none()
                && !plan.picture,
            here: Instant::new(plan.system.law, 0.0, y0, [0.0; 2]),
            slips: [DoubleDouble::ZERO; 2],
            row: Vec::new(),
            pictured: pictured_columns(plan.system.interfaces),
            sampled: 0,
            stopped: false,
        }
    }

    fn start(&mut self) {
        if self.plan.picture {
            let here = self.here;
            self.draw(&here);
        }
        if self.plan.sampling != Sampling::FinalOnly {
            let here = self.here;
            self.emit(&here);
            self.sampled = 1;
        }
    }

    fn see(&mut self, step: &Step<'_, N>) -> Result<Control> {
        let field = self.field;
        let before = self.slips;
        if let Some(detector) = &mut self.detector {
            detector.see(step, &before)?;
        }
        let needs_slip = self.plan.needs_slip();
        let slip = |t: f64| {
            if needs_slip {
                slips(field, step, &before, t)
            } else {
                before
            }
        };
        let law = self.plan.system.law;
        let instant = |t: f64| Instant::new(law, t, &at(step, t), slip(t).map(DoubleDouble::hi));
        while let Some(t) = self.next_sample().filter(|&t| t <= step.t1) {
            self.emit(&instant(t));
            self.sampled += 1;
        }
        if self.plan.picture {
            for part in 1..=PICTURED {
                let t = step.t0 + (step.t1 - step.t0) * part as f64 / PICTURED as f64;
                self.draw(&Instant::new(law, t, &at(step, t), [0.0; 2]));
            }
        }
        self.slips = slip(step.t1);
        if self.plan.sampling == Sampling::EveryStep {
            let here = Instant::new(law, step.t1, step.y1, self.slips.map(DoubleDouble::hi));
            self.emit(&here);
        }
        Ok(self.reached(step))
    }

    /// The run has come to the end of this step.
    fn reached(&mut self, step: &Step<'_, N>) -> Control {
        self.here.time = step.t1;
        self.here.stress = step.y1[0];
        self.here.log_state = [step.y1[1], step.y1[N - 1]];
        self.here.slip = self.slips.map(DoubleDouble::hi);
        if self.sink.reached(step.t1 / self.plan.until) == Control::Stop {
            self.stopped = true;
        }
        match (self.stopped, self.only_end) {
            (true, _) => Control::Stop,
            (false, true) => Control::Rest(RESTS),
            (false, false) => Control::Continue,
        }
    }

    /// The next fixed time of a row.
    fn next_sample(&self) -> Option<f64> {
        self.plan.sampling.time(self.sampled, self.plan.until)
    }

    fn draw(&mut self, at: &Instant) {
        fill(&mut self.row, &self.pictured, self.plan, at);
        self.sink.drawn(&self.row);
    }

    fn emit(&mut self, at: &Instant) {
        fill(&mut self.row, &self.plan.columns, self.plan, at);
        if self.sink.row(&self.row) == Control::Stop {
            self.stopped = true;
        }
    }

    fn finish(mut self, end: &Result<State<N>>) -> RunOutcome {
        let plan = self.plan;
        let known = end.is_ok() || plan.observed();
        if let Ok(y) = end
            && !self.stopped
        {
            self.here = Instant::new(plan.system.law, plan.until, y, self.here.slip);
        }
        if plan.sampling == Sampling::FinalOnly && end.is_ok() && !self.stopped {
            let here = self.here;
            self.emit(&here);
        }
        fill(&mut self.row, &plan.columns, plan, &self.here);
        RunOutcome {
            last: known.then_some(self.row),
            events: self.detector.map_or_else(Vec::new, Detector::into_events),
            work: Work::default(),
            error_estimate: None,
            estimate_failure: None,
            failure: end.as_ref().err().cloned(),
            stopped: self.stopped,
        }
    }
}

/// Fills a row with the columns at an instant, in the user's units.
fn fill(row: &mut Vec<f64>, columns: &[Column<Instant>], plan: &Plan, at: &Instant) {
    let units = &plan.system.units;
    row.clear();
    row.extend(columns.iter().map(|column| column.number(at, units)));
}
