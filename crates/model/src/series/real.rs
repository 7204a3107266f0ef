//! The arithmetic of [`Series`], so that any formula can be evaluated in them.

use super::composition::ratio_coefficients;
use super::element::Element;
use super::handle::{Series, SeriesKind, exact, literal, row, value};
use super::tape::{self, Order};
use crate::number::{Balance, DoubleDouble, Ratio, Real};
use SeriesKind::{Exact, Literal, Row, Value};
use std::ops::{Add, Div, Mul, Neg, Sub};

impl<E: Element, O: Order> Neg for Series<'_, E, O> {
    type Output = Self;
    #[inline(always)]
    fn neg(self) -> Self {
        match self.kind() {
            Literal(x) => literal(-x),
            Exact(x) => exact(-x),
            Value(x) => value(-x),
            Row(a) => row(a.negative()),
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
                (Row(a), Row(b)) => row(a.sum(b)),
                (Row(a), Value(x)) | (Value(x), Row(a)) => row(a.plus(x)),
                (Row(a), Exact(x)) | (Exact(x), Row(a)) => row(a.plus(a.any().like_exact(x))),
                (Value(x), Value(y)) => value(x + y),
                (Value(x), Exact(y)) | (Exact(y), Value(x)) => value(x + x.like_exact(y)),
                (Exact(x), Exact(y)) => exact(x + y),
                _ => unreachable!("released"),
            },
        }
    }
}

impl<E: Element, O: Order> Sub for Series<'_, E, O> {
    type Output = Self;
    #[inline(always)]
    fn sub(self, other: Self) -> Self {
        match (self.kind(), other.kind()) {
            (_, Literal(0.0)) => self,
            (a, b) => match (a.released(), b.released()) {
                (Row(a), Row(b)) => row(a.difference(b)),
                (Row(_), _) => self + -other,
                (Value(x), Row(a)) => {
                    if a.order() == 0 {
                        row(a.mapped(x - a.newest()))
                    } else {
                        row(a.loose().negative())
                    }
                }
                (Exact(x), Row(a)) => {
                    if a.order() == 0 {
                        let new = a.newest();
                        row(a.mapped(new.like_exact(x) - new))
                    } else {
                        row(a.loose().negative())
                    }
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
            (Literal(0.0), _) | (_, Literal(0.0)) => literal(0.0),
            (Literal(1.0), _) => other,
            (_, Literal(1.0)) => self,
            (Literal(-1.0), _) => -other,
            (_, Literal(-1.0)) => -self,
            (a, b) => match (a.released(), b.released()) {
                (Row(a), Row(b)) => row(a.product(b)),
                (Row(a), Value(x)) | (Value(x), Row(a)) => row(a.scaled(x)),
                (Row(a), Exact(x)) | (Exact(x), Row(a)) => row(a.scaled(a.any().like_exact(x))),
                (Value(x), Value(y)) => value(x * y),
                (Value(x), Exact(y)) | (Exact(y), Value(x)) => value(x * x.like_exact(y)),
                (Exact(x), Exact(y)) => exact(x * y),
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
            (Literal(0.0), _) => literal(0.0),
            (a, Row(b)) => {
                let a = match a.released() {
                    Row(a) => a,
                    Value(x) => b.constant_series(x),
                    Exact(x) => b.constant_series(b.any().like_exact(x)),
                    Literal(_) => unreachable!("released"),
                };
                row(a.quotient(b))
            }
            (a, b) => match (a.released(), b.released()) {
                (Row(a), Value(x)) => row(a.over(x)),
                (Row(a), Exact(x)) => row(a.over(a.any().like_exact(x))),
                (Value(x), Value(y)) => value(x / y),
                (Value(x), Exact(y)) => value(x / x.like_exact(y)),
                (Exact(x), Value(y)) => value(y.like_exact(x) / y),
                (Exact(x), Exact(y)) => exact(x / y),
                _ => unreachable!("released"),
            },
        }
    }
}

impl<E: Element, O: Order> Add<f64> for Series<'_, E, O> {
    type Output = Self;
    #[inline(always)]
    fn add(self, x: f64) -> Self {
        match self.kind() {
            Literal(y) => exact(DoubleDouble::of_finite(y, x)),
            Exact(y) => exact(y + x),
            Value(y) => value(y + y.like(x)),
            Row(a) => row(a.plus(a.any().like(x))),
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
            Exact(y) => exact(y * x),
            Value(y) => value(y * y.like(x)),
            Literal(_) => unreachable!("released"),
            Row(a) => row(a.scaled(a.any().like(x))),
        }
    }
}

impl<E: Element, O: Order> Div<f64> for Series<'_, E, O> {
    type Output = Self;
    #[inline(always)]
    fn div(self, x: f64) -> Self {
        match self.kind().released() {
            Exact(y) => exact(y / x),
            Value(y) => value(y / y.like(x)),
            Literal(_) => unreachable!("released"),
            Row(a) => row(a.over(a.any().like(x))),
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
                    Literal(x) => {
                        let $x = DoubleDouble::from(x);
                        exact($of_constant)
                    }
                    Exact($x) => exact($of_constant),
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
            Literal(x) => x,
            Exact(x) => x.hi(),
            Value(x) => x.first(),
            Row(a) => a.stored().get(0).first(),
        }
    }

    functions! {
        exp: |x| Element::exp(x), |a| a.exponential();
        exp_m1: |x| Element::exp_m1(x), |a| a.exponential_less_one();
        ln: |x| Element::ln(x), |a| a.logarithm();
        ln_1p: |x| Element::ln_1p(x), |a| a.logarithm_of_one_more();
        sinh: |x| Element::sinh_cosh(x).0, |a| a.hyperbolic().0;
        cosh: |x| Element::sinh_cosh(x).1, |a| a.hyperbolic().1;
        atan: |x| Element::atan(x), |a| a.arctangent();
        tanh: |x| Element::tanh(x), |a| a.hyperbolic_tangent();
        abs: |x| Element::abs(x), |a| a.magnitude();
    }

    #[inline(always)]
    fn sinh_cosh(self) -> (Self, Self) {
        match self.kind().released() {
            Row(a) => {
                let (sinh, cosh) = a.hyperbolic();
                (row(sinh), row(cosh))
            }
            _ => (self.sinh(), self.cosh()),
        }
    }

    #[inline(always)]
    fn sin_cos(self) -> (Self, Self) {
        match self.kind().released() {
            Exact(x) => {
                let (sin, cos) = Real::sin_cos(x);
                (exact(sin), exact(cos))
            }
            Value(x) => {
                let (sin, cos) = Element::sin_cos(x);
                (value(sin), value(cos))
            }
            Row(a) => {
                let (sin, cos) = a.circular();
                (row(sin), row(cos))
            }
            Literal(_) => unreachable!("released"),
        }
    }

    #[inline(always)]
    fn powf(self, p: f64) -> Self {
        match self.kind() {
            Literal(x) => exact(Real::powf(DoubleDouble::from(x), p)),
            Exact(x) => exact(Real::powf(x, p)),
            Value(x) => value(Element::powf(x, p)),
            Row(a) => row(a.power(p)),
        }
    }

    #[inline(always)]
    fn pow(self, p: Self) -> Self {
        match p.kind() {
            Literal(p) => self.powf(p),
            _ => (p * self.ln()).exp(),
        }
    }

    #[inline(always)]
    fn sign(self) -> Self {
        match self.kind() {
            Row(a) => value(a.stored().get(0).sign()),
            _ => literal(1_f64.copysign(self.leading())),
        }
    }

    #[inline(always)]
    fn ratio(self, ratio: Ratio) -> Self {
        match self.kind().released() {
            Exact(x) => exact(Real::ratio(x, ratio)),
            Value(x) => value(ratio_coefficients(ratio, x, 1)[0]),
            Row(a) => row(a.ratio(ratio)),
            Literal(_) => unreachable!("released"),
        }
    }

    #[inline(always)]
    fn balanced(self, g: Balance<Self>) -> (Self, Self) {
        let (mut rows, mut constants): (Option<tape::Row<'_, E, O>>, _) = (None, None);
        let mut look = |x: Self| match x.kind() {
            Row(a) => rows = Some(a),
            Value(x) => constants = Some(x),
            _ => {}
        };
        look(self);
        g.map(look);
        // What is constant becomes a row where something else is one.
        if let Some(any) = rows {
            let as_row = |x: Self| match x.kind().released() {
                Row(a) => a,
                Value(x) => any.constant_series(x),
                Exact(x) => any.constant_series(any.any().like_exact(x)),
                Literal(_) => unreachable!("released"),
            };
            let (y, of_y) = as_row(self).balanced(g.map(as_row));
            return (row(y), row(of_y));
        }
        let exact_of = |x: Self| match x.kind().released() {
            Exact(x) => x,
            _ => unreachable!("no value"),
        };
        match constants {
            Some(any) => {
                let as_value = |x: Self| match x.kind().released() {
                    Value(x) => x,
                    Exact(x) => any.like_exact(x),
                    _ => unreachable!("no row"),
                };
                let (y, of_y) = as_value(self).balanced(g.map(as_value));
                (value(y), value(of_y))
            }
            None => {
                let (y, of_y) = Real::balanced(exact_of(self), g.map(exact_of));
                (exact(y), exact(of_y))
            }
        }
    }

    // The others are made of these. Near 0 asinh cancels, as the laws' own formulas never do.
    #[inline(always)]
    fn sqrt(self) -> Self {
        self.powf(0.5)
    }
    #[inline(always)]
    fn asinh(self) -> Self {
        (self + (self * self + 1.0).sqrt()).ln()
    }
}
