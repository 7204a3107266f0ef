//! Any small system of differential equations, and its solution in series.

use super::formula::{Formula, Rates, WATCHED};
use super::handle::{Series, value};
use super::stepper::Stepper;
use super::tape::{Counting, Order, ROOM, ROWS, Tape};
use super::{Accuracy, Expansion, Solution, Tangent};
use crate::number::{DoubleDouble, Real};
use std::cell::Cell;
use std::fmt::Debug;

/// dx/dt = f(x; p) in N variables with P named parameters: the right-hand side, written once for every number.
///
/// Jets make derivatives of it, and series its solutions. The series run in loops over the recorded operations, and every step is
/// checked where it ends: against the rates there, and for zeros of quantities whose sign the formula takes.
pub trait Equations<const N: usize, const P: usize>: Copy + Debug + Send + Sync {
    /// The names of the parameters, in the order in which `rates` takes them. Derivatives are had in any of them.
    const PARAMETERS: [&'static str; P];

    /// Whether their series are compiled for them, which takes half the time a step and minutes to compile. Only for polynomials of a
    /// few terms in up to three variables, without slip rates: the ends of these steps are not checked.
    const KERNELS: bool = false;

    /// f(x; p). To be marked `#[inline(always)]`: what is not is compiled for any processor, and takes ten times as long.
    fn rates<T: Real>(&self, x: [T; N], parameters: [T; P]) -> [T; N];

    /// Slip rates along the solution, of one interface or two, for fields that have any.
    fn slip_rates<T: Real>(&self, _x: [T; N], _parameters: [T; P]) -> [Option<T>; 2] {
        [None; 2]
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

/// So many equations have compiled kernels, if they are short; for more these are not even compiled.
pub(crate) const COMPILED: usize = 3;

/// Whether the formula is small enough for code that is compiled for it: a few variables, and rows that there is room for.
pub(crate) fn is_small<S: Equations<N, P>, const N: usize, const P: usize>(
    equations: &S,
    p: [f64; P],
) -> bool {
    if const { N > COMPILED } {
        return false;
    }
    let memory = [const { Cell::new(1.0) }; ROWS * ROOM];
    let tape = Tape::new(&memory, Counting, N);
    let x = std::array::from_fn(|i| tape.variable(i));
    equations.rates(x, p.map(value));
    // What the outputs may take, and in tangents for each rate its slope, their sum, and the rate without directions.
    tape.rows() + 4 * N <= ROWS
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
