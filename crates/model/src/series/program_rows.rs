//! The rows of a [`Program`], and how its operations fill them: by recurrences (Knuth, The Art of
//! Computer Programming 2, section 4.7; Jorba & Zou 2005, proposition 2), in loops.

use super::element::Element;
use super::placed::{PlacedLater, PlacedSum, PlacedTerm, placed};
use super::products::ORDERS;
use super::program::{Instruction, Operation, Program, Source};
use crate::number::DoubleDouble;

/// The rows of a program: the coefficients of each, one after the other.
#[derive(Debug, Clone)]
pub(super) struct ProgramRows<T: Element> {
    coefficients: Vec<T>,
    /// Coefficients that a row has room for.
    room: usize,
    /// 1/k for every order k.
    inverses: Vec<DoubleDouble>,
    /// The operations of the first order and of all later ones; rows are where they begin among the coefficients.
    first: Vec<Instruction>,
    /// The places of those of the first order that the rates need.
    of_rates: Vec<usize>,
    later: Vec<PlacedLater<T>>,
    /// Those of the later ones for which the first coefficients count.
    prepared: Vec<usize>,
    /// The places, among those of the first order and the later ones, of those whose constants parameters are part of.
    varying_first: Vec<usize>,
    varying_later: Vec<usize>,
    /// The rates of the variables, and those that are no sums at later orders.
    rates: Vec<Rate>,
    rates_apart: Vec<Rate>,
    any: T,
}

/// The rate of a variable.
#[derive(Debug, Clone, Copy)]
pub(super) struct Rate {
    pub variable: usize,
    pub of: Source,
}

impl Rate {
    /// Whether it is one of these sums, which then makes the next coefficient of the variable too.
    fn joined_to<T: Element>(self, later: &mut [PlacedLater<T>], room: usize) -> bool {
        let Source::Row(row) = self.of else {
            return false;
        };
        let sums = later.iter_mut().filter_map(|one| match one {
            PlacedLater::Sum(sum) => Some(sum),
            PlacedLater::Other(_) => None,
        });
        let mut free = sums.filter(|sum| sum.rate_of.is_none());
        let sum = free.find(|sum| sum.result == row * room);
        sum.is_some_and(|sum| {
            sum.rate_of = Some(self.variable * room);
            true
        })
    }
}

impl<T: Element> ProgramRows<T> {
    /// With room for these; `any` is any number.
    pub fn new(program: &Program, room: usize, any: T) -> Self {
        let first = program.instructions().iter();
        // None where there is room for the first coefficients alone.
        let later = if room > 1 {
            &program.later.all[..]
        } else {
            &[]
        };
        let mut later: Vec<_> = later
            .iter()
            .map(|one| PlacedLater::new(one, program, room, any))
            .collect();
        let rate = |variable| Rate {
            variable,
            of: program.output(variable),
        };
        let rates: Vec<_> = (0..program.variables()).map(rate).collect();
        let apart = rates
            .iter()
            .filter(|rate| !rate.joined_to(&mut later, room));
        let rates_apart = apart.copied().collect();
        let is_prepared = |one: &PlacedLater<T>| match one {
            PlacedLater::Sum(sum) => sum.terms.iter().any(|term| term.sign.is_some()),
            PlacedLater::Other(_) => true,
        };
        ProgramRows {
            coefficients: vec![any.like(0.0); program.rows() * room],
            room,
            inverses: (0..room)
                .map(|k| DoubleDouble::from(1.0) / k as f64)
                .collect(),
            first: first
                .map(|one| placed(one, room, &program.constants))
                .collect(),
            of_rates: program.of_rates(),
            varying_first: (0..program.instructions().len())
                .filter(|&i| program.varies(program.instructions()[i].operation))
                .collect(),
            varying_later: (0..later.len())
                .filter(|&i| program.varies_later(&program.later.all[i]))
                .collect(),
            rates_apart,
            prepared: (0..later.len())
                .filter(|&i| is_prepared(&later[i]))
                .collect(),
            later,
            rates,
            any,
        }
    }

    /// Takes over the constants of the program, which is theirs but for these. Returns whether all stands where it did.
    pub fn set(&mut self, program: &Program) -> bool {
        for &i in &self.varying_first {
            self.first[i] = placed(&program.instructions()[i], self.room, &program.constants);
        }
        for rate in self.rates.iter_mut().chain(&mut self.rates_apart) {
            rate.of = program.output(rate.variable);
        }
        let mut later = self.varying_later.iter();
        later.all(|&i| {
            let one = &program.later.all[i];
            self.later[i].set(one, program, self.room, self.any)
        })
    }

    /// The coefficients of a row.
    #[inline(always)]
    pub fn row(&self, row: usize) -> &[T] {
        &self.coefficients[row * self.room..][..self.room]
    }

    /// The rate of a variable where the series begin.
    #[inline(always)]
    pub fn rate(&self, variable: usize) -> T {
        self.coefficient(self.rates[variable].of, 0)
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

    /// What is to be made at an order, and the operations of those after the first.
    #[inline(always)]
    fn order(&mut self, k: usize) -> (Level<'_, T>, &mut [PlacedLater<T>]) {
        let level = Level {
            coefficients: &mut self.coefficients,
            room: self.room,
            k,
            phase: k % ORDERS,
            begins: k < ORDERS,
            one_over: self.inverses[k],
            share: self.any,
            order: DoubleDouble::from(k as f64),
            any: self.any,
        };
        (level, &mut self.later)
    }

    /// The coefficients of all rows, one row after the other.
    pub fn coefficients(&self) -> &[T] {
        &self.coefficients
    }

    /// The same, to be changed.
    #[inline(always)]
    pub fn coefficients_mut(&mut self) -> &mut [T] {
        &mut self.coefficients
    }

    /// How many variables there are, which have the first rows.
    pub fn variables(&self) -> usize {
        self.rates.len()
    }

    /// Coefficients that a row has room for.
    pub fn room(&self) -> usize {
        self.room
    }

    /// What is carried out at all orders but the first.
    #[inline(always)]
    pub fn later(&self) -> &[PlacedLater<T>] {
        &self.later
    }

    /// Those of the later ones whose constants parameters are part of.
    pub fn varying(&self) -> &[usize] {
        &self.varying_later
    }

    /// The rates that are no sums.
    pub fn rates_apart(&self) -> &[Rate] {
        &self.rates_apart
    }

    /// 1/k
    pub fn one_over(&self, k: usize) -> DoubleDouble {
        self.inverses[k]
    }

    /// What the k-th coefficient of a rate counts in the next one of its variable, in that unit of time.
    #[inline(always)]
    pub fn share(&self, k: usize, unit: T) -> T {
        unit.like_exact(self.inverses[k + 1]) * unit
    }

    /// The first coefficients at this state.
    #[inline(always)]
    pub fn begin(&mut self, x: &[T]) {
        self.begin_variables(x);
        let operations = std::mem::take(&mut self.first);
        let (mut level, _) = self.order(0);
        // A loop, as all here: a closure would not be compiled for the processor.
        for one in &operations {
            level.begin(one);
        }
        self.first = operations;
    }

    /// Those of the rates at this state, and of what they need.
    #[inline(always)]
    pub fn begin_rates(&mut self, x: &[T]) {
        self.begin_variables(x);
        let operations = (
            std::mem::take(&mut self.first),
            std::mem::take(&mut self.of_rates),
        );
        let (mut level, _) = self.order(0);
        for &place in &operations.1 {
            level.begin(&operations.0[place]);
        }
        (self.first, self.of_rates) = operations;
    }

    #[inline(always)]
    fn begin_variables(&mut self, x: &[T]) {
        let rows = self.coefficients.chunks_exact_mut(self.room);
        for (row, x) in rows.zip(x) {
            row[0] = *x;
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

    /// Holds non-integer powers of the rows that satisfy the condition constant in the next series, and no others. Returns whether this
    /// differs from the series before.
    pub fn hold_powers(&mut self, of: impl Fn(usize, &[T]) -> bool) -> bool {
        let mut changes = false;
        for one in &mut self.later {
            if let PlacedLater::Other(one) = one
                && let Operation::Power(base, _) = one.operation
            {
                let hold = of(base / self.room, &self.coefficients[base..][..self.room]);
                changes |= hold != one.held;
                one.held = hold;
            }
        }
        changes
    }

    /// Whether the next series holds any power constant.
    pub fn holds_powers(&self) -> bool {
        let held = |one: &PlacedLater<T>| matches!(one, PlacedLater::Other(one) if one.held);
        self.later.iter().any(held)
    }

    /// What the first coefficients are to all later orders.
    #[inline(always)]
    pub fn prepare(&mut self) {
        let prepared = std::mem::take(&mut self.prepared);
        let (level, later) = self.order(0);
        for &i in &prepared {
            match &mut later[i] {
                PlacedLater::Sum(sum) => level.set_signs(&mut sum.terms),
                PlacedLater::Other(one) => level.prepare(one),
            }
        }
        self.prepared = prepared;
    }

    /// Those of the later operations for which the first coefficients count.
    #[inline(always)]
    pub fn prepared(&self) -> &[usize] {
        &self.prepared
    }

    /// The coefficients of the variables after the first, from the first ones of their rates.
    #[inline(always)]
    pub fn integrate(&mut self, unit: T) {
        let share = self.share(0, unit);
        for rate in &self.rates {
            let next = self.coefficient(rate.of, 0) * share;
            self.coefficients[rate.variable * self.room + 1] = next;
        }
    }

    /// The k-th coefficients of all rows but those of the variables, from those up to the k-th of these, whose next ones they make; k > 0,
    /// and orders follow each other.
    #[inline(always)]
    pub fn level(&mut self, k: usize, unit: T) {
        let share = self.share(k, unit);
        let (level, later) = self.order(k);
        let level = Level { share, ..level };
        if k == 1 {
            for one in later.iter_mut() {
                if let PlacedLater::Other(one) = one {
                    level.clear_sums(one);
                }
            }
        }
        if level.phase == 0 {
            for one in later.iter_mut() {
                if let PlacedLater::Other(one) = one {
                    level.go_on(one);
                }
            }
        }
        // Compiled for either: the first ones do what no other does.
        if level.begins {
            level.beginning(true).carry_all_out(later);
        } else {
            level.beginning(false).carry_all_out(later);
        }
        for rate in &self.rates_apart {
            let next = match rate.of {
                Source::Row(row) => self.coefficients[row * self.room + k] * share,
                Source::Number(_) => self.any.like(0.0),
            };
            self.coefficients[rate.variable * self.room + k + 1] = next;
        }
    }
}

/// The coefficients of all rows while those of one order are made.
pub(super) struct Level<'a, T> {
    coefficients: &'a mut [T],
    pub room: usize,
    pub k: usize,
    /// How many orders it is after a multiple of [`ORDERS`].
    pub phase: usize,
    /// Whether it is before the first such multiple.
    pub begins: bool,
    /// 1/k
    pub one_over: DoubleDouble,
    /// What a rate counts in the next coefficient of its variable.
    share: T,
    /// k
    pub order: DoubleDouble,
    pub any: T,
}

impl<T: Element> Level<'_, T> {
    /// The same for what is called: that of which others know where it stands is read from there again and again.
    #[inline(always)]
    pub fn apart(&mut self) -> Level<'_, T> {
        Level {
            coefficients: self.coefficients,
            ..*self
        }
    }

    /// The same with that known to the compiler.
    #[inline(always)]
    fn beginning(self, begins: bool) -> Self {
        Level { begins, ..self }
    }

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

    #[inline(always)]
    fn carry_all_out(&mut self, later: &mut [PlacedLater<T>]) {
        for one in later {
            match one {
                PlacedLater::Sum(sum) => self.sum(sum),
                PlacedLater::Other(one) => self.carry_out(one),
            }
        }
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

    /// The newest coefficient of the row of a term, of the lane that counts.
    #[inline(always)]
    fn newest_of(&self, term: &PlacedTerm<T>) -> T {
        let x = self.newest(term.row);
        match term.lane {
            None => x,
            Some(0) => self.any.like(x.lane(0)),
            // Twins are two.
            Some(_) => self.any.like(x.lane(T::LANES - 1)),
        }
    }

    #[inline(always)]
    fn sum(&mut self, sum: &PlacedSum<T>) {
        let mut terms = sum.terms.iter();
        let mut all = match terms.next() {
            Some(term) => self.newest_of(term) * term.factor,
            None => self.any.like(0.0),
        };
        for term in terms {
            all = self.newest_of(term).mul_add(term.factor, all);
        }
        self.put(sum.result, all);
        if let Some(variable) = sum.rate_of {
            self.put(variable + 1, all * self.share);
        }
    }
}
