//! A run of a system of one's own: from a plan to rows.

use super::observer::TextObserver;
use super::plan::TextPlan;
use crate::error::{Error, Result};
use crate::field::{Matrix, Vector};
use crate::integrate::{AnyField, AnyIntegrator, AnyStep, Choice, Control, Tolerances, Work};
use crate::model::TextSystem;
use crate::scene::estimate::{Companion, GROWTH, MARGIN, PIECES, ROUNDING, confirmed};
use crate::scene::program::Stretch;
use crate::scene::run::{RunOutcome, Sink};
use std::borrow::Cow;

/// Runs a plan.
///
/// # Errors
/// [`Error::Parameter`] if the integrator refuses its settings; a failure on the way is in [`RunOutcome::failure`].
pub fn run_text(plan: &TextPlan, sink: &mut dyn Sink) -> Result<RunOutcome> {
    let mut watch = TextObserver::new(plan, &mut *sink);
    let mut work = Work::default();
    let end = along(plan, |part, from| {
        watch.begin(part.stretch, &from);
        if part.is_empty() {
            return Ok((from, false));
        }
        let left = steps_left(plan, part.stretch, &work)?;
        let mut integrator = AnyIntegrator::new(plan.method, plan.tolerances, left)?;
        let end = if plan.observed() {
            let mut observer = |step: &AnyStep<'_>| Ok(watch.see(part.system, step));
            integrator.flow(&part.field, part.stretch.span, &from, Some(&mut observer))
        } else {
            integrator.flow(&part.field, part.stretch.span, &from, None)
        };
        work += integrator.work();
        Ok((end?, watch.stopped()))
    });
    let end = end.map_err(|error| of_run(plan, error));
    if let Err(error @ Error::Parameter { .. }) = end {
        return Err(error);
    }
    let mut outcome = watch.finish(&end);
    outcome.work = work;
    match (end, plan.estimate) {
        (Ok(end), Some(companion)) if !outcome.stopped => {
            let second = second_run(companion, plan, &mut outcome, sink);
            match second.and_then(|second| errors(plan, &end, &second, &mut outcome)) {
                Ok(errors) => {
                    let sizes = errors.iter().zip(&end).enumerate();
                    let slides = plan.model.slab.is_some();
                    // The stress relatively; what ln psi errs by is the relative error of psi.
                    let size = |(i, (error, x)): (usize, (&f64, &f64))| match (slides, i) {
                        (false, _) => error / (1.0 + x.abs()),
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
            let second = second_run(companion, plan, &mut outcome, sink);
            outcome.failure = Some(confirmed(error, second.err()));
        }
        _ => {}
    }
    Ok(outcome)
}

/// A stretch of a run with its equations.
struct Part<'a> {
    stretch: &'a Stretch,
    system: &'a TextSystem,
    field: AnyField<'a>,
}

impl Part<'_> {
    /// A run that ends with a change has an end on the far side of that.
    fn is_empty(&self) -> bool {
        self.stretch.span.0 == self.stretch.span.1
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
            field: AnyField::of_text(Cow::Borrowed(&*system))?,
        };
        // On a ramp V_H is a state more.
        if part.field.dimension() > count {
            here = here.push(stretch.driving.0);
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

/// The end of the run by another method.
fn second_run(
    companion: Companion,
    plan: &TextPlan,
    outcome: &mut RunOutcome,
    sink: &mut dyn Sink,
) -> Result<Vector> {
    along(plan, |part, from| {
        if part.is_empty() {
            return Ok((from, false));
        }
        let mut integrator = companion.any_integrator(plan.max_steps)?;
        let mut stopped = false;
        let mut observer = |step: &AnyStep<'_>| {
            let told = sink.reached(step.t1 / plan.until);
            stopped |= told == Control::Stop;
            Ok(told)
        };
        let end = integrator.flow(&part.field, part.stretch.span, &from, Some(&mut observer));
        outcome.work += integrator.work();
        if stopped {
            return Err(Error::Interrupted);
        }
        Ok((end?, false))
    })
}

/// The error of every state at the end: what the second run says, and what becomes of the rounding of the start.
fn errors(
    plan: &TextPlan,
    end: &Vector,
    second: &Vector,
    outcome: &mut RunOutcome,
) -> Result<Vec<f64>> {
    let tolerances = Tolerances::equal(GROWTH)?.stepping(plan.tolerances.max_step);
    let mut integrator = AnyIntegrator::new(Choice::Auto, tolerances, plan.max_steps)?;
    let count = plan.start.len();
    let mut tangent = Matrix::identity(count, count);
    let pieces = (PIECES / plan.stretches()?.len()).max(1);
    along(plan, |part, from| {
        let (begin, end) = part.stretch.span;
        let time = |piece: usize| begin + (end - begin) * (piece as f64 / pieces as f64);
        let mut y = from;
        for piece in 0..pieces {
            if part.is_empty() {
                break;
            }
            let span = (time(piece), time(piece + 1));
            let (next, grown) = growth(&mut integrator, &part.field, span, &y)?;
            outcome.work += integrator.work();
            y = next;
            // V_H is exact, where it is a state.
            tangent = grown.view((0, 0), (count, count)) * &tangent;
        }
        Ok((y, false))
    })?;
    let rounded = plan.start.map(|x| 0.5 * f64::EPSILON * x.abs());
    // What is exact moves nothing, however much it would grow.
    let moved = |i: usize| -> f64 {
        let exact = |j: &usize| rounded[*j] == 0.0;
        let inexact = (0..count).filter(|j| !exact(j));
        inexact.map(|j| tangent[(i, j)].abs() * rounded[j]).sum()
    };
    let error =
        |i: usize| MARGIN * (end[i] - second[i]).abs() + moved(i) + ROUNDING * (1.0 + end[i].abs());
    Ok((0..count).map(error).collect())
}

/// The state at the end of a span with its derivatives in the start, of which a digit will do: by differences where a formula has no derivatives on the
/// way, as where it overflows and its inverse is 0.
fn growth(
    integrator: &mut AnyIntegrator,
    field: &AnyField<'_>,
    span: (f64, f64),
    y: &Vector,
) -> Result<(Vector, Matrix)> {
    /// The distance of the starts, in units of a variable, or of the largest where that is 0: far above the tolerance.
    const APART: f64 = 1e-3;
    if let Ok((next, grown)) = integrator.derivatives(field, span, y, &[]) {
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
