//! What a dynamical system is: dy/dt = f(y), with the derivatives that implicit methods, tangents and normal forms need.
//!
//! The trait is object-safe on purpose: static and dynamic dispatch take the same time on these systems, and an integrator
//! then is compiled once per dimension and not once per law.

use crate::series::{Jet3, Solution, Tangent, TaylorMap};
use nalgebra::{SMatrix, SVector};

/// A point of the phase space.
pub type State<const N: usize> = SVector<f64, N>;

/// The matrix of first derivatives, `J[i][j] = d f_i / d y_j`; also a tangent flow, d y_i(t) / d y_j(0).
pub type Jacobian<const N: usize> = SMatrix<f64, N, N>;

/// An autonomous system of N ordinary differential equations.
///
/// ```
/// use twinslip::field::{Jacobian, State, VectorField};
/// struct Decay;
/// impl VectorField<1> for Decay {
///     fn f(&self, y: &State<1>) -> State<1> { -y }
///     fn jacobian(&self, _: &State<1>) -> Jacobian<1> { Jacobian::<1>::new(-1.0) }
///     fn second_derivative(&self, _: &State<1>, _: &State<1>, _: &State<1>) -> State<1> { State::zeros() }
/// }
/// assert_eq!(Decay.f(&State::<1>::new(2.0))[0], -2.0);
/// ```
pub trait VectorField<const N: usize>: Send + Sync {
    /// f(y). May be non-finite where y is far outside the domain: integrators then reject the trial step.
    fn f(&self, y: &State<N>) -> State<N>;

    /// J(y) = Df(y).
    fn jacobian(&self, y: &State<N>) -> Jacobian<N>;

    /// D2f(y)[u, v], the second derivative applied to two directions; symmetric in u and v.
    fn second_derivative(&self, y: &State<N>, u: &State<N>, v: &State<N>) -> State<N>;

    /// The law by whose name every solution, forwards in time, is known to exist for all time; `None` where that is not known.
    /// What leaves the range of doubles is then no finite-time singularity.
    fn lasting(&self) -> Option<&'static str> {
        None
    }

    /// The field in power series, where it can be written so: what a Taylor integrator steps with.
    fn analytic(&self) -> Option<&dyn Analytic<N>> {
        None
    }
}

/// A field whose solutions are made as power series in time.
pub trait Analytic<const N: usize> {
    /// A solution, to be started.
    fn solution(&self) -> Box<dyn Solution<N> + '_>;

    /// A solution in 31 digits, to be started.
    fn reference(&self) -> Box<dyn Solution<N> + '_>;

    /// A solution with its derivatives in its start, and in the parameters if asked for, to be started.
    fn tangent(&self, parameters: bool) -> Box<dyn Tangent<N> + '_>;

    /// The same, with all derivatives, in 31 digits.
    fn reference_tangent(&self) -> Box<dyn Tangent<N> + '_>;

    /// A solution to third order in two variations, which are those of this start; `None` where the field has none.
    fn transport(&self, _start: [Jet3; N]) -> Option<Box<dyn TaylorMap<N> + '_>> {
        None
    }
}
