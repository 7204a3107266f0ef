//! What the coefficients of a series are: one number, or one in each of several lanes.

use crate::number::{Balance, DoubleDouble, Real};
use pulp::NullaryFnOnce;
use std::fmt::Debug;
use std::ops::{Add, Div, Mul, Neg, Sub};
use twinslip_kernel::{Kernel, Width};

/// A coefficient of a series.
///
/// The lanes of a pair are the two interfaces under one stress; the lanes of a batch are
/// trajectories that have nothing to do with each other.
pub trait Element:
    Copy
    + Debug
    + Neg<Output = Self>
    + Add<Output = Self>
    + Sub<Output = Self>
    + Mul<Output = Self>
    + Div<Output = Self>
{
    /// The number x in every lane. (A method of a value, since what the processor can do is known from values alone.)
    fn like(self, x: f64) -> Self;
    /// The same for a number of 31 digits, as many of them as the element holds.
    fn like_exact(self, x: DoubleDouble) -> Self {
        self.like(x.hi())
    }
    /// The first lane, with all its digits.
    fn to_exact(self) -> DoubleDouble {
        DoubleDouble::from(self.first())
    }
    /// The call, compiled for the processor that the element is made for.
    #[inline(always)]
    fn run<F: NullaryFnOnce>(self, f: F) -> F::Output {
        f.call()
    }
    /// x self, for a number x of 31 digits.
    #[inline(always)]
    fn scale(self, x: DoubleDouble) -> Self {
        self * self.like_exact(x)
    }
    /// self a + b, fused where the processor does that.
    fn mul_add(self, a: Self, b: Self) -> Self;
    /// |self|
    fn abs(self) -> Self;
    /// The larger one; not self where self is no number.
    fn max(self, other: Self) -> Self;
    /// The smaller one; not self where self is no number.
    fn min(self, other: Self) -> Self;
    /// 1 with the sign of self.
    fn sign(self) -> Self;
    /// The logarithm to base 2 within 0.01, for self > 0; far below all others for 0.
    fn rough_log2(self) -> Self;
    /// 2^self within 1 per cent, or a number as near to it as the range allows.
    fn rough_exp2(self) -> Self;
    /// e^self
    fn exp(self) -> Self;
    /// e^self - 1, accurate near 0. Lane by lane where an element does not say otherwise: series need it but once in a step.
    fn exp_m1(self) -> Self {
        lane_by_lane(self, f64::exp_m1)
    }
    /// ln self
    fn ln(self) -> Self;
    /// ln(1 + self), accurate near 0; likewise.
    fn ln_1p(self) -> Self {
        lane_by_lane(self, f64::ln_1p)
    }
    /// self^p
    fn powf(self, p: f64) -> Self;
    /// The same for an exponent of 31 digits, as many of them as the element holds.
    #[inline(always)]
    fn power(self, p: DoubleDouble) -> Self {
        self.powf(p.hi())
    }
    /// sinh and cosh
    fn sinh_cosh(self) -> (Self, Self);
    /// sine and cosine; likewise, as the next two.
    fn sin_cos(self) -> (Self, Self) {
        (lane_by_lane(self, f64::sin), lane_by_lane(self, f64::cos))
    }
    /// inverse of the tangent
    fn atan(self) -> Self {
        lane_by_lane(self, f64::atan)
    }
    /// hyperbolic tangent
    fn tanh(self) -> Self {
        lane_by_lane(self, f64::tanh)
    }
    /// The y of y + g(y) = self, and g(y); likewise.
    fn balanced(self, g: Balance<Self>) -> (Self, Self) {
        let mut both = (self, self);
        for i in 0..Self::LANES {
            let (y, value) = Real::balanced(self.lane(i), g.map(|c| c.lane(i)));
            both = (both.0.with_lane(i, y), both.1.with_lane(i, value));
        }
        both
    }
    /// inverse of the hyperbolic sine
    fn asinh(self) -> Self {
        lane_by_lane(self, <f64 as Real>::asinh)
    }
    /// a in the lanes where self is negative, else b.
    fn if_negative(self, a: Self, b: Self) -> Self;
    /// a in the lanes where self is positive and finite, else b. Lanes that belong together do so only together, and all do
    /// where an element does not say otherwise.
    fn if_positive(self, a: Self, b: Self) -> Self {
        if self.all_positive() { a } else { b }
    }
    /// a in the lanes where self is zero, else b.
    fn if_zero(self, a: Self, b: Self) -> Self;
    /// Whether every lane is positive and finite.
    fn all_positive(self) -> bool;
    /// Whether no lane is negative.
    #[inline(always)]
    fn none_negative(self) -> bool {
        (self.if_negative(self.like(-1.0), self.like(1.0))).all_positive()
    }
    /// Whether every lane is finite.
    fn all_finite(self) -> bool;
    /// The sums for four orders from k, with the products a_j b_(k-j) of coefficients from the fourth to before the k-th, where the element
    /// has a faster way to them.
    #[inline(always)]
    fn sums_of_older(_sums: [Self; 4], _rows: [&[Self]; 2]) -> Option<[Self; 4]> {
        None
    }
    /// What is added to the sums of three orders by newest coefficients of two rows, given the first of both; likewise.
    #[inline(always)]
    fn sums_with_newest(
        _sums: [Self; 3],
        _newest: [Self; 2],
        _first: [&[Self; 3]; 2],
    ) -> Option<[Self; 3]> {
        None
    }
    /// Two elements side by side, where [`Element::SHARES`] says so.
    type Two: Two<Self>;
    /// Whether sums of products that share a factor are faster side by side.
    const SHARES: bool = false;
    /// How many lanes there are.
    const LANES: usize;
    /// The vectors that kernels make of it, where there are kernels of it.
    const WIDTH: Option<Width> = None;
    /// Carries out a kernel of such vectors on these results, given these numbers and coefficients.
    fn run_kernel(_: &Kernel, _results: &mut [Self], _numbers: &[Self], _coefficients: &[f64]) {
        unreachable!("no kernels of these");
    }
    /// Elements that are doubles.
    fn as_doubles(_all: &[Self]) -> Option<&[f64]> {
        None
    }
    /// The number in the first lane.
    fn first(self) -> f64;
    /// The number in a lane.
    fn lane(self, i: usize) -> f64;
    /// The same with another number in a lane.
    fn with_lane(self, i: usize, x: f64) -> Self;
    /// The largest number in any lane; not those that are no numbers.
    fn largest_lane(self) -> f64;
    /// The largest over the interfaces that are lanes of this element.
    fn largest_over_interfaces(self) -> Self {
        self
    }
}

/// Two elements side by side.
pub trait Two<T>: Copy + Debug {
    /// Of these two.
    fn of(both: [T; 2]) -> Self;
    /// These two.
    fn both(self) -> [T; 2];
    /// a times both, added to these.
    fn times(self, a: T, sums: Self) -> Self;
}

/// Where nothing stands side by side.
impl<T> Two<T> for () {
    fn of(_: [T; 2]) -> Self {}
    fn both(self) -> [T; 2] {
        unreachable!("nothing side by side")
    }
    fn times(self, _: T, (): Self) -> Self {}
}

/// The function in one lane after the other.
fn lane_by_lane<E: Element>(mut x: E, f: impl Fn(f64) -> f64) -> E {
    for i in 0..E::LANES {
        x = x.with_lane(i, f(x.lane(i)));
    }
    x
}

/// log2 x from the bits of x: its exponent, and its mantissa by a parabola.
#[inline(always)]
pub(super) fn rough_log2(x: f64) -> f64 {
    let bits = x.to_bits();
    let exponent = (bits >> 52) as i32 - 1023;
    let m = f64::from_bits((bits & 0x000f_ffff_ffff_ffff) | 0x3ff0_0000_0000_0000);
    f64::from(exponent) + (m - 1.0) * (1.344 - 0.344 * (m - 1.0))
}

/// 2^x by bits.
#[inline(always)]
pub(super) fn rough_exp2(x: f64) -> f64 {
    let x = if x > -1000.0 { x } else { -1000.0 };
    let x = if x < 1000.0 { x } else { 1000.0 };
    // Adding this leaves the whole part in the last bits.
    const SHIFT: f64 = 6755399441055744.0;
    let shifted = (x - 0.5) + SHIFT;
    let f = x - (shifted - SHIFT);
    let scale = f64::from_bits(shifted.to_bits().wrapping_add(1023) << 52);
    scale * (1.0 + f * (0.6565 + 0.3435 * f))
}

impl Element for f64 {
    type Two = ();
    const LANES: usize = 1;
    const WIDTH: Option<Width> = Some(Width::One);
    #[inline(always)]
    fn run_kernel(kernel: &Kernel, results: &mut [f64], numbers: &[f64], coefficients: &[f64]) {
        kernel.run(results, numbers, coefficients);
    }
    #[inline(always)]
    fn as_doubles(all: &[f64]) -> Option<&[f64]> {
        Some(all)
    }
    #[inline(always)]
    fn lane(self, _: usize) -> f64 {
        self
    }
    #[inline(always)]
    fn with_lane(self, _: usize, x: f64) -> Self {
        x
    }
    #[inline(always)]
    fn largest_lane(self) -> f64 {
        self
    }
    #[inline(always)]
    fn like(self, x: f64) -> f64 {
        x
    }
    // Unfused: in a binary for any x86-64 the fused one is a call of the library.
    #[inline(always)]
    fn mul_add(self, a: f64, b: f64) -> f64 {
        self * a + b
    }
    #[inline(always)]
    fn abs(self) -> f64 {
        self.abs()
    }
    #[inline(always)]
    fn max(self, other: f64) -> f64 {
        if self > other { self } else { other }
    }
    #[inline(always)]
    fn min(self, other: f64) -> f64 {
        if self < other { self } else { other }
    }
    #[inline(always)]
    fn rough_log2(self) -> f64 {
        rough_log2(self)
    }
    #[inline(always)]
    fn rough_exp2(self) -> f64 {
        rough_exp2(self)
    }
    #[inline(always)]
    fn sign(self) -> f64 {
        1_f64.copysign(self)
    }
    #[inline(always)]
    fn exp(self) -> f64 {
        self.exp()
    }
    #[inline(always)]
    fn ln(self) -> f64 {
        self.ln()
    }
    #[inline(always)]
    fn powf(self, p: f64) -> f64 {
        self.powf(p)
    }
    #[inline(always)]
    fn sinh_cosh(self) -> (f64, f64) {
        (Real::sinh(self), Real::cosh(self))
    }
    #[inline(always)]
    fn if_negative(self, a: f64, b: f64) -> f64 {
        if self < 0.0 { a } else { b }
    }
    #[inline(always)]
    fn if_zero(self, a: f64, b: f64) -> f64 {
        if self == 0.0 { a } else { b }
    }
    #[inline(always)]
    fn all_positive(self) -> bool {
        self > 0.0 && self < f64::INFINITY
    }
    #[inline(always)]
    fn all_finite(self) -> bool {
        self.is_finite()
    }
    #[inline(always)]
    fn first(self) -> f64 {
        self
    }
}

impl Element for DoubleDouble {
    type Two = ();
    const LANES: usize = 1;
    #[cfg(target_arch = "x86_64")]
    fn sums_of_older(sums: [Self; 4], rows: [&[Self]; 2]) -> Option<[Self; 4]> {
        super::exact_products::sums_of_older(sums, rows)
    }
    #[cfg(target_arch = "x86_64")]
    fn sums_with_newest(
        sums: [Self; 3],
        newest: [Self; 2],
        first: [&[Self; 3]; 2],
    ) -> Option<[Self; 3]> {
        super::exact_products::sums_with_newest(sums, newest, first)
    }
    #[inline(never)]
    fn run<F: NullaryFnOnce>(self, f: F) -> F::Output {
        f.call()
    }
    #[inline(always)]
    fn lane(self, _: usize) -> f64 {
        self.hi()
    }
    #[inline(always)]
    fn with_lane(self, _: usize, x: f64) -> Self {
        DoubleDouble::from(x)
    }
    #[inline(always)]
    fn largest_lane(self) -> f64 {
        self.hi()
    }
    fn like(self, x: f64) -> Self {
        DoubleDouble::from(x)
    }
    fn like_exact(self, x: DoubleDouble) -> Self {
        x
    }
    fn to_exact(self) -> DoubleDouble {
        self
    }
    fn mul_add(self, a: Self, b: Self) -> Self {
        self * a + b
    }
    fn abs(self) -> Self {
        Real::abs(self)
    }
    fn max(self, other: Self) -> Self {
        if self > other { self } else { other }
    }
    fn min(self, other: Self) -> Self {
        if self < other { self } else { other }
    }
    fn sign(self) -> Self {
        DoubleDouble::from(1_f64.copysign(self.hi()))
    }
    fn rough_log2(self) -> Self {
        DoubleDouble::from(rough_log2(self.hi()))
    }
    fn rough_exp2(self) -> Self {
        DoubleDouble::from(rough_exp2(self.hi()))
    }
    fn exp(self) -> Self {
        Real::exp(self)
    }
    fn exp_m1(self) -> Self {
        Real::exp_m1(self)
    }
    fn ln(self) -> Self {
        Real::ln(self)
    }
    fn ln_1p(self) -> Self {
        Real::ln_1p(self)
    }
    fn powf(self, p: f64) -> Self {
        Real::powf(self, p)
    }
    fn power(self, p: DoubleDouble) -> Self {
        Real::pow(self, p)
    }
    fn sinh_cosh(self) -> (Self, Self) {
        (Real::sinh(self), Real::cosh(self))
    }
    fn sin_cos(self) -> (Self, Self) {
        Real::sin_cos(self)
    }
    fn atan(self) -> Self {
        Real::atan(self)
    }
    fn tanh(self) -> Self {
        Real::tanh(self)
    }
    fn balanced(self, g: Balance<Self>) -> (Self, Self) {
        Real::balanced(self, g)
    }
    fn asinh(self) -> Self {
        Real::asinh(self)
    }
    fn if_negative(self, a: Self, b: Self) -> Self {
        if self.hi() < 0.0 { a } else { b }
    }
    fn if_zero(self, a: Self, b: Self) -> Self {
        if self.hi() == 0.0 { a } else { b }
    }
    fn all_positive(self) -> bool {
        self.hi() > 0.0 && self.is_finite()
    }
    fn all_finite(self) -> bool {
        self.is_finite()
    }
    fn first(self) -> f64 {
        self.hi()
    }
}

/// The y of y + g(y) = x, and g(y), for numbers that carry more than doubles: from the solution of their doubles, by so many of Newton's
/// steps, each of which doubles the order of the derivatives that are right.
#[inline(never)]
pub(super) fn balanced<E: Element>(x: E, g: Balance<E>, steps: usize) -> (E, E) {
    let at = |y: E| match g {
        Balance::Exponential(a) => {
            let value = a * y.exp();
            (value, value)
        }
        Balance::Sinh(a) => {
            let (sinh, cosh) = y.sinh_cosh();
            (a * sinh, a * cosh)
        }
        Balance::Difference(a, b) => (
            a * y.exp_m1() - b * (-y).exp_m1(),
            a * y.exp() + b * (-y).exp(),
        ),
    };
    let mut y = x.like(g.map(Element::first).solve(x.first()));
    for _ in 0..steps {
        let (value, slope) = at(y);
        y = y - (y + value - x) / (slope + x.like(1.0));
    }
    (y, at(y).0)
}
