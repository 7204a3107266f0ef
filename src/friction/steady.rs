//! Steady sliding: the stress tau_ss(V), its extrema, and the critical stiffness k_c(V) of one interface.

use super::Law;
use crate::error::Result;
use crate::number::{Interval, Jet, Real, bracketed_root};

/// tau_ss(V) = F(V, psi_ss(V))  (2), for V > 0.
pub fn steady_stress<T: Real>(law: &impl Law, v: T) -> T {
    law.stress(v, law.steady_state(v))
}

/// d tau_ss / dV.
pub fn steady_slope<T: Real>(law: &impl Law, v: T) -> T {
    steady_stress(law, Jet::<T, 1>::variable(v, 0)).gradient[0]
}

/// k_c(V) = -G_psi d tau_ss/dV  (16): one interface driven at V slides steadily where it is stiffer than this.
pub fn critical_stiffness<T: Real>(law: &impl Law, v: T) -> T {
    let psi = Jet::<T, 1>::variable(law.steady_state(v), 0);
    let held = Jet {
        value: v,
        gradient: [T::constant(0.0)],
    };
    law.evolution(held, psi).gradient[0] * steady_slope(law, v)
}

/// Maximum (V_M) or minimum (V_m) of the steady stress.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum ExtremumKind {
    /// V_M: weakening sets in.
    Maximum,
    /// V_m: weakening ends.
    Minimum,
}

/// An extremum of tau_ss(V), with bounds that hold.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Extremum {
    /// Maximum or minimum.
    pub kind: ExtremumKind,
    /// V_M or V_m.
    pub slip_rate: f64,
    /// The true extremum of the law with these very parameters lies within this distance.
    pub slip_rate_uncertainty: f64,
    /// tau_ss there.
    pub stress: f64,
    /// The true stress lies within this distance.
    pub stress_uncertainty: f64,
}

impl Extremum {
    /// All extrema of a law, by slip rate ascending, each enclosed by certain signs of the slope on either side.
    pub fn all(law: &impl Law) -> Vec<Extremum> {
        law.steady_extrema()
            .into_iter()
            .enumerate()
            .map(|(i, v)| {
                let radius = enclosing_radius(v, |x| steady_slope(law, x));
                let stress = steady_stress(law, v);
                Extremum {
                    kind: if i % 2 == 0 {
                        ExtremumKind::Maximum
                    } else {
                        ExtremumKind::Minimum
                    },
                    slip_rate: v,
                    slip_rate_uncertainty: radius,
                    stress,
                    // The slope vanishes there: the interval at the point alone, plus second order in the radius.
                    stress_uncertainty: steady_stress(law, Interval::around(v, radius))
                        .distance_from(stress),
                }
            })
            .collect()
    }
}

/// The smallest radius (by powers of two) within which g certainly changes sign around v > 0; infinite if there is none.
pub(crate) fn enclosing_radius(v: f64, g: impl Fn(Interval) -> Interval) -> f64 {
    let mut radius = v * f64::EPSILON;
    while radius < 0.5 * v {
        let ends = [v - radius, v + radius].map(|x| g(Interval::constant(x)).sign());
        if let [Some(left), Some(right)] = ends
            && left != right
        {
            return radius;
        }
        radius *= 2.0;
    }
    f64::INFINITY
}

/// The largest critical stiffness and its slip rate, `((V, radius), (k_c, radius))`; `None` where k_c has no maximum.
///
/// Only a law that weakens between two extrema has one: k_c vanishes at both.
///
/// # Errors
/// [`crate::Error::NotConverged`] if the search fails, which the shape of the laws excludes.
pub fn critical_stiffness_maximum(law: &impl Law) -> Result<Option<((f64, f64), (f64, f64))>> {
    let extrema = law.steady_extrema();
    let [v_peak, v_trough] = extrema[..] else {
        return Ok(None);
    };
    // d k_c / d ln V, with its slope, along x = ln V
    let slope = |x: f64| {
        let v = Jet::<Jet<f64, 1>, 1>::variable(Jet::variable(x, 0), 0).exp();
        let rate = critical_stiffness(law, v).gradient[0];
        (rate.value, rate.gradient[0])
    };
    let v = bracketed_root("the maximum of k_c", v_peak.ln(), v_trough.ln(), slope)?.exp();
    let radius = enclosing_radius(v, |x| {
        critical_stiffness(law, Jet::<Interval, 1>::variable(x, 0)).gradient[0]
    });
    let stiffness = critical_stiffness(law, v);
    let bounds = critical_stiffness(law, Interval::around(v, radius));
    Ok(Some((
        (v, radius),
        (stiffness, bounds.distance_from(stiffness)),
    )))
}
