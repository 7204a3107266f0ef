//! The global error at the end of a run, from a second one.

use super::plan::Plan;
use super::run::{Part, RunOutcome, Sink, along, of_run, steps_left};
use super::system::Described;
use super::units::Quantity;
use twinslip::error::{Error, Result};
use twinslip::field::{Matrix, Vector};
use twinslip::integrate::{
    AnyField, AnyIntegrator, AnyObserver, AnyStep, Choice, Control, MotionUnits, Tolerances, Work,
};

/// How much tighter the second run is, so that its own error hardly counts: a run can err by a hundredth of what another of its tolerance errs by.
const TIGHTER: f64 = 1e4;
/// The tolerance from which on the second run is in double-double arithmetic.
const REFERENCE: f64 = 1e-12;
/// How much smaller its absolute tolerance is. A value that sinks below that of the run and grows again is lost there by any method;
/// the second run follows it.
const FOLLOWED: f64 = 1e-30;
/// And at most this: Taylor's order is then another than that of the run. Two runs of one order whose steps all end at the same kinks
/// would err alike.
const LOOSEST: f64 = 1e-7;
/// Its largest step over that of the run, where there is one, for the same reason.
const SHORTER: f64 = 0.7;
/// A tolerance below this gains nothing: rounding rules.
const TIGHTEST: f64 = 1e-14;
/// The second run's error, of which little is known but that it is small, is allowed for by this factor; with the reference it
/// allows for what rounding may still do within the run's own digits.
const MARGIN: f64 = 2.0;
/// Relative errors below this are rounding.
const ROUNDING: f64 = 4.0 * f64::EPSILON;
/// Spacings of the numbers around a time that its rounding, and that of what it follows from, may make.
const TIME_SPACINGS: f64 = 64.0;
/// Tolerance of the tangent flow that says how far the rounding of the start grows: a digit of it will do.
const GROWTH: f64 = 1e-6;
/// Pieces in which it goes, so that it can be stopped.
const PIECES: usize = 64;

/// The second run.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Companion {
    /// By `auto`, with a tighter relative tolerance and next to no absolute one.
    Tighter(Tolerances),
    /// In double-double arithmetic, with this largest step.
    Reference {
        /// [`Tolerances::max_step`]
        max_step: f64,
    },
}

impl Companion {
    /// What goes with a run of these tolerances: the reference where it is asked for, or where doubles end.
    pub fn of(tolerances: Tolerances, reference: bool) -> Self {
        let Tolerances { rtol, atol, .. } = tolerances;
        let max_step = tolerances.max_step * SHORTER;
        if reference || rtol < REFERENCE {
            Companion::Reference { max_step }
        } else {
            Companion::Tighter(Tolerances {
                rtol: (rtol / TIGHTER).clamp(TIGHTEST, LOOSEST),
                atol: f64::max(atol * FOLLOWED, f64::MIN_POSITIVE),
                max_step,
            })
        }
    }

    /// The same in this unit of time.
    fn in_time(mut self, unit: f64) -> Self {
        let (Companion::Tighter(Tolerances { max_step, .. }) | Companion::Reference { max_step }) =
            &mut self;
        *max_step /= unit;
        self
    }

    /// The method of the second run.
    fn integrator(self, max_steps: usize) -> Result<AnyIntegrator> {
        match self {
            Companion::Tighter(tolerances) => {
                AnyIntegrator::new(Choice::Auto, tolerances, max_steps)
            }
            Companion::Reference { max_step } => AnyIntegrator::reference(max_steps, max_step),
        }
    }
}

/// Puts the errors at the end of a run, and the work for them, into the outcome. The run has ended in these units.
pub(super) fn estimate(
    companion: Companion,
    plan: &Plan,
    (end, reached): (&Vector, &MotionUnits),
    outcome: &mut RunOutcome,
    sink: &mut dyn Sink,
) {
    // What came to be followed by its logarithm is so from the start.
    let begins = MotionUnits {
        signs: reached.signs.clone(),
        ..plan.units.clone()
    };
    // The reference takes long enough that one wants to see it move, and to stop it.
    let watched = plan.observed() || matches!(companion, Companion::Reference { .. });
    let second = second_run((companion, &begins, watched), plan, outcome, sink);
    let found =
        second.and_then(|second| errors(plan, (end, &second), (&begins, reached), outcome, sink));
    match found {
        Ok(errors) => {
            let slides = plan.system.slides();
            let sizes = errors.iter().zip(end).enumerate();
            let size = |(i, (error, x)): (usize, (&f64, &f64))| match (slides, i) {
                (false, _) => error / (reached.sizes[i] + x.abs()),
                (true, 0) => error / x.abs().max(f64::MIN_POSITIVE),
                // The relative error of psi, from that of ln psi.
                (true, _) => error.exp_m1(),
            };
            let sizes: Vec<f64> = sizes.map(size).collect();
            let known = sizes.iter().all(|x| x.is_finite());
            outcome.error_estimate = known.then(|| sizes.iter().fold(0.0, |a: f64, x| a.max(*x)));
            let mut all = Vec::with_capacity(errors.len() + 1);
            plan.subspace.whole(&errors, &mut all);
            // ln psi has no unit.
            if slides {
                all[0] *= plan.system.units().factor(Quantity::Stress);
            }
            outcome.errors = Some(all);
        }
        Err(Error::Interrupted) => outcome.stopped = true,
        Err(error) => outcome.estimate_failure = Some(error),
    }
}

/// The end of the run by another method, which begins in these units; it can be stopped where it is watched.
fn second_run(
    (companion, begins, watched): (Companion, &MotionUnits, bool),
    plan: &Plan,
    outcome: &mut RunOutcome,
    sink: &mut dyn Sink,
) -> Result<Vector> {
    let mut work = Work::default();
    let end = along(plan, |part, from| {
        if part.is_empty() {
            return Ok((from, false));
        }
        let units = part.units(begins);
        let left = steps_left(plan, part.stretch, &work)?;
        let mut integrator = companion.in_time(units.time).integrator(left)?;
        let mut stopped = false;
        let mut observer = |step: &AnyStep<'_>| {
            let told = sink.reached(step.t1 * units.time / plan.until);
            stopped |= told == Control::Stop;
            Ok(told)
        };
        let observer = watched.then_some(&mut observer as AnyObserver<'_>);
        let (begin, end) = part.stretch.span;
        let span = (begin / units.time, end / units.time);
        let field = part.equations.field(&units)?;
        let end = integrator.flow(&field, span, &units.inward(&from), observer);
        work += integrator.work();
        if stopped {
            return Err(Error::Interrupted);
        }
        let end = end.map_err(|error| of_run(plan, units.outward_error(error, 0)))?;
        Ok((units.outward(&end), false))
    });
    outcome.work += work;
    end
}

/// The error of every state at the end: what the second run says, which began in the first units, and what becomes of the rounding of the start:
/// both runs begin at the same doubles, in which psi is kept by its logarithm and SI units are divided out. The states have come as far as
/// `reached`.
fn errors(
    plan: &Plan,
    (end, second): (&Vector, &Vector),
    (begins, reached): (&MotionUnits, &MotionUnits),
    outcome: &mut RunOutcome,
    sink: &mut dyn Sink,
) -> Result<Vec<f64>> {
    let tangent = growth(plan, begins, outcome, sink)?;
    let (count, slides) = (plan.start.len(), plan.system.slides());
    let start = begins.inward(&plan.start);
    // The rounding of a value is that of its logarithm, beside the logarithm's own.
    let rounded = |i: usize| {
        let own = if slides { 1.0 } else { begins.signs[i].abs() };
        0.5 * f64::EPSILON * (own + start[i].abs())
    };
    let last = begins.inward(end);
    // What is exact moves nothing, however much it would grow.
    let moved = |i: usize| -> f64 {
        let inexact = (0..count).filter(|&j| rounded(j) != 0.0);
        let all: f64 = inexact.map(|j| tangent[(i, j)].abs() * rounded(j)).sum();
        begins.outward_error_of(i, last[i], all)
    };
    let size = |i: usize| match (slides, i) {
        (false, _) => reached.sizes[i] + end[i].abs(),
        (true, 0) => end[i].abs(),
        (true, _) => 1.0,
    };
    let error = |i: usize| MARGIN * (end[i] - second[i]).abs() + moved(i) + ROUNDING * size(i);
    Ok((0..count).map(error).collect())
}

/// The derivatives of the end of a run in its start.
fn growth(
    plan: &Plan,
    begins: &MotionUnits,
    outcome: &mut RunOutcome,
    sink: &mut dyn Sink,
) -> Result<Matrix> {
    let tolerances = Tolerances::equal(GROWTH)?.stepping(plan.tolerances.max_step);
    let tolerances = begins.inward_tolerances(tolerances, false);
    let mut integrator = AnyIntegrator::new(Choice::Auto, tolerances, plan.max_steps)?;
    let count = plan.start.len();
    let mut tangent = Matrix::identity(count, count);
    along(plan, |part, from| {
        let units = part.units(begins);
        let field = part.equations.field(&units)?;
        let (begin, end) = part.stretch.span;
        let pieces = (PIECES as f64 * (end - begin) / plan.until).ceil();
        let time = |piece: usize| match piece as f64 {
            last if last == pieces => end,
            piece => begin + (end - begin) * (piece / pieces),
        };
        let mut y = units.inward(&from);
        for piece in 0..pieces as usize {
            let span = (time(piece), time(piece + 1));
            let inward = (span.0 / units.time, span.1 / units.time);
            let (next, grown) = grown(&mut integrator, part, &field, inward, &y)?;
            outcome.work += integrator.work();
            y = next;
            // V_H and time are exact, where they are variables.
            tangent = grown.view((0, 0), (count, count)) * &tangent;
            if sink.reached(span.1 / plan.until) == Control::Stop {
                return Err(Error::Interrupted);
            }
        }
        Ok((units.outward(&y), false))
    })?;
    Ok(tangent)
}

/// The state at the end of a span with its derivatives in the start, of which a digit will do: by differences where slopes may be infinite, and where a
/// formula has no derivatives on the way, as where it overflows and its inverse is 0.
fn grown(
    integrator: &mut AnyIntegrator,
    part: &Part<'_>,
    field: &AnyField<'_>,
    span: (f64, f64),
    y: &Vector,
) -> Result<(Vector, Matrix)> {
    /// The distance of the starts, in units of a variable, or of the largest where that is 0: far above the tolerance.
    const APART: f64 = 1e-3;
    if !part.equations.takes_powers()
        && let Ok((next, grown)) = integrator.derivatives(field, span, y, &[])
    {
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

/// The time of a singularity, or of a burst too fast for doubles, with its uncertainty by a second run.
pub(super) fn timed(
    error: Error,
    plan: &Plan,
    outcome: &mut RunOutcome,
    sink: &mut dyn Sink,
) -> Result<Error> {
    let companion = Companion::of(plan.tolerances, false);
    match second_run((companion, &plan.units, true), plan, outcome, sink) {
        Err(error @ Error::Parameter { .. }) => Err(error),
        second => Ok(confirmed(error, second.err())),
    }
}

/// A singularity with the uncertainty of its time, by what a second run ended with, if not with the end of the run. One that is not
/// confirmed is undecided.
fn confirmed(mut error: Error, second: Option<Error>) -> Error {
    /// The uncertainty of its time, in units of that time, from which on there is none to tell.
    const VAGUE: f64 = 0.1;
    let again = match second {
        Some(Error::BlowUp { t, .. } | Error::TooFast { t, .. }) => Some(t),
        Some(Error::Interrupted) => return error,
        _ => None,
    };
    let singular = matches!(error, Error::BlowUp { .. });
    if let Error::BlowUp { t, uncertainty, .. } | Error::TooFast { t, uncertainty, .. } = &mut error
    {
        let t = *t;
        let bound = again
            .map(|again| MARGIN * (again - t).abs() + TIME_SPACINGS * f64::EPSILON * again.abs());
        if singular && bound.is_none_or(|bound| bound > VAGUE * t.abs()) {
            return Error::UndecidedEnd { t, again };
        }
        *uncertainty = bound;
    }
    error
}
