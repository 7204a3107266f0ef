//! Any small system of differential equations, and its solution in series.

use super::{Solution, Tangent};
use crate::number::Real;
use std::fmt::Debug;

/// dx/dt = f(x; p) in N variables with P named parameters: the right-hand side, written once for every number.
///
/// Jets make derivatives of it, and series its solutions. The series run in loops over the recorded operations, and every step is
/// checked where it ends: against the rates there, and for zeros of quantities whose sign the formula takes.
pub trait Equations<const N: usize, const P: usize>: Copy + Debug + Send + Sync {
    /// The names of the parameters, in the order in which `rates` takes them. Derivatives are had in any of them.
    const PARAMETERS: [&'static str; P];

    /// f(x; p). To be marked `#[inline(always)]`: what is not is compiled for any processor, and takes ten times as long.
    fn rates<T: Real>(&self, x: [T; N], parameters: [T; P]) -> [T; N];

    /// Slip rates along the solution, of one interface or two, for fields that have any.
    fn slip_rates<T: Real>(&self, _x: [T; N], _parameters: [T; P]) -> [Option<T>; 2] {
        [None; 2]
    }

    /// The solution, where the equations have a faster way to it than their formula, whose steps need no check at their ends.
    fn own_solution(&self, _parameters: [f64; P]) -> Option<Box<dyn Solution<N>>> {
        None
    }

    /// The solution with its derivatives in the parameters of these places, where the equations have a faster way to it than their
    /// formula.
    fn own_tangent(&self, _parameters: [f64; P], _free: &[usize]) -> Option<Box<dyn Tangent<N>>> {
        None
    }

    /// The name of a law by which every solution, forwards in time, is known to exist for all time.
    fn lasting(&self) -> Option<&'static str> {
        None
    }
}
