//! The equation y + g(y) = x with a rising exponential function g: what radiation damping leaves of a stress.
//!
//! A slip rate v radiates eta v of the stress tau, so that friction carries y = tau - eta v, and with the direct effect v = s(y)/h
//! this y solves y + (eta/h) s(y) = tau. The left side rises: there is one solution for every x.

use super::{Interval, Real};

/// g in y + g(y) = x. Its coefficients are not negative.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Balance<T> {
    /// a e^y
    Exponential(T),
    /// a sinh y. y then has the sign of x, and near 0 its relative accuracy, as in the next.
    Sinh(T),
    /// a (e^y - 1) + b (1 - e^-y): by how much both others differ between two points that are y apart.
    Difference(T, T),
}

use Balance::{Difference, Exponential, Sinh};

impl<T: Copy> Balance<T> {
    /// The same function with its coefficients in another kind of number.
    #[inline(always)]
    pub fn map<U>(self, mut f: impl FnMut(T) -> U) -> Balance<U> {
        match self {
            Exponential(a) => Exponential(f(a)),
            Sinh(a) => Sinh(f(a)),
            Difference(a, b) => Difference(f(a), f(b)),
        }
    }
}

impl<T: Real> Balance<T> {
    /// g(y) and g'(y).
    #[inline(always)]
    pub fn at(self, y: T) -> (T, T) {
        match self {
            Exponential(a) => {
                let value = a * y.exp();
                (value, value)
            }
            Sinh(a) => {
                let (sinh, cosh) = y.sinh_cosh();
                (a * sinh, a * cosh)
            }
            Difference(a, b) => {
                let (rising, falling) = (y.exp_m1(), (-y).exp_m1());
                let slope = a * y.exp() + b * (-y).exp();
                (a * rising - b * falling, slope)
            }
        }
    }

    /// Newton's step from y towards the solution for x.
    #[inline(always)]
    pub(super) fn newton(self, x: T, y: T) -> T {
        let (value, slope) = self.at(y);
        y - (y + value - x) / (slope + 1.0)
    }
}

/// Newton steps, which from above converge within a few; halvings where they leave the bracket.
const STEPS: usize = 100;

impl Balance<f64> {
    /// The solution for x, within a few units in its last place; not a number where x or a coefficient is none or infinite.
    pub fn solve(self, x: f64) -> f64 {
        match self {
            _ if !x.is_finite() => f64::NAN,
            Exponential(a) | Sinh(a) if !(a >= 0.0 && a.is_finite()) => f64::NAN,
            Difference(a, b) if !(a.min(b) >= 0.0 && (a + b).is_finite()) => f64::NAN,
            Exponential(a) => self.between(x, (f64::NEG_INFINITY, x), start(x, a)),
            _ if x == 0.0 => x,
            Difference(a, b) if x < 0.0 => -Difference(b, a).solve(-x),
            Sinh(_) if x < 0.0 => -self.solve(-x),
            Difference(a, _) => {
                // a (e^y - 1) <= x
                let high = x.min((x / a).ln_1p());
                self.between(x, (0.0, high), high)
            }
            Sinh(a) => {
                // a sinh y <= x
                let high = x.min(Real::asinh(x / a));
                self.between(x, (0.0, high), high)
            }
        }
    }

    fn between(self, x: f64, (mut low, mut high): (f64, f64), start: f64) -> f64 {
        let mut y = start;
        for _ in 0..STEPS {
            let (value, slope) = self.at(y);
            let residual = y + value - x;
            if residual > 0.0 {
                high = y;
            } else {
                low = y;
            }
            let step = residual / (slope + 1.0);
            let mut next = y - step;
            if !(next > low && next < high) && low.is_finite() && high > low {
                // Next to the solution rounding alone takes it out of the bracket.
                if step.abs() <= 4.0 * f64::EPSILON * y.abs() {
                    return y;
                }
                next = 0.5 * (low + high);
            }
            if (next - y).abs() <= f64::EPSILON * y.abs() {
                return next;
            }
            y = next;
        }
        y
    }
}

/// A first guess at y + a e^y = x, above the solution or next to it. w = a e^y solves w + ln w = x + ln a.
fn start(x: f64, a: f64) -> f64 {
    let level = x + a.ln();
    if level > 1.0 {
        x - level + level.ln()
    } else {
        x
    }
}

impl Balance<Interval> {
    /// Bounds on the solutions for all x: they rise with x, and where they are positive they fall with the coefficients.
    pub(super) fn enclose(self, x: Interval) -> Interval {
        let ends = |lower: bool| {
            let x = if lower { x.lo() } else { x.hi() };
            // of e^y the solution falls with a throughout
            let large = lower == (x >= 0.0 || matches!(self, Exponential(_)));
            let g = self.map(|c| if large { c.hi() } else { c.lo() });
            (x, g)
        };
        let ((low, at_low), (high, at_high)) = (ends(true), ends(false));
        Interval::new(certain(at_low, low, -1.0), certain(at_high, high, 1.0))
    }
}

/// A number next to the solution for x where y + g(y) - x certainly has this sign.
fn certain(g: Balance<f64>, x: f64, sign: f64) -> f64 {
    let y = g.solve(x);
    if !y.is_finite() {
        return sign * f64::INFINITY;
    }
    let mut away = (y.abs() * f64::EPSILON).max(f64::MIN_POSITIVE);
    while away.is_finite() {
        let moved = y + sign * away;
        let point = Interval::constant(moved);
        let (value, _) = g.map(Interval::constant).at(point);
        if (point + value - x).sign() == Some(sign) {
            return moved;
        }
        away *= 2.0;
    }
    sign * f64::INFINITY
}
