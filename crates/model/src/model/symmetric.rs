//! The symmetric subspace psi_1 = psi_2 of the two interfaces, as a system of its own.
//!
//! It is flow-invariant, but often unstable: a three-dimensional run drifts off it by rounding, this one can't. Two equal
//! interfaces behave as one that is driven half as fast by a spring twice as stiff, 2 K (V_H/2 - v) = K (V_H - 2 v), so the
//! formulas of [`SingleInterface`] serve.

use super::slab::Slab;
use super::{Driven, Loading, SingleInterface};
use crate::field::{Analytic, Jacobian, Parametrised, State, VectorField};
use crate::friction::{AnyLaw, Law};

/// dtau/dt = K (V_H - 2 v), dw/dt = g(v, w): (19) with w_1 = w_2, in the state (tau, w).
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Symmetric<L> {
    equivalent: SingleInterface<L>,
}

impl<L: Law> Symmetric<L> {
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

impl<L: Law + Into<AnyLaw>> VectorField<2> for Symmetric<L> {
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

impl<L: Law + Into<AnyLaw>> Slab<2> for Symmetric<L> {
    fn law(&self) -> AnyLaw {
        self.equivalent.law.into()
    }

    fn alike(&self) -> f64 {
        2.0
    }

    fn loading(&self) -> Loading {
        let Loading { driving, stiffness } = self.equivalent.loading;
        Loading {
            driving: 2.0 * driving,
            stiffness: 0.5 * stiffness,
        }
    }
}

impl<L: Law + Into<AnyLaw>> Driven<2> for Symmetric<L> {
    fn slip_rates(&self, y: &State<2>) -> [f64; 2] {
        self.equivalent.slip_rates(y)
    }
}
