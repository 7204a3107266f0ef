//! The symmetric subspace psi_1 = psi_2 of the two interfaces, as a system of its own.
//!
//! It is flow-invariant, but often unstable: a three-dimensional run drifts off it by rounding, this one can't. Two equal
//! interfaces behave as one that is driven half as fast by a spring twice as stiff, 2 K (V_H/2 - v) = K (V_H - 2 v), so the
//! formulas of [`SingleInterface`] serve.

use super::logarithmic::Logarithmic;
use super::series::SeriesSolution;
use super::tangent::tangent;
use super::{Driven, Loading, Parameter, SingleInterface};
use crate::field::{Analytic, Jacobian, State, VectorField};
use crate::friction::Law;
use crate::series::{Recorded, Solution, Tangent};

/// dtau/dt = K (V_H - 2 v), dw/dt = g(v, w): (19) with w_1 = w_2, in the state (tau, w).
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Symmetric<L> {
    equivalent: SingleInterface<L>,
}

impl<L: Law> Symmetric<L> {
    fn recorded(&self) -> Recorded<Logarithmic<L>, 2> {
        let two = Logarithmic {
            law: self.equivalent.law,
            alike: 2.0,
        };
        two.recorded(&self.equivalent.as_pair())
    }

    /// Of two interfaces with this law and loading.
    pub fn new(law: L, loading: Loading) -> Self {
        let halved = Loading {
            driving: 0.5 * loading.driving,
            stiffness: 2.0 * loading.stiffness,
        };
        Symmetric {
            equivalent: SingleInterface {
                law,
                loading: halved,
            },
        }
    }

    /// d(equivalent parameter)/d(parameter).
    fn weight(p: Parameter) -> f64 {
        match p {
            Parameter::Driving => 0.5,
            Parameter::Stiffness => 2.0,
        }
    }
}

impl<L: Law> VectorField<2> for Symmetric<L> {
    fn f(&self, y: &State<2>) -> State<2> {
        self.equivalent.f(y)
    }

    fn jacobian(&self, y: &State<2>) -> Jacobian<2> {
        self.equivalent.jacobian(y)
    }

    fn second_derivative(&self, y: &State<2>, a: &State<2>, b: &State<2>) -> State<2> {
        self.equivalent.second_derivative(y, a, b)
    }

    fn lasting(&self) -> Option<&'static str> {
        self.equivalent.lasting()
    }

    fn analytic(&self) -> Option<&dyn Analytic<2>> {
        Some(self)
    }
}

impl<L: Law> Analytic<2> for Symmetric<L> {
    fn solution(&self) -> Box<dyn Solution<2> + '_> {
        Box::new(SeriesSolution::new(
            self.equivalent.law.core(),
            &self.equivalent.as_pair(),
        ))
    }

    fn reference(&self) -> Box<dyn Solution<2> + '_> {
        self.recorded().reference()
    }

    fn tangent(&self, parameters: bool) -> Box<dyn Tangent<2> + '_> {
        let compiled = tangent(
            self.equivalent.law.core(),
            self.equivalent.as_pair(),
            (1.0, 1.0),
            parameters,
        );
        compiled.unwrap_or_else(|| self.recorded().tangent(parameters))
    }

    fn reference_tangent(&self) -> Box<dyn Tangent<2> + '_> {
        self.recorded().reference_tangent()
    }
}

impl<L: Law> Driven<2> for Symmetric<L> {
    fn parameter_derivative(&self, y: &State<2>, p: Parameter) -> State<2> {
        self.equivalent.parameter_derivative(y, p) * Self::weight(p)
    }

    fn parameter_jacobian(&self, y: &State<2>, p: Parameter) -> Jacobian<2> {
        self.equivalent.parameter_jacobian(y, p) * Self::weight(p)
    }

    fn slip_rates(&self, y: &State<2>) -> [f64; 2] {
        self.equivalent.slip_rates(y)
    }
}
