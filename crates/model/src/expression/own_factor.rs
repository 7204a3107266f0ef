//! Variables that are factors of their own rates.
//!
//! In x' = x g(x, y) the plane x = 0 is invariant: no solution crosses it, and one that comes near it goes away as it came, by factors. So
//! populations and concentrations are followed relative to their size, however small they are.

use super::{Binary, Builder, Expressions, Function, Operation, Place};
use crate::error::Result;
use crate::number::Numerator;

impl Expressions {
    /// For every variable, whether the formula at its place has it as a factor, and is 0 where the variable is.
    ///
    /// # Panics
    /// Where there are fewer formulas or parameters than they name, or more than 128 variables.
    pub fn own_factors(&self, variables: usize, parameters: &[f64]) -> Vec<bool> {
        assert!(variables <= u128::BITS as usize, "one bit for each");
        let multiples = self.multiples(parameters);
        let all = (0..variables).map(|i| {
            multiples[self.outputs[i]] & (1 << i) != 0 && self.ends_at(i, variables, parameters)
        });
        all.collect()
    }

    /// Whether a rate is 0 where its variable is.
    fn ends_at(&self, i: usize, variables: usize, parameters: &[f64]) -> bool {
        // A cofactor that is infinite there takes the factor away, as in x/sqrt(x): seen at some values of the others.
        let some = |j: usize| if j == i { 0.0 } else { 0.7 + 0.3 * j as f64 };
        let there: Vec<f64> = (0..variables).map(some).collect();
        self.evaluate(&there, parameters)[i] == 0.0
    }

    /// For every operation the variables, by bits, with which it goes to 0, at least in proportion to them where its cofactors are finite.
    fn multiples(&self, parameters: &[f64]) -> Vec<u128> {
        use Operation::*;
        let mut multiples: Vec<u128> = Vec::with_capacity(self.operations.len());
        for operation in &self.operations {
            let of = |place: usize| multiples[place];
            let multiple = match *operation {
                Variable(i) => 1 << i,
                Sum(a, b) | Difference(a, b) | Lesser(a, b) | Greater(a, b) => of(a) & of(b),
                Product(a, b) => of(a) | of(b),
                Negative(a) | Quotient(a, _) | Signed(a, _) => of(a),
                Whole(a, n) if n > 0 => of(a),
                Power(a, b) => {
                    let exponent = match self.operations[b] {
                        Number(bits) => f64::from_bits(bits),
                        Parameter(q) => parameters[q],
                        _ => 0.0,
                    };
                    if exponent >= 1.0 { of(a) } else { 0 }
                }
                Call(function, a) if is_odd_or_zero(function) => of(a),
                Whole(..) | Call(..) | Parameter(_) | Number(_) | Pi | Ratio(..) | Balanced(..) => {
                    0
                }
            };
            multiples.push(multiple);
        }
        multiples
    }

    /// The same rates in the logarithms of variables that are factors of their own rates: with x = s exp(X) of the sign s, dX/dt is the rate
    /// over x. Variables whose sign is 0 stay as they are. `None` where a rate is not known over its variable.
    ///
    /// # Errors
    /// As of [`Builder::variable`].
    pub fn in_logarithms(&self, signs: &[f64], parameters: usize) -> Result<Option<Self>> {
        let mut builder = Builder::default();
        let mut variables = Vec::with_capacity(signs.len());
        for (i, &sign) in signs.iter().enumerate() {
            let variable = builder.variable(i)?;
            variables.push(match sign {
                0.0 => variable,
                _ => {
                    let size = builder.call(Function::Exp, &[variable])?;
                    builder.times(size, sign)?
                }
            });
        }
        let parameters: Result<Vec<_>> = (0..parameters).map(|q| builder.parameter(q)).collect();
        let all = Expressions {
            outputs: (0..self.operations.len()).collect(),
            operations: self.operations.clone(),
        };
        let places = builder.insert(&all, &variables, &parameters?)?;
        let mut rates = Vec::with_capacity(signs.len());
        for (i, &output) in self.outputs.iter().enumerate() {
            rates.push(match signs[i] {
                0.0 => places[output],
                sign => {
                    let cofactors = self.cofactors((i, sign), &places, &mut builder)?;
                    let Some(cofactor) = cofactors[output] else {
                        return Ok(None);
                    };
                    cofactor
                }
            });
        }
        Ok(Some(builder.complete(rates)))
    }

    /// Every operation over the variable of this sign, where it is a multiple of it and that can be written: at its place in the formulas
    /// that are built, where the operations themselves stand at `places`.
    fn cofactors(
        &self,
        (variable, sign): (usize, f64),
        places: &[Place],
        builder: &mut Builder,
    ) -> Result<Vec<Option<Place>>> {
        use Operation::*;
        let mut over: Vec<Option<Place>> = Vec::with_capacity(self.operations.len());
        for operation in &self.operations {
            let both = |a: Place, b: Place| over[a].zip(over[b]);
            let cofactor = match *operation {
                Variable(i) if i == variable => Some(builder.number(1.0)?),
                Sum(a, b) | Difference(a, b) | Lesser(a, b) | Greater(a, b) => {
                    let binary = match (operation, sign > 0.0) {
                        (Sum(..), _) => Binary::Sum,
                        (Difference(..), _) => Binary::Difference,
                        (Lesser(..), true) | (Greater(..), false) => Binary::Lesser,
                        _ => Binary::Greater,
                    };
                    match both(a, b) {
                        Some((a, b)) => Some(builder.binary(binary, a, b)?),
                        None => None,
                    }
                }
                Product(a, b) => match (over[a], over[b]) {
                    (Some(a), _) => Some(builder.binary(Binary::Product, a, places[b])?),
                    (_, Some(b)) => Some(builder.binary(Binary::Product, places[a], b)?),
                    _ => None,
                },
                Quotient(a, b) => match over[a] {
                    Some(a) => Some(builder.binary(Binary::Quotient, a, places[b])?),
                    None => None,
                },
                Negative(a) => match over[a] {
                    Some(a) => Some(builder.negative(a)?),
                    None => None,
                },
                Signed(a, b) => match over[a] {
                    Some(a) => Some(builder.place(Signed(a, places[b]))?),
                    None => None,
                },
                Whole(a, n) if n > 0 => match over[a] {
                    Some(over) => {
                        let rest = builder.number(f64::from(n - 1))?;
                        let rest = builder.binary(Binary::Power, places[a], rest)?;
                        Some(builder.binary(Binary::Product, over, rest)?)
                    }
                    None => None,
                },
                Power(a, b) => match over[a] {
                    Some(over) => {
                        let one = builder.number(1.0)?;
                        let less = builder.binary(Binary::Difference, places[b], one)?;
                        let rest = builder.binary(Binary::Power, places[a], less)?;
                        Some(builder.binary(Binary::Product, over, rest)?)
                    }
                    None => None,
                },
                Call(function, a) => match (over[a], numerator(function)) {
                    (Some(over), Some(numerator)) => {
                        let ratio = builder.place(Ratio(numerator, places[a]))?;
                        Some(builder.binary(Binary::Product, over, ratio)?)
                    }
                    (Some(over), None) if function == Function::Abs => {
                        let size = builder.call(Function::Abs, &[over])?;
                        Some(builder.times(size, sign)?)
                    }
                    _ => None,
                },
                _ => None,
            };
            over.push(cofactor);
        }
        Ok(over)
    }
}

/// The function over its argument, where that is an operation of its own.
fn numerator(function: Function) -> Option<Numerator> {
    match function {
        Function::Expm1 => Some(Numerator::ExpM1),
        Function::Sin => Some(Numerator::Sin),
        Function::Sinh => Some(Numerator::Sinh),
        Function::Tanh => Some(Numerator::Tanh),
        Function::Log1p => Some(Numerator::Ln1p),
        _ => None,
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
