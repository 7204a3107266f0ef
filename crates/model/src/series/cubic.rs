//! Third-order jets: polynomials of the third degree in two variations, what a flow map is around a solution.

use super::element::{Element, balanced, rough_exp2, rough_log2};
use crate::number::{Balance, DoubleDouble, Real};
use pulp::NullaryFnOnce;
use std::ops::{Add, Div, Mul, Neg, Sub};

/// The coefficients of 1, s, t, s^2, s t, t^2, s^3, s^2 t, s t^2, t^3; all of higher degree are left out. Choices and rough
/// functions, which step sizes are made of, go by the first.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct Jet3(pub [f64; 10]);

impl Jet3 {
    /// A number that does not vary.
    pub fn constant(x: f64) -> Self {
        let mut c = [0.0; 10];
        c[0] = x;
        Jet3(c)
    }

    /// x + a s + b t
    pub fn linear(x: f64, [a, b]: [f64; 2]) -> Self {
        let mut c = [0.0; 10];
        c[..3].copy_from_slice(&[x, a, b]);
        Jet3(c)
    }

    /// The value without the variations.
    pub fn value(self) -> f64 {
        self.0[0]
    }

    /// The value at (s, t).
    pub fn at(self, s: f64, t: f64) -> f64 {
        let c = self.0;
        let [first, second] = [
            s * c[1] + t * c[2],
            s * s * c[3] + s * t * c[4] + t * t * c[5],
        ];
        let third = s * s * (s * c[6] + t * c[7]) + t * t * (s * c[8] + t * c[9]);
        c[0] + (first + (second + third))
    }

    /// x times all.
    pub fn scaled(self, x: f64) -> Self {
        Jet3(self.0.map(|c| c * x))
    }

    /// g(self), from g, g', g''/2 and g'''/6 at the value.
    #[inline(never)]
    fn composed(self, [g, first, second, third]: [f64; 4]) -> Self {
        let mut change = self;
        change.0[0] = 0.0;
        let of = Self::constant;
        ((change.scaled(third) + of(second)) * change + of(first)) * change + of(g)
    }

    fn zip(mut self, o: Self, f: impl Fn(f64, f64) -> f64) -> Self {
        for (x, y) in self.0.iter_mut().zip(o.0) {
            *x = f(*x, y);
        }
        self
    }
}

impl Neg for Jet3 {
    type Output = Self;
    #[inline]
    fn neg(self) -> Self {
        self.scaled(-1.0)
    }
}

impl Add for Jet3 {
    type Output = Self;
    #[inline]
    fn add(self, o: Self) -> Self {
        self.zip(o, |x, y| x + y)
    }
}

impl Sub for Jet3 {
    type Output = Self;
    #[inline]
    fn sub(self, o: Self) -> Self {
        self.zip(o, |x, y| x - y)
    }
}

impl Mul for Jet3 {
    type Output = Self;
    #[inline]
    fn mul(self, o: Self) -> Self {
        let (a, b) = (self.0, o.0);
        let mut c = [a[0] * b[0]; 10];
        for i in 1..10 {
            c[i] = a[0] * b[i] + a[i] * b[0];
        }
        c[3] += a[1] * b[1];
        c[4] += a[1] * b[2] + a[2] * b[1];
        c[5] += a[2] * b[2];
        for (p, q) in [(&a, &b), (&b, &a)] {
            c[6] += p[1] * q[3];
            c[7] += p[1] * q[4] + p[2] * q[3];
            c[8] += p[1] * q[5] + p[2] * q[4];
            c[9] += p[2] * q[5];
        }
        Jet3(c)
    }
}

impl Div for Jet3 {
    type Output = Self;
    #[allow(clippy::suspicious_arithmetic_impl)]
    #[inline(never)]
    fn div(self, o: Self) -> Self {
        let r = 1.0 / o.0[0];
        // Of a constant near 0 the powers overflow.
        if o == Self::constant(o.0[0]) {
            return Jet3(self.0.map(|c| c / o.0[0]));
        }
        self * o.composed([r, -r * r, r * r * r, -r * r * r * r])
    }
}

impl Element for Jet3 {
    type Two = ();
    const LANES: usize = 1;
    #[inline(never)]
    fn run<F: NullaryFnOnce>(self, f: F) -> F::Output {
        f.call()
    }
    fn like(self, x: f64) -> Self {
        Self::constant(x)
    }
    fn to_exact(self) -> DoubleDouble {
        DoubleDouble::from(self.0[0])
    }
    fn scale(self, x: DoubleDouble) -> Self {
        self.scaled(x.hi())
    }
    #[inline]
    fn mul_add(self, a: Self, b: Self) -> Self {
        self * a + b
    }
    fn abs(self) -> Self {
        self.scaled(1_f64.copysign(self.0[0]))
    }
    fn max(self, o: Self) -> Self {
        if self.0[0] > o.0[0] { self } else { o }
    }
    fn min(self, o: Self) -> Self {
        if self.0[0] < o.0[0] { self } else { o }
    }
    fn sign(self) -> Self {
        Self::constant(1_f64.copysign(self.0[0]))
    }
    fn rough_log2(self) -> Self {
        Self::constant(rough_log2(self.0[0]))
    }
    fn rough_exp2(self) -> Self {
        Self::constant(rough_exp2(self.0[0]))
    }
    #[inline(never)]
    fn exp(self) -> Self {
        let e = self.0[0].exp();
        self.composed([e, e, e / 2.0, e / 6.0])
    }
    #[inline(never)]
    fn exp_m1(self) -> Self {
        let e = self.0[0].exp();
        self.composed([self.0[0].exp_m1(), e, e / 2.0, e / 6.0])
    }
    #[inline(never)]
    fn ln(self) -> Self {
        let r = 1.0 / self.0[0];
        self.composed([self.0[0].ln(), r, -r * r / 2.0, r * r * r / 3.0])
    }
    #[inline(never)]
    fn ln_1p(self) -> Self {
        let r = 1.0 / (1.0 + self.0[0]);
        self.composed([self.0[0].ln_1p(), r, -r * r / 2.0, r * r * r / 3.0])
    }
    #[inline(never)]
    fn powf(self, p: f64) -> Self {
        let r = 1.0 / self.0[0];
        let power = self.0[0].powf(p);
        let first = p * power * r;
        let second = (p - 1.0) * first * r / 2.0;
        self.composed([power, first, second, (p - 2.0) * second * r / 3.0])
    }
    #[inline(never)]
    fn sinh_cosh(self) -> (Self, Self) {
        let (s, c) = Real::sinh_cosh(self.0[0]);
        (
            self.composed([s, c, s / 2.0, c / 6.0]),
            self.composed([c, s, c / 2.0, s / 6.0]),
        )
    }
    #[inline(never)]
    fn sin_cos(self) -> (Self, Self) {
        let (s, c) = self.0[0].sin_cos();
        (
            self.composed([s, c, -s / 2.0, -c / 6.0]),
            self.composed([c, -s, -c / 2.0, s / 6.0]),
        )
    }
    #[inline(never)]
    fn atan(self) -> Self {
        // atan' = r, atan'' = -2 x r^2, atan''' = (6 x^2 - 2) r^3, r = 1 / (1 + x^2)
        let x = self.0[0];
        let r = 1.0 / (1.0 + x * x);
        let third = (6.0 * x * x - 2.0) * r * r * r;
        self.composed([x.atan(), r, -x * r * r, third / 6.0])
    }
    #[inline(never)]
    fn tanh(self) -> Self {
        // tanh' = u, tanh'' = -2 y u, tanh''' = (6 y^2 - 2) u, u = 1 - y^2
        let y = self.0[0].tanh();
        let u = 1.0 - y * y;
        self.composed([y, u, -y * u, (6.0 * y * y - 2.0) * u / 6.0])
    }
    fn balanced(self, g: Balance<Self>) -> (Self, Self) {
        balanced(self, g, 2)
    }
    #[inline(never)]
    fn asinh(self) -> Self {
        // asinh' = r, asinh'' = -x r^3, asinh''' = (2 x^2 - 1) r^5, r = 1 / sqrt(1 + x^2)
        let x = self.0[0];
        let r = 1.0 / 1_f64.hypot(x);
        let third = (2.0 * x * x - 1.0) * r.powi(5);
        let value = Real::asinh(x);
        self.composed([value, r, -0.5 * x * r.powi(3), third / 6.0])
    }
    fn if_negative(self, a: Self, b: Self) -> Self {
        if self.0[0] < 0.0 { a } else { b }
    }
    fn if_zero(self, a: Self, b: Self) -> Self {
        if self.0 == [0.0; 10] { a } else { b }
    }
    fn all_positive(self) -> bool {
        self.0[0] > 0.0 && self.0[0] < f64::INFINITY
    }
    fn all_finite(self) -> bool {
        self.0.iter().all(|c| c.is_finite())
    }
    fn first(self) -> f64 {
        self.0[0]
    }
    fn lane(self, _: usize) -> f64 {
        self.0[0]
    }
    fn with_lane(self, _: usize, x: f64) -> Self {
        Self::constant(x)
    }
    fn largest_lane(self) -> f64 {
        self.0[0]
    }
}
