//! The values of a formula at two points and their difference, without cancellation.
//!
//! Two steady slip rates that carry the same stress are zeros of tau_ss(V_1) - tau_ss(V_2). Close to a pitchfork the two
//! rates merge, and subtracting two rounded stresses leaves no digit of the answer. Here the difference is carried through
//! the formula by the addition theorems, so it keeps its relative accuracy however close the points are.

use super::Real;
use std::ops::{Add, Div, Mul, Neg, Sub};

/// `first`, `second` and `gap` = first - second.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Difference<T> {
    /// Value at the first point.
    pub first: T,
    /// Value at the second point.
    pub second: T,
    /// First minus second, with its own relative accuracy.
    pub gap: T,
}

impl<T: Real> Difference<T> {
    /// Two points whose difference is known.
    pub fn new(first: T, second: T, gap: T) -> Self {
        Difference { first, second, gap }
    }

    /// Where the values are far apart subtraction is as good as an addition theorem, and can't overflow.
    fn far_apart(&self) -> bool {
        let (a, b) = (self.first.leading(), self.second.leading());
        !(a * b > 0.0 && (0.25..4.0).contains(&(a / b)))
    }

    fn direct(self, g: impl Fn(T) -> T) -> Self {
        let (first, second) = (g(self.first), g(self.second));
        Difference {
            first,
            second,
            gap: first - second,
        }
    }
}

impl<T: Real> Neg for Difference<T> {
    type Output = Self;
    fn neg(self) -> Self {
        Difference {
            first: -self.first,
            second: -self.second,
            gap: -self.gap,
        }
    }
}

impl<T: Real> Add for Difference<T> {
    type Output = Self;
    fn add(self, o: Self) -> Self {
        Difference {
            first: self.first + o.first,
            second: self.second + o.second,
            gap: self.gap + o.gap,
        }
    }
}

impl<T: Real> Sub for Difference<T> {
    type Output = Self;
    fn sub(self, o: Self) -> Self {
        self + -o
    }
}

impl<T: Real> Mul for Difference<T> {
    type Output = Self;
    // a1 a2 - b1 b2 = (a1 - b1) a2 + b1 (a2 - b2)
    fn mul(self, o: Self) -> Self {
        Difference {
            first: self.first * o.first,
            second: self.second * o.second,
            gap: self.gap * o.first + self.second * o.gap,
        }
    }
}

impl<T: Real> Div for Difference<T> {
    type Output = Self;
    // a1 / a2 - b1 / b2 = ((a1 - b1) - (b1 / b2) (a2 - b2)) / a2
    fn div(self, o: Self) -> Self {
        let second = self.second / o.second;
        Difference {
            first: self.first / o.first,
            second,
            gap: (self.gap - second * o.gap) / o.first,
        }
    }
}

impl<T: Real> Add<f64> for Difference<T> {
    type Output = Self;
    fn add(self, x: f64) -> Self {
        Difference {
            first: self.first + x,
            second: self.second + x,
            ..self
        }
    }
}

impl<T: Real> Sub<f64> for Difference<T> {
    type Output = Self;
    fn sub(self, x: f64) -> Self {
        Difference {
            first: self.first - x,
            second: self.second - x,
            ..self
        }
    }
}

impl<T: Real> Mul<f64> for Difference<T> {
    type Output = Self;
    fn mul(self, x: f64) -> Self {
        Difference {
            first: self.first * x,
            second: self.second * x,
            gap: self.gap * x,
        }
    }
}

impl<T: Real> Div<f64> for Difference<T> {
    type Output = Self;
    fn div(self, x: f64) -> Self {
        Difference {
            first: self.first / x,
            second: self.second / x,
            gap: self.gap / x,
        }
    }
}

impl<T: Real> Real for Difference<T> {
    fn constant(x: f64) -> Self {
        Difference {
            first: T::constant(x),
            second: T::constant(x),
            gap: T::constant(0.0),
        }
    }
    fn leading(self) -> f64 {
        self.first.leading()
    }
    // e^a - e^b = e^b (e^(a-b) - 1)
    fn exp(self) -> Self {
        if self.gap.leading().abs() > 1.0 {
            return self.direct(T::exp);
        }
        let second = self.second.exp();
        Difference {
            first: self.first.exp(),
            second,
            gap: second * self.gap.exp_m1(),
        }
    }
    fn exp_m1(self) -> Self {
        Difference {
            first: self.first.exp_m1(),
            second: self.second.exp_m1(),
            gap: self.exp().gap,
        }
    }
    // ln a - ln b = ln(1 + (a - b) / b)
    fn ln(self) -> Self {
        if self.far_apart() {
            return self.direct(T::ln);
        }
        Difference {
            first: self.first.ln(),
            second: self.second.ln(),
            gap: (self.gap / self.second).ln_1p(),
        }
    }
    fn ln_1p(self) -> Self {
        Difference {
            first: self.first.ln_1p(),
            second: self.second.ln_1p(),
            gap: (self + 1.0).ln().gap,
        }
    }
    // a^p - b^p = b^p (e^(p (ln a - ln b)) - 1)
    fn powf(self, p: f64) -> Self {
        if self.far_apart() {
            return self.direct(|x| x.powf(p));
        }
        let second = self.second.powf(p);
        Difference {
            first: self.first.powf(p),
            second,
            gap: second * (self.ln().gap * p).exp_m1(),
        }
    }
    // sqrt a - sqrt b = (a - b) / (sqrt a + sqrt b)
    fn sqrt(self) -> Self {
        let (first, second) = (self.first.sqrt(), self.second.sqrt());
        Difference {
            first,
            second,
            gap: self.gap / (first + second),
        }
    }
    // sinh a - sinh b = 2 cosh((a + b) / 2) sinh((a - b) / 2)
    fn sinh(self) -> Self {
        let (mean, half) = ((self.first + self.second) * 0.5, self.gap * 0.5);
        Difference {
            first: self.first.sinh(),
            second: self.second.sinh(),
            gap: mean.cosh() * half.sinh() * 2.0,
        }
    }
    // cosh a - cosh b = 2 sinh((a + b) / 2) sinh((a - b) / 2)
    fn cosh(self) -> Self {
        let (mean, half) = ((self.first + self.second) * 0.5, self.gap * 0.5);
        Difference {
            first: self.first.cosh(),
            second: self.second.cosh(),
            gap: mean.sinh() * half.sinh() * 2.0,
        }
    }
    // asinh a - asinh b = asinh(a sqrt(1+b^2) - b sqrt(1+a^2)), and the argument is (a-b)(a+b) / (a sqrt(1+b^2) + b sqrt(1+a^2))
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
    fn abs(self) -> Self {
        match (self.first.leading() < 0.0, self.second.leading() < 0.0) {
            (false, false) => self,
            (true, true) => -self,
            _ => self.direct(T::abs),
        }
    }
}
