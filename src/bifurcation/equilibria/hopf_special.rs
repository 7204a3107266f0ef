//! What else there is to know of Hopf points: criticality, the largest K, zeros of l_1, and the same point by other means.
//!
//! That the closed forms are right is no part of their error budgets: they are held against the numerical condition on the
//! Jacobian of the vector field itself, and a special point's budget covers the difference.

use super::crossing::QuadraticRoot;
use super::curves::CurveVariables;
use super::hopf::{Hopf, HopfPoints, certain_zero, straddling};
use super::lyapunov::{FirstLyapunov, first_lyapunov};
use crate::bifurcation::{Criticality, Label, Parameter, Special, Symmetry};
use crate::field::State;
use crate::friction::{AnyLaw, Formulas, steady_stress};
use crate::model::{Loading, single_interface, two_interfaces};
use crate::number::{DoubleDouble, Real, Uncertain, bracketed_root};
use nalgebra::DMatrix;

impl HopfPoints<'_> {
    /// l_1 at exactly this V_H, at the closed form's K.
    pub fn lyapunov(&self, driving: f64, near: [f64; 2]) -> FirstLyapunov {
        let rates = self.curve.in_31_digits(self.law, driving, near);
        let pair = [rates[0], *rates.last().unwrap_or(&rates[0])];
        let k: DoubleDouble = self.closed_form(pair);
        let omega = self.frequency_squared(pair, k).sqrt();
        first_lyapunov(self.law, &rates, k, omega)
    }

    /// The sign of l_1, if it is the same wherever the point may lie.
    pub fn criticality(&self, point: &Hopf) -> Criticality {
        let (v, radius) = (point.driving.value, point.driving.uncertainty);
        if !radius.is_finite() {
            return Criticality::Undecided;
        }
        let signs = [v - radius, v, v + radius].map(|v| self.lyapunov(v, point.rates).sign());
        match signs[1] {
            Some(sign) if signs == [Some(sign); 3] && sign < 0.0 => Criticality::Supercritical,
            Some(sign) if signs == [Some(sign); 3] => Criticality::Subcritical,
            _ => Criticality::Undecided,
        }
    }

    /// The largest K of the curve, near this V_H. None where K has no maximum there.
    pub fn top(&self, driving: f64, near: [f64; 2]) -> Option<Hopf> {
        let slope = |v: f64| {
            let pair = self.curve.rates_at::<DoubleDouble>(self.law, v, near);
            let k = self.closed_form_along(pair);
            let relative = (k.gradient[0] * v / k.value).to_f64();
            let off = self.inputs(v, near, |points, rates| {
                let k = points.closed_form_along(rates);
                k.gradient[0] * v / k.value
            });
            // a law whose K is the same throughout leaves rounding
            (relative, relative.abs() > off.max(1e-22))
        };
        let (v, radius) = certain_zero("the largest K", driving, slope)?;
        let maximum = slope(v - radius).0 > 0.0;
        maximum.then(|| self.around_driving((v, radius), near))?
    }

    /// The zero of l_1 near this V_H. None where its sign does not change.
    pub fn degenerate(&self, driving: f64, near: [f64; 2]) -> Option<Hopf> {
        let l_1 = |v: f64| {
            let l_1 = self.lyapunov(v, near);
            // the parameters are rounded
            let part = l_1.value / l_1.scale;
            (part, part.abs() > 100.0 * f64::EPSILON)
        };
        let at = certain_zero("a degenerate Hopf point", driving, l_1)?;
        self.around_driving(at, near)
    }

    /// K where the pair crosses by the Jacobian of (19) or (11) itself, near the closed form's; found in a bracket.
    pub fn numerical(&self, rates: [f64; 2], near: f64) -> Option<f64> {
        let condition = |k: f64| {
            let matrix = self.jacobian(rates, k);
            let trace = matrix.trace();
            if self.curve != CurveVariables::Asymmetric {
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
            CurveVariables::Asymmetric => {
                let y = State::<3>::new(tau, w[0], w[1]);
                let j = two_interfaces(*self.law, loading(2.0)).jacobian(&y);
                DMatrix::from_fn(3, 3, |i, l| j[(i, l)])
            }
            CurveVariables::Symmetric { interfaces } => {
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
        let closed = point.stiffness.value;
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

/// The Hopf point of a curve of equilibria at this (V_H, K), of which the parameter that does not vary is exact, with the slip
/// rates there. `None` where no pair crosses: two real eigenvalues of opposite sign are no bifurcation.
pub(super) fn hopf_point(
    law: &AnyLaw,
    curve: CurveVariables,
    along: Parameter,
    [driving, stiffness]: [f64; 2],
    rates: [f64; 2],
) -> Option<(Special, [f64; 2])> {
    /// In ln V_H and ln K: that it is this one.
    const CLOSE: f64 = 1e-6;
    [QuadraticRoot::Larger, QuadraticRoot::Smaller]
        .into_iter()
        .find_map(|root| {
            let points = HopfPoints { law, curve, root };
            let found = match along {
                Parameter::Driving => points.at_stiffness(stiffness, driving, rates),
                Parameter::Stiffness => points.at_driving(driving, rates),
            };
            let near = |a: f64, b: f64| (a / b).ln().abs() < CLOSE;
            let point = found.filter(|point| {
                near(point.driving.value, driving) && near(point.stiffness.value, stiffness)
            })?;
            let point = points.crosschecked(point);
            let special = Special {
                period: point.period,
                criticality: Some(points.criticality(&point)),
                coefficient: Some(points.lyapunov(point.driving.value, point.rates).value),
                ..Special::new(Label::Hb, point.driving, point.stiffness)
            };
            Some((special, point.rates))
        })
}

/// K of a Hopf point by its closed form, by the Jacobian of the vector field, and what the comparison leaves certain of it.
pub fn by_both(
    law: &AnyLaw,
    driving: f64,
    rates: [f64; 2],
    symmetry: Symmetry,
) -> Option<(Uncertain, f64, Uncertain)> {
    let curve = match symmetry {
        Symmetry::Symmetric => CurveVariables::Symmetric { interfaces: 2 },
        Symmetry::Asymmetric => CurveVariables::Asymmetric,
    };
    let points = HopfPoints {
        law,
        curve,
        root: QuadraticRoot::Larger,
    };
    let point = points.at_driving(driving, rates)?;
    let closed = point.stiffness;
    let numerical = points.numerical(point.rates, closed.value)?;
    Some((closed, numerical, points.crosschecked(point).stiffness))
}
