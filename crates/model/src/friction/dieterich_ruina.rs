//! The Dieterich-Ruina law with the ageing evolution, equations (4) and (8). Velocity weakening throughout for beta > 1.

use super::{AgeingForm, Formulas, Law, LawForm, Parameters};
use crate::number::{Constant, Free, Real, With};

/// tau = a_v/a + ln v + beta ln psi, dpsi/dt = 1 - v psi, with psi in L/V*.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct DieterichRuina<C = f64> {
    /// b/a
    pub beta: C,
    /// 2 exp(-a_v/a)
    pub gamma0: C,
}

impl<C> Parameters<C> {
    /// Law (4): Dieterich-Ruina.
    pub fn dieterich_ruina(self) -> DieterichRuina<C> {
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

impl<C: Constant> Formulas<C> for DieterichRuina<C> {
    const EXPONENTIAL: bool = true;

    // exp(-a_v/a) = gamma0 / 2
    #[inline(always)]
    fn activation<T: With<C>>(&self, tau: T) -> T {
        tau.exp().times(self.gamma0 * 0.5)
    }

    // v = exp(-a_v/a) psi^(-beta) exp(tau)  (8)
    #[inline(always)]
    fn slip_rate<T: With<C>>(&self, activation: T, psi: T) -> T {
        activation * psi.power(-self.beta)
    }

    fn log_strength<T: With<C>>(&self, psi: T) -> T {
        psi.ln().times(self.beta)
    }

    // F_V = 1/v
    fn compliance<T: With<C>>(&self, v: T, _: T) -> T {
        v
    }

    // tau = a_v/a + ln v + beta ln psi  (4)
    fn stress<T: With<C>>(&self, v: T, psi: T) -> T {
        v.ln() + psi.ln().times(self.beta) - T::of(self.gamma0 * 0.5).ln()
    }

    // dpsi/dt = 1 - v psi  (4)
    #[inline(always)]
    fn evolution<T: With<C>>(&self, v: T, psi: T) -> T {
        T::constant(1.0) - v * psi
    }

    // psi_ss = 1 / V
    fn steady_state<T: With<C>>(&self, v: T) -> T {
        T::constant(1.0) / v
    }
}

impl DieterichRuina {
    /// The law in the constants that its power series are made from.
    pub(super) fn form(&self) -> LawForm {
        let form = AgeingForm {
            exponential: true,
            ..AgeingForm::of_ageing(self.beta, self.gamma0)
        };
        form.into()
    }
}

impl Law for DieterichRuina {
    type Freed<T: Real> = DieterichRuina<Free<T>>;

    fn freed<T: Real>(&self, constants: Parameters<Free<T>>) -> DieterichRuina<Free<T>> {
        constants.dieterich_ruina()
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
        tau + (0.5 * self.gamma0).ln()
    }

    // tau_ss = a_v/a + (1 - beta) ln V is monotonic
    fn steady_extrema(&self) -> Vec<f64> {
        Vec::new()
    }
}
