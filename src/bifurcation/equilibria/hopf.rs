//! Hopf points: where they are, to the last digits, with error budgets, period and criticality.
//!
//! K of a Hopf point at an exact V_H is a closed form of the slip rates, (29) or (34); V_H at an exact K is the zero of their
//! difference. Budgets are signs in interval arithmetic on both sides. That the closed form is right is no part of these: it is
//! held against the numerical condition on the Jacobian of the vector field itself, and the budget covers their difference.

use super::crossing::{self, Root};
use super::curves::Curve;
use super::lyapunov::{Lyapunov, first_lyapunov};
use crate::bifurcation::Criticality;
use crate::equilibrium::Interface;
use crate::field::{State, VectorField};
use crate::friction::{AnyLaw, Law, steady_stress};
use crate::model::{Loading, single_interface, two_interfaces};
use crate::number::{
    DoubleDouble, Interval, Jet, Real, Uncertain, bracketed_root, enclosing_radius,
};
use nalgebra::DMatrix;
use std::f64::consts::TAU;

/// A Hopf point.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Hopf {
    pub driving: Uncertain,
    pub stiffness: Uncertain,
    pub period: Uncertain,
    pub rates: [f64; 2],
}

/// The Hopf points of one curve of equilibria.
#[derive(Debug, Clone, Copy)]
pub(super) struct HopfPoints<'a> {
    pub law: &'a AnyLaw,
    pub curve: Curve,
    pub root: Root,
}

impl HopfPoints<'_> {
    /// K of the closed form.
    pub fn closed_form<T: Real>(&self, rates: [T; 2]) -> T {
        match self.curve {
            Curve::Symmetric { interfaces } => crossing::symmetric(self.law, rates[0], interfaces),
            Curve::Asymmetric => {
                let [one, two] = rates.map(|v| Interface::at(self.law, v));
                crossing::asymmetric(&one, &two, self.root)
            }
        }
    }

    /// K of the closed form with its derivative in V_H.
    fn closed_form_along<T: Real>(&self, rates: [T; 2]) -> Jet<T, 1> {
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
            Curve::Symmetric { interfaces } => crossing::symmetric_frequency(&one, k, interfaces),
            Curve::Asymmetric => crossing::asymmetric_frequency(&one, &two, k),
        }
    }

    /// K at these rates if a pair of eigenvalues crosses there.
    pub fn stiffness(&self, rates: [f64; 2]) -> Option<f64> {
        let k = self.closed_form(rates);
        (k > 0.0 && k.is_finite() && self.frequency_squared(rates, k) > 0.0).then_some(k)
    }

    fn enclosed(&self, driving: f64, near: [f64; 2]) -> Interval {
        self.closed_form(self.curve.enclosed(self.law, driving, near))
    }

    /// The period 2 pi / omega, enclosed.
    fn period(&self, driving: f64, near: [f64; 2], k: Option<f64>) -> Interval {
        let rates = self.curve.enclosed(self.law, driving, near);
        let k = k.map_or_else(|| self.closed_form(rates), Interval::constant);
        Interval::around(TAU, f64::EPSILON) / self.frequency_squared(rates, k).sqrt()
    }

    /// The Hopf point at exactly this V_H.
    pub fn at_driving(&self, driving: f64, near: [f64; 2]) -> Option<Hopf> {
        let rates = self.curve.rates_at::<f64>(self.law, driving, near);
        let stiffness = self.stiffness(rates)?;
        Some(Hopf {
            driving: Uncertain::new(driving, 0.0),
            stiffness: within(stiffness, self.enclosed(driving, near)),
            period: self.uncertain_period(rates, stiffness, &[driving], None),
            rates,
        })
    }

    /// The Hopf point at exactly this K, at a V_H near this one. None where K does not certainly pass the value.
    pub fn at_stiffness(&self, k: f64, driving: f64, near: [f64; 2]) -> Option<Hopf> {
        let along = |v: f64| {
            let jet = self.closed_form_along(self.curve.rates_at::<f64>(self.law, v, near));
            (jet.value - k, jet.gradient[0])
        };
        let (low, high) = straddling(driving, |v| along(v).0)?;
        let v = bracketed_root("a Hopf point", low, high, along).ok()?;
        let rates = self.curve.rates_at::<f64>(self.law, v, near);
        let radius = enclosing_radius(v, |x| self.enclosed(x.leading(), near) - k);
        let positive = self.frequency_squared(rates, k) > 0.0;
        if !(radius.is_finite() && positive) {
            return None;
        }
        Some(Hopf {
            driving: Uncertain::new(v, radius),
            stiffness: Uncertain::new(k, 0.0),
            period: self.uncertain_period(rates, k, &[v - radius, v, v + radius], Some(k)),
            rates,
        })
    }

    fn uncertain_period(
        &self,
        rates: [f64; 2],
        k: f64,
        at: &[f64],
        exact: Option<f64>,
    ) -> Uncertain {
        let value = TAU / self.frequency_squared(rates, k).sqrt();
        let bounds = at.iter().map(|&v| self.period(v, rates, exact));
        let radius = bounds.map(|b| bound(value, b)).fold(0.0, f64::max);
        Uncertain::new(value, radius)
    }

    /// The largest K of the curve, near this V_H. None where dK/dV_H does not certainly change its sign.
    pub fn top(&self, driving: f64, near: [f64; 2]) -> Option<Hopf> {
        let slope = |v: Interval| {
            let rates = self.curve.enclosed(self.law, v.leading(), near);
            self.closed_form_along(rates).gradient[0]
        };
        let radius = enclosing_radius(driving, slope);
        if radius > 1e-3 * driving {
            return None;
        }
        let mut top = self.at_driving(driving, near)?;
        // between the two signs K changes by no more than their bounds allow
        let ends = [driving - radius, driving + radius];
        let reach = ends.map(|v| {
            let spread = (slope(Interval::constant(v)).abs() * radius).hi();
            bound(top.stiffness.value, self.enclosed(v, near)) + spread
        });
        top.stiffness.uncertainty = reach[0].max(reach[1]).max(top.stiffness.uncertainty);
        top.period = self.uncertain_period(top.rates, top.stiffness.value, &ends, None);
        top.driving.uncertainty = radius;
        Some(top)
    }

    /// l_1 at exactly this V_H, at the closed form's K.
    pub fn lyapunov(&self, driving: f64, near: [f64; 2]) -> Lyapunov {
        let rates = self.curve.in_31_digits(self.law, driving, near);
        let pair = [rates[0], *rates.last().unwrap_or(&rates[0])];
        let k: DoubleDouble = self.closed_form(pair);
        let omega = self.frequency_squared(pair, k).sqrt();
        first_lyapunov(self.law, &rates, k, omega)
    }

    /// The zero of l_1 near this V_H. None where its sign does not change.
    pub fn degenerate(&self, driving: f64, near: [f64; 2]) -> Option<Hopf> {
        let mut radius = driving * f64::EPSILON;
        let sign = |v: f64| self.lyapunov(v, near).value.signum();
        while sign(driving - radius) == sign(driving + radius) {
            radius *= 2.0;
            if radius > 1e-6 * driving {
                return None;
            }
        }
        let mut point = self.at_driving(driving, near)?;
        let ends = [driving - radius, driving + radius];
        let reach = ends.map(|v| bound(point.stiffness.value, self.enclosed(v, near)));
        point.stiffness.uncertainty = reach[0].max(reach[1]);
        point.period = self.uncertain_period(point.rates, point.stiffness.value, &ends, None);
        point.driving.uncertainty = radius;
        Some(point)
    }

    /// K where the pair crosses by the Jacobian of (19) or (11) itself, near the closed form's; found in a bracket.
    pub fn numerical(&self, rates: [f64; 2], near: f64) -> Option<f64> {
        let condition = |k: f64| {
            let matrix = self.jacobian(rates, k);
            let trace = matrix.trace();
            if self.curve != Curve::Asymmetric {
                return trace;
            }
            let minor = |i: usize, j: usize| {
                matrix[(i, i)] * matrix[(j, j)] - matrix[(i, j)] * matrix[(j, i)]
            };
            let minors = minor(0, 1) + minor(0, 2) + minor(1, 2);
            matrix.determinant() - trace * minors
        };
        let (low, high) = straddling(near, condition)?;
        let with_slope = |k: f64| {
            let h = 1e-4 * k;
            (
                condition(k),
                (condition(k + h) - condition(k - h)) / (2.0 * h),
            )
        };
        bracketed_root("the numerical Hopf point", low, high, with_slope).ok()
    }

    /// Of the plane of symmetry, or of all three equations.
    fn jacobian(&self, rates: [f64; 2], k: f64) -> DMatrix<f64> {
        let w = rates.map(|v| self.law.steady_state(v).ln());
        let tau = steady_stress(self.law, rates[0]);
        let loading = |interfaces: f64| Loading {
            driving: rates[0] + (interfaces - 1.0) * rates[1],
            stiffness: k,
        };
        match self.curve {
            Curve::Asymmetric => {
                let y = State::<3>::new(tau, w[0], w[1]);
                let j = two_interfaces(*self.law, loading(2.0)).jacobian(&y);
                DMatrix::from_fn(3, 3, |i, l| j[(i, l)])
            }
            Curve::Symmetric { interfaces } => {
                // two interfaces in symmetry are one on a spring twice as stiff
                let stiffer = Loading {
                    driving: rates[0],
                    stiffness: k * interfaces as f64,
                };
                let j = single_interface(*self.law, stiffer).jacobian(&State::<2>::new(tau, w[0]));
                DMatrix::from_fn(2, 2, |i, l| j[(i, l)])
            }
        }
    }

    /// The budgets widened to the numerical condition.
    pub fn crosschecked(&self, mut point: Hopf) -> Hopf {
        let closed = self.closed_form(point.rates);
        let apart = self
            .numerical(point.rates, closed)
            .map_or(f64::INFINITY, |k| (k - closed).abs());
        if point.stiffness.uncertainty == 0.0 {
            let slope =
                self.stiffness_slope(point.driving.value, point.rates) / point.driving.value;
            point.driving.uncertainty = point.driving.uncertainty.max(apart / slope.abs());
        } else {
            point.stiffness.uncertainty = point.stiffness.uncertainty.max(apart);
        }
        point
    }
}

/// The sign of l_1.
pub(super) fn criticality(l_1: Lyapunov) -> Criticality {
    /// The point itself is known in 16 digits.
    const KNOWN: f64 = 1e-12;
    if l_1.value.abs() <= KNOWN * l_1.scale || !l_1.value.is_finite() {
        Criticality::Undecided
    } else if l_1.value < 0.0 {
        Criticality::Supercritical
    } else {
        Criticality::Subcritical
    }
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

/// A value with the bound that follows from where the truth lies.
pub(super) fn within(value: f64, bounds: Interval) -> Uncertain {
    Uncertain::new(value, bound(value, bounds))
}

/// Two values around x > 0, as close as may be, at which g has opposite signs.
fn straddling(x: f64, g: impl Fn(f64) -> f64) -> Option<(f64, f64)> {
    let mut part = 1e-10;
    while part < 1e-2 {
        let (low, high) = (x * (1.0 - part), x * (1.0 + part));
        if g(low) * g(high) < 0.0 {
            return Some((low, high));
        }
        part *= 4.0;
    }
    None
}
