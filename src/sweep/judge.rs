//! What a run has settled on, from its returns.

use super::watch::{Run, see, turn};
use super::{Row, Settings, creep};
use crate::equilibrium::Symmetry;
use crate::error::{Error, Result};
use crate::field::State;
use crate::integrate::{Control, Integrator, MAX_STEPS, Step, Taylor, Tolerances};
use crate::number::Uncertain;
use crate::section::{
    Ended, Periodic, Regime, Return, Search, Spectrum, Surface, Watching, aperiodic,
    at_equilibrium, divergence, points, record, spectrum,
};

/// Log states that differ by less, all along, are those of interfaces that move alike.
const ALIKE: f64 = 1e-6;
/// The step at which Newton's method ends; the error then is its square.
const CONVERGED: f64 = 1e-5;
/// The tolerance with which an orbit is gone round once, for its period and its stress.
const TOLERANCE: f64 = 1e-11;
/// Returns after which a run that has not settled is judged: each time twice as many.
pub(super) const FIRST_STAGE: usize = 64;
/// Returns without which no run is seen to creep.
const FEWEST_TO_CREEP: usize = 256;
/// Returns without which neither torus nor chaos is told: those before are let pass.
const FEWEST_TO_WANDER: usize = 512;
/// Returns before exponents are asked for. For them there are more each time.
const FEWEST_TO_ASK: usize = 1024;
const FOR_EXPONENTS: std::ops::RangeInclusive<usize> = 256..=1024;
/// A candidate that is none is not looked at again before this part more returns.
const LATER: f64 = 1.3;
/// The relative error of multipliers, in tolerances.
const MULTIPLIER_PER_RTOL: f64 = 1e4;
/// A run this close to an unstable orbit is held on it.
const ON_ORBIT: f64 = 1e-5;

/// Judges runs; its integrators are used over and over.
pub(super) struct Judge {
    settings: Settings,
    fine: Taylor,
    coarse: Taylor,
}

/// What is known of a run's end, and where the next one may start from it.
pub(super) struct Told {
    pub row: Row,
    pub attractor: Option<State<3>>,
}

impl Judge {
    pub fn new(settings: &Settings) -> Result<Self> {
        let fine = TOLERANCE.min(settings.rtol);
        Ok(Judge {
            settings: settings.clone(),
            fine: Taylor::new(Tolerances::equal(fine)?, MAX_STEPS)?,
            coarse: Taylor::new(Tolerances::equal(settings.rtol)?, settings.max_steps)?,
        })
    }

    /// What the run has settled on, or `None` if it shall go on.
    pub fn judge(&mut self, run: &mut Run) -> Option<Told> {
        match run.recorder.ended.take() {
            Some(Ended::Steady {
                equilibrium,
                stable,
                ..
            }) => return Some(steady(run, equilibrium, stable)),
            Some(Ended::Failed(error)) => {
                return match error {
                    Error::NoReturn {
                        lowest, highest, ..
                    } if run.surface_moves_between(lowest, highest)
                        || run.let_go(run.state)
                        || run.waits_longer() =>
                    {
                        None
                    }
                    error => Some(undecided(run, error.to_string())),
                };
            }
            Some(Ended::Complete | Ended::Stopped) | None => (),
        }
        if std::mem::take(&mut run.held) {
            run.let_go(run.state);
            return None;
        }
        if run.recorder.steps >= self.settings.max_steps {
            return Some(undecided(
                run,
                "its steps are used up; raise --max-steps".into(),
            ));
        }
        if let Some(q) = run.candidate.take() {
            match self.periodic(run, q) {
                Some(told) => return Some(told),
                None => run.next_look = (run.recorder.returns.len() as f64 * LATER) as usize + 1,
            }
        }
        let n = run.recorder.returns.len();
        if n < run.next_stage {
            return None;
        }
        if let Some(told) = self.creeping(run) {
            return Some(told);
        }
        let told = self.wandering(run);
        let last = n >= self.settings.max_returns;
        run.next_stage = (2 * n).min(self.settings.max_returns);
        run.stress = (f64::INFINITY, f64::NEG_INFINITY);
        match told {
            Ok(told) => Some(told),
            Err(why) if last => Some(undecided(run, why.into())),
            Err(_) => None,
        }
    }

    /// The periodic orbit that the run closes in on.
    fn periodic(&mut self, run: &mut Run, q: usize) -> Option<Told> {
        let at = (&*run.field, &run.surface, run.returns());
        let mut search = Search::new(at.0, at.1, &mut self.coarse, at.2, (self.settings.rtol, q));
        search.converged = CONVERGED;
        let found = search.point()?;
        if self.attracts(&found) {
            return self.orbit(run, &found);
        }
        let y = run.returns().last()?.state;
        if (y - found.point).amax() < ON_ORBIT {
            run.let_go(y);
        }
        None
    }

    /// What the run creeps to.
    fn creeping(&mut self, run: &Run) -> Option<Told> {
        let (field, returns) = (&*run.field, run.returns());
        if returns.len() < FEWEST_TO_CREEP {
            return None;
        }
        if let Some(equilibrium) = creep::to_rest(field, returns) {
            return Some(steady(run, equilibrium, true));
        }
        let accuracy = (self.settings.rtol, CONVERGED);
        let found = creep::to_orbit(field, &run.surface, &mut self.coarse, returns, accuracy)?;
        if !self.attracts(&found) {
            return None;
        }
        self.orbit(run, &found)
    }

    /// Whether the point attracts, beyond the error of its multiplier.
    fn attracts(&self, found: &Periodic<3>) -> bool {
        found.attracts() && found.multiplier < 1.0 - MULTIPLIER_PER_RTOL * self.settings.rtol
    }

    fn orbit(&mut self, run: &Run, found: &Periodic<3>) -> Option<Told> {
        let mut stress = (found.point[0], found.point[0]);
        let mut unlike = 0.0_f64;
        let mut observer = |step: &Step<'_, 3>| {
            see(&mut stress, step.y1[0]);
            if let Some(turn) = step.series().and_then(turn) {
                see(&mut stress, turn);
            }
            unlike = unlike.max((step.y1[1] - step.y1[2]).abs());
            Ok(Control::Continue)
        };
        let time = (0.0, found.period.value);
        let flown = self
            .fine
            .flow(&*run.field, time, &found.point, Some(&mut observer));
        let end = flown.ok()?;
        // The point is known better than the time: to the first order it ends on the section.
        let rate = run.field.f(&end)[0];
        let period = found.period.value - run.surface.height(&end) / rate;
        let mut told = begun(run, Regime::Periodic);
        told.attractor = Some(found.point);
        told.row.symmetry = Some(symmetry(unlike));
        told.row.returns_per_period = Some(found.returns);
        told.row.period = Some(period);
        told.row.stress_range = Some(stress);
        told.row.lyapunov_max = multiplier_exponent(found, self.settings.rtol);
        Some(told)
    }

    /// A torus or chaos, or why nothing can be said.
    fn wandering(&mut self, run: &mut Run) -> std::result::Result<Told, &'static str> {
        let n = run.returns().len();
        let last = run.recorder.returns.len() >= self.settings.max_returns;
        if n < FEWEST_TO_WANDER && !last {
            return Err("too early");
        }
        let half = &run.returns()[n / 2..];
        if half.len() < crate::section::FEWEST_RETURNS / 2 {
            return Err("too few returns since it was let go from an unstable orbit");
        }
        if half.iter().all(|at| alike(&at.state)) {
            return Err(
                "equal interfaces, whose motion is plane and so neither a torus nor chaos, close in on nothing yet; raise --max-returns",
            );
        }
        let seen = aperiodic(&run.surface, half, self.settings.rtol, None);
        if seen.regime == Regime::Torus && !self.settings.lyapunov {
            let mut told = begun(run, Regime::Torus);
            told.row.stress_range = Some(run.stress);
            return Ok(told);
        }
        if seen.regime != Regime::Torus && n < FEWEST_TO_ASK && !last {
            return Err("too early");
        }
        if !may_be_chaotic(&run.surface, half) {
            return Err("the returns have not settled, and show no chaos; raise --max-returns");
        }
        self.with_exponents(run)
    }

    /// Records anew from where the run is, now with its tangents.
    fn with_exponents(&mut self, run: &mut Run) -> std::result::Result<Told, &'static str> {
        // A quarter of what there were: a longer run has shown that it needs more.
        let returns = run.recorder.returns.len() / 4;
        let watching = Watching {
            skip: 0,
            returns: returns.clamp(*FOR_EXPONENTS.start(), *FOR_EXPONENTS.end()),
            waypoints: true,
            ..run.watching
        };
        let mut stress = run.stress;
        let see_all = &mut |_: usize, _: Option<&_>| Control::Continue;
        let start = run.recorder.returns.last().map_or(run.state, |at| at.state);
        let (field, surface) = (&*run.field, &run.surface);
        let recorded = record(&mut self.coarse, field, &start, surface, &watching, see_all);
        for point in &recorded.waypoints {
            see(&mut stress, point.state[0]);
        }
        if let Ended::Steady { equilibrium, .. } = recorded.ended {
            return Ok(steady(run, equilibrium, true));
        }
        let found = spectrum(field, &recorded).map_err(|_| "its tangents fail")?;
        let known = Some(found.known());
        let made = aperiodic(surface, &recorded.returns, self.settings.rtol, known);
        match made.regime {
            Regime::Torus | Regime::Chaotic => {
                let mut told = begun(run, made.regime);
                told.row.returns += recorded.returns.len();
                told.attractor = recorded.returns.last().map(|at| at.state);
                told.row.stress_range = Some(stress);
                told.row.lyapunov_max = across(&found);
                Ok(told)
            }
            _ => Err(made.why.unwrap_or("its returns do not tell")),
        }
    }
}

/// Whether neighbours part so fast, perhaps, that exponents would tell chaos: they cost more than the run itself.
fn may_be_chaotic(surface: &Surface<3>, returns: &[Return<3>]) -> bool {
    /// Slower chaos than this, per return, is not told from as many returns as are looked at.
    const SLOWEST: f64 = 0.01;
    /// Standard deviations.
    const SURE: f64 = 4.0;
    divergence(&points(surface, returns)).is_none_or(|(mean, error)| mean + SURE * error > SLOWEST)
}

/// The largest exponent but that along the flow.
fn across(found: &Spectrum<3>) -> Option<Uncertain> {
    let mut all = found.exponents.iter();
    all.find(|x| x.value != found.along_flow).copied()
}

/// ln |mu| / T; where mu is large enough to be told from rounding.
fn multiplier_exponent(found: &Periodic<3>, rtol: f64) -> Option<Uncertain> {
    const LEAST: f64 = 1e-6;
    let value = found.multiplier.ln() / found.period.value;
    let error = MULTIPLIER_PER_RTOL * rtol / found.period.value;
    (value.is_finite() && found.multiplier > LEAST).then(|| Uncertain::new(value, error))
}

fn alike(y: &State<3>) -> bool {
    (y[1] - y[2]).abs() < ALIKE
}

fn symmetry(unlike: f64) -> Symmetry {
    if unlike < ALIKE {
        Symmetry::Symmetric
    } else {
        Symmetry::Asymmetric
    }
}

/// A row of which the regime is known.
fn begun(run: &Run, regime: Regime) -> Told {
    let point = &run.point;
    Told {
        row: Row {
            number: point.number,
            driving: point.loading.driving,
            stiffness: point.loading.stiffness,
            start: point.start.into(),
            regime,
            symmetry: None,
            returns_per_period: None,
            period: None,
            stress_range: None,
            lyapunov_max: None,
            returns: run.recorder.passed,
            note: (run.pushes > 0).then(|| {
                "equal interfaces, held by rounding where that is unstable, were let go by 0.001 in ln psi2"
                    .into()
            }),
        },
        attractor: run.recorder.returns.last().map(|at| at.state),
    }
}

fn steady(run: &Run, equilibrium: State<3>, stable: bool) -> Told {
    let mut told = begun(run, Regime::Steady);
    told.attractor = Some(equilibrium);
    told.row.symmetry = Some(symmetry((equilibrium[1] - equilibrium[2]).abs()));
    told.row.stress_range = Some((equilibrium[0], equilibrium[0]));
    told.row.lyapunov_max = Some(at_equilibrium(&*run.field, &equilibrium)[0]);
    if !stable {
        told.row.note = Some("starts at an unstable steady state and rests there".into());
    }
    told
}

pub(super) fn undecided(run: &Run, why: String) -> Told {
    let mut told = begun(run, Regime::Undecided);
    told.row.note = Some(why);
    told.attractor = None;
    told
}
