//! From a plan to rows: one flow, or one for each stretch of a program, watched only as far as the plan needs.

use super::equations::Equations;
use super::estimate::{estimate, timed};
use super::event::SlipEvent;
use super::holds::HoldOfRun;
use super::many::{Catalogue, ManyCheckpoint};
use super::observer::RunObserver;
use super::plan::Plan;
use super::program::Stretch;
use super::system::Described;
use twinslip::error::{Error, Result};
use twinslip::field::Vector;
use twinslip::integrate::{AnyIntegrator, AnyObserver, AnyStep, Control, MotionUnits, Work};

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
    /// The holds of its program.
    pub holds: Vec<HoldOfRun>,
    /// The slip events of a run of many interfaces, where they are asked for.
    pub catalogue: Option<Catalogue>,
    /// What it cost, the second run of an error estimate included.
    pub work: Work,
    /// Estimate of the global error of the last row, the largest of all states, not below it: relative to stress and psi, and of a
    /// user-defined system in units of 1 + |x|. `None` where not asked for or not known.
    pub error_estimate: Option<f64>,
    /// Estimates of the global errors of all states at the end, not below them, in the user's units; `None` where not asked for or not
    /// known.
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
        plan,
        watch: RunObserver::new(plan, &mut *sink),
        units: plan.units.clone(),
        work: Work::default(),
    };
    let end = along(plan, |part, from| {
        run.watch.begin(part.stretch, &from);
        match part.is_empty() {
            true => Ok((from, false)),
            false => run.part(part, from),
        }
    });
    let Run {
        watch, units, work, ..
    } = run;
    let end = end.map_err(|error| of_run(plan, error));
    if let Err(error @ Error::Parameter { .. }) = end {
        return Err(error);
    }
    let mut outcome = watch.finish(&end);
    outcome.work = work;
    match (end, plan.estimate) {
        (Ok(end), Some(companion)) if !outcome.stopped => {
            estimate(companion, plan, (&end, &units), &mut outcome, sink);
        }
        (Err(error @ (Error::BlowUp { .. } | Error::TooFast { .. })), _) => {
            outcome.failure = Some(timed(error, plan, &mut outcome, sink)?);
        }
        _ => {}
    }
    let told = |error: Error| plan.system.units().told(error);
    outcome.failure = outcome.failure.map(told);
    outcome.estimate_failure = outcome.estimate_failure.map(told);
    Ok(outcome)
}

/// A run on its way.
struct Run<'a> {
    plan: &'a Plan,
    watch: RunObserver<'a>,
    /// They grow as states come far beyond them.
    units: MotionUnits,
    work: Work,
}

impl Run<'_> {
    /// Goes along a part; where it ends, and whether to go no further.
    fn part(&mut self, part: &Part<'_>, from: Vector) -> Result<(Vector, bool)> {
        /// How often units grow: where states go to infinity nothing is to be gained.
        const LEGS: usize = 8;
        let plan = self.plan;
        let (mut now, end) = part.stretch.span;
        let mut legs = 1;
        let mut here = part.units(&self.units).inward(&from);
        let have_logarithms = part.equations.have_logarithms();
        let sinks = have_logarithms.contains(&true);
        loop {
            let units = part.units(&self.units);
            self.watch.in_units(&units);
            let field = part.equations.field(&units)?;
            let left = steps_left(plan, part.stretch, &self.work)?;
            let tolerances = units.inward_tolerances(plan.tolerances, plan.atol_is_given);
            let mut integrator = AnyIntegrator::new(plan.method, tolerances, left)?;
            let grow = !plan.atol_is_given && !part.equations.keep_units() && legs < LEGS;
            let mut outgrown = None;
            let watch = &mut self.watch;
            let mut observer = |step: &AnyStep<'_>| {
                let told = match plan.observed() {
                    true => watch.see(&field, step)?,
                    false => Control::Rest(RESTS),
                };
                if told == Control::Stop {
                    return Ok(told);
                }
                let sunken = sinks.then(|| units.sunken(&have_logarithms, step.y1));
                let larger = || grow.then(|| units.outgrown(step.y1)).flatten();
                if let Some(larger) = sunken.flatten().or_else(larger) {
                    let reached = units.moved(&larger, step.y1);
                    outgrown = Some((step.t1 * units.time, reached, larger));
                    return Ok(Control::Stop);
                }
                Ok(told)
            };
            let seen = plan.observed() || grow || sinks;
            let observer = seen.then_some(&mut observer as AnyObserver<'_>);
            let span = (now / units.time, end / units.time);
            let reached = integrator.flow(&field, span, &here, observer);
            self.work += integrator.work();
            match (reached, outgrown) {
                (Ok(_), Some((time, state, larger))) if time < end => {
                    (now, here, self.units) = (time, state, larger);
                    legs += 1;
                }
                (Ok(state), _) => return Ok((units.outward(&state), self.watch.stopped())),
                (Err(error), _) => return Err(units.outward_error(error, 0)),
            }
        }
    }
}

/// A stretch of a run with its equations.
pub(super) struct Part<'a> {
    pub stretch: &'a Stretch,
    pub equations: &'a Equations<'a>,
}

impl Part<'_> {
    /// A run that ends with a change has an end on the far side of that.
    pub fn is_empty(&self) -> bool {
        self.stretch.span.0 == self.stretch.span.1
    }

    /// On a ramp V_H is a variable more.
    pub fn units(&self, of_run: &MotionUnits) -> MotionUnits {
        match self.equations.keep_units() {
            true => MotionUnits::given(self.equations.variables()),
            false => of_run.clone(),
        }
    }
}

/// Goes along all stretches of a plan: each begins where the last has ended, or at a node.
pub(super) fn along(
    plan: &Plan,
    mut by: impl FnMut(&Part<'_>, Vector) -> Result<(Vector, bool)>,
) -> Result<Vector> {
    let count = plan.start.len();
    let mut here = plan.start.clone();
    for (i, stretch) in plan.stretches()?.into_iter().enumerate() {
        if let Some((_, node)) = i.checked_sub(1).and_then(|i| plan.nodes.get(i)) {
            here.clone_from(node);
        }
        let equations = plan.system.on(&stretch, plan.subspace)?;
        let part = Part {
            stretch: &stretch,
            equations: &equations,
        };
        if equations.has_driving(count) {
            here = here.push(stretch.driving.0);
        }
        if equations.is_timed() {
            here = here.push(stretch.span.0);
        }
        let (end, stopped) = by(&part, here)?;
        here = end.rows(0, count).into_owned();
        if stopped {
            break;
        }
    }
    Ok(here)
}

/// How many steps a run may still take that comes to this stretch.
pub(super) fn steps_left(plan: &Plan, stretch: &Stretch, work: &Work) -> Result<usize> {
    match plan.max_steps.saturating_sub(work.steps) {
        0 => Err(Error::TooManySteps {
            t: stretch.span.0,
            end: plan.until,
            limit: plan.max_steps,
        }),
        left => Ok(left),
    }
}

/// The error of a stretch as one of the run.
pub(super) fn of_run(plan: &Plan, error: Error) -> Error {
    match error {
        Error::TooManySteps { t, .. } => Error::TooManySteps {
            t,
            end: plan.until,
            limit: plan.max_steps,
        },
        other => other,
    }
}
