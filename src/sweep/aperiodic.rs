//! Aperiodic motion: runs that close in on nothing, which are tori, chaos, or neither yet.

use super::classify::{Classified, Classifier, alike, begun, steady};
use super::finite_difference_exponent::stretching;
use super::flows::Flows;
use super::watch::{SweepRun, see};
use crate::field::{Vector, state, vector};
use crate::integrate::{AnyField, Control};
use crate::number::Uncertain;
use crate::section::{
    Ended, FEWEST_FOR_EXPONENTS, FEWEST_RETURNS, IRREGULAR, REGULAR, Regime, Return, ReturnRecord,
    Surface, Watching, aperiodic, points, record_finely, regularity, spectrum,
};

/// Returns without which neither torus nor chaos is told: those before are let pass.
pub(super) const FEWEST_TO_WANDER: usize = 512;
/// Returns before exponents are asked for.
pub(super) const FEWEST_TO_ASK: usize = 1024;
/// Over how many returns exponents are taken: if these don't tell, twice as many.
const FOR_EXPONENTS: std::ops::RangeInclusive<usize> = 256..=1024;

impl Classifier {
    /// A torus or chaos, or why nothing can be said.
    pub(super) fn wandering(
        &self,
        run: &SweepRun,
        flows: &mut Flows,
    ) -> std::result::Result<Classified, &'static str> {
        let n = run.returns().len();
        let last = run.recorder.returns.len() >= self.settings.max_returns;
        if n < FEWEST_TO_WANDER && !last {
            return Err("too early");
        }
        let half = &run.returns()[n / 2..];
        if half.len() < FEWEST_RETURNS / 2 {
            return Err("too few returns since it was let go from an unstable orbit");
        }
        if half.iter().all(|at| alike(&at.state)) {
            return Err(
                "equal interfaces, whose motion is plane and so neither a torus nor chaos, close in on nothing yet; raise `max_returns`",
            );
        }
        let seen = aperiodic(&run.surface, half, self.settings.rtol, None);
        if seen.regime == Regime::Torus {
            if self.settings.lyapunov {
                return self.with_tangents(run);
            }
            return Ok(told(run, Regime::Torus, run.stress));
        }
        if n < FEWEST_TO_ASK && !last {
            return Err("too early");
        }
        let disorder = regularity(&points(&run.surface, half));
        if disorder > IRREGULAR {
            return match self.chaos(run, flows) {
                Some(told) => told,
                None if last => self.with_tangents(run),
                None => Err("runs beside it take another way"),
            };
        }
        if disorder < REGULAR {
            return self.with_tangents(run);
        }
        Err("the returns are neither regular nor irregular yet; raise `max_returns`")
    }

    /// Chaos, by the exponents along the last returns: of ever more, until they tell. `None` where no runs beside it can be
    /// compared with it.
    fn chaos(
        &self,
        run: &SweepRun,
        flows: &mut Flows,
    ) -> Option<std::result::Result<Classified, &'static str>> {
        let all = run.returns();
        let settled = all.len() / 2;
        let mut count = *FOR_EXPONENTS.start();
        loop {
            count = count.min(settled).min(*FOR_EXPONENTS.end());
            if count < FEWEST_FOR_EXPONENTS {
                return Some(Err("too few returns for exponents; raise `max_returns`"));
            }
            let late: &[Return] = &all[all.len() - count..];
            let found = stretching(run, late, flows, self.settings.rtol)?;
            let made = aperiodic(&run.surface, late, self.settings.rtol, Some(found.known()));
            if made.regime == Regime::Chaotic {
                let mut told = told(run, Regime::Chaotic, run.stress);
                told.row.lyapunov_max = found.across_flow();
                return Some(Ok(told));
            }
            if count == settled || count == *FOR_EXPONENTS.end() {
                return Some(Err(made.why.unwrap_or("its returns do not tell")));
            }
            count *= 2;
        }
    }

    /// Records anew from where the run is, so finely that its tangents tell an exponent that vanishes.
    fn with_tangents(&self, run: &SweepRun) -> std::result::Result<Classified, &'static str> {
        let all = &run.recorder.returns;
        let start = all
            .last()
            .map_or_else(|| vector(&run.state), |at| at.state.clone());
        let watching = Watching {
            returns: fine_returns(all.len()),
            ..run.watching
        };
        let at = (&run.field, &run.surface, &start);
        let found = FineRun::of(at, &watching, self.settings.max_steps)?;
        if let Some(equilibrium) = found.rests_at() {
            return Ok(steady(run, equilibrium, true));
        }
        let mut stress = run.stress;
        for point in &found.recorded.waypoints {
            see(&mut stress, point.state[0]);
        }
        let (regime, exponent) = found.regime(&run.surface, &run.field)?;
        let mut told = told(run, regime, stress);
        told.row.returns += found.recorded.returns.len();
        told.attractor = found.last().map(|at| state(at.state.as_slice()));
        told.row.lyapunov_max = exponent;
        Ok(told)
    }
}

/// Over how many returns tangents are taken of a run with so many.
pub(super) fn fine_returns(all: usize) -> usize {
    (all / 4).clamp(*FOR_EXPONENTS.start(), *FOR_EXPONENTS.end())
}

/// A run recorded so finely that its tangents tell an exponent that vanishes.
pub(super) struct FineRun {
    pub recorded: ReturnRecord,
}

impl FineRun {
    pub fn of(
        (field, surface, start): (&AnyField<'_>, &Surface, &Vector),
        watching: &Watching,
        max_steps: usize,
    ) -> std::result::Result<Self, &'static str> {
        let see_all = &mut |_: usize, _: Option<&_>| Control::Continue;
        let recorded = record_finely(field, start, surface, watching, max_steps, see_all);
        let recorded = recorded.map_err(|_| "its tangents fail")?;
        Ok(FineRun { recorded })
    }

    /// Where it has come to rest, if it has.
    pub fn rests_at(&self) -> Option<&Vector> {
        match &self.recorded.ended {
            Ended::Steady { equilibrium, .. } => Some(equilibrium),
            _ => None,
        }
    }

    pub fn last(&self) -> Option<&Return> {
        self.recorded.returns.last()
    }

    /// A torus or chaos with the largest exponent across the flow, or why neither can be said.
    pub fn regime(
        &self,
        surface: &Surface,
        field: &AnyField<'_>,
    ) -> std::result::Result<(Regime, Option<Uncertain>), &'static str> {
        let recorded = &self.recorded;
        let found = spectrum(field, recorded).map_err(|_| "its tangents fail")?;
        let known = Some(found.known());
        let made = aperiodic(surface, &recorded.returns, recorded.accuracy, known);
        match made.regime {
            Regime::Torus | Regime::Chaotic => Ok((made.regime, found.across_flow())),
            _ => Err(made.why.unwrap_or("its returns do not tell")),
        }
    }
}

fn told(run: &SweepRun, regime: Regime, stress: (f64, f64)) -> Classified {
    let mut told = begun(run, regime);
    told.row.range = Some(stress);
    told
}
