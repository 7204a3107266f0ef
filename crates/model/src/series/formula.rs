//! A differential equation as a formula, and the series of its solution.

use super::MAX_ORDER;
use super::element::Element;
use super::handle::Series;
use super::tape::{At, Order, ROOM, ROWS, Running, Tape};
use pulp::NullaryFnOnce;
use std::cell::Cell;

/// Coefficients of all rows of a formula, of which each has the same room.
pub(super) type Memory<E> = [[E; MAX_ORDER + 1]; ROWS];
/// Quantities of a formula, other than its variables, whose series are kept too.
pub const WATCHED: usize = 5;

/// What a formula gives at one order.
pub struct Rates<'t, E, O, const C: usize> {
    /// The time derivative of every variable.
    pub variables: [Series<'t, E, O>; C],
    /// Other quantities along the solution.
    pub watched: [Series<'t, E, O>; WATCHED],
}

/// dx/dt = f(x) in C variables.
pub trait Formula<E: Element, const C: usize>: Copy {
    /// Whether the series are compiled order by order, and not made in loops. They then take half the time, and seconds to
    /// minutes to compile.
    const UNROLLED: bool = false;

    /// The variable at whose zeros the formula is not smooth, if there is one.
    const KINK: Option<usize> = None;

    /// f(x), at the order of the series.
    fn rates<'t, O: Order>(&self, x: [Series<'t, E, O>; C]) -> Rates<'t, E, O, C>;

    /// What may err by one in a step, from the state and the tolerances: the unit of every variable.
    fn units(&self, x: &[E; C], tolerances: (f64, f64)) -> [E; C];

    /// Positive and finite in the lanes whose state is one that the formula is meant for.
    fn allows(&self, x: &[E; C]) -> E;
}

/// The coefficients at the order of the tape, and with them those of the variables at the next, in a unit of time. Returns the rows of what is
/// watched.
#[inline(always)]
fn level<E: Element, F: Formula<E, C>, O: Order, const C: usize>(
    formula: &F,
    memory: &[Cell<E>],
    order: O,
    unit: E,
) -> [Option<usize>; WATCHED] {
    let tape = Tape::new(memory, order, C);
    let mut x = [tape.variable(0); C];
    // The first one by one: what is in a loop folds too late.
    if C > 1 {
        x[1] = tape.variable(1);
    }
    if C > 2 {
        x[2] = tape.variable(2);
    }
    for (i, x) in x.iter_mut().enumerate().skip(3) {
        *x = tape.variable(i);
    }
    let rates = formula.rates(x);
    let any = memory[0].get();
    let next = order.index() + 1;
    let unit_over_next = unit * (any.like(1.0) / any.like(next as f64));
    // No closure: it would be compiled for any processor.
    macro_rules! put {
        ($i:expr) => {
            let rate = rates.variables[$i].times(unit_over_next, order);
            memory[$i * ROOM + next].set(rate);
        };
    }
    put!(0);
    if C > 1 {
        put!(1);
    }
    if C > 2 {
        put!(2);
    }
    for i in 3..C {
        put!(i);
    }
    let [a, b, c, d, e] = rates.watched;
    [a.row(), b.row(), c.row(), d.row(), e.row()]
}

/// One level, as a function of its own for the compiler: the time that it takes for a function grows with the square of
/// its length.
struct Level<'a, E, F, O, const C: usize> {
    formula: &'a F,
    memory: &'a [Cell<E>],
    order: O,
    unit: E,
}

impl<E: Element, F: Formula<E, C>, O: Order, const C: usize> NullaryFnOnce
    for Level<'_, E, F, O, C>
{
    type Output = [Option<usize>; WATCHED];
    #[inline(always)]
    fn call(self) -> Self::Output {
        level(self.formula, self.memory, self.order, self.unit)
    }
}

#[inline(always)]
fn run_level<E: Element, F: Formula<E, C>, O: Order, const C: usize>(
    formula: &F,
    memory: &[Cell<E>],
    order: O,
    unit: E,
) -> [Option<usize>; WATCHED] {
    unit.run(Level {
        formula,
        memory,
        order,
        unit,
    })
}

/// A level in loops.
#[inline(always)]
fn running_level<E: Element, F: Formula<E, C>, const C: usize>(
    formula: &F,
    memory: &[Cell<E>],
    order: Running,
    unit: E,
) -> [Option<usize>; WATCHED] {
    if E::CALLED {
        run_level(formula, memory, order, unit)
    } else {
        level(formula, memory, order, unit)
    }
}

/// The first level alone: the rates at the first coefficients, in that unit of time.
#[inline(always)]
pub(super) fn first_level<E: Element, F: Formula<E, C>, const C: usize>(
    formula: &F,
    memory: &[Cell<E>],
    unit: E,
) {
    run_level(formula, memory, Running(0), unit);
}

/// The series, in that unit of time, of the solution whose first coefficients stand in the memory, to an order of 12, 16 or [`super::UNROLLED_ORDER`].
///
/// Every order is compiled by itself: with it a constant, all sums are unrolled and all places in the memory known.
#[inline(always)]
pub(super) fn expand<E: Element, F: Formula<E, C>, const C: usize>(
    formula: &F,
    memory: &[Cell<E>],
    order: usize,
    unit: E,
) -> [Option<usize>; WATCHED] {
    macro_rules! levels {
        ($($k:literal)*; $last:literal) => {{
            $( run_level(formula, memory, At::<$k>, unit); )*
            run_level(formula, memory, At::<$last>, unit)
        }};
    }
    let watched = levels!(0 1 2 3 4 5 6 7 8 9 10; 11);
    if order == 12 {
        return watched;
    }
    let watched = levels!(12 13 14; 15);
    if order == 16 {
        return watched;
    }
    levels!(16; 17)
}

/// The same to any even order up to [`MAX_ORDER`], in loops. Inlined, as all of a step is: what
/// is not would be compiled for any processor, and call its instructions one by one.
#[inline(always)]
pub(super) fn expand_running<E: Element, F: Formula<E, C>, const C: usize>(
    formula: &F,
    memory: &[Cell<E>],
    order: usize,
    unit: E,
) -> [Option<usize>; WATCHED] {
    let mut watched = [None; WATCHED];
    for index in 0..order {
        watched = running_level(formula, memory, Running(index), unit);
    }
    watched
}
