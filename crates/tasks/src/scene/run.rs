//! From a plan to rows: one flow, or one for each stretch of a program, watched only as far as the plan needs.

use super::column::Column;
use super::estimate::{estimate, timed};
use super::event::{Detector, SlipEvent};
use super::instant::Instant;
use super::many::{Catalogue, ManyCheckpoint};
use super::plan::{Plan, Point, Sampling};
use super::program::Stretch;
use super::slip::{Slips, at, slips};
use super::stretch::{Along, as_field, go, of_run, point, steps_left};
use twinslip::error::{Error, Result};
use twinslip::field::State;
use twinslip::integrate::{Control, Step, Work};
use twinslip::model::Driven;
use twinslip::number::DoubleDouble;

/// Points of a picture in each step: steps are long where the solution is smooth, and a polygon would show.
pub(super) const PICTURED: usize = 4;

/// Steps that pass unseen where only the end is shown: some microseconds.
pub(super) const RESTS: u32 = 63;

/// Takes what a run yields, as it comes.
pub trait Sink {
    /// A row, in the plan's columns and the user's units.
    fn row(&mut self, row: &[f64]) -> Control;
    /// A point of the picture, in the columns [`Plan::pictured`] and the user's units.
    fn drawn(&mut self, _point: &[f64]) {}
    /// The run has come to this fraction of its time.
    fn reached(&mut self, fraction: f64) -> Control;
    /// Keeps what a run of many interfaces needs to go on after the rows so far.
    ///
    /// # Errors
    /// What keeps it from being written.
    fn save(&mut self, _checkpoint: &ManyCheckpoint) -> Result<()> {
        Ok(())
    }
}

/// What a run came to.
#[derive(Debug, Clone, PartialEq)]
pub struct RunOutcome {
    /// The last row, in all columns asked for; `None` if a run that nobody watched failed.
    pub last: Option<Vec<f64>>,
    /// The events, dimensionless.
    pub events: Vec<SlipEvent>,
    /// The slip events of a run of many interfaces, where they are asked for.
    pub catalogue: Option<Catalogue>,
    /// What it cost, the second run of an error estimate included.
    pub work: Work,
    /// Estimate of the global error of the last row, the largest of all states, not below it: relative to stress and psi, and of a
    /// user-defined system in units of 1 + |x|. `None` where not asked for or not known.
    pub error_estimate: Option<f64>,
    /// Estimates of the global errors of all states of a user-defined system at its end, not below them; `None` where not asked for or
    /// not known, and of interfaces that are built in.
    pub errors: Option<Vec<f64>>,
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
    let mut run = Run {
        watch: RunObserver::new(plan, &mut *sink),
        work: Work::default(),
    };
    let end = go(plan, &mut run);
    if let Err(error @ Error::Parameter { .. }) = end {
        return Err(error);
    }
    let Run { watch, work } = run;
    let mut outcome = watch.finish(&end);
    outcome.work = work;
    match (end, plan.estimate) {
        (Ok(end), Some(companion)) if !outcome.stopped => {
            estimate(companion, plan, &end, &mut outcome, sink)?;
        }
        (Err(error @ (Error::BlowUp { .. } | Error::TooFast { .. })), _) => {
            outcome.failure = Some(timed(error, plan, &mut outcome, sink)?);
        }
        _ => {}
    }
    let told = |error: Error| plan.system.units.told(error);
    outcome.failure = outcome.failure.map(told);
    outcome.estimate_failure = outcome.estimate_failure.map(told);
    Ok(outcome)
}

/// The run itself, along its stretches: on each the integrator starts anew.
struct Run<'a> {
    watch: RunObserver<'a>,
    work: Work,
}

impl Along for Run<'_> {
    fn along<const N: usize>(
        &mut self,
        stretch: &Stretch,
        field: &dyn Driven<N>,
        from: &State<N>,
    ) -> Result<State<N>> {
        let (plan, span) = (self.watch.plan, stretch.span);
        self.watch.begin(stretch, field, from);
        if span.0 == span.1 {
            return Ok(*from);
        }
        let left = steps_left(plan, stretch, &self.work)?;
        let mut integrator = plan.method.integrator::<N>(plan.tolerances, left)?;
        let end = if plan.observed() {
            let mut observer = |step: &Step<'_, N>| self.watch.see(field, step);
            integrator.flow(as_field(field), span, from, Some(&mut observer))
        } else {
            integrator.flow(as_field(field), span, from, None)
        };
        self.work += integrator.work();
        end.map_err(|error| of_run(plan, error))
    }

    fn stopped(&self) -> bool {
        self.watch.stopped
    }
}

/// Sees the steps of a run and makes rows, slips and events of them.
struct RunObserver<'a> {
    plan: &'a Plan,
    sink: &'a mut dyn Sink,
    detector: Option<Detector>,
    /// Whether nothing but the end is shown.
    only_end: bool,
    /// How V_H is here.
    stretch: Stretch,
    /// The end of the last step seen.
    here: Instant,
    /// The slips there, in all digits.
    slips: Slips,
    row: Vec<f64>,
    pictured: Vec<Column<Instant>>,
    /// Rows at fixed times made so far.
    sampled: usize,
    /// How many stretches have begun.
    begun: usize,
    /// The time of the last row.
    shown: Option<f64>,
    stopped: bool,
}

impl<'a> RunObserver<'a> {
    fn new(plan: &'a Plan, sink: &'a mut dyn Sink) -> Self {
        let (laws, driving) = (plan.system.laws(), plan.loading.driving);
        let (stress, log_state) = plan.start;
        RunObserver {
            plan,
            sink,
            detector: plan
                .detected()
                .map(|threshold| Detector::new(plan, threshold)),
            only_end: plan.sampling == Sampling::FinalOnly
                && plan.events.is_none()
                && !plan.picture,
            stretch: Stretch::new((0.0, 0.0), (driving, driving)),
            here: Instant {
                laws,
                time: 0.0,
                stress,
                log_state,
                slip: [0.0; 2],
                driving,
            },
            slips: [DoubleDouble::ZERO; 2],
            row: Vec::new(),
            pictured: plan.pictured(),
            sampled: 0,
            begun: 0,
            shown: None,
            stopped: false,
        }
    }

    /// A stretch begins: the first one with the first row, the others with one at either side of a change.
    fn begin<const N: usize>(&mut self, stretch: &Stretch, field: &dyn Driven<N>, from: &State<N>) {
        let first = self.begun == 0;
        self.begun += 1;
        if let Some(detector) = &mut self.detector {
            detector.begin(stretch, field, from, &self.slips);
        }
        let rows = self.plan.sampling != Sampling::FinalOnly;
        let changes = !first && stretch.from.is_none();
        if rows && changes && self.shown != Some(stretch.span.0) {
            let before = self.here;
            self.emit(&before);
        }
        let jumps = stretch.driving.0 != self.stretch.driving.1;
        self.stretch = *stretch;
        let slips = self.slips.map(DoubleDouble::hi);
        self.here = Instant {
            driving: stretch.driving.0,
            ..self.here.at(stretch.span.0, point(self.plan, from), slips)
        };
        let here = self.here;
        if self.plan.picture {
            self.draw(&here);
        }
        if rows && (first || jumps) {
            self.emit(&here);
        }
        if first && rows {
            self.sampled = 1;
        }
    }

    fn see<const N: usize>(
        &mut self,
        field: &dyn Driven<N>,
        step: &Step<'_, N>,
    ) -> Result<Control> {
        let before = self.slips;
        if let Some(detector) = &mut self.detector {
            detector.see(field, step, &before)?;
        }
        let needs_slip = self.plan.needs_slip();
        let slip = |t: f64| {
            if needs_slip {
                slips(field, step, &before, t)
            } else {
                before
            }
        };
        let (plan, here, stretch) = (self.plan, self.here, self.stretch);
        let instant = |t: f64, slips: Slips| Instant {
            driving: stretch.driving_at(t),
            ..here.at(t, point(plan, &at(step, t)), slips.map(DoubleDouble::hi))
        };
        while let Some(t) = self.next_sample().filter(|&t| t <= step.t1) {
            self.emit(&instant(t, slip(t)));
            self.sampled += 1;
        }
        if self.plan.picture {
            for part in 1..=PICTURED {
                let t = step.t0 + (step.t1 - step.t0) * part as f64 / PICTURED as f64;
                self.draw(&instant(t, before));
            }
        }
        self.slips = slip(step.t1);
        self.here = instant(step.t1, self.slips);
        if self.plan.sampling == Sampling::EveryStep {
            let here = self.here;
            self.emit(&here);
        }
        Ok(self.reached())
    }

    /// The run has come to the end of a step.
    fn reached(&mut self) -> Control {
        if self.sink.reached(self.here.time / self.plan.until) == Control::Stop {
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
        let plan = self.plan;
        let end = match plan.program {
            Some(_) => self.stretch.span.1,
            None => plan.until,
        };
        let units = &plan.system.units;
        plan.sampling.time(self.sampled, (plan.until, end), units)
    }

    fn draw(&mut self, at: &Instant) {
        fill(&mut self.row, &self.pictured, self.plan, at);
        self.sink.drawn(&self.row);
    }

    fn emit(&mut self, at: &Instant) {
        fill(&mut self.row, &self.plan.columns, self.plan, at);
        self.shown = Some(at.time);
        if self.sink.row(&self.row) == Control::Stop {
            self.stopped = true;
        }
    }

    fn finish(mut self, end: &Result<Point>) -> RunOutcome {
        let plan = self.plan;
        let known = end.is_ok() || plan.observed();
        if let Ok(point) = end
            && !self.stopped
        {
            self.here = Instant {
                driving: self.stretch.driving.1,
                ..self.here.at(plan.until, *point, self.here.slip)
            };
        }
        if plan.sampling == Sampling::FinalOnly && end.is_ok() && !self.stopped {
            let here = self.here;
            self.emit(&here);
        }
        fill(&mut self.row, &plan.columns, plan, &self.here);
        RunOutcome {
            last: known.then_some(self.row),
            events: self.detector.map_or_else(Vec::new, Detector::into_events),
            catalogue: None,
            work: Work::default(),
            error_estimate: None,
            errors: None,
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
