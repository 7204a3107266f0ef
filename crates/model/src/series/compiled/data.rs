//! The numbers that a kernel is given: those of the orders, of the parameters, and of the first coefficients of a step.

use super::shape::{Kind, Shape, Step};
use crate::number::Balance;
use crate::series::element::Element;
use crate::series::placed::{PlacedInstruction, PlacedLater};
use crate::series::program::{Operation, Source};
use crate::series::program_rows::ProgramRows;

/// Where the numbers stand of a recurrence, from its first one on.
#[derive(Debug, Clone, Copy)]
pub enum OfRecurrence {
    /// What the newest coefficients of two rows count.
    FirstCount,
    SecondCount,
    Inverse,
    /// Of the first operand.
    Factor,
    /// The exponent of a power, or a coefficient of a balance that is a number.
    Constant,
    OtherConstant,
}

/// How many these are; behind them stand the coefficients of a ratio.
const OF_RECURRENCE: usize = 6;

/// Where the numbers stand of a shape.
#[derive(Debug, Clone)]
pub struct Layout {
    room: usize,
    /// Of every step the first one.
    steps: Vec<usize>,
    length: usize,
}

impl Layout {
    pub fn of(shape: &Shape) -> Self {
        let mut length = 3 * shape.room;
        let place = |step: &Step| {
            let begin = length;
            length += match step {
                Step::Sum { terms, .. } => terms.len(),
                Step::Recurrence(one) if matches!(one.kind, Kind::Ratio(_)) => {
                    OF_RECURRENCE + shape.room
                }
                Step::Recurrence(_) => OF_RECURRENCE,
            };
            begin
        };
        let steps = shape.steps.iter().map(place).collect();
        Layout {
            room: shape.room,
            steps,
            length,
        }
    }

    /// 1/k
    pub fn one_over(&self, k: usize) -> usize {
        k
    }

    /// k
    pub fn order(&self, k: usize) -> usize {
        self.room + k
    }

    /// What the k-th coefficient of a rate counts in the next one of its variable.
    pub fn share(&self, k: usize) -> usize {
        2 * self.room + k
    }

    /// The factor of a term in a step that is a sum.
    pub fn factor_of_term(&self, step: usize, term: usize) -> usize {
        self.steps[step] + term
    }

    pub fn of_recurrence(&self, step: usize, what: OfRecurrence) -> usize {
        self.steps[step] + what as usize
    }

    /// The m-th coefficient of a ratio at the first one of its argument.
    pub fn of_ratio(&self, step: usize, m: usize) -> usize {
        self.steps[step] + OF_RECURRENCE + m
    }
}

/// The numbers.
#[derive(Debug, Clone)]
pub struct Data<T> {
    layout: Layout,
    numbers: Vec<T>,
    /// The unit of time that the shares are for.
    unit: T,
}

impl<T: Element> Data<T> {
    /// With those that hold for all steps of these rows.
    pub fn new(layout: Layout, rows: &ProgramRows<T>, any: T) -> Self {
        let mut numbers = vec![any.like(0.0); layout.length];
        for k in 1..layout.room {
            numbers[layout.one_over(k)] = any.like_exact(rows.one_over(k));
            numbers[layout.order(k)] = any.like(k as f64);
        }
        let mut data = Data {
            layout,
            numbers,
            unit: any.like(f64::NAN),
        };
        data.set(rows, 0..rows.later().len());
        data
    }

    /// Takes over the constants of these operations of later orders.
    pub fn set(&mut self, rows: &ProgramRows<T>, steps: impl IntoIterator<Item = usize>) {
        for step in steps {
            match &rows.later()[step] {
                PlacedLater::Sum(sum) => {
                    for (j, term) in sum.terms.iter().enumerate() {
                        let at = self.layout.factor_of_term(step, j);
                        self.numbers[at] = term.factor;
                    }
                }
                PlacedLater::Other(one) => self.constants(step, one, self.unit),
            }
        }
    }

    fn constants(&mut self, step: usize, one: &PlacedInstruction<T>, any: T) {
        let layout = &self.layout;
        let place = |what| layout.of_recurrence(step, what);
        let first = place(OfRecurrence::Constant);
        let second = place(OfRecurrence::OtherConstant);
        self.numbers[place(OfRecurrence::Factor)] = any.like_exact(one.operand.factor);
        let number = |source| match source {
            Source::Number(x) => any.like_exact(x),
            Source::Row(_) => any.like(0.0),
        };
        match one.operation {
            Operation::Power(_, p) => self.numbers[first] = any.like_exact(p),
            Operation::Balanced(_, Balance::Exponential(a) | Balance::Sinh(a)) => {
                self.numbers[first] = number(a);
            }
            Operation::Balanced(_, Balance::Difference(a, b)) => {
                self.numbers[first] = number(a);
                self.numbers[second] = number(b);
            }
            _ => {}
        }
    }

    /// Takes over those of a step, whose first coefficients are prepared. Returns whether the kernel holds for it: it multiplies no product
    /// with 1.
    #[inline(always)]
    pub fn gather(&mut self, rows: &ProgramRows<T>, unit: T) -> bool {
        if !is_same(unit, self.unit) {
            self.unit = unit;
            for k in 1..self.layout.room - 1 {
                self.numbers[self.layout.share(k)] = rows.share(k, unit);
            }
        }
        let mut holds = true;
        let (later, steps) = (rows.later(), &self.layout.steps);
        for &i in rows.prepared() {
            let at = steps[i];
            match &later[i] {
                PlacedLater::Sum(sum) => {
                    for (j, term) in sum.terms.iter().enumerate() {
                        if term.sign.is_some() {
                            self.numbers[at + j] = term.factor;
                        }
                    }
                }
                PlacedLater::Other(one) => {
                    let [first, second] = one.counts;
                    self.numbers[at + OfRecurrence::FirstCount as usize] = first;
                    self.numbers[at + OfRecurrence::SecondCount as usize] = second;
                    self.numbers[at + OfRecurrence::Inverse as usize] = one.inverse;
                    if let Some(composition) = &one.composition {
                        let numbers = &mut self.numbers[at + OF_RECURRENCE..];
                        let coefficients = composition.coefficients();
                        numbers[..coefficients.len()].copy_from_slice(coefficients);
                    }
                    if matches!(one.operation, Operation::Product(..)) {
                        let factor = self.numbers[at + OfRecurrence::Factor as usize];
                        holds &= is_same(one.inverse, factor);
                    }
                }
            }
        }
        holds
    }

    pub fn numbers(&self) -> &[T] {
        &self.numbers
    }
}

/// Whether all lanes are the same.
#[inline(always)]
fn is_same<T: Element>(a: T, b: T) -> bool {
    (0..T::LANES).all(|lane| a.lane(lane).to_bits() == b.lane(lane).to_bits())
}
