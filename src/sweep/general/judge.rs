//! Judges the runs of any system.

use super::super::SweepRow;
use super::super::aperiodic::{FEWEST_TO_ASK, FEWEST_TO_WANDER, FineRun, fine_returns};
use super::super::classify::{
    CONVERGED, FEWEST_TO_CREEP, LATER, ON_ORBIT, alike, attracts, symmetry,
};
use super::super::closing::{ARRIVED, apart};
use super::super::orbit::around;
use super::super::slow_convergence::{SlowReturns, comes_as_said, to_rest};
use super::super::watch::SWING;
use super::run::{GeneralRun, pushed};
use super::{GeneralSweeper, Settled};
use crate::error::Error;
use crate::field::Vector;
use crate::section::{
    Ended, FEWEST_RETURNS, IRREGULAR, Periodic, PeriodicSearch, REGULAR, Regime, Return, Watching,
    aperiodic, at_equilibrium, growth, points, regularity,
};

/// By what part of its size a run starts beside the steady state of the point before.
const APART: f64 = 1e-4;

impl GeneralSweeper {
    /// Follows a run until it is told what it settles on; the row has what is known of its point.
    pub(super) fn settle(&mut self, mut run: GeneralRun, row: SweepRow) -> Settled {
        if let Err(error) = self.pass_transient(&mut run) {
            let why = run.in_words(error);
            return undecided(&run, row, why);
        }
        loop {
            if run.recorder.ended.is_none()
                && run.hopeless.is_none()
                && let Err(error) = run.advance(&mut self.coarse)
            {
                let why = run.in_words(error);
                return undecided(&run, row, why);
            }
            if let Some(told) = self.judge(&mut run, &row) {
                return told;
            }
        }
    }

    fn judge(&mut self, run: &mut GeneralRun, row: &SweepRow) -> Option<Settled> {
        if let Some(why) = run.hopeless.take() {
            return Some(undecided(run, row.clone(), why));
        }
        match run.recorder.ended.take() {
            Some(Ended::Steady { equilibrium, .. }) => {
                return Some(steady(run, row, &equilibrium));
            }
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
                    error => Some(undecided(run, row.clone(), run.in_words(error))),
                };
            }
            Some(Ended::Complete | Ended::Stopped) | None => (),
        }
        if run.recorder.steps >= self.settings.max_steps {
            let why = "its steps are used up; raise `max_steps`";
            return Some(undecided(run, row.clone(), why.into()));
        }
        // The rounding of an equilibrium on the section returns for ever.
        if run.leaves_rest() {
            return None;
        }
        if let Some(q) = run.candidate.take() {
            match self.periodic(run, row, q) {
                Some(told) => return Some(told),
                None => run.next_look = (run.recorder.returns.len() as f64 * LATER) as usize + 1,
            }
        }
        let n = run.recorder.returns.len();
        if n < run.next_stage {
            return None;
        }
        if let Some(told) = self.creeping(run, row) {
            return Some(told);
        }
        let told = self.wandering(run, row);
        let last = n >= self.settings.max_returns;
        run.next_stage = (2 * n).min(self.settings.max_returns);
        run.begin_stage();
        match told {
            Ok(told) => Some(told),
            Err(why) if last => Some(undecided(run, row.clone(), why.into())),
            Err(_) => None,
        }
    }

    /// The periodic orbit that the run has come to, or comes to as fast as its multipliers say. From one that does not attract it is let
    /// go, where it is held there.
    fn periodic(&mut self, run: &mut GeneralRun, row: &SweepRow, q: usize) -> Option<Settled> {
        let (rtol, unit) = (self.settings.rtol, run.unit);
        let returns = run.returns();
        let mut search = PeriodicSearch::new(
            &run.field,
            &run.surface,
            &mut self.coarse,
            returns,
            (rtol, q),
        )
        .in_units(unit);
        search.converged = CONVERGED * unit;
        let found = search.point()?;
        let last = &returns.last()?.state;
        if attracts(&found, rtol) {
            let arrived = apart(last, &found.point) < ARRIVED * unit;
            if arrived || comes_as_said(run.surface.chart, returns, &found) {
                return self.orbit(run, row, &found);
            }
        } else if apart(last, &found.point) < ON_ORBIT * unit {
            let last = last.clone();
            run.let_go(&last);
        }
        None
    }

    /// What the run creeps to.
    fn creeping(&mut self, run: &GeneralRun, row: &SweepRow) -> Option<Settled> {
        let returns = run.returns();
        if returns.len() < FEWEST_TO_CREEP {
            return None;
        }
        if let Some(equilibrium) = to_rest(&run.field, &run.surface, returns, run.unit) {
            return Some(steady(run, row, &equilibrium));
        }
        let mut slow = SlowReturns {
            field: &run.field,
            surface: &run.surface,
            taylor: &mut self.fine,
            returns,
            accuracy: self.settings.rtol,
            unit: run.unit,
        };
        let found = slow.nearby()?;
        attracts(&found, self.settings.rtol)
            .then(|| self.orbit(run, row, &found))
            .flatten()
    }

    fn orbit(&mut self, run: &GeneralRun, row: &SweepRow, found: &Periodic) -> Option<Settled> {
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
        let mut told = begun(run, row, Regime::Periodic);
        told.attractor = Some(orbit.point);
        told.row.period = Some(orbit.period);
        told.row.symmetry = run.equal_parts.then(|| symmetry(orbit.unlike));
        told.row.returns_per_period = Some(found.returns);
        told.row.range = Some(orbit.range);
        told.row.lyapunov_max = orbit.exponent;
        Some(told)
    }

    /// A torus or chaos, or why nothing can be said. Where there is a stable steady state too, chaos may be but a way to it: it is waited for,
    /// and nothing said in the end.
    fn wandering(&self, run: &GeneralRun, row: &SweepRow) -> Result<Settled, &'static str> {
        let n = run.returns().len();
        let last = run.recorder.returns.len() >= self.settings.max_returns;
        if n < FEWEST_TO_WANDER && !last {
            return Err("too early");
        }
        let half = &run.returns()[n / 2..];
        let plane = run.field.dimension() < 3;
        if plane || (run.equal_parts && half.iter().all(|at| alike(&at.state))) {
            return Err(
                "its motion is plane, and so neither a torus nor chaos, and closes in on nothing yet; raise `max_returns`",
            );
        }
        if half.len() < FEWEST_RETURNS / 2 {
            return Err("too few returns since it was let go from an unstable state or orbit");
        }
        let seen = aperiodic(&run.surface, half, self.settings.rtol, None);
        if seen.regime == Regime::Torus {
            if self.settings.lyapunov {
                return self.with_tangents(run, row);
            }
            let mut told = begun(run, row, Regime::Torus);
            told.row.range = Some(run.reach[run.variable]);
            return Ok(told);
        }
        if n < FEWEST_TO_ASK && !last {
            return Err("too early");
        }
        let disorder = regularity(&points(&run.surface, half));
        if disorder > IRREGULAR && may_come_to_rest(run) {
            return Err(
                "its returns are irregular, but there is a stable steady state, to which they may lead; raise `max_returns`",
            );
        }
        if !(REGULAR..=IRREGULAR).contains(&disorder) {
            return self.with_tangents(run, row);
        }
        Err("the returns are neither regular nor irregular yet; raise `max_returns`")
    }

    /// Records anew from where the run is, so finely that its tangents tell its exponents.
    fn with_tangents(&self, run: &GeneralRun, row: &SweepRow) -> Result<Settled, &'static str> {
        let watching = Watching {
            returns: fine_returns(run.recorder.returns.len()),
            ..run.watching
        };
        let at = (&run.field, &run.surface, run.last());
        let found = FineRun::of(at, &watching, self.settings.max_steps)?;
        if let Some(equilibrium) = found.rests_at() {
            return Ok(steady(run, row, equilibrium));
        }
        let (regime, exponent) = found.regime(&run.surface, &run.field)?;
        let mut told = begun(run, row, regime);
        told.row.returns += found.recorded.returns.len();
        told.row.range = Some(run.reach[run.variable]);
        told.row.lyapunov_max = exponent;
        told.attractor = found.last().map(|at| at.state.clone());
        Ok(told)
    }
}

/// Whether Newton's method leads from a return of the run to a stable steady state.
fn may_come_to_rest(run: &GeneralRun) -> bool {
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

/// A row of which the regime is known.
fn begun(run: &GeneralRun, row: &SweepRow, regime: Regime) -> Settled {
    let note = (run.pushes > 0)
        .then(|| "held by a symmetry or its start where that is unstable, it was let go by 0.001 of its size".into());
    Settled {
        row: SweepRow {
            regime,
            note,
            returns: run.recorder.passed,
            ..row.clone()
        },
        attractor: run.returns().last().map(|at| at.state.clone()),
    }
}

fn steady(run: &GeneralRun, row: &SweepRow, equilibrium: &Vector) -> Settled {
    let mut told = begun(run, row, Regime::Steady);
    let n = equilibrium.len();
    let value = equilibrium[run.variable];
    told.row.symmetry = run
        .equal_parts
        .then(|| symmetry((equilibrium[n - 2] - equilibrium[n - 1]).abs()));
    told.row.range = Some((value, value));
    told.row.lyapunov_max = Some(at_equilibrium(&run.field, equilibrium)[0]);
    told.attractor = Some(pushed(equilibrium, APART));
    told
}

fn undecided(run: &GeneralRun, row: SweepRow, why: String) -> Settled {
    let mut told = begun(run, &row, Regime::Undecided);
    told.row.note = Some(why);
    told.attractor = None;
    told
}
