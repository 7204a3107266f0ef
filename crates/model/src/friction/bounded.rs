//! The paper's first proposal, equations (6) and (9): healing saturates after the time t**, so the state stays in (0, 1] and
//! a steady maximum of friction appears at V_M (7). It is the limit of the spinodal law (35) for c = 0, whose formulas serve.

use super::{Formulas, Law, LawForm, Parameters, Spinodal};
use crate::number::{Constant, Free, Real, With};

/// tau = asinh(v [(1+R) psi]^beta / gamma0), dpsi/dt = (1 - psi)/R - |v| psi.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Bounded<C = f64> {
    /// b/a
    pub beta: C,
    /// 2 exp(-a_v/a)
    pub gamma0: C,
    /// R = t** V*/L
    pub r: C,
}

impl<C> Parameters<C> {
    /// Law (6): the state bounded, no residual strength.
    pub fn bounded(self) -> Bounded<C> {
        Bounded {
            beta: self.beta,
            gamma0: self.gamma0,
            r: self.healing_time,
        }
    }
}

impl Bounded {
    /// The name by which the command line knows the law.
    pub const NAME: &str = "bounded";
}

impl<C: Constant> Bounded<C> {
    #[inline(always)]
    fn as_limit(&self) -> Spinodal<C> {
        let Bounded { beta, gamma0, r } = *self;
        Spinodal {
            beta,
            gamma0,
            r,
            c: C::fixed(0.0),
        }
    }
}

impl<C: Constant> Formulas<C> for Bounded<C> {
    #[inline(always)]
    fn activation<T: With<C>>(&self, tau: T) -> T {
        self.as_limit().activation(tau)
    }

    // v = 2 exp(-a_v/a) (psi/psi_*)^(-beta) sinh(tau), psi_* = 1 / (1 + R)  (9)
    #[inline(always)]
    fn slip_rate<T: With<C>>(&self, activation: T, psi: T) -> T {
        self.as_limit().slip_rate(activation, psi)
    }

    fn log_strength<T: With<C>>(&self, psi: T) -> T {
        self.as_limit().log_strength(psi)
    }

    fn compliance<T: With<C>>(&self, v: T, log_strength: T) -> T {
        self.as_limit().compliance(v, log_strength)
    }

    // tau = asinh{(v/2) exp[(a_v + b ln(psi/psi_*))/a]}  (6)
    fn stress<T: With<C>>(&self, v: T, psi: T) -> T {
        self.as_limit().stress(v, psi)
    }

    // dpsi/dt = (1 - psi)/R - |v| psi  (6)
    #[inline(always)]
    fn evolution<T: With<C>>(&self, v: T, psi: T) -> T {
        self.as_limit().evolution(v, psi)
    }

    fn steady_state<T: With<C>>(&self, v: T) -> T {
        self.as_limit().steady_state(v)
    }
}

impl Bounded {
    /// The law in the constants that its power series are made from.
    pub(super) fn form(&self) -> LawForm {
        self.as_limit().form()
    }
}

impl Law for Bounded {
    type Freed<T: Real> = Bounded<Free<T>>;

    fn freed<T: Real>(&self, constants: Parameters<Free<T>>) -> Bounded<Free<T>> {
        constants.bounded()
    }

    fn name(&self) -> &'static str {
        Self::NAME
    }

    fn constants(&mut self) -> [Option<&mut f64>; Parameters::NAMES.len()] {
        [
            Some(&mut self.beta),
            Some(&mut self.gamma0),
            Some(&mut self.r),
            None,
            None,
        ]
    }

    fn log_activation(&self, tau: f64) -> f64 {
        self.as_limit().log_activation(tau)
    }

    // V_M = 1 / (R (beta - 1))  (7)
    fn steady_extrema(&self) -> Vec<f64> {
        self.as_limit().steady_extrema()
    }

    fn lasts(&self) -> bool {
        true
    }

    fn bounds_state(&self) -> bool {
        true
    }
}
