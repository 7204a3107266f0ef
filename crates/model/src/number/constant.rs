//! The constants of a formula: fixed doubles, or free numbers in which it has derivatives.

use super::Real;
use std::fmt::Debug;
use std::ops::{Mul, Neg};

/// A constant of a formula: an `f64`, or a [`Free`] number.
pub trait Constant: Copy + Debug + Neg<Output = Self> + Mul<f64, Output = Self> {
    /// The constant of this value.
    fn fixed(x: f64) -> Self;
}

impl Constant for f64 {
    #[inline(always)]
    fn fixed(x: f64) -> f64 {
        x
    }
}

/// A constant that is a number of the same kind as the variables of the formula, as any other parameter of a system.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Free<T>(pub T);

impl<T: Real> Constant for Free<T> {
    #[inline(always)]
    fn fixed(x: f64) -> Self {
        Free(T::constant(x))
    }
}

impl<T: Real> Neg for Free<T> {
    type Output = Self;
    #[inline(always)]
    fn neg(self) -> Self {
        Free(-self.0)
    }
}

impl<T: Real> Mul<f64> for Free<T> {
    type Output = Self;
    #[inline(always)]
    fn mul(self, x: f64) -> Self {
        Free(self.0 * x)
    }
}

/// A number of a formula whose constants are of the kind C.
///
/// An `f64` is taken as exact, in the mixed operations of [`Real`]. A [`Free`] constant is a variable like others.
///
/// ```
/// use twinslip::number::{Constant, Free, Jet, With};
/// fn area<C: Constant, T: With<C>>(pi: C, radius: T) -> T {
///     (radius * radius).times(pi)
/// }
/// assert_eq!(area(3.14, 2.0), 12.56);
/// let [pi, radius] = Jet::variables([3.14, 2.0]);
/// assert_eq!(area(Free(pi), radius).gradient, [4.0, 12.56]);
/// ```
pub trait With<C>: Real {
    /// c
    fn of(c: C) -> Self;
    /// x + c
    fn plus(self, c: C) -> Self;
    /// x c
    fn times(self, c: C) -> Self;
    /// x / c
    fn over(self, c: C) -> Self;
    /// x^c for x > 0
    fn power(self, c: C) -> Self;
}

impl<T: Real> With<f64> for T {
    #[inline(always)]
    fn of(c: f64) -> T {
        T::constant(c)
    }
    #[inline(always)]
    fn plus(self, c: f64) -> T {
        self + c
    }
    #[inline(always)]
    fn times(self, c: f64) -> T {
        self * c
    }
    #[inline(always)]
    fn over(self, c: f64) -> T {
        self / c
    }
    #[inline(always)]
    fn power(self, c: f64) -> T {
        self.powf(c)
    }
}

impl<T: Real> With<Free<T>> for T {
    #[inline(always)]
    fn of(c: Free<T>) -> T {
        c.0
    }
    #[inline(always)]
    fn plus(self, c: Free<T>) -> T {
        self + c.0
    }
    #[inline(always)]
    fn times(self, c: Free<T>) -> T {
        self * c.0
    }
    #[inline(always)]
    fn over(self, c: Free<T>) -> T {
        self / c.0
    }
    #[inline(always)]
    fn power(self, c: Free<T>) -> T {
        self.pow(c.0)
    }
}
