//! The rows of a [`Program`], and how its operations fill them: the recurrences of [`super::tape`], in loops.

use super::element::Element;
use super::placed::{PlacedLater, PlacedTerm, placed};
use super::products::ORDERS;
use super::program::{Instruction, Program, Source};
use crate::number::DoubleDouble;

/// The rows of a program: the coefficients of each, one after the other.
#[derive(Debug, Clone)]
pub(super) struct ProgramRows<T> {
    coefficients: Vec<T>,
    /// Coefficients that a row has room for.
    room: usize,
    /// 1/k for every order k.
    inverses: Vec<DoubleDouble>,
    /// The operations of the first order and of all later ones; rows are where they begin among the coefficients.
    first: Vec<Instruction>,
    later: Vec<PlacedLater<T>>,
    /// The rates of the variables.
    rates: Vec<Source>,
    any: T,
}

impl<T: Element> ProgramRows<T> {
    /// With room for these; `any` is any number.
    pub fn new(program: &Program, room: usize, any: T) -> Self {
        let first = program.instructions().iter();
        let later = program.later.all.iter();
        let rates = program.outputs[..program.variables()].iter();
        let rates = rates.map(|rate| match *rate {
            Source::Row(row) => Source::Row(row * room),
            number => number,
        });
        ProgramRows {
            coefficients: vec![any.like(0.0); program.rows() * room],
            room,
            inverses: (0..room)
                .map(|k| DoubleDouble::from(1.0) / k as f64)
                .collect(),
            first: first.map(|one| placed(one, room)).collect(),
            later: later
                .map(|one| PlacedLater::new(one, &program.later, room, any))
                .collect(),
            rates: rates.collect(),
            any,
        }
    }

    /// The coefficients of a row.
    #[inline(always)]
    pub fn row(&self, row: usize) -> &[T] {
        &self.coefficients[row * self.room..][..self.room]
    }

    /// The k-th coefficient of a quantity.
    #[inline(always)]
    pub fn coefficient(&self, of: Source, k: usize) -> T {
        match of {
            Source::Row(row) => self.coefficients[row * self.room + k],
            Source::Number(x) if k == 0 => self.any.like_exact(x),
            Source::Number(_) => self.any.like(0.0),
        }
    }

    /// What is to be made at an order, and the operations of the first one and of the others.
    #[inline(always)]
    fn order(&mut self, k: usize) -> (Level<'_, T>, &[Instruction], &mut [PlacedLater<T>]) {
        let level = Level {
            coefficients: &mut self.coefficients,
            room: self.room,
            k,
            one_over: self.inverses[k],
            order: DoubleDouble::from(k as f64),
            any: self.any,
        };
        (level, &self.first, &mut self.later)
    }

    /// The first coefficients at this state.
    #[inline(always)]
    pub fn begin(&mut self, x: &[T]) {
        let rows = self.coefficients.chunks_exact_mut(self.room);
        for (row, x) in rows.zip(x) {
            row[0] = *x;
        }
        let (mut level, first, _) = self.order(0);
        // A loop, as all here: a closure would not be compiled for the processor.
        for one in first {
            level.begin(one);
        }
    }

    /// The first coefficients of other rows of the same program.
    #[inline(always)]
    pub fn begin_as(&mut self, other: &Self) {
        let others = other.coefficients.chunks_exact(other.room);
        let rows = self.coefficients.chunks_exact_mut(self.room);
        for (row, other) in rows.zip(others) {
            row[0] = other[0];
        }
    }

    /// What the first coefficients are to all later orders.
    #[inline(always)]
    pub fn prepare(&mut self) {
        let (level, _, later) = self.order(0);
        for one in later {
            match one {
                PlacedLater::Sum { terms, .. } => level.set_signs(terms),
                PlacedLater::Other(one) => level.prepare(one),
            }
        }
    }

    /// The k-th coefficients of all rows but those of the variables, from those up to the k-th of these; k > 0, and orders follow each
    /// other.
    #[inline(always)]
    pub fn level(&mut self, k: usize) {
        let (mut level, _, later) = self.order(k);
        if k.is_multiple_of(ORDERS) {
            for one in later.iter_mut() {
                if let PlacedLater::Other(one) = one {
                    level.go_on(one);
                }
            }
        }
        for one in later {
            match one {
                PlacedLater::Sum { terms, result } => level.sum(terms, *result),
                PlacedLater::Other(one) => level.carry_out(one),
            }
        }
    }

    /// The next coefficients of the variables, whose rates the program gives first; the unit of time is a power of two.
    #[inline(always)]
    pub fn integrate(&mut self, k: usize, unit: f64) {
        let inverse = self.inverses[k + 1];
        let share = DoubleDouble::of_finite(inverse.hi() * unit, inverse.lo() * unit);
        for (i, rate) in self.rates.iter().enumerate() {
            let rate = match *rate {
                Source::Row(row) => self.coefficients[row + k],
                Source::Number(x) if k == 0 => self.any.like_exact(x),
                Source::Number(_) => self.any.like(0.0),
            };
            self.coefficients[i * self.room + k + 1] = rate.scale(share);
        }
    }
}

/// The coefficients of all rows while those of one order are made.
pub(super) struct Level<'a, T> {
    coefficients: &'a mut [T],
    pub room: usize,
    pub k: usize,
    /// 1/k
    pub one_over: DoubleDouble,
    /// k
    pub order: DoubleDouble,
    pub any: T,
}

impl<T: Element> Level<'_, T> {
    #[inline(always)]
    pub fn put(&mut self, row: usize, x: T) {
        self.coefficients[row + self.k] = x;
    }

    /// The newest coefficient of a row.
    #[inline(always)]
    pub fn newest(&self, row: usize) -> T {
        self.coefficients[row + self.k]
    }

    #[inline(always)]
    pub fn first(&self, row: usize) -> T {
        self.coefficients[row]
    }

    /// The newest coefficient of a quantity.
    #[inline(always)]
    pub fn of(&self, source: Source) -> T {
        match source {
            Source::Row(row) => self.newest(row),
            Source::Number(x) if self.k == 0 => self.any.like_exact(x),
            Source::Number(_) => self.any.like(0.0),
        }
    }

    /// The coefficients of a row before the newest.
    #[inline(always)]
    pub fn older(&self, row: usize) -> &[T] {
        &self.coefficients[row..][..self.k]
    }

    /// The signs that hold for all later orders.
    #[inline(always)]
    fn set_signs(&self, terms: &mut [PlacedTerm<T>]) {
        for term in terms {
            if let Some(row) = term.sign {
                term.factor = self.any.like_exact(term.exact) * self.first(row).sign();
            }
        }
    }

    #[inline(always)]
    fn sum(&mut self, terms: &[PlacedTerm<T>], result: usize) {
        let mut sum = self.any.like(0.0);
        for term in terms {
            let x = self.newest(term.row);
            let x = match term.lane {
                None => x,
                Some(0) => self.any.like(x.lane(0)),
                // Twins are two.
                Some(_) => self.any.like(x.lane(T::LANES - 1)),
            };
            sum = x.mul_add(term.factor, sum);
        }
        self.put(result, sum);
    }
}
