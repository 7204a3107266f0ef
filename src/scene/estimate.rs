//! The global error at the end of a run, from a second one.

use super::plan::Plan;
use super::run::{RunOutcome, Sink};
use crate::error::{Error, Result};
use crate::field::{Jacobian, State, VectorField};
use crate::integrate::{
    AnyIntegrator, Choice, Control, Integrator, Observer, Step, Taylor, Tolerances,
};

/// How much tighter the second run is: its own error then hardly counts.
const TIGHTER: f64 = 100.0;
/// A tolerance below this gains nothing: rounding rules.
const TIGHTEST: f64 = 1e-14;
/// The second run's error, of which little is known but that it is small, is allowed for by this factor; with the reference it
/// allows for what rounding may still do within the run's own digits.
pub(super) const MARGIN: f64 = 2.0;
/// Relative errors below this are rounding.
pub(super) const ROUNDING: f64 = 4.0 * f64::EPSILON;
/// Spacings of the numbers around a time that its rounding, and that of what it follows from, may make.
pub(super) const TIME_SPACINGS: f64 = 64.0;
/// Tolerance of the tangent flow that says how far the rounding of the start grows: a digit of it will do.
pub(super) const GROWTH: f64 = 1e-6;
/// Pieces in which it goes, so that it can be stopped.
pub(super) const PIECES: usize = 64;

/// The second run.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Companion {
    /// By `auto`, with tighter tolerances.
    Tighter(Tolerances),
    /// In double-double arithmetic.
    Reference,
}

impl Companion {
    /// What goes with a run of these tolerances: the reference where it is asked for, or where doubles end.
    pub fn of(tolerances: Tolerances, reference: bool) -> Self {
        let Tolerances { rtol, atol } = tolerances;
        if reference || rtol < TIGHTER * TIGHTEST {
            Companion::Reference
        } else {
            Companion::Tighter(Tolerances {
                rtol: rtol / TIGHTER,
                atol: atol / TIGHTER,
            })
        }
    }

    /// The method of the second run in a dimension known when the program runs.
    pub(super) fn any_integrator(self, max_steps: usize) -> Result<AnyIntegrator> {
        match self {
            Companion::Tighter(tolerances) => {
                AnyIntegrator::new(Choice::Auto, tolerances, max_steps)
            }
            Companion::Reference => AnyIntegrator::reference(max_steps),
        }
    }

    fn integrator<const N: usize>(self, max_steps: usize) -> Result<Box<dyn Integrator<N>>> {
        match self {
            Companion::Tighter(tolerances) => Choice::Auto.integrator(tolerances, max_steps),
            Companion::Reference => Ok(Box::new(Taylor::reference(max_steps)?)),
        }
    }
}

/// Puts the error of `end`, and the work for it, into the outcome.
pub(super) fn estimate<const N: usize>(
    companion: Companion,
    plan: &Plan,
    field: &dyn VectorField<N>,
    y0: &State<N>,
    end: &State<N>,
    outcome: &mut RunOutcome,
    sink: &mut dyn Sink,
) -> Result<()> {
    let mut integrator = companion.integrator::<N>(plan.max_steps)?;
    let span = (0.0, plan.until);
    let mut stopped = false;
    let mut observer = |step: &Step<'_, N>| {
        let control = sink.reached(step.t1 / plan.until);
        stopped = control == Control::Stop;
        Ok(control)
    };
    // The reference takes long enough that one wants to see it move, and to stop it.
    let watched = plan.observed() || companion == Companion::Reference;
    let observer: Option<Observer<'_, N>> = if watched { Some(&mut observer) } else { None };
    let second = integrator.flow(field, span, y0, observer);
    outcome.work += integrator.work();
    let second = match second {
        Ok(second) if !stopped => second,
        Ok(_) => {
            outcome.stopped = true;
            return Ok(());
        }
        Err(error) => {
            outcome.estimate_failure = Some(error);
            return Ok(());
        }
    };
    match rounding_of_start(plan, field, y0, end, outcome, sink) {
        Ok(Some(rounding)) => {
            let distance = relative_distance(end, &second);
            outcome.error_estimate = Some(MARGIN * distance + rounding + ROUNDING);
        }
        Ok(None) => outcome.stopped = true,
        Err(error) => outcome.estimate_failure = Some(error),
    }
    Ok(())
}

/// What becomes of the rounding of the start: both runs begin at the same doubles, in which psi is kept by its logarithm and SI
/// units are divided out. `None` where the sink stops it.
fn rounding_of_start<const N: usize>(
    plan: &Plan,
    field: &dyn VectorField<N>,
    y0: &State<N>,
    end: &State<N>,
    outcome: &mut RunOutcome,
    sink: &mut dyn Sink,
) -> Result<Option<f64>> {
    let mut integrator =
        Choice::Auto.integrator::<N>(Tolerances::equal(GROWTH)?, plan.max_steps)?;
    let (mut y, mut tangent) = (*y0, Jacobian::<N>::identity());
    let time = |piece: usize| plan.until * (piece as f64 / PIECES as f64);
    for piece in 0..PIECES {
        let (next, part) = integrator.tangent_flow(field, (time(piece), time(piece + 1)), &y)?;
        outcome.work += integrator.work();
        y = next;
        tangent = part * tangent;
        if sink.reached((piece + 1) as f64 / PIECES as f64) == Control::Stop {
            return Ok(None);
        }
    }
    // Half a spacing of ln psi and, relative to itself, of psi as it was read; tau likewise.
    let rounded = y0.map(|x| 0.5 * f64::EPSILON * (1.0 + x.abs()));
    let moved = tangent.abs() * rounded;
    let stress = moved[0] / end[0].abs().max(f64::MIN_POSITIVE);
    Ok(Some(
        (1..N).fold(stress, |largest, i| largest.max(moved[i])),
    ))
}

/// The time of a singularity, or of a burst too fast for doubles, with its uncertainty by a second run.
pub(super) fn timed<const N: usize>(
    mut error: Error,
    plan: &Plan,
    field: &dyn VectorField<N>,
    y0: &State<N>,
    outcome: &mut RunOutcome,
    sink: &mut dyn Sink,
) -> Result<Error> {
    let companion = Companion::of(plan.tolerances, false);
    let mut integrator = companion.integrator::<N>(plan.max_steps)?;
    let span = (0.0, plan.until);
    let mut observer = |step: &Step<'_, N>| Ok(sink.reached(step.t1 / plan.until));
    let second = integrator.flow(field, span, y0, Some(&mut observer));
    outcome.work += integrator.work();
    let (Error::BlowUp { t, uncertainty, .. } | Error::TooFast { t, uncertainty, .. }) = &mut error
    else {
        return Ok(error);
    };
    if let Err(Error::BlowUp { t: again, .. } | Error::TooFast { t: again, .. }) = second {
        let rounding = TIME_SPACINGS * f64::EPSILON * again.abs();
        *uncertainty = Some(MARGIN * (again - *t).abs() + rounding);
    }
    Ok(error)
}

/// Largest relative difference in stress and states: the states by their logarithms.
fn relative_distance<const N: usize>(y: &State<N>, reference: &State<N>) -> f64 {
    let stress = (y[0] - reference[0]).abs() / reference[0].abs().max(f64::MIN_POSITIVE);
    (1..N).fold(stress, |largest, i| {
        largest.max((y[i] - reference[i]).exp_m1().abs())
    })
}
