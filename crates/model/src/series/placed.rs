//! The operations of a [`super::program::Program`] with rows where they begin among the coefficients of all: so that no place is
//! computed at every order.

use super::composition::Composition;
use super::element::Element;
use super::later::{Later, LaterOrders, Multiple, Term};
use super::products::{SharedSums, Sums};
use super::program::{Instruction, Operation};
use crate::number::DoubleDouble;

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

/// With rows of so many coefficients one after the other.
pub(super) fn placed(one: &Instruction, room: usize) -> Instruction {
    let place = |row: usize| row * room;
    Instruction {
        operation: one.operation.moved(place),
        result: place(one.result),
        spare: place(one.spare),
    }
}

impl<T: Element> PlacedLater<T> {
    /// The same of one of these; `any` is any number.
    pub fn new(later: &Later, all: &LaterOrders, room: usize, any: T) -> Self {
        match later {
            Later::Sum { from, to, result } => {
                let terms = all.terms[*from..*to].iter();
                let terms = terms.flat_map(|term| PlacedTerm::new(term, room, any));
                PlacedLater::Sum(PlacedSum {
                    terms: terms.collect(),
                    result: result * room,
                    rate_of: None,
                })
            }
            Later::Other(one, operand) => {
                let Instruction {
                    operation,
                    result,
                    spare,
                } = placed(one, room);
                let products = Products::of(operation, result, spare, room);
                let shares = T::SHARES && matches!(products, Products::Shared(..));
                PlacedLater::Other(PlacedInstruction {
                    operation,
                    result,
                    spare,
                    operand: Multiple {
                        row: operand.row * room,
                        ..*operand
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

impl<T: Element> PlacedTerm<T> {
    /// The term, and one more with what the element's digits leave of its factor: rounded it would be another one at all orders of all
    /// steps.
    fn new(term: &Term, room: usize, any: T) -> impl Iterator<Item = Self> {
        let of = |exact: DoubleDouble| PlacedTerm {
            row: term.row * room,
            lane: term.lane,
            exact,
            factor: any.like_exact(exact),
            sign: term.sign.map(|row| row * room),
        };
        let first = of(term.factor);
        let rest = term.factor - first.factor.to_exact();
        // What counts least comes first in the sum.
        let rest = (rest.hi() != 0.0).then(|| of(rest));
        rest.into_iter().chain([first])
    }
}
