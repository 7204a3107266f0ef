//! The operations of a [`super::program::Program`] with rows where they begin among the coefficients of all: so that no place is
//! computed at every order.

use super::element::Element;
use super::later::{Later, Term};
use super::program::{Instruction, Operation};
use crate::number::DoubleDouble;

/// An operation whose rows are where they begin among the coefficients.
#[derive(Debug, Clone, Copy)]
pub(super) struct PlacedInstruction {
    pub operation: Operation,
    pub result: usize,
    pub spare: usize,
    pub older: OlderSums,
}

/// The sums of products of older coefficients that an operation needs: of a_j b_(k-j) over 0 < j < k.
#[derive(Debug, Clone, Copy)]
pub(super) enum OlderSums {
    Nothing,
    One(usize, usize),
    /// With the same a.
    Two(usize, [usize; 2]),
}

/// What is carried out at later orders.
#[derive(Debug, Clone, Copy)]
pub(super) enum PlacedLater {
    /// Of these terms.
    Sum {
        from: usize,
        to: usize,
        result: usize,
    },
    Other(PlacedInstruction),
}

impl PlacedInstruction {
    /// With rows where they are placed.
    pub fn new(one: &Instruction, place: impl Fn(usize) -> usize) -> Self {
        let operation = one.operation.moved(&place);
        let (result, spare) = (place(one.result), place(one.spare));
        use OlderSums::{Nothing, One, Two};
        let older = match operation {
            Operation::Product(a, b) => One(a, b),
            Operation::Quotient(_, b) => One(result, b),
            Operation::Exponential(_) => One(spare, result),
            Operation::Logarithm(u)
            | Operation::Arctangent(_, u)
            | Operation::InverseHyperbolicSine(_, u)
            | Operation::HyperbolicTangent(_, u) => One(spare, u),
            Operation::Hyperbolic(_, cosh) => Two(spare, [cosh, result]),
            Operation::Circular(_, cos) => Two(spare, [cos, result]),
            Operation::Power(a, _) => Two(a, [result, spare]),
            Operation::Balanced(..) => {
                let [e, f] = BALANCED.map(|before| result - place(before));
                Two(spare, [e, f])
            }
            _ => Nothing,
        };
        PlacedInstruction {
            operation,
            result,
            spare,
            older,
        }
    }
}

/// How many rows before that of a balance both exponentials stand.
const BALANCED: [usize; 2] = [6, 5];

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

impl PlacedLater {
    /// With rows where they are placed.
    pub fn new(later: &Later, place: impl Fn(usize) -> usize) -> Self {
        match later {
            Later::Sum { from, to, result } => PlacedLater::Sum {
                from: *from,
                to: *to,
                result: place(*result),
            },
            Later::Other(one) => PlacedLater::Other(PlacedInstruction::new(one, place)),
        }
    }
}

impl<T: Element> PlacedTerm<T> {
    /// With rows where they are placed; `any` is any number.
    pub fn new(term: &Term, place: impl Fn(usize) -> usize, any: T) -> Self {
        PlacedTerm {
            row: place(term.row),
            lane: term.lane,
            exact: term.factor,
            factor: any.like_exact(term.factor),
            sign: term.sign.map(place),
        }
    }
}
