//! What all systems of interfaces have from their equations: derivatives in every parameter, and power series.

use super::logarithmic::{ALL, LOADING, Logarithmic};
use super::{Loading, Parameter, Smooth};
use crate::field::{Analytic, Jacobian, Parametrised, State};
use crate::friction::AnyLaw;
use crate::series::{ByRecording, Equations, Jet3, Recorded, Solution, Tangent, TaylorMap};

/// A system of interfaces under one stress.
pub trait Slab<const N: usize> {
    /// The law of all of them.
    fn law(&self) -> AnyLaw;

    /// How many interfaces move alike.
    fn alike(&self) -> f64 {
        1.0
    }

    /// (11) or (19), with any law: what is recorded, and that is done once in a run.
    fn equations(&self) -> Logarithmic<AnyLaw> {
        Logarithmic {
            law: self.law(),
            alike: self.alike(),
        }
    }

    /// V_H and K.
    fn loading(&self) -> Loading;

    /// V_H and K of the two equal interfaces that move as these do, per those of the system.
    fn weights(&self) -> [f64; 2] {
        [1.0; 2]
    }
}

/// The two equal interfaces that move as these do.
fn pair<const N: usize>(slab: &impl Slab<N>) -> Loading {
    let Loading { driving, stiffness } = slab.loading();
    let [of_driving, of_stiffness] = slab.weights();
    Loading {
        driving: of_driving * driving,
        stiffness: of_stiffness * stiffness,
    }
}

/// The formula in V_H and K alone, which serves where no constant of the law is free.
fn in_loading<S: Slab<N>, const N: usize>(slab: &S) -> Recorded<Logarithmic<AnyLaw>, N, LOADING> {
    recorded(slab.equations(), slab.loading().into())
}

/// Where the parameter that a system has at this place stands among all.
fn among_all<S: Slab<N>, const N: usize>(slab: &S, place: usize) -> usize {
    let names = Parameter::names(&slab.law());
    assert!(place < names.len(), "{names:?} have no place {place}");
    let of_all = Parameter::NAMES
        .iter()
        .position(|name| *name == names[place]);
    of_all.expect("a parameter of interfaces")
}

/// The same of several.
fn all_among<S: Slab<N>, const N: usize>(slab: &S, places: &[usize]) -> Vec<usize> {
    places.iter().map(|&place| among_all(slab, place)).collect()
}

/// The formula in all parameters.
fn in_all<S: Slab<N>, const N: usize>(slab: &S) -> Recorded<Logarithmic<AnyLaw>, N, ALL> {
    let equations = slab.equations();
    recorded(equations, equations.parameters(slab.loading()))
}

fn recorded<E, const N: usize, const P: usize>(
    equations: E,
    parameters: [f64; P],
) -> Recorded<E, N, P> {
    Recorded {
        equations,
        parameters,
        symmetric: N == 2,
    }
}

/// The formula as a field, for its derivatives in parameters.
fn field<E, const N: usize, const P: usize>(recorded: Recorded<E, N, P>) -> Smooth<E, N, P>
where
    E: Equations<N, P>,
{
    Smooth {
        equations: recorded.equations,
        parameters: recorded.parameters,
    }
}

fn is_loading(place: usize) -> bool {
    place < LOADING
}

impl<S: Slab<N>, const N: usize> Parametrised<N> for S {
    fn names(&self) -> &[&'static str] {
        Parameter::names(&self.law())
    }

    fn parameter_derivative(&self, y: &State<N>, place: usize) -> State<N> {
        if is_loading(place) {
            field(in_loading(self)).parameter_derivative(y, place)
        } else {
            field(in_all(self)).parameter_derivative(y, among_all(self, place))
        }
    }

    fn parameter_jacobian(&self, y: &State<N>, place: usize) -> Jacobian<N> {
        if is_loading(place) {
            field(in_loading(self)).parameter_jacobian(y, place)
        } else {
            field(in_all(self)).parameter_jacobian(y, among_all(self, place))
        }
    }
}

impl<S: Slab<N>, const N: usize> Analytic<N> for S {
    fn solution(&self) -> Box<dyn Solution<N> + '_> {
        #[cfg(target_arch = "x86_64")]
        if let Some(own) = super::series::solution(self.law().form(), &pair(self)) {
            return own;
        }
        super::in_states::solution(self.law().form(), &pair(self))
    }

    fn reference(&self) -> Box<dyn Solution<N> + '_> {
        in_loading(self).reference()
    }

    fn tangent(&self, free: &[usize]) -> Box<dyn Tangent<N> + '_> {
        if !free.iter().copied().all(is_loading) {
            return in_all(self).tangent(&all_among(self, free));
        }
        #[cfg(target_arch = "x86_64")]
        if let Some(own) =
            super::tangent::tangent(self.law().form(), pair(self), self.weights(), free)
        {
            return own;
        }
        in_loading(self).tangent(free)
    }

    fn reference_tangent(&self, free: &[usize]) -> Box<dyn Tangent<N> + '_> {
        if free.iter().copied().all(is_loading) {
            in_loading(self).reference_tangent(free)
        } else {
            in_all(self).reference_tangent(&all_among(self, free))
        }
    }

    fn transport(&self, start: [Jet3; N]) -> Option<Box<dyn TaylorMap<N> + '_>> {
        Some(in_loading(self).transport(start))
    }
}
