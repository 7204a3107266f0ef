//! Power series in time that are made order by order.
//!
//! A formula written for any [`Real`](crate::number::Real) is evaluated once per order on [`Series`]: handles of rows on a tape, the coefficients
//! so far. At order k every operation appends the k-th coefficient of its result from its arguments' coefficients 0..=k, by
//! the recurrence of the operation (Knuth, The Art of Computer Programming 2, section 4.7; Jorba & Zou 2005, proposition 2).
//! The rows are allocated by a counter that starts anew at each order, so that an operation finds its own row again. With the
//! order a constant everything but the recurrences folds away: no handle, no counter is left in the machine code.

use super::element::Element;
use crate::number::DoubleDouble;
use std::cell::Cell;
use std::fmt;

/// The order at which a formula is evaluated.
pub trait Order: Copy {
    /// Whether the order is known to the compiler, and all sums to be unrolled.
    const UNROLLED: bool;
    /// Coefficients that a row has room for.
    fn room(self) -> usize;
    /// k
    fn index(self) -> usize;
}

/// An order known to the compiler, on rows for [`super::MAX_ORDER`].
#[derive(Clone, Copy)]
pub struct At<const K: usize>;

impl<const K: usize> Order for At<K> {
    const UNROLLED: bool = true;
    #[inline(always)]
    fn room(self) -> usize {
        super::MAX_ORDER + 1
    }
    #[inline(always)]
    fn index(self) -> usize {
        K
    }
}

/// An order known when the program runs.
#[derive(Clone, Copy)]
pub struct Running {
    /// Coefficients that a row has room for.
    pub room: usize,
    /// k
    pub index: usize,
}

impl Order for Running {
    const UNROLLED: bool = false;
    #[inline(always)]
    fn room(self) -> usize {
        self.room
    }
    #[inline(always)]
    fn index(self) -> usize {
        self.index
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
        row(Row { tape: self, row: i })
    }

    #[inline(always)]
    fn get(&self, row: usize, j: usize) -> E {
        self.memory[row * self.order.room() + j].get()
    }

    #[inline(always)]
    fn set(&self, row: usize, j: usize, x: E) {
        self.memory[row * self.order.room() + j].set(x);
    }

    #[inline(always)]
    fn allocate(&self) -> usize {
        let row = self.next.get();
        self.next.set(row + 1);
        row
    }
}

/// A row on a tape.
pub struct Row<'t, E, O> {
    tape: &'t Tape<'t, E, O>,
    row: usize,
}

impl<E, O> Clone for Row<'_, E, O> {
    #[inline(always)]
    fn clone(&self) -> Self {
        *self
    }
}
impl<E, O> Copy for Row<'_, E, O> {}

impl<'t, E: Element, O: Order> Row<'t, E, O> {
    /// A new row on the same tape.
    #[inline(always)]
    fn another(self) -> Self {
        let row = self.tape.allocate();
        Row { row, ..self }
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
    fn coefficients(self) -> &'t [Cell<E>] {
        let room = self.tape.order.room();
        &self.tape.memory[self.row * room..][..room]
    }

    /// The newest coefficient.
    #[inline(always)]
    pub(super) fn newest(self) -> E {
        self.get(self.order())
    }

    /// Puts down the newest coefficient.
    #[inline(always)]
    fn put(self, x: E) -> Self {
        self.tape.set(self.row, self.order(), x);
        self
    }

    #[inline(always)]
    pub(super) fn mapped(self, x: E) -> Self {
        self.another().put(x)
    }

    /// sum of a_j b_(k-j) over 0 < j < k. From the middle outward, so that the newest coefficients come last and nobody waits
    /// for them; in two sums, which the processor forms side by side.
    #[inline(always)]
    fn inner_product(self, other: Self) -> E {
        let k = self.order();
        let zero = self.get(0).like(0.0);
        let (mut left, mut right) = (zero, zero);
        if !O::UNROLLED {
            // Four sums side by side: one or two would wait for each other.
            let (a, b) = (&self.coefficients()[..k], &other.coefficients()[..k]);
            let (mut third, mut fourth) = (zero, zero);
            let (mut i, mut j) = (1, k.saturating_sub(1));
            while i + 3 < k {
                left = a[i].get().mul_add(b[j].get(), left);
                right = a[i + 1].get().mul_add(b[j - 1].get(), right);
                third = a[i + 2].get().mul_add(b[j - 2].get(), third);
                fourth = a[i + 3].get().mul_add(b[j - 3].get(), fourth);
                i += 4;
                j -= 4;
            }
            while i < k {
                left = a[i].get().mul_add(b[j].get(), left);
                i += 1;
                j -= 1;
            }
            return (left + right) + (third + fourth);
        }
        let mut i = k / 2;
        while i >= 1 {
            left = self.get(i).mul_add(other.get(k - i), left);
            if 2 * i != k {
                right = self.get(k - i).mul_add(other.get(i), right);
            }
            i -= 1;
        }
        left + right
    }

    /// The sums of a_(k-j) f_j and of a_(k-j) g_j over 0 < j < k, likewise: every a_j is read but once.
    #[inline(always)]
    fn inner_products(self, f: Self, g: Self) -> (E, E) {
        if !O::UNROLLED {
            let k = self.order();
            let zero = self.get(0).like(0.0);
            let (a, f, g) = (
                &self.coefficients()[..k],
                &f.coefficients()[..k],
                &g.coefficients()[..k],
            );
            let (mut left, mut right) = ((zero, zero), (zero, zero));
            let (mut i, mut j) = (1, k.saturating_sub(1));
            while i + 1 < k {
                let (x, y) = (a[j].get(), a[j - 1].get());
                left.0 = x.mul_add(f[i].get(), left.0);
                left.1 = x.mul_add(g[i].get(), left.1);
                right.0 = y.mul_add(f[i + 1].get(), right.0);
                right.1 = y.mul_add(g[i + 1].get(), right.1);
                i += 2;
                j -= 2;
            }
            if i < k {
                left.0 = a[j].get().mul_add(f[i].get(), left.0);
                left.1 = a[j].get().mul_add(g[i].get(), left.1);
            }
            return (left.0 + right.0, left.1 + right.1);
        }
        let k = self.order();
        let zero = self.get(0).like(0.0);
        let (mut left, mut right) = ((zero, zero), (zero, zero));
        let mut i = k / 2;
        while i >= 1 {
            let a = self.get(i);
            left.0 = a.mul_add(f.get(k - i), left.0);
            left.1 = a.mul_add(g.get(k - i), left.1);
            if 2 * i != k {
                let a = self.get(k - i);
                right.0 = a.mul_add(f.get(i), right.0);
                right.1 = a.mul_add(g.get(i), right.1);
            }
            i -= 1;
        }
        (left.0 + right.0, left.1 + right.1)
    }

    // In what follows the newest coefficient of the argument, which is known last, enters by one multiplication at the end:
    // the next order waits for that chain.

    /// (a b)_k
    #[inline(always)]
    pub(super) fn product(self, other: Self) -> Self {
        let k = self.order();
        let result = self.another();
        if k == 0 {
            return result.put(self.get(0) * other.get(0));
        }
        let sum = self.inner_product(other);
        let sum = self.get(0).mul_add(other.get(k), sum);
        result.put(self.get(k).mul_add(other.get(0), sum))
    }

    /// q = a / b from a = q b: b_0 q_k = a_k - sum of b_j q_(k-j) over 0 < j <= k.
    #[inline(always)]
    pub(super) fn quotient(self, other: Self) -> Self {
        let k = self.order();
        // The first coefficients of this row are 1 / b_0 and -q_0 / b_0.
        let inverse = other.another();
        let q = self.another();
        if k == 0 {
            let one_over = other.get(0).like(1.0) / other.get(0);
            let first = self.get(0) / other.get(0);
            inverse.put(one_over);
            inverse.tape.set(inverse.row, 1, -(first * one_over));
            return q.put(first);
        }
        let rest = (self.get(k) - q.inner_product(other)) * inverse.get(0);
        q.put(other.get(k).mul_add(inverse.get(1), rest))
    }

    /// j a_j as a row of its own, whose first coefficient is free.
    #[inline(always)]
    fn slopes(self) -> Self {
        let k = self.order();
        let slopes = self.another();
        if k > 0 {
            slopes.put(self.get(k) * self.get(k).like(k as f64));
        }
        slopes
    }

    /// 1/k
    #[inline(always)]
    fn one_over_order(self) -> E {
        let x = self.get(0);
        x.like(1.0) / x.like(self.order() as f64)
    }

    /// e = exp a from e' = e a'.
    #[inline(always)]
    pub(super) fn exponential(self) -> Self {
        let k = self.order();
        let slopes = self.slopes();
        let e = self.another();
        if k == 0 {
            return e.put(self.get(0).exp());
        }
        let rest = slopes.inner_product(e) * self.one_over_order();
        e.put(self.get(k).mul_add(e.get(0), rest))
    }

    /// s = sinh a, c = cosh a from s' = c a', c' = s a'.
    #[inline(always)]
    pub(super) fn hyperbolic(self) -> (Self, Self) {
        let k = self.order();
        let slopes = self.slopes();
        let (s, c) = (self.another(), self.another());
        if k == 0 {
            let (sinh, cosh) = self.get(0).sinh_cosh();
            return (s.put(sinh), c.put(cosh));
        }
        let (of_c, of_s) = slopes.inner_products(c, s);
        let (new, one_over) = (self.get(k), self.one_over_order());
        (
            s.put(new.mul_add(c.get(0), of_c * one_over)),
            c.put(new.mul_add(s.get(0), of_s * one_over)),
        )
    }

    /// l = ln a from a l' = a': a_0 k l_k = k a_k - sum of a_(k-j) j l_j over 0 < j < k.
    #[inline(always)]
    pub(super) fn logarithm(self) -> Self {
        let k = self.order();
        let l = self.another();
        // The first coefficient of this row is 1 / a_0.
        let slopes = self.another();
        if k == 0 {
            slopes.put(self.get(0).like(1.0) / self.get(0));
            return l.put(self.get(0).ln());
        }
        let sum = slopes.inner_product(self);
        let one_over = slopes.get(0);
        let rest = sum * -(self.one_over_order() * one_over);
        let new = self.get(k).mul_add(one_over, rest);
        slopes.put(new * new.like(k as f64));
        l.put(new)
    }

    /// y = a^p from a y' = p a' y: k a_0 y_k = sum of (p (k-j) - j) a_(k-j) y_j over 0 <= j < k
    ///                                      = p k sum a_(k-j) y_j - (1+p) sum a_(k-j) j y_j.
    #[inline(always)]
    pub(super) fn power(self, p: f64) -> Self {
        let k = self.order();
        let y = self.another();
        // The first coefficient of this row is 1 / a_0.
        let slopes = self.another();
        let a0 = self.get(0);
        if k == 0 {
            slopes.put(a0.like(1.0) / a0);
            return y.put(a0.powf(p));
        }
        let (plain, weighted) = self.inner_products(y, slopes);
        let one_over = slopes.get(0);
        let p_over = a0.like(p) * one_over;
        let one_and_p = a0.like_exact(DoubleDouble::of_finite(1.0, p)) * self.one_over_order();
        let rest = weighted.mul_add(-(one_and_p * one_over), plain * p_over);
        let new = self.get(k).mul_add(y.get(0) * p_over, rest);
        slopes.put(new * new.like(k as f64));
        y.put(new)
    }

    /// The constant x as a row of its own.
    #[inline(always)]
    pub(super) fn constant_series(self, x: E) -> Self {
        self.mapped(if self.order() == 0 { x } else { x.like(0.0) })
    }

    /// a / x. Beyond the first coefficient by the inverse, which is the same at all orders: divisions take long.
    #[inline(always)]
    pub(super) fn over(self, x: E) -> Self {
        let new = self.newest();
        if self.order() == 0 {
            return self.mapped(new / x);
        }
        self.mapped(new * (x.like(1.0) / x))
    }

    /// a + x
    #[inline(always)]
    pub(super) fn plus(self, x: E) -> Self {
        let new = if self.order() == 0 {
            self.get(0) + x
        } else {
            self.newest()
        };
        self.mapped(new)
    }
}

/// A series, at the order of its tape.
///
/// A record and no enumeration: with a place of its own for every field the compiler sees through it.
pub struct Series<'t, E, O> {
    tape: Option<&'t Tape<'t, E, O>>,
    row: usize,
    value: Option<E>,
    exact: DoubleDouble,
    literal: bool,
}

/// What a series is.
pub(super) enum Kind<'t, E, O> {
    /// A constant in the program's text: what it is the compiler knows.
    Literal(f64),
    /// A constant of 31 digits.
    Exact(DoubleDouble),
    /// A constant.
    Value(E),
    /// A series on a tape.
    Row(Row<'t, E, O>),
}

use Kind::{Exact, Value};

impl<E, O> Kind<'_, E, O> {
    /// The same, and no literal any more.
    #[inline(always)]
    pub(super) fn released(self) -> Self {
        match self {
            Kind::Literal(x) => Exact(DoubleDouble::from(x)),
            other => other,
        }
    }
}

impl<E: Copy, O> Clone for Series<'_, E, O> {
    #[inline(always)]
    fn clone(&self) -> Self {
        *self
    }
}
impl<E: Copy, O> Copy for Series<'_, E, O> {}

impl<E: fmt::Debug, O> fmt::Debug for Series<'_, E, O> {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(
            f,
            "row {} or {:?} or {:?}",
            self.row, self.value, self.exact
        )
    }
}

#[inline(always)]
pub(super) fn exact<'t, E, O>(x: DoubleDouble) -> Series<'t, E, O> {
    Series {
        tape: None,
        row: 0,
        value: None,
        exact: x,
        literal: false,
    }
}
#[inline(always)]
pub(super) fn literal<'t, E, O>(x: f64) -> Series<'t, E, O> {
    Series {
        tape: None,
        row: 0,
        value: None,
        exact: DoubleDouble::from(x),
        literal: true,
    }
}
/// A constant, which may differ from lane to lane.
#[inline(always)]
pub fn value<'t, E, O>(x: E) -> Series<'t, E, O> {
    Series {
        tape: None,
        row: 0,
        value: Some(x),
        exact: DoubleDouble::ZERO,
        literal: false,
    }
}
#[inline(always)]
pub(super) fn row<'t, E, O>(x: Row<'t, E, O>) -> Series<'t, E, O> {
    Series {
        tape: Some(x.tape),
        row: x.row,
        value: None,
        exact: DoubleDouble::ZERO,
        literal: false,
    }
}

impl<'t, E: Element, O: Order> Series<'t, E, O> {
    #[inline(always)]
    pub(super) fn kind(self) -> Kind<'t, E, O> {
        if let Some(tape) = self.tape {
            Kind::Row(Row {
                tape,
                row: self.row,
            })
        } else if let Some(x) = self.value {
            Value(x)
        } else if self.literal {
            Kind::Literal(self.exact.hi())
        } else {
            Exact(self.exact)
        }
    }

    /// The coefficient at the order of the tape.
    #[inline(always)]
    pub fn newest(self, like: E, order: O) -> E {
        let constant = |x: E| if order.index() == 0 { x } else { x.like(0.0) };
        match self.kind() {
            Exact(x) => constant(like.like_exact(x)),
            Value(x) => constant(x),
            Kind::Literal(x) => constant(like.like(x)),
            Kind::Row(row) => row.newest(),
        }
    }

    /// The sum over the interfaces that are lanes of the coefficients.
    #[inline(always)]
    pub fn over_interfaces(self) -> Self {
        match self.kind() {
            Kind::Row(a) => row(a.mapped(a.newest().over_interfaces())),
            _ => self,
        }
    }

    /// The row that it stands in, if it is no constant.
    #[inline(always)]
    pub(super) fn row(self) -> Option<usize> {
        if self.tape.is_some() {
            Some(self.row)
        } else {
            None
        }
    }
}
