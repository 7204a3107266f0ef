//! Elements of several lanes in the processor's vector registers.
//!
//! The types hold a token of what the processor can do, which cannot be had without asking it: their arithmetic is safe.

use super::element::{Element, Two};
use super::functions::{self, Register};
use pulp::NullaryFnOnce;
use pulp::x86::{V3, V4};
use std::arch::x86_64::{__m128d, __m256d, __m512d, _CMP_LT_OQ};
use std::cmp::Ordering;
use std::ops::{Add, Div, Mul, Neg, Sub};
use twinslip_kernel::{Kernel, Width, doubles};

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

doubles!(Pair {
    lanes: __m128d,
    simd: V3
});
doubles!(Four {
    lanes: __m256d,
    simd: V3
});

impl Pair {
    /// (x, x, y, y) of (x, y).
    #[inline(always)]
    pub fn twice(self) -> Four {
        let simd = self.simd;
        let wide = simd.avx._mm256_castpd128_pd256(self.lanes);
        Four {
            lanes: simd.avx2._mm256_permute4x64_pd::<0b0101_0000>(wide),
            simd,
        }
    }

    /// (x^p e^y, x^p e^(-y)) for both lanes, side by side; `None` where one is not an ordinary number.
    #[inline(always)]
    pub fn power_and_exponentials(self, p: f64, y: Pair) -> Option<Four> {
        let y = y.twice();
        let y = y * y.like_lanes([1.0, -1.0, 1.0, -1.0]);
        functions::power_and_exponentials(self, p, y, Pair::twice)
    }
}

impl Four {
    /// (x, y) of (x, _, y, _).
    #[inline(always)]
    pub fn once(self) -> Pair {
        let simd = self.simd;
        let once = simd.avx2._mm256_permute4x64_pd::<0b1000>(self.lanes);
        Pair {
            lanes: simd.avx._mm256_castpd256_pd128(once),
            simd,
        }
    }

    /// The lanes of each half exchanged.
    #[inline(always)]
    pub fn swapped(self) -> Self {
        self.with(self.simd.avx._mm256_permute_pd::<0b0101>(self.lanes))
    }

    /// The halves exchanged.
    #[inline(always)]
    pub fn crossed(self) -> Self {
        let avx = self.simd.avx;
        self.with(avx._mm256_permute2f128_pd::<1>(self.lanes, self.lanes))
    }

    /// The first lane of each half twice.
    #[inline(always)]
    pub fn firsts(self) -> Self {
        self.with(self.simd.avx._mm256_movedup_pd(self.lanes))
    }

    /// The second lane of each half twice.
    #[inline(always)]
    pub fn seconds(self) -> Self {
        self.with(self.simd.avx._mm256_permute_pd::<0b1111>(self.lanes))
    }

    /// The first lanes of the halves, and the second ones of the other.
    #[inline(always)]
    pub fn beside(self, other: Self) -> Self {
        self.with(
            self.simd
                .avx
                ._mm256_blend_pd::<0b1010>(self.lanes, other.lanes),
        )
    }
}

impl Two<Pair> for Four {
    #[inline(always)]
    fn of([a, b]: [Pair; 2]) -> Self {
        let simd = a.simd;
        let wide = simd.avx._mm256_castpd128_pd256(a.lanes);
        Four {
            lanes: simd.avx._mm256_insertf128_pd::<1>(wide, b.lanes),
            simd,
        }
    }
    #[inline(always)]
    fn both(self) -> [Pair; 2] {
        let Four { lanes, simd } = self;
        let first = simd.avx._mm256_castpd256_pd128(lanes);
        let second = simd.avx._mm256_extractf128_pd::<1>(lanes);
        let (first, second) = (
            Pair { lanes: first, simd },
            Pair {
                lanes: second,
                simd,
            },
        );
        [first, second]
    }
    #[inline(always)]
    fn times(self, a: Pair, sums: Self) -> Self {
        self.mul_add(Self::of([a, a]), sums)
    }
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

            /// These numbers. (As [`Element::like`], where a token is not at hand.)
            #[inline(always)]
            pub fn like_lanes(self, lanes: [f64; $n]) -> Self {
                Self::new(self.simd, lanes)
            }

            #[inline(always)]
            fn with(self, lanes: $register) -> Self {
                $name { lanes, ..self }
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
                self.xor(self.bits(functions::SIGN))
            }
        }

        impl Element for $name {
            const LANES: usize = $n;
            #[inline(always)]
            fn run<F: NullaryFnOnce>(self, f: F) -> F::Output {
                self.simd.vectorize(f)
            }
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
                self.magnitude()
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
                functions::rough_log2(self)
            }
            #[inline(always)]
            fn rough_exp2(self) -> Self {
                functions::rough_exp2(self)
            }
            #[inline(always)]
            fn sign(self) -> Self {
                self.like(1.0).or(self.sign_bit())
            }
            #[inline(always)]
            fn exp(self) -> Self {
                functions::exp(self)
            }
            #[inline(always)]
            fn ln(self) -> Self {
                functions::ln(self)
            }
            #[inline(always)]
            fn powf(self, p: f64) -> Self {
                functions::powf(self, p)
            }
            #[inline(always)]
            fn sinh_cosh(self) -> (Self, Self) {
                functions::sinh_cosh(self)
            }
            #[inline(always)]
            fn if_negative(self, a: Self, b: Self) -> Self {
                self.if_less(self.like(0.0), a, b)
            }
            #[inline(always)]
            fn if_zero(self, a: Self, b: Self) -> Self {
                // Beside zero the magnitude is no less than the smallest number.
                self.magnitude().if_less(self.bits(1), a, b)
            }
            #[inline(always)]
            fn all_positive(self) -> bool {
                self.like(0.0).all_less(self) & self.all_less(self.like(f64::INFINITY))
            }
            #[inline(always)]
            fn all_finite(self) -> bool {
                self.magnitude().all_less(self.like(f64::INFINITY))
            }
            #[inline(always)]
            fn first(self) -> f64 {
                self.lanes()[0]
            }
            lanes!(@interfaces $name);
        }
    };
    (@interfaces Pair) => {
        lanes!(@kernels Two);
        type Two = Four;
        const SHARES: bool = true;
        #[inline(always)]
        fn largest_over_interfaces(self) -> Self {
            let [x, y] = self.lanes();
            Element::max(self, Self::new(self.simd, [y, x]))
        }
    };
    (@interfaces Four) => {
        lanes!(@kernels Four);
        lanes!(@interfaces Others);
    };
    (@kernels $width:ident) => {
        const WIDTH: Option<Width> = Some(Width::$width);
        #[inline(always)]
        fn run_kernel(kernel: &Kernel, results: &mut [Self], numbers: &[Self], coefficients: &[f64]) {
            kernel.run(results, numbers, coefficients);
        }
    };
    (@interfaces $other:ident) => {
        type Two = ();
        #[inline(always)]
        fn if_positive(self, a: Self, b: Self) -> Self {
            let below = self.if_less(self.like(f64::INFINITY), a, b);
            self.like(0.0).if_less(self, below, b)
        }
    };
}

lanes!(Pair, __m128d, V3, 2, |s| s.sse2, _mm_add_pd _mm_sub_pd _mm_mul_pd _mm_div_pd, _mm_fmadd_pd: |f| f.fma, _mm_set1_pd _mm_max_pd _mm_min_pd);
lanes!(Four, __m256d, V3, 4, |s| s.avx, _mm256_add_pd _mm256_sub_pd _mm256_mul_pd _mm256_div_pd, _mm256_fmadd_pd: |f| f.fma, _mm256_set1_pd _mm256_max_pd _mm256_min_pd);
lanes!(Eight, __m512d, V4, 8, |s| s.avx512f, _mm512_add_pd _mm512_sub_pd _mm512_mul_pd _mm512_div_pd, _mm512_fmadd_pd: |f| f.avx512f, _mm512_set1_pd _mm512_max_pd _mm512_min_pd);

/// The operations on bits and the choices lane by lane: the instructions follow no one pattern of names.
macro_rules! register {
    ($name:ident, |$s:ident| $whole:expr, $plus:ident $minus:ident $left:ident $right:ident, $logic:expr, $and:ident $or:ident $xor:ident,
     |$x:ident, $y:ident, $a:ident, $b:ident| $choose:expr, $all:expr) => {
        impl Register for $name {
            #[inline(always)]
            fn plus_bits(self, o: Self) -> Self {
                let $s = self.simd;
                self.with(pulp::cast(
                    $whole.$plus(pulp::cast(self.lanes), pulp::cast(o.lanes)),
                ))
            }
            #[inline(always)]
            fn minus_bits(self, o: Self) -> Self {
                let $s = self.simd;
                self.with(pulp::cast(
                    $whole.$minus(pulp::cast(self.lanes), pulp::cast(o.lanes)),
                ))
            }
            #[inline(always)]
            fn and(self, o: Self) -> Self {
                let $s = self.simd;
                self.with($logic.$and(self.lanes, o.lanes))
            }
            #[inline(always)]
            fn or(self, o: Self) -> Self {
                let $s = self.simd;
                self.with($logic.$or(self.lanes, o.lanes))
            }
            #[inline(always)]
            fn xor(self, o: Self) -> Self {
                let $s = self.simd;
                self.with($logic.$xor(self.lanes, o.lanes))
            }
            #[inline(always)]
            fn into_exponent(self) -> Self {
                let $s = self.simd;
                self.with(pulp::cast($whole.$left::<52>(pulp::cast(self.lanes))))
            }
            #[inline(always)]
            fn exponent_bits(self) -> Self {
                let $s = self.simd;
                self.with(pulp::cast($whole.$right::<52>(pulp::cast(self.lanes))))
            }
            #[inline(always)]
            fn if_less(self, limit: Self, a: Self, b: Self) -> Self {
                let $s = self.simd;
                let ($x, $y, $a, $b) = (self.lanes, limit.lanes, a.lanes, b.lanes);
                self.with($choose)
            }
            #[inline(always)]
            fn all_less(self, limit: Self) -> bool {
                let $s = self.simd;
                let ($x, $y) = (self.lanes, limit.lanes);
                $all
            }
            #[inline(always)]
            fn mend(self, size: Self, limit: f64, fast: Self, exact: impl Fn(f64) -> f64) -> Self {
                let mended = mended(self.lanes(), size.lanes(), limit, fast.lanes(), &exact);
                Self::new(self.simd, mended)
            }
        }
    };
}

#[cold]
#[inline(never)]
fn mended<const N: usize>(
    x: [f64; N],
    size: [f64; N],
    limit: f64,
    fast: [f64; N],
    exact: &dyn Fn(f64) -> f64,
) -> [f64; N] {
    let mut mended = fast;
    for i in 0..N {
        // Nor is a size that is no number below the limit.
        if !matches!(size[i].partial_cmp(&limit), Some(Ordering::Less)) {
            mended[i] = exact(x[i]);
        }
    }
    mended
}

register!(Pair, |s| s.sse2, _mm_add_epi64 _mm_sub_epi64 _mm_slli_epi64 _mm_srli_epi64, s.sse2, _mm_and_pd _mm_or_pd _mm_xor_pd,
    |x, y, a, b| s.sse4_1._mm_blendv_pd(b, a, s.sse2._mm_cmplt_pd(x, y)),
    s.sse2._mm_movemask_pd(s.sse2._mm_cmplt_pd(x, y)) == 3);
register!(Four, |s| s.avx2, _mm256_add_epi64 _mm256_sub_epi64 _mm256_slli_epi64 _mm256_srli_epi64, s.avx, _mm256_and_pd _mm256_or_pd _mm256_xor_pd,
    |x, y, a, b| s.avx._mm256_blendv_pd(b, a, s.avx._mm256_cmp_pd::<_CMP_LT_OQ>(x, y)),
    s.avx._mm256_movemask_pd(s.avx._mm256_cmp_pd::<_CMP_LT_OQ>(x, y)) == 15);
register!(Eight, |s| s.avx512f, _mm512_add_epi64 _mm512_sub_epi64 _mm512_slli_epi64 _mm512_srli_epi64, s.avx512dq, _mm512_and_pd _mm512_or_pd _mm512_xor_pd,
    |x, y, a, b| s.avx512f._mm512_mask_blend_pd(s.avx512f._mm512_cmp_pd_mask::<_CMP_LT_OQ>(x, y), b, a),
    s.avx512f._mm512_cmp_pd_mask::<_CMP_LT_OQ>(x, y) == 255);
