//! The Dieterich-Ruina law with the ageing evolution, equations (4) and (8). Velocity weakening throughout for beta > 1.

use super::{Law, Parameters};
use crate::number::Real;

/// tau = a_v/a + ln v + beta ln psi, dpsi/dt = 1 - v psi, with psi in L/V*.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct DieterichRuina {
    /// b/a
    pub beta: f64,
    /// 2 exp(-a_v/a)
    pub gamma0: f64,
}

impl Parameters {
    /// Law (4): Dieterich-Ruina.
    pub fn dieterich_ruina(self) -> DieterichRuina {
        DieterichRuina {
            beta: self.beta,
            gamma0: self.gamma0,
        }
    }
}

impl DieterichRuina {
    /// The name by which the command line knows the law.
    pub const NAME: &str = "dieterich-ruina";
}

impl Law for DieterichRuina {
    type Core = DieterichRuina;
    const UNROLLED: bool = true;

    fn core(&self) -> DieterichRuina {
        *self
    }

    fn name(&self) -> &'static str {
        Self::NAME
    }

    fn constants(&mut self) -> Vec<(&'static str, &mut f64)> {
        vec![("beta", &mut self.beta), ("gamma0", &mut self.gamma0)]
    }

    // exp(-a_v/a) = gamma0 / 2
    #[inline(always)]
    fn activation<T: Real>(&self, tau: T) -> T {
        tau.exp() * (0.5 * self.gamma0)
    }

    // v = exp(-a_v/a) psi^(-beta) exp(tau)  (8)
    #[inline(always)]
    fn slip_rate<T: Real>(&self, activation: T, psi: T) -> T {
        activation * psi.powf(-self.beta)
    }

    fn log_strength<T: Real>(&self, psi: T) -> T {
        psi.ln() * self.beta
    }

    fn log_activation(&self, tau: f64) -> f64 {
        tau + (0.5 * self.gamma0).ln()
    }

    // F_V = 1/v
    fn compliance<T: Real>(&self, v: T, _: T) -> T {
        v
    }

    // tau = a_v/a + ln v + beta ln psi  (4)
    fn stress<T: Real>(&self, v: T, psi: T) -> T {
        v.ln() + psi.ln() * self.beta - T::constant(0.5 * self.gamma0).ln()
    }

    // dpsi/dt = 1 - v psi  (4)
    #[inline(always)]
    fn evolution<T: Real>(&self, v: T, psi: T) -> T {
        T::constant(1.0) - v * psi
    }

    // psi_ss = 1 / V
    fn steady_state<T: Real>(&self, v: T) -> T {
        T::constant(1.0) / v
    }

    // tau_ss = a_v/a + (1 - beta) ln V is monotonic
    fn steady_extrema(&self) -> Vec<f64> {
        Vec::new()
    }
}
