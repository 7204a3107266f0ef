//! Running error analysis: first-order bounds on the rounding errors of a recorded formula's values.
//!
//! Higham, N. J. (2002). Accuracy and Stability of Numerical Algorithms, 2nd edition, section 3.3. SIAM.

use super::program::{Operation, Program, Source};

/// Returns a bound on the rounding error of each row's value in double precision, whose variables are rounded too: they are sums. Rows that are not finite have the bound 0.
pub(super) fn rounding(program: &Program, value: impl Fn(usize) -> f64) -> Vec<f64> {
    const UNIT: f64 = f64::EPSILON;
    let mut off = vec![0.0; program.rows()];
    for (row, off) in off[..program.variables()].iter_mut().enumerate() {
        *off = UNIT * value(row).abs();
    }
    for one in program.instructions() {
        let (result, size) = (one.result, |row: usize| value(row).abs());
        let constant = |x| program.constants.value(x).hi().abs();
        let of = |source: Source<_>| match source {
            Source::Row(row) => off[row],
            Source::Number(_) => 0.0,
        };
        let (made, beside) = match one.operation {
            Operation::Lane(a, _) | Operation::Negative(a) | Operation::Signed(a, _) => {
                (off[a], 0.0)
            }
            Operation::Sum(a, b) | Operation::Difference(a, b) => (off[a] + off[b], 0.0),
            Operation::Shifted(a, _) | Operation::Complement(_, a) => (off[a], 0.0),
            Operation::Scaled(a, x) => (off[a] * constant(x), 0.0),
            Operation::Over(a, x) => (off[a] / constant(x), 0.0),
            Operation::Product(a, b) => (size(a) * off[b] + size(b) * off[a], 0.0),
            Operation::Quotient(a, b) => ((of(a) + size(result) * off[b]) / size(b), 0.0),
            Operation::Exponential(a) => (size(result) * off[a], 0.0),
            Operation::Exponentials(a, falling) => (size(result) * off[a], size(falling) * off[a]),
            Operation::ExponentialLessOne(a, _) => ((1.0 + size(result)) * off[a], 0.0),
            Operation::Logarithm(a) => (off[a] / size(a), 0.0),
            Operation::LogarithmOfOneMore(a, _) => (off[a] / (1.0 + value(a)).abs(), 0.0),
            Operation::Hyperbolic(a, other) | Operation::Circular(a, other) => {
                (size(other) * off[a], size(result) * off[a])
            }
            Operation::Arctangent(a, u) | Operation::InverseHyperbolicSine(a, u) => {
                (off[a] / size(u), 0.0)
            }
            Operation::HyperbolicTangent(a, u) => {
                (size(u) * off[a], size(u) * (2.0 * off[a] + 4.0 * UNIT))
            }
            Operation::Power(a, p) => (constant(p) * size(result) / size(a) * off[a], 0.0),
            // The ratio's slope is at most this large.
            Operation::Ratio(a, _) => ((1.0 + size(result)) * off[a], 0.0),
            Operation::Sign(_) => (0.0, 0.0),
            // y and g(y) grow with x, no faster.
            Operation::Balanced(x, _) => (of(x) + size(result) * UNIT, of(x)),
        };
        let known = |off: f64, row: usize| {
            let off = off + UNIT * value(row).abs();
            if off.is_finite() { off } else { 0.0 }
        };
        let beside = one.second_result().map(|row| (row, known(beside, row)));
        off[result] = known(made, result);
        if let Some((row, beside)) = beside {
            off[row] = beside;
        }
    }
    off
}
