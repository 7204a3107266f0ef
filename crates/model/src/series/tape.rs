//! Taylor-mode automatic differentiation: power series in time that are made order by order.
//!
//! A formula written for any [`Real`](crate::number::Real) is evaluated once per order on [`Series`]: handles of rows on a tape, the coefficients
//! so far. At order k every operation appends the k-th coefficient of its result from its arguments' coefficients 0..=k, by
//! the recurrence of the operation (Knuth, The Art of Computer Programming 2, section 4.7; Jorba & Zou 2005, proposition 2).
//! The rows are allocated by a counter that starts anew at each order, so that an operation finds its own row again. With the
//! order a constant everything but the recurrences folds away: no handle, no counter is left in the machine code.

use super::element::Element;
use super::handle::{Series, row};
use std::cell::Cell;

/// Coefficients that a row has room for.
pub const ROOM: usize = super::MAX_ORDER + 1;

/// Rows that a compiled formula may take, its variables included.
pub(super) const ROWS: usize = 64;

/// The order at which a formula is evaluated.
pub trait Order: Copy {
    /// Whether the order is known to the compiler, and all sums to be unrolled.
    const UNROLLED: bool;
    /// k
    fn index(self) -> usize;
}

/// An order known to the compiler.
#[derive(Clone, Copy)]
pub struct At<const K: usize>;

impl<const K: usize> Order for At<K> {
    const UNROLLED: bool = true;
    #[inline(always)]
    fn index(self) -> usize {
        K
    }
}

/// An order known when the program runs.
#[derive(Clone, Copy)]
pub struct Running(pub usize);

impl Order for Running {
    const UNROLLED: bool = false;
    #[inline(always)]
    fn index(self) -> usize {
        self.0
    }
}

/// The rows of all series of one formula.
pub struct Tape<'m, E, O> {
    memory: &'m [Cell<E>],
    order: O,
    next: Cell<usize>,
}

impl<'m, E: Element, O: Order> Tape<'m, E, O> {
    /// On this memory, whose first rows are taken by the variables.
    #[inline(always)]
    pub fn new(memory: &'m [Cell<E>], order: O, variables: usize) -> Self {
        let next = Cell::new(variables);
        Tape {
            memory,
            order,
            next,
        }
    }

    /// The variable in the i-th row.
    #[inline(always)]
    pub fn variable(&self, i: usize) -> Series<'_, E, O> {
        row(Row {
            tape: self,
            row: i,
            newest: None,
            factor: None,
        })
    }

    #[inline(always)]
    fn get(&self, row: usize, j: usize) -> E {
        self.memory[row * ROOM + j].get()
    }

    #[inline(always)]
    pub(super) fn set(&self, row: usize, j: usize, x: E) {
        self.memory[row * ROOM + j].set(x);
    }

    #[inline(always)]
    fn allocate(&self) -> usize {
        let row = self.next.get();
        self.next.set(row + 1);
        row
    }
}

/// A row on a tape, times a factor; or but the newest coefficient of one, as long as no other is asked for.
///
/// The factor waits until it can be multiplied by something that is known sooner than the coefficient.
pub struct Row<'t, E, O> {
    pub(super) tape: &'t Tape<'t, E, O>,
    pub(super) row: usize,
    pub(super) newest: Option<E>,
    pub(super) factor: Option<E>,
}

impl<E: Copy, O> Clone for Row<'_, E, O> {
    #[inline(always)]
    fn clone(&self) -> Self {
        *self
    }
}
impl<E: Copy, O> Copy for Row<'_, E, O> {}

impl<'t, E: Element, O: Order> Row<'t, E, O> {
    /// A new row on the same tape.
    #[inline(always)]
    pub(super) fn another(self) -> Self {
        Row {
            row: self.tape.allocate(),
            newest: None,
            factor: None,
            ..self
        }
    }

    /// As a row whose coefficients can all be had.
    #[inline(always)]
    pub(super) fn stored(self) -> Self {
        match (self.newest, self.factor) {
            (None, None) => self,
            _ => self.another().put(self.newest()),
        }
    }

    /// The row without its factor, as one whose coefficients can all be had, and the factor if there is still one.
    #[inline(always)]
    pub(super) fn parts(self) -> (Self, Option<E>) {
        match self.newest {
            None => (
                Row {
                    factor: None,
                    ..self
                },
                self.factor,
            ),
            Some(_) => (self.stored(), None),
        }
    }

    /// The order at which the formula is evaluated.
    #[inline(always)]
    pub(super) fn order(self) -> usize {
        self.tape.order.index()
    }

    #[inline(always)]
    pub(super) fn get(self, j: usize) -> E {
        self.tape.get(self.row, j)
    }

    /// The row.
    #[inline(always)]
    pub(super) fn coefficients(self) -> &'t [Cell<E>] {
        &self.tape.memory[self.row * ROOM..][..ROOM]
    }

    /// The newest coefficient.
    #[inline(always)]
    pub(super) fn newest(self) -> E {
        match self.factor {
            Some(factor) => self.unscaled() * factor,
            None => self.unscaled(),
        }
    }

    /// The newest coefficient without the factor.
    #[inline(always)]
    pub(super) fn unscaled(self) -> E {
        match self.newest {
            Some(x) => x,
            None => self.get(self.order()),
        }
    }

    /// The newest coefficient times x.
    #[inline(always)]
    pub(super) fn times(self, x: E) -> E {
        match self.factor {
            Some(factor) => self.unscaled() * (factor * x),
            None => self.unscaled() * x,
        }
    }

    /// The newest coefficient times a, plus b.
    #[inline(always)]
    pub(super) fn mul_add(self, a: E, b: E) -> E {
        match self.factor {
            Some(factor) => self.unscaled().mul_add(factor * a, b),
            None => self.unscaled().mul_add(a, b),
        }
    }

    /// x a
    #[inline(always)]
    pub(super) fn scaled(self, x: E) -> Self {
        let factor = match self.factor {
            Some(factor) => factor * x,
            None => x,
        };
        Row {
            factor: Some(factor),
            ..self
        }
    }

    /// |a|, of the sign that a has at the beginning.
    #[inline(always)]
    pub(super) fn magnitude(self) -> Self {
        let (this, factor) = self.parts();
        let this = match factor {
            Some(factor) => this.scaled(factor.abs()),
            None => this,
        };
        this.scaled(this.get(0).sign())
    }

    /// Some element, for its kind.
    #[inline(always)]
    pub(super) fn any(self) -> E {
        self.tape.get(0, 0)
    }

    /// a + b
    #[inline(always)]
    pub(super) fn sum(self, other: Self) -> Self {
        match (self.factor, other.factor) {
            (_, Some(factor)) => self.mapped(other.unscaled().mul_add(factor, self.newest())),
            (Some(factor), _) => self.mapped(self.unscaled().mul_add(factor, other.unscaled())),
            _ => self.mapped(self.unscaled() + other.unscaled()),
        }
    }

    /// -a
    #[inline(always)]
    pub(super) fn negative(self) -> Self {
        match self.factor {
            Some(factor) => Row {
                factor: Some(-factor),
                ..self
            },
            None => self.mapped(-self.unscaled()),
        }
    }

    /// a - b
    #[inline(always)]
    pub(super) fn difference(self, other: Self) -> Self {
        match (self.factor, other.factor) {
            (None, None) => self.mapped(self.unscaled() - other.unscaled()),
            _ => self.sum(other.negative()),
        }
    }

    /// Puts down the newest coefficient.
    #[inline(always)]
    pub(super) fn put(self, x: E) -> Self {
        self.tape.set(self.row, self.order(), x);
        self
    }

    /// A series with this newest coefficient.
    #[inline(always)]
    pub(super) fn mapped(self, x: E) -> Self {
        Row {
            newest: Some(x),
            factor: None,
            ..self
        }
    }

    /// The constant x as a row of its own.
    #[inline(always)]
    pub(super) fn constant_series(self, x: E) -> Self {
        self.mapped(if self.order() == 0 { x } else { x.like(0.0) })
    }

    /// a / x. Beyond the first coefficient by the inverse, which is the same at all orders: divisions take long.
    #[inline(always)]
    pub(super) fn over(self, x: E) -> Self {
        if self.order() == 0 {
            return self.mapped(self.newest() / x);
        }
        self.loose().scaled(x.like(1.0) / x)
    }

    /// The same, of which but the newest coefficient can be had: for what is not the same multiple of a row at all orders.
    #[inline(always)]
    pub(super) fn loose(self) -> Self {
        Row {
            newest: Some(self.unscaled()),
            ..self
        }
    }

    /// a + x
    #[inline(always)]
    pub(super) fn plus(self, x: E) -> Self {
        if self.order() == 0 {
            return self.mapped(self.newest() + x);
        }
        self.loose()
    }
}
