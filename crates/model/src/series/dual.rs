//! Numbers with derivatives in several directions, as coefficients of series.
//!
//! A formula evaluated on series of these yields the solution of its variational equations along with its own: no second set
//! of recurrences is needed. The directions stand in lanes.

use super::element::{Element, balanced};
use crate::number::Balance;
use pulp::NullaryFnOnce;
use std::ops::{Add, Div, Mul, Neg, Sub};

/// A number, and its derivatives in the lanes of X. Choices and rough functions, which step sizes are made of, go by the
/// number alone.
#[derive(Debug, Clone, Copy)]
pub struct Dual<X> {
    /// The number.
    pub value: f64,
    /// Its derivatives.
    pub gradient: X,
}

impl<X: Element> Dual<X> {
    /// x in every lane.
    #[inline(always)]
    fn spread(self, x: f64) -> X {
        self.gradient.like(x)
    }

    /// g(self), from g and dg/dx at the value (chain rule).
    #[inline(always)]
    fn chain(self, value: f64, slope: f64) -> Self {
        Dual {
            value,
            gradient: self.gradient * self.spread(slope),
        }
    }

    /// A constant.
    #[inline(always)]
    fn constant(self, value: f64) -> Self {
        Dual {
            value,
            gradient: self.gradient.like(0.0),
        }
    }
}

impl<X: Element> Neg for Dual<X> {
    type Output = Self;
    #[inline(always)]
    fn neg(self) -> Self {
        Dual {
            value: -self.value,
            gradient: -self.gradient,
        }
    }
}

impl<X: Element> Add for Dual<X> {
    type Output = Self;
    #[inline(always)]
    fn add(self, o: Self) -> Self {
        Dual {
            value: self.value + o.value,
            gradient: self.gradient + o.gradient,
        }
    }
}

impl<X: Element> Sub for Dual<X> {
    type Output = Self;
    #[inline(always)]
    fn sub(self, o: Self) -> Self {
        Dual {
            value: self.value - o.value,
            gradient: self.gradient - o.gradient,
        }
    }
}

impl<X: Element> Mul for Dual<X> {
    type Output = Self;
    #[inline(always)]
    fn mul(self, o: Self) -> Self {
        let of_other = o.gradient * self.spread(self.value);
        Dual {
            value: self.value * o.value,
            gradient: self.gradient.mul_add(self.spread(o.value), of_other),
        }
    }
}

impl<X: Element> Div for Dual<X> {
    type Output = Self;
    #[inline(always)]
    fn div(self, o: Self) -> Self {
        let quotient = self.value / o.value;
        let of_other = o.gradient * self.spread(quotient);
        let one_over = 1.0 / o.value;
        Dual {
            value: quotient,
            gradient: (self.gradient - of_other) * self.spread(one_over),
        }
    }
}

/// Functions by their values and slopes.
macro_rules! functions {
    ($($name:ident: |$x:ident| $slope:expr;)*) => {
        $(
            #[inline(always)]
            fn $name(self) -> Self {
                let $x = self.value;
                self.chain($x.$name(), $slope)
            }
        )*
    };
}

impl<X: Element> Element for Dual<X> {
    type Two = ();
    const LANES: usize = 1;
    const CALLED: bool = true;
    #[inline(always)]
    fn like(self, x: f64) -> Self {
        self.constant(x)
    }
    #[inline(always)]
    fn plain(self) -> Self {
        self.constant(self.value)
    }
    #[inline(always)]
    fn run<F: NullaryFnOnce>(self, f: F) -> F::Output {
        self.gradient.run(f)
    }
    #[inline(always)]
    fn mul_add(self, a: Self, b: Self) -> Self {
        let of_other = a.gradient.mul_add(self.spread(self.value), b.gradient);
        Dual {
            value: self.value.mul_add(a.value, b.value),
            gradient: self.gradient.mul_add(self.spread(a.value), of_other),
        }
    }
    functions! {
        abs: |x| x.sign();
        exp: |x| x.exp();
        exp_m1: |x| x.exp();
        ln: |x| 1.0 / x;
        ln_1p: |x| 1.0 / (x + 1.0);
        atan: |x| 1.0 / (x * x + 1.0);
        tanh: |x| 1.0 - x.tanh() * x.tanh();
    }
    #[inline(always)]
    fn balanced(self, g: Balance<Self>) -> (Self, Self) {
        balanced(self, g, 1)
    }
    #[inline(always)]
    fn powf(self, p: f64) -> Self {
        let power = self.value.powf(p);
        self.chain(power, power / self.value * p)
    }
    #[inline(always)]
    fn sinh_cosh(self) -> (Self, Self) {
        let (sinh, cosh) = self.value.sinh_cosh();
        (self.chain(sinh, cosh), self.chain(cosh, sinh))
    }
    #[inline(always)]
    fn sin_cos(self) -> (Self, Self) {
        let (sin, cos) = self.value.sin_cos();
        (self.chain(sin, cos), self.chain(cos, -sin))
    }
    #[inline(always)]
    fn max(self, o: Self) -> Self {
        if (o.value - self.value).first() < 0.0 {
            self
        } else {
            o
        }
    }
    #[inline(always)]
    fn min(self, o: Self) -> Self {
        if (self.value - o.value).first() < 0.0 {
            self
        } else {
            o
        }
    }
    #[inline(always)]
    fn sign(self) -> Self {
        self.constant(self.value.sign())
    }
    #[inline(always)]
    fn rough_log2(self) -> Self {
        self.constant(self.value.rough_log2())
    }
    #[inline(always)]
    fn rough_exp2(self) -> Self {
        self.constant(self.value.rough_exp2())
    }
    #[inline(always)]
    fn if_negative(self, a: Self, b: Self) -> Self {
        if self.value.first() < 0.0 { a } else { b }
    }
    // Of a number that has overflown in one derivative only, this is none of 0 times it.
    #[inline(always)]
    fn if_zero(self, a: Self, b: Self) -> Self {
        if self.value.first() == 0.0 && self.gradient.all_finite() {
            a
        } else {
            b
        }
    }
    #[inline(always)]
    fn all_positive(self) -> bool {
        self.value.all_positive()
    }
    #[inline(always)]
    fn all_finite(self) -> bool {
        self.value.all_finite() && self.gradient.all_finite()
    }
    #[inline(always)]
    fn first(self) -> f64 {
        self.value.first()
    }
    #[inline(always)]
    fn lane(self, _: usize) -> f64 {
        self.value.first()
    }
    #[inline(always)]
    fn with_lane(self, _: usize, x: f64) -> Self {
        self.like(x)
    }
    #[inline(always)]
    fn largest_lane(self) -> f64 {
        self.value.first()
    }
}
