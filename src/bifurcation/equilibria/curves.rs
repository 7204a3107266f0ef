//! The curves that equilibria lie on, as zero problems along ln V_H, and their points as slip rates.
//!
//! The symmetric state is V_H / n. Of an asymmetric one z = ln(V_fast / V_slow) / 2 is the only unknown: the rates then sum to
//! V_H by construction, and (20) is left, divided by z. So divided the curve goes straight through the pitchforks at z = 0,
//! and the symmetric state is no part of it.

use crate::continuation::{CurvePoint, ZeroProblem};
use crate::equilibrium::Symmetry;
use crate::error::Result;
use crate::friction::{AnyLaw, Formulas, Law, steady_log_activation};
use crate::number::{Difference, Jet, Real, log_ratio};
use nalgebra::{DMatrix, DVector};

/// Below this z the quotient is its series: the term left out is of the fourth order.
const SERIES: f64 = 1e-5;

/// [ln s(tau_ss(V_fast)) - ln s(tau_ss(V_slow))] / (ln V_fast - ln V_slow) where both sum to V_H  (20), (21). The logarithm of the
/// activation rises and falls with the stress, and has a double where V_slow has none.
fn balance<T: Real>(law: &impl Law, z: T, log_driving: T) -> T {
    if z.leading().abs() < SERIES {
        // as a function of x = ln V, about x = ln(V_H / 2)
        let x = log_driving - std::f64::consts::LN_2 - z * z * 0.5;
        let [first, third] = log_derivatives(law, x);
        return first + third * z * z / 6.0;
    }
    let fast = log_driving - (-z * 2.0).exp().ln_1p();
    let rates = Difference::new(fast, fast - z * 2.0, z * 2.0).exp();
    if law.damping() != 0.0 {
        return steady_log_activation(law, rates).gap / (z * 2.0);
    }
    law.log_strength(law.steady_state(rates)).gap / (z * 2.0) + 1.0
}

/// The first and third derivatives of ln s(tau_ss) in x = ln V.
fn log_derivatives<T: Real>(law: &impl Law, x: T) -> [T; 2] {
    let x = Jet::<_, 1>::variable(Jet::<_, 1>::variable(Jet::<T, 1>::variable(x, 0), 0), 0);
    if law.damping() != 0.0 {
        let level = steady_log_activation(law, x.exp());
        return [
            level.value.value.gradient[0],
            level.gradient[0].gradient[0].gradient[0],
        ];
    }
    let level = law.log_strength(law.steady_state(x.exp()));
    [
        level.value.value.gradient[0] + 1.0,
        level.gradient[0].gradient[0].gradient[0],
    ]
}

/// What u means.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum CurveVariables {
    /// No unknown: all interfaces slide at V_H / n.
    Symmetric { interfaces: usize },
    /// u = z.
    Asymmetric,
}

impl CurveVariables {
    /// The symmetry of its equilibria.
    pub fn symmetry(self) -> Symmetry {
        match self {
            CurveVariables::Symmetric { .. } => Symmetry::Symmetric,
            CurveVariables::Asymmetric => Symmetry::Asymmetric,
        }
    }

    /// Both slip rates at V_H, the slower one first.
    pub fn rates(self, point: &CurvePoint, driving: f64) -> [f64; 2] {
        match self {
            CurveVariables::Symmetric { interfaces } => [driving / interfaces as f64; 2],
            CurveVariables::Asymmetric => {
                let ratio = (2.0 * point.u[0].abs()).exp();
                [driving / (1.0 + ratio), driving / (1.0 + 1.0 / ratio)]
            }
        }
    }

    /// u of these rates.
    pub fn unknown(self, law: &AnyLaw, [slow, fast]: [f64; 2]) -> DVector<f64> {
        let ratio = if slow > 0.0 {
            log_ratio(slow, fast)
        } else {
            // the slower one, smaller than any double, has healed
            let healed = law.log_strength(law.steady_state(0.0));
            fast.ln() - (steady_log_activation(law, fast) - healed)
        };
        match self {
            CurveVariables::Symmetric { .. } => DVector::zeros(0),
            CurveVariables::Asymmetric => DVector::from_element(1, 0.5 * ratio),
        }
    }
}

/// A curve of equilibria along lambda = ln V_H.
#[derive(Debug, Clone, Copy)]
pub(super) struct AlongDriving<'a> {
    pub law: &'a AnyLaw,
    pub curve: CurveVariables,
}

impl ZeroProblem for AlongDriving<'_> {
    fn dimension(&self) -> usize {
        usize::from(self.curve == CurveVariables::Asymmetric)
    }

    fn residual(&self, u: &DVector<f64>, lambda: f64) -> Result<DVector<f64>> {
        let value = |z: &f64| balance(self.law, *z, lambda);
        Ok(DVector::from_iterator(u.len(), u.iter().map(value)))
    }

    fn jacobian(&self, u: &DVector<f64>, lambda: f64) -> Result<DMatrix<f64>> {
        let row = |z: &f64| {
            let [z, x] = Jet::variables([*z, lambda]);
            balance(self.law, z, x).gradient
        };
        Ok(DMatrix::from_row_iterator(
            u.len(),
            u.len() + 1,
            u.iter().flat_map(row),
        ))
    }
}

/// One equilibrium along lambda = ln K: nothing but lambda changes.
#[derive(Debug, Clone, Copy)]
pub(super) struct AlongStiffness;

impl ZeroProblem for AlongStiffness {
    fn dimension(&self) -> usize {
        0
    }

    fn residual(&self, _: &DVector<f64>, _: f64) -> Result<DVector<f64>> {
        Ok(DVector::zeros(0))
    }

    fn jacobian(&self, _: &DVector<f64>, _: f64) -> Result<DMatrix<f64>> {
        Ok(DMatrix::zeros(0, 1))
    }
}
