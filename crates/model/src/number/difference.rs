//! The values of a formula at two points and their difference, without cancellation.
//!
//! Two steady slip rates that carry the same stress are zeros of tau_ss(V_1) - tau_ss(V_2). Close to a pitchfork the two
//! rates merge, and subtracting two rounded stresses leaves no digit of the answer. Here the difference is carried through
//! the formula by the addition theorems, so it keeps its relative accuracy however close the points are.

use super::{Balance, Ratio, Real};
use std::ops::{Add, Div, Mul, Neg, Sub};

/// `first`, `second` and `gap` = first - second.
///
/// The addition theorems are left where values are so far apart, or of such signs, that subtraction does as well. Not so if
/// they are ORDERED: where a formula takes logarithms and powers of numbers with first > second > 0 only, and magnitudes
/// and inverse tangents of two that have the same sign, the theorems serve at any distance, and the same operations are done
/// whatever the numbers.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Difference<T, const ORDERED: bool = false> {
    /// Value at the first point.
    pub first: T,
    /// Value at the second point.
    pub second: T,
    /// First minus second, with its own relative accuracy.
    pub gap: T,
}

impl<T: Real> Difference<T> {
    /// Two points whose difference is known.
    #[inline(always)]
    pub fn new(first: T, second: T, gap: T) -> Self {
        Difference { first, second, gap }
    }
}

impl<T: Real> Difference<T, true> {
    /// Two points in a formula whose logarithms and powers are of ordered numbers.
    #[inline(always)]
    pub fn ordered(first: T, second: T, gap: T) -> Self {
        Difference { first, second, gap }
    }
}

impl<T: Real, const ORDERED: bool> Difference<T, ORDERED> {
    /// Where the values are far apart subtraction is as good as an addition theorem, and can't overflow.
    #[inline(always)]
    fn far_apart(&self) -> bool {
        if ORDERED {
            return false;
        }
        let (a, b) = (self.first.leading(), self.second.leading());
        !(a * b > 0.0 && (0.25..4.0).contains(&(a / b)))
    }

    /// ln(first / second) where they are not far apart.
    #[inline(always)]
    fn log_ratio(self) -> T {
        (self.gap / self.second).ln_1p()
    }

    #[inline(always)]
    fn direct(self, g: impl Fn(T) -> T) -> Self {
        let (first, second) = (g(self.first), g(self.second));
        Difference {
            first,
            second,
            gap: first - second,
        }
    }
}

impl<T: Real, const ORDERED: bool> Neg for Difference<T, ORDERED> {
    type Output = Self;
    #[inline(always)]
    fn neg(self) -> Self {
        Difference {
            first: -self.first,
            second: -self.second,
            gap: -self.gap,
        }
    }
}

impl<T: Real, const ORDERED: bool> Add for Difference<T, ORDERED> {
    type Output = Self;
    #[inline(always)]
    fn add(self, o: Self) -> Self {
        Difference {
            first: self.first + o.first,
            second: self.second + o.second,
            gap: self.gap + o.gap,
        }
    }
}

impl<T: Real, const ORDERED: bool> Sub for Difference<T, ORDERED> {
    type Output = Self;
    #[inline(always)]
    fn sub(self, o: Self) -> Self {
        self + -o
    }
}

impl<T: Real, const ORDERED: bool> Mul for Difference<T, ORDERED> {
    type Output = Self;
    // a1 a2 - b1 b2 = (a1 - b1) a2 + b1 (a2 - b2) = (a1 - b1) b2 + a1 (a2 - b2)
    #[inline(always)]
    fn mul(self, o: Self) -> Self {
        // Of a slip rate that falls and a state that rises, no part of the latter is larger than the products.
        let gap = if ORDERED {
            self.gap * o.second + self.first * o.gap
        } else {
            self.gap * o.first + self.second * o.gap
        };
        Difference {
            first: self.first * o.first,
            second: self.second * o.second,
            gap,
        }
    }
}

impl<T: Real, const ORDERED: bool> Div for Difference<T, ORDERED> {
    type Output = Self;
    // a1 / a2 - b1 / b2 = ((a1 - b1) - (b1 / b2) (a2 - b2)) / a2
    #[inline(always)]
    fn div(self, o: Self) -> Self {
        let second = self.second / o.second;
        Difference {
            first: self.first / o.first,
            second,
            gap: (self.gap - second * o.gap) / o.first,
        }
    }
}

impl<T: Real, const ORDERED: bool> Add<f64> for Difference<T, ORDERED> {
    type Output = Self;
    #[inline(always)]
    fn add(self, x: f64) -> Self {
        Difference {
            first: self.first + x,
            second: self.second + x,
            ..self
        }
    }
}

impl<T: Real, const ORDERED: bool> Sub<f64> for Difference<T, ORDERED> {
    type Output = Self;
    #[inline(always)]
    fn sub(self, x: f64) -> Self {
        Difference {
            first: self.first - x,
            second: self.second - x,
            ..self
        }
    }
}

impl<T: Real, const ORDERED: bool> Mul<f64> for Difference<T, ORDERED> {
    type Output = Self;
    #[inline(always)]
    fn mul(self, x: f64) -> Self {
        Difference {
            first: self.first * x,
            second: self.second * x,
            gap: self.gap * x,
        }
    }
}

impl<T: Real, const ORDERED: bool> Div<f64> for Difference<T, ORDERED> {
    type Output = Self;
    #[inline(always)]
    fn div(self, x: f64) -> Self {
        Difference {
            first: self.first / x,
            second: self.second / x,
            gap: self.gap / x,
        }
    }
}

impl<T: Real, const ORDERED: bool> Real for Difference<T, ORDERED> {
    #[inline(always)]
    fn constant(x: f64) -> Self {
        Difference {
            first: T::constant(x),
            second: T::constant(x),
            gap: T::constant(0.0),
        }
    }
    #[inline(always)]
    fn leading(self) -> f64 {
        self.first.leading()
    }
    // e^a - e^b = e^b (e^(a-b) - 1)
    #[inline(always)]
    fn exp(self) -> Self {
        if !ORDERED && self.gap.leading().abs() > 1.0 {
            return self.direct(T::exp);
        }
        let second = self.second.exp();
        Difference {
            first: self.first.exp(),
            second,
            gap: second * self.gap.exp_m1(),
        }
    }
    #[inline(always)]
    fn exp_m1(self) -> Self {
        Difference {
            first: self.first.exp_m1(),
            second: self.second.exp_m1(),
            gap: self.exp().gap,
        }
    }
    // ln a - ln b = ln(1 + (a - b) / b)
    #[inline(always)]
    fn ln(self) -> Self {
        if self.far_apart() {
            return self.direct(T::ln);
        }
        Difference {
            first: self.first.ln(),
            second: self.second.ln(),
            gap: self.log_ratio(),
        }
    }
    #[inline(always)]
    fn ln_1p(self) -> Self {
        Difference {
            first: self.first.ln_1p(),
            second: self.second.ln_1p(),
            gap: (self + 1.0).ln().gap,
        }
    }
    // a^p - b^p = b^p (e^(p (ln a - ln b)) - 1)
    #[inline(always)]
    fn powf(self, p: f64) -> Self {
        if self.far_apart() {
            return self.direct(|x| x.powf(p));
        }
        let second = self.second.powf(p);
        Difference {
            first: self.first.powf(p),
            second,
            gap: second * (self.log_ratio() * p).exp_m1(),
        }
    }
    // sqrt a - sqrt b = (a - b) / (sqrt a + sqrt b)
    #[inline(always)]
    fn sqrt(self) -> Self {
        let (first, second) = (self.first.sqrt(), self.second.sqrt());
        Difference {
            first,
            second,
            gap: self.gap / (first + second),
        }
    }
    // sinh a - sinh b = 2 cosh((a + b) / 2) sinh((a - b) / 2)
    #[inline(always)]
    fn sinh(self) -> Self {
        let (mean, half) = ((self.first + self.second) * 0.5, self.gap * 0.5);
        Difference {
            first: self.first.sinh(),
            second: self.second.sinh(),
            gap: mean.cosh() * half.sinh() * 2.0,
        }
    }
    // cosh a - cosh b = 2 sinh((a + b) / 2) sinh((a - b) / 2)
    #[inline(always)]
    fn cosh(self) -> Self {
        let (mean, half) = ((self.first + self.second) * 0.5, self.gap * 0.5);
        Difference {
            first: self.first.cosh(),
            second: self.second.cosh(),
            gap: mean.sinh() * half.sinh() * 2.0,
        }
    }
    // asinh a - asinh b = asinh(a sqrt(1+b^2) - b sqrt(1+a^2)), and the argument is (a-b)(a+b) / (a sqrt(1+b^2) + b sqrt(1+a^2))
    #[inline(always)]
    fn asinh(self) -> Self {
        if self.far_apart() {
            return self.direct(T::asinh);
        }
        let (a, b) = (self.first, self.second);
        let (root_a, root_b) = ((a * a + 1.0).sqrt(), (b * b + 1.0).sqrt());
        let argument = self.gap * (a + b) / (a * root_b + b * root_a);
        Difference {
            first: a.asinh(),
            second: b.asinh(),
            gap: argument.asinh(),
        }
    }
    #[inline(always)]
    fn log10(self) -> Self {
        Difference {
            first: self.first.log10(),
            second: self.second.log10(),
            gap: self.ln().gap / T::constant(10.0).ln(),
        }
    }
    // sin a - sin b = 2 cos((a + b) / 2) sin((a - b) / 2), cos a - cos b = -2 sin((a + b) / 2) sin((a - b) / 2)
    #[inline(always)]
    fn sin_cos(self) -> (Self, Self) {
        let (first, second) = (self.first.sin_cos(), self.second.sin_cos());
        let (sin, cos) = ((self.first + self.second) * 0.5).sin_cos();
        let half = (self.gap * 0.5).sin();
        (
            Difference {
                first: first.0,
                second: second.0,
                gap: cos * half * 2.0,
            },
            Difference {
                first: first.1,
                second: second.1,
                gap: sin * half * -2.0,
            },
        )
    }
    // tanh a - tanh b = sinh(a - b) / (cosh a cosh b)
    #[inline(always)]
    fn tanh(self) -> Self {
        if !ORDERED && self.gap.leading().abs() > 1.0 {
            return self.direct(T::tanh);
        }
        Difference {
            first: self.first.tanh(),
            second: self.second.tanh(),
            gap: self.gap.sinh() / self.first.cosh() / self.second.cosh(),
        }
    }
    // atan a - atan b = atan((a - b) / (1 + a b)) for a b > -1
    #[inline(always)]
    fn atan(self) -> Self {
        if self.far_apart() {
            return self.direct(T::atan);
        }
        Difference {
            first: self.first.atan(),
            second: self.second.atan(),
            gap: (self.gap / (self.first * self.second + 1.0)).atan(),
        }
    }
    #[inline(always)]
    fn abs(self) -> Self {
        if ORDERED {
            return Difference {
                first: self.first.abs(),
                second: self.second.abs(),
                gap: self.gap * self.second.sign(),
            };
        }
        match (self.first.leading() < 0.0, self.second.leading() < 0.0) {
            (false, false) => self,
            (true, true) => -self,
            _ => self.direct(T::abs),
        }
    }
    // With d = y_1 - y_2: d + a_1 e^(y_2) (e^d - 1) + b_1 e^(-y_2) (1 - e^(-d)) = x_1 - x_2 less what g differs by at y_2.
    #[inline(never)]
    fn balanced(self, g: Balance<Self>) -> (Self, Self) {
        let (first, second) = (
            self.first.balanced(g.map(|c| c.first)),
            self.second.balanced(g.map(|c| c.second)),
        );
        let y = second.0;
        let (apart, of_gap) = match g {
            Balance::Exponential(a) => {
                let e = y.exp();
                (a.gap * e, [a.first * e, T::constant(0.0)])
            }
            Balance::Sinh(a) => {
                let half = a.first * 0.5;
                (a.gap * y.sinh(), [half * y.exp(), half * (-y).exp()])
            }
            Balance::Difference(a, b) => {
                let (rising, falling) = (y.exp_m1(), (-y).exp_m1());
                let of_gap = [a.first * y.exp(), b.first * (-y).exp()];
                (a.gap * rising - b.gap * falling, of_gap)
            }
        };
        let [a, b] = of_gap;
        let (gap, of_g) = (self.gap - apart).balanced(Balance::Difference(a, b));
        (
            Difference {
                first: first.0,
                second: second.0,
                gap,
            },
            Difference {
                first: first.1,
                second: second.1,
                gap: apart + of_g,
            },
        )
    }
    // f(a) - f(b) = f'(b) (a - b) + f''(b) (a - b)^2 / 2 + ...
    fn ratio(self, ratio: Ratio) -> Self {
        /// Further apart subtraction loses little, and for others these terms are enough.
        const NEAR: f64 = 0.1;
        const TERMS: usize = 40;
        let by_subtraction = self.direct(|x| x.ratio(ratio));
        let (gap, second) = (self.gap, self.second);
        let (apart, at) = (gap.leading().abs(), second.leading());
        // A logarithm has no value from -1 on.
        if !(apart <= NEAR && apart <= NEAR * (1.0 + at).abs()) {
            return by_subtraction;
        }
        let of_numerator = [ratio.numerator.of(second), ratio.numerator.slope(second)];
        let all = ratio.coefficients((second, at), of_numerator, T::constant, TERMS);
        let terms = all[1..].iter().rev();
        Difference {
            gap: terms.fold(T::constant(0.0), |sum, &a| (sum + a) * gap),
            ..by_subtraction
        }
    }
}
