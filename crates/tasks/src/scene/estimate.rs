//! The global error at the end of a run, from a second one.

use super::plan::{Plan, Point};
use super::program::Stretch;
use super::run::{RunOutcome, Sink};
use super::stretch::{Along, as_field, go, of_run, steps_left};
use twinslip::error::{Error, Result};
use twinslip::field::{Jacobian, State};
use twinslip::integrate::{
    AnyIntegrator, Choice, Control, Integrator, Observer, Step, Taylor, Tolerances, Work,
};
use twinslip::model::Driven;

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
    pub(super) fn in_time(mut self, unit: f64) -> Self {
        let (Companion::Tighter(Tolerances { max_step, .. }) | Companion::Reference { max_step }) =
            &mut self;
        *max_step /= unit;
        self
    }

    /// The method of the second run in a dimension known when the program runs.
    pub(super) fn any_integrator(self, max_steps: usize) -> Result<AnyIntegrator> {
        match self {
            Companion::Tighter(tolerances) => {
                AnyIntegrator::new(Choice::Auto, tolerances, max_steps)
            }
            Companion::Reference { max_step } => AnyIntegrator::reference(max_steps, max_step),
        }
    }

    fn integrator<const N: usize>(self, max_steps: usize) -> Result<Box<dyn Integrator<N>>> {
        match self {
            Companion::Tighter(tolerances) => Choice::Auto.integrator(tolerances, max_steps),
            Companion::Reference { max_step } => {
                Ok(Box::new(Taylor::reference(max_steps)?.stepping(max_step)))
            }
        }
    }
}

/// The second run, along its stretches.
struct Second<'a> {
    companion: Companion,
    plan: &'a Plan,
    sink: &'a mut dyn Sink,
    /// Whether it tells how far it is, and can be stopped.
    watched: bool,
    work: Work,
    stopped: bool,
}

impl<'a> Second<'a> {
    fn new(companion: Companion, plan: &'a Plan, sink: &'a mut dyn Sink, watched: bool) -> Self {
        Second {
            companion,
            plan,
            sink,
            watched,
            work: Work::default(),
            stopped: false,
        }
    }
}

impl Along for Second<'_> {
    fn along<const N: usize>(
        &mut self,
        stretch: &Stretch,
        field: &dyn Driven<N>,
        from: &State<N>,
    ) -> Result<State<N>> {
        if stretch.span.0 == stretch.span.1 {
            return Ok(*from);
        }
        let left = steps_left(self.plan, stretch, &self.work)?;
        let mut integrator = self.companion.integrator::<N>(left)?;
        let until = self.plan.until;
        let mut observer = |step: &Step<'_, N>| {
            let control = self.sink.reached(step.t1 / until);
            self.stopped = control == Control::Stop;
            Ok(control)
        };
        let observer: Option<Observer<'_, N>> = if self.watched {
            Some(&mut observer)
        } else {
            None
        };
        let end = integrator.flow(as_field(field), stretch.span, from, observer);
        self.work += integrator.work();
        end.map_err(|error| of_run(self.plan, error))
    }

    fn stopped(&self) -> bool {
        self.stopped
    }
}

/// Puts the error of `end`, and the work for it, into the outcome.
pub(super) fn estimate(
    companion: Companion,
    plan: &Plan,
    end: &Point,
    outcome: &mut RunOutcome,
    sink: &mut dyn Sink,
) -> Result<()> {
    // The reference takes long enough that one wants to see it move, and to stop it.
    let watched = plan.observed() || matches!(companion, Companion::Reference { .. });
    let mut run = Second::new(companion, plan, &mut *sink, watched);
    let second = go(plan, &mut run);
    let (work, stopped) = (run.work, run.stopped);
    outcome.work += work;
    let second = match second {
        Err(error @ Error::Parameter { .. }) => return Err(error),
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
    match rounding_of_start(plan, end, outcome, sink) {
        Ok(Some(rounding)) => {
            let distance = relative_distance(end, &second);
            let estimate = MARGIN * distance + rounding + ROUNDING;
            outcome.error_estimate = Some(estimate).filter(|x| x.is_finite());
        }
        Ok(None) => outcome.stopped = true,
        Err(error) => outcome.estimate_failure = Some(error),
    }
    Ok(())
}

/// The tangent flow in (tau, ln psi_1, ln psi_2), along the stretches of a run.
struct Growth<'a> {
    plan: &'a Plan,
    sink: &'a mut dyn Sink,
    tangent: Jacobian<3>,
    work: Work,
    stopped: bool,
}

impl Along for Growth<'_> {
    fn along<const N: usize>(
        &mut self,
        stretch: &Stretch,
        field: &dyn Driven<N>,
        from: &State<N>,
    ) -> Result<State<N>> {
        let (plan, (begin, end)) = (self.plan, stretch.span);
        let tolerances = Tolerances::equal(GROWTH)?.stepping(plan.tolerances.max_step);
        let mut integrator = Choice::Auto.integrator::<N>(tolerances, plan.max_steps)?;
        let pieces = (PIECES as f64 * (end - begin) / plan.until).ceil();
        let time = |piece: usize| match piece as f64 {
            last if last == pieces => end,
            piece => begin + (end - begin) * (piece / pieces),
        };
        let (mut y, mut tangent) = (*from, Jacobian::<N>::identity());
        for piece in 0..pieces as usize {
            let span = (time(piece), time(piece + 1));
            let (next, part) = integrator.tangent_flow(as_field(field), span, &y)?;
            self.work += integrator.work();
            y = next;
            tangent = part * tangent;
            if self.sink.reached(span.1 / plan.until) == Control::Stop {
                self.stopped = true;
                break;
            }
        }
        // V_H, where it is a variable, is as it is.
        let known = plan.dimension.number();
        let mut part = Jacobian::<3>::identity();
        for i in 0..known {
            for j in 0..known {
                part[(i, j)] = tangent[(i, j)];
            }
        }
        self.tangent = part * self.tangent;
        Ok(y)
    }

    fn stopped(&self) -> bool {
        self.stopped
    }
}

/// What becomes of the rounding of the start: both runs begin at the same doubles, in which psi is kept by its logarithm and SI
/// units are divided out. `None` where the sink stops it.
fn rounding_of_start(
    plan: &Plan,
    end: &Point,
    outcome: &mut RunOutcome,
    sink: &mut dyn Sink,
) -> Result<Option<f64>> {
    let mut growth = Growth {
        plan,
        sink,
        tangent: Jacobian::<3>::identity(),
        work: Work::default(),
        stopped: false,
    };
    let gone = go(plan, &mut growth);
    outcome.work += growth.work;
    gone?;
    if growth.stopped {
        return Ok(None);
    }
    // Half a spacing of ln psi and, relative to itself, of psi as it was read; tau likewise.
    let (tau, [first, second]) = plan.start;
    let start = State::<3>::new(tau, first, second);
    let rounded = start.map(|x| 0.5 * f64::EPSILON * (1.0 + x.abs()));
    let moved = growth.tangent.abs() * rounded;
    let stress = moved[0] / end.0.abs().max(f64::MIN_POSITIVE);
    let of_all = (1..plan.dimension.number())
        .map(|i| moved[i])
        .chain([stress]);
    Ok(Some(of_all.fold(0.0, |largest: f64, x| {
        // One that is not known is no small one.
        if x.is_nan() {
            f64::INFINITY
        } else {
            largest.max(x)
        }
    })))
}

/// The time of a singularity, or of a burst too fast for doubles, with its uncertainty by a second run.
pub(super) fn timed(
    error: Error,
    plan: &Plan,
    outcome: &mut RunOutcome,
    sink: &mut dyn Sink,
) -> Result<Error> {
    let companion = Companion::of(plan.tolerances, false);
    let mut run = Second::new(companion, plan, sink, true);
    let second = go(plan, &mut run);
    let run_stopped = run.stopped;
    outcome.work += run.work;
    if let Err(error @ Error::Parameter { .. }) = second {
        return Err(error);
    }
    if run_stopped {
        return Ok(error);
    }
    Ok(confirmed(error, second.err()))
}

/// A singularity with the uncertainty of its time, by what a second run ended with, if not with the end of the run. One that is not
/// confirmed is undecided.
pub(super) fn confirmed(mut error: Error, second: Option<Error>) -> Error {
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

/// Largest relative difference in stress and states: the states by their logarithms.
fn relative_distance((tau, log_state): &Point, (other, others): &Point) -> f64 {
    let stress = (tau - other).abs() / other.abs().max(f64::MIN_POSITIVE);
    let states = log_state.iter().zip(others);
    states.fold(stress, |largest, (w, other)| {
        largest.max((w - other).exp_m1().abs())
    })
}
