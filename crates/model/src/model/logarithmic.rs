//! Equations (11) and (19) in ln psi, for every number: what references, third-order maps and recorded formulas are made of.

use super::response::Response;
use super::{Loading, Parameter, Smooth, stress_rate};
use crate::friction::Law;
use crate::number::Real;
use crate::series::{Equations, Recorded};

/// One interface (11), two (19), or two that move alike, in (tau, w_1, ...), w = ln psi.
#[derive(Debug, Clone, Copy)]
pub(super) struct Logarithmic<L> {
    pub law: L,
    /// How many interfaces move alike.
    pub alike: f64,
}

impl<L: Law> Logarithmic<L> {
    #[inline(always)]
    fn response<T: Real>(&self, activation: T, w: T) -> Response<T> {
        Response::new(&self.law, activation, w)
    }
}

impl<L: Law> Equations<2, 2> for Logarithmic<L> {
    const PARAMETERS: [&'static str; 2] = Parameter::NAMES;

    #[inline(always)]
    fn rates<T: Real>(&self, [tau, w]: [T; 2], [driving, stiffness]: [T; 2]) -> [T; 2] {
        let one = self.response(self.law.activation(tau), w);
        let slip_rate = one.v * self.alike;
        [stress_rate((driving, stiffness), slip_rate), one.g]
    }

    fn slip_rates<T: Real>(&self, [tau, w]: [T; 2], _: [T; 2]) -> [Option<T>; 2] {
        [Some(self.response(self.law.activation(tau), w).v), None]
    }
}

impl<L: Law> Equations<3, 2> for Logarithmic<L> {
    const PARAMETERS: [&'static str; 2] = Parameter::NAMES;

    #[inline(always)]
    fn rates<T: Real>(&self, [tau, w1, w2]: [T; 3], [driving, stiffness]: [T; 2]) -> [T; 3] {
        let activation = self.law.activation(tau);
        let first = self.response(activation, w1);
        let second = self.response(activation, w2);
        let slip_rate = first.v + second.v;
        [
            stress_rate((driving, stiffness), slip_rate),
            first.g,
            second.g,
        ]
    }

    fn slip_rates<T: Real>(&self, [tau, w1, w2]: [T; 3], _: [T; 2]) -> [Option<T>; 2] {
        let activation = self.law.activation(tau);
        [w1, w2].map(|w| Some(self.response(activation, w).v))
    }
}

impl<L: Law> Logarithmic<L> {
    /// The formula, to be recorded.
    pub fn recorded<const N: usize>(self, loading: Loading) -> Recorded<Self, N, 2>
    where
        Self: Equations<N, 2>,
    {
        Recorded {
            equations: self,
            parameters: loading.into(),
            symmetric: N == 2,
        }
    }

    /// The field.
    pub fn at<const N: usize>(self, loading: Loading) -> Smooth<Self, N, 2> {
        Smooth {
            equations: self,
            parameters: loading.into(),
        }
    }
}
