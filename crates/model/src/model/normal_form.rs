//! The approximating system (39)-(40) of the 1:2 resonance, and its bifurcation curves.
//!
//! Its flow over the time one is the second iterate of the return map near the resonance. A steady state at the origin is the
//! periodic orbit, the other two are the orbit of twice its period, and a cycle is an invariant torus: figure 15.
//!
//! Kuznetsov, Y. A. (2004). Elements of Applied Bifurcation Theory, section 9.5.3. Guckenheimer, J. and Holmes, P. (1983).
//! Nonlinear Oscillations, Dynamical Systems, and Bifurcations of Vector Fields, section 7.3, with their mu_1 and mu_2 being
//! -mu_2 and -mu_1 here.

use crate::number::Real;
use crate::series::Equations;

/// v' = w  (39), w' = -mu_1 w - mu_2 v - v^3 - v^2 w  (40), in the parameters (mu_1, mu_2).
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct StrongResonance;

impl Equations<2, 2> for StrongResonance {
    const PARAMETERS: [&'static str; 2] = ["mu_1", "mu_2"];

    #[inline(always)]
    fn rates<T: Real>(&self, [v, w]: [T; 2], [mu1, mu2]: [T; 2]) -> [T; 2] {
        let squared = v * v;
        [w, -((mu1 + squared) * w + (mu2 + squared) * v)]
    }
}

impl StrongResonance {
    /// v of the steady states (+-v, 0) beside the origin, sqrt(-mu_2); only for mu_2 < 0.
    pub fn steady(mu2: f64) -> Option<f64> {
        (mu2 < 0.0).then(|| (-mu2).sqrt())
    }

    /// The eigenvalues at the origin have the sum -mu_1 and the product mu_2.
    pub fn trace_and_determinant([mu1, mu2]: [f64; 2]) -> [f64; 2] {
        [-mu1, mu2]
    }

    /// TR: mu_1 at which the origin has a Hopf point, for mu_2 > 0 and with the frequency sqrt(mu_2): always 0. It is
    /// supercritical: a stable cycle v = A cos(sqrt(mu_2) t) with A = 2 sqrt(-mu_1) to leading order, on mu_1 < 0.
    pub fn torus(_mu2: f64) -> f64 {
        0.0
    }

    /// PD: mu_2 at which the origin has a pitchfork: always 0. Supercritical, with steady states on mu_2 < 0.
    pub fn period_doubling(_mu1: f64) -> f64 {
        0.0
    }

    /// TR2: mu_1 at which both states beside the origin have a Hopf point, for mu_2 < 0: mu_1 = mu_2, with the frequency
    /// sqrt(-2 mu_2). It is subcritical.
    pub fn second_torus(mu2: f64) -> f64 {
        mu2
    }

    /// (global): mu_1 at which the origin has a pair of homoclinic orbits, for mu_2 < 0: (4/5) mu_2, and an error of the order
    /// of mu_2^2, as reversing time changes the sign of sqrt(-mu_2) alone in the system scaled by it.
    pub fn homoclinic(mu2: f64) -> f64 {
        0.8 * mu2
    }

    /// (sn): mu_1 at which two cycles around all three steady states merge, for mu_2 < 0: 0.75225564 mu_2,
    /// and an error of the order of mu_2^2 again.
    ///
    /// The factor is the least value of the ratio of the integrals of u^2 p and of p over the closed curves
    /// p^2/2 - u^2/2 + u^4/4 = h > 0, at h = 0.08899.
    pub fn fold_of_cycles(mu2: f64) -> f64 {
        0.752_255_640_4 * mu2
    }
}
