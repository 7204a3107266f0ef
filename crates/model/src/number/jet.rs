//! A value with its gradient in N variables: exact first derivatives. Nested (`Jet<Jet<f64, N>, N>`) it gives second
//! derivatives, and so on.

use super::{Balance, Ratio, Real};
use std::ops::{Add, Div, Mul, Neg, Sub};

/// A value and its N partial derivatives.
///
/// ```
/// use twinslip::number::{Jet, Real};
/// let [x, y] = Jet::variables([2.0, 3.0]);
/// let z = x * y.ln();
/// assert_eq!(z.gradient, [3.0_f64.ln(), 2.0 / 3.0]);
/// ```
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Jet<T, const N: usize> {
    /// The value.
    pub value: T,
    /// The partial derivatives.
    pub gradient: [T; N],
}

/// The same for every i < N. Few are written one by one: through a loop the compiler does not see what the components are until
/// it is too late to fold them, and of jets of series all must fold.
macro_rules! each {
    ($i:ident => $body:expr) => {{
        if N > 0 {
            let $i = 0;
            $body;
        }
        if N > 1 {
            let $i = 1;
            $body;
        }
        let mut $i = 2;
        while $i < N {
            $body;
            $i += 1;
        }
    }};
}

impl<T: Real, const N: usize> Jet<T, N> {
    /// The N independent variables at a point.
    pub fn variables(at: [T; N]) -> [Self; N] {
        std::array::from_fn(|i| Self::variable(at[i], i))
    }

    /// The i-th independent variable.
    #[inline(always)]
    pub fn variable(value: T, i: usize) -> Self {
        let mut gradient = [T::constant(0.0); N];
        gradient[i] = T::constant(1.0);
        Jet { value, gradient }
    }

    /// g(self), from g and dg/dx at the value (chain rule).
    #[inline(always)]
    fn chain(self, g: T, slope: T) -> Self {
        let mut gradient = self.gradient;
        each!(i => gradient[i] = slope * gradient[i]);
        Jet { value: g, gradient }
    }
}

/// A jet with this value, its gradient component by component from those of two others. A macro and no function of a closure:
/// where the compiler is to see through all layers of numbers, it does not see through these.
macro_rules! zip {
    ($a:expr, $b:expr, $value:expr, |$d:ident, $e:ident| $rule:expr) => {{
        let value = $value;
        let mut gradient = $a.gradient;
        each!(i => {
            let ($d, $e) = (gradient[i], $b.gradient[i]);
            gradient[i] = $rule;
        });
        Jet { value, gradient }
    }};
}

impl<T: Real, const N: usize> Neg for Jet<T, N> {
    type Output = Self;
    #[inline(always)]
    fn neg(self) -> Self {
        self.chain(-self.value, T::constant(-1.0))
    }
}

impl<T: Real, const N: usize> Add for Jet<T, N> {
    type Output = Self;
    #[inline(always)]
    fn add(self, o: Self) -> Self {
        zip!(self, o, self.value + o.value, |d, e| d + e)
    }
}

impl<T: Real, const N: usize> Sub for Jet<T, N> {
    type Output = Self;
    #[inline(always)]
    fn sub(self, o: Self) -> Self {
        zip!(self, o, self.value - o.value, |d, e| d - e)
    }
}

impl<T: Real, const N: usize> Mul for Jet<T, N> {
    type Output = Self;
    // the product rule
    #[allow(clippy::suspicious_arithmetic_impl)]
    #[inline(always)]
    fn mul(self, o: Self) -> Self {
        zip!(self, o, self.value * o.value, |d, e| d * o.value
            + self.value * e)
    }
}

impl<T: Real, const N: usize> Div for Jet<T, N> {
    type Output = Self;
    // the quotient rule
    #[allow(clippy::suspicious_arithmetic_impl)]
    #[inline(always)]
    fn div(self, o: Self) -> Self {
        let quotient = self.value / o.value;
        zip!(self, o, quotient, |d, e| (d - quotient * e) / o.value)
    }
}

impl<T: Real, const N: usize> Add<f64> for Jet<T, N> {
    type Output = Self;
    #[inline(always)]
    fn add(self, x: f64) -> Self {
        Jet {
            value: self.value + x,
            ..self
        }
    }
}

impl<T: Real, const N: usize> Sub<f64> for Jet<T, N> {
    type Output = Self;
    #[inline(always)]
    fn sub(self, x: f64) -> Self {
        Jet {
            value: self.value - x,
            ..self
        }
    }
}

impl<T: Real, const N: usize> Mul<f64> for Jet<T, N> {
    type Output = Self;
    #[inline(always)]
    fn mul(self, x: f64) -> Self {
        self.chain(self.value * x, T::constant(x))
    }
}

impl<T: Real, const N: usize> Div<f64> for Jet<T, N> {
    type Output = Self;
    #[inline(always)]
    fn div(self, x: f64) -> Self {
        let mut gradient = self.gradient;
        each!(i => gradient[i] = gradient[i] / x);
        Jet {
            value: self.value / x,
            gradient,
        }
    }
}

impl<T: Real, const N: usize> Real for Jet<T, N> {
    #[inline(always)]
    fn constant(x: f64) -> Self {
        Jet {
            value: T::constant(x),
            gradient: [T::constant(0.0); N],
        }
    }
    #[inline(always)]
    fn leading(self) -> f64 {
        self.value.leading()
    }
    #[inline(always)]
    fn in_range(self) -> Self {
        let mut gradient = self.gradient;
        each!(i => gradient[i] = gradient[i].in_range());
        Jet {
            value: self.value.in_range(),
            gradient,
        }
    }
    #[inline(always)]
    fn exp(self) -> Self {
        let e = self.value.exp();
        let mut jet = self.chain(e, e.in_range());
        each!(i => jet.gradient[i] = jet.gradient[i].in_range());
        jet
    }
    #[inline(always)]
    fn exp_m1(self) -> Self {
        self.chain(self.value.exp_m1(), self.value.exp())
    }
    #[inline(always)]
    fn ln(self) -> Self {
        self.chain(self.value.ln(), T::constant(1.0) / self.value)
    }
    #[inline(always)]
    fn ln_1p(self) -> Self {
        self.chain(self.value.ln_1p(), T::constant(1.0) / (self.value + 1.0))
    }
    #[inline(always)]
    fn powf(self, p: f64) -> Self {
        let slope = match p {
            0.0 => T::constant(0.0),
            p => self.value.powf(p - 1.0) * p,
        };
        self.chain(self.value.powf(p), slope)
    }
    // d x^p = p x^(p-1) dx + x^p ln x dp; at x = 0 the last product is 0, and so is the first of p = 0
    #[inline(always)]
    fn pow(self, p: Self) -> Self {
        let power = self.value.pow(p.value);
        let log = self.value.greater(T::constant(f64::MIN_POSITIVE)).ln();
        let slope = match p.value.leading() {
            0.0 => T::constant(0.0),
            _ => self.value.pow(p.value - 1.0) * p.value,
        };
        let of_p = power * log;
        zip!(self, p, power, |d, e| slope * d + of_p * e)
    }
    #[inline(always)]
    fn sqrt(self) -> Self {
        let root = self.value.sqrt();
        self.chain(root, T::constant(0.5) / root)
    }
    #[inline(always)]
    fn sinh(self) -> Self {
        let (sinh, cosh) = self.value.sinh_cosh();
        self.chain(sinh, cosh.in_range())
    }
    #[inline(always)]
    fn cosh(self) -> Self {
        let (sinh, cosh) = self.value.sinh_cosh();
        self.chain(cosh, sinh.in_range())
    }
    #[inline(always)]
    fn asinh(self) -> Self {
        self.chain(
            self.value.asinh(),
            T::constant(1.0) / (self.value * self.value + 1.0).sqrt(),
        )
    }
    #[inline(always)]
    fn sin_cos(self) -> (Self, Self) {
        let (sin, cos) = self.value.sin_cos();
        (self.chain(sin, cos), self.chain(cos, -sin))
    }
    #[inline(always)]
    fn tanh(self) -> Self {
        // 1 / cosh^2 with e = e^(-2|x|): neither overflows, nor cancels where tanh is nearly 1.
        let e = (self.value.abs() * -2.0).exp();
        let whole = e + 1.0;
        self.chain(self.value.tanh(), e * 4.0 / (whole * whole))
    }
    #[inline(always)]
    fn atan(self) -> Self {
        self.chain(
            self.value.atan(),
            T::constant(1.0) / (self.value * self.value + 1.0),
        )
    }
    #[inline(always)]
    fn abs(self) -> Self {
        self.chain(self.value.abs(), self.value.sign())
    }
    // dy (1 + g'(y)) = dx - dg and dg(y) (1 + g'(y)) = g'(y) dx + dg, with dg at the y that is held
    #[inline(always)]
    fn balanced(self, g: Balance<Self>) -> (Self, Self) {
        let (y, value) = self.value.balanced(g.map(|c| c.value));
        let held = Jet {
            value: y,
            gradient: [T::constant(0.0); N],
        };
        let (at, slope) = g.at(held);
        let (slope, whole) = (slope.value, slope.value + 1.0);
        (
            zip!(self, at, y, |d, e| (d - e) / whole),
            zip!(self, at, value, |d, e| (slope * d + e) / whole),
        )
    }
    #[inline(always)]
    fn ratio(self, ratio: Ratio) -> Self {
        self.chain(self.value.ratio(ratio), self.value.ratio(ratio.derived()))
    }
    // The gradient of the one that it is; where that is not known, as in intervals, of anything between both.
    #[inline(always)]
    fn lesser(self, o: Self) -> Self {
        let half = (o.value - self.value).sign() * 0.5;
        let (this, other) = (half + 0.5, -half + 0.5);
        zip!(self, o, self.value.lesser(o.value), |d, e| this * d
            + other * e)
    }
    #[inline(always)]
    fn greater(self, o: Self) -> Self {
        -(-self).lesser(-o)
    }
}
