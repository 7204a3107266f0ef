//! One interface, equation (11).

use super::logarithmic::Logarithmic;
use super::response::{Response, bilinear, curvature_variables, slope_variables};
use super::slab::Slab;
use super::{Driven, Loading};
use crate::field::{Analytic, Jacobian, Parametrised, State, VectorField};
use crate::friction::{AnyLaw, Law};
use crate::series::Equations;

/// dtau/dt = K (V_H - v), dw/dt = g(v, w)  (11), in the state (tau, w), w = ln psi.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct SingleInterface<L> {
    /// The law of the interface.
    pub law: L,
    /// V_H and K.
    pub loading: Loading,
}

impl<L: Law> SingleInterface<L> {
    #[inline]
    fn slopes(&self, y: &State<2>) -> Response<super::response::Slope> {
        let [tau, w] = slope_variables(y[0], y[1]);
        Response::new(&self.law, self.law.activation(tau), w)
    }
}

impl<L: Law + Into<AnyLaw>> VectorField<2> for SingleInterface<L> {
    fn f(&self, y: &State<2>) -> State<2> {
        let Loading { driving, stiffness } = self.loading;
        let equations = Logarithmic {
            law: self.law,
            alike: 1.0,
        };
        State::from(equations.rates(y.data.0[0], [driving, stiffness]))
    }

    fn jacobian(&self, y: &State<2>) -> Jacobian<2> {
        let k = self.loading.stiffness;
        let one = self.slopes(y);
        #[rustfmt::skip]
        let j = Jacobian::<2>::new(
            -k * one.v.gradient[0], -k * one.v.gradient[1],
            one.g.gradient[0],      one.g.gradient[1],
        );
        j
    }

    fn second_derivative(&self, y: &State<2>, a: &State<2>, b: &State<2>) -> State<2> {
        let [tau, w] = curvature_variables(y[0], y[1]);
        let one = Response::new(&self.law, self.law.activation(tau), w);
        let (a, b) = ([a[0], a[1]], [b[0], b[1]]);
        State::<2>::new(
            -self.loading.stiffness * bilinear(&one.v, a, b),
            bilinear(&one.g, a, b),
        )
    }

    fn lasting(&self) -> Option<&'static str> {
        self.law.lasts().then(|| self.law.name())
    }

    fn has_spikes(&self) -> bool {
        false
    }

    fn parametrised(&self) -> Option<&dyn Parametrised<2>> {
        Some(self)
    }

    fn analytic(&self) -> Option<&dyn Analytic<2>> {
        Some(self)
    }
}

impl<L: Law + Into<AnyLaw>> Slab<2> for SingleInterface<L> {
    fn law(&self) -> AnyLaw {
        self.law.into()
    }

    fn loading(&self) -> Loading {
        self.loading
    }

    /// K (V_H - v) = K/2 (2 V_H - 2 v)
    fn weights(&self) -> [f64; 2] {
        [2.0, 0.5]
    }
}

impl<L: Law + Into<AnyLaw>> Driven<2> for SingleInterface<L> {
    fn slip_rates(&self, y: &State<2>) -> [f64; 2] {
        [self.law.slip_rate(self.law.activation(y[0]), y[1].exp()); 2]
    }
}
