//! Both interfaces in ordinary numbers: for processors without the vector instructions, and for any kind of number.

use super::element::Element;
use crate::number::{Balance, DoubleDouble};
use pulp::NullaryFnOnce;
use std::ops::{Add, Div, Mul, Neg, Sub};

/// Both interfaces under one stress, or twice as many lanes.
#[derive(Debug, Clone, Copy)]
pub struct Both<T>(pub [T; 2]);

macro_rules! lanewise {
    ($trait:ident $method:ident $op:tt) => {
        impl<T: Element> $trait for Both<T> {
            type Output = Self;
            #[inline(always)]
            fn $method(self, o: Self) -> Self {
                Both([self.0[0] $op o.0[0], self.0[1] $op o.0[1]])
            }
        }
    };
}
lanewise!(Add add +);
lanewise!(Sub sub -);
lanewise!(Mul mul *);
lanewise!(Div div /);

impl<T: Element> Neg for Both<T> {
    type Output = Self;
    #[inline(always)]
    fn neg(self) -> Self {
        Both([-self.0[0], -self.0[1]])
    }
}

/// Functions of one lane after the other.
macro_rules! functions {
    ($($name:ident($($x:ident: $t:ty),*);)*) => {
        $(
            #[inline(always)]
            fn $name(self, $($x: $t),*) -> Self {
                Both([self.0[0].$name($($x),*), self.0[1].$name($($x),*)])
            }
        )*
    };
}

impl<T: Element> Element for Both<T> {
    type Two = ();
    const LANES: usize = 2 * T::LANES;
    // Where there are vector instructions this is for the few processors without them.
    const UNROLLED: bool = T::UNROLLED && cfg!(not(target_arch = "x86_64"));
    #[inline(always)]
    fn to_exact(self) -> DoubleDouble {
        self.0[0].to_exact()
    }
    #[inline(always)]
    fn run<F: NullaryFnOnce>(self, f: F) -> F::Output {
        self.0[0].run(f)
    }
    #[inline(always)]
    fn lane(self, i: usize) -> f64 {
        self.0[i / T::LANES].lane(i % T::LANES)
    }
    #[inline(always)]
    fn with_lane(self, i: usize, x: f64) -> Self {
        let mut all = self.0;
        all[i / T::LANES] = all[i / T::LANES].with_lane(i % T::LANES, x);
        Both(all)
    }
    #[inline(always)]
    fn largest_lane(self) -> f64 {
        self.0[0].largest_lane().max(self.0[1].largest_lane())
    }
    functions! {
        like(x: f64);
        like_exact(x: DoubleDouble);
        abs();
        sign();
        exp();
        exp_m1();
        ln();
        ln_1p();
        atan();
        tanh();
        asinh();
        powf(p: f64);
        rough_log2();
        rough_exp2();
    }
    #[inline(always)]
    fn mul_add(self, a: Self, b: Self) -> Self {
        Both([
            self.0[0].mul_add(a.0[0], b.0[0]),
            self.0[1].mul_add(a.0[1], b.0[1]),
        ])
    }
    #[inline(always)]
    fn max(self, o: Self) -> Self {
        Both([self.0[0].max(o.0[0]), self.0[1].max(o.0[1])])
    }
    #[inline(always)]
    fn min(self, o: Self) -> Self {
        Both([self.0[0].min(o.0[0]), self.0[1].min(o.0[1])])
    }
    #[inline(always)]
    fn if_negative(self, a: Self, b: Self) -> Self {
        Both([
            self.0[0].if_negative(a.0[0], b.0[0]),
            self.0[1].if_negative(a.0[1], b.0[1]),
        ])
    }
    #[inline(always)]
    fn if_zero(self, a: Self, b: Self) -> Self {
        Both([
            self.0[0].if_zero(a.0[0], b.0[0]),
            self.0[1].if_zero(a.0[1], b.0[1]),
        ])
    }
    #[inline(always)]
    fn sinh_cosh(self) -> (Self, Self) {
        let ((s1, c1), (s2, c2)) = (self.0[0].sinh_cosh(), self.0[1].sinh_cosh());
        (Both([s1, s2]), Both([c1, c2]))
    }
    #[inline(always)]
    fn sin_cos(self) -> (Self, Self) {
        let ((s1, c1), (s2, c2)) = (self.0[0].sin_cos(), self.0[1].sin_cos());
        (Both([s1, s2]), Both([c1, c2]))
    }
    #[inline(always)]
    fn balanced(self, g: Balance<Self>) -> (Self, Self) {
        let of = |i: usize| self.0[i].balanced(g.map(|c| c.0[i]));
        let ((y, of_y), (z, of_z)) = (of(0), of(1));
        (Both([y, z]), Both([of_y, of_z]))
    }
    #[inline(always)]
    fn first(self) -> f64 {
        self.0[0].first()
    }
    #[inline(always)]
    fn all_positive(self) -> bool {
        self.0[0].all_positive() && self.0[1].all_positive()
    }
    #[inline(always)]
    fn all_finite(self) -> bool {
        self.0[0].all_finite() && self.0[1].all_finite()
    }
    #[inline(always)]
    fn interfaces(self) -> [f64; 2] {
        [self.0[0].first(), self.0[1].first()]
    }
    #[inline(always)]
    fn over_interfaces(self) -> Self {
        let sum = self.0[0] + self.0[1];
        Both([sum, sum])
    }
    #[inline(always)]
    fn largest_over_interfaces(self) -> Self {
        let largest = self.0[0].max(self.0[1]);
        Both([largest, largest])
    }
}
