//! Elementary functions of sums of two doubles: exp by a series after reduction, ln by Newton's method on it, the others
//! from these two. Each is arranged so that nothing cancels, as relative errors near zeros have to stay small too.

use super::{DoubleDouble, two_product};
use crate::number::{Balance, Ratio, Real};

/// ln 2
const LN_2: DoubleDouble = DoubleDouble {
    hi: std::f64::consts::LN_2,
    lo: 2.3190468138462996e-17,
};

/// ln 2 in three parts, the first two of 42 bits: their products with exponents are exact (Cody and Waite, 1980).
const LN_2_PARTS: [f64; 3] = [
    0.6931471805598903,
    5.49792301870721e-14,
    1.1612227229362532e-26,
];

/// 1/7!, 1/6!, ... 1/2!
const INVERSE_FACTORIALS: [DoubleDouble; 6] = [
    DoubleDouble {
        hi: 0.0001984126984126984,
        lo: 1.7209558293420705e-22,
    },
    DoubleDouble {
        hi: 0.001388888888888889,
        lo: -5.300543954373577e-20,
    },
    DoubleDouble {
        hi: 0.008333333333333333,
        lo: 1.1564823173178714e-19,
    },
    DoubleDouble {
        hi: 0.041666666666666664,
        lo: 2.3129646346357427e-18,
    },
    DoubleDouble {
        hi: 0.16666666666666666,
        lo: 9.25185853854297e-18,
    },
    DoubleDouble { hi: 0.5, lo: 0.0 },
];

/// 1/14!, 1/13!, ... 1/8!: terms so small that their leading digits are enough.
const SMALL_INVERSE_FACTORIALS: [f64; 7] = [
    1.1470745597729725e-11,
    1.6059043836821613e-10,
    2.08767569878681e-09,
    2.505210838544172e-08,
    2.755731922398589e-07,
    2.7557319223985893e-06,
    2.48015873015873e-05,
];

/// Below this x and x + x^2/2 are the same number.
const LINEAR: f64 = 1e-33;
/// Below this x and x + x^3/6 are.
const ODD_LINEAR: f64 = 1e-17;
/// Above this e^-2x is nothing beside 1.
const ONE_EXPONENTIAL: f64 = 40.0;

/// pi/2 in four parts.
const HALF_PI_PARTS: [f64; 4] = [
    std::f64::consts::FRAC_PI_2,
    6.123233995736766e-17,
    -1.4973849048591698e-33,
    5.562271104316826e-50,
];
/// Beyond, pi/2 would take more parts, and the digits of the double must do.
const TURNS: f64 = 1e9;

/// 2^k for a normal number.
#[inline(always)]
fn power_of_two(k: i32) -> f64 {
    f64::from_bits(((k + 1023) as u64) << 52)
}

/// x 2^k for |k| < 2044, in two steps, as 2^k alone may overflow.
#[inline(always)]
fn times_power_of_two(x: DoubleDouble, k: i32) -> DoubleDouble {
    let half = k / 2;
    x.scaled(power_of_two(half)).scaled(power_of_two(k - half))
}

/// e^x - 1 for |x| < 0.36: the Taylor series at x/16, doubled four times by e^2x - 1 = (e^x - 1)^2 + 2 (e^x - 1).
fn exp_m1_near_zero(x: DoubleDouble) -> DoubleDouble {
    if x.hi.abs() < LINEAR {
        return x;
    }
    let q = x.scaled(1.0 / 16.0);
    let mut tail = 0.0;
    for c in SMALL_INVERSE_FACTORIALS {
        tail = tail * q.hi + c;
    }
    let mut series = DoubleDouble::from(tail);
    for c in INVERSE_FACTORIALS {
        series = series * q + c;
    }
    let mut s = q + q * q * series;
    for _ in 0..4 {
        s = s.scaled(2.0) + s * s;
    }
    s
}

/// k and s with e^x = 2^k (1 + s), |s| < 0.42, for |x| < 1500.
#[inline]
fn exp_parts(x: DoubleDouble) -> (i32, DoubleDouble) {
    let k = (x.hi * std::f64::consts::LOG2_E).round();
    let [first, second, third] = LN_2_PARTS;
    let reduced = x - k * first - k * second - k * third;
    (k as i32, exp_m1_near_zero(reduced))
}

/// ln(1 + t) for -0.3 < t < 0.42, by one step of Newton's method from the double's. The residual (1 + t) e^-y - 1 is formed
/// without the 1, to be accurate near 0.
fn ln_1p_near_zero(t: DoubleDouble) -> DoubleDouble {
    if t.hi.abs() < LINEAR {
        return t;
    }
    let y = t.hi.ln_1p();
    let e = exp_m1_near_zero(DoubleDouble::from(-y));
    let residual = t + (e + t * e);
    residual + y
}

/// k and m with x = 2^k m, m between 0.7 and 1.5, for finite x > 0.
#[inline]
fn exponent_and_mantissa(x: DoubleDouble) -> (i32, DoubleDouble) {
    // a subnormal number has no exponent to read
    let shift = if x.hi < 1e-290 { 100 } else { 0 };
    let x = times_power_of_two(x, shift);
    let exponent = (x.hi.to_bits() >> 52) as i32 - 1023;
    let m = times_power_of_two(x, -exponent);
    if m.hi > std::f64::consts::SQRT_2 {
        (exponent + 1 - shift, m.scaled(0.5))
    } else {
        (exponent - shift, m)
    }
}

/// sin r and cos r for |r| < 0.8, by their Taylor series.
fn sin_cos_near_zero(r: DoubleDouble) -> (DoubleDouble, DoubleDouble) {
    /// Terms beyond are below 1e-33.
    const ORDER: i32 = 29;
    let squared = r * r;
    let (mut sin, mut cos) = (DoubleDouble::ONE, DoubleDouble::ONE);
    // 1 - r^2/(2 3) (1 - r^2/(4 5) ...), 1 - r^2/(1 2) (1 - r^2/(3 4) ...)
    let mut n = ORDER;
    while n > 1 {
        let of = |n: i32| squared / f64::from(n * (n - 1));
        sin = -(of(n) * sin) + 1.0;
        cos = -(of(n - 1) * cos) + 1.0;
        n -= 2;
    }
    (sin * r, cos)
}

/// x less the nearest multiple of pi/2, and that multiple, for |x| < [`TURNS`].
fn quarters(x: DoubleDouble) -> (DoubleDouble, i64) {
    let k = (x.hi * std::f64::consts::FRAC_2_PI).round();
    let mut rest = x;
    for part in HALF_PI_PARTS {
        let (product, error) = two_product(k, part);
        rest = rest - product - error;
    }
    (rest, k as i64)
}

/// e^x / 2 for x > 40, however close to overflow.
fn half_exponential(x: DoubleDouble) -> DoubleDouble {
    let root = x.scaled(0.5).exp();
    root.scaled(0.5) * root
}

impl Real for DoubleDouble {
    #[inline(always)]
    fn constant(x: f64) -> Self {
        DoubleDouble::from(x)
    }

    #[inline(always)]
    fn leading(self) -> f64 {
        self.hi
    }

    fn exp(self) -> Self {
        // beyond, and for NaN, the double says it all: 0 or infinity
        let moderate = self.hi.abs() < 750.0;
        if !moderate {
            return DoubleDouble::from(self.hi.exp());
        }
        let (k, s) = exp_parts(self);
        times_power_of_two(s + 1.0, k)
    }

    fn exp_m1(self) -> Self {
        // beyond, one of the two terms is nothing beside the other
        let moderate = self.hi.abs() < 80.0;
        if !moderate {
            return self.exp() - 1.0;
        }
        let (k, s) = exp_parts(self);
        let power = power_of_two(k);
        s.scaled(power) + (DoubleDouble::from(power) - 1.0)
    }

    fn ln(self) -> Self {
        if !(self.hi > 0.0 && self.hi.is_finite()) {
            return DoubleDouble::from(self.hi.ln());
        }
        let (k, m) = exponent_and_mantissa(self);
        LN_2 * f64::from(k) + ln_1p_near_zero(m - 1.0)
    }

    fn ln_1p(self) -> Self {
        if (-0.29..0.41).contains(&self.hi) {
            ln_1p_near_zero(self)
        } else {
            (self + 1.0).ln()
        }
    }

    // 2^(p k) e^(p ln m): the large part of the exponent is exact.
    fn powf(self, p: f64) -> Self {
        let estimate = p * self.hi.ln();
        if !(self.hi > 0.0 && self.hi.is_finite() && estimate.abs() < 750.0) {
            let value = self.hi.powf(p);
            return DoubleDouble::from(if self.hi < 0.0 { f64::NAN } else { value });
        }
        let (k, m) = exponent_and_mantissa(self);
        let (product, error) = two_product(p, f64::from(k));
        let twos = product.round();
        let rest = DoubleDouble::new(product - twos, error);
        let (more_twos, s) = exp_parts(LN_2 * rest + ln_1p_near_zero(m - 1.0) * p);
        times_power_of_two(s + 1.0, twos as i32 + more_twos)
    }

    // Exact in a power that is a double.
    fn pow(self, p: Self) -> Self {
        if p.lo == 0.0 {
            self.powf(p.hi)
        } else {
            (p * self.ln()).exp()
        }
    }

    // The double's root and one Newton correction, at a scale where the remainder neither overflows nor underflows.
    fn sqrt(self) -> Self {
        if !(self.hi > 0.0 && self.hi.is_finite()) {
            return DoubleDouble::from(self.hi.sqrt());
        }
        let (k, _) = exponent_and_mantissa(self);
        let half = k / 2;
        let x = times_power_of_two(self, -2 * half);
        let root = x.hi.sqrt();
        let (square, error) = two_product(root, root);
        let correction = ((x.hi - square) - error + x.lo) / (2.0 * root);
        times_power_of_two(Self::normalised(root, correction), half)
    }

    fn sinh(self) -> Self {
        let x = self.abs();
        let value = if x.hi < ODD_LINEAR {
            x
        } else if x.hi < ONE_EXPONENTIAL {
            let e = x.exp_m1();
            (e + e / (e + 1.0)).scaled(0.5)
        } else {
            half_exponential(x)
        };
        value.with_sign_of(self)
    }

    fn cosh(self) -> Self {
        let x = self.abs();
        if x.hi < ONE_EXPONENTIAL {
            let e = x.exp();
            (e + e.recip()).scaled(0.5)
        } else {
            half_exponential(x)
        }
    }

    fn asinh(self) -> Self {
        let x = self.abs();
        let value = if x.hi < ODD_LINEAR {
            x
        } else if x.hi < 1e17 {
            let square = x * x;
            (x + square / ((square + 1.0).sqrt() + 1.0)).ln_1p()
        } else {
            x.ln() + LN_2
        };
        value.with_sign_of(self)
    }

    // By e^(-2|x|) - 1, which neither overflows nor cancels.
    fn tanh(self) -> Self {
        let m = self.abs().scaled(-2.0).exp_m1();
        (-m / (m + 2.0)).with_sign_of(self)
    }

    fn sin_cos(self) -> (Self, Self) {
        let counted = self.hi.abs() < TURNS;
        if !counted {
            let (sin, cos) = self.hi.sin_cos();
            return (sin.into(), cos.into());
        }
        let (rest, quarters) = quarters(self);
        let (sin, cos) = sin_cos_near_zero(rest);
        match quarters.rem_euclid(4) {
            0 => (sin, cos),
            1 => (cos, -sin),
            2 => (-sin, -cos),
            _ => (-cos, sin),
        }
    }

    // The double's, and what is left by the addition theorem: its third power is nothing.
    fn atan(self) -> Self {
        /// Beyond, atan x = pi/2 - 1/x + 1/(3 x^3) to all digits.
        const LARGE: f64 = 1e8;
        if self.hi.is_nan() || self.hi.abs() < ODD_LINEAR {
            return self;
        }
        if self.hi.abs() > LARGE {
            let inverse = self.abs().recip();
            let [first, second, ..] = HALF_PI_PARTS;
            let third = inverse.hi * inverse.hi * inverse.hi / 3.0;
            let value = DoubleDouble::new(first, second) - inverse + third;
            return value.with_sign_of(self);
        }
        let near = DoubleDouble::from(self.hi.atan());
        let (sin, cos) = Real::sin_cos(near);
        near + (self * cos - sin) / (self * sin + cos)
    }

    #[inline(always)]
    fn abs(self) -> Self {
        self.with_sign_of(DoubleDouble::ONE)
    }

    // The double's, and Newton's method from there.
    fn balanced(self, g: Balance<Self>) -> (Self, Self) {
        let mut y = DoubleDouble::from(g.map(|c| c.hi).solve(self.hi));
        for _ in 0..2 {
            y = g.newton(self, y);
        }
        (y, g.at(y).0)
    }

    fn ratio(self, ratio: Ratio) -> Self {
        match ratio {
            Ratio {
                numerator,
                derivative: 0,
            } if self.hi != 0.0 => numerator.of(self) / self,
            _ => ratio.by_coefficients(self),
        }
    }
}

impl DoubleDouble {
    /// x or -x, whichever has the sign of the other.
    #[inline(always)]
    fn with_sign_of(self, other: Self) -> Self {
        if self.hi.is_sign_negative() == other.hi.is_sign_negative() {
            self
        } else {
            -self
        }
    }
}
