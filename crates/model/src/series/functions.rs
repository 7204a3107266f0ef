//! The exponential, the logarithm, powers and hyperbolic functions of whole registers.
//!
//! Written once for all widths, in additions, fused multiplications and operations on the bits: a lane gets the same bits
//! whatever its neighbours hold and however many they are. Lanes where a function is not an ordinary number (overflow,
//! subnormal or negative arguments, no numbers) get what the library says, one by one.
//!
//! Largest errors, in units in the last place, found and asserted in `tests/lanes.rs`: exp 0.99 and 1, ln 0.53 and 0.75,
//! sinh 1.5 and 3, cosh 1.3 and 2; x^p 1 and in addition 3e-18 |p| of itself.

use super::element::Element;
use std::f64::consts::LOG2_E;

/// What the functions need of a register beside arithmetic.
pub(super) trait Register: Element {
    /// The sum of the lanes taken as whole numbers of 64 bits.
    fn plus_bits(self, other: Self) -> Self;
    /// Their difference.
    fn minus_bits(self, other: Self) -> Self;
    /// The bits that both have.
    fn and(self, other: Self) -> Self;
    /// The bits that one of them has.
    fn or(self, other: Self) -> Self;
    /// The bits that only one of them has.
    fn xor(self, other: Self) -> Self;
    /// The lowest bits in the place of sign and exponent.
    fn into_exponent(self) -> Self;
    /// Sign and exponent in the place of the lowest bits.
    fn exponent_bits(self) -> Self;
    /// a in the lanes where self < limit, else b.
    fn if_less(self, limit: Self, a: Self, b: Self) -> Self;
    /// Whether self < limit in every lane.
    fn all_less(self, limit: Self) -> bool;
    /// `fast` in the lanes where size < limit, else `exact` of self: for the few that are no ordinary numbers.
    fn mend(self, size: Self, limit: f64, fast: Self, exact: impl Fn(f64) -> f64) -> Self;

    /// These bits in every lane.
    #[inline(always)]
    fn bits(self, bits: u64) -> Self {
        self.like(f64::from_bits(bits))
    }
    /// Its magnitude, by its bits.
    #[inline(always)]
    fn magnitude(self) -> Self {
        self.and(self.bits(!SIGN))
    }
    /// Its sign, as a bit.
    #[inline(always)]
    fn sign_bit(self) -> Self {
        self.and(self.bits(SIGN))
    }
}

/// The bit of the sign.
pub(super) const SIGN: u64 = 1 << 63;
/// The bits of sign and exponent.
const EXPONENT: u64 = 0xfff << 52;
/// The exponent of 1.
const ONE: u64 = 1023 << 52;
/// Added to a number below 2^51, this leaves the nearest whole number in the last bits.
const SHIFT: f64 = 6755399441055744.0;
/// 2^52, in whose last bits whole numbers stand as they are.
const WHOLE: f64 = 4503599627370496.0;
/// ln 2 in two parts, of which the first leaves room for whole factors up to 2^20.
const LN_2: (f64, f64) = (0.6931471803691238, 1.9082149292705877e-10);
/// Below these, exp is an ordinary number.
const EXP_LIMIT: f64 = 708.0;

/// 1/(2+j)!: exp r = 1 + r + r^2 (these). Enough for |r| < ln(2)/2: the next is below 4e-18.
const OF_EXP: [f64; 12] = {
    let mut c = [0.5; 12];
    let mut j = 1;
    while j < 12 {
        c[j] = c[j - 1] / (j + 2) as f64;
        j += 1;
    }
    c
};
/// 2/(2j+3): ln m = 2 s + s^3 (these in s^2) with s = (m-1)/(m+1). Enough for m within sqrt(2) of 1.
const OF_LN: [f64; 12] = {
    let mut c = [0.0; 12];
    let mut j = 0;
    while j < 12 {
        c[j] = 2.0 / (2 * j + 3) as f64;
        j += 1;
    }
    c
};
/// 1/(2j+3)!: sinh x = x + x^3 (these in x^2). Enough for |x| < 1.
const OF_SINH: [f64; 8] = {
    let mut c = [1.0 / 6.0; 8];
    let mut j = 1;
    while j < 8 {
        c[j] = c[j - 1] / ((2 * j + 2) * (2 * j + 3)) as f64;
        j += 1;
    }
    c
};

/// The polynomial at z, of a multiple of four coefficients: four at a time, in chains a quarter as long.
#[inline(always)]
fn polynomial<E: Element, const N: usize>(c: &[f64; N], z: E) -> E {
    const { assert!(N.is_multiple_of(4)) };
    let squared = z * z;
    let fourth = squared * squared;
    let mut sum = z.like(0.0);
    let mut j = N;
    while j > 0 {
        j -= 4;
        let low = z.like(c[j + 1]).mul_add(z, z.like(c[j]));
        let high = z.like(c[j + 3]).mul_add(z, z.like(c[j + 2]));
        let four = high.mul_add(squared, low);
        sum = if j + 4 == N {
            four
        } else {
            sum.mul_add(fourth, four)
        };
    }
    sum
}

/// exp(x + y) for |x| < 708 and y far smaller. Modulo ln 2, then by its series; the power of two by bits.
#[inline(always)]
fn exp_of_sum<E: Register>(x: E, y: E) -> E {
    let shifted = x.mul_add(x.like(LOG2_E), x.like(SHIFT));
    let n = shifted - x.like(SHIFT);
    // The first part is exact.
    let r = n.mul_add(x.like(-LN_2.0), x);
    let r = r + n.mul_add(x.like(-LN_2.1), y);
    let tail = polynomial(&OF_EXP, r);
    let e = (r * r).mul_add(tail, r) + x.like(1.0);
    e.plus_bits(shifted.into_exponent())
}

/// ln x in two parts, for normal x > 0. Errs by less than 3e-18, or by that of itself.
#[inline(always)]
fn ln_in_parts<E: Register>(x: E) -> (E, E) {
    // The mantissa between sqrt(1/2) and sqrt(2), and the exponent to it.
    let above = x
        .minus_bits(x.bits(0x3fe6_a09e_667f_3bcd))
        .plus_bits(x.bits(ONE));
    let m = x
        .minus_bits(above.and(x.bits(EXPONENT)))
        .plus_bits(x.bits(ONE));
    let n = above.exponent_bits().or(x.like(WHOLE)) - x.like(WHOLE + 1023.0);
    // s = f / (2 + f) in two parts.
    let f = m - x.like(1.0);
    let d = f + x.like(2.0);
    let d_error = f - (d - x.like(2.0));
    let over = x.like(1.0) / d;
    let s = f * over;
    let rest = (-s).mul_add(d, f);
    let s_error = (-s).mul_add(d_error, rest) * over;
    let z = s * s;
    let tail = (s * z) * polynomial(&OF_LN, z);
    // n ln 2 + 2 s: the first part of n ln 2 is exact, and is 0 or larger than 2 s.
    let (big, small) = (n * x.like(LN_2.0), s + s);
    let hi = big + small;
    let lo = (small - (hi - big)) + n.mul_add(x.like(LN_2.1), tail + (s_error + s_error));
    let sum = hi + lo;
    (sum, lo - (sum - hi))
}

#[inline(always)]
pub(super) fn exp<E: Register>(x: E) -> E {
    let fast = exp_of_sum(x, x.like(0.0));
    let size = x.magnitude();
    if size.all_less(x.like(EXP_LIMIT)) {
        return fast;
    }
    x.mend(size, EXP_LIMIT, fast, f64::exp)
}

/// `size` in the lanes where x is normal and positive, else infinity.
#[inline(always)]
fn where_normal<E: Register>(x: E, size: E) -> E {
    const LARGEST_SUBNORMAL: f64 = f64::from_bits((1 << 52) - 1);
    let infinity = x.like(f64::INFINITY);
    let size = x.if_less(infinity, size, infinity);
    x.like(LARGEST_SUBNORMAL).if_less(x, size, infinity)
}

#[inline(always)]
pub(super) fn ln<E: Register>(x: E) -> E {
    let (fast, _) = ln_in_parts(x);
    let size = where_normal(x, x);
    if size.all_less(x.like(f64::INFINITY)) {
        return fast;
    }
    x.mend(size, f64::INFINITY, fast, f64::ln)
}

/// x^p = exp(p ln x), with ln x in two parts: what rounding takes from p ln x the power would show as many times larger.
#[inline(always)]
pub(super) fn powf<E: Register>(x: E, p: f64) -> E {
    let (hi, lo) = ln_in_parts(x);
    let power = x.like(p);
    let y = hi * power;
    let error = hi.mul_add(power, -y);
    let fast = exp_of_sum(y, lo.mul_add(power, error));
    let size = where_normal(x, y.magnitude());
    if size.all_less(x.like(EXP_LIMIT)) {
        return fast;
    }
    x.mend(size, EXP_LIMIT, fast, |x| x.powf(p))
}

/// x^p e^y, with every lane of x next to as many of y as `spread` makes of it: the exponential of a sum of which no rounding error is
/// left out. `None` where a lane is not an ordinary number.
#[inline(always)]
pub(super) fn power_and_exponentials<E: Register, W: Register>(
    x: E,
    p: f64,
    y: W,
    spread: impl Fn(E) -> W,
) -> Option<W> {
    let (hi, lo) = ln_in_parts(x);
    let power = x.like(p);
    let log = hi * power;
    let log_error = lo.mul_add(power, hi.mul_add(power, -log));
    let (wide, wide_error) = (spread(log), spread(log_error));
    let sum = wide + y;
    let of_y = sum - wide;
    let error = (wide - (sum - of_y)) + (y - of_y) + wide_error;
    let (normal, limit) = (where_normal(x, x.like(0.0)), y.like(EXP_LIMIT));
    let ordinary = normal.all_less(x.like(1.0)) & sum.magnitude().all_less(limit);
    ordinary.then(|| exp_of_sum(sum, error))
}

/// By one exponential; sinh where that cancels by its series.
#[inline(always)]
pub(super) fn sinh_cosh<E: Register>(x: E) -> (E, E) {
    let (one, half) = (x.like(1.0), x.like(0.5));
    let size = x.magnitude();
    let e = exp_of_sum(size, x.like(0.0));
    let (up, down) = (e * half, half / e);
    let (mut sinh, mut cosh) = ((up - down).or(x.sign_bit()), up + down);
    if !one.all_less(size) {
        let z = x * x;
        let near = (x * z).mul_add(polynomial(&OF_SINH, z), x);
        sinh = one.if_less(size, sinh, near);
    }
    if !size.all_less(x.like(EXP_LIMIT)) {
        sinh = x.mend(size, EXP_LIMIT, sinh, f64::sinh);
        cosh = x.mend(size, EXP_LIMIT, cosh, f64::cosh);
    }
    (sinh, cosh)
}

/// log2 x from the bits of x: its exponent, and its mantissa by a parabola.
#[inline(always)]
pub(super) fn rough_log2<E: Register>(x: E) -> E {
    let exponent = x.exponent_bits().or(x.like(WHOLE)) - x.like(WHOLE + 1023.0);
    let f = x.and(x.bits(!EXPONENT)).or(x.bits(ONE)) - x.like(1.0);
    exponent + f * (x.like(1.344) - x.like(0.344) * f)
}

/// 2^x by bits.
#[inline(always)]
pub(super) fn rough_exp2<E: Register>(x: E) -> E {
    let x = Element::min(Element::max(x, x.like(-1000.0)), x.like(1000.0));
    let shifted = (x - x.like(0.5)) + x.like(SHIFT);
    let f = x - (shifted - x.like(SHIFT));
    let scaled = x.like(1.0) + f * (x.like(0.6565) + x.like(0.3435) * f);
    scaled.plus_bits(shifted.into_exponent())
}
