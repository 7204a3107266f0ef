//! The asymmetric steady state in a bracket: KINSOL on (20) in the two unknowns (ln V_slow, ln V_fast).
//!
//! The symmetric state solves (20) too. Dividing the difference of the stresses by that of the logarithms takes it out, and
//! makes the system regular up to the pitchfork.

use super::isolate::Bracket;
use crate::error::{Error, Result};
use crate::field::{Jacobian, State};
use crate::friction::{Law, steady_log_activation};
use crate::number::{Difference, Jet, Real, log_ratio};
use crate::sundials::{Kinsol, KinsolSettings, Residual, Strategy};

/// Where in the bracket, as fractions of its logarithmic width, the iteration starts, in turn until one ends inside.
const STARTS: [f64; 9] = [0.5, 0.25, 0.75, 0.1, 0.9, 0.02, 0.98, 1e-3, 0.999];

/// Residual from which on Newton's method converges quadratically, unless a fold is very close.
const NEAR: f64 = 1e-9;
/// Rounds of two Newton steps from there; one or two reach rounding, but at a fold each step only halves the error.
const ROUNDS: usize = 30;

/// V_slow + V_fast = V_H and tau_ss(V_slow) = tau_ss(V_fast)  (20), the second as logarithms of the activation, divided by
/// ln V_fast - ln V_slow.
#[derive(Debug)]
struct Steady<'a, L> {
    law: &'a L,
    driving: f64,
}

impl<L: Law> Steady<'_, L> {
    fn at<T: Real>(&self, [slow, fast]: [T; 2]) -> [T; 2] {
        let logarithms = Difference::new(fast, slow, fast - slow);
        let rates = logarithms.exp();
        let balance = (rates.first + rates.second) / self.driving - 1.0;
        [
            balance,
            steady_log_activation(self.law, rates).gap / logarithms.gap,
        ]
    }
}

impl<L: Law> Residual<2> for Steady<'_, L> {
    fn residual(&self, u: &State<2>) -> State<2> {
        State::<2>::from(self.at([u[0], u[1]]))
    }

    fn jacobian(&self, u: &State<2>) -> Jacobian<2> {
        let [balance, stress] = self
            .at(Jet::<f64, 2>::variables([u[0], u[1]]))
            .map(|r| r.gradient);
        Jacobian::<2>::new(balance[0], balance[1], stress[0], stress[1])
    }
}

/// V_slow in each bracket, by one solver in turn.
pub(super) fn solve(law: &impl Law, driving: f64, brackets: &[Bracket]) -> Result<Vec<f64>> {
    let problem = Steady { law, driving };
    let Some(_) = brackets.first() else {
        return Ok(Vec::new());
    };
    let mut kinsol = Kinsol::new()?;
    brackets
        .iter()
        .map(|&bracket| in_bracket(&mut kinsol, &problem, driving, bracket))
        .collect()
}

fn in_bracket(
    kinsol: &mut Kinsol<2>,
    problem: &dyn Residual<2>,
    driving: f64,
    bracket: Bracket,
) -> Result<f64> {
    let width = log_ratio(bracket.low, bracket.high);
    let mut last = None;
    for fraction in STARTS {
        let slow = (bracket.low.ln() + fraction * width).exp();
        let guess = State::<2>::new(slow.ln(), (driving - slow).ln());
        match from(kinsol, problem, &guess) {
            Ok(found) if (bracket.low..=bracket.high).contains(&found) => return Ok(found),
            // another steady state: it has a bracket of its own
            Ok(_) => {}
            Err(error) => last = Some(error),
        }
    }
    Err(last.unwrap_or(Error::NotConverged {
        what: "KINSOL in the bracket of the asymmetric steady state",
        iterations: STARTS.len(),
        residual: width,
        tolerance: 0.0,
    }))
}

/// A line search to come near, then full Newton steps until they no longer shrink: close to a fold a small residual alone
/// says little. The caller bounds the error of what comes out.
fn from(kinsol: &mut Kinsol<2>, problem: &dyn Residual<2>, guess: &State<2>) -> Result<f64> {
    let ones = State::<2>::repeat(1.0);
    kinsol.settings = KinsolSettings {
        strategy: Strategy::LineSearch,
        residual_tolerance: NEAR,
        ..KinsolSettings::default()
    };
    let mut root = kinsol.solve(problem, guess, &ones, &ones)?;
    kinsol.settings = KinsolSettings {
        strategy: Strategy::Newton,
        residual_tolerance: f64::MIN_POSITIVE,
        step_tolerance: f64::MIN_POSITIVE,
        max_iterations: 2,
        ..KinsolSettings::default()
    };
    let mut last_change = f64::INFINITY;
    for _ in 0..ROUNDS {
        let (next, _) = kinsol.iterate(problem, &root, &ones, &ones)?;
        let change = (next - root).amax();
        root = next;
        if change > 0.5 * last_change || change <= f64::EPSILON * root.amax() {
            break;
        }
        last_change = change;
    }
    Ok(root[0].exp())
}
