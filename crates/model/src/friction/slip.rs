//! The slip law: the direct effect of (4) with the evolution of Ruina (1983), in which a resting interface does not heal.
//!
//! Ruina, A. (1983). Slip instability and state variable friction laws. J. Geophys. Res. 88, 10359-10370.

use super::{DieterichRuina, Formulas, Law, LawForm, Parameters};
use crate::number::{Constant, Free, Real, With};

/// tau = a_v/a + ln v + beta ln psi, dpsi/dt = -v psi ln(v psi), with psi in L/V*.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Slip<C = f64> {
    /// b/a
    pub beta: C,
    /// 2 exp(-a_v/a)
    pub gamma0: C,
}

impl<C> Parameters<C> {
    /// The slip law of Ruina (1983).
    pub fn slip(self) -> Slip<C> {
        Slip {
            beta: self.beta,
            gamma0: self.gamma0,
        }
    }
}

impl Slip {
    /// The name by which the command line knows the law.
    pub const NAME: &str = "slip";
}

impl<C: Constant> Slip<C> {
    #[inline(always)]
    fn direct_effect(&self) -> DieterichRuina<C> {
        DieterichRuina {
            beta: self.beta,
            gamma0: self.gamma0,
        }
    }
}

impl<C: Constant> Formulas<C> for Slip<C> {
    const EXPONENTIAL: bool = true;

    #[inline(always)]
    fn activation<T: With<C>>(&self, tau: T) -> T {
        self.direct_effect().activation(tau)
    }

    #[inline(always)]
    fn slip_rate<T: With<C>>(&self, activation: T, psi: T) -> T {
        self.direct_effect().slip_rate(activation, psi)
    }

    fn log_strength<T: With<C>>(&self, psi: T) -> T {
        self.direct_effect().log_strength(psi)
    }

    fn compliance<T: With<C>>(&self, v: T, log_strength: T) -> T {
        self.direct_effect().compliance(v, log_strength)
    }

    fn stress<T: With<C>>(&self, v: T, psi: T) -> T {
        self.direct_effect().stress(v, psi)
    }

    // dpsi/dt = -v psi ln(v psi)
    #[inline(always)]
    fn evolution<T: With<C>>(&self, v: T, psi: T) -> T {
        let x = v * psi;
        -(x * x.ln())
    }

    fn steady_state<T: With<C>>(&self, v: T) -> T {
        T::constant(1.0) / v
    }
}

impl Slip {
    /// The law in the constants that its power series are made from.
    pub(super) fn form(&self) -> LawForm {
        LawForm {
            slip_law: true,
            ..self.direct_effect().form()
        }
    }
}

impl Law for Slip {
    type Freed<T: Real> = Slip<Free<T>>;

    fn freed<T: Real>(&self, constants: Parameters<Free<T>>) -> Slip<Free<T>> {
        constants.slip()
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
        self.direct_effect().log_activation(tau)
    }

    fn steady_extrema(&self) -> Vec<f64> {
        Vec::new()
    }
}
