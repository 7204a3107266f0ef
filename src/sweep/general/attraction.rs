//! The stable equilibria that a run comes near, with balls around them that no run leaves.

use crate::equilibrium::{Enclosed, LyapunovBall};
use crate::field::Vector;
use crate::integrate::AnyField;
use crate::section::growth;

/// An equilibrium is looked for so near to a state, in units of 1 + |y|: within what a run swings around.
const NEAR: f64 = 0.75;
/// As many are remembered.
const MOST: usize = 8;
/// Newton's method ends at this step, in the same units, or fails.
const CONVERGED: f64 = 1e-10;
const ITERATIONS: usize = 12;
/// Two that are so near are the same.
const SAME: f64 = 1e-6;

/// The equilibria that were found.
#[derive(Debug, Default)]
pub(super) struct Attraction {
    /// Each with its ball, where it is stable and has one.
    known: Vec<(Vector, Option<LyapunovBall>)>,
}

impl Attraction {
    /// The stable equilibrium at which the run through y ends for certain.
    pub fn of(
        &mut self,
        field: &AnyField<'_>,
        equations: &dyn Enclosed,
        y: &[f64],
    ) -> Option<Vector> {
        let state = Vector::from_column_slice(y);
        let size = 1.0 + state.amax();
        let held = |(at, ball): &(Vector, Option<LyapunovBall>)| {
            ball.as_ref()
                .filter(|ball| ball.holds(y))
                .map(|_| at.clone())
        };
        let near = |at: &Vector, distance: f64| (&state - at).amax() < distance * size;
        if let Some(here) = self.known.iter().find(|(at, _)| near(at, NEAR)) {
            return held(here);
        }
        if self.known.len() == MOST {
            return None;
        }
        let at = equilibrium(field, &state, NEAR * size)?;
        if self
            .known
            .iter()
            .any(|(known, _)| (known - &at).amax() < SAME * size)
        {
            return None;
        }
        let stable = growth(field, at.as_slice()) < 0.0;
        let ball = stable
            .then(|| LyapunovBall::around(equations, &at))
            .flatten();
        let here = (at, ball);
        let told = held(&here);
        self.known.push(here);
        told
    }
}

/// The equilibrium that Newton's method leads to from a state without leaving its surroundings.
fn equilibrium(field: &AnyField<'_>, state: &Vector, distance: f64) -> Option<Vector> {
    let mut at = state.clone();
    for _ in 0..ITERATIONS {
        let step = field.newton_step(at.as_slice())?;
        at -= &step;
        if (&at - state).amax() > distance {
            return None;
        }
        if step.amax() < CONVERGED * (1.0 + at.amax()) {
            return Some(at);
        }
    }
    None
}
