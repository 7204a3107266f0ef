//! The arithmetic of [`Series`], so that any formula can be evaluated in them.

use super::element::Element;
use super::tape::{Kind, Order, Series, exact, literal, row, value};
use crate::number::Real;
use Kind::{Exact, Literal, Row, Value};
use std::ops::{Add, Div, Mul, Neg, Sub};

impl<E: Element, O: Order> Neg for Series<'_, E, O> {
    type Output = Self;
    #[inline(always)]
    fn neg(self) -> Self {
        match self.kind() {
            Literal(x) => literal(-x),
            Exact(x, y) => exact(-x, -y),
            Value(x) => value(-x),
            Row(a) => row(a.mapped(-a.newest())),
        }
    }
}

impl<E: Element, O: Order> Add for Series<'_, E, O> {
    type Output = Self;
    #[inline(always)]
    fn add(self, other: Self) -> Self {
        match (self.kind(), other.kind()) {
            (Literal(0.0), _) => other,
            (_, Literal(0.0)) => self,
            (a, b) => match (a.released(), b.released()) {
                // What is exactly zero costs nothing.
                (Row(a), Row(b)) => row(a.mapped(a.newest() + b.newest())),
                (Row(a), Value(x)) | (Value(x), Row(a)) => row(a.plus(x)),
                (Row(a), Exact(x, y)) | (Exact(x, y), Row(a)) => {
                    row(a.plus(a.newest().like_sum(x, y)))
                }
                (Value(x), Value(y)) => value(x + y),
                (Value(x), Exact(y, z)) | (Exact(y, z), Value(x)) => value(x + x.like_sum(y, z)),
                (Exact(x, y), Exact(z, w)) => exact_sum(x, y + w, z),
                _ => unreachable!("released"),
            },
        }
    }
}

/// (x + z) + y
#[inline(always)]
fn exact_sum<'t, E, O>(x: f64, y: f64, z: f64) -> Series<'t, E, O> {
    let sum = x + z;
    let x_part = sum - z;
    let error = (x - x_part) + (z - (sum - x_part));
    exact(sum, error + y)
}

impl<E: Element, O: Order> Sub for Series<'_, E, O> {
    type Output = Self;
    #[inline(always)]
    fn sub(self, other: Self) -> Self {
        match (self.kind(), other.kind()) {
            (_, Literal(0.0)) => self,
            (a, b) => match (a.released(), b.released()) {
                (Row(a), Row(b)) => row(a.mapped(a.newest() - b.newest())),
                (Row(_), _) => self + -other,
                (Value(x), Row(a)) => {
                    let x = if a.order() == 0 { x } else { x.like(0.0) };
                    row(a.mapped(x - a.newest()))
                }
                (Exact(x, y), Row(a)) => {
                    let new = a.newest();
                    row(a.mapped(if a.order() == 0 {
                        new.like_sum(x, y) - new
                    } else {
                        -new
                    }))
                }
                (_, _) => self + -other,
            },
        }
    }
}

impl<E: Element, O: Order> Mul for Series<'_, E, O> {
    type Output = Self;
    #[inline(always)]
    fn mul(self, other: Self) -> Self {
        match (self.kind(), other.kind()) {
            (Literal(0.0), _) | (_, Literal(0.0)) => exact(0.0, 0.0),
            (Literal(1.0), _) => other,
            (_, Literal(1.0)) => self,
            (Literal(-1.0), _) => -other,
            (_, Literal(-1.0)) => -self,
            (a, b) => match (a.released(), b.released()) {
                (Row(a), Row(b)) => row(a.product(b)),
                (Row(a), Value(x)) | (Value(x), Row(a)) => row(a.mapped(a.newest() * x)),
                (Row(a), Exact(x, y)) | (Exact(x, y), Row(a)) => {
                    let new = a.newest();
                    row(a.mapped(new * new.like_sum(x, y)))
                }
                (Value(x), Value(y)) => value(x * y),
                (Value(x), Exact(y, z)) | (Exact(y, z), Value(x)) => value(x * x.like_sum(y, z)),
                (Exact(x, y), Exact(z, w)) => exact((x + y) * (z + w), 0.0),
                _ => unreachable!("released"),
            },
        }
    }
}

impl<E: Element, O: Order> Div for Series<'_, E, O> {
    type Output = Self;
    #[inline(always)]
    fn div(self, other: Self) -> Self {
        match (self.kind(), other.kind()) {
            (Literal(0.0), _) => exact(0.0, 0.0),
            (a, b) => match (a.released(), b.released()) {
                (Row(a), Row(b)) => row(a.quotient(b)),
                (Value(x), Row(b)) => row(b.constant_series(x).quotient(b)),
                (Exact(x, y), Row(b)) => {
                    let x = b.newest().like_sum(x, y);
                    row(b.constant_series(x).quotient(b))
                }
                (Row(a), Value(x)) => row(a.mapped(a.newest() / x)),
                (Row(a), Exact(x, y)) => {
                    let new = a.newest();
                    row(a.mapped(new / new.like_sum(x, y)))
                }
                (Value(x), Value(y)) => value(x / y),
                (Value(x), Exact(y, z)) => value(x / x.like_sum(y, z)),
                (Exact(x, y), Value(z)) => value(z.like_sum(x, y) / z),
                (Exact(x, y), Exact(z, w)) => exact((x + y) / (z + w), 0.0),
                _ => unreachable!("released"),
            },
        }
    }
}

impl<E: Element, O: Order> Add<f64> for Series<'_, E, O> {
    type Output = Self;
    #[inline(always)]
    fn add(self, x: f64) -> Self {
        match self.kind().released() {
            Exact(y, z) => exact_sum(y, z, x),
            Value(y) => value(y + y.like(x)),
            Literal(_) => unreachable!("released"),
            Row(a) => row(a.plus(a.newest().like(x))),
        }
    }
}

impl<E: Element, O: Order> Sub<f64> for Series<'_, E, O> {
    type Output = Self;
    #[inline(always)]
    fn sub(self, x: f64) -> Self {
        self + -x
    }
}

impl<E: Element, O: Order> Mul<f64> for Series<'_, E, O> {
    type Output = Self;
    #[inline(always)]
    fn mul(self, x: f64) -> Self {
        match self.kind().released() {
            Exact(y, z) => exact((y + z) * x, 0.0),
            Value(y) => value(y * y.like(x)),
            Literal(_) => unreachable!("released"),
            Row(a) => row(a.mapped(a.newest() * a.newest().like(x))),
        }
    }
}

impl<E: Element, O: Order> Div<f64> for Series<'_, E, O> {
    type Output = Self;
    #[inline(always)]
    fn div(self, x: f64) -> Self {
        match self.kind().released() {
            Exact(y, z) => exact((y + z) / x, 0.0),
            Value(y) => value(y / y.like(x)),
            Literal(_) => unreachable!("released"),
            Row(a) => row(a.mapped(a.newest() / a.newest().like(x))),
        }
    }
}

/// A function of a series: that of a number on constants, that of a row on rows.
macro_rules! functions {
    ($($name:ident: |$x:ident| $of_constant:expr, |$a:ident| $of_row:expr;)*) => {
        $(
            #[inline(always)]
            fn $name(self) -> Self {
                match self.kind() {
                    Literal($x) => exact($of_constant, 0.0),
                    Exact(x, y) => { let $x = x + y; exact($of_constant, 0.0) }
                    Value($x) => value($of_constant),
                    Row($a) => row($of_row),
                }
            }
        )*
    };
}

impl<E: Element, O: Order> Real for Series<'_, E, O> {
    #[inline(always)]
    fn constant(x: f64) -> Self {
        literal(x)
    }

    #[inline(always)]
    fn leading(self) -> f64 {
        match self.kind() {
            Literal(x) | Exact(x, _) => x,
            Value(x) => x.first(),
            Row(a) => a.get(0).first(),
        }
    }

    functions! {
        exp: |x| Element::exp(x), |a| a.exponential();
        ln: |x| Element::ln(x), |a| a.logarithm();
        sinh: |x| Element::sinh_cosh(x).0, |a| a.hyperbolic().0;
        cosh: |x| Element::sinh_cosh(x).1, |a| a.hyperbolic().1;
        abs: |x| Element::abs(x), |a| a.mapped(a.newest() * a.get(0).sign());
    }

    #[inline(always)]
    fn powf(self, p: f64) -> Self {
        match self.kind() {
            Literal(x) => exact(x.powf(p), 0.0),
            Exact(x, y) => exact((x + y).powf(p), 0.0),
            Value(x) => value(x.powf(p)),
            Row(a) => row(a.power(p)),
        }
    }

    // The others are made of these; near 0 they cancel, as the laws' own formulas never do.
    #[inline(always)]
    fn exp_m1(self) -> Self {
        self.exp() - 1.0
    }
    #[inline(always)]
    fn ln_1p(self) -> Self {
        (self + 1.0).ln()
    }
    #[inline(always)]
    fn sqrt(self) -> Self {
        self.powf(0.5)
    }
    #[inline(always)]
    fn asinh(self) -> Self {
        (self + (self * self + 1.0).sqrt()).ln()
    }
}
