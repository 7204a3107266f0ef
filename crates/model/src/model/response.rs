//! What one interface does at (tau, w): slip rate and evolution, with their derivatives, from the law's formulas.

use crate::friction::Formulas;
use crate::number::{Jet, Real, With};

/// First derivatives in (tau, w).
pub(super) type Slope = Jet<f64, 2>;
/// First and second derivatives in (tau, w).
pub(super) type Curvature = Jet<Jet<f64, 2>, 2>;

/// v and dw/dt.
#[derive(Debug, Clone, Copy)]
pub(super) struct Response<T> {
    /// slip rate
    pub v: T,
    /// dw/dt
    pub g: T,
}

impl<T: Real> Response<T> {
    /// At an activation s(tau) computed once for all interfaces, and w.
    #[inline]
    pub fn new<C>(law: &impl Formulas<C>, activation: T, w: T) -> Self
    where
        T: With<C>,
    {
        let psi = w.exp();
        let v = law.slip_rate(activation, psi);
        let g = law.evolution(v, psi) / psi;
        Response { v, g }
    }
}

#[inline]
pub(super) fn slope_variables(tau: f64, w: f64) -> [Slope; 2] {
    [Jet::variable(tau, 0), Jet::variable(w, 1)]
}

#[inline]
pub(super) fn curvature_variables(tau: f64, w: f64) -> [Curvature; 2] {
    let [tau, w] = slope_variables(tau, w);
    [Jet::variable(tau, 0), Jet::variable(w, 1)]
}

/// The second derivative of one component applied to two directions in (tau, w).
#[inline]
pub(super) fn bilinear(x: &Curvature, a: [f64; 2], b: [f64; 2]) -> f64 {
    let along = |row: &Slope| row.gradient[0] * b[0] + row.gradient[1] * b[1];
    along(&x.gradient[0]) * a[0] + along(&x.gradient[1]) * a[1]
}
