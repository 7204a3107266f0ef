//! The operations of a program at all orders but the first, where constants that are added have no part.
//!
//! What is linear there is one sum of multiples of rows, however many operations it is written in.

use super::program::{Instruction, Operation, Program, Source};
use crate::number::DoubleDouble;

/// Sums of more terms than this are made in parts.
const MOST_TERMS: usize = 8;

/// A multiple of a row.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Term {
    pub row: usize,
    /// The lane that counts, in all lanes; `None` where each counts in its own.
    pub lane: Option<usize>,
    pub factor: DoubleDouble,
    /// The row whose sign at the first order is a factor too.
    pub sign: Option<usize>,
}

/// What is carried out.
#[derive(Debug, Clone, Copy)]
pub(super) enum Later {
    /// A sum of terms, from one of these to before another, into a row.
    Sum {
        from: usize,
        to: usize,
        result: usize,
    },
    /// An operation, whose first operand is a multiple of the row that stands in its place.
    Other(Instruction, Multiple),
}

/// A row that is a multiple of another, but for its first coefficient.
#[derive(Debug, Clone, Copy)]
pub(super) struct Multiple {
    pub row: usize,
    pub factor: DoubleDouble,
}

/// All of that, in order.
#[derive(Debug, Clone, Default)]
pub(super) struct LaterOrders {
    pub terms: Vec<Term>,
    pub all: Vec<Later>,
}

impl LaterOrders {
    /// Those of a program.
    pub fn of(program: &Program) -> Self {
        let mut uses = vec![0_usize; program.rows()];
        for instruction in program.instructions() {
            let operands = instruction.operation.operands();
            operands
                .into_iter()
                .flatten()
                .for_each(|row| uses[row] += 1);
        }
        let mut sums: Vec<Option<Vec<Term>>> = vec![None; program.rows()];
        for instruction in program.instructions() {
            let Some(plain) = terms(instruction.operation) else {
                continue;
            };
            let mut all: Vec<Term> = Vec::new();
            for term in plain {
                match &sums[term.row] {
                    // What is used once, or is but a multiple, has no row of its own.
                    Some(within) if within.len() == 1 || uses[term.row] == 1 => {
                        match within.iter().map(|inner| joined(term, *inner)).collect() {
                            Some::<Vec<Term>>(within) => {
                                within.into_iter().for_each(|x| add(&mut all, x))
                            }
                            None => add(&mut all, term),
                        }
                    }
                    _ => add(&mut all, term),
                }
            }
            if all.len() > MOST_TERMS {
                all = terms(instruction.operation).unwrap_or_default();
            }
            sums[instruction.result] = Some(all);
        }
        Self::needed(program, &sums)
    }

    /// Those whose results anything needs.
    fn needed(program: &Program, sums: &[Option<Vec<Term>>]) -> Self {
        let mut needed = vec![false; program.rows()];
        for output in &program.outputs {
            if let Source::Row(row) = output {
                needed[*row] = true;
            }
        }
        let mut kept = Vec::new();
        for instruction in program.instructions().iter().rev() {
            let second = instruction.second_result().is_some_and(|row| needed[row]);
            if !(needed[instruction.result] || second) {
                continue;
            }
            match &sums[instruction.result] {
                Some(terms) => terms.iter().for_each(|term| needed[term.row] = true),
                None => {
                    let (plain, _) = with_multiple(*instruction, sums);
                    let operands = plain.operation.operands();
                    operands
                        .into_iter()
                        .flatten()
                        .for_each(|row| needed[row] = true);
                }
            }
            kept.push(*instruction);
        }
        let mut later = LaterOrders::default();
        for instruction in kept.into_iter().rev() {
            match &sums[instruction.result] {
                Some(terms) => {
                    let from = later.terms.len();
                    later.terms.extend(terms);
                    later.all.push(Later::Sum {
                        from,
                        to: later.terms.len(),
                        result: instruction.result,
                    });
                }
                None => {
                    let (plain, multiple) = with_multiple(instruction, sums);
                    later.all.push(Later::Other(plain, multiple));
                }
            }
        }
        later
    }
}

/// The operation with the row of which its first operand is a multiple in the place of that.
fn with_multiple(one: Instruction, sums: &[Option<Vec<Term>>]) -> (Instruction, Multiple) {
    let multiple = |row, factor| Multiple { row, factor };
    let Some(operand) = one.operation.of_multiple() else {
        return (one, multiple(one.result, DoubleDouble::ONE));
    };
    let (row, factor) = match sums[operand].as_deref() {
        Some([term]) if term.lane.is_none() && term.sign.is_none() => (term.row, term.factor),
        _ => (operand, DoubleDouble::ONE),
    };
    let to = |at| if at == operand { row } else { at };
    let operation = one.operation.moved(to);
    (Instruction { operation, ..one }, multiple(operand, factor))
}

/// The terms of what is linear.
fn terms(operation: Operation) -> Option<Vec<Term>> {
    let one = DoubleDouble::from(1.0);
    let term = |row, factor| Term {
        row,
        lane: None,
        factor,
        sign: None,
    };
    Some(match operation {
        Operation::Sum(a, b) => vec![term(a, one), term(b, one)],
        Operation::Difference(a, b) => vec![term(a, one), term(b, -one)],
        Operation::Negative(a) | Operation::Complement(_, a) => vec![term(a, -one)],
        Operation::Shifted(a, _) => vec![term(a, one)],
        Operation::Scaled(a, x) => vec![term(a, x)],
        Operation::Lane(a, lane) => vec![Term {
            lane: Some(lane),
            ..term(a, one)
        }],
        Operation::Signed(a, b) => vec![Term {
            sign: Some(b),
            ..term(a, one)
        }],
        _ => return None,
    })
}

/// A multiple of a multiple; `None` where that takes two signs, or the sign of another lane, or a factor that is no double: rounded it would
/// be another one at all orders of all steps.
fn joined(outer: Term, inner: Term) -> Option<Term> {
    let sign = match (outer.sign, inner.sign) {
        (Some(_), Some(_)) => return None,
        (_, Some(_)) if outer.lane.is_some() => return None,
        (outer, inner) => outer.or(inner),
    };
    let factor = outer.factor * inner.factor;
    (factor.lo() == 0.0).then_some(Term {
        row: inner.row,
        lane: inner.lane.or(outer.lane),
        factor,
        sign,
    })
}

/// A term more, as part of one that there is of the same.
fn add(all: &mut Vec<Term>, term: Term) {
    let alike =
        |known: &&mut Term| (known.row, known.lane, known.sign) == (term.row, term.lane, term.sign);
    match all.iter_mut().find(alike) {
        Some(known) if (known.factor + term.factor).lo() == 0.0 => {
            known.factor = known.factor + term.factor;
        }
        _ => all.push(term),
    }
}
