//! Formulas that are known when the program runs: a list of operations, to be carried out in numbers of any kind.
//!
//! What occurs twice is there once. Nothing in it can do more than arithmetic.

mod damped;
mod factor;
mod function;
mod own_factor;
mod ratios;
mod signed_powers;
mod sparsity;
mod units;

pub use function::Function;
pub use sparsity::ColumnGroups;

use crate::error::{Error, Result};
use crate::number::{Balance, Numerator, Real};
use std::collections::HashMap;

/// Formulas have no more operations, all together.
const LARGEST: usize = 10_000;
/// Whole exponents up to this are carried out as products.
const LARGEST_POWER: f64 = 1024.0;

/// An operation by its place in the list: every operand stands before what is made of it.
pub type Place = usize;

/// An operation, of which operands.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash)]
enum Operation {
    /// The i-th variable.
    Variable(usize),
    /// The i-th parameter.
    Parameter(usize),
    /// A number, by its bits.
    Number(u64),
    Pi,
    Sum(Place, Place),
    Difference(Place, Place),
    Product(Place, Place),
    Quotient(Place, Place),
    Negative(Place),
    /// To a whole power.
    Whole(Place, i32),
    /// To any power, of what is positive.
    Power(Place, Place),
    Call(Function, Place),
    /// N(x)/x.
    Ratio(Numerator, Place),
    /// The first one with the sign of the second.
    Signed(Place, Place),
    Lesser(Place, Place),
    Greater(Place, Place),
    /// g(y) of the y with y + g(y) = the first operand, g being the second one times this function.
    Balanced(Place, Place, Activation),
}

/// A function of the stress by which a slip rate rises.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash)]
enum Activation {
    Sinh,
    Exponential,
}

impl Operation {
    /// The same of operands that stand elsewhere.
    fn moved(self, mut at: impl FnMut(Place) -> Place) -> Self {
        use Operation::*;
        let mut sorted = |a, b| {
            let (a, b) = (at(a), at(b));
            (a.min(b), a.max(b))
        };
        match self {
            Variable(_) | Parameter(_) | Number(_) | Pi => self,
            Sum(a, b) => {
                let (a, b) = sorted(a, b);
                Sum(a, b)
            }
            Product(a, b) => {
                let (a, b) = sorted(a, b);
                Product(a, b)
            }
            Difference(a, b) => Difference(at(a), at(b)),
            Quotient(a, b) => Quotient(at(a), at(b)),
            Negative(a) => Negative(at(a)),
            Whole(a, n) => Whole(at(a), n),
            Power(a, b) => Power(at(a), at(b)),
            Call(function, a) => Call(function, at(a)),
            Ratio(numerator, a) => Ratio(numerator, at(a)),
            Signed(a, b) => Signed(at(a), at(b)),
            Lesser(a, b) => Lesser(at(a), at(b)),
            Greater(a, b) => Greater(at(a), at(b)),
            Balanced(a, b, activation) => Balanced(at(a), at(b), activation),
        }
    }
}

/// Two operands and what is made of them.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash)]
pub enum Binary {
    /// a + b
    Sum,
    /// a - b
    Difference,
    /// a b
    Product,
    /// a / b
    Quotient,
    /// a^b: for whole numbers b, written as such, of any a; else of positive ones.
    Power,
    /// the lesser one
    Lesser,
    /// the greater one
    Greater,
}

/// Formulas in some variables and parameters, complete.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Expressions {
    operations: Vec<Operation>,
    outputs: Vec<Place>,
}

impl Expressions {
    /// Whether there are powers that are not whole, or roots: their slopes may be infinite at a zero of the base.
    pub fn take_powers(&self) -> bool {
        self.operations.iter().any(|operation| {
            matches!(
                operation,
                Operation::Power(..) | Operation::Call(Function::Sqrt, _)
            )
        })
    }

    /// The values of all formulas.
    ///
    /// # Panics
    /// Where there are fewer variables or parameters than they name.
    pub fn evaluate<T: Real>(&self, variables: &[T], parameters: &[T]) -> Vec<T> {
        let count = self.operations.len();
        let mut values: Vec<T> = Vec::with_capacity(count + self.outputs.len());
        for operation in &self.operations {
            let at = |place: Place| values[place];
            let value = match *operation {
                Operation::Variable(i) => variables[i],
                Operation::Parameter(i) => parameters[i],
                Operation::Number(bits) => T::constant(f64::from_bits(bits)),
                // To all digits of T.
                Operation::Pi => T::constant(1.0).atan() * 4.0,
                Operation::Sum(a, b) => at(a) + at(b),
                Operation::Difference(a, b) => at(a) - at(b),
                Operation::Product(a, b) => at(a) * at(b),
                Operation::Quotient(a, b) => at(a) / at(b),
                Operation::Negative(a) => -at(a),
                Operation::Whole(a, n) => whole_power(at(a), n),
                Operation::Power(a, b) => match self.operations[b] {
                    Operation::Number(bits) => at(a).powf(f64::from_bits(bits)),
                    _ => at(a).pow(at(b)),
                },
                Operation::Call(function, a) => function.of(at(a)),
                Operation::Ratio(numerator, a) => at(a).ratio(numerator.into()),
                Operation::Signed(a, b) => at(a) * at(b).sign(),
                Operation::Lesser(a, b) => at(a).lesser(at(b)),
                Operation::Greater(a, b) => at(a).greater(at(b)),
                Operation::Balanced(a, b, Activation::Sinh) => {
                    at(a).balanced(Balance::Sinh(at(b))).1
                }
                Operation::Balanced(a, b, Activation::Exponential) => {
                    at(a).balanced(Balance::Exponential(at(b))).1
                }
            };
            values.push(value);
        }
        for &place in &self.outputs {
            values.push(values[place]);
        }
        values.drain(..count);
        values
    }

    /// Whether the i-th variable is named.
    pub fn names_variable(&self, i: usize) -> bool {
        self.operations.contains(&Operation::Variable(i))
    }

    /// How many formulas there are.
    pub fn count(&self) -> usize {
        self.outputs.len()
    }

    /// The same without the operations that no formula needs.
    fn pruned(self) -> Self {
        let mut needed = vec![false; self.operations.len()];
        self.outputs.iter().for_each(|&place| needed[place] = true);
        for (place, operation) in self.operations.iter().enumerate().rev() {
            if needed[place] {
                let _ = operation.moved(|operand| {
                    needed[operand] = true;
                    operand
                });
            }
        }
        let mut places = vec![0; self.operations.len()];
        let mut operations = Vec::new();
        for (place, operation) in self.operations.iter().enumerate() {
            if needed[place] {
                places[place] = operations.len();
                operations.push(operation.moved(|operand| places[operand]));
            }
        }
        Expressions {
            operations,
            outputs: self.outputs.iter().map(|&place| places[place]).collect(),
        }
    }
}

/// x^n by squares.
fn whole_power<T: Real>(x: T, n: i32) -> T {
    let (mut rest, mut square) = (n.unsigned_abs(), x);
    let mut power: Option<T> = None;
    while rest > 0 {
        if rest & 1 == 1 {
            power = Some(power.map_or(square, |power| power * square));
        }
        rest >>= 1;
        if rest > 0 {
            square = square * square;
        }
    }
    let power = power.unwrap_or(T::constant(1.0));
    if n < 0 {
        T::constant(1.0) / power
    } else {
        power
    }
}

/// Formulas on their way: operations are asked for one after the other.
#[derive(Debug, Default)]
pub struct Builder {
    operations: Vec<Operation>,
    /// Whether a variable is part of each.
    varies: Vec<bool>,
    places: HashMap<Operation, Place>,
}

impl Builder {
    /// The i-th variable.
    ///
    /// # Errors
    /// As all that follow: [`Error::Input`] where there are too many operations.
    pub fn variable(&mut self, i: usize) -> Result<Place> {
        self.place(Operation::Variable(i))
    }

    /// The i-th parameter.
    ///
    /// # Errors
    /// As of [`Builder::variable`].
    pub fn parameter(&mut self, i: usize) -> Result<Place> {
        self.place(Operation::Parameter(i))
    }

    /// A number.
    ///
    /// # Errors
    /// As of [`Builder::variable`].
    pub fn number(&mut self, x: f64) -> Result<Place> {
        self.place(Operation::Number(x.to_bits()))
    }

    /// The circumference of a circle over its diameter.
    ///
    /// # Errors
    /// As of [`Builder::variable`].
    pub fn pi(&mut self) -> Result<Place> {
        self.place(Operation::Pi)
    }

    /// -a
    ///
    /// # Errors
    /// As of [`Builder::variable`].
    pub fn negative(&mut self, a: Place) -> Result<Place> {
        match self.known(a) {
            Some(x) => self.number(-x),
            None => self.place(Operation::Negative(a)),
        }
    }

    /// What is made of two. Quotients such as u/(exp(u) - 1), which are analytic where both parts are 0, are made so that they
    /// have a value there.
    ///
    /// # Errors
    /// As of [`Builder::variable`], and for a whole exponent that is too large.
    pub fn binary(&mut self, binary: Binary, a: Place, b: Place) -> Result<Place> {
        if matches!(binary, Binary::Product | Binary::Quotient)
            && let Some(place) = self.with_ratio(a, b, binary)?
        {
            return Ok(place);
        }
        if binary == Binary::Product
            && let Some(place) = self.with_signed_power(a, b)?
        {
            return Ok(place);
        }
        if binary == Binary::Quotient
            && let Some(place) = self.with_sign(a, b)?
        {
            return Ok(place);
        }
        let sorted = (a.min(b), a.max(b));
        self.place(match binary {
            Binary::Sum => Operation::Sum(sorted.0, sorted.1),
            Binary::Difference => Operation::Difference(a, b),
            Binary::Product => Operation::Product(sorted.0, sorted.1),
            Binary::Quotient => Operation::Quotient(a, b),
            Binary::Lesser => Operation::Lesser(a, b),
            Binary::Greater => Operation::Greater(a, b),
            Binary::Power => match self.known(b) {
                Some(n) if n.fract() == 0.0 && n.abs() <= LARGEST_POWER => {
                    Operation::Whole(a, n as i32)
                }
                Some(n) if n.fract() == 0.0 => {
                    return Err(Error::parameter(
                        "a whole exponent",
                        n,
                        format!("between {} and {LARGEST_POWER}", -LARGEST_POWER),
                    ));
                }
                _ => Operation::Power(a, b),
            },
        })
    }

    /// A function of one argument, or of two.
    ///
    /// # Errors
    /// As of [`Builder::binary`].
    ///
    /// # Panics
    /// Where the function takes another number of arguments.
    pub fn call(&mut self, function: Function, arguments: &[Place]) -> Result<Place> {
        match (function, arguments) {
            (Function::Min, &[a, b]) => self.binary(Binary::Lesser, a, b),
            (Function::Max, &[a, b]) => self.binary(Binary::Greater, a, b),
            (Function::Pow, &[a, b]) => self.binary(Binary::Power, a, b),
            (Function::Exprel, &[a]) => self.place(Operation::Ratio(Numerator::ExpM1, a)),
            (function, &[a]) => self.place(Operation::Call(function, a)),
            _ => panic!("{function:?} of {} arguments", arguments.len()),
        }
    }

    /// The formulas of others, with what stands at these places for their variables and parameters.
    ///
    /// # Errors
    /// As of [`Builder::variable`].
    ///
    /// # Panics
    /// Where there are fewer variables or parameters than they name.
    pub fn insert(
        &mut self,
        of: &Expressions,
        variables: &[Place],
        parameters: &[Place],
    ) -> Result<Vec<Place>> {
        let mut places: Vec<Place> = Vec::with_capacity(of.operations.len());
        for operation in &of.operations {
            let place = match *operation {
                Operation::Variable(i) => variables[i],
                Operation::Parameter(i) => parameters[i],
                operation => self.place(operation.moved(|place| places[place]))?,
            };
            places.push(place);
        }
        Ok(of.outputs.iter().map(|&place| places[place]).collect())
    }

    /// The formulas whose values stand at these places.
    pub fn complete(self, outputs: Vec<Place>) -> Expressions {
        let all = Expressions {
            operations: self.operations,
            outputs,
        };
        all.pruned()
    }

    /// Two lists of formulas whose values stand at these places.
    pub fn complete_both(
        self,
        outputs: Vec<Place>,
        others: Vec<Place>,
    ) -> (Expressions, Expressions) {
        let first = Expressions {
            operations: self.operations,
            outputs,
        };
        let second = Expressions {
            outputs: others,
            ..first.clone()
        };
        (first.pruned(), second.pruned())
    }

    /// The number at a place, where it is one.
    fn known(&self, place: Place) -> Option<f64> {
        match self.operations[place] {
            Operation::Number(bits) => Some(f64::from_bits(bits)),
            _ => None,
        }
    }

    fn place(&mut self, operation: Operation) -> Result<Place> {
        if let Some(&place) = self.places.get(&operation) {
            return Ok(place);
        }
        if self.operations.len() == LARGEST {
            return Err(Error::Input(format!(
                "the formulas have more than {LARGEST} operations, which is the most allowed"
            )));
        }
        let mut varies = matches!(operation, Operation::Variable(_));
        let _ = operation.moved(|operand| {
            varies |= self.varies[operand];
            operand
        });
        self.places.insert(operation, self.operations.len());
        self.operations.push(operation);
        self.varies.push(varies);
        Ok(self.operations.len() - 1)
    }
}
