//! Classifies what a run has settled on, from its returns.

use super::closing::apart;
use super::flows::Flows;
use super::orbit::{TOLERANCE, around};
use super::slow_convergence::{Leap, SlowReturns};
use super::watch::{SWING, SweepRun};
use super::{SweepRow, SweepSettings, slow_convergence};
use crate::equilibrium::Symmetry;
use crate::error::{Error, Result};
use crate::field::{State, Vector, state};
use crate::integrate::{AnyIntegrator, Choice, MAX_STEPS, Tolerances};
use crate::section::{Ended, Periodic, PeriodicSearch, Regime, at_equilibrium};

/// Log states that differ by less, all along, are those of interfaces that move alike.
const ALIKE: f64 = 1e-6;
/// The step at which Newton's method ends; the error then is its square.
pub(super) const CONVERGED: f64 = 1e-5;
/// Returns after which a run that has not settled is judged: each time twice as many.
pub(super) const FIRST_STAGE: usize = 64;
/// Returns without which no run is seen to creep.
pub(super) const FEWEST_TO_CREEP: usize = 256;
/// A candidate that is none is not looked at again before this part more returns.
pub(super) const LATER: f64 = 1.3;
/// The error of the multipliers by which it is told whether a point attracts, in tolerances.
const MULTIPLIER_PER_RTOL: f64 = 1e4;
/// A run this close to an unstable orbit is held on it.
pub(super) const ON_ORBIT: f64 = 1e-5;

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
            if let Some(equilibrium) =
                slow_convergence::to_rest(&run.field, &run.surface, run.returns(), 1.0)
            {
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
            unit: 1.0,
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
        attracts(found, self.settings.rtol)
    }

    fn orbit(&mut self, run: &SweepRun, found: &Periodic) -> Option<Classified> {
        let orbit = around(&run.field, &run.surface, &mut self.fine, found, 0)?;
        // Returns beside a steady state on the section repeat themselves too.
        if orbit.range.1 - orbit.range.0 < SWING {
            return None;
        }
        let mut told = begun(run, Regime::Periodic);
        told.attractor = Some(state(orbit.point.as_slice()));
        told.row.period = Some(orbit.period);
        told.row.symmetry = Some(symmetry(orbit.unlike));
        told.row.returns_per_period = Some(found.returns);
        told.row.range = Some(orbit.range);
        told.row.lyapunov_max = orbit.exponent;
        Some(told)
    }
}

/// Whether a point attracts, beyond the error of its multiplier at this tolerance.
pub(super) fn attracts(found: &Periodic, rtol: f64) -> bool {
    found.attracts() && found.multiplier < 1.0 - MULTIPLIER_PER_RTOL * rtol
}

pub(super) fn alike(y: &Vector) -> bool {
    (y[1] - y[2]).abs() < ALIKE
}

pub(super) fn symmetry(unlike: f64) -> Symmetry {
    if unlike < ALIKE {
        Symmetry::Symmetric
    } else {
        Symmetry::Asymmetric
    }
}

/// A row of which the regime is known.
pub(super) fn begun(run: &SweepRun, regime: Regime) -> Classified {
    let point = &run.point;
    let (parameters, start) = (point.parameters.clone(), point.start.as_slice().to_vec());
    let note = (run.pushes > 0).then(|| {
        "equal interfaces, held by rounding where that is unstable, were let go by 0.001 in ln psi2"
            .into()
    });
    Classified {
        row: SweepRow {
            returns: run.recorder.passed,
            note,
            ..SweepRow::new(point.number, parameters, start, regime)
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
    told.row.range = Some((equilibrium[0], equilibrium[0]));
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
