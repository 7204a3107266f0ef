//! The symmetric subspace psi_1 = psi_2 of the two interfaces, as a system of its own.
//!
//! It is flow-invariant, but often unstable: a three-dimensional run drifts off it by rounding, this one can't. Two equal
//! interfaces behave as one that is driven half as fast by a spring twice as stiff, 2 K (V_H/2 - v) = K (V_H - 2 v), so the
//! formulas of [`SingleInterface`] serve.

use super::logarithmic::Logarithmic;
use super::series::SeriesSolution;
use super::tangent::tangent;
use super::{Driven, Loading, Parameter, SingleInterface, Smooth};
use crate::field::{Analytic, Jacobian, Parametrised, State, VectorField};
use crate::friction::Law;
use crate::series::{Recorded, Solution, Tangent};

/// dtau/dt = K (V_H - 2 v), dw/dt = g(v, w): (19) with w_1 = w_2, in the state (tau, w).
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Symmetric<L> {
    equivalent: SingleInterface<L>,
}

impl<L: Law> Symmetric<L> {
    /// (19) with w_1 = w_2, for every number.
    fn equations(&self) -> Logarithmic<L> {
        Logarithmic {
            law: self.equivalent.law,
            alike: 2.0,
        }
    }

    fn whole(&self) -> Smooth<Logarithmic<L>, 2, 2> {
        self.equations().at(self.equivalent.as_pair())
    }

    fn recorded(&self) -> Recorded<Logarithmic<L>, 2, 2> {
        self.equations().recorded(self.equivalent.as_pair())
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

    fn parametrised(&self) -> Option<&dyn Parametrised<2>> {
        Some(self)
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

    fn tangent(&self, free: &[usize]) -> Box<dyn Tangent<2> + '_> {
        let compiled = tangent(
            self.equivalent.law.core(),
            self.equivalent.as_pair(),
            [1.0, 1.0],
            free,
        );
        compiled.unwrap_or_else(|| self.recorded().tangent(free))
    }

    fn reference_tangent(&self, free: &[usize]) -> Box<dyn Tangent<2> + '_> {
        self.recorded().reference_tangent(free)
    }
}

impl<L: Law> Parametrised<2> for Symmetric<L> {
    fn names(&self) -> &[&'static str] {
        &Parameter::NAMES
    }

    fn parameter_derivative(&self, y: &State<2>, place: usize) -> State<2> {
        self.whole().parameter_derivative(y, place)
    }

    fn parameter_jacobian(&self, y: &State<2>, place: usize) -> Jacobian<2> {
        self.whole().parameter_jacobian(y, place)
    }
}

impl<L: Law> Driven<2> for Symmetric<L> {
    fn slip_rates(&self, y: &State<2>) -> [f64; 2] {
        self.equivalent.slip_rates(y)
    }
}
