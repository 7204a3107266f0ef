//! The slip law: the direct effect of (4) with the evolution of Ruina (1983), in which a resting interface does not heal.
//!
//! Ruina, A. (1983). Slip instability and state variable friction laws. J. Geophys. Res. 88, 10359-10370.

use super::{DieterichRuina, Law, Parameters};
use crate::number::Real;

/// tau = a_v/a + ln v + beta ln psi, dpsi/dt = -v psi ln(v psi), with psi in L/V*.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Slip {
    /// b/a
    pub beta: f64,
    /// 2 exp(-a_v/a)
    pub gamma0: f64,
}

impl Parameters {
    /// The slip law of Ruina (1983).
    pub fn slip(self) -> Slip {
        Slip {
            beta: self.beta,
            gamma0: self.gamma0,
        }
    }
}

impl Slip {
    /// The name by which the command line knows the law.
    pub const NAME: &str = "slip";

    fn direct_effect(&self) -> DieterichRuina {
        DieterichRuina {
            beta: self.beta,
            gamma0: self.gamma0,
        }
    }
}

impl Law for Slip {
    type Core = Slip;

    fn core(&self) -> Slip {
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
        self.direct_effect().activation(tau)
    }

    #[inline(always)]
    fn slip_rate<T: Real>(&self, activation: T, psi: T) -> T {
        self.direct_effect().slip_rate(activation, psi)
    }

    fn log_strength<T: Real>(&self, psi: T) -> T {
        self.direct_effect().log_strength(psi)
    }

    fn log_activation(&self, tau: f64) -> f64 {
        self.direct_effect().log_activation(tau)
    }

    fn compliance<T: Real>(&self, v: T, log_strength: T) -> T {
        self.direct_effect().compliance(v, log_strength)
    }

    fn stress<T: Real>(&self, v: T, psi: T) -> T {
        self.direct_effect().stress(v, psi)
    }

    // dpsi/dt = -v psi ln(v psi)
    #[inline(always)]
    fn evolution<T: Real>(&self, v: T, psi: T) -> T {
        let x = v * psi;
        -(x * x.ln())
    }

    fn steady_state<T: Real>(&self, v: T) -> T {
        T::constant(1.0) / v
    }

    fn steady_extrema(&self) -> Vec<f64> {
        Vec::new()
    }
}
