//! Formulas compiled to machine code when the program runs: all orders of a step but the first coefficients, in one call.
//!
//! A kernel carries out the operations of [`super::later_orders`] in the same order, so that its results are those of the loops bit by bit. What a
//! formula's parameters and the first coefficients of a step make of it are numbers that the kernel is given, so that one kernel serves all
//! solutions of a formula. Formulas are run in loops until [`formulas::Kernels`] has counted enough steps of them.

mod both_ways;
mod columns;
#[cfg(target_arch = "x86_64")]
mod columns_both_ways;
mod data;
mod ends;
mod formulas;
mod ratios_and_balances;
mod recurrences;
mod shape;
mod sums;

pub use both_ways::BothWays;
pub(super) use both_ways::both_ways;
pub(super) use columns::CompiledColumns;
#[cfg(target_arch = "x86_64")]
pub(super) use columns_both_ways::columns_both_ways;

use super::element::Element;
use super::program_rows::ProgramRows;
use data::Data;
use ends::Ends;
use formulas::{Formula, When};
use shape::Shape;

/// The formula of some rows, and what its kernels are given.
#[derive(Debug, Clone)]
pub(super) struct Compiled<T> {
    formula: Formula,
    data: Data<T>,
    ends: Ends<T>,
    when: When,
}

/// Makes the series of these rows that begin at these variables, to an order and in that unit of time: compiled where that is given and has
/// a kernel, else in loops. Returns whether it was compiled.
#[inline(always)]
pub(super) fn expand<T: Element>(
    (rows, compiled): (&mut ProgramRows<T>, Option<&mut Compiled<T>>),
    begin: &[T],
    (order, unit): (usize, T),
) -> bool {
    rows.begin(begin);
    rows.prepare();
    rows.integrate(unit);
    if let Some(compiled) = compiled
        && compiled.expand(rows, order, unit)
    {
        return true;
    }
    for k in 1..order {
        rows.level(k, unit);
    }
    false
}

impl<T: Element> Compiled<T> {
    /// `None` where these rows are not compiled.
    pub fn of(rows: &ProgramRows<T>, any: T) -> Option<Self> {
        Self::when(When::allowed()?, rows, any)
    }

    /// To be compiled before the first step, whatever the user allows.
    pub fn at_once(rows: &ProgramRows<T>, any: T) -> Option<Self> {
        Self::when(When::AtOnce, rows, any)
    }

    fn when(when: When, rows: &ProgramRows<T>, any: T) -> Option<Self> {
        let shape = Shape::of(rows.later(), rows.rates_apart(), rows.room())?;
        let formula = Formula::of(shape)?;
        let data = Data::new(formula.layout().clone(), rows, any);
        let ends = Ends::of(rows.variables(), rows.room(), any)?;
        Some(Compiled {
            formula,
            data,
            ends,
            when,
        })
    }

    /// Takes over the constants of the rows, which are as they were but for these. Returns whether the kernels hold for them.
    pub fn set(&mut self, rows: &ProgramRows<T>) -> bool {
        let varying = rows.varying();
        self.data.set(rows, varying.iter().copied());
        self.formula.shape().holds_for(rows.later(), varying)
    }

    /// Makes the coefficients of all rows below an order, and of the variables that one too, of rows that are prepared; returns whether it did:
    /// there may be no kernel yet, or none for such first coefficients.
    #[inline(always)]
    pub fn expand(&mut self, rows: &mut ProgramRows<T>, order: usize, unit: T) -> bool {
        let Some(kernel) = self.formula.kernel(order, self.when) else {
            return false;
        };
        if !self.data.gather(rows, unit) {
            return false;
        }
        T::run_kernel(kernel, rows.coefficients_mut(), self.data.numbers(), &[]);
        true
    }

    /// Evaluates the series of the variables at two points; returns whether it did: there may be no kernel yet.
    #[inline(always)]
    pub fn evaluate(&mut self, rows: &ProgramRows<T>, order: usize, points: [T; 2]) -> bool {
        self.ends.evaluate(rows, (order, self.when), points)
    }

    /// The sum of the terms after the first over the point, and the derivative, of a variable at one of the points that were evaluated last.
    #[inline(always)]
    pub fn end(&self, i: usize, point: usize) -> [T; 2] {
        self.ends.of_variable(i, point)
    }
}
