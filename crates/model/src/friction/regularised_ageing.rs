//! The regularised Dieterich-Ruina law, equation (5) (Lapusta et al. 2000), with the ageing evolution of (4).

use super::{Law, Parameters, direct};
use crate::number::Real;

/// tau = asinh(v psi^beta / gamma0), dpsi/dt = 1 - |v| psi, with psi in L/V*.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct RegularisedAgeing {
    /// b/a
    pub beta: f64,
    /// 2 exp(-a_v/a)
    pub gamma0: f64,
}

impl Parameters {
    /// Law (5) with the ageing evolution of (4).
    pub fn regularised_ageing(self) -> RegularisedAgeing {
        RegularisedAgeing {
            beta: self.beta,
            gamma0: self.gamma0,
        }
    }
}

impl RegularisedAgeing {
    /// The name by which the command line knows the law.
    pub const NAME: &str = "regularised-ageing";
}

impl Law for RegularisedAgeing {
    type Core = RegularisedAgeing;

    fn core(&self) -> RegularisedAgeing {
        *self
    }

    fn name(&self) -> &'static str {
        Self::NAME
    }

    fn constants(&mut self) -> Vec<(&'static str, &mut f64)> {
        vec![("beta", &mut self.beta), ("gamma0", &mut self.gamma0)]
    }

    #[inline(always)]
    fn activation<T: Real>(&self, tau: T) -> T {
        tau.sinh() * self.gamma0
    }

    #[inline(always)]
    fn slip_rate<T: Real>(&self, activation: T, psi: T) -> T {
        activation * psi.powf(-self.beta)
    }

    fn log_strength<T: Real>(&self, psi: T) -> T {
        psi.ln() * self.beta
    }

    fn log_activation(&self, tau: f64) -> f64 {
        direct::log_activation(tau, self.gamma0)
    }

    fn compliance<T: Real>(&self, v: T, log_strength: T) -> T {
        direct::compliance(v, log_strength, self.gamma0)
    }

    // tau = asinh{(v/2) exp[(a_v + b ln psi)/a]}  (5)
    fn stress<T: Real>(&self, v: T, psi: T) -> T {
        let log_h = || self.log_strength(psi);
        direct::stress(v, psi.powf(self.beta), log_h, self.gamma0)
    }

    // dpsi/dt = 1 - |v| psi
    #[inline(always)]
    fn evolution<T: Real>(&self, v: T, psi: T) -> T {
        T::constant(1.0) - v.abs() * psi
    }

    fn steady_state<T: Real>(&self, v: T) -> T {
        T::constant(1.0) / v
    }

    fn lasts(&self) -> bool {
        true
    }

    // tau_ss = asinh(V^(1-beta) / gamma0) is monotonic
    fn steady_extrema(&self) -> Vec<f64> {
        Vec::new()
    }
}
