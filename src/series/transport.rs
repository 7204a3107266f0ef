//! Flow maps to third order: solutions whose state is a polynomial in two variations of the start, and their maps onto planes.
//!
//! Composed, such maps give the return map of a periodic orbit with all its derivatives to the third, of which the normal
//! forms of its bifurcations are made.

use super::array::Array;
use super::cubic::Cubic;
use super::equations::{Equations, Fixed, copy};
use super::stepper::Stepper;
use super::variational::longest_of_columns;
use super::{Accuracy, Expansion, MAX_ORDER, Solution};
use crate::number::DoubleDouble;

/// A solution with its third-order dependence on two variations of its start. [`Solution::start`] gives the start without
/// them.
///
/// A step may err by `atol + rtol |x_i|` in x_i, and in every coefficient by `rtol` of the largest of that kind, each counted in
/// units of 1 + |x_i|.
pub trait Transport<const N: usize>: Solution<N> {
    /// The state reached.
    fn polynomials(&self) -> [Cubic; N];

    /// The state at a time after the beginning of the last step, and its time derivative. By the series of that step: the
    /// time must be within it, or beyond it by a part of it.
    fn after(&self, time: Cubic) -> [[Cubic; N]; 2];

    /// The passage of the plane normal . (x - point) = 0 near a time after the beginning of the last step: that time, and the
    /// state there. `None` if the solution does not pass it there, transversally and for all variations.
    fn onto_plane(
        &self,
        (normal, point): (&[f64; N], &[f64; N]),
        near: f64,
    ) -> Option<(Cubic, [Cubic; N])> {
        /// Newton steps: the number of digits doubles with each, and then the degree with each.
        const STEPS: usize = 8;
        /// Distance, in units of 1 + |x|, at which the solution is on the plane.
        const ON_PLANE: f64 = 1e-12;
        let mut time = Cubic::constant(near);
        for _ in 0..STEPS {
            let [state, rates] = self.after(time);
            let (mut distance, mut speed) = (Cubic::default(), Cubic::default());
            for i in 0..N {
                let apart = state[i] - Cubic::constant(point[i]);
                distance = distance + apart.scaled(normal[i]);
                speed = speed + rates[i].scaled(normal[i]);
            }
            time = time - distance / speed;
        }
        let [state, _] = self.after(time);
        let (mut distance, mut size) = (0.0, 0.0);
        for i in 0..N {
            distance += (state[i].value() - point[i]) * normal[i];
            size += (1.0 + point[i].abs()) * normal[i].abs();
        }
        let there = distance.abs() <= ON_PLANE * size;
        let finite = time.0.iter().all(|c| c.is_finite());
        (there && finite).then_some((time, state))
    }
}

const ROOM: usize = MAX_ORDER + 1;

/// The equations on polynomials.
pub struct Cubics<S, const N: usize> {
    stepper: Stepper<Cubic, Fixed<S, Cubic>, N, ROOM>,
    start: [Cubic; N],
    order: usize,
}

impl<S: Equations<N>, const N: usize> Cubics<S, N> {
    /// To be started; the variations of the start are those of `start`.
    pub fn new(equations: S, parameters: [f64; 2], start: [Cubic; N]) -> Self {
        let formula = Fixed {
            equations,
            parameters: parameters.map(Cubic::constant),
        };
        Cubics {
            stepper: Stepper::new(formula, Cubic::default()),
            start,
            order: 0,
        }
    }

    /// The largest of the k-th coefficients of the series for every monomial, in units of 1 + |x_i|.
    fn sizes(&self, k: usize) -> Array<f64, 10> {
        let mut largest = [0_f64; 10];
        for i in 0..N {
            let series = self.stepper.series(i);
            let unit = 1.0 + series[0].value().abs();
            for (largest, c) in largest.iter_mut().zip(series[k].0) {
                *largest = largest.max(c.abs() / unit);
            }
        }
        Array(largest)
    }
}

impl<S: Equations<N>, const N: usize> Solution<N> for Cubics<S, N> {
    fn start(&mut self, y: &[f64; N]) {
        let mut x = self.start;
        for (x, y) in x.iter_mut().zip(y) {
            x.0[0] = *y;
        }
        self.stepper.start(x);
    }

    fn advance(&mut self, accuracy: &Accuracy, limit: DoubleDouble) -> DoubleDouble {
        let limit = Cubic::constant(limit.hi());
        self.order = accuracy.order;
        self.stepper.expand(accuracy);
        let in_units = (limit / self.stepper.unit()).value().abs();
        let most = self.stepper.longest(accuracy).value().min(in_units);
        let longest = longest_of_columns(accuracy, most, |k| self.sizes(k));
        let h = Cubic::constant(most.min(longest));
        DoubleDouble::from(self.stepper.advance_by(accuracy, h, limit).value())
    }

    fn state(&self) -> [f64; N] {
        self.stepper.state().map(Cubic::value)
    }

    fn expansion(&self, order: usize, into: &mut Expansion<N>) {
        copy(&self.stepper, order, into);
    }
}

impl<S: Equations<N>, const N: usize> Transport<N> for Cubics<S, N> {
    fn polynomials(&self) -> [Cubic; N] {
        *self.stepper.state()
    }

    fn after(&self, time: Cubic) -> [[Cubic; N]; 2] {
        let one_over = 1.0 / self.stepper.unit().value();
        let h = time.scaled(one_over);
        let [mut state, mut rates] = [[Cubic::default(); N]; 2];
        for i in 0..N {
            for c in self.stepper.series(i)[..=self.order].iter().rev() {
                rates[i] = rates[i] * h + state[i];
                state[i] = state[i] * h + *c;
            }
            rates[i] = rates[i].scaled(one_over);
        }
        [state, rates]
    }
}
