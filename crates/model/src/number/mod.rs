//! What a formula is written in.
//!
//! The friction laws are written once, generic over [`Real`]. In `f64` they give values; in [`Jet`] exact derivatives; in
//! [`Difference`] the difference of two values without cancellation; in [`Interval`] bounds that hold whatever the rounding;
//! in [`DoubleDouble`] values of 31 digits. Their constants are fixed doubles or [`Free`] numbers. [`polynomial`] has the real roots of Taylor polynomials.

mod balance;
mod constant;
mod difference;
mod double_double;
mod eigenvalues;
mod interval;
mod jet;
mod logarithm;
pub mod polynomial;
mod quantile;
mod ratio;
mod root;
mod uncertain;

pub use balance::Balance;
pub use constant::{Constant, Free, With};
pub use difference::Difference;
pub use double_double::DoubleDouble;
#[cfg(target_arch = "x86_64")]
pub(crate) use double_double::two_sum;
pub use eigenvalues::{
    eigenvalues, eigenvector, null_vector, singular_values, symmetric_eigenvalues,
};
pub use interval::Interval;
pub use jet::Jet;
pub use logarithm::{between_in_log, log_ratio};
pub use quantile::quantile;
pub use ratio::{Numerator, Ratio};
pub use root::{bracketed_root, enclosing_radius};
pub use uncertain::Uncertain;

use std::fmt::Debug;
use std::ops::{Add, Div, Mul, Neg, Sub};

/// A number in which a formula can be evaluated.
///
/// Mixed operations with `f64` take the `f64` as exact. Functions outside their domain give values that are not finite.
pub trait Real:
    Copy
    + Debug
    + Neg<Output = Self>
    + Add<Output = Self>
    + Sub<Output = Self>
    + Mul<Output = Self>
    + Div<Output = Self>
    + Add<f64, Output = Self>
    + Sub<f64, Output = Self>
    + Mul<f64, Output = Self>
    + Div<f64, Output = Self>
{
    /// An exact constant.
    fn constant(x: f64) -> Self;
    /// An ordinary number that stands for this one in comparisons: its value, or its middle.
    fn leading(self) -> f64;
    /// This number; 0 where it is infinite, as the slope of a function is taken to be beyond the range of numbers: so 1/(1 + e^x)
    /// has one there.
    #[inline(always)]
    fn in_range(self) -> Self {
        self
    }
    /// e^x
    fn exp(self) -> Self;
    /// e^x - 1, accurate near 0
    fn exp_m1(self) -> Self;
    /// natural logarithm
    fn ln(self) -> Self;
    /// ln(1 + x), accurate near 0
    fn ln_1p(self) -> Self;
    /// x^p for x > 0
    fn powf(self, p: f64) -> Self;
    /// x^p for x > 0, of a power that is a number too
    #[inline(always)]
    fn pow(self, p: Self) -> Self {
        (p * self.ln()).exp()
    }
    /// square root
    fn sqrt(self) -> Self;
    /// hyperbolic sine
    fn sinh(self) -> Self;
    /// hyperbolic cosine
    fn cosh(self) -> Self;
    /// sinh and cosh, which share their work
    #[inline(always)]
    fn sinh_cosh(self) -> (Self, Self) {
        (self.sinh(), self.cosh())
    }
    /// inverse of the hyperbolic sine
    fn asinh(self) -> Self;
    /// sine
    #[inline(always)]
    fn sin(self) -> Self {
        self.sin_cos().0
    }
    /// cosine
    #[inline(always)]
    fn cos(self) -> Self {
        self.sin_cos().1
    }
    /// sine and cosine, which share their work
    fn sin_cos(self) -> (Self, Self);
    /// hyperbolic tangent
    fn tanh(self) -> Self;
    /// inverse of the tangent
    fn atan(self) -> Self;
    /// logarithm to base 10
    #[inline(always)]
    fn log10(self) -> Self {
        self.ln() / Self::constant(10.0).ln()
    }
    /// absolute value
    fn abs(self) -> Self;
    /// one, with this number's sign
    #[inline(always)]
    fn sign(self) -> Self {
        Self::constant(1_f64.copysign(self.leading()))
    }
    /// the y of y + g(y) = x, and g(y), each with its own digits
    fn balanced(self, g: Balance<Self>) -> (Self, Self);
    /// N(x)/x of a function N with N(0) = 0, or a derivative of that, with its own digits where x is 0 or near it
    fn ratio(self, ratio: Ratio) -> Self;
    /// the lesser of two; this one where they are equal
    #[inline(always)]
    fn lesser(self, o: Self) -> Self {
        if (o - self).leading() >= 0.0 { self } else { o }
    }
    /// the greater of two; this one where they are equal
    #[inline(always)]
    fn greater(self, o: Self) -> Self {
        if (self - o).leading() >= 0.0 { self } else { o }
    }
}

/// Arguments for which sinh and cosh are accurate, and finite, as a sum of two exponentials.
const BOTH_EXPONENTIALS: std::ops::Range<f64> = 2.0..700.0;

impl Real for f64 {
    #[inline]
    fn constant(x: f64) -> f64 {
        x
    }
    #[inline]
    fn leading(self) -> f64 {
        self
    }
    #[inline]
    fn in_range(self) -> f64 {
        if self.is_infinite() { 0.0 } else { self }
    }
    #[inline]
    fn exp(self) -> f64 {
        self.exp()
    }
    #[inline]
    fn exp_m1(self) -> f64 {
        self.exp_m1()
    }
    #[inline]
    fn ln(self) -> f64 {
        self.ln()
    }
    #[inline]
    fn ln_1p(self) -> f64 {
        self.ln_1p()
    }
    #[inline]
    fn powf(self, p: f64) -> f64 {
        self.powf(p)
    }
    #[inline]
    fn pow(self, p: f64) -> f64 {
        self.powf(p)
    }
    #[inline]
    fn sqrt(self) -> f64 {
        self.sqrt()
    }
    // Where the exponentials do not cancel, one of them serves both functions: several per cent of a whole integration.
    #[inline]
    fn sinh(self) -> f64 {
        if BOTH_EXPONENTIALS.contains(&f64::abs(self)) {
            let e = f64::exp(f64::abs(self));
            (0.5 * e - 0.5 / e).copysign(self)
        } else {
            self.sinh()
        }
    }
    #[inline]
    fn cosh(self) -> f64 {
        if BOTH_EXPONENTIALS.contains(&f64::abs(self)) {
            let e = f64::exp(f64::abs(self));
            0.5 * e + 0.5 / e
        } else {
            self.cosh()
        }
    }
    // The standard library's asinh loses digits for large negative arguments and overflows near the largest numbers.
    #[inline]
    fn asinh(self) -> f64 {
        let x = f64::abs(self);
        let value = if x > 1e150 {
            f64::ln(x) + std::f64::consts::LN_2
        } else {
            f64::ln_1p(x + x * x / (1.0 + f64::sqrt(1.0 + x * x)))
        };
        value.copysign(self)
    }
    #[inline]
    fn sin_cos(self) -> (f64, f64) {
        self.sin_cos()
    }
    #[inline]
    fn tanh(self) -> f64 {
        self.tanh()
    }
    #[inline]
    fn atan(self) -> f64 {
        self.atan()
    }
    #[inline]
    fn log10(self) -> f64 {
        self.log10()
    }
    #[inline]
    fn abs(self) -> f64 {
        self.abs()
    }
    fn balanced(self, g: Balance<f64>) -> (f64, f64) {
        let y = g.solve(self);
        (y, g.at(y).0)
    }
    fn ratio(self, ratio: Ratio) -> f64 {
        match ratio {
            Ratio {
                numerator,
                derivative: 0,
            } if self != 0.0 => numerator.of(self) / self,
            _ => ratio.by_coefficients(self),
        }
    }
}
