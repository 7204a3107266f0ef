//! One interface's part of the linearised system, in the paper's letters: what (14), (26) and (30) are made of.

use crate::friction::{AnyLaw, Law, Rounded, ScaledLaw, UnequalLaws, steady_log_slope};
use crate::number::{Jet, Real};

/// The law of each interface of a system: one for all, or one for each of two.
pub trait LawOfEach: Rounded {
    /// Of what kind these are.
    type Law: Law + Rounded;

    /// That of the interface at this place, 0 or 1.
    fn law(&self, interface: usize) -> &Self::Law;
}

impl LawOfEach for AnyLaw {
    type Law = AnyLaw;

    fn law(&self, _: usize) -> &AnyLaw {
        self
    }
}

impl LawOfEach for UnequalLaws {
    type Law = ScaledLaw;

    fn law(&self, interface: usize) -> &ScaledLaw {
        &self.laws()[interface]
    }
}

/// An interface that slides steadily.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Interface<T> {
    /// 1 / F_V
    pub compliance: T,
    /// G_psi
    pub g_psi: T,
    /// s_i = k_c / F_V
    pub s: T,
    /// a_i s_i = F_psi G_V / F_V^2  (31)
    pub a_s: T,
}

impl<T: Real> Interface<T> {
    /// At the slip rate v. In logarithms of the strength h, F_psi = F_V v (ln h)' and s = -G_psi d ln s(tau_ss)/d ln V: nothing
    /// overflows.
    pub fn at(law: &impl Law, v: T) -> Self {
        let along = Jet {
            value: v,
            gradient: [v],
        };
        let steady = law.steady_state(along);
        let psi = steady.value;
        let strength = law.log_strength(Jet::<T, 1>::variable(psi, 0));
        let steepness = strength.gradient[0];
        let compliance = law.compliance(v, strength.value);
        let [rate, state] = Jet::<T, 2>::variables([v, psi]);
        let [minus_g_v, minus_g_psi] = law.evolution(rate, state).gradient;
        let a_s = -(v * steepness * minus_g_v * compliance);
        // F_psi is that of the friction alone, and F_V/(F_V + eta) is one less eta times the compliance
        let (slope, friction_alone) = if law.damping() == 0.0 {
            (steepness * steady.gradient[0] + 1.0, a_s)
        } else {
            let radiated = compliance * law.damping();
            (steady_log_slope(law, v), a_s * (-radiated + 1.0))
        };
        Interface {
            compliance,
            g_psi: -minus_g_psi,
            s: minus_g_psi * slope,
            a_s: friction_alone,
        }
    }
}

/// [c_2, c_1, c_0] of the characteristic polynomial (30), written s^3 + c_2 s^2 + c_1 s + c_0.
pub(crate) fn routh_hurwitz<T: Real>(one: &Interface<T>, two: &Interface<T>, k: T) -> [T; 3] {
    weighted(one, two, T::constant(1.0), k)
}

/// The coefficients of s^2, s and 1 in m times (30) at the stiffness k/m, whose leading one is m: at a large K, with m = 1/K and
/// k = 1, none overflows.
pub(crate) fn weighted<T: Real>(one: &Interface<T>, two: &Interface<T>, m: T, k: T) -> [T; 3] {
    let s_3 = (one.compliance + two.compliance) * k;
    let (sum, product) = (one.s + two.s, one.s * two.s);
    [
        s_3 - sum * m,
        product * m - s_3 * sum + (one.a_s + two.a_s) * k,
        s_3 * product - (one.a_s * two.s + two.a_s * one.s) * k,
    ]
}
