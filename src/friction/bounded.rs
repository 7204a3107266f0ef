//! The paper's first proposal, equations (6) and (9): healing saturates after the time t**, so the state stays in (0, 1] and
//! a steady maximum of friction appears at V_M (7).

use super::Law;
use crate::number::Real;

/// tau = asinh(v [(1+R) psi]^beta / gamma0), dpsi/dt = (1 - psi)/R - |v| psi.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Bounded {
    /// b/a
    pub beta: f64,
    /// 2 exp(-a_v/a)
    pub gamma0: f64,
    /// R = t** V*/L
    pub r: f64,
}

impl Bounded {
    // psi / psi_*, with psi_* = L / (L + V* t**) = 1 / (1 + R)
    #[inline]
    fn relative_state<T: Real>(&self, psi: T) -> T {
        (T::constant(1.0) + self.r) * psi
    }
}

impl Law for Bounded {
    #[inline]
    fn activation<T: Real>(&self, tau: T) -> T {
        tau.sinh() * self.gamma0
    }

    // v = 2 exp(-a_v/a) (psi/psi_*)^(-beta) sinh(tau)  (9)
    #[inline]
    fn slip_rate<T: Real>(&self, activation: T, psi: T) -> T {
        activation / self.relative_state(psi).powf(self.beta)
    }

    // (6)
    fn stress<T: Real>(&self, v: T, psi: T) -> T {
        (v * self.relative_state(psi).powf(self.beta) / self.gamma0).asinh()
    }

    // dpsi/dt = (1 - psi)/R - |v| psi  (6)
    #[inline]
    fn evolution<T: Real>(&self, v: T, psi: T) -> T {
        (T::constant(1.0) - psi) / self.r - v.abs() * psi
    }

    // psi_ss = 1 / (1 + R V)
    fn steady_state<T: Real>(&self, v: T) -> T {
        T::constant(1.0) / (v * self.r + 1.0)
    }

    // V_M = 1 / (R (beta - 1))  (7)
    fn steady_extrema(&self) -> Vec<f64> {
        let v_peak = 1.0 / (self.r * (self.beta - 1.0));
        if v_peak > 0.0 && v_peak.is_finite() {
            vec![v_peak]
        } else {
            Vec::new()
        }
    }

    fn bounds_state(&self) -> bool {
        true
    }
}
