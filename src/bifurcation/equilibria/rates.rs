//! The slip rates of an asymmetric state at an exact V_H: refined in any numbers, enclosed in intervals, with their derivative.

use super::curves::CurveVariables;
use crate::equilibrium::{quotient, refined};
use crate::friction::{AnyLaw, steady_slope};
use crate::number::{DoubleDouble, Interval, Real, enclosing_radius};

impl CurveVariables {
    /// Both rates at V_H, next to these.
    pub fn rates_at<T: Real>(self, law: &AnyLaw, driving: f64, near: [f64; 2]) -> [T; 2] {
        match self {
            CurveVariables::Symmetric { interfaces } => {
                [T::constant(driving) / interfaces as f64; 2]
            }
            CurveVariables::Asymmetric => {
                // what is close in V_H has nearly the same ratio of the rates
                let slow = driving / (1.0 + near[1] / near[0]);
                let slow = refined(law, driving, T::constant(slow));
                [slow, T::constant(driving) - slow]
            }
        }
    }

    /// Both rates at V_H, enclosed; without bounds at a fold.
    pub fn enclosed(self, law: &AnyLaw, driving: f64, near: [f64; 2]) -> [Interval; 2] {
        let [slow, _] = self.rates_at::<f64>(law, driving, near);
        match self {
            CurveVariables::Symmetric { interfaces } => {
                [Interval::constant(driving) / interfaces as f64; 2]
            }
            CurveVariables::Asymmetric => {
                let radius = enclosing_radius(slow, |s| quotient(law, driving, s));
                let slow = Interval::around(slow, radius);
                [slow, Interval::constant(driving) - slow]
            }
        }
    }

    /// d(rates)/dV_H.
    pub fn slopes<T: Real>(self, law: &AnyLaw, rates: [T; 2]) -> [T; 2] {
        match self {
            CurveVariables::Symmetric { interfaces } => [T::constant(1.0) / interfaces as f64; 2],
            // tau_ss'(V_1) dV_1 = tau_ss'(V_2) dV_2, and both sum to dV_H  (20)
            CurveVariables::Asymmetric => {
                let [slow, fast] = rates.map(|v| steady_slope(law, v));
                [fast / (slow + fast), slow / (slow + fast)]
            }
        }
    }

    /// Both rates in 31 digits, one for each interface.
    pub fn in_31_digits(self, law: &AnyLaw, driving: f64, near: [f64; 2]) -> Vec<DoubleDouble> {
        let rates = self.rates_at::<DoubleDouble>(law, driving, near);
        match self {
            CurveVariables::Symmetric { interfaces } => rates[..interfaces].to_vec(),
            CurveVariables::Asymmetric => rates.to_vec(),
        }
    }
}
