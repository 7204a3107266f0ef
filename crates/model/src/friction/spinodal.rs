//! The spinodal law, equation (35): the bounded law with a residual strength c that makes friction strengthen again at high
//! slip rates. Its steady stress (36) rises to V_M, falls to V_m and rises again.

use super::{AgeingForm, Formulas, Law, LawForm, Parameters, direct};
use crate::number::{Constant, Free, Real, With};

/// tau = asinh(v [c + (1+R) psi]^beta / gamma0), dpsi/dt = (1 - psi)/R - |v| psi.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Spinodal<C = f64> {
    /// b/a
    pub beta: C,
    /// 2 exp(-a_v/a)
    pub gamma0: C,
    /// R = t** V*/L
    pub r: C,
    /// residual strength
    pub c: C,
}

impl<C> Parameters<C> {
    /// Law (35): spinodal.
    pub fn spinodal(self) -> Spinodal<C> {
        Spinodal {
            beta: self.beta,
            gamma0: self.gamma0,
            r: self.healing_time,
            c: self.residual_strength,
        }
    }
}

impl Spinodal {
    /// The name by which the command line knows the law.
    pub const NAME: &str = "spinodal";
}

impl<C: Constant> Spinodal<C> {
    // c + (1+R) psi
    #[inline(always)]
    fn strength<T: With<C>>(&self, psi: T) -> T {
        (T::constant(1.0).plus(self.r) * psi).plus(self.c)
    }
}

impl<C: Constant> Formulas<C> for Spinodal<C> {
    #[inline(always)]
    fn activation<T: With<C>>(&self, tau: T) -> T {
        tau.sinh().times(self.gamma0)
    }

    // v = gamma0 sinh(tau) / [c + (1+R) psi]^beta, from (35)
    #[inline(always)]
    fn slip_rate<T: With<C>>(&self, activation: T, psi: T) -> T {
        activation / self.strength(psi).power(self.beta)
    }

    fn log_strength<T: With<C>>(&self, psi: T) -> T {
        self.strength(psi).ln().times(self.beta)
    }

    fn compliance<T: With<C>>(&self, v: T, log_strength: T) -> T {
        direct::compliance(v, log_strength, self.gamma0)
    }

    // tau = asinh{v [c + (1+R) psi]^beta / gamma0}  (35)
    fn stress<T: With<C>>(&self, v: T, psi: T) -> T {
        let log_h = || self.log_strength(psi);
        direct::stress(v, self.strength(psi).power(self.beta), log_h, self.gamma0)
    }

    // dpsi/dt = (1 - psi)/R - |v| psi  (35)
    #[inline(always)]
    fn evolution<T: With<C>>(&self, v: T, psi: T) -> T {
        (T::constant(1.0) - psi).over(self.r) - v.abs() * psi
    }

    // psi_ss = 1 / (1 + R V)
    fn steady_state<T: With<C>>(&self, v: T) -> T {
        T::constant(1.0) / (v.times(self.r) + 1.0)
    }
}

impl Spinodal {
    /// The law in the constants that its power series are made from.
    pub(super) fn form(&self) -> LawForm {
        let form = AgeingForm {
            strength: [self.c, 1.0 + self.r],
            healing: [1.0 / self.r, -1.0 / self.r],
            beta: self.beta,
            gamma0: self.gamma0,
            exponential: false,
        };
        form.into()
    }
}

impl Law for Spinodal {
    type Freed<T: Real> = Spinodal<Free<T>>;

    fn freed<T: Real>(&self, constants: Parameters<Free<T>>) -> Spinodal<Free<T>> {
        constants.spinodal()
    }

    fn name(&self) -> &'static str {
        Self::NAME
    }

    fn constants(&mut self) -> [Option<&mut f64>; Parameters::NAMES.len()] {
        [
            Some(&mut self.beta),
            Some(&mut self.gamma0),
            Some(&mut self.r),
            Some(&mut self.c),
            None,
        ]
    }

    fn log_activation(&self, tau: f64) -> f64 {
        direct::log_activation(tau, self.gamma0)
    }

    // With X = 1 + R V the extrema of (36) solve c X^2 - (1+R)(beta-1) X + beta (1+R) = 0. Written in y = R V no digit is lost,
    // and with q = c/(1+R) nothing overflows: q y^2 - [(beta-1) - 2 q] y + (1 + q) = 0.
    fn steady_extrema(&self) -> Vec<f64> {
        let q = self.c / (1.0 + self.r);
        let half = 0.5 * (self.beta - 1.0) - q;
        let discriminant = 1.0 - (q / half) * ((1.0 + q) / half);
        // Without a positive discriminant the stress rises throughout; a double root is an inflection, no extremum.
        if !(half > 0.0 && discriminant > 0.0) {
            return Vec::new();
        }
        let sum = half * (1.0 + discriminant.sqrt());
        let (v_peak, v_trough) = ((1.0 + q) / sum / self.r, sum / q / self.r);
        if v_trough.is_finite() {
            vec![v_peak, v_trough]
        } else {
            vec![v_peak]
        }
    }

    fn lasts(&self) -> bool {
        true
    }

    fn bounds_state(&self) -> bool {
        true
    }

    fn transition_rate(&self) -> Option<f64> {
        (self.c > 0.0).then(|| 1.0 / self.c)
    }
}
