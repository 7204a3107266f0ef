//! Systems that are forced periodically: the phase of the forcing as a state, and what is asked of their orbits.

use super::file::{TIME, TimeUse};
use super::model::TextModel;
use crate::scene::system::Described;
use crate::scene::units::Quantity;
use twinslip::error::{Error, Result};
use twinslip::friction::positive;
use twinslip::model::TextSystem;

impl TextModel {
    /// How many states there are without the phase of a forcing, which is the last and goes round and round.
    pub(in crate::scene) fn moving(&self) -> usize {
        self.system.states().len() - usize::from(self.system.phase().is_some())
    }

    /// That there may be equilibria: under a forcing nothing rests.
    ///
    /// # Errors
    /// [`Error::Input`] for a system with a forcing.
    pub(in crate::scene) fn may_rest(&self) -> Result<()> {
        if self.system.phase().is_none() {
            return Ok(());
        }
        let (what, it) = match &self.slab {
            Some(_) => ("`modulate` forces the interfaces".to_owned(), "they have"),
            None => (format!("{} is forced", self.name()), "it has"),
        };
        Err(Error::Input(format!(
            "{what} periodically, so {it} no equilibria: look for orbits (`orbit`, `branch orbits`) or returns (`section`)"
        )))
    }

    /// The period of orbits that are looked for, where that is known: so many of a periodic forcing, or what is guessed.
    ///
    /// # Errors
    /// [`Error::Input`] for periods of a forcing where there is none, and for a guess where there is; [`Error::Parameter`] for a guess that is not positive.
    pub(in crate::scene) fn period(
        &self,
        turns: Option<usize>,
        guess: Option<f64>,
    ) -> Result<Option<f64>> {
        let Some(forcing) = self.system.forcing_period() else {
            if let Some(turns) = turns {
                return Err(not_forced(turns));
            }
            let guess = guess
                .map(|period| positive("period-guess", period))
                .transpose()?;
            return Ok(guess.map(|period| self.units().inward(Quantity::Time, period)));
        };
        if guess.is_some() {
            return Err(Error::Input(
                "`period_guess`: orbits under a forcing last whole periods of it; say how many by `turns`".into(),
            ));
        }
        match turns {
            Some(0) => Err(Error::parameter("turns", 0, "at least 1")),
            turns => Ok(Some(turns.unwrap_or(1) as f64 * forcing)),
        }
    }
}

/// What formulas that name time have in its place: that variable, or the phase of its period as a state.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum TimeIs {
    Time,
    Phase,
}

/// That periods of a forcing are counted where there is none.
pub(in crate::scene) fn not_forced(turns: usize) -> Error {
    Error::Input(format!(
        "`turns` {turns} counts periods of a forcing, and nothing is forced here: give `modulate`, or a `system` whose formulas name {TIME}, with the key period"
    ))
}

/// That a file names time, and no period of it.
pub(super) fn no_period(file: &str, TimeUse { formula, place }: &TimeUse) -> Error {
    let (line, column) = place;
    Error::Input(format!(
        "{file}:{line}:{column}: {formula} names {TIME}, the time: only `integrate`, and solve_ivp in Python, take such a system, unless the file says of what period that is, as in period = \"2*pi/w\""
    ))
}

/// That what depends on time has the period that is said.
pub(super) fn is_periodic(system: &TextSystem, start: &[Option<f64>]) -> Result<()> {
    /// Phases that are looked at, and by how much rates a period apart may differ, as a part of the largest.
    const PHASES: [f64; 4] = [0.0, 0.137, 0.419, 0.781];
    const SAME: f64 = 1e-8;
    let period = system.forcing_period().unwrap_or(f64::NAN);
    if !(period.is_finite() && period > 0.0) {
        let must = "positive and finite";
        return Err(Error::parameter("the period of the system", period, must));
    }
    let at = |phase: f64| {
        let states = start[..start.len() - 1].iter();
        let states = states.map(|x| x.filter(|x| *x != 0.0).unwrap_or(0.5));
        system.rates(&states.chain([phase]).collect::<Vec<f64>>())
    };
    let rates = PHASES.map(|phase| [at(phase), at(phase + 1.0)]);
    for (i, state) in system.states().iter().enumerate() {
        // Of the largest rate at any phase: at some it may be 0 but for rounding.
        let size = rates
            .iter()
            .flatten()
            .fold(0.0_f64, |most, all| most.max(all[i].abs()));
        for (phase, [now, later]) in PHASES.into_iter().zip(&rates) {
            // Outside its domain a formula says nothing.
            if (now[i] - later[i]).abs() > SAME * size {
                return Err(Error::Input(format!(
                    "the period of the system, {period}, is none: the rate of {state} is {} at {TIME} = {} and {} a period later",
                    now[i],
                    phase * period,
                    later[i]
                )));
            }
        }
    }
    Ok(())
}
