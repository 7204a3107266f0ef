//! Lanes of any number one after the other, in loops: for references, and for processors without vector instructions. Inlined
//! nowhere: the code of 31 digits in eight lanes is long, and formulas of it inlined take most of the time of a build.

use super::element::Element;
use crate::number::DoubleDouble;
use pulp::NullaryFnOnce;
use std::ops::{Add, Div, Mul, Neg, Sub};

/// M numbers that have nothing to do with each other.
#[derive(Debug, Clone, Copy)]
pub struct Array<T, const M: usize>(pub [T; M]);

impl<T: Element, const M: usize> Array<T, M> {
    fn map(mut self, f: impl Fn(T) -> T) -> Self {
        for x in &mut self.0 {
            *x = f(*x);
        }
        self
    }

    fn zip(mut self, other: Self, f: impl Fn(T, T) -> T) -> Self {
        for (x, y) in self.0.iter_mut().zip(other.0) {
            *x = f(*x, y);
        }
        self
    }
}

macro_rules! operators {
    ($($trait:ident $method:ident)*) => {
        $(
            impl<T: Element, const M: usize> $trait for Array<T, M> {
                type Output = Self;
                #[inline(never)]
                fn $method(self, o: Self) -> Self {
                    self.zip(o, T::$method)
                }
            }
        )*
    };
}
operators!(Add add Sub sub Mul mul Div div);

impl<T: Element, const M: usize> Neg for Array<T, M> {
    type Output = Self;
    #[inline(never)]
    fn neg(self) -> Self {
        self.map(T::neg)
    }
}

/// Functions of one lane after the other.
macro_rules! functions {
    ($($name:ident)*) => {
        $(
            #[inline(never)]
            fn $name(self) -> Self {
                self.map(|x| x.$name())
            }
        )*
    };
}

impl<T: Element, const M: usize> Element for Array<T, M> {
    const LANES: usize = M;
    const CALLED: bool = true;
    #[inline(never)]
    fn run<F: NullaryFnOnce>(self, f: F) -> F::Output {
        f.call()
    }
    functions! { abs sign exp exp_m1 ln ln_1p rough_log2 rough_exp2 }
    fn like(self, x: f64) -> Self {
        Array([self.0[0].like(x); M])
    }
    fn like_exact(self, x: DoubleDouble) -> Self {
        Array([self.0[0].like_exact(x); M])
    }
    #[inline(never)]
    fn powf(self, p: f64) -> Self {
        self.map(|x| x.powf(p))
    }
    #[inline(never)]
    fn sinh_cosh(self) -> (Self, Self) {
        (self.map(|x| x.sinh_cosh().0), self.map(|x| x.sinh_cosh().1))
    }
    #[inline(never)]
    fn mul_add(mut self, a: Self, b: Self) -> Self {
        for (x, (a, b)) in self.0.iter_mut().zip(a.0.into_iter().zip(b.0)) {
            *x = x.mul_add(a, b);
        }
        self
    }
    #[inline(never)]
    fn max(self, o: Self) -> Self {
        self.zip(o, T::max)
    }
    #[inline(never)]
    fn min(self, o: Self) -> Self {
        self.zip(o, T::min)
    }
    #[inline(never)]
    fn if_negative(mut self, a: Self, b: Self) -> Self {
        for (x, (a, b)) in self.0.iter_mut().zip(a.0.into_iter().zip(b.0)) {
            *x = x.if_negative(a, b);
        }
        self
    }
    #[inline(never)]
    fn if_zero(mut self, a: Self, b: Self) -> Self {
        for (x, (a, b)) in self.0.iter_mut().zip(a.0.into_iter().zip(b.0)) {
            *x = x.if_zero(a, b);
        }
        self
    }
    fn all_positive(self) -> bool {
        self.0.into_iter().all(T::all_positive)
    }
    fn all_finite(self) -> bool {
        self.0.into_iter().all(T::all_finite)
    }
    fn first(self) -> f64 {
        self.0[0].first()
    }
    fn to_exact(self) -> DoubleDouble {
        self.0[0].to_exact()
    }
    fn lane(self, i: usize) -> f64 {
        self.0[i].first()
    }
    fn lane_exact(self, i: usize) -> DoubleDouble {
        self.0[i].to_exact()
    }
    fn with_lane(mut self, i: usize, x: f64) -> Self {
        self.0[i] = self.0[i].like(x);
        self
    }
    fn largest_lane(self) -> f64 {
        let lanes = self.0.into_iter().map(T::first);
        lanes.fold(f64::NEG_INFINITY, f64::max)
    }
}
