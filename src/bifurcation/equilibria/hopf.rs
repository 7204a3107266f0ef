//! Hopf points: where they are, to the last digits, with error budgets, period and criticality.
//!
//! K of a Hopf point at an exact V_H is a closed form of the slip rates, (29) or (34); V_H at an exact K is the zero of their
//! difference. Both are computed in 31 digits, as close to a pitchfork the slip rates take digits; budgets come from the same
//! formulas in interval arithmetic, and cover the rounding of the law's parameters and of V_H or K.

use super::crossing::{self, QuadraticRoot};
use super::curves::CurveVariables;
use crate::continuation::CurvePoint;
use crate::equilibrium::Interface;
use crate::friction::AnyLaw;
use crate::friction::rounding;
use crate::number::{DoubleDouble, Interval, Jet, Real, Uncertain, bracketed_root};
use std::f64::consts::TAU;

/// A Hopf point.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Hopf {
    pub driving: Uncertain,
    pub stiffness: Uncertain,
    pub period: Option<Uncertain>,
    pub rates: [f64; 2],
}

/// The Hopf points of one curve of equilibria.
#[derive(Debug, Clone, Copy)]
pub(super) struct HopfPoints<'a> {
    pub law: &'a AnyLaw,
    pub curve: CurveVariables,
    pub root: QuadraticRoot,
}

impl HopfPoints<'_> {
    /// K of the closed form.
    pub fn closed_form<T: Real>(&self, rates: [T; 2]) -> T {
        match self.curve {
            CurveVariables::Symmetric { interfaces } => {
                crossing::symmetric(self.law, rates[0], interfaces)
            }
            CurveVariables::Asymmetric => {
                let [one, two] = rates.map(|v| Interface::at(self.law, v));
                crossing::asymmetric(&one, &two, self.root)
            }
        }
    }

    /// K of the closed form, as it is watched along a curve: where nothing but rounding is left of it, at a pitchfork, its limit.
    pub fn along(&self, point: &CurvePoint, rates: [f64; 2]) -> f64 {
        /// z this close to a pitchfork; K is a quadratic function of it.
        const CLOSE: f64 = 1e-6;
        if self.curve == CurveVariables::Asymmetric && point.u[0].abs() < CLOSE {
            return 0.0;
        }
        self.closed_form(rates)
    }

    /// K of the closed form with its derivative in V_H.
    pub fn closed_form_along<T: Real>(&self, rates: [T; 2]) -> Jet<T, 1> {
        let slopes = self.curve.slopes(self.law, rates);
        let jet = |i: usize| Jet {
            value: rates[i],
            gradient: [slopes[i]],
        };
        self.closed_form([jet(0), jet(1)])
    }

    /// dK/d ln V_H along the curve.
    pub fn stiffness_slope(&self, driving: f64, rates: [f64; 2]) -> f64 {
        self.closed_form_along(rates).gradient[0] * driving
    }

    /// omega^2; the point is none unless it is positive.
    pub fn frequency_squared<T: Real>(&self, rates: [T; 2], k: T) -> T {
        let [one, two] = rates.map(|v| Interface::at(self.law, v));
        match self.curve {
            CurveVariables::Symmetric { interfaces } => {
                crossing::symmetric_frequency(&one, k, interfaces)
            }
            CurveVariables::Asymmetric => crossing::asymmetric_frequency(&one, &two, k),
        }
    }

    /// K at these rates if a pair of eigenvalues crosses there.
    pub fn stiffness(&self, rates: [f64; 2]) -> Option<f64> {
        let k = self.closed_form(rates);
        (k > 0.0 && k.is_finite() && self.frequency_squared(rates, k) > 0.0).then_some(k)
    }

    /// omega^2 at exactly this V_H and the closed form's K, with a bound on its error.
    fn refined_frequency(&self, driving: f64, near: [f64; 2]) -> RefinedValue {
        let bounds = {
            let rates = self.curve.enclosed(self.law, driving, near);
            self.frequency_squared(rates, self.closed_form(rates))
        };
        let pair = self.curve.rates_at::<DoubleDouble>(self.law, driving, near);
        let of_inputs = self.inputs(driving, near, |points, rates| {
            points.frequency_squared(rates, points.closed_form(rates))
        });
        let value = self.frequency_squared(pair, self.closed_form(pair));
        RefinedValue::new(value, bounds, of_inputs)
    }

    /// K of the closed form at exactly this V_H, with a bound on its error.
    pub fn refine(&self, driving: f64, near: [f64; 2]) -> RefinedValue {
        let bounds = self.closed_form(self.curve.enclosed(self.law, driving, near));
        let pair = self.curve.rates_at::<DoubleDouble>(self.law, driving, near);
        let of_inputs = self.inputs(driving, near, |points, rates| points.closed_form(rates));
        RefinedValue::new(self.closed_form(pair), bounds, of_inputs)
    }

    /// What a number is off by the rounding of the law's parameters and of V_H.
    pub fn inputs(
        &self,
        driving: f64,
        near: [f64; 2],
        number: impl Fn(&HopfPoints<'_>, [f64; 2]) -> f64,
    ) -> f64 {
        let at = |law: &AnyLaw, v: f64| {
            let points = HopfPoints { law, ..*self };
            number(&points, self.curve.rates_at::<f64>(law, v, near))
        };
        /// Of V_H, to see its effect.
        const CHANGE: f64 = 1e-6;
        let apart = at(self.law, driving * (1.0 + CHANGE)) - at(self.law, driving);
        let of_driving = apart.abs() * f64::EPSILON / CHANGE;
        rounding(self.law, |law| Some(at(law, driving))) + of_driving
    }

    /// The period 2 pi / omega, where V_H lies between the first and the last of these. None where omega is lost in rounding.
    pub fn period(&self, driving: &[f64], near: [f64; 2]) -> Option<Uncertain> {
        let all: Vec<_> = driving
            .iter()
            .map(|&v| self.refined_frequency(v, near))
            .collect();
        let middle = all[all.len() / 2];
        let omega = middle.value.to_f64().sqrt();
        let reach = all.iter().map(|x| {
            let apart = (x.value - middle.value).to_f64().abs();
            apart + x.error
        });
        // d ln T = -d omega^2 / (2 omega^2); twice that, as omega^2 is not quite linear
        let relative = reach.fold(0.0, f64::max) / (omega * omega);
        let value = TAU / omega;
        let uncertainty = if relative < 0.1 {
            value * (relative + 4.0 * f64::EPSILON)
        } else {
            f64::INFINITY
        };
        value
            .is_finite()
            .then(|| Uncertain::new(value, uncertainty))
    }

    /// The rates at exactly this V_H, the same wherever the search for them began.
    fn rounded_rates(&self, driving: f64, near: [f64; 2]) -> [f64; 2] {
        let rates = self.curve.rates_at::<DoubleDouble>(self.law, driving, near);
        rates.map(DoubleDouble::to_f64)
    }

    /// The Hopf point at exactly this V_H.
    pub fn at_driving(&self, driving: f64, near: [f64; 2]) -> Option<Hopf> {
        let rates = self.rounded_rates(driving, near);
        self.stiffness(rates)?;
        Some(Hopf {
            driving: Uncertain::new(driving, 0.0),
            stiffness: self.refine(driving, rates).rounded(),
            period: self.period(&[driving], rates),
            rates,
        })
    }

    /// The Hopf point at exactly this K, at a V_H near this one. None where K does not certainly pass the value.
    pub fn at_stiffness(&self, k: f64, driving: f64, near: [f64; 2]) -> Option<Hopf> {
        let above = |v: f64| {
            let mut refined_point = self.refine(v, near);
            refined_point.error += k * f64::EPSILON;
            refined_point.above(k)
        };
        let (v, radius) = certain_zero("a Hopf point", driving, above)?;
        let rates = self.rounded_rates(v, near);
        if self.frequency_squared(rates, k) <= 0.0 {
            return None;
        }
        Some(Hopf {
            driving: Uncertain::new(v, radius),
            stiffness: Uncertain::new(k, 0.0),
            period: self.period(&[v - radius, v, v + radius], rates),
            rates,
        })
    }

    /// A point where some condition is zero at an uncertain V_H: K follows from it.
    pub fn around_driving(&self, (v, radius): (f64, f64), near: [f64; 2]) -> Option<Hopf> {
        let mut point = self.at_driving(v, near)?;
        let at = [v - radius, v, v + radius];
        let reach = at.map(|x| {
            let here = self.refine(x, near);
            here.above(point.stiffness.value).0.abs() + here.error
        });
        point.stiffness.uncertainty += reach.into_iter().fold(0.0, f64::max);
        point.period = self.period(&at, near);
        point.driving.uncertainty = radius;
        Some(point)
    }
}

/// A number in 31 digits, with a bound on what it is off.
#[derive(Debug, Clone, Copy)]
pub(super) struct RefinedValue {
    pub value: DoubleDouble,
    pub error: f64,
}

impl RefinedValue {
    /// The width of intervals is that of rounding in 16 digits: the same operations in 31 digits err by 1e-15 of it, and a
    /// factor of a thousand is left.
    fn new(value: DoubleDouble, bounds: Interval, of_inputs: f64) -> Self {
        const PART: f64 = 1e-12;
        let error = PART * bound(value.to_f64(), bounds) + of_inputs;
        RefinedValue { value, error }
    }

    fn rounded(&self) -> Uncertain {
        let value = self.value.to_f64();
        Uncertain::new(value, value.abs() * f64::EPSILON + self.error)
    }

    /// How far above a number it is, and whether the sign of that is certain.
    fn above(&self, x: f64) -> (f64, bool) {
        let difference = (self.value - x).to_f64();
        (difference, difference.abs() > self.error)
    }
}

/// The zero near x > 0 of a function that knows whether its sign is certain, and the radius within which it certainly changes.
pub fn certain_zero(
    what: &'static str,
    x: f64,
    g: impl Fn(f64) -> (f64, bool),
) -> Option<(f64, f64)> {
    let (low, high) = straddling(x, |x| g(x).0)?;
    let with_slope = |x: f64| {
        let h = 1e-7 * x;
        (g(x).0, (g(x + h).0 - g(x - h).0) / (2.0 * h))
    };
    let zero = bracketed_root(what, low, high, with_slope).ok()?;
    let mut radius = zero * f64::EPSILON;
    while radius < 1e-3 * zero {
        let [(a, sure_a), (b, sure_b)] = [zero - radius, zero + radius].map(&g);
        if sure_a && sure_b && a.signum() != b.signum() {
            return Some((zero, radius));
        }
        radius *= 2.0;
    }
    None
}

/// A bound on the distance of the truth within `bounds` from a value; infinite where there are no bounds.
pub(super) fn bound(value: f64, bounds: Interval) -> f64 {
    let distance = bounds.distance_from(value);
    if distance.is_finite() {
        distance
    } else {
        f64::INFINITY
    }
}

/// Two values around x > 0, as close as may be, at which g has opposite signs.
pub(super) fn straddling(x: f64, g: impl Fn(f64) -> f64) -> Option<(f64, f64)> {
    let mut part = 1e-14;
    while part < 1e-2 {
        let (low, high) = (x * (1.0 - part), x * (1.0 + part));
        if g(low) * g(high) < 0.0 {
            return Some((low, high));
        }
        part *= 4.0;
    }
    None
}
