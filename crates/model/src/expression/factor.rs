//! Quotients that are worked out term by term where a factor cancels.
//!
//! The logarithm of a state changes at the rate of the state over the state itself. In (1 - psi)/R - v psi, divided by psi, the last
//! term is v: it loses no digit, and takes no product.

use super::{Builder, Function, Operation, Place};
use crate::error::Result;
use std::collections::HashMap;

impl Builder {
    /// What stands at `a` over the number e^w, for w at `exponent`: sums term by term where a term has that factor, all else as a
    /// product with e^(-w).
    ///
    /// # Errors
    /// As of [`Builder::variable`].
    pub fn over_exponential(&mut self, a: Place, exponent: Place) -> Result<Place> {
        let divisor = self.call(Function::Exp, &[exponent])?;
        let negative = self.negative(exponent)?;
        let mut division = Division {
            inverse: self.call(Function::Exp, &[negative])?,
            one: self.number(1.0)?,
            divides: self.multiples(divisor),
            divisor,
            made: HashMap::new(),
        };
        division.of(self, a)
    }

    /// For every operation whether it is a product with this one, or a sum with such a term.
    fn multiples(&self, factor: Place) -> Vec<bool> {
        let mut multiples = vec![false; self.operations.len()];
        for (place, operation) in self.operations.iter().enumerate() {
            multiples[place] = place == factor
                || match *operation {
                    Operation::Sum(a, b)
                    | Operation::Difference(a, b)
                    | Operation::Product(a, b) => multiples[a] || multiples[b],
                    Operation::Negative(a) | Operation::Quotient(a, _) => multiples[a],
                    _ => false,
                };
        }
        multiples
    }
}

/// A division on its way.
struct Division {
    divisor: Place,
    inverse: Place,
    one: Place,
    divides: Vec<bool>,
    /// What was divided already: operations may be shared.
    made: HashMap<Place, Place>,
}

impl Division {
    fn of(&mut self, builder: &mut Builder, a: Place) -> Result<Place> {
        if let Some(&made) = self.made.get(&a) {
            return Ok(made);
        }
        use super::Binary as B;
        let made = if a == self.divisor {
            self.one
        } else if !self.divides[a] {
            match builder.known(a) {
                Some(1.0) => self.inverse,
                _ => builder.binary(B::Product, a, self.inverse)?,
            }
        } else {
            match builder.operations[a] {
                Operation::Sum(x, y) => {
                    let (x, y) = (self.of(builder, x)?, self.of(builder, y)?);
                    builder.binary(B::Sum, x, y)?
                }
                Operation::Difference(x, y) => {
                    let (x, y) = (self.of(builder, x)?, self.of(builder, y)?);
                    builder.binary(B::Difference, x, y)?
                }
                Operation::Product(x, y) => {
                    let (x, y) = if self.divides[x] { (x, y) } else { (y, x) };
                    match self.of(builder, x)? {
                        one if one == self.one => y,
                        x => builder.binary(B::Product, x, y)?,
                    }
                }
                Operation::Quotient(x, y) => {
                    let x = self.of(builder, x)?;
                    builder.binary(B::Quotient, x, y)?
                }
                Operation::Negative(x) => {
                    let x = self.of(builder, x)?;
                    builder.negative(x)?
                }
                _ => unreachable!("no multiple"),
            }
        };
        self.made.insert(a, made);
        Ok(made)
    }
}
