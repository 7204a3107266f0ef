//! Any small system of differential equations, and its solution in series.

use super::element::Element;
use super::formula::{Formula, Rates, WATCHED};
use super::handle::{Series, value};
use super::stepper::Stepper;
use super::tape::Order;
use super::{Accuracy, Expansion, Solution};
use crate::number::{DoubleDouble, Real};
use pulp::NullaryFnOnce;
use std::fmt::Debug;

/// dx/dt = f(x; p) in N = 2 or 3 variables with two control parameters: the right-hand side, written once for every number.
///
/// Jets make derivatives of it, and series its solutions. It must be smooth along the solutions: of |x| they take the sign at
/// the beginning of a step. There is room for 64 series: one for each variable and product, two for a quotient, three for an
/// exponential, four for a power. A formula that needs more panics.
pub trait Equations<const N: usize>: Copy + Debug + Send + Sync {
    /// f(x; p). To be marked `#[inline(always)]`: what is not is compiled for any processor, and takes ten times as long.
    fn rates<T: Real>(&self, x: [T; N], parameters: [T; 2]) -> [T; N];

    /// The name of a law by which every solution, forwards in time, is known to exist for all time.
    fn lasting(&self) -> Option<&'static str> {
        None
    }
}

/// The equations as a formula, with parameters in E.
#[derive(Debug, Clone, Copy)]
pub(super) struct Fixed<S, E> {
    pub equations: S,
    pub parameters: [E; 2],
}

impl<E: Element, S> Fixed<S, E> {
    /// atol + rtol |x_i|
    #[inline(always)]
    pub fn units<const N: usize>(x: &[E; N], (rtol, atol): (f64, f64)) -> [E; N] {
        let mut units = *x;
        let mut i = 0;
        while i < N {
            units[i] = x[i].plain().abs().mul_add(x[i].like(rtol), x[i].like(atol));
            i += 1;
        }
        units
    }

    /// 1, and no number where one of x is not finite.
    #[inline(always)]
    pub fn finite<const N: usize>(x: &[E; N]) -> E {
        let mut one = x[0].like(1.0);
        let mut i = 0;
        while i < N {
            one = x[i].mul_add(x[i].like(0.0), one);
            i += 1;
        }
        one
    }
}

impl<E: Element, S: Equations<N>, const N: usize> Formula<E, N> for Fixed<S, E> {
    #[inline(always)]
    fn rates<'t, O: Order>(&self, x: [Series<'t, E, O>; N]) -> Rates<'t, E, O, N> {
        let parameters = [value(self.parameters[0]), value(self.parameters[1])];
        Rates {
            variables: self.equations.rates(x, parameters),
            watched: [Series::constant(0.0); WATCHED],
        }
    }

    #[inline(always)]
    fn units(&self, x: &[E; N], tolerances: (f64, f64)) -> [E; N] {
        Self::units(x, tolerances)
    }

    #[inline(always)]
    fn allows(&self, x: &[E; N]) -> E {
        Self::finite(x)
    }
}

/// A solution of the equations on its way, in numbers E: `f64`, or [`DoubleDouble`] with room for
/// [`super::REFERENCE_ORDER`] and one coefficients. A step may err by `atol + rtol |x_i|` in x_i, in each of them.
pub struct Plain<S, E, const N: usize, const ROOM: usize> {
    stepper: Stepper<E, Fixed<S, E>, N, ROOM>,
}

impl<S: Equations<N>, E: Element, const N: usize, const ROOM: usize> Plain<S, E, N, ROOM> {
    /// To be started; `any` is any number.
    pub fn new(equations: S, parameters: [f64; 2], any: E) -> Self {
        let formula = Fixed {
            equations,
            parameters: parameters.map(|p| any.like(p)),
        };
        Plain {
            stepper: Stepper::new(formula, any),
        }
    }
}

/// A step, to be compiled for the processor.
struct Step<'a, S, E, const N: usize, const ROOM: usize> {
    stepper: &'a mut Stepper<E, Fixed<S, E>, N, ROOM>,
    accuracy: &'a Accuracy,
    limit: E,
}

impl<S: Equations<N>, E: Element, const N: usize, const ROOM: usize> NullaryFnOnce
    for Step<'_, S, E, N, ROOM>
{
    type Output = E;
    #[inline(always)]
    fn call(self) -> E {
        self.stepper.advance(self.accuracy, self.limit)
    }
}

impl<S: Equations<N>, E: Element, const N: usize, const ROOM: usize> Solution<N>
    for Plain<S, E, N, ROOM>
{
    fn start(&mut self, y: &[f64; N]) {
        let any = self.stepper.state()[0];
        self.stepper.start(y.map(|y| any.like(y)));
    }

    fn advance(&mut self, accuracy: &Accuracy, limit: DoubleDouble) -> DoubleDouble {
        let limit = self.stepper.state()[0].like_exact(limit);
        let step = Step {
            stepper: &mut self.stepper,
            accuracy,
            limit,
        };
        limit.run(step).to_exact()
    }

    fn state(&self) -> [f64; N] {
        self.stepper.state().map(Element::first)
    }

    fn expansion(&self, order: usize, into: &mut Expansion<N>) {
        copy(&self.stepper, order, into);
    }
}

/// The series of the last step.
pub(super) fn copy<E: Element, F: Formula<E, N>, const N: usize, const ROOM: usize>(
    stepper: &Stepper<E, F, N, ROOM>,
    order: usize,
    into: &mut Expansion<N>,
) {
    into.order = order;
    into.unit = stepper.unit().first();
    into.chart = |x| x;
    for (i, variable) in into.variables.iter_mut().enumerate() {
        for (to, x) in variable[..=order].iter_mut().zip(stepper.series(i)) {
            *to = x.first();
        }
    }
}
