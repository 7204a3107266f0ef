//! The spinodal law, equation (35): the bounded law with a residual strength c that makes friction strengthen again at high
//! slip rates. Its steady stress (36) rises to V_M, falls to V_m and rises again.

use super::{Law, Parameters, direct};
use crate::number::Real;

/// tau = asinh(v [c + (1+R) psi]^beta / gamma0), dpsi/dt = (1 - psi)/R - |v| psi.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Spinodal {
    /// b/a
    pub beta: f64,
    /// 2 exp(-a_v/a)
    pub gamma0: f64,
    /// R = t** V*/L
    pub r: f64,
    /// residual strength
    pub c: f64,
}

impl Parameters {
    /// Law (35): spinodal.
    pub fn spinodal(self) -> Spinodal {
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

    // c + (1+R) psi
    #[inline(always)]
    fn strength<T: Real>(&self, psi: T) -> T {
        (T::constant(1.0) + self.r) * psi + self.c
    }
}

impl Law for Spinodal {
    type Core = Spinodal;
    const UNROLLED: bool = true;
    const UNROLLED_IN_LANES: bool = true;

    fn core(&self) -> Spinodal {
        *self
    }

    fn name(&self) -> &'static str {
        Self::NAME
    }

    fn constants(&mut self) -> Vec<(&'static str, &mut f64)> {
        vec![
            ("beta", &mut self.beta),
            ("gamma0", &mut self.gamma0),
            ("r", &mut self.r),
            ("c", &mut self.c),
        ]
    }

    #[inline(always)]
    fn activation<T: Real>(&self, tau: T) -> T {
        tau.sinh() * self.gamma0
    }

    // v = gamma0 sinh(tau) / [c + (1+R) psi]^beta, from (35)
    #[inline(always)]
    fn slip_rate<T: Real>(&self, activation: T, psi: T) -> T {
        activation / self.strength(psi).powf(self.beta)
    }

    fn log_strength<T: Real>(&self, psi: T) -> T {
        self.strength(psi).ln() * self.beta
    }

    fn log_activation(&self, tau: f64) -> f64 {
        direct::log_activation(tau, self.gamma0)
    }

    fn compliance<T: Real>(&self, v: T, log_strength: T) -> T {
        direct::compliance(v, log_strength, self.gamma0)
    }

    // tau = asinh{v [c + (1+R) psi]^beta / gamma0}  (35)
    fn stress<T: Real>(&self, v: T, psi: T) -> T {
        let log_h = || self.log_strength(psi);
        direct::stress(v, self.strength(psi).powf(self.beta), log_h, self.gamma0)
    }

    // dpsi/dt = (1 - psi)/R - |v| psi  (35)
    #[inline(always)]
    fn evolution<T: Real>(&self, v: T, psi: T) -> T {
        (T::constant(1.0) - psi) / self.r - v.abs() * psi
    }

    // psi_ss = 1 / (1 + R V)
    fn steady_state<T: Real>(&self, v: T) -> T {
        T::constant(1.0) / (v * self.r + 1.0)
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
