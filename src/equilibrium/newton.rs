//! The asymmetric steady state in a bracket: Newton's method for the slower rate.

use super::isolate::{Bracket, quotient};
use crate::error::Result;
use crate::friction::Law;
use crate::number::{Jet, bracketed_root};

/// V_slow in each bracket.
pub(super) fn solve(law: &impl Law, driving: f64, brackets: &[Bracket]) -> Result<Vec<f64>> {
    brackets
        .iter()
        .map(|&bracket| in_bracket(law, driving, bracket))
        .collect()
}

fn in_bracket(law: &impl Law, driving: f64, bracket: Bracket) -> Result<f64> {
    // At V_H/2 itself the quotient is 0/0; its limit has the sign that the bracket was found by.
    let high = bracket.high.min(0.5 * driving * (1.0 - f64::EPSILON));
    let slow = bracketed_root("the asymmetric steady state", bracket.low, high, |s| {
        let q = quotient(law, driving, Jet::<f64, 1>::variable(s, 0));
        (q.value, q.gradient[0])
    })?;
    Ok(slow)
}
