//! Two equal interfaces with their tangents in power series.
//!
//! The Jacobian's entries along the solution come with its series, for both interfaces at once, by the recurrences that laws have of
//! their own, or by the recorded formula with its derivatives. The linearised equations of all columns are then sums of products with them, see [`VariationalEquations`].

use super::Loading;
use super::ageing_series::{AgeingRecurrences, Best};
use super::in_states::{InStates, chart};
use super::series::{Interfaces, Slopes, copy};
use crate::friction::LawForm;
use crate::number::DoubleDouble;
use crate::series::{
    Accuracy, Along, Derivatives, Eight, Element, Expansion, Four, JacobianTerm, KeptFormula,
    ONE_OVER, Pair, ROOM, Recurrences, Solution, Stepper, Tangent, VariationalEquations, avx2,
    longest_of_terms, usual_order,
};
use pulp::NullaryFnOnce;
use std::cell::Cell;

/// A solution with the columns that are the derivatives in its start, and in V_H and K where those are asked for.
struct TangentSolution<R, X> {
    best: Best,
    /// V_H and K of the pair that moves as the system does, per those of the system.
    weights: [f64; 2],
    /// The places of the parameters in which derivatives are asked for.
    free: Vec<usize>,
    stepper: Stepper<Pair, Interfaces, 2>,
    recurrences: Box<R>,
    /// The derivatives in the start, then those in parameters, as many in each as X has lanes.
    columns: Vec<VariationalEquations<X>>,
    stiffness: f64,
    log_determinant: f64,
    /// The integral of dg/dpsi of the first interface.
    log_transverse: f64,
    /// Half the number of states that are variables of the system.
    states: f64,
    /// ln psi at the start.
    start: [f64; 2],
}

/// Coefficients that come with the Jacobian's along them.
pub(super) trait Linearised: Recurrences<Pair, Interfaces, 2> {
    /// The order with which they take the least time for a relative tolerance.
    fn order(rtol: f64) -> usize;
    /// That of those made last.
    fn jacobian(&self) -> &[JacobianTerm];
}

/// By the recorded formula with its derivatives.
struct BySlopes {
    formula: KeptFormula,
    jacobian: [JacobianTerm; ROOM],
}

impl Recurrences<Pair, Interfaces, 2> for BySlopes {
    fn make(&mut self, formula: &Interfaces, memory: &[Cell<Pair>], order: usize, unit: Pair) {
        self.formula.make(formula, memory, order, unit);
        let psi = [1, 2].map(|i| self.formula.variable(i)[0]);
        for (k, term) in self.jacobian[..order].iter_mut().enumerate() {
            let slopes = Slopes::of(&self.formula, k);
            *term = slopes.jacobian(psi, formula.stiffness.first(), unit.first());
        }
    }
}

impl Linearised for BySlopes {
    fn order(rtol: f64) -> usize {
        usual_order(rtol)
    }

    fn jacobian(&self) -> &[JacobianTerm] {
        &self.jacobian
    }
}

/// A solution with its derivatives in its start and in the parameters of these places, in the vector registers of this processor, if it
/// has any: by the recurrences that the law has of its own, or by its recorded formula.
pub(super) fn tangent<const N: usize>(
    law: LawForm,
    loading: Loading,
    weights: [f64; 2],
    free: &[usize],
) -> Option<Box<dyn Tangent<N>>> {
    let simd = avx2()?;
    let best = Best::new(simd);
    let stepper = Interfaces::stepper(law, &loading, simd);
    let asked = Asked {
        best,
        weights,
        free,
        stiffness: loading.stiffness,
    };
    let four = Four::new(simd, [0.0; 4]);
    if law.undamped_ageing().is_none() {
        let by_slopes = Box::new(BySlopes {
            formula: KeptFormula::new(InStates(law), true),
            jacobian: [JacobianTerm::ZERO; ROOM],
        });
        return Some(Box::new(
            asked.solution::<_, _, N>(stepper, by_slopes, four),
        ));
    }
    let recurrences = Box::new(AgeingRecurrences::<true>::new(simd));
    Some(match best.wide() {
        Some(wide) if N + free.len() > Four::LANES => {
            let eight = Eight::new(wide, [0.0; 8]);
            Box::new(asked.solution::<_, _, N>(stepper, recurrences, eight))
        }
        _ => Box::new(asked.solution::<_, _, N>(stepper, recurrences, four)),
    })
}

/// What a tangent is asked for.
struct Asked<'a> {
    best: Best,
    weights: [f64; 2],
    free: &'a [usize],
    stiffness: f64,
}

impl Asked<'_> {
    /// A solution of a system of N variables, made by these; the columns are as `any`.
    fn solution<R, X: Element, const N: usize>(
        self,
        stepper: Stepper<Pair, Interfaces, 2>,
        recurrences: Box<R>,
        any: X,
    ) -> TangentSolution<R, X> {
        let directions = N + self.free.len();
        let columns = (0..directions.div_ceil(X::LANES))
            .map(|_| VariationalEquations::new([any; 3], any, any))
            .collect();
        TangentSolution {
            best: self.best,
            weights: self.weights,
            free: self.free.to_vec(),
            stepper,
            recurrences,
            columns,
            stiffness: self.stiffness,
            log_determinant: 0.0,
            log_transverse: 0.0,
            states: 0.5 * (N - 1) as f64,
            start: [0.0; 2],
        }
    }
}

impl<R: Linearised, X: Element> TangentSolution<R, X> {
    #[inline(always)]
    fn step(&mut self, accuracy: &Accuracy, limit: f64) -> f64 {
        let order = accuracy.order;
        let unit = self.stepper.unit().first();
        let along = Along {
            jacobian: &self.recurrences.jacobian()[..order],
            stress: &self.stepper.series(0)[..=order],
            stiffness: self.stiffness,
            unit,
        };
        let longest_of_solution = self.stepper.longest(accuracy).first();
        let most = longest_of_solution.min((limit / unit).abs());
        let mut terms = [0.0; 2];
        for columns in &mut self.columns {
            columns.expand(order, &along);
            let [before, last] = columns.last_terms(accuracy, most);
            terms = [larger(terms[0], before), larger(terms[1], last)];
        }
        let h = most.min(longest_of_terms(order, terms));
        let any = self.stepper.state()[0];
        let before = self.stepper.state()[1];
        let taken = self
            .stepper
            .advance_by(accuracy, any.like(h), any.like(limit))
            .first();
        let h = taken / unit;
        let growth = (self.stepper.state()[1] / before).lanes();
        for columns in &mut self.columns {
            columns.advance_by(order, h, growth);
        }
        let jacobian = &self.recurrences.jacobian()[..order];
        let (trace, across) = mean_traces(jacobian, self.states, h);
        self.log_determinant += h * trace;
        self.log_transverse += h * across;
        taken
    }
}

/// The mean over h units of the trace of the Jacobian, its states counted `all` times, and of the growth of a difference between equal
/// interfaces.
#[inline(always)]
pub(super) fn mean_traces(jacobian: &[JacobianTerm], all: f64, h: f64) -> (f64, f64) {
    let squared = h * h;
    // Even and odd terms apart.
    let mut sums = [(0.0, 0.0); 2];
    let mut k = jacobian.len();
    while k > 0 {
        k -= 1;
        let JacobianTerm { stress, states } = &jacobian[k];
        let (across, over) = (states[0][1], ONE_OVER[k + 1]);
        let trace = stress[0][0] + all * (across + states[1][1]);
        let sum = &mut sums[k % 2];
        *sum = (
            sum.0 * squared + trace * over,
            sum.1 * squared + across * over,
        );
    }
    let [even, odd] = sums;
    (even.0 + h * odd.0, even.1 + h * odd.1)
}

/// The larger one, or the one that is no number.
#[inline(always)]
pub(super) fn larger(a: f64, b: f64) -> f64 {
    if a > b { a } else { b }
}

/// The series of the solution, to be compiled for the processor. Apart from the rest of a step: it is by far the most code.
pub(super) struct Expand<'a, R> {
    pub stepper: &'a mut Stepper<Pair, Interfaces, 2>,
    pub recurrences: &'a mut R,
    pub accuracy: &'a Accuracy,
}

impl<R: Linearised> NullaryFnOnce for Expand<'_, R> {
    type Output = ();
    #[inline(always)]
    fn call(self) {
        self.stepper.expand_with(self.recurrences, self.accuracy);
    }
}

/// A step whose series are made, to be compiled for the processor.
struct TangentStep<'a, R, X> {
    track: &'a mut TangentSolution<R, X>,
    accuracy: &'a Accuracy,
    limit: f64,
}

impl<R: Linearised, X: Element> NullaryFnOnce for TangentStep<'_, R, X> {
    type Output = f64;
    #[inline(always)]
    fn call(self) -> f64 {
        self.track.step(self.accuracy, self.limit)
    }
}

impl<R: Linearised, X: Element, const N: usize> Solution<N> for TangentSolution<R, X> {
    fn order(&self, rtol: f64) -> usize {
        R::order(rtol)
    }

    fn start(&mut self, y: &[f64; N]) {
        let zero = self.stepper.state()[0].like(0.0);
        self.start = [y[1], y[N - 1]];
        let psi = zero.with_lane(0, y[1]).with_lane(1, y[N - 1]).exp();
        self.stepper.start([zero.like(y[0]), psi]);
        for (chunk, columns) in self.columns.iter_mut().enumerate() {
            let nothing = columns.state()[0].like(0.0);
            let unit = |direction: usize| match direction.checked_sub(chunk * X::LANES) {
                Some(lane) if lane < X::LANES => nothing.with_lane(lane, 1.0),
                _ => nothing,
            };
            // Where the interfaces are one, both move.
            let x = [unit(0), unit(1), unit(N - 1)];
            let of = |place: usize| match self.free.iter().position(|&free| free == place) {
                Some(at) => unit(N + at),
                None => nothing,
            };
            columns.restart(x, of(0), of(1));
        }
        self.log_determinant = 0.0;
        self.log_transverse = 0.0;
    }

    fn advance(&mut self, accuracy: &Accuracy, limit: DoubleDouble) -> DoubleDouble {
        let best = self.best;
        best.vectorize(Expand {
            stepper: &mut self.stepper,
            recurrences: &mut *self.recurrences,
            accuracy,
        });
        let step = TangentStep {
            track: self,
            accuracy,
            limit: limit.hi(),
        };
        DoubleDouble::from(best.vectorize(step))
    }

    fn state(&self) -> [f64; N] {
        let [tau, psi] = self.stepper.state();
        chart(tau.first(), psi.ln().lanes())
    }

    fn expansion(&self, order: usize, into: &mut Expansion<N>) {
        copy(&self.stepper, order, into);
    }
}

impl<R: Linearised, X: Element, const N: usize> Tangent<N> for TangentSolution<R, X> {
    fn derivatives(&self) -> Derivatives<N> {
        let column = |direction: usize| {
            let columns = &self.columns[direction / X::LANES];
            let [tau, first, second] = columns.state().map(|x| x.lane(direction % X::LANES));
            chart::<N>(tau, [first, second])
        };
        let parameter =
            |(at, &place): (usize, &usize)| column(N + at).map(|x| x * self.weights[place]);
        // The trace in ln psi is less by the growth of ln psi.
        let end: [f64; 2] = self.stepper.state()[1].ln().lanes();
        let growth: f64 = (0..N - 1).map(|i| end[i] - self.start[i]).sum();
        Derivatives {
            start: std::array::from_fn(column),
            parameters: self.free.iter().enumerate().map(parameter).collect(),
            log_determinant: self.log_determinant - growth,
            log_transverse: (N == 2).then_some(self.log_transverse - growth),
        }
    }
}
