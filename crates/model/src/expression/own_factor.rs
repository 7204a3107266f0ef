//! Variables that are factors of their own rates.
//!
//! In x' = x g(x, y) the plane x = 0 is invariant: no solution crosses it, and one that comes near it goes away as it came, by factors. So
//! populations and concentrations are followed relative to their size, however small they are.

use super::{Expressions, Function, Operation};

impl Expressions {
    /// For every variable, whether the formula at its place has it as a factor, and is 0 where the variable is.
    ///
    /// # Panics
    /// Where there are fewer formulas or parameters than they name.
    pub fn own_factors(&self, variables: usize, parameters: &[f64]) -> Vec<bool> {
        (0..variables)
            .map(|i| self.has_own_factor(i, variables, parameters))
            .collect()
    }

    fn has_own_factor(&self, i: usize, variables: usize, parameters: &[f64]) -> bool {
        if !self.multiples_of(i, parameters)[self.outputs[i]] {
            return false;
        }
        // A cofactor that is infinite there takes the factor away, as in x/sqrt(x): seen at some values of the others.
        let some = |j: usize| if j == i { 0.0 } else { 0.7 + 0.3 * j as f64 };
        let there: Vec<f64> = (0..variables).map(some).collect();
        self.evaluate(&there, parameters)[i] == 0.0
    }

    /// For every operation whether it goes to 0 with the variable, at least in proportion to it where its cofactors are finite.
    fn multiples_of(&self, variable: usize, parameters: &[f64]) -> Vec<bool> {
        use Operation::*;
        let mut multiples: Vec<bool> = Vec::with_capacity(self.operations.len());
        for operation in &self.operations {
            let of = |place: usize| multiples[place];
            let multiple = match *operation {
                Variable(i) => i == variable,
                Sum(a, b) | Difference(a, b) | Lesser(a, b) | Greater(a, b) => of(a) && of(b),
                Product(a, b) => of(a) || of(b),
                Negative(a) | Quotient(a, _) | Signed(a, _) => of(a),
                Whole(a, n) => n > 0 && of(a),
                Power(a, b) => {
                    let exponent = match self.operations[b] {
                        Number(bits) => f64::from_bits(bits),
                        Parameter(q) => parameters[q],
                        _ => 0.0,
                    };
                    exponent >= 1.0 && of(a)
                }
                Call(function, a) => is_odd_or_zero(function) && of(a),
                Parameter(_) | Number(_) | Pi | Ratio(..) | Balanced(..) => false,
            };
            multiples.push(multiple);
        }
        multiples
    }
}

/// Whether a function of 0 is 0, with a finite slope.
fn is_odd_or_zero(function: Function) -> bool {
    use Function::*;
    matches!(
        function,
        Sin | Tan | Sinh | Tanh | Asinh | Atan | Expm1 | Log1p | Abs
    )
}
