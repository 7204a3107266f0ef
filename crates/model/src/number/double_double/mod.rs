//! Numbers of 31 digits, as unevaluated sums of two doubles: for reference solutions in the formulas' own code.
//!
//! The operations are those of Dekker (1971), Knuth (The Art of Computer Programming 2, section 4.2.2) and Hida, Li and
//! Bailey (2001, Algorithms for quad-double precision floating point arithmetic), in their accurate forms; error bounds
//! are from Joldes, Muller and Popescu (2017, Tight and rigorous error bounds for basic building blocks of double-word
//! arithmetic). The crate `twofloat` (0.8.4) has the operations too, but its exp, sinh and ln_1p are off by 1e-12 to 1e-11;
//! `qd` (0.8) has no exp_m1, ln_1p and hyperbolic functions, without which digits cancel near 0.

mod functions;

use std::ops::{Add, Div, Mul, Neg, Sub};

/// The unevaluated sum of two doubles, `hi` the double next to it.
///
/// Sums, products, quotients and square roots are within 1e-31 of the exact ones, relative; for the functions see
/// [`Real`](super::Real), whose every function here is within 1e-30, powers within 1e-30 (1 + |p ln m|) for x = 2^k m,
/// m between 0.7 and 1.5, sine and cosine only for |x| < 1e9. That needs room for the second double: below 1e-290 digits are
/// lost one by one, as with `f64` below 1e-308. What overflows is infinite, what has no value is NaN; both have the low part 0.
///
/// ```
/// use twinslip::number::DoubleDouble;
/// let third = DoubleDouble::from(1.0) / DoubleDouble::from(3.0);
/// assert!((third * 3.0 - 1.0).to_f64().abs() < 1e-31);
/// ```
// Normalised pairs compare as their parts do, one after the other.
#[derive(Debug, Clone, Copy, PartialEq, PartialOrd)]
pub struct DoubleDouble {
    hi: f64,
    lo: f64,
}

/// a + b and the rounding error, exactly (Knuth): of doubles, or of many side by side.
#[inline(always)]
pub(crate) fn two_sum<T: Copy + Add<Output = T> + Sub<Output = T>>(a: T, b: T) -> (T, T) {
    let sum = a + b;
    let virtual_b = sum - a;
    (sum, (a - (sum - virtual_b)) + (b - virtual_b))
}

/// The upper 26 bits of a double, rounded, and the lower ones: products of these parts are exact. Veltkamp's splitting by
/// a multiplication does the same, but takes longer and overflows above 2^996.
#[inline(always)]
fn split(a: f64) -> (f64, f64) {
    const HALF_A_UNIT: u64 = 1 << 26;
    const UPPER: u64 = !((1 << 27) - 1);
    let upper = f64::from_bits(a.to_bits().wrapping_add(HALF_A_UNIT) & UPPER);
    (upper, a - upper)
}

/// a b and the rounding error, exactly (Dekker), if neither overflows nor underflows.
///
/// Without the instruction a fused multiplication is a call of the library: no gain in products (8 against 9 ns), a loss in
/// quotients and logarithms (65 against 52 ns, 500 against 300 ns), and very slow on processors that lack it.
#[inline(always)]
fn two_product(a: f64, b: f64) -> (f64, f64) {
    let product = a * b;
    if cfg!(any(target_feature = "fma", target_arch = "aarch64")) {
        return (product, a.mul_add(b, -product));
    }
    let ((a1, a2), (b1, b2)) = (split(a), split(b));
    (product, ((a1 * b1 - product) + a1 * b2 + a2 * b1) + a2 * b2)
}

/// Multiplies by this and back where an intermediate would overflow.
const DOWN: f64 = 1.0 / UP;
const UP: f64 = (1u64 << 60) as f64;

impl DoubleDouble {
    /// 0
    pub const ZERO: Self = DoubleDouble { hi: 0.0, lo: 0.0 };
    /// 1
    pub const ONE: Self = DoubleDouble { hi: 1.0, lo: 0.0 };

    /// The sum of any two doubles, exactly, unless it overflows.
    #[inline(always)]
    pub fn new(a: f64, b: f64) -> Self {
        let (sum, error) = two_sum(a, b);
        Self::normalised(sum, error)
    }

    /// The same for doubles whose sum is finite: without the question whether it is.
    #[inline(always)]
    #[doc(hidden)]
    pub fn of_finite(a: f64, b: f64) -> Self {
        let (hi, lo) = two_sum(a, b);
        DoubleDouble { hi, lo }
    }

    /// The double next to it.
    #[inline(always)]
    pub fn hi(self) -> f64 {
        self.hi
    }

    /// What `hi` leaves: at most half a unit in its last place.
    #[inline(always)]
    pub fn lo(self) -> f64 {
        self.lo
    }

    /// The double next to it.
    #[inline(always)]
    pub fn to_f64(self) -> f64 {
        self.hi
    }

    /// Neither infinite nor NaN.
    #[inline(always)]
    pub fn is_finite(self) -> bool {
        self.hi.is_finite()
    }

    /// 1/x
    #[inline(always)]
    pub fn recip(self) -> Self {
        Self::ONE / self
    }

    /// sum + error, where |error| is at most about a unit in the last place of sum (Dekker's fast two-sum).
    #[inline(always)]
    fn normalised(sum: f64, error: f64) -> Self {
        let hi = sum + error;
        if hi.is_finite() {
            let lo = error - (hi - sum);
            DoubleDouble { hi, lo }
        } else {
            // an infinite sum has no meaningful error, and a sum that becomes infinite no low part
            let hi = if sum.is_finite() { hi } else { sum };
            DoubleDouble { hi, lo: 0.0 }
        }
    }

    /// x times a power of two: exact, unless it underflows.
    #[inline(always)]
    fn scaled(self, power: f64) -> Self {
        Self::normalised(self.hi * power, self.lo * power)
    }

    /// The product where a step of the usual way was not finite: it overflows, or a part only just did.
    #[cold]
    fn extreme_product(self, o: Self) -> Self {
        let product = self.hi * o.hi;
        if !(product.is_finite() && self.is_finite() && o.is_finite()) {
            return DoubleDouble::from(product);
        }
        let (large, small) = if self.hi.abs() > o.hi.abs() {
            (self, o)
        } else {
            (o, self)
        };
        (large.scaled(DOWN) * small).scaled(UP)
    }

    /// The quotient where a step of the usual way was not finite.
    #[cold]
    fn extreme_quotient(self, o: Self) -> Self {
        let quotient = self.hi / o.hi;
        if !(quotient.is_finite() && self.is_finite() && o.is_finite()) {
            return DoubleDouble::from(quotient);
        }
        if self.hi.abs() > o.hi.abs() {
            (self.scaled(DOWN) / o).scaled(UP)
        } else {
            self.scaled(DOWN) / o.scaled(DOWN)
        }
    }
}

impl From<f64> for DoubleDouble {
    #[inline(always)]
    fn from(x: f64) -> Self {
        DoubleDouble { hi: x, lo: 0.0 }
    }
}

impl Neg for DoubleDouble {
    type Output = Self;
    #[inline(always)]
    fn neg(self) -> Self {
        DoubleDouble {
            hi: -self.hi,
            lo: -self.lo,
        }
    }
}

// Not inlined: formulas hold hundreds of these, and a call costs little beside the work.
impl Add for DoubleDouble {
    type Output = Self;
    // relative error 3 u^2, u = 2^-53, however much cancels
    #[inline(never)]
    fn add(self, o: Self) -> Self {
        let (sum, error) = two_sum(self.hi, o.hi);
        let (low_sum, low_error) = two_sum(self.lo, o.lo);
        let first = Self::normalised(sum, error + low_sum);
        Self::normalised(first.hi, first.lo + low_error)
    }
}

impl Sub for DoubleDouble {
    type Output = Self;
    #[inline(never)]
    fn sub(self, o: Self) -> Self {
        self + -o
    }
}

impl Mul for DoubleDouble {
    type Output = Self;
    // relative error 4 u^2
    #[inline(never)]
    fn mul(self, o: Self) -> Self {
        let (product, error) = two_product(self.hi, o.hi);
        let cross = self.hi * o.lo + self.lo * o.hi;
        let result = Self::normalised(product, error + (cross + self.lo * o.lo));
        if result.is_finite() {
            result
        } else {
            self.extreme_product(o)
        }
    }
}

impl Div for DoubleDouble {
    type Output = Self;
    // long division: two digits of 53 bits each, and a third that rounds
    #[inline(never)]
    fn div(self, o: Self) -> Self {
        let first = self.hi / o.hi;
        let remainder = self - o * first;
        let second = remainder.hi / o.hi;
        let third = (remainder - o * second).hi / o.hi;
        let result = Self::normalised(first, second) + third;
        if result.is_finite() {
            result
        } else {
            self.extreme_quotient(o)
        }
    }
}

impl Add<f64> for DoubleDouble {
    type Output = Self;
    // relative error 2 u^2
    #[inline(never)]
    fn add(self, x: f64) -> Self {
        let (sum, error) = two_sum(self.hi, x);
        Self::normalised(sum, error + self.lo)
    }
}

impl Sub<f64> for DoubleDouble {
    type Output = Self;
    #[inline(always)]
    fn sub(self, x: f64) -> Self {
        self + -x
    }
}

impl Mul<f64> for DoubleDouble {
    type Output = Self;
    // relative error 2 u^2
    #[inline(never)]
    fn mul(self, x: f64) -> Self {
        let (product, error) = two_product(self.hi, x);
        let result = Self::normalised(product, error + self.lo * x);
        if result.is_finite() {
            result
        } else {
            self.extreme_product(DoubleDouble::from(x))
        }
    }
}

impl Div<f64> for DoubleDouble {
    type Output = Self;
    // relative error 3 u^2: what the first digit leaves is a double, but for the low part
    #[inline]
    fn div(self, x: f64) -> Self {
        let first = self.hi / x;
        let (product, error) = two_product(first, x);
        let second = ((self.hi - product) - error + self.lo) / x;
        let result = Self::normalised(first, second);
        if result.is_finite() {
            result
        } else {
            self.extreme_quotient(DoubleDouble::from(x))
        }
    }
}
