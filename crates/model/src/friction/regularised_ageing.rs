//! The regularised Dieterich-Ruina law, equation (5) (Lapusta et al. 2000), with the ageing evolution of (4).

use super::{AgeingForm, Formulas, Law, LawForm, Parameters, direct};
use crate::number::{Constant, Free, Real, With};

/// tau = asinh(v psi^beta / gamma0), dpsi/dt = 1 - |v| psi, with psi in L/V*.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct RegularisedAgeing<C = f64> {
    /// b/a
    pub beta: C,
    /// 2 exp(-a_v/a)
    pub gamma0: C,
}

impl<C> Parameters<C> {
    /// Law (5) with the ageing evolution of (4).
    pub fn regularised_ageing(self) -> RegularisedAgeing<C> {
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

impl<C: Constant> Formulas<C> for RegularisedAgeing<C> {
    #[inline(always)]
    fn activation<T: With<C>>(&self, tau: T) -> T {
        tau.sinh().times(self.gamma0)
    }

    #[inline(always)]
    fn slip_rate<T: With<C>>(&self, activation: T, psi: T) -> T {
        activation * psi.power(-self.beta)
    }

    fn log_strength<T: With<C>>(&self, psi: T) -> T {
        psi.ln().times(self.beta)
    }

    fn compliance<T: With<C>>(&self, v: T, log_strength: T) -> T {
        direct::compliance(v, log_strength, self.gamma0)
    }

    // tau = asinh{(v/2) exp[(a_v + b ln psi)/a]}  (5)
    fn stress<T: With<C>>(&self, v: T, psi: T) -> T {
        let log_h = || self.log_strength(psi);
        direct::stress(v, psi.power(self.beta), log_h, self.gamma0)
    }

    // dpsi/dt = 1 - |v| psi
    #[inline(always)]
    fn evolution<T: With<C>>(&self, v: T, psi: T) -> T {
        T::constant(1.0) - v.abs() * psi
    }

    fn steady_state<T: With<C>>(&self, v: T) -> T {
        T::constant(1.0) / v
    }
}

impl RegularisedAgeing {
    /// The law in the constants that its power series are made from.
    pub(super) fn form(&self) -> LawForm {
        AgeingForm::of_ageing(self.beta, self.gamma0).into()
    }
}

impl Law for RegularisedAgeing {
    type Freed<T: Real> = RegularisedAgeing<Free<T>>;

    fn freed<T: Real>(&self, constants: Parameters<Free<T>>) -> RegularisedAgeing<Free<T>> {
        constants.regularised_ageing()
    }

    fn name(&self) -> &'static str {
        Self::NAME
    }

    fn constants(&mut self) -> [Option<&mut f64>; Parameters::NAMES.len()] {
        [
            Some(&mut self.beta),
            Some(&mut self.gamma0),
            None,
            None,
            None,
        ]
    }

    fn log_activation(&self, tau: f64) -> f64 {
        direct::log_activation(tau, self.gamma0)
    }

    fn lasts(&self) -> bool {
        true
    }

    // tau_ss = asinh(V^(1-beta) / gamma0) is monotonic
    fn steady_extrema(&self) -> Vec<f64> {
        Vec::new()
    }
}
