//! The operations of a [`super::program::Program`] with rows where they begin among the coefficients of all: so that no place is
//! computed at every order.

use super::composition::Composition;
use super::constants::{Constant, Constants};
use super::element::Element;
use super::later::{Later, Multiple, Term};
use super::products::{SharedSums, Sums};
use super::program::{Instruction, Operation, Program};
use crate::number::DoubleDouble;
use std::ops::Range;

/// An operation whose rows are where they begin among the coefficients, at all orders but the first.
#[derive(Debug, Clone)]
pub(super) struct PlacedInstruction<T: Element> {
    pub operation: Operation,
    pub result: usize,
    pub spare: usize,
    /// Its first operand, which is a multiple of the row in its place.
    pub operand: Multiple,
    /// What holds for all orders of a step: what the newest coefficients of two rows count, and what the result is to be multiplied with.
    pub counts: [T; 2],
    pub inverse: T,
    /// The rows of whose older coefficients it needs sums of products, and these sums.
    pub products: Products,
    pub sums: [Sums<T>; 2],
    /// Instead of these where both share a row and the element has them side by side.
    pub shared: Option<SharedSums<T>>,
    /// Of a power: whether it is held, as its base is next to 0.
    pub held: bool,
    /// Of a ratio.
    pub composition: Option<Box<Composition<T>>>,
}

/// Rows of which products are needed.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash)]
pub(super) enum Products {
    Nothing,
    One([usize; 2]),
    Two([[usize; 2]; 2]),
    /// Of the first of these with both of the others.
    Shared(usize, [usize; 2]),
}

impl Products {
    fn of(operation: Operation, result: usize, spare: usize, room: usize) -> Self {
        use Products::{Nothing, One, Shared, Two};
        match operation {
            Operation::Product(a, b) => One([a, b]),
            Operation::Quotient(_, b) => One([result, b]),
            Operation::Exponential(_) => One([spare, result]),
            Operation::Exponentials(_, falling) => Shared(spare, [result, falling]),
            Operation::Logarithm(u)
            | Operation::Arctangent(_, u)
            | Operation::InverseHyperbolicSine(_, u) => One([spare, u]),
            Operation::HyperbolicTangent(_, u) => Two([[spare, u], [result, result]]),
            Operation::Hyperbolic(_, other) | Operation::Circular(_, other) => {
                Shared(spare, [other, result])
            }
            Operation::Power(a, _) => Shared(a, [result, spare]),
            Operation::Balanced(..) => Shared(spare, BALANCED.map(|before| result - before * room)),
            _ => Nothing,
        }
    }
}

/// How many rows before that of a balance both exponentials stand.
const BALANCED: [usize; 2] = [6, 5];

/// What is carried out at later orders.
#[derive(Debug, Clone)]
pub(super) enum PlacedLater<T: Element> {
    Sum(PlacedSum<T>),
    Other(PlacedInstruction<T>),
}

/// A sum of terms, into a row.
#[derive(Debug, Clone)]
pub(super) struct PlacedSum<T> {
    pub terms: Vec<PlacedTerm<T>>,
    pub result: usize,
    /// The variable whose rate it is, whose next coefficient is made with it.
    pub rate_of: Option<usize>,
}

/// A term of later orders, whose row is where it begins among the coefficients.
#[derive(Debug, Clone, Copy)]
pub(super) struct PlacedTerm<T> {
    pub row: usize,
    pub lane: Option<usize>,
    pub exact: DoubleDouble,
    /// The same with its sign as it is here.
    pub factor: T,
    pub sign: Option<usize>,
}

/// With rows of so many coefficients one after the other, and with the constants as they are.
pub(super) fn placed(
    one: &Instruction<Constant>,
    room: usize,
    constants: &Constants,
) -> Instruction {
    let place = |row: usize| row * room;
    Instruction {
        operation: one.operation.map(place, |x| constants.value(x)),
        result: place(one.result),
        spare: place(one.spare),
    }
}

impl<T: Element> PlacedLater<T> {
    /// The same of one of those of a program; `any` is any number.
    pub fn new(later: &Later, program: &Program, room: usize, any: T) -> Self {
        match later {
            Later::Sum { from, to, result } => PlacedLater::Sum(PlacedSum {
                terms: terms(program, *from..*to, room, any).collect(),
                result: result * room,
                rate_of: None,
            }),
            Later::Other(one, operand) => {
                let Instruction {
                    operation,
                    result,
                    spare,
                } = placed(one, room, &program.constants);
                let products = Products::of(operation, result, spare, room);
                let shares = T::SHARES && matches!(products, Products::Shared(..));
                PlacedLater::Other(PlacedInstruction {
                    operation,
                    result,
                    spare,
                    operand: Multiple {
                        row: operand.row * room,
                        factor: program.constants.value(operand.factor),
                    },
                    counts: [any; 2],
                    inverse: any,
                    held: false,
                    products,
                    sums: [Sums::new(any), Sums::new(any)],
                    shared: shares.then(|| SharedSums::new(any, room)),
                    composition: matches!(operation, Operation::Ratio(..))
                        .then(|| Box::new(Composition::new(any, room))),
                })
            }
        }
    }
}

impl<T: Element> PlacedLater<T> {
    /// Takes over the constants of the program, of which this is one. Returns whether it has as many terms with them.
    pub fn set(&mut self, later: &Later, program: &Program, room: usize, any: T) -> bool {
        match (self, later) {
            (PlacedLater::Sum(sum), Later::Sum { from, to, .. }) => {
                let mut known = sum.terms.iter_mut();
                let all = terms(program, *from..*to, room, any).all(|term| match known.next() {
                    Some(known) if known.is_of(&term) => {
                        *known = term;
                        true
                    }
                    _ => false,
                });
                all && known.next().is_none()
            }
            (PlacedLater::Other(known), Later::Other(one, operand)) => {
                known.operation = placed(one, room, &program.constants).operation;
                known.operand.factor = program.constants.value(operand.factor);
                true
            }
            _ => unreachable!("of the same program"),
        }
    }
}

/// Those of a sum that stand there among the terms of a program.
fn terms<T: Element>(
    program: &Program,
    within: Range<usize>,
    room: usize,
    any: T,
) -> impl Iterator<Item = PlacedTerm<T>> {
    let terms = program.later.terms[within].iter();
    terms.flat_map(move |term| {
        let factor = program.constants.value(term.factor);
        PlacedTerm::new(term, factor, room, any)
    })
}

impl<T: Element> PlacedTerm<T> {
    /// Whether it is a multiple of the same.
    fn is_of(&self, other: &Self) -> bool {
        (self.row, self.lane, self.sign) == (other.row, other.lane, other.sign)
    }

    /// The term, and one more with what the element's digits leave of its factor: rounded it would be another one at all orders of all
    /// steps.
    fn new(term: &Term, factor: DoubleDouble, room: usize, any: T) -> impl Iterator<Item = Self> {
        let of = |exact: DoubleDouble| PlacedTerm {
            row: term.row * room,
            lane: term.lane,
            exact,
            factor: any.like_exact(exact),
            sign: term.sign.map(|row| row * room),
        };
        let first = of(factor);
        let rest = factor - first.factor.to_exact();
        // What counts least comes first in the sum.
        let rest = (rest.hi() != 0.0).then(|| of(rest));
        rest.into_iter().chain([first])
    }
}
