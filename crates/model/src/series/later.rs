//! The operations of a program at all orders but the first, where constants that are added have no part.
//!
//! What is linear there is one sum of multiples of rows, however many operations it is written in.

use super::constants::{Constant, Constants};
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
    pub factor: Constant,
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
    Other(Instruction<Constant>, Multiple<Constant>),
}

/// A row that is a multiple of another, but for its first coefficient.
#[derive(Debug, Clone, Copy)]
pub(super) struct Multiple<C = DoubleDouble> {
    pub row: usize,
    pub factor: C,
}

/// All of that, in order.
#[derive(Debug, Clone, Default)]
pub(super) struct LaterOrders {
    pub terms: Vec<Term>,
    pub all: Vec<Later>,
}

impl LaterOrders {
    /// Those of a program.
    pub fn of(program: &Program, constants: &mut Constants) -> Self {
        let mut uses = vec![0_usize; program.rows()];
        let all = program.instructions().iter();
        let operands = all.flat_map(|one| one.operation.operands());
        operands.flatten().for_each(|row| uses[row] += 1);
        let mut sums: Vec<Option<Vec<Term>>> = vec![None; program.rows()];
        for instruction in program.instructions() {
            let Some(plain) = terms(instruction.operation, constants) else {
                continue;
            };
            let mut all: Vec<Term> = Vec::new();
            for term in plain {
                match &sums[term.row] {
                    // What is used once, or is but a multiple, has no row of its own.
                    Some(within) if within.len() == 1 || uses[term.row] == 1 => {
                        let joined = |inner: &Term| joined(term, *inner, constants);
                        match within.iter().map(joined).collect() {
                            Some::<Vec<Term>>(within) => {
                                within.into_iter().for_each(|x| add(&mut all, x, constants))
                            }
                            None => add(&mut all, term, constants),
                        }
                    }
                    _ => add(&mut all, term, constants),
                }
            }
            if all.len() > MOST_TERMS {
                all = terms(instruction.operation, constants).unwrap_or_default();
            }
            sums[instruction.result] = Some(all);
        }
        Self::needed(program, &sums, constants)
    }

    /// Those whose results anything needs.
    fn needed(program: &Program, sums: &[Option<Vec<Term>>], constants: &mut Constants) -> Self {
        let mut needed = vec![false; program.rows()];
        for output in &program.outputs {
            if let Source::Row(row) = output {
                needed[*row] = true;
            }
        }
        // The ends of steps are judged by these.
        for row in [&program.kinks, &program.branch_points, &program.bases] {
            row.iter().for_each(|&row| needed[row] = true);
        }
        let one = constants.one();
        let multiples = multiples(program, sums, constants);
        let mut kept = Vec::new();
        for instruction in program.instructions().iter().rev() {
            let second = instruction.second_result().is_some_and(|row| needed[row]);
            if !(needed[instruction.result] || second) {
                continue;
            }
            match &sums[instruction.result] {
                Some(terms) => terms.iter().for_each(|term| needed[term.row] = true),
                None => {
                    let (plain, _) = with_multiple(*instruction, &multiples, one);
                    let operands = plain.operation.operands().into_iter();
                    operands.flatten().for_each(|row| needed[row] = true);
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
                    let (plain, multiple) = with_multiple(instruction, &multiples, one);
                    later.all.push(Later::Other(plain, multiple));
                }
            }
        }
        later.join_exponentials(constants);
        later
    }

    /// Makes e^a and e^-a in one operation: they take the same slopes of a.
    fn join_exponentials(&mut self, constants: &mut Constants) {
        let mut at = 0;
        while at < self.all.len() {
            let (known, rest) = self.all.split_at_mut(at + 1);
            if let Later::Other(one, Multiple { factor, .. }) = &mut known[at]
                && let Operation::Exponential(a) = one.operation
                && let Some((place, falling)) = inverse_exponential(rest, (a, *factor), constants)
            {
                one.operation = Operation::Exponentials(a, falling);
                self.all.remove(at + 1 + place);
            }
            at += 1;
        }
    }
}

/// Where among these the exponential of minus this multiple of a row is made, and its row.
fn inverse_exponential(
    all: &[Later],
    (of, factor): (usize, Constant),
    constants: &mut Constants,
) -> Option<(usize, usize)> {
    let mut negative = None;
    let result = |one: &Later| match one {
        Later::Other(one, multiple) if one.operation == Operation::Exponential(of) => {
            let negative = *negative.get_or_insert_with(|| constants.negative(factor));
            constants
                .are_same(multiple.factor, negative)
                .then_some(one.result)
        }
        _ => None,
    };
    all.iter()
        .map(result)
        .enumerate()
        .find_map(|(place, result)| Some((place, result?)))
}

/// What every row is a multiple of, itself if of no other. Where the factor is no double, it must be that of the first order: rounded it
/// would be another one at all other orders of all steps.
fn multiples(
    program: &Program,
    sums: &[Option<Vec<Term>>],
    constants: &mut Constants,
) -> Vec<Multiple<Constant>> {
    let factor = constants.one();
    let itself = (0..program.rows()).map(|row| Multiple { row, factor });
    let mut all: Vec<_> = itself.collect();
    for one in program.instructions() {
        let Some(&[term]) = sums[one.result].as_deref() else {
            continue;
        };
        let Term { row, factor, .. } = term;
        if term.lane.is_none()
            && term.sign.is_none()
            && (one.operation == Operation::Scaled(row, factor) || constants.is_double(factor))
        {
            all[one.result] = Multiple { row, factor };
        }
    }
    all
}

/// The operation with the row of which its first operand is a multiple in the place of that. The factor of what is no multiple is 1.
fn with_multiple(
    one: Instruction<Constant>,
    multiples: &[Multiple<Constant>],
    factor: Constant,
) -> (Instruction<Constant>, Multiple<Constant>) {
    let operation = match one.operation {
        // Either may come first.
        Operation::Product(a, b) if multiples[a].row == a => Operation::Product(b, a),
        operation => operation,
    };
    let (operand, of) = match (operation, operation.of_multiple()) {
        (Operation::Product(a, b), _) if a == b => (a, Multiple { row: a, factor }),
        (_, Some(operand)) => (operand, multiples[operand]),
        (_, None) => (
            one.result,
            Multiple {
                row: one.result,
                factor,
            },
        ),
    };
    let to = |at| if at == operand { of.row } else { at };
    let operation = operation.moved(to);
    let operand = Multiple {
        row: operand,
        factor: of.factor,
    };
    (Instruction { operation, ..one }, operand)
}

/// The terms of what is linear.
fn terms(operation: Operation<Constant>, constants: &mut Constants) -> Option<Vec<Term>> {
    let (one, minus_one) = (constants.one(), constants.minus_one());
    let term = |row, factor| Term {
        row,
        lane: None,
        factor,
        sign: None,
    };
    Some(match operation {
        Operation::Sum(a, b) => vec![term(a, one), term(b, one)],
        Operation::Difference(a, b) => vec![term(a, one), term(b, minus_one)],
        Operation::Negative(a) | Operation::Complement(_, a) => vec![term(a, minus_one)],
        Operation::Shifted(a, _) => vec![term(a, one)],
        Operation::Scaled(a, x) => vec![term(a, x)],
        Operation::Over(a, x) => vec![term(a, constants.quotient(one, x))],
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

/// A multiple of a multiple; `None` where that takes two signs, or the sign of another lane.
fn joined(outer: Term, inner: Term, constants: &mut Constants) -> Option<Term> {
    let sign = match (outer.sign, inner.sign) {
        (Some(_), Some(_)) => return None,
        (_, Some(_)) if outer.lane.is_some() => return None,
        (outer, inner) => outer.or(inner),
    };
    Some(Term {
        row: inner.row,
        lane: inner.lane.or(outer.lane),
        factor: constants.product(outer.factor, inner.factor),
        sign,
    })
}

/// A term more, as part of one that there is of the same.
fn add(all: &mut Vec<Term>, term: Term, constants: &mut Constants) {
    let alike =
        |known: &&mut Term| (known.row, known.lane, known.sign) == (term.row, term.lane, term.sign);
    match all.iter_mut().find(alike) {
        Some(known) => known.factor = constants.sum(known.factor, term.factor),
        None => all.push(term),
    }
}
