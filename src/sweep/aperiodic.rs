//! Aperiodic motion: runs that close in on nothing, which are tori, chaos, or neither yet.

use super::classify::{Classifier, Settled, alike, begun, steady};
use super::finite_difference_exponent::stretching;
use super::watch::{SweepRun, see};
use crate::integrate::Control;
use crate::section::{
    Closing, Ended, FEWEST_FOR_EXPONENTS, FEWEST_RETURNS, IRREGULAR, ON_SADDLE, REGULAR, Regime,
    Return, Watching, aperiodic, closing_in, growth, points, record_finely, regularity, spectrum,
};

/// Returns without which neither torus nor chaos is told: those before are let pass.
const FEWEST_TO_WANDER: usize = 512;
/// Returns before exponents are asked for.
const FEWEST_TO_ASK: usize = 1024;
/// Over how many returns exponents are taken: if these don't tell, twice as many.
const FOR_EXPONENTS: std::ops::RangeInclusive<usize> = 256..=1024;

/// Why nothing can be said.
type Undecided = &'static str;

/// A torus or chaos, or why nothing can be said. Where there is a stable steady state too, chaos may be but a way to it: it is waited for,
/// and nothing said in the end.
pub(super) fn wandering(classifier: &mut Classifier, run: &SweepRun) -> Result<Settled, Undecided> {
    let settings = &classifier.settings;
    let (rtol, max_steps, lyapunov) = (settings.rtol, settings.max_steps, settings.lyapunov);
    let n = run.returns().len();
    let last = run.recorder.returns.len() >= settings.max_returns;
    if n < FEWEST_TO_WANDER && !last {
        return Err("too early");
    }
    let half = &run.returns()[n / 2..];
    if half.len() < FEWEST_RETURNS / 2 {
        return Err("too few returns since it was perturbed off an unstable state or orbit");
    }
    let plane = run.field.dimension() < 3;
    if plane || (run.equal_parts && half.iter().all(|at| alike(&at.state))) {
        return Err(
            "its plane motion cannot be a torus or chaos, and has not converged yet; raise `max_returns`",
        );
    }
    let seen = aperiodic(&run.surface, half, rtol, None);
    if seen.regime == Regime::Torus {
        return match lyapunov {
            true => with_tangents(run, max_steps),
            false => Ok(told(run, Regime::Torus)),
        };
    }
    if n < FEWEST_TO_ASK && !last {
        return Err("too early");
    }
    let disorder = regularity(&points(&run.surface, half));
    if disorder > IRREGULAR {
        if may_come_to_rest(run) {
            return Err(
                "its returns are irregular, but there is a stable steady state, to which they may lead; raise `max_returns`",
            );
        }
        return match chaos(classifier, run) {
            Some(told) => told,
            None if last || run.lane.is_none() => with_tangents(run, max_steps),
            None => Err("nearby runs behave differently"),
        };
    }
    if disorder < REGULAR {
        return with_tangents(run, max_steps);
    }
    Err("the returns are neither regular nor irregular yet; raise `max_returns`")
}

/// Chaos of two equal interfaces, by the exponents along the last returns: of ever more, until they tell. `None` where no runs beside it can be
/// compared with it.
fn chaos(classifier: &mut Classifier, run: &SweepRun) -> Option<Result<Settled, Undecided>> {
    run.lane?;
    let rtol = classifier.settings.rtol;
    let all = run.returns();
    let settled = all.len() / 2;
    let mut count = *FOR_EXPONENTS.start();
    loop {
        count = count.min(settled).min(*FOR_EXPONENTS.end());
        if count < FEWEST_FOR_EXPONENTS {
            return Some(Err("too few returns for exponents; raise `max_returns`"));
        }
        let late: &[Return] = &all[all.len() - count..];
        let found = stretching(run, late, &mut classifier.flows, rtol)?;
        let made = aperiodic(&run.surface, late, rtol, Some(found.known()));
        if made.regime == Regime::Chaotic {
            let mut told = told(run, Regime::Chaotic);
            told.row.lyapunov_max = found.across_flow();
            return Some(Ok(told));
        }
        if count == settled || count == *FOR_EXPONENTS.end() {
            return Some(Err(made.why.unwrap_or("its returns do not decide")));
        }
        count *= 2;
    }
}

/// Records anew from where the run is, so finely that its tangents tell an exponent that vanishes.
fn with_tangents(run: &SweepRun, max_steps: usize) -> Result<Settled, Undecided> {
    let tangents_fail = "its tangents fail";
    let all = run.recorder.returns.len();
    let watching = Watching {
        returns: (all / 4).clamp(*FOR_EXPONENTS.start(), *FOR_EXPONENTS.end()),
        ..run.watching
    };
    let see_all = &mut |_: usize, _: Option<&_>| Control::Continue;
    let (field, surface) = (&*run.field, &run.surface);
    let recorded = record_finely(field, run.last(), surface, &watching, max_steps, see_all)
        .map_err(|_| tangents_fail)?;
    if let Ended::Steady { equilibrium, .. } = &recorded.ended {
        return Ok(steady(run, equilibrium));
    }
    if let Ok(Closing::OnSaddle) = closing_in(field, surface, &recorded) {
        return Err(ON_SADDLE);
    }
    let found = spectrum(field, &recorded).map_err(|_| tangents_fail)?;
    let known = Some(found.known());
    let made = aperiodic(surface, &recorded.returns, recorded.accuracy, known);
    if !matches!(made.regime, Regime::Torus | Regime::Chaotic) {
        return Err(made.why.unwrap_or("its returns do not decide"));
    }
    let mut told = told(run, made.regime);
    if let Some(range) = &mut told.row.range {
        let waypoints = recorded.waypoints.iter();
        waypoints.for_each(|point| see(range, point.state[run.variable]));
    }
    told.row.returns += recorded.returns.len();
    told.attractor = recorded.returns.last().map(|at| at.state.clone());
    told.row.lyapunov_max = found.across_flow();
    Ok(told)
}

/// Whether Newton's method leads from a return of the run to a stable steady state.
fn may_come_to_rest(run: &SweepRun) -> bool {
    /// Returns that are tried, steps of Newton's method, and one that is the last, in units of 1 + |y|.
    const TRIED: usize = 16;
    const STEPS: usize = 40;
    const LAST: f64 = 1e-9;
    let rest = |at: &Return| {
        let mut y = at.state.clone();
        for _ in 0..STEPS {
            let step = run.field.newton_step(y.as_slice())?;
            y -= &step;
            if step.amax() < LAST * (1.0 + y.amax()) {
                return Some(y);
            }
        }
        None
    };
    let returns = run.returns();
    let every = (returns.len() / TRIED).max(1);
    let mut rests = returns.iter().step_by(every).filter_map(rest);
    rests.any(|y| growth(&run.field, y.as_slice()) < 0.0)
}

/// A row of which the regime is known, with the range of the last stage.
fn told(run: &SweepRun, regime: Regime) -> Settled {
    let mut told = begun(run, regime);
    told.row.range = Some(run.reach[run.variable]);
    told
}
