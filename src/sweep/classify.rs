//! Classifies what a run has settled on, from its returns.

use super::flows::Flows;
use super::slow_convergence::{Leap, SlowReturns};
use super::watch::{SWING, SweepRun, apart, see, turn};
use super::{SweepRow, SweepSettings, slow_convergence};
use crate::equilibrium::Symmetry;
use crate::error::{Error, Result};
use crate::field::{Matrix, State, Vector, state};
use crate::integrate::{AnyIntegrator, AnyStep, Choice, Control, MAX_STEPS, Tolerances};
use crate::number::{DoubleDouble, Uncertain};
use crate::section::{
    Ended, Periodic, PeriodicSearch, Regime, STEPS_OF_PIECE, at_equilibrium, derivative_along,
    reduce,
};

/// Log states that differ by less, all along, are those of interfaces that move alike.
const ALIKE: f64 = 1e-6;
/// The step at which Newton's method ends; the error then is its square.
const CONVERGED: f64 = 1e-5;
/// The tolerance with which an orbit is gone round once, for its period and its stress.
const TOLERANCE: f64 = 1e-11;
/// Returns after which a run that has not settled is judged: each time twice as many.
pub(super) const FIRST_STAGE: usize = 64;
/// Returns without which no run is seen to slow_convergence.
const FEWEST_TO_CREEP: usize = 256;
/// A candidate that is none is not looked at again before this part more returns.
const LATER: f64 = 1.3;
/// The error of the multipliers by which it is told whether a point attracts, in tolerances.
const MULTIPLIER_PER_RTOL: f64 = 1e4;
/// The relative error of the derivative once around, in tolerances; and what the change of a multiplier from one point to the next,
/// which tells how it changes from there, is taken times. An orbit is gone round until these changes are below that error, and so
/// often: the first point is off by the tolerance of the runs, which may matter more than all else.
const DERIVATIVE_PER_RTOL: f64 = 30.0;
const ROUNDS: usize = 3;
const CHANGE: f64 = 3.0;
/// A run this close to an unstable orbit is held on it.
const ON_ORBIT: f64 = 1e-5;

/// Judges runs; its integrators are used over and over.
pub(super) struct Classifier {
    pub(super) settings: SweepSettings,
    fine: AnyIntegrator,
    pub(super) coarse: AnyIntegrator,
}

/// What is known of a run's end, and where the next one may start from it.
pub(super) struct Classified {
    pub row: SweepRow,
    pub attractor: Option<State<3>>,
}

/// Whether a run that is not there yet shows where it comes to.
enum Creeping {
    To(Box<Classified>),
    Leapt,
    No,
}

impl Classifier {
    pub fn new(settings: &SweepSettings) -> Result<Self> {
        let taylor = |tolerance: f64, max_steps: usize| {
            AnyIntegrator::new(Choice::Taylor, Tolerances::equal(tolerance)?, max_steps)
        };
        Ok(Classifier {
            settings: settings.clone(),
            fine: taylor(TOLERANCE.min(settings.rtol), MAX_STEPS)?,
            coarse: taylor(settings.rtol, settings.max_steps)?,
        })
    }

    /// What the run has settled on, or `None` if it shall go on.
    pub fn classify(&mut self, run: &mut SweepRun, flows: &mut Flows) -> Option<Classified> {
        let told = self.judge(run, flows)?;
        // What is found after a leap, other than where it led to, is not what the run comes to.
        if run.leaps_back() {
            return None;
        }
        Some(told)
    }

    fn judge(&mut self, run: &mut SweepRun, flows: &mut Flows) -> Option<Classified> {
        match run.recorder.ended.take() {
            Some(Ended::Steady {
                equilibrium,
                stable,
                ..
            }) => return Some(steady(run, &equilibrium, stable)),
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
                "its steps are used up; raise `max_steps`".into(),
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
        match self.creeping(run) {
            Creeping::To(told) => return Some(*told),
            Creeping::Leapt => {
                run.next_stage = n + FIRST_STAGE;
                return None;
            }
            Creeping::No if run.leaps_back() => return None,
            Creeping::No => (),
        }
        let told = self.wandering(run, flows);
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
    fn periodic(&mut self, run: &mut SweepRun, q: usize) -> Option<Classified> {
        let at = (&run.field, &run.surface, run.returns());
        let mut search =
            PeriodicSearch::new(at.0, at.1, &mut self.coarse, at.2, (self.settings.rtol, q));
        search.converged = CONVERGED;
        let found = search.point()?;
        if self.attracts(&found) {
            let told = self.orbit(run, &found)?;
            // A leap is confirmed where it led to.
            let same = |leap: &mut Leap| apart(&leap.to.point, &found.point) < CONVERGED;
            run.leap.take_if(same);
            return Some(told);
        }
        let y = &run.returns().last()?.state;
        if apart(y, &found.point) < ON_ORBIT {
            run.let_go(state(y.as_slice()));
        }
        None
    }

    /// What the run creeps to.
    fn creeping(&mut self, run: &mut SweepRun) -> Creeping {
        let returns = run.returns();
        if returns.len() < FIRST_STAGE {
            return Creeping::No;
        }
        let found = if let Some(leap) = &run.leap {
            if !leap.is_confirmed_by(returns) {
                return Creeping::No;
            }
            if !leap.is_near(returns) {
                return self.leap(run, leap.to.clone());
            }
            Some(leap.to.clone())
        } else {
            let far = self.slow(run).ahead();
            if let Some(Creeping::Leapt) = far.map(|far| self.leap(run, far)) {
                return Creeping::Leapt;
            }
            if run.returns().len() < FEWEST_TO_CREEP {
                return Creeping::No;
            }
            if let Some(equilibrium) = slow_convergence::to_rest(&run.field, run.returns()) {
                return Creeping::To(Box::new(steady(run, &equilibrium, true)));
            }
            // Where little is between the map and the identity, the point is off by much more than the map.
            self.slow(run).nearby()
        };
        let Some(found) = found.filter(|found| self.attracts(found)) else {
            return Creeping::No;
        };
        match self.orbit(run, &found) {
            Some(told) => {
                run.leap = None;
                Creeping::To(Box::new(told))
            }
            None => Creeping::No,
        }
    }

    fn slow<'a>(&'a mut self, run: &'a SweepRun) -> SlowReturns<'a> {
        SlowReturns {
            field: &run.field,
            surface: &run.surface,
            taylor: &mut self.fine,
            returns: run.returns(),
            accuracy: self.settings.rtol,
        }
    }

    /// Leaps on the way to a point that attracts, if returns are left to see where that leads.
    fn leap(&self, run: &mut SweepRun, to: Periodic) -> Creeping {
        let left = self
            .settings
            .max_returns
            .checked_sub(run.recorder.returns.len());
        if self.attracts(&to) && left >= Some(FIRST_STAGE) && run.leaps(to) {
            Creeping::Leapt
        } else {
            Creeping::No
        }
    }

    /// Whether the point attracts, beyond the error of its multiplier.
    fn attracts(&self, found: &Periodic) -> bool {
        found.attracts() && found.multiplier < 1.0 - MULTIPLIER_PER_RTOL * self.settings.rtol
    }

    fn orbit(&mut self, run: &SweepRun, found: &Periodic) -> Option<Classified> {
        let mut stress = (found.point[0], found.point[0]);
        let mut unlike = 0.0_f64;
        let (mut point, mut period) = (found.point.clone(), found.period.value);
        let (mut before, mut step) = (found.multiplier, found.last_step);
        let mut largest: Option<Uncertain> = None;
        let mut told = begun(run, Regime::Periodic);
        for _ in 0..ROUNDS {
            let mut points = vec![(DoubleDouble::ZERO, point.clone())];
            let mut steps = 0;
            let mut observer = |step: &AnyStep<'_>| {
                see(&mut stress, step.y1[0]);
                let series = step.series().ok_or(Error::NotAnalytic)?;
                if let Some(turn) = turn(series) {
                    see(&mut stress, turn);
                }
                unlike = unlike.max((step.y1[1] - step.y1[2]).abs());
                steps += 1;
                if steps % STEPS_OF_PIECE == 0 {
                    let end = series.begin() + series.length();
                    points.push((end, Vector::from_column_slice(step.y1)));
                }
                Ok(Control::Continue)
            };
            let (field, time) = (&run.field, (0.0, period));
            let flown = self.fine.flow(field, time, &point, Some(&mut observer));
            let end = flown.ok()?;
            // The point is known better than the time: to the first order it ends on the section.
            let rate = field.f(&end)[0];
            period -= run.surface.height(end.as_slice()) / rate;
            if told.row.period.is_none() {
                (told.attractor, told.row.period) = (Some(state(point.as_slice())), Some(period));
            }
            points.retain(|(begin, _)| begin.hi() < period);
            let now = DoubleDouble::from(period);
            let around = derivative_along(field, &run.surface, &mut self.fine, &points, now);
            let around = largest_multiplier(run, &point, &around.ok()?);
            let Some(Revolution { mu, error, left }) = around.filter(|_| before > 0.0) else {
                break;
            };
            // What mu still changes by, by how much it has changed over the last step to the point.
            let part = (left.amax() / step).min(1.0);
            let changes = CHANGE * (mu / before).ln().abs() * part;
            let here = Uncertain::new(mu.ln(), changes + error);
            // Of a stiff orbit the derivative may be too rough to come nearer by.
            if largest.is_some_and(|best| best.uncertainty <= here.uncertainty) {
                break;
            }
            largest = Some(here);
            (told.attractor, told.row.period) = (Some(state(point.as_slice())), Some(period));
            if changes <= error {
                break;
            }
            point = run.surface.nearest(&(point + &left));
            (before, step) = (mu, left.amax());
        }
        // Returns beside a steady state on the section repeat themselves too.
        if stress.1 - stress.0 < SWING {
            return None;
        }
        told.row.symmetry = Some(symmetry(unlike));
        told.row.returns_per_period = Some(found.returns);
        told.row.stress_range = Some(stress);
        let period = told.row.period?;
        told.row.lyapunov_max = largest.map(|ln| {
            // The period is that of a point a little beside the orbit.
            let by_period = ln.value.abs() * found.period.uncertainty / period;
            Uncertain::new(ln.value / period, (ln.uncertainty + by_period) / period)
        });
        Some(told)
    }
}

/// Once around from a point.
struct Revolution {
    /// The larger multiplier, its modulus.
    mu: f64,
    /// What its logarithm errs by.
    error: f64,
    /// What Newton's method would move the point by.
    left: Vector,
}

/// The larger multiplier by where the way around ends and its derivative; `None` where mu is too small to be told from rounding.
fn largest_multiplier(
    run: &SweepRun,
    point: &Vector,
    (end, derivative): &(Vector, Matrix),
) -> Option<Revolution> {
    const LEAST: f64 = 1e-6;
    let inside = run.surface.directions(point.as_slice());
    let reduced = reduce(derivative, &inside);
    let values = reduced.complex_eigenvalues();
    let mu = values.iter().map(|z| z.norm()).fold(0.0, f64::max);
    if !(mu > LEAST && mu.is_finite()) {
        return None;
    }
    let identity = Matrix::identity(2, 2);
    let left = (identity - &reduced)
        .lu()
        .solve(&(inside.transpose() * (end - point)))?;
    // A double multiplier errs by the root of what the derivative does.
    let error = DERIVATIVE_PER_RTOL * TOLERANCE;
    let (size, apart) = (reduced.norm(), (values[0] - values[1]).norm());
    let double = size / apart.max(error.sqrt() * size);
    Some(Revolution {
        mu,
        error: error * size / mu * double.max(1.0),
        left: inside * left,
    })
}

pub(super) fn alike(y: &Vector) -> bool {
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
pub(super) fn begun(run: &SweepRun, regime: Regime) -> Classified {
    let point = &run.point;
    let note = (run.pushes > 0).then(|| {
        "equal interfaces, held by rounding where that is unstable, were let go by 0.001 in ln psi2"
            .into()
    });
    Classified {
        row: SweepRow {
            returns: run.recorder.passed,
            note,
            ..SweepRow::new(point.number, point.loading, point.start.into(), regime)
        },
        attractor: run
            .recorder
            .returns
            .last()
            .map(|at| state(at.state.as_slice())),
    }
}

pub(super) fn steady(run: &SweepRun, equilibrium: &Vector, stable: bool) -> Classified {
    let mut told = begun(run, Regime::Steady);
    told.attractor = Some(state(equilibrium.as_slice()));
    told.row.symmetry = Some(symmetry((equilibrium[1] - equilibrium[2]).abs()));
    told.row.stress_range = Some((equilibrium[0], equilibrium[0]));
    told.row.lyapunov_max = Some(at_equilibrium(&run.field, equilibrium)[0]);
    if !stable {
        told.row.note = Some("starts at an unstable steady state and rests there".into());
    }
    told
}

pub(super) fn undecided(run: &SweepRun, why: String) -> Classified {
    let mut told = begun(run, Regime::Undecided);
    told.row.note = Some(why);
    told.attractor = None;
    told
}
