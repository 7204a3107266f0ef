//! Classifies what a run has settled on, from its returns.

use super::aperiodic::wandering;
use super::closing::{ARRIVED, apart};
use super::flows::Flows;
use super::orbit::{TOLERANCE, around};
use super::slow_convergence::{Leap, SlowReturns, comes_as_said, to_rest};
use super::watch::{ALIKE, SWING, SweepRun, are_alike, pushed};
use super::{SweepRow, SweepSettings};
use crate::equilibrium::Symmetry;
use crate::error::{Error, Result};
use crate::field::Vector;
use crate::integrate::{AnyIntegrator, Choice, MAX_STEPS, Tolerances};
use crate::section::{Ended, Periodic, PeriodicSearch, Regime, at_equilibrium};

/// The step at which Newton's method ends; the error then is its square.
const CONVERGED: f64 = 1e-5;
/// Returns after which a run that has not settled is classified: each time twice as many.
pub(super) const FIRST_STAGE: usize = 64;
/// Returns without which no run is seen to converge slowly.
const FEWEST_TO_CREEP: usize = 256;
/// A candidate that is none is not looked at again before this part more returns.
const LATER: f64 = 1.3;
/// The error of the multipliers by which it is told whether a point attracts, in tolerances.
const MULTIPLIER_PER_RTOL: f64 = 1e4;
/// A run this close to an unstable orbit is held on it.
const ON_ORBIT: f64 = 1e-5;
/// By how much the next run starts beside the steady state of the point before: of its size, or of equal parts in the last variable.
const APART: f64 = 1e-4;

/// Classifies runs; its integrators are used over and over.
pub(super) struct Classifier {
    pub settings: SweepSettings,
    /// The integrators of the runs.
    pub flows: Flows,
    /// The integrator of orbits.
    fine: AnyIntegrator,
}

/// The row of a run that has settled, and where the next run may start.
pub(super) struct Settled {
    pub row: SweepRow,
    pub attractor: Option<Vector>,
    /// The state where it rests.
    pub rest: Option<Vector>,
}

impl Settled {
    /// The row in the system's own units. Words have them already.
    pub fn outward(mut self, run: &SweepRun) -> Self {
        let units = &run.units;
        let size = units.sizes[run.variable];
        let row = &mut self.row;
        row.period = row.period.map(|period| period * units.time);
        row.range = row.range.map(|(low, high)| (low * size, high * size));
        row.lyapunov_max = row.lyapunov_max.map(|x| units.outward_rate(x));
        self.attractor = self.attractor.map(|state| units.outward(&state));
        self
    }
}

/// Whether a run that is not there yet shows where it comes to.
enum Creeping {
    To(Box<Settled>),
    Leapt,
    No,
}

impl Classifier {
    pub fn new(settings: &SweepSettings) -> Result<Self> {
        let fine = Tolerances::equal(TOLERANCE.min(settings.rtol))?;
        Ok(Classifier {
            settings: settings.clone(),
            flows: Flows::new(settings)?,
            fine: AnyIntegrator::new(Choice::Taylor, fine, MAX_STEPS)?,
        })
    }

    /// The regime that the run has settled on, or `None` if it shall go on.
    pub fn classify(&mut self, run: &mut SweepRun) -> Option<Settled> {
        let told = self.verdict(run)?;
        // What is found after a leap, other than where it led to, is not what the run comes to.
        if run.leaps_back() {
            return None;
        }
        Some(told)
    }

    fn verdict(&mut self, run: &mut SweepRun) -> Option<Settled> {
        if let Some(why) = run.hopeless.take() {
            return Some(undecided(run, why));
        }
        match run.recorder.ended.take() {
            Some(Ended::Steady { equilibrium, .. }) => return Some(steady(run, &equilibrium)),
            Some(Ended::Failed(error)) => {
                return match error {
                    Error::NoReturn {
                        lowest, highest, ..
                    } if run.section_moves_between(lowest, highest)
                        || run.leaves_rest()
                        || run.waits_longer() =>
                    {
                        None
                    }
                    error => Some(undecided(run, run.in_words(error))),
                };
            }
            Some(Ended::Complete | Ended::Stopped) | None => (),
        }
        if run.recorder.steps >= self.settings.max_steps {
            return Some(undecided(
                run,
                "the limit of steps was reached; raise `max_steps`".into(),
            ));
        }
        // The rounding of an equilibrium on the section returns for ever.
        if run.leaves_rest() {
            return None;
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
        let told = wandering(self, run);
        let last = n >= self.settings.max_returns;
        run.next_stage = (2 * n).min(self.settings.max_returns);
        run.begin_stage();
        match told {
            Ok(told) => Some(told),
            Err(why) if last => Some(undecided(run, why.into())),
            Err(_) => None,
        }
    }

    /// The periodic orbit that the run has come to, or comes to as fast as its multipliers say. From one that does not attract it is let
    /// go, where it is held there.
    fn periodic(&mut self, run: &mut SweepRun, q: usize) -> Option<Settled> {
        let (rtol, unit) = (self.settings.rtol, run.unit);
        let found = self.near(run, q)?;
        let returns = run.returns();
        let last = &returns.last()?.state;
        if attracts(&found, rtol) {
            let arrived = apart(last, &found.point) < ARRIVED * unit;
            if !arrived && !comes_as_said(run.surface.chart, returns, &found) {
                return None;
            }
            // A leap is confirmed where it led to.
            let same = |leap: &&Leap| apart(&leap.to.point, &found.point) < CONVERGED * unit;
            let to = run.leap.as_ref().filter(same).map(|leap| leap.to.clone());
            let is_confirmed = to.is_some();
            let told = self.tightest(run, [Some(found), to].into_iter().flatten())?;
            if is_confirmed {
                run.leap = None;
            }
            return Some(told);
        }
        if apart(last, &found.point) < ON_ORBIT * unit {
            let last = last.clone();
            run.let_go(&last);
        }
        None
    }

    /// The q-periodic point near the last return.
    fn near(&mut self, run: &SweepRun, q: usize) -> Option<Periodic> {
        let (accuracy, returns) = (self.settings.rtol, run.returns());
        let coarse = self.flows.one();
        let search = PeriodicSearch::new(&run.field, &run.surface, coarse, returns, (accuracy, q));
        let mut search = search.in_units(run.unit);
        search.converged = CONVERGED * run.unit;
        search.point()
    }

    /// The attractor that the run converges to slowly.
    fn creeping(&mut self, run: &mut SweepRun) -> Creeping {
        let returns = run.returns();
        if returns.len() < FIRST_STAGE {
            return Creeping::No;
        }
        let found = if let Some(leap) = &run.leap {
            if !leap.is_confirmed_by(returns) {
                return Creeping::No;
            }
            let to = leap.to.clone();
            if !leap.is_near(returns) {
                return self.leap(run, to);
            }
            let here = self.near(run, to.returns);
            let same = |here: &Periodic| apart(&here.point, &to.point) < CONVERGED * run.unit;
            let here = here.filter(same);
            vec![Some(to), here]
        } else {
            let far = run.may_leap().then(|| self.slow(run).ahead()).flatten();
            if let Some(Creeping::Leapt) = far.map(|far| self.leap(run, far)) {
                return Creeping::Leapt;
            }
            if run.returns().len() < FEWEST_TO_CREEP {
                return Creeping::No;
            }
            let rest = to_rest(&run.field, &run.surface, run.returns(), run.unit);
            if let Some(equilibrium) = rest {
                return Creeping::To(Box::new(steady(run, &equilibrium)));
            }
            // Where little is between the map and the identity, the point is off by much more than the map.
            vec![self.slow(run).nearby()]
        };
        let attracting = found.into_iter().flatten();
        let attracting: Vec<Periodic> = attracting.filter(|found| self.attracts(found)).collect();
        match self.tightest(run, attracting) {
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
            unit: run.unit,
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

    /// The orbit through points that are one and the same, from that which gives the tightest bound: that is a matter of how far the last step of
    /// Newton's method was above rounding.
    fn tightest(
        &mut self,
        run: &SweepRun,
        points: impl IntoIterator<Item = Periodic>,
    ) -> Option<Settled> {
        let off = |told: &Settled| {
            told.row
                .lyapunov_max
                .map_or(f64::INFINITY, |x| x.uncertainty)
        };
        let told = points
            .into_iter()
            .filter_map(|point| self.orbit(run, &point));
        told.min_by(|a, b| off(a).total_cmp(&off(b)))
    }

    fn orbit(&mut self, run: &SweepRun, found: &Periodic) -> Option<Settled> {
        let orbit = around(
            &run.field,
            &run.surface,
            &mut self.fine,
            found,
            run.variable,
        )?;
        // Returns beside a steady state on the section repeat themselves too.
        if orbit.range.1 - orbit.range.0 < SWING {
            return None;
        }
        let mut told = begun(run, Regime::Periodic);
        told.attractor = Some(orbit.point);
        told.row.period = Some(orbit.period);
        told.row.symmetry = run.equal_parts.then(|| symmetry(orbit.unlike));
        told.row.returns_per_period = Some(found.returns);
        told.row.range = Some(orbit.range);
        told.row.lyapunov_max = orbit.exponent;
        Some(told)
    }
}

/// Whether a point attracts, beyond the error of its multiplier at this tolerance.
fn attracts(found: &Periodic, rtol: f64) -> bool {
    found.attracts() && found.multiplier < 1.0 - MULTIPLIER_PER_RTOL * rtol
}

fn symmetry(unlike: f64) -> Symmetry {
    if unlike < ALIKE {
        Symmetry::Symmetric
    } else {
        Symmetry::Asymmetric
    }
}

/// A row of which the regime is known.
pub(super) fn begun(run: &SweepRun, regime: Regime) -> Settled {
    let note = (run.pushes > 0)
        .then(|| "it stayed on an unstable symmetric or initial state; it was perturbed by 0.001 of its size".into());
    Settled {
        row: SweepRow {
            regime,
            note,
            returns: run.recorder.passed,
            ..run.row.clone()
        },
        attractor: run.recorder.returns.last().map(|at| at.state.clone()),
        rest: None,
    }
}

pub(super) fn steady(run: &SweepRun, equilibrium: &Vector) -> Settled {
    let mut told = begun(run, Regime::Steady);
    let last = equilibrium.len() - 1;
    let value = equilibrium[run.variable];
    told.row.range = Some((value, value));
    told.rest = Some(equilibrium.clone());
    told.row.lyapunov_max = Some(at_equilibrium(&run.field, equilibrium)[0]);
    // From the state itself the next run would come to rest where that is unstable.
    told.attractor = Some(match run.equal_parts {
        true => {
            let unlike = (equilibrium[last - 1] - equilibrium[last]).abs();
            told.row.symmetry = Some(symmetry(unlike));
            let mut beside = equilibrium.clone();
            if unlike < APART {
                beside[last] = beside[last - 1] + APART;
            }
            beside
        }
        false => pushed(equilibrium, APART),
    });
    told
}

pub(super) fn undecided(run: &SweepRun, why: String) -> Settled {
    let mut told = begun(run, Regime::Undecided);
    told.row.note = Some(why);
    told.attractor = None;
    told
}

/// Whether the last two variables of a state, of equal parts, move alike.
pub(super) fn alike(y: &Vector) -> bool {
    are_alike(y.as_slice(), ALIKE)
}
