//! Intervals with outward rounding: the true value of a formula lies inside, whatever the rounding of its operations.
//!
//! Used to certify: a zero is enclosed where the sign at both ends is certain, an equilibrium is stable where the
//! Routh-Hurwitz conditions hold for the whole interval, and undecided where they don't. Endpoints that are not finite
//! simply certify nothing.

use super::{Balance, Numerator, Ratio, Real};
use std::ops::{Add, Div, Mul, Neg, Sub};

/// How many units in the last place a function of the C mathematical library may be off, with a margin: glibc documents
/// at most 2 for the functions used here.
const LIBRARY_ULPS: usize = 4;

/// A closed interval.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Interval {
    lo: f64,
    hi: f64,
}

impl Interval {
    /// The interval from `lo` to `hi`.
    pub fn new(lo: f64, hi: f64) -> Self {
        Interval { lo, hi }
    }

    /// Everything within `radius` of `middle`.
    pub fn around(middle: f64, radius: f64) -> Self {
        Interval {
            lo: (middle - radius).next_down(),
            hi: (middle + radius).next_up(),
        }
    }

    /// Lower end.
    pub fn lo(self) -> f64 {
        self.lo
    }

    /// Upper end.
    pub fn hi(self) -> f64 {
        self.hi
    }

    /// The sign, where it is certain.
    pub fn sign(self) -> Option<f64> {
        if self.lo > 0.0 {
            Some(1.0)
        } else if self.hi < 0.0 {
            Some(-1.0)
        } else {
            None
        }
    }

    /// The largest distance of a point of the interval from x.
    pub fn distance_from(self, x: f64) -> f64 {
        (self.hi - x).max(x - self.lo).next_up()
    }

    /// What two bounds of the same number have in common; the second where rounding leaves nothing of that.
    pub fn common(self, other: Self) -> Self {
        let lo = self.lo.max(other.lo);
        let hi = self.hi.min(other.hi);
        if lo <= hi { Interval { lo, hi } } else { other }
    }

    fn widened(lo: f64, hi: f64, ulps: usize) -> Self {
        let (mut lo, mut hi) = (lo, hi);
        for _ in 0..ulps {
            lo = lo.next_down();
            hi = hi.next_up();
        }
        Interval { lo, hi }.known()
    }

    /// The same; everything where an end is no number, as comparisons overlook these.
    fn known(self) -> Self {
        if self.lo.is_nan() || self.hi.is_nan() {
            return Self::EVERYTHING;
        }
        self
    }

    /// A wave of the mathematical library that is largest, 1, at so many turns and all turns after, and least half a turn later.
    fn wave(self, g: impl Fn(f64) -> f64, crest: f64) -> Self {
        /// So far from 0 the turns are not counted.
        const FAR: f64 = 1e6;
        /// What the count may be off by.
        const UNSURE: f64 = 1e-9;
        let turns = |x: f64| x / std::f64::consts::TAU;
        if !(self.lo > -FAR && self.hi < FAR) {
            return Interval { lo: -1.0, hi: 1.0 };
        }
        let meets = |at: f64| {
            (turns(self.hi) - at + UNSURE).floor() >= (turns(self.lo) - at - UNSURE).ceil()
        };
        let (a, b) = (g(self.lo), g(self.hi));
        let ends = Self::widened(a.min(b), a.max(b), LIBRARY_ULPS);
        Interval {
            lo: if meets(crest + 0.5) { -1.0 } else { ends.lo },
            hi: if meets(crest) { 1.0 } else { ends.hi },
        }
        .within_one()
    }

    /// The part of it between -1 and 1.
    fn within_one(self) -> Self {
        Interval {
            lo: self.lo.max(-1.0),
            hi: self.hi.min(1.0),
        }
    }

    /// A non-decreasing function of the mathematical library.
    fn monotone(self, g: impl Fn(f64) -> f64) -> Self {
        Self::widened(g(self.lo), g(self.hi), LIBRARY_ULPS)
    }

    /// The hull of an operation on the ends, each result known with the sign of its rounding error.
    fn corners(a: Self, b: Self, operation: impl Fn(f64, f64) -> Rounded) -> Self {
        let candidates = [
            operation(a.lo, b.lo),
            operation(a.lo, b.hi),
            operation(a.hi, b.lo),
            operation(a.hi, b.hi),
        ];
        if candidates.iter().any(|x| x.value.is_nan()) {
            return Self::EVERYTHING;
        }
        let lo = candidates
            .iter()
            .map(Rounded::below)
            .fold(f64::INFINITY, f64::min);
        let hi = candidates
            .iter()
            .map(Rounded::above)
            .fold(f64::NEG_INFINITY, f64::max);
        Interval { lo, hi }
    }

    const EVERYTHING: Self = Interval {
        lo: f64::NEG_INFINITY,
        hi: f64::INFINITY,
    };
}

/// A rounded result and a number of the sign of (exact - rounded), from an error-free transformation. An exact result is
/// not widened: the gap of two close points stays as sharp as it is.
#[derive(Debug, Clone, Copy)]
struct Rounded {
    value: f64,
    error: f64,
}

impl Rounded {
    // Knuth's two-sum
    fn sum(a: f64, b: f64) -> Self {
        let value = a + b;
        let virtual_b = value - a;
        Rounded {
            value,
            error: (a - (value - virtual_b)) + (b - virtual_b),
        }
    }

    fn product(a: f64, b: f64) -> Self {
        let value = a * b;
        let error = if a == 0.0 || b == 0.0 {
            0.0
        } else {
            Self::trusted(value, a.mul_add(b, -value))
        };
        Rounded { value, error }
    }

    fn quotient(a: f64, b: f64) -> Self {
        let value = a / b;
        let remainder = (-value).mul_add(b, a);
        let signed = if b < 0.0 { -remainder } else { remainder };
        Rounded {
            value,
            error: if a == 0.0 {
                0.0
            } else {
                Self::trusted(value, signed)
            },
        }
    }

    /// Near the ends of the range the transformation itself may round: then nothing is known of the sign.
    fn trusted(value: f64, error: f64) -> f64 {
        if (1e-280..1e280).contains(&value.abs()) {
            error
        } else {
            f64::NAN
        }
    }

    fn below(&self) -> f64 {
        if self.error >= 0.0 {
            self.value
        } else {
            self.value.next_down()
        }
    }

    fn above(&self) -> f64 {
        if self.error <= 0.0 {
            self.value
        } else {
            self.value.next_up()
        }
    }
}

impl Neg for Interval {
    type Output = Self;
    fn neg(self) -> Self {
        Interval {
            lo: -self.hi,
            hi: -self.lo,
        }
    }
}

impl Add for Interval {
    type Output = Self;
    fn add(self, o: Self) -> Self {
        Interval {
            lo: Rounded::sum(self.lo, o.lo).below(),
            hi: Rounded::sum(self.hi, o.hi).above(),
        }
        .known()
    }
}

impl Sub for Interval {
    type Output = Self;
    fn sub(self, o: Self) -> Self {
        self + -o
    }
}

impl Mul for Interval {
    type Output = Self;
    fn mul(self, o: Self) -> Self {
        Self::corners(self, o, Rounded::product)
    }
}

impl Div for Interval {
    type Output = Self;
    fn div(self, o: Self) -> Self {
        if o.lo <= 0.0 && o.hi >= 0.0 {
            return Interval {
                lo: f64::NEG_INFINITY,
                hi: f64::INFINITY,
            };
        }
        Self::corners(self, o, Rounded::quotient)
    }
}

impl Add<f64> for Interval {
    type Output = Self;
    fn add(self, x: f64) -> Self {
        self + Self::constant(x)
    }
}

impl Sub<f64> for Interval {
    type Output = Self;
    fn sub(self, x: f64) -> Self {
        self - Self::constant(x)
    }
}

impl Mul<f64> for Interval {
    type Output = Self;
    fn mul(self, x: f64) -> Self {
        self * Self::constant(x)
    }
}

impl Div<f64> for Interval {
    type Output = Self;
    fn div(self, x: f64) -> Self {
        self / Self::constant(x)
    }
}

impl Real for Interval {
    fn constant(x: f64) -> Self {
        Interval { lo: x, hi: x }
    }
    fn leading(self) -> f64 {
        0.5 * self.lo + 0.5 * self.hi
    }
    fn exp(self) -> Self {
        self.monotone(f64::exp)
    }
    fn exp_m1(self) -> Self {
        self.monotone(f64::exp_m1)
    }
    fn ln(self) -> Self {
        self.monotone(f64::ln)
    }
    fn ln_1p(self) -> Self {
        self.monotone(f64::ln_1p)
    }
    fn powf(self, p: f64) -> Self {
        let rising = self.monotone(|x| x.powf(p.abs()));
        if p < 0.0 {
            Self::constant(1.0) / rising
        } else {
            rising
        }
    }
    fn sqrt(self) -> Self {
        Self::widened(self.lo.sqrt(), self.hi.sqrt(), 1)
    }
    fn sinh(self) -> Self {
        self.monotone(f64::sinh)
    }
    fn cosh(self) -> Self {
        let outer = self.lo.abs().max(self.hi.abs()).cosh();
        let inner = if self.lo <= 0.0 && self.hi >= 0.0 {
            1.0
        } else {
            self.lo.abs().min(self.hi.abs()).cosh()
        };
        Self::widened(inner, outer, LIBRARY_ULPS)
    }
    fn asinh(self) -> Self {
        self.monotone(<f64 as Real>::asinh)
    }
    fn sin_cos(self) -> (Self, Self) {
        (self.wave(f64::sin, 0.25), self.wave(f64::cos, 0.0))
    }
    fn tanh(self) -> Self {
        self.monotone(f64::tanh).within_one()
    }
    fn atan(self) -> Self {
        self.monotone(f64::atan)
    }
    fn log10(self) -> Self {
        self.monotone(f64::log10)
    }
    fn sign(self) -> Self {
        Interval {
            lo: if self.lo >= 0.0 { 1.0 } else { -1.0 },
            hi: if self.hi < 0.0 { -1.0 } else { 1.0 },
        }
    }
    fn lesser(self, o: Self) -> Self {
        Interval {
            lo: self.lo.min(o.lo),
            hi: self.hi.min(o.hi),
        }
    }
    fn greater(self, o: Self) -> Self {
        Interval {
            lo: self.lo.max(o.lo),
            hi: self.hi.max(o.hi),
        }
    }
    fn abs(self) -> Self {
        if self.lo >= 0.0 {
            self
        } else if self.hi <= 0.0 {
            -self
        } else {
            Interval {
                lo: 0.0,
                hi: (-self.lo).max(self.hi),
            }
        }
    }
    fn balanced(self, g: Balance<Self>) -> (Self, Self) {
        let y = g.enclose(self);
        (y, g.at(y).0)
    }
    fn ratio(self, ratio: Ratio) -> Self {
        if ratio.derivative == 0 {
            return self.of_ratio(ratio.numerator);
        }
        /// A part that is no wider than this around 0 goes by coefficients, as these are summed far beyond what is rounded.
        const NEAR: f64 = 0.25;
        let part = |lo: f64, hi: f64| {
            let part = Interval {
                lo: self.lo.max(lo),
                hi: self.hi.min(hi),
            };
            (part.lo <= part.hi).then_some(part)
        };
        let parts = [
            part(f64::NEG_INFINITY, -NEAR).map(|x| x.derivative_of_ratio(ratio)),
            part(-NEAR, NEAR).map(|x| ratio.by_coefficients(x)),
            part(NEAR, f64::INFINITY).map(|x| x.derivative_of_ratio(ratio)),
        ];
        let hull = |a: Self, b: Self| Interval {
            lo: a.lo.min(b.lo),
            hi: a.hi.max(b.hi),
        };
        let all = parts.into_iter().flatten().map(Self::known).reduce(hull);
        all.unwrap_or(Self::EVERYTHING)
    }
}

impl Interval {
    /// N(x)/x. All but sin(x)/x rise or fall with x, or with |x|.
    fn of_ratio(self, numerator: Numerator) -> Self {
        /// The least of sin(x)/x, below it.
        const LEAST: f64 = -0.217_234;
        /// Of a quotient of a function of the library, in its last place.
        const ULPS: usize = LIBRARY_ULPS + 1;
        let at = |x: f64| x.ratio(numerator.into());
        let (outer, inner) = (self.abs().hi, self.abs().lo);
        let ends = match numerator {
            Numerator::ExpM1 => [at(self.lo), at(self.hi)],
            Numerator::Ln1p => [at(self.hi), at(self.lo)],
            Numerator::Sinh => [at(inner), at(outer)],
            Numerator::Tanh => [at(outer), at(inner)],
            Numerator::Sin if outer <= std::f64::consts::PI => [at(outer), at(inner)],
            Numerator::Sin => {
                let quotient = self.sin() / self;
                return Interval {
                    lo: quotient.lo.max(LEAST),
                    hi: quotient.hi.min(1.0),
                };
            }
        };
        Self::widened(ends[0], ends[1], ULPS)
    }

    /// f^(d) of f(x) = N(x)/x by x f^(d) + d f^(d-1) = N^(d), where x is not 0.
    fn derivative_of_ratio(self, ratio: Ratio) -> Self {
        let x = super::Jet::<_, 1>::variable(self, 0);
        match ratio.derivative {
            0 => self.of_ratio(ratio.numerator),
            1 => {
                let slope = ratio.numerator.of(x).gradient[0];
                (slope - self.of_ratio(ratio.numerator)) / self
            }
            // Wider than it need be: no formula asks for it.
            _ => Self::EVERYTHING,
        }
    }
}
