//! Equations (11) and (19) in ln psi, for every number: what references, third-order maps and recorded formulas are made of.

use super::{Loading, stress_rate};
use crate::friction::{AnyLaw, Law};
use crate::number::Real;
use crate::series::{Equations, Recorded};

/// One interface (11), two (19), or two that move alike, in (tau, w_1, ...), w = ln psi, and in the parameters (V_H, K).
#[derive(Debug, Clone, Copy)]
pub(super) struct Logarithmic<L> {
    pub law: L,
    /// How many interfaces move alike.
    pub alike: f64,
}

impl<L: Law> Logarithmic<L> {
    /// v and dw/dt.
    #[inline(always)]
    fn response<T: Real>(&self, activation: T, w: T) -> (T, T) {
        let psi = w.exp();
        let v = self.law.slip_rate(activation, psi);
        (v, self.law.evolution(v, psi) / psi)
    }
}

impl<L: Law> Equations<2> for Logarithmic<L> {
    #[inline(always)]
    fn rates<T: Real>(&self, [tau, w]: [T; 2], [driving, stiffness]: [T; 2]) -> [T; 2] {
        let (v, g) = self.response(self.law.activation(tau), w);
        [stress_rate((driving, stiffness), v * self.alike), g]
    }

    fn slip_rates<T: Real>(&self, [tau, w]: [T; 2], _: [T; 2]) -> [Option<T>; 2] {
        [Some(self.response(self.law.activation(tau), w).0), None]
    }
}

impl<L: Law> Equations<3> for Logarithmic<L> {
    #[inline(always)]
    fn rates<T: Real>(&self, [tau, w1, w2]: [T; 3], [driving, stiffness]: [T; 2]) -> [T; 3] {
        let activation = self.law.activation(tau);
        let (v1, g1) = self.response(activation, w1);
        let (v2, g2) = self.response(activation, w2);
        [stress_rate((driving, stiffness), v1 + v2), g1, g2]
    }

    fn slip_rates<T: Real>(&self, [tau, w1, w2]: [T; 3], _: [T; 2]) -> [Option<T>; 2] {
        let activation = self.law.activation(tau);
        [w1, w2].map(|w| Some(self.response(activation, w).0))
    }
}

/// The formula of these interfaces, recorded.
pub(super) fn recorded<const N: usize>(
    law: impl Law,
    &Loading { driving, stiffness }: &Loading,
    alike: f64,
) -> Recorded<Logarithmic<AnyLaw>, N>
where
    Logarithmic<AnyLaw>: Equations<N>,
{
    Recorded {
        equations: Logarithmic {
            law: law.any(),
            alike,
        },
        parameters: [driving, stiffness],
        symmetric: N == 2,
    }
}
