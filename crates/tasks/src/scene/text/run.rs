//! A run of a user-defined system: from a plan to rows.

use super::observer::TextObserver;
use super::plan::TextPlan;
use crate::scene::estimate::{Companion, GROWTH, MARGIN, PIECES, ROUNDING, confirmed};
use crate::scene::program::Stretch;
use crate::scene::run::{RESTS, RunOutcome, Sink};
use twinslip::error::{Error, Result};
use twinslip::field::{Matrix, Vector};
use twinslip::integrate::{
    AnyField, AnyIntegrator, AnyObserver, AnyStep, Choice, Control, MotionUnits, Tolerances, Work,
};
use twinslip::model::TextSystem;

/// Runs a plan.
///
/// # Errors
/// [`Error::Parameter`] if the integrator refuses its settings; a failure on the way is in [`RunOutcome::failure`].
pub fn run_text(plan: &TextPlan, sink: &mut dyn Sink) -> Result<RunOutcome> {
    let mut run = Run {
        plan,
        watch: TextObserver::new(plan, &mut *sink),
        units: plan.units.clone(),
        work: Work::default(),
    };
    let end = along(plan, |part, from| {
        run.watch.begin(part.stretch, &from);
        match part.is_empty() {
            true => Ok((from, false)),
            false => run.stretch(part, from),
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
            // What came to be followed by its logarithm is so from the start.
            let begins = MotionUnits {
                signs: units.signs.clone(),
                ..plan.units.clone()
            };
            let second = second_run((companion, &begins), plan, &mut outcome, sink);
            let found = second
                .and_then(|second| errors(plan, (&end, &second), (&begins, &units), &mut outcome));
            match found {
                Ok(errors) => {
                    let sizes = errors.iter().zip(&end).enumerate();
                    let slides = plan.model.slab.is_some();
                    // The stress relatively; what ln psi errs by is the relative error of psi.
                    let size = |(i, (error, x)): (usize, (&f64, &f64))| match (slides, i) {
                        (false, _) => error / (units.sizes[i] + x.abs()),
                        (true, 0) => error / x.abs(),
                        (true, _) => *error,
                    };
                    let sizes: Vec<f64> = sizes.map(size).collect();
                    let known = sizes.iter().all(|x| x.is_finite());
                    outcome.error_estimate =
                        known.then(|| sizes.iter().fold(0.0, |a: f64, x| a.max(*x)));
                    outcome.errors = Some(errors);
                }
                Err(Error::Interrupted) => outcome.stopped = true,
                Err(error) => outcome.estimate_failure = Some(error),
            }
        }
        (Err(error @ (Error::BlowUp { .. } | Error::TooFast { .. })), _) => {
            let companion = Companion::of(plan.tolerances, false);
            let second = second_run((companion, &plan.units), plan, &mut outcome, sink);
            outcome.failure = Some(confirmed(error, second.err()));
        }
        _ => {}
    }
    Ok(outcome)
}

/// A run on its way.
struct Run<'a> {
    plan: &'a TextPlan,
    watch: TextObserver<'a>,
    /// They grow as states come far beyond them.
    units: MotionUnits,
    work: Work,
}

impl Run<'_> {
    /// Goes along a stretch; where it ends, and whether to go no further.
    fn stretch(&mut self, part: &Part<'_>, from: Vector) -> Result<(Vector, bool)> {
        /// How often units grow: where states go to infinity nothing is to be gained.
        const LEGS: usize = 8;
        let plan = self.plan;
        let (mut now, end) = part.stretch.span;
        let mut legs = 1;
        let mut here = part.units(&self.units).inward(&from);
        // Interfaces keep their units, and what they are followed by.
        let have_logarithms = match part.slides {
            true => Vec::new(),
            false => part.system.have_logarithms(),
        };
        let sinks = have_logarithms.contains(&true);
        loop {
            let units = part.units(&self.units);
            self.watch.in_units(&units);
            let field = units.field(part.system)?;
            let left = steps_left(plan, part.stretch, &self.work)?;
            let tolerances = units.inward_tolerances(plan.tolerances, plan.atol_is_given);
            let mut integrator = AnyIntegrator::new(plan.method, tolerances, left)?;
            let grow = !plan.atol_is_given && !part.slides && legs < LEGS;
            let mut outgrown = None;
            let watch = &mut self.watch;
            let mut observer = |step: &AnyStep<'_>| {
                let told = match plan.observed() {
                    true => watch.see(part.system, step),
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
struct Part<'a> {
    stretch: &'a Stretch,
    system: &'a TextSystem,
    /// Whether it has interfaces, which keep their units.
    slides: bool,
}

impl Part<'_> {
    /// A run that ends with a change has an end on the far side of that.
    fn is_empty(&self) -> bool {
        self.stretch.span.0 == self.stretch.span.1
    }

    /// On a ramp V_H is a variable more.
    fn units(&self, of_run: &MotionUnits) -> MotionUnits {
        match self.slides {
            true => MotionUnits::given(self.system.variables()),
            false => of_run.clone(),
        }
    }
}

/// Goes along all stretches of a run, on each from where the last has ended, to the bit, or from a node; `by` says where a stretch ends,
/// and whether to go no further.
fn along(
    plan: &TextPlan,
    mut by: impl FnMut(&Part<'_>, Vector) -> Result<(Vector, bool)>,
) -> Result<Vector> {
    let count = plan.start.len();
    let mut here = plan.start.clone();
    for (i, stretch) in plan.stretches()?.into_iter().enumerate() {
        if let Some((_, node)) = i.checked_sub(1).and_then(|i| plan.nodes.get(i)) {
            here.clone_from(node);
        }
        let system = plan.system_on(&stretch)?;
        let part = Part {
            stretch: &stretch,
            system: &system,
            slides: plan.model.slab.is_some(),
        };
        here = match part.system.states().len() > count {
            true => here.push(stretch.driving.0),
            false => plan.model.at_time(here, stretch.span.0),
        };
        let (end, stopped) = by(&part, here)?;
        here = end.rows(0, count).into_owned();
        if stopped {
            break;
        }
    }
    Ok(here)
}

/// How many steps a run may still take that comes to this stretch.
fn steps_left(plan: &TextPlan, stretch: &Stretch, work: &Work) -> Result<usize> {
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
fn of_run(plan: &TextPlan, error: Error) -> Error {
    match error {
        Error::TooManySteps { t, .. } => Error::TooManySteps {
            t,
            end: plan.until,
            limit: plan.max_steps,
        },
        other => other,
    }
}

/// The end of the run by another method, which begins in these units.
fn second_run(
    (companion, begins): (Companion, &MotionUnits),
    plan: &TextPlan,
    outcome: &mut RunOutcome,
    sink: &mut dyn Sink,
) -> Result<Vector> {
    along(plan, |part, from| {
        if part.is_empty() {
            return Ok((from, false));
        }
        let units = part.units(begins);
        let mut integrator = companion
            .in_time(units.time)
            .any_integrator(plan.max_steps)?;
        let mut stopped = false;
        let mut observer = |step: &AnyStep<'_>| {
            let told = sink.reached(step.t1 * units.time / plan.until);
            stopped |= told == Control::Stop;
            Ok(told)
        };
        let (begin, end) = part.stretch.span;
        let span = (begin / units.time, end / units.time);
        let field = units.field(part.system)?;
        let end = integrator.flow(&field, span, &units.inward(&from), Some(&mut observer));
        outcome.work += integrator.work();
        if stopped {
            return Err(Error::Interrupted);
        }
        let end = end.map_err(|error| units.outward_error(error, 0))?;
        Ok((units.outward(&end), false))
    })
}

/// The error of every state at the end: what the second run says, which began in the first units, and what becomes of the rounding of the start.
/// The states have come as far as `reached`.
fn errors(
    plan: &TextPlan,
    (end, second): (&Vector, &Vector),
    (begins, reached): (&MotionUnits, &MotionUnits),
    outcome: &mut RunOutcome,
) -> Result<Vec<f64>> {
    let tolerances = Tolerances::equal(GROWTH)?.stepping(plan.tolerances.max_step);
    let tolerances = begins.inward_tolerances(tolerances, false);
    let mut integrator = AnyIntegrator::new(Choice::Auto, tolerances, plan.max_steps)?;
    let count = plan.start.len();
    let mut tangent = Matrix::identity(count, count);
    let pieces = (PIECES / plan.stretches()?.len()).max(1);
    along(plan, |part, from| {
        let units = part.units(begins);
        let field = units.field(part.system)?;
        let (begin, end) = part.stretch.span;
        let (begin, end) = (begin / units.time, end / units.time);
        let time = |piece: usize| begin + (end - begin) * (piece as f64 / pieces as f64);
        let mut y = units.inward(&from);
        for piece in 0..pieces {
            if part.is_empty() {
                break;
            }
            let span = (time(piece), time(piece + 1));
            let by_differences = part.system.takes_powers();
            let (next, grown) = growth(&mut integrator, &field, span, &y, by_differences)?;
            outcome.work += integrator.work();
            y = next;
            // V_H and time are exact, where they are variables.
            tangent = grown.view((0, 0), (count, count)) * &tangent;
        }
        Ok((units.outward(&y), false))
    })?;
    // The rounding of a value is that of its logarithm, beside the logarithm's own.
    let start = begins.inward(&plan.start);
    let rounded = |i: usize| {
        let own = begins.signs[i].abs();
        0.5 * f64::EPSILON * (own + start[i].abs())
    };
    let last = begins.inward(end);
    // What is exact moves nothing, however much it would grow.
    let moved = |i: usize| -> f64 {
        let inexact = (0..count).filter(|&j| rounded(j) != 0.0);
        let all: f64 = inexact.map(|j| tangent[(i, j)].abs() * rounded(j)).sum();
        begins.outward_error_of(i, last[i], all)
    };
    let error = |i: usize| {
        let rounding = ROUNDING * (reached.sizes[i] + end[i].abs());
        MARGIN * (end[i] - second[i]).abs() + moved(i) + rounding
    };
    Ok((0..count).map(error).collect())
}

/// The state at the end of a span with its derivatives in the start, of which a digit will do: by differences if this is asked for, as where slopes may
/// be infinite, and where a formula has no derivatives on the way, as where it overflows and its inverse is 0.
fn growth(
    integrator: &mut AnyIntegrator,
    field: &AnyField<'_>,
    span: (f64, f64),
    y: &Vector,
    by_differences: bool,
) -> Result<(Vector, Matrix)> {
    /// The distance of the starts, in units of a variable, or of the largest where that is 0: far above the tolerance.
    const APART: f64 = 1e-3;
    if !by_differences && let Ok((next, grown)) = integrator.derivatives(field, span, y, &[]) {
        return Ok((next, grown.start));
    }
    let next = integrator.flow(field, span, y, None)?;
    let columns = (0..y.len()).map(|i| {
        let sizes = [y[i].abs(), y.amax(), 1.0];
        let distance = APART * sizes.into_iter().find(|size| *size > 0.0).unwrap_or(1.0);
        let mut beside = y.clone();
        beside[i] += distance;
        let there = integrator.flow(field, span, &beside, None)?;
        Ok((there - &next) / distance)
    });
    let columns: Vec<Vector> = columns.collect::<Result<_>>()?;
    Ok((next, Matrix::from_columns(&columns)))
}
