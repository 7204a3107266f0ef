//! The interfaces with their tangents in power series.
//!
//! The Jacobian's entries along the solution come with its series, for both interfaces at once: by the recurrences that laws have of
//! their own, or by the law's derivatives written out. The linearised equations of all columns are then sums of products with them,
//! see [`VariationalEquations`].

#[cfg(target_arch = "x86_64")]
use super::ageing_series::{AgeingRecurrences, Best};
#[cfg(target_arch = "x86_64")]
use super::series::stepper;
use super::series::{Interfaces, Motion, chart, copy, interfaces};
use super::{Loading, stress_rate};
use crate::friction::{LawForm, Slopes};
use crate::number::DoubleDouble;
#[cfg(not(target_arch = "x86_64"))]
use crate::series::Both;
use crate::series::{
    Accuracy, Along, ByFormula, Derivatives, Element, Expansion, Formula, JacobianTerm, ONE_OVER,
    Order, ROOM, Rates, Recurrences, Series, Solution, Stepper, Tangent, VariationalEquations,
    WATCHED, longest_of_terms, usual_order, value,
};
use pulp::NullaryFnOnce;
use std::cell::Cell;
#[cfg(target_arch = "x86_64")]
use {
    crate::series::{Eight, Four, Pair},
    pulp::x86::V3,
};

/// The interfaces, with v and dv/dtau, dv/dpsi, dg/dtau, dg/dpsi watched, g = dpsi/dt.
#[derive(Clone, Copy)]
pub(super) struct LinearisedInterfaces<E, L>(pub Interfaces<E, L>);

impl<E: Element, L: Motion> Formula<E, 2> for LinearisedInterfaces<E, L> {
    const KINK: Option<usize> = <Interfaces<E, L> as Formula<E, 2>>::KINK;

    #[inline(always)]
    fn rates<'t, O: Order>(&self, [tau, psi]: [Series<'t, E, O>; 2]) -> Rates<'t, E, O, 2> {
        let Interfaces {
            law,
            driving,
            stiffness,
        } = &self.0;
        let Slopes {
            v,
            v_tau,
            v_psi,
            g,
            g_tau,
            g_psi,
        } = law.slopes(tau, psi);
        let loading = (value(*driving), value(*stiffness));
        Rates {
            variables: [stress_rate(loading, v.over_interfaces()), g],
            watched: [v, v_tau, v_psi, g_tau, g_psi],
        }
    }

    #[inline(always)]
    fn units(&self, x: &[E; 2], tolerances: (f64, f64)) -> [E; 2] {
        self.0.units(x, tolerances)
    }

    #[inline(always)]
    fn allows(&self, x: &[E; 2]) -> E {
        self.0.allows(x)
    }
}

/// Coefficients that come with the Jacobian's along them.
pub(super) trait Linearised<E: Element, F: Formula<E, 2>>: Recurrences<E, F, 2> {
    /// The order with which they take the least time for a relative tolerance.
    fn order(rtol: f64) -> usize;
    /// That of those made last.
    fn jacobian(&self) -> &[JacobianTerm];
}

/// By the formula with its derivatives.
struct BySlopes {
    jacobian: [JacobianTerm; ROOM],
}

impl<E: Element, L: Motion> Linearised<E, LinearisedInterfaces<E, L>> for BySlopes {
    fn order(rtol: f64) -> usize {
        usual_order(rtol)
    }

    fn jacobian(&self) -> &[JacobianTerm] {
        &self.jacobian
    }
}

impl<E: Element, L: Motion> Recurrences<E, LinearisedInterfaces<E, L>, 2> for BySlopes {
    #[inline(always)]
    fn make(
        &mut self,
        formula: &LinearisedInterfaces<E, L>,
        memory: &[Cell<E>],
        order: usize,
        unit: E,
    ) -> [Option<usize>; WATCHED] {
        let watched = ByFormula.make(formula, memory, order, unit);
        let jacobian = &mut self.jacobian[..order];
        jacobian_of_rows(jacobian, memory, &watched, formula.0.stiffness, unit);
        watched
    }
}

/// The Jacobian from the rows of [`LinearisedInterfaces`]. What has no row does not change along solutions, and is zero.
#[inline(always)]
pub(super) fn jacobian_of_rows<E: Element>(
    jacobian: &mut [JacobianTerm],
    memory: &[Cell<E>],
    watched: &[Option<usize>; WATCHED],
    stiffness: E,
    unit: E,
) {
    let psi = memory[ROOM].get();
    let pull = -(stiffness * unit);
    let (of_psi, per_psi) = (pull * psi, unit / psi);
    let mut k = 0;
    while k < jacobian.len() {
        let mut entries = [unit.like(0.0); WATCHED];
        let mut i = 0;
        while i < WATCHED {
            if let Some(row) = watched[i] {
                entries[i] = memory[row * ROOM + k].get();
            }
            i += 1;
        }
        let [_, v_tau, v_psi, g_tau, g_psi] = entries;
        let stress = (v_tau.over_interfaces() * pull).first();
        let by_state = (v_psi * of_psi).interfaces();
        let by_stress = (g_tau * per_psi).interfaces();
        let growth = (g_psi * unit).interfaces();
        jacobian[k] = JacobianTerm {
            stress: [[stress, by_state[0]], [stress, by_state[1]]],
            states: [[by_stress[0], growth[0]], [by_stress[1], growth[1]]],
        };
        k += 1;
    }
}

/// How code is compiled: for the processor at hand, or for any.
trait Shell: Copy {
    fn run<F: NullaryFnOnce>(self, f: F) -> F::Output;
}

#[cfg(not(target_arch = "x86_64"))]
#[derive(Clone, Copy)]
struct AnyProcessor;

#[cfg(not(target_arch = "x86_64"))]
impl Shell for AnyProcessor {
    #[inline(always)]
    fn run<F: NullaryFnOnce>(self, f: F) -> F::Output {
        f.call()
    }
}

#[cfg(target_arch = "x86_64")]
impl Shell for V3 {
    #[inline(always)]
    fn run<F: NullaryFnOnce>(self, f: F) -> F::Output {
        self.vectorize(f)
    }
}

#[cfg(target_arch = "x86_64")]
impl Shell for Best {
    #[inline(always)]
    fn run<F: NullaryFnOnce>(self, f: F) -> F::Output {
        self.vectorize(f)
    }
}

/// A solution with the columns that are the derivatives in its start, and in V_H and K where those are asked for.
struct TangentSolution<S, E, F, R, X> {
    shell: S,
    /// V_H and K of the pair that moves as the system does, per those of the system.
    weights: [f64; 2],
    /// The places of the parameters in which derivatives are asked for.
    free: Vec<usize>,
    stepper: Stepper<E, F, 2>,
    recurrences: R,
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

/// A solution with its derivatives in its start and in the parameters of these places, compiled for this processor. `None` on an x86-64
/// without AVX2, of which there are few.
pub(super) fn tangent<const N: usize>(
    form: LawForm,
    loading: Loading,
    weights: [f64; 2],
    free: &[usize],
) -> Option<Box<dyn Tangent<N>>> {
    let asked = Asked {
        loading,
        weights,
        free,
    };
    #[cfg(target_arch = "x86_64")]
    let (shell, zero, any) = {
        let simd = crate::series::avx2()?;
        let (zero, any) = (Pair::new(simd, [0.0; 2]), Four::new(simd, [0.0; 4]));
        if let Some(form) = form.undamped_ageing() {
            let stepper = stepper(form, &loading, zero);
            let recurrences = AgeingRecurrences::<true>::new(simd);
            let best = Best::new(simd);
            return Some(match best.wide() {
                Some(wide) if N + free.len() > Four::LANES => {
                    let any = Eight::new(wide, [0.0; 8]);
                    Box::new(asked.solution::<_, _, _, _, _, N>(best, stepper, recurrences, any))
                }
                _ => Box::new(asked.solution::<_, _, _, _, _, N>(best, stepper, recurrences, any)),
            });
        }
        (simd, zero, any)
    };
    #[cfg(not(target_arch = "x86_64"))]
    let (shell, zero, any) = (AnyProcessor, Both([0.0; 2]), Both([Both([0.0; 2]); 2]));
    let formula = LinearisedInterfaces(interfaces(form, &loading, zero));
    let jacobian = [JacobianTerm::ZERO; ROOM];
    let stepper = Stepper::new(formula, zero);
    Some(Box::new(asked.solution::<_, _, _, _, _, N>(
        shell,
        stepper,
        BySlopes { jacobian },
        any,
    )))
}

/// What a tangent is asked for.
struct Asked<'a> {
    loading: Loading,
    weights: [f64; 2],
    free: &'a [usize],
}

impl Asked<'_> {
    /// A solution of a system of N variables, made by these; the columns are as `any`.
    fn solution<S, E, F, R, X: Element, const N: usize>(
        self,
        shell: S,
        stepper: Stepper<E, F, 2>,
        recurrences: R,
        any: X,
    ) -> TangentSolution<S, E, F, R, X> {
        let directions = N + self.free.len();
        let columns = (0..directions.div_ceil(X::LANES))
            .map(|_| VariationalEquations::new([any; 3], any, any))
            .collect();
        TangentSolution {
            shell,
            weights: self.weights,
            free: self.free.to_vec(),
            stepper,
            recurrences,
            columns,
            stiffness: self.loading.stiffness,
            log_determinant: 0.0,
            log_transverse: 0.0,
            states: 0.5 * (N - 1) as f64,
            start: [0.0; 2],
        }
    }
}

impl<S: Shell, E: Element, F: Formula<E, 2>, R: Linearised<E, F>, X: Element>
    TangentSolution<S, E, F, R, X>
{
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
        let growth = (self.stepper.state()[1] / before).interfaces();
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
pub(super) struct Expand<'a, E, F, R> {
    pub stepper: &'a mut Stepper<E, F, 2>,
    pub recurrences: &'a mut R,
    pub accuracy: &'a Accuracy,
}

impl<E: Element, F: Formula<E, 2>, R: Recurrences<E, F, 2>> NullaryFnOnce for Expand<'_, E, F, R> {
    type Output = ();
    #[inline(always)]
    fn call(self) {
        self.stepper.expand_with(self.recurrences, self.accuracy);
    }
}

/// A step whose series are made, to be compiled for the processor.
struct TangentStep<'a, T> {
    track: &'a mut T,
    accuracy: &'a Accuracy,
    limit: f64,
}

impl<S: Shell, E: Element, F: Formula<E, 2>, R: Linearised<E, F>, X: Element> NullaryFnOnce
    for TangentStep<'_, TangentSolution<S, E, F, R, X>>
{
    type Output = f64;
    #[inline(always)]
    fn call(self) -> f64 {
        self.track.step(self.accuracy, self.limit)
    }
}

impl<S: Shell, E: Element, F: Formula<E, 2>, R: Linearised<E, F>, X: Element, const N: usize>
    Solution<N> for TangentSolution<S, E, F, R, X>
{
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
        let shell = self.shell;
        shell.run(Expand {
            stepper: &mut self.stepper,
            recurrences: &mut self.recurrences,
            accuracy,
        });
        let step = TangentStep {
            track: self,
            accuracy,
            limit: limit.hi(),
        };
        DoubleDouble::from(shell.run(step))
    }

    fn state(&self) -> [f64; N] {
        let [tau, psi] = self.stepper.state();
        chart(tau.first(), psi.ln().interfaces())
    }

    fn expansion(&self, order: usize, into: &mut Expansion<N>) {
        copy(&self.stepper, order, into);
    }
}

impl<S: Shell, E: Element, F: Formula<E, 2>, R: Linearised<E, F>, X: Element, const N: usize>
    Tangent<N> for TangentSolution<S, E, F, R, X>
{
    fn derivatives(&self) -> Derivatives<N> {
        let column = |direction: usize| {
            let columns = &self.columns[direction / X::LANES];
            let [tau, first, second] = columns.state().map(|x| x.lane(direction % X::LANES));
            chart::<N>(tau, [first, second])
        };
        let parameter =
            |(at, &place): (usize, &usize)| column(N + at).map(|x| x * self.weights[place]);
        // The trace in ln psi is less by the growth of ln psi.
        let end: [f64; 2] = self.stepper.state()[1].ln().interfaces();
        let growth: f64 = (0..N - 1).map(|i| end[i] - self.start[i]).sum();
        Derivatives {
            start: std::array::from_fn(column),
            parameters: self.free.iter().enumerate().map(parameter).collect(),
            log_determinant: self.log_determinant - growth,
            log_transverse: (N == 2).then_some(self.log_transverse - growth),
        }
    }
}
