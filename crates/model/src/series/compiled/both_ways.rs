//! A formula at a state, run in loops or compiled: for tests that compare the two.

use super::{Compiled, expand};
use crate::series::element::Element;
use crate::series::program::Program;
use crate::series::program_rows::ProgramRows;
use pulp::NullaryFnOnce;

/// A formula at a state, whose series are made either way.
pub trait BothWays {
    /// Makes the coefficients of all rows below this order, and those of the variables up to it, in this unit of time, compiled or in loops. Returns
    /// whether it was compiled: a kernel may not hold for the first coefficients.
    fn expand(&mut self, compiled: bool, order: usize, unit: f64) -> bool;

    /// The coefficients of all rows, in all lanes.
    fn coefficients(&self) -> Vec<f64>;
}

struct AtState<T: Element> {
    rows: ProgramRows<T>,
    compiled: Compiled<T>,
    state: Vec<T>,
    any: T,
}

/// `None` where it is not compiled.
pub(in crate::series) fn both_ways<T: Element + 'static>(
    program: &Program,
    room: usize,
    (state, any): (Vec<T>, T),
) -> Option<Box<dyn BothWays>> {
    let rows = ProgramRows::new(program, room, any);
    let compiled = Compiled::at_once(&rows, any)?;
    Some(Box::new(AtState {
        rows,
        compiled,
        state,
        any,
    }))
}

/// All orders, to be compiled for the processor.
struct Expand<'a, T: Element> {
    at: &'a mut AtState<T>,
    compiled: bool,
    order: usize,
    unit: f64,
}

impl<T: Element> NullaryFnOnce for Expand<'_, T> {
    type Output = bool;

    #[inline(always)]
    fn call(self) -> bool {
        let unit = self.at.any.like(self.unit);
        let AtState {
            rows,
            compiled,
            state,
            ..
        } = self.at;
        let compiled = self.compiled.then_some(compiled);
        expand((rows, compiled), state, (self.order, unit))
    }
}

impl<T: Element> BothWays for AtState<T> {
    fn expand(&mut self, compiled: bool, order: usize, unit: f64) -> bool {
        let any = self.any;
        any.run(Expand {
            at: self,
            compiled,
            order,
            unit,
        })
    }

    fn coefficients(&self) -> Vec<f64> {
        let all = self.rows.coefficients().iter();
        let lanes = all.flat_map(|x| (0..T::LANES).map(|lane| x.lane(lane)));
        lanes.collect()
    }
}
