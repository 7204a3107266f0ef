//! Functions N(x)/x of functions N with N(0) = 0, which are analytic where x is 0 as well.
//!
//! With the coefficients b_m of N around x, those of N(x)/x are known by x a_m + a_(m-1) = b_m: upwards where |x| is large, and downwards
//! from far above where it is small, as Miller does it for Bessel functions. Neither cancels.
//!
//! Gautschi, W. (1967). Computational aspects of three-term recurrence relations. SIAM Review 9, 24-82.

use super::Real;
use std::ops::{Add, Div, Mul, Neg, Sub};

/// N.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash)]
pub enum Numerator {
    /// e^x - 1
    ExpM1,
    /// sin x
    Sin,
    /// sinh x
    Sinh,
    /// tanh x
    Tanh,
    /// ln(1 + x)
    Ln1p,
}

use Numerator::{ExpM1, Ln1p, Sin, Sinh, Tanh};

/// N(x)/x, or a derivative of it.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash)]
pub struct Ratio {
    /// N.
    pub numerator: Numerator,
    /// Which derivative.
    pub derivative: u8,
}

impl From<Numerator> for Ratio {
    fn from(numerator: Numerator) -> Self {
        Ratio {
            numerator,
            derivative: 0,
        }
    }
}

impl Ratio {
    /// The derivative.
    #[must_use]
    pub fn derived(self) -> Self {
        Ratio {
            derivative: self.derivative + 1,
            ..self
        }
    }

    /// Its first coefficients around x, given N(x), N'(x) and x as a number to compare with.
    pub(crate) fn coefficients<T>(
        self,
        x: (T, f64),
        of_numerator: [T; 2],
        number: impl Fn(f64) -> T,
        count: usize,
    ) -> Vec<T>
    where
        T: Copy
            + Neg<Output = T>
            + Add<Output = T>
            + Sub<Output = T>
            + Mul<Output = T>
            + Div<Output = T>,
    {
        let derivative = usize::from(self.derivative);
        let mut all = of_ratio(self.numerator, x, of_numerator, &number, count + derivative);
        for _ in 0..derivative {
            all.remove(0);
            for (m, a) in all.iter_mut().enumerate() {
                *a = *a * number((m + 1) as f64);
            }
        }
        all
    }

    /// The value of it at x in numbers that know no better.
    pub(super) fn by_coefficients<T: Real>(self, x: T) -> T {
        let of_numerator = [self.numerator.of(x), self.numerator.slope(x)];
        self.coefficients((x, x.leading()), of_numerator, T::constant, 1)[0]
    }
}

impl Numerator {
    /// N(x)
    pub fn of<T: Real>(self, x: T) -> T {
        match self {
            ExpM1 => x.exp_m1(),
            Sin => x.sin(),
            Sinh => x.sinh(),
            Tanh => x.tanh(),
            Ln1p => x.ln_1p(),
        }
    }

    /// N'(x)
    pub(super) fn slope<T: Real>(self, x: T) -> T {
        let one = T::constant(1.0);
        match self {
            ExpM1 => x.exp(),
            Sin => x.cos(),
            Sinh => x.cosh(),
            Tanh => {
                // 1 / cosh^2 with e = e^(-2|x|), which does not cancel where tanh is nearly 1.
                let e = (x.abs() * -2.0).exp();
                let whole = e + 1.0;
                e * 4.0 / (whole * whole)
            }
            Ln1p => one / (x + 1.0),
        }
    }

    /// The m up to which coefficients are made upwards at x, and how many more are to be begun with downwards.
    fn turn(self, x: f64) -> (usize, usize) {
        /// Below these the coefficients of N fall by a half each at least, against those of powers of x.
        const OF_LOGARITHM: f64 = 1.0 / 3.0;
        const OF_TANGENT: f64 = 0.5;
        /// Until nothing is left of the last in 31 digits.
        const MORE: usize = 110;
        /// Those of N fall as 1/m!.
        const MORE_OF_ENTIRE: usize = 34;
        let near = |within: f64| {
            if x.abs() <= within {
                (0, MORE)
            } else {
                (usize::MAX, 0)
            }
        };
        match self {
            // Where x is no number, it does not matter.
            ExpM1 | Sin | Sinh => (
                x.abs() as usize,
                MORE_OF_ENTIRE + 2 * x.abs().min(64.0) as usize,
            ),
            Tanh => near(OF_TANGENT),
            Ln1p => near(OF_LOGARITHM),
        }
    }
}

fn of_ratio<T>(
    numerator: Numerator,
    (x, leading): (T, f64),
    [value, slope]: [T; 2],
    number: &impl Fn(f64) -> T,
    count: usize,
) -> Vec<T>
where
    T: Copy
        + Neg<Output = T>
        + Add<Output = T>
        + Sub<Output = T>
        + Mul<Output = T>
        + Div<Output = T>,
{
    let (turn, more) = numerator.turn(leading);
    let most = if turn >= count { count } else { count + more };
    let mut b = Vec::with_capacity(most + 1);
    b.extend([value, slope]);
    for m in 2..=most {
        let n = m as f64;
        b.push(match numerator {
            ExpM1 => b[m - 1] / number(n),
            Sin => -(b[m - 2] / number(n * (n - 1.0))),
            Sinh => b[m - 2] / number(n * (n - 1.0)),
            Ln1p => -(b[m - 1] * slope * number(n - 1.0) / number(n)),
            // y' = 1 - y^2
            Tanh => {
                let squares = (0..m).map(|j| b[j] * b[m - 1 - j]);
                -(squares.fold(number(0.0), |sum, x| sum + x) / number(n))
            }
        });
    }
    let mut a = vec![number(0.0); most + 1];
    let mut below = number(0.0);
    for (a, b) in a.iter_mut().zip(&b).take(turn.min(count)) {
        *a = (*b - below) / x;
        below = *a;
    }
    for m in (turn.saturating_add(1)..=most).rev() {
        a[m - 1] = b[m] - x * a[m];
    }
    a.truncate(count);
    a
}
