//! What of a formula its machine code depends on: the recurrences and the rows they are of, and no constants.

use crate::number::{Balance, DoubleDouble};
use crate::series::element::Element;
use crate::series::placed::{PlacedInstruction, PlacedLater, PlacedSum, PlacedTerm, Products};
use crate::series::program::{Operation, Source};
use crate::series::program_rows::Rate;
use twinslip_kernel::Width;

/// The recurrences of all orders but the first.
#[derive(Debug, Clone, PartialEq, Eq, Hash)]
pub struct Shape {
    /// Of the numbers that they are carried out in.
    pub width: Width,
    /// Coefficients that a row has room for. Rows are where they begin.
    pub room: usize,
    pub steps: Vec<Step>,
    /// Variables whose rates are no sums, and the rows of these rates.
    pub rates_apart: Vec<(usize, Option<usize>)>,
}

/// What is carried out at every order.
#[derive(Debug, Clone, PartialEq, Eq, Hash)]
pub enum Step {
    Sum {
        terms: Vec<SumTerm>,
        result: usize,
        rate_of: Option<usize>,
    },
    Recurrence(Recurrence),
}

/// A term of a sum.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash)]
pub struct SumTerm {
    pub row: usize,
    pub lane: Option<usize>,
    pub factor: Factor,
}

/// A factor: those that need no multiplication are told apart.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash)]
pub enum Factor {
    One,
    MinusOne,
    Other,
}

/// A recurrence, and its rows.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash)]
pub struct Recurrence {
    pub kind: Kind,
    pub result: usize,
    pub spare: usize,
    /// What its first operand is of the row in its place.
    pub factor: Factor,
    pub products: Products,
}

/// The kinds of recurrences, as the operations of [`Operation`] that they belong to.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash)]
pub enum Kind {
    Product(usize, usize),
    Quotient(Option<usize>, usize),
    Exponential(usize),
    Exponentials(usize, usize),
    /// The coefficients of another row.
    Copy(usize),
    Logarithm(usize),
    /// y' = a'/u, of the arctangent and the inverse hyperbolic sine
    Integral(usize, usize),
    Hyperbolic(usize, usize),
    Circular(usize, usize),
    HyperbolicTangent(usize, usize),
    Power(usize),
    Ratio(usize),
    Nothing,
    Balanced(Option<usize>, Function),
}

/// The function of a balance, and the rows of its coefficients, where these are no numbers.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash)]
pub enum Function {
    Exponential(Option<usize>),
    Sinh(Option<usize>),
    Difference(Option<usize>, Option<usize>),
}

impl Shape {
    /// Of these recurrences; `None` where numbers T are not compiled.
    pub fn of<T: Element>(later: &[PlacedLater<T>], rates: &[Rate], room: usize) -> Option<Self> {
        let rates_apart = rates.iter().map(|rate| {
            let row = row(rate.of);
            (rate.variable * room, row.map(|row| row * room))
        });
        Some(Shape {
            width: T::WIDTH?,
            room,
            steps: later.iter().map(Step::of).collect(),
            rates_apart: rates_apart.collect(),
        })
    }
}

impl Shape {
    /// Whether it is that of these recurrences too, which differ from its own at most in the constants of these places.
    pub fn holds_for<T: Element>(&self, later: &[PlacedLater<T>], places: &[usize]) -> bool {
        let mut all = places.iter().map(|&at| (&self.steps[at], &later[at]));
        all.all(|both| match both {
            (Step::Sum { terms, .. }, PlacedLater::Sum(sum)) => {
                let mut both = terms.iter().zip(&sum.terms);
                both.all(|(known, term)| *known == SumTerm::of(term))
            }
            (Step::Recurrence(known), PlacedLater::Other(one)) => *known == Recurrence::of(one),
            _ => false,
        })
    }
}

impl Step {
    fn of<T: Element>(later: &PlacedLater<T>) -> Self {
        match later {
            PlacedLater::Sum(PlacedSum {
                terms,
                result,
                rate_of,
            }) => Step::Sum {
                terms: terms.iter().map(SumTerm::of).collect(),
                result: *result,
                rate_of: *rate_of,
            },
            PlacedLater::Other(one) => Step::Recurrence(Recurrence::of(one)),
        }
    }
}

impl SumTerm {
    fn of<T: Element>(term: &PlacedTerm<T>) -> Self {
        let factor = match term.sign {
            Some(_) => Factor::Other,
            None => Factor::of(term.exact),
        };
        SumTerm {
            row: term.row,
            lane: term.lane,
            factor,
        }
    }
}

impl Factor {
    fn of(x: DoubleDouble) -> Self {
        if x == DoubleDouble::ONE {
            Factor::One
        } else if x == -DoubleDouble::ONE {
            Factor::MinusOne
        } else {
            Factor::Other
        }
    }
}

/// The row of a quantity.
fn row(source: Source) -> Option<usize> {
    match source {
        Source::Row(row) => Some(row),
        Source::Number(_) => None,
    }
}

impl Recurrence {
    fn of<T: Element>(one: &PlacedInstruction<T>) -> Self {
        let kind = match one.operation {
            Operation::Product(a, b) => Kind::Product(a, b),
            Operation::Quotient(a, b) => Kind::Quotient(row(a), b),
            Operation::Exponential(a) => Kind::Exponential(a),
            Operation::Exponentials(a, falling) => Kind::Exponentials(a, falling),
            Operation::ExponentialLessOne(_, whole) | Operation::LogarithmOfOneMore(_, whole) => {
                Kind::Copy(whole)
            }
            Operation::Logarithm(u) => Kind::Logarithm(u),
            Operation::Arctangent(a, u) | Operation::InverseHyperbolicSine(a, u) => {
                Kind::Integral(a, u)
            }
            Operation::Hyperbolic(a, cosh) => Kind::Hyperbolic(a, cosh),
            Operation::Circular(a, cos) => Kind::Circular(a, cos),
            Operation::HyperbolicTangent(a, u) => Kind::HyperbolicTangent(a, u),
            Operation::Power(a, _) => Kind::Power(a),
            Operation::Ratio(a, _) => Kind::Ratio(a),
            Operation::Sign(_) => Kind::Nothing,
            Operation::Balanced(x, g) => {
                let g = match g {
                    Balance::Exponential(a) => Function::Exponential(row(a)),
                    Balance::Sinh(a) => Function::Sinh(row(a)),
                    Balance::Difference(a, b) => Function::Difference(row(a), row(b)),
                };
                Kind::Balanced(row(x), g)
            }
            Operation::Lane(..)
            | Operation::Sum(..)
            | Operation::Difference(..)
            | Operation::Negative(_)
            | Operation::Shifted(..)
            | Operation::Complement(..)
            | Operation::Scaled(..)
            | Operation::Over(..)
            | Operation::Signed(..) => unreachable!("a sum of terms"),
        };
        Recurrence {
            kind,
            result: one.result,
            spare: one.spare,
            factor: Factor::of(one.operand.factor),
            products: one.products,
        }
    }
}
