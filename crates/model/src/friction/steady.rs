//! Steady sliding: the stress tau_ss(V), its extrema, and the critical stiffness k_c(V) of one interface.

use super::{Formulas, Law};
use crate::error::Result;
use crate::number::{Interval, Jet, Real, Uncertain, With, bracketed_root, enclosing_radius};

/// tau_ss(V) = F(V, psi_ss(V))  (2), for V > 0.
pub fn steady_stress<C, T: With<C>>(law: &impl Formulas<C>, v: T) -> T {
    law.stress(v, law.steady_state(v))
}

/// d tau_ss / dV = F_V d ln s(tau_ss)/d ln V, F_V with the damping where there is one: next to an extremum it has the digits of the latter, of whatever size F_V is.
pub fn steady_slope<T: Real>(law: &impl Law, v: T) -> T {
    let log_strength = law.log_strength(law.steady_state(v));
    steady_log_slope(law, v) / law.compliance(v, log_strength)
}

/// ln s(tau_ss(V)), the logarithm of the activation that steady sliding takes: it rises and falls as tau_ss does, and has a
/// double where tau_ss or the strength has none. With damping, where equal stresses are no equal activations, tau_ss itself.
pub fn steady_log_activation<T: Real>(law: &impl Law, v: T) -> T {
    if law.damping() != 0.0 {
        return steady_stress(law, v);
    }
    v.ln() + law.log_strength(law.steady_state(v))
}

/// d ln s(tau_ss) / d ln V: positive where an interface strengthens with its slip rate, negative where it weakens. With damping
/// d tau_ss/dV over F_V + eta, which is the same where there is none.
pub fn steady_log_slope<T: Real>(law: &impl Law, v: T) -> T {
    let along = Jet {
        value: v,
        gradient: [v],
    };
    let strength = law.log_strength(law.steady_state(along));
    let slope = strength.gradient[0] + 1.0;
    if law.damping() == 0.0 {
        return slope;
    }
    // (F_V l + eta) / (F_V + eta)
    let radiated = law.compliance(v, strength.value) * law.damping();
    slope + radiated * (-slope + 1.0)
}

/// tau_ss at a rate known within `radius`, with its error budget: rounding at the point, and the largest slope nearby.
pub fn steady_stress_within(law: &impl Law, v: f64, radius: f64) -> Uncertain {
    let stress = steady_stress(law, v);
    let rounding = steady_stress(law, Interval::constant(v)).distance_from(stress);
    let slope = |x| steady_slope(law, x);
    Uncertain::new(stress, rounding + spread(slope, v, radius))
}

/// How far a function of this slope goes within `radius` of v: infinite where that is not known.
fn spread(slope: impl Fn(Interval) -> Interval, v: f64, radius: f64) -> f64 {
    if radius == 0.0 || !radius.is_finite() {
        return radius;
    }
    (slope(Interval::around(v, radius)).abs() * radius).hi()
}

/// k_c(V) = -G_psi d tau_ss/dV  (16): one interface driven at V slides steadily where it is stiffer than this.
pub fn critical_stiffness<T: Real>(law: &impl Law, v: T) -> T {
    -(renewal_slope(law, v) * steady_log_slope(law, v))
}

/// Maximum (V_M) or minimum (V_m) of the steady stress.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum ExtremumKind {
    /// V_M: weakening sets in.
    Maximum,
    /// V_m: weakening ends.
    Minimum,
}

impl ExtremumKind {
    /// The kind of the extremum of a law at this place among [`Law::steady_extrema`]: maxima and minima take turns.
    pub fn of(law: &impl Law, place: usize) -> Self {
        if place % 2 == usize::from(law.weakens_from_rest()) {
            ExtremumKind::Maximum
        } else {
            ExtremumKind::Minimum
        }
    }
}

/// An extremum of tau_ss(V), with bounds that hold.
#[derive(Debug, Clone, Copy, PartialEq)]
#[non_exhaustive]
pub struct Extremum {
    /// Maximum or minimum.
    pub kind: ExtremumKind,
    /// V_M or V_m.
    pub slip_rate: Uncertain,
    /// tau_ss there.
    pub stress: Uncertain,
}

impl Extremum {
    /// Of a steady stress that is known otherwise than by a [`Law`].
    pub fn new(kind: ExtremumKind, slip_rate: Uncertain, stress: Uncertain) -> Self {
        Extremum {
            kind,
            slip_rate,
            stress,
        }
    }

    /// All extrema of a law, by slip rate ascending, each enclosed by certain signs of the slope on either side.
    pub fn all(law: &impl Law) -> Vec<Extremum> {
        law.steady_extrema()
            .into_iter()
            .enumerate()
            .map(|(i, v)| {
                let radius = enclosing_radius(v, |x| steady_log_slope(law, x));
                Extremum {
                    kind: ExtremumKind::of(law, i),
                    slip_rate: Uncertain::new(v, radius),
                    stress: steady_stress_within(law, v, radius),
                }
            })
            .collect()
    }
}

/// A maximum of k_c(V).
#[derive(Debug, Clone, Copy, PartialEq)]
#[non_exhaustive]
pub struct StiffnessMaximum {
    /// Where it is.
    pub slip_rate: Uncertain,
    /// The largest critical stiffness.
    pub stiffness: Uncertain,
}

impl StiffnessMaximum {
    /// Likewise.
    pub fn new(slip_rate: Uncertain, stiffness: Uncertain) -> Self {
        StiffnessMaximum {
            slip_rate,
            stiffness,
        }
    }
}

/// The largest critical stiffness; `None` where k_c has no maximum.
///
/// Only a law that weakens between two extrema has one: k_c vanishes at both.
///
/// # Errors
/// [`crate::error::Error::NotConverged`] if the search fails, which the shape of the laws excludes.
pub fn critical_stiffness_maximum(law: &impl Law) -> Result<Option<StiffnessMaximum>> {
    let extrema = law.steady_extrema();
    let [v_peak, v_trough] = extrema[..] else {
        return Ok(None);
    };
    // along x = ln V
    let slope = |x: f64| {
        let rate = stiffness_growth(law, Jet::<f64, 1>::variable(x, 0).exp());
        (rate.value, rate.gradient[0])
    };
    let v = bracketed_root("the maximum of k_c", v_peak.ln(), v_trough.ln(), slope)?.exp();
    let radius = enclosing_radius(v, |x| stiffness_growth(law, x));
    let rate = |x: Interval| stiffness_growth(law, x) * renewal_slope(law, x) / x;
    let stiffness = critical_stiffness(law, v);
    let rounding = critical_stiffness(law, Interval::constant(v)).distance_from(stiffness);
    Ok(Some(StiffnessMaximum {
        slip_rate: Uncertain::new(v, radius),
        stiffness: Uncertain::new(stiffness, rounding + spread(rate, v, radius)),
    }))
}

/// G_psi F_V.
fn renewal_slope<T: Real>(law: &impl Law, v: T) -> T {
    let psi = law.steady_state(v);
    let held = Jet {
        value: v,
        gradient: [T::constant(0.0)],
    };
    let renewal = -law.evolution(held, Jet::variable(psi, 0)).gradient[0];
    renewal / law.compliance(v, law.log_strength(psi))
}

/// d k_c / d ln V over G_psi F_V > 0. As k_c = -G_psi F_V l, l = d ln s / d ln V of [`steady_log_slope`], that is
/// -(l' + l (ln G_psi F_V)'). Of 1/F_V, the root of v^2 + (gamma0/h)^2, the logarithm has the derivative 1 - l (1 - (v F_V)^2):
/// nothing overflows.
fn stiffness_growth<T: Real>(law: &impl Law, v: T) -> T {
    let along = Jet {
        value: v,
        gradient: [v],
    };
    if law.damping() != 0.0 {
        return critical_stiffness(law, along).gradient[0] / renewal_slope(law, v);
    }
    let psi = law.steady_state(along);
    let [rate, state] = Jet::<_, 2>::variables([along, psi]);
    let renewal = -law.evolution(rate, state).gradient[1];
    let compliance = law.compliance(v, law.log_strength(psi.value));
    let slope = steady_log_slope(law, along);
    let part = v / compliance;
    let of_compliance = -(slope.value * (-(part * part) + 1.0)) + 1.0;
    let of_renewal = renewal.gradient[0] / renewal.value;
    -(slope.gradient[0] + slope.value * (of_renewal - of_compliance))
}
