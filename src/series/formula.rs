//! A differential equation as a formula, and the series of its solution.

use super::element::Element;
use super::tape::{At, Order, Running, Series, Tape};
use std::cell::Cell;

/// Rows that a formula may take, its variables included.
pub(super) const ROWS: usize = 40;
/// Coefficients of all rows of a formula, of which each has the same room.
pub(super) type Memory<E, const ROOM: usize> = [[E; ROOM]; ROWS];
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
    let mut c = 1;
    while c < C {
        x[c] = tape.variable(c);
        c += 1;
    }
    let rates = formula.rates(x);
    let any = memory[0].get();
    let next = order.index() + 1;
    let unit_over_next = unit * (any.like(1.0) / any.like(next as f64));
    let mut c = 0;
    while c < C {
        let rate = rates.variables[c].newest(any, order);
        memory[c * order.room() + next].set(rate * unit_over_next);
        c += 1;
    }
    let [a, b, c, d, e] = rates.watched;
    [a.row(), b.row(), c.row(), d.row(), e.row()]
}

/// The first level alone: the rates at the first coefficients, in that unit of time.
#[inline(always)]
pub(super) fn first_level<E: Element, F: Formula<E, C>, const C: usize>(
    formula: &F,
    memory: &[Cell<E>],
    room: usize,
    unit: E,
) {
    level(formula, memory, Running { room, index: 0 }, unit);
}

/// The series, in that unit of time, of the solution whose first coefficients stand in the memory, to an order of 12, 16 or [`super::MAX_ORDER`].
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
            $( level(formula, memory, At::<$k>, unit); )*
            level(formula, memory, At::<$last>, unit)
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
    levels!(16 17 18; 19)
}

/// The same to any even order below the room of a row, in loops.
pub(super) fn expand_running<E: Element, F: Formula<E, C>, const C: usize>(
    formula: &F,
    memory: &[Cell<E>],
    room: usize,
    order: usize,
    unit: E,
) -> [Option<usize>; WATCHED] {
    let mut watched = [None; WATCHED];
    for index in 0..order {
        watched = level(formula, memory, Running { room, index }, unit);
    }
    watched
}
