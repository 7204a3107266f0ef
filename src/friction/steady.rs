//! Steady sliding: the stress tau_ss(V), its extrema, and the critical stiffness k_c(V) of one interface.

use super::Law;
use crate::error::Result;
use crate::number::{Interval, Jet, Real, Uncertain, bracketed_root, enclosing_radius};

/// tau_ss(V) = F(V, psi_ss(V))  (2), for V > 0.
pub fn steady_stress<T: Real>(law: &impl Law, v: T) -> T {
    law.stress(v, law.steady_state(v))
}

/// d tau_ss / dV.
pub fn steady_slope<T: Real>(law: &impl Law, v: T) -> T {
    steady_stress(law, Jet::<T, 1>::variable(v, 0)).gradient[0]
}

/// tau_ss at a rate known within `radius`, with its error budget: rounding at the point, and the largest slope nearby.
pub fn steady_stress_within(law: &impl Law, v: f64, radius: f64) -> Uncertain {
    let stress = steady_stress(law, v);
    let rounding = steady_stress(law, Interval::constant(v)).distance_from(stress);
    let spread = if radius == 0.0 {
        0.0
    } else {
        let slope = steady_slope(law, Interval::around(v, radius)).abs();
        (slope * Interval::constant(radius)).hi()
    };
    Uncertain::new(stress, rounding + spread)
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
    pub slip_rate: Uncertain,
    /// tau_ss there.
    pub stress: Uncertain,
}

impl Extremum {
    /// All extrema of a law, by slip rate ascending, each enclosed by certain signs of the slope on either side.
    pub fn all(law: &impl Law) -> Vec<Extremum> {
        law.steady_extrema()
            .into_iter()
            .enumerate()
            .map(|(i, v)| {
                let radius = enclosing_radius(v, |x| steady_slope(law, x));
                Extremum {
                    kind: if i % 2 == 0 {
                        ExtremumKind::Maximum
                    } else {
                        ExtremumKind::Minimum
                    },
                    slip_rate: Uncertain::new(v, radius),
                    stress: steady_stress_within(law, v, radius),
                }
            })
            .collect()
    }
}

/// A maximum of k_c(V).
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct StiffnessMaximum {
    /// Where it is.
    pub slip_rate: Uncertain,
    /// The largest critical stiffness.
    pub stiffness: Uncertain,
}

/// The largest critical stiffness; `None` where k_c has no maximum.
///
/// Only a law that weakens between two extrema has one: k_c vanishes at both.
///
/// # Errors
/// [`crate::Error::NotConverged`] if the search fails, which the shape of the laws excludes.
pub fn critical_stiffness_maximum(law: &impl Law) -> Result<Option<StiffnessMaximum>> {
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
    let rate =
        |x: Interval| critical_stiffness(law, Jet::<Interval, 1>::variable(x, 0)).gradient[0];
    let radius = enclosing_radius(v, rate);
    let stiffness = critical_stiffness(law, v);
    let rounding = critical_stiffness(law, Interval::constant(v)).distance_from(stiffness);
    let spread = (rate(Interval::around(v, radius)).abs() * Interval::constant(radius)).hi();
    Ok(Some(StiffnessMaximum {
        slip_rate: Uncertain::new(v, radius),
        stiffness: Uncertain::new(stiffness, rounding + spread),
    }))
}
