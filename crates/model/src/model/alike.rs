//! Interfaces that move alike, or one alone, in any of their parameters.

use super::unequal::{InTargets, MOST, field_in_any_parameter, formula};
use super::{Driven, Smooth, UnequalInterfaces, stress_rate};
use crate::field::{Analytic, Jacobian, Parametrised, State, VectorField};
use crate::friction::Formulas;
use crate::number::Real;
use crate::series::{ByRecording, Equations, Jet3, Solution, Tangent, TaylorMap};

/// dtau/dt = K (V_H - n v), dw/dt = g(v, w), in the state (tau, w), w = ln psi: (11) with n = 1, the symmetric subspace of (19) with
/// n = 2.
///
/// Its parameters are all constants by their names, without an index. [`SingleInterface`](super::SingleInterface) and
/// [`Symmetric`](super::Symmetric) are faster, and have fewer parameters.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct AlikeInterfaces {
    /// The law and the loading; both laws are the same.
    pub interfaces: UnequalInterfaces,
    /// n.
    pub count: usize,
}

impl AlikeInterfaces {
    fn all_names(&self) -> &'static [&'static str] {
        self.interfaces.named(false)
    }

    fn of<const P: usize>(
        &self,
        whole: Smooth<InTargets<P>, 3, P>,
    ) -> Smooth<AlikeInTargets<P>, 2, P> {
        Smooth {
            equations: AlikeInTargets {
                whole: whole.equations,
                count: self.count,
            },
            parameters: whole.parameters,
        }
    }

    fn in_loading(&self) -> Smooth<AlikeInTargets<2>, 2, 2> {
        self.of(self.interfaces.in_loading())
    }

    fn in_places<const P: usize>(&self, places: &[usize]) -> Smooth<AlikeInTargets<P>, 2, P> {
        self.of(self.interfaces.in_names(self.all_names(), places))
    }
}

/// The equations of interfaces that move alike in P of all parameters.
#[derive(Debug, Clone, Copy)]
pub struct AlikeInTargets<const P: usize> {
    whole: InTargets<P>,
    count: usize,
}

impl<const P: usize> Equations<2, P> for AlikeInTargets<P> {
    const PARAMETERS: [&'static str; P] = ["parameter"; P];

    fn rates<T: Real>(&self, [tau, w]: [T; 2], parameters: [T; P]) -> [T; 2] {
        let one = self.whole.response(tau, w, &parameters);
        let loading = self.whole.loading(&parameters);
        [stress_rate(loading, one.v * self.count as f64), one.g]
    }

    fn slip_rates<T: Real>(&self, [tau, w]: [T; 2], parameters: [T; P]) -> [Option<T>; 2] {
        [Some(self.whole.response(tau, w, &parameters).v), None]
    }

    fn lasting(&self) -> Option<&'static str> {
        Equations::<3, P>::lasting(&self.whole)
    }
}

field_in_any_parameter! { AlikeInterfaces, 2 }

impl Driven<2> for AlikeInterfaces {
    fn slip_rates(&self, y: &State<2>) -> [f64; 2] {
        let [law, _] = self.interfaces.laws.laws();
        [law.slip_rate(law.activation(y[0]), y[1].exp()); 2]
    }
}
