//! Elements of several lanes in the processor's vector registers.
//!
//! The types hold a token of what the processor can do, which cannot be had without asking it: their arithmetic is safe.

use super::columns::Spread;
use super::element::{Element, rough_exp2, rough_log2};
use super::plain::Both;
use pulp::x86::{V3, V4};
use std::arch::x86_64::{__m128d, __m256d, __m512d};
use std::ops::{Add, Div, Mul, Neg, Sub};

/// Both interfaces under one stress, in one register.
#[derive(Debug, Clone, Copy)]
pub struct Pair {
    lanes: __m128d,
    simd: V3,
}

/// Four trajectories.
#[derive(Debug, Clone, Copy)]
pub struct Four {
    lanes: __m256d,
    simd: V3,
}

/// Eight trajectories.
#[derive(Debug, Clone, Copy)]
pub struct Eight {
    lanes: __m512d,
    simd: V4,
}

macro_rules! lanes {
    ($name:ident, $register:ty, $token:ty, $n:literal, |$s:ident| $unit:expr,
     $add:ident $sub:ident $mul:ident $div:ident, $fused:ident: |$f:ident| $fma:expr, $splat:ident $max:ident $min:ident) => {
        impl $name {
            /// The numbers in the lanes.
            #[inline(always)]
            pub fn new(simd: $token, lanes: [f64; $n]) -> Self {
                $name {
                    lanes: pulp::cast(lanes),
                    simd,
                }
            }

            /// The numbers in the lanes.
            #[inline(always)]
            pub fn lanes(self) -> [f64; $n] {
                pulp::cast(self.lanes)
            }

            #[inline(always)]
            fn with(self, lanes: $register) -> Self {
                $name { lanes, ..self }
            }

            #[inline(always)]
            fn each(self, f: impl Fn(f64) -> f64) -> Self {
                let mut x = self.lanes();
                for lane in &mut x {
                    *lane = f(*lane);
                }
                Self::new(self.simd, x)
            }
        }

        impl Add for $name {
            type Output = Self;
            #[inline(always)]
            fn add(self, o: Self) -> Self {
                let $s = self.simd;
                self.with($unit.$add(self.lanes, o.lanes))
            }
        }
        impl Sub for $name {
            type Output = Self;
            #[inline(always)]
            fn sub(self, o: Self) -> Self {
                let $s = self.simd;
                self.with($unit.$sub(self.lanes, o.lanes))
            }
        }
        impl Mul for $name {
            type Output = Self;
            #[inline(always)]
            fn mul(self, o: Self) -> Self {
                let $s = self.simd;
                self.with($unit.$mul(self.lanes, o.lanes))
            }
        }
        impl Div for $name {
            type Output = Self;
            #[inline(always)]
            fn div(self, o: Self) -> Self {
                let $s = self.simd;
                self.with($unit.$div(self.lanes, o.lanes))
            }
        }
        impl Neg for $name {
            type Output = Self;
            #[inline(always)]
            fn neg(self) -> Self {
                self.like(-0.0) - self
            }
        }

        impl Element for $name {
            const LANES: usize = $n;
            #[inline(always)]
            fn lane(self, i: usize) -> f64 {
                self.lanes()[i]
            }
            #[inline(always)]
            fn with_lane(self, i: usize, x: f64) -> Self {
                let mut lanes = self.lanes();
                lanes[i] = x;
                Self::new(self.simd, lanes)
            }
            #[inline(always)]
            fn largest_lane(self) -> f64 {
                let mut largest = f64::NEG_INFINITY;
                for x in self.lanes() {
                    if x > largest {
                        largest = x;
                    }
                }
                largest
            }
            #[inline(always)]
            fn like(self, x: f64) -> Self {
                let $s = self.simd;
                self.with($unit.$splat(x))
            }
            #[inline(always)]
            fn mul_add(self, a: Self, b: Self) -> Self {
                let $f = self.simd;
                self.with($fma.$fused(self.lanes, a.lanes, b.lanes))
            }
            #[inline(always)]
            fn abs(self) -> Self {
                self.each(f64::abs)
            }
            #[inline(always)]
            fn max(self, o: Self) -> Self {
                let $s = self.simd;
                self.with($unit.$max(self.lanes, o.lanes))
            }
            #[inline(always)]
            fn min(self, o: Self) -> Self {
                let $s = self.simd;
                self.with($unit.$min(self.lanes, o.lanes))
            }
            #[inline(always)]
            fn rough_log2(self) -> Self {
                self.each(rough_log2)
            }
            #[inline(always)]
            fn rough_exp2(self) -> Self {
                self.each(rough_exp2)
            }
            #[inline(always)]
            fn sign(self) -> Self {
                self.each(|x| 1_f64.copysign(x))
            }
            #[inline(always)]
            fn exp(self) -> Self {
                self.each(f64::exp)
            }
            #[inline(always)]
            fn ln(self) -> Self {
                self.each(f64::ln)
            }
            #[inline(always)]
            fn powf(self, p: f64) -> Self {
                self.each(|x| x.powf(p))
            }
            #[inline(always)]
            fn sinh_cosh(self) -> (Self, Self) {
                let e = Element::exp(self);
                let half = self.like(0.5);
                let (up, down) = (e * half, half / e);
                (up - down, up + down)
            }
            #[inline(always)]
            fn if_negative(self, a: Self, b: Self) -> Self {
                let (mut x, a, b) = (self.lanes(), a.lanes(), b.lanes());
                for i in 0..$n {
                    x[i] = if x[i] < 0.0 { a[i] } else { b[i] };
                }
                Self::new(self.simd, x)
            }
            #[inline(always)]
            fn if_zero(self, a: Self, b: Self) -> Self {
                let (mut x, a, b) = (self.lanes(), a.lanes(), b.lanes());
                let mut i = 0;
                while i < $n {
                    x[i] = if x[i] == 0.0 { a[i] } else { b[i] };
                    i += 1;
                }
                Self::new(self.simd, x)
            }
            #[inline(always)]
            fn all_positive(self) -> bool {
                let mut all = true;
                for x in self.lanes() {
                    all &= x > 0.0 && x < f64::INFINITY;
                }
                all
            }
            #[inline(always)]
            fn all_finite(self) -> bool {
                let mut all = true;
                for x in self.lanes() {
                    all &= x.is_finite();
                }
                all
            }
            #[inline(always)]
            fn first(self) -> f64 {
                self.lanes()[0]
            }
            lanes!(@interfaces $name);
        }
    };
    (@interfaces Pair) => {
        #[inline(always)]
        fn interfaces(self) -> [f64; 2] {
            self.lanes()
        }
        #[inline(always)]
        fn over_interfaces(self) -> Self {
            let [x, y] = self.lanes();
            self.like(x + y)
        }
        #[inline(always)]
        fn largest_over_interfaces(self) -> Self {
            let [x, y] = self.lanes();
            Element::max(self, Self::new(self.simd, [y, x]))
        }
    };
    (@interfaces $other:ident) => {};
}

lanes!(Pair, __m128d, V3, 2, |s| s.sse2, _mm_add_pd _mm_sub_pd _mm_mul_pd _mm_div_pd, _mm_fmadd_pd: |f| f.fma, _mm_set1_pd _mm_max_pd _mm_min_pd);
lanes!(Four, __m256d, V3, 4, |s| s.avx, _mm256_add_pd _mm256_sub_pd _mm256_mul_pd _mm256_div_pd, _mm256_fmadd_pd: |f| f.fma, _mm256_set1_pd _mm256_max_pd _mm256_min_pd);
lanes!(Eight, __m512d, V4, 8, |s| s.avx512f, _mm512_add_pd _mm512_sub_pd _mm512_mul_pd _mm512_div_pd, _mm512_fmadd_pd: |f| f.avx512f, _mm512_set1_pd _mm512_max_pd _mm512_min_pd);

impl Spread<Four> for Pair {
    #[inline(always)]
    fn spread(self, interface: usize, any: Four) -> Four {
        any.like(self.lanes()[interface])
    }
}

impl Spread<Both<Four>> for Pair {
    #[inline(always)]
    fn spread(self, interface: usize, any: Both<Four>) -> Both<Four> {
        any.like(self.lanes()[interface])
    }
}
