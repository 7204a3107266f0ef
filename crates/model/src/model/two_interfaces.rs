//! Two interfaces under one stress, equation (19).

use super::logarithmic::Logarithmic;
use super::response::{Response, bilinear, curvature_variables, slope_variables};
use super::slab::Slab;
use super::{Driven, Loading};
use crate::field::{Analytic, Jacobian, Parametrised, State, VectorField};
use crate::friction::{AnyLaw, Law};
use crate::series::Equations;

/// dtau/dt = K (V_H - v_1 - v_2), dw_i/dt = g(v_i, w_i)  (19), in the state (tau, w_1, w_2), w = ln psi.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct TwoInterfaces<L> {
    /// The law of both interfaces.
    pub law: L,
    /// V_H and K.
    pub loading: Loading,
}

impl<L: Law + Into<AnyLaw>> VectorField<3> for TwoInterfaces<L> {
    fn f(&self, y: &State<3>) -> State<3> {
        let Loading { driving, stiffness } = self.loading;
        let equations = Logarithmic {
            law: self.law,
            alike: 1.0,
        };
        State::from(equations.rates(y.data.0[0], [driving, stiffness]))
    }

    fn jacobian(&self, y: &State<3>) -> Jacobian<3> {
        let k = self.loading.stiffness;
        let [first, second] = self.slopes(y);
        #[rustfmt::skip]
        let j = Jacobian::<3>::new(
            -k * (first.v.gradient[0] + second.v.gradient[0]), -k * first.v.gradient[1], -k * second.v.gradient[1],
            first.g.gradient[0],                                first.g.gradient[1],      0.0,
            second.g.gradient[0],                               0.0,                      second.g.gradient[1],
        );
        j
    }

    fn second_derivative(&self, y: &State<3>, a: &State<3>, b: &State<3>) -> State<3> {
        let of = |w: f64| {
            let [tau, w] = curvature_variables(y[0], w);
            Response::new(&self.law, self.law.activation(tau), w)
        };
        let (first, second) = (of(y[1]), of(y[2]));
        let (a1, b1) = ([a[0], a[1]], [b[0], b[1]]);
        let (a2, b2) = ([a[0], a[2]], [b[0], b[2]]);
        State::<3>::new(
            -self.loading.stiffness * (bilinear(&first.v, a1, b1) + bilinear(&second.v, a2, b2)),
            bilinear(&first.g, a1, b1),
            bilinear(&second.g, a2, b2),
        )
    }

    fn lasting(&self) -> Option<&'static str> {
        self.law.lasts().then(|| self.law.name())
    }

    fn has_spikes(&self) -> bool {
        false
    }

    fn parametrised(&self) -> Option<&dyn Parametrised<3>> {
        Some(self)
    }

    fn analytic(&self) -> Option<&dyn Analytic<3>> {
        Some(self)
    }
}

impl<L: Law> TwoInterfaces<L> {
    #[inline]
    fn slopes(&self, y: &State<3>) -> [Response<super::response::Slope>; 2] {
        let [tau, first] = slope_variables(y[0], y[1]);
        let [_, second] = slope_variables(y[0], y[2]);
        let s = self.law.activation(tau);
        [
            Response::new(&self.law, s, first),
            Response::new(&self.law, s, second),
        ]
    }
}

impl<L: Law + Into<AnyLaw>> Slab<3> for TwoInterfaces<L> {
    fn law(&self) -> AnyLaw {
        self.law.into()
    }

    fn loading(&self) -> Loading {
        self.loading
    }
}

impl<L: Law + Into<AnyLaw>> Driven<3> for TwoInterfaces<L> {
    fn slip_rates(&self, y: &State<3>) -> [f64; 2] {
        let s = self.law.activation(y[0]);
        [1, 2].map(|i| self.law.slip_rate(s, y[i].exp()))
    }
}
