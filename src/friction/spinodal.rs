//! The spinodal law, equation (35): the bounded law with a residual strength c that makes friction strengthen again at high
//! slip rates. Its steady stress (36) rises to V_M, falls to V_m and rises again.

use super::Law;
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

impl Spinodal {
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
        "spinodal"
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

    // tau = asinh{v [c + (1+R) psi]^beta / gamma0}  (35)
    fn stress<T: Real>(&self, v: T, psi: T) -> T {
        (v * self.strength(psi).powf(self.beta) / self.gamma0).asinh()
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

    // With X = 1 + R V the extrema of (36) solve c X^2 - (1+R)(beta-1) X + beta (1+R) = 0. Written in V no digit is lost:
    // c R^2 V^2 - R [(1+R)(beta-1) - 2 c] V + (1 + R + c) = 0.
    fn steady_extrema(&self) -> Vec<f64> {
        let (r, c) = (self.r, self.c);
        let half = 0.5 * r * ((1.0 + r) * (self.beta - 1.0) - 2.0 * c);
        let constant = 1.0 + r + c;
        let discriminant = half * half - c * r * r * constant;
        // Without a positive discriminant the stress rises throughout; a double root is an inflection, no extremum.
        if !(half > 0.0 && discriminant > 0.0) {
            return Vec::new();
        }
        let sum = half + discriminant.sqrt();
        let (v_peak, v_trough) = (constant / sum, sum / (c * r * r));
        if c > 0.0 && v_trough.is_finite() {
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
