//! The asymmetric steady states around an extremum V_e of tau_ss, along z = (V_1 - V_2)/2 instead of V_H: the branch leaves the
//! symmetric state at V_H = 2 V_e (23) as a function of z, whichever way it bends.

use crate::error::Result;
use crate::friction::{ExtremumKind, Law, steady_slope, steady_stress};
use crate::number::{Difference, Jet, Real, bracketed_root};

/// The pitchfork at an extremum of tau_ss.
#[derive(Debug, Clone, Copy, PartialEq)]
#[non_exhaustive]
pub struct Pitchfork {
    /// Maximum V_M or minimum V_m.
    pub kind: ExtremumKind,
    /// V_e, half of the V_H of the pitchfork.
    pub slip_rate: f64,
    /// tau_ss''(V_e).
    pub curvature: f64,
    /// tau_ss'''(V_e): the branch is supercritical, and stable in stiff slabs, where it is positive.
    pub third: f64,
    /// The next extremum, up to which tau_ss is monotonic.
    rival: Option<f64>,
}

impl Pitchfork {
    /// Those of a law, by slip rate ascending.
    pub fn all(law: &impl Law) -> Vec<Self> {
        let extrema = law.steady_extrema();
        let at = |(i, &v): (usize, &f64)| {
            let x = Jet::<_, 1>::variable(Jet::<f64, 1>::variable(v, 0), 0);
            let slope = steady_slope(law, x);
            Pitchfork {
                kind: ExtremumKind::of(law, i),
                slip_rate: v,
                curvature: slope.value.gradient[0],
                third: slope.gradient[0].gradient[0],
                rival: extrema.iter().copied().find(|&other| other != v),
            }
        };
        extrema.iter().enumerate().map(at).collect()
    }

    /// lambda = V_H/2 of the parabola (24): z^2 = -6 (tau_ss''/tau_ss''') (lambda - V_e).
    pub fn parabola(&self, z: f64) -> f64 {
        self.slip_rate - z * z * self.third / (6.0 * self.curvature)
    }

    /// lambda = V_H/2 at which the interfaces slide at lambda + z and lambda - z, z > 0: the zero of (21), bracketed.
    ///
    /// # Errors
    /// [`crate::Error::NotConverged`] for a z with which there is no such state near this extremum.
    pub fn branch(&self, law: &impl Law, z: f64) -> Result<f64> {
        let v = self.slip_rate;
        // At V_e - z both rates are on its left, at V_e + z on its right, where the stress falls or rises throughout; up to the
        // rival extremum, at which the rate next to it has the least or largest stress of all between.
        let (low, high) = ((v - z).max(z), v + z);
        let range = match (self.kind, self.rival) {
            (ExtremumKind::Maximum, Some(trough)) => (low, high.min(trough - z)),
            (ExtremumKind::Minimum, Some(peak)) => (low.max(peak + z), high),
            (_, None) => (low, high),
        };
        bracketed_root("an asymmetric steady state", range.0, range.1, |lambda| {
            let phi = quotient(law, Jet::<f64, 1>::variable(lambda, 0), z);
            (phi.value, phi.gradient[0])
        })
    }
}

/// phi(z; lambda) / (2 z)  (21)
fn quotient<T: Real>(law: &impl Law, lambda: T, z: f64) -> T {
    let rates = Difference::new(lambda + z, lambda - z, T::constant(2.0 * z));
    steady_stress(law, rates).gap / (2.0 * z)
}
