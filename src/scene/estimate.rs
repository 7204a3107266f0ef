//! The global error at the end of a run, from a second one.

use super::plan::Plan;
use super::run::{Outcome, Sink};
use crate::error::Result;
use crate::field::{State, VectorField};
use crate::integrate::{Choice, Control, Integrator, Step, Taylor, Tolerances};

/// How much tighter the second run is: its own error then hardly counts.
const TIGHTER: f64 = 100.0;
/// A tolerance below this gains nothing: rounding rules.
const TIGHTEST: f64 = 1e-14;
/// The second run's error, of which little is known but that it is small, is allowed for by this factor.
const MARGIN: f64 = 2.0;
/// Relative errors below this are rounding.
const ROUNDING: f64 = 4.0 * f64::EPSILON;

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

    fn integrator<const N: usize>(self, max_steps: usize) -> Result<Box<dyn Integrator<N>>> {
        match self {
            Companion::Tighter(tolerances) => Choice::Auto.integrator(tolerances, max_steps),
            Companion::Reference => Ok(Box::new(Taylor::reference(max_steps)?)),
        }
    }

    /// The error of a state that is so far from the companion's.
    fn error(self, distance: f64) -> f64 {
        match self {
            Companion::Tighter(_) => MARGIN * distance + ROUNDING,
            Companion::Reference => distance + ROUNDING,
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
    outcome: &mut Outcome,
    sink: &mut dyn Sink,
) -> Result<()> {
    let mut integrator = companion.integrator::<N>(plan.max_steps)?;
    let span = (0.0, plan.until);
    let mut stopped = false;
    // The reference takes long enough that one wants to see it move, and to stop it.
    let slow = companion == Companion::Reference;
    let second = if plan.observed() || slow {
        let mut observer = |step: &Step<'_, N>| {
            let control = sink.reached(step.t1 / plan.until);
            stopped = control == Control::Stop;
            Ok(control)
        };
        integrator.flow(field, span, y0, Some(&mut observer))
    } else {
        integrator.flow(field, span, y0, None)
    };
    outcome.work += integrator.work();
    match second {
        Ok(_) if stopped => outcome.stopped = true,
        Ok(second) => {
            outcome.error_estimate = Some(companion.error(relative_distance(end, &second)));
        }
        Err(error) => outcome.estimate_failure = Some(error),
    }
    Ok(())
}

/// Largest relative difference in stress and states: the states by their logarithms.
fn relative_distance<const N: usize>(y: &State<N>, reference: &State<N>) -> f64 {
    let stress = (y[0] - reference[0]).abs() / reference[0].abs().max(f64::MIN_POSITIVE);
    (1..N).fold(stress, |largest, i| {
        largest.max((y[i] - reference[i]).exp_m1().abs())
    })
}
