//! Any small system of differential equations, and its solution in series.

use super::formula::{Formula, Rates, WATCHED};
use super::handle::{Series, value};
use super::stepper::Stepper;
use super::tape::Order;
use super::{Accuracy, Expansion, Solution, Tangent};
use crate::number::{DoubleDouble, Real};
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

/// The equations as a formula.
#[derive(Debug, Clone, Copy)]
struct Fixed<S, const P: usize> {
    equations: S,
    parameters: [f64; P],
}

impl<S: Equations<N, P>, const N: usize, const P: usize> Formula<f64, N> for Fixed<S, P> {
    #[inline(always)]
    fn rates<'t, O: Order>(&self, x: [Series<'t, f64, O>; N]) -> Rates<'t, f64, O, N> {
        Rates {
            variables: self.equations.rates(x, self.parameters.map(value)),
            watched: [Series::constant(0.0); WATCHED],
        }
    }

    /// atol + rtol |x_i|
    #[inline(always)]
    fn units(&self, x: &[f64; N], (rtol, atol): (f64, f64)) -> [f64; N] {
        x.map(|x| x.abs() * rtol + atol)
    }

    /// 1, and no number where one of x is not finite.
    #[inline(always)]
    fn allows(&self, x: &[f64; N]) -> f64 {
        x.iter().fold(1.0, |one, x| x * 0.0 + one)
    }
}

/// A solution of the equations on its way. A step may err by `atol + rtol |x_i|` in x_i, in each of them.
pub struct Plain<S, const N: usize, const P: usize> {
    stepper: Stepper<f64, Fixed<S, P>, N>,
}

impl<S: Equations<N, P>, const N: usize, const P: usize> Plain<S, N, P> {
    /// To be started.
    pub fn new(equations: S, parameters: [f64; P]) -> Self {
        let formula = Fixed {
            equations,
            parameters,
        };
        Plain {
            stepper: Stepper::new(formula, 0.0),
        }
    }
}

impl<S: Equations<N, P>, const N: usize, const P: usize> Solution<N> for Plain<S, N, P> {
    fn start(&mut self, y: &[f64; N]) {
        self.stepper.start(*y);
    }

    fn advance(&mut self, accuracy: &Accuracy, limit: DoubleDouble) -> DoubleDouble {
        DoubleDouble::from(self.stepper.advance(accuracy, limit.hi()))
    }

    fn state(&self) -> [f64; N] {
        *self.stepper.state()
    }

    fn expansion(&self, order: usize, into: &mut Expansion<N>) {
        into.order = order;
        into.unit = self.stepper.unit();
        into.chart = |x| x;
        for (i, variable) in into.variables.iter_mut().enumerate() {
            variable[..=order].copy_from_slice(&self.stepper.series(i)[..=order]);
        }
    }
}
