//! One interface's part of the linearised system, in the paper's letters: what (14), (26) and (30) are made of.

use crate::friction::{Law, critical_stiffness};
use crate::number::{Jet, Real};

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
    /// At the slip rate v.
    pub fn at(law: &impl Law, v: T) -> Self {
        let [rate, psi] = Jet::<T, 2>::variables([v, law.steady_state(v)]);
        let [f_v, f_psi] = law.stress(rate, psi).gradient;
        let [minus_g_v, minus_g_psi] = law.evolution(rate, psi).gradient;
        Interface {
            compliance: T::constant(1.0) / f_v,
            g_psi: -minus_g_psi,
            s: critical_stiffness(law, v) / f_v,
            a_s: -(f_psi * minus_g_v / (f_v * f_v)),
        }
    }
}

/// [c_2, c_1, c_0] of the characteristic polynomial (30), written s^3 + c_2 s^2 + c_1 s + c_0.
pub(crate) fn routh_hurwitz<T: Real>(one: &Interface<T>, two: &Interface<T>, k: T) -> [T; 3] {
    let s_3 = (one.compliance + two.compliance) * k;
    let (sum, product) = (one.s + two.s, one.s * two.s);
    [
        s_3 - sum,
        product - s_3 * sum + (one.a_s + two.a_s) * k,
        s_3 * product - (one.a_s * two.s + two.a_s * one.s) * k,
    ]
}
