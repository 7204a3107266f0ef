//! The interfaces with their tangents in power series.
//!
//! The laws' formulas run on jets of series: the Jacobian's entries along the solution, for both interfaces at once. The
//! linearised equations of all columns are then sums of products with them, see [`VariationalEquations`]. In doubles: it takes a quarter of
//! the time of [`crate::series::Recorded`], which serves for 31 digits and for other systems.

use super::series::{Interfaces, chart, copy};
use super::{Loading, stress_rate};
use crate::friction::Law;
use crate::number::{DoubleDouble, Jet};
use crate::series::{
    Accuracy, Both, Derivatives, Element, Expansion, Formula, JacobianSeries, MAX_ORDER, Order,
    Rates, Series, Solution, Spread, Stepper, Tangent, VariationalEquations, value,
};
use pulp::NullaryFnOnce;
#[cfg(target_arch = "x86_64")]
use {
    crate::series::{Four, Pair},
    pulp::x86::V3,
};

/// The interfaces, with v and dv/dtau, dv/dpsi, dg/dtau, dg/dpsi watched, g = dpsi/dt.
#[derive(Clone, Copy)]
struct LinearisedInterfaces<E, L>(Interfaces<E, L>);

impl<E: Element, L: Law> Formula<E, 2> for LinearisedInterfaces<E, L> {
    const UNROLLED: bool = E::UNROLLED && L::UNROLLED_IN_LANES;
    const KINK: Option<usize> = <Interfaces<E, L> as Formula<E, 2>>::KINK;

    #[inline(always)]
    fn rates<'t, O: Order>(&self, [tau, psi]: [Series<'t, E, O>; 2]) -> Rates<'t, E, O, 2> {
        let Interfaces {
            law,
            driving,
            stiffness,
        } = &self.0;
        let (tau, psi) = (Jet::<_, 2>::variable(tau, 0), Jet::<_, 2>::variable(psi, 1));
        let v = law.slip_rate(law.activation(tau), psi);
        let g = law.evolution(v, psi);
        let loading = (value(*driving), value(*stiffness));
        Rates {
            variables: [stress_rate(loading, v.value.over_interfaces()), g.value],
            watched: [
                v.value,
                v.gradient[0],
                v.gradient[1],
                g.gradient[0],
                g.gradient[1],
            ],
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

/// A solution with the columns that are the derivatives in its start, in V_H and in K, as many as X has lanes.
struct TangentSolution<S, E, X, L> {
    shell: S,
    /// V_H and K of the pair that moves as the system does, per those of the system.
    weights: [f64; 2],
    /// The places of the parameters in which derivatives are asked for.
    free: Vec<usize>,
    stepper: Stepper<E, LinearisedInterfaces<E, L>, 2>,
    columns: VariationalEquations<X>,
    stiffness: E,
    /// Zero for a quantity that does not change along solutions.
    constant: [E; MAX_ORDER + 1],
    log_determinant: E,
    /// The integral of dg/dpsi of the first interface.
    log_transverse: E,
    /// Half the number of states that are variables of the system.
    states: E,
    /// ln psi at the start.
    start: [f64; 2],
}

/// A solution with its derivatives in its start and in the parameters of these places, compiled for this processor; without
/// parameters it takes less. `None` on an x86-64
/// without AVX2, of which there are few: each kernel takes minutes to compile, and one for each processor is enough.
pub(super) fn tangent<'a, L: Law + 'a, const N: usize>(
    law: L,
    loading: Loading,
    weights: [f64; 2],
    free: &[usize],
) -> Option<Box<dyn Tangent<N> + 'a>> {
    #[cfg(target_arch = "x86_64")]
    let (shell, pair, four) = {
        let simd = crate::series::avx2()?;
        (simd, Pair::new(simd, [0.0; 2]), Four::new(simd, [0.0; 4]))
    };
    #[cfg(not(target_arch = "x86_64"))]
    let (shell, pair, four) = (AnyProcessor, Both([0.0; 2]), Both([Both([0.0; 2]); 2]));
    let eight = Both([four; 2]);
    Some(if free.is_empty() {
        Box::new(TangentSolution::new(
            shell, law, loading, weights, free, pair, four,
        ))
    } else {
        Box::new(TangentSolution::new(
            shell, law, loading, weights, free, pair, eight,
        ))
    })
}

impl<S: Shell, E: Spread<X>, X: Element, L: Law> TangentSolution<S, E, X, L> {
    fn new(
        shell: S,
        law: L,
        loading: Loading,
        weights: [f64; 2],
        free: &[usize],
        zero: E,
        any: X,
    ) -> Self {
        let formula = LinearisedInterfaces(Interfaces {
            law,
            driving: zero.like(loading.driving),
            stiffness: zero.like(loading.stiffness),
        });
        TangentSolution {
            shell,
            weights,
            free: free.to_vec(),
            stepper: Stepper::new(formula, zero),
            columns: VariationalEquations::new([any; 3], any, any),
            stiffness: zero.like(loading.stiffness),
            constant: [zero; MAX_ORDER + 1],
            log_determinant: zero,
            log_transverse: zero,
            states: zero,
            start: [0.0; 2],
        }
    }

    #[inline(always)]
    fn step(&mut self, accuracy: &Accuracy, limit: E) -> E {
        let longest_of_solution = self.stepper.longest(accuracy);
        let along = JacobianSeries {
            entries: entries(&self.stepper, &self.constant),
            stress: self.stepper.series(0),
            stiffness: self.stiffness,
            unit: self.stepper.unit(),
        };
        self.columns.expand(accuracy.order, &along);
        let most = Element::min(longest_of_solution, (limit / self.stepper.unit()).abs());
        let psi = self.stepper.state()[1];
        let longest = self.columns.longest(accuracy, psi, most.first());
        let h = Element::min(most, limit.like(longest));
        let taken = self.stepper.advance_by(accuracy, h, limit);
        let h = taken / self.stepper.unit();
        self.columns.advance_by(accuracy.order, h);
        let (trace, across) = self.mean_traces(accuracy.order, h);
        self.log_determinant = trace.mul_add(taken, self.log_determinant);
        self.log_transverse = across.mul_add(taken, self.log_transverse);
        taken
    }

    /// The mean over the last step of -K (dv_1/dtau + dv_2/dtau) + dg_1/dpsi_1 + dg_2/dpsi_2, where the interfaces are one the
    /// last term once; and of dg/dpsi.
    #[inline(always)]
    fn mean_traces(&self, order: usize, h: E) -> (E, E) {
        let [v_tau, _, _, g_psi] = entries(&self.stepper, &self.constant);
        let (mut mean, mut across) = (h.like(0.0), h.like(0.0));
        let mut j = order;
        while j > 0 {
            j -= 1;
            let states = g_psi[j].over_interfaces() * self.states;
            let term = states - self.stiffness * v_tau[j].over_interfaces();
            let one_over = h.like(1.0) / h.like((j + 1) as f64);
            mean = mean.mul_add(h, term * one_over);
            across = across.mul_add(h, g_psi[j] * one_over);
        }
        (mean, across)
    }
}

/// The Jacobian's entries along the last step.
#[inline(always)]
fn entries<'a, E: Element, F: Formula<E, 2>>(
    stepper: &'a Stepper<E, F, 2>,
    constant: &'a [E],
) -> [&'a [E]; 4] {
    let mut entries = [constant; 4];
    let mut i = 0;
    while i < 4 {
        if let Some(series) = stepper.watched_series(1 + i) {
            entries[i] = series;
        }
        i += 1;
    }
    entries
}

/// The series of the solution, to be compiled for the processor. Apart from the rest of a step: it is by far the most code, and
/// the same whatever the columns.
struct Expand<'a, E, L> {
    stepper: &'a mut Stepper<E, LinearisedInterfaces<E, L>, 2>,
    accuracy: &'a Accuracy,
}

impl<E: Element, L: Law> NullaryFnOnce for Expand<'_, E, L> {
    type Output = ();
    #[inline(always)]
    fn call(self) {
        self.stepper.expand(self.accuracy);
    }
}

/// A step whose series are made, to be compiled for the processor.
struct TangentStep<'a, T, E> {
    track: &'a mut T,
    accuracy: &'a Accuracy,
    limit: E,
}

impl<S: Shell, E: Spread<X>, X: Element, L: Law> NullaryFnOnce
    for TangentStep<'_, TangentSolution<S, E, X, L>, E>
{
    type Output = E;
    #[inline(always)]
    fn call(self) -> E {
        self.track.step(self.accuracy, self.limit)
    }
}

impl<S: Shell, E: Spread<X>, X: Element, L: Law, const N: usize> Solution<N>
    for TangentSolution<S, E, X, L>
{
    fn start(&mut self, y: &[f64; N]) {
        let zero = self.stiffness.like(0.0);
        self.start = [y[1], y[N - 1]];
        let psi = zero.with_lane(0, y[1]).with_lane(1, y[N - 1]).exp();
        self.stepper.start([zero.like(y[0]), psi]);
        // The derivatives in ln psi; where the interfaces are one, both move.
        let any = self.columns.state()[0].like(0.0);
        let [psi1, psi2] = psi.interfaces();
        let x = [
            any.with_lane(0, 1.0),
            any.with_lane(1, psi1),
            any.with_lane(N - 1, psi2),
        ];
        let lane = |i: usize| {
            if i < X::LANES {
                any.with_lane(i, 1.0)
            } else {
                any
            }
        };
        self.columns.restart(x, lane(N), lane(N + 1));
        self.states = zero.like(0.5 * (N - 1) as f64);
        self.log_determinant = zero;
        self.log_transverse = zero;
    }

    fn advance(&mut self, accuracy: &Accuracy, limit: DoubleDouble) -> DoubleDouble {
        let limit = self.stiffness.like_exact(limit);
        let shell = self.shell;
        shell.run(Expand {
            stepper: &mut self.stepper,
            accuracy,
        });
        let step = TangentStep {
            track: self,
            accuracy,
            limit,
        };
        shell.run(step).to_exact()
    }

    fn state(&self) -> [f64; N] {
        let [tau, psi] = self.stepper.state();
        chart(tau.first(), psi.ln().interfaces())
    }

    fn expansion(&self, order: usize, into: &mut Expansion<N>) {
        copy(&self.stepper, order, into);
    }
}

impl<S: Shell, E: Spread<X>, X: Element, L: Law, const N: usize> Tangent<N>
    for TangentSolution<S, E, X, L>
{
    fn derivatives(&self) -> Derivatives<N> {
        let psi = self.stepper.state()[1].interfaces();
        let [tau, psi1, psi2] = self.columns.state();
        let column = |lane: usize| {
            let states = [psi1.lane(lane) / psi[0], psi2.lane(lane) / psi[1]];
            chart::<N>(tau.lane(lane), states)
        };
        let parameter = |&place: &usize| column(N + place).map(|x| x * self.weights[place]);
        // The trace in ln psi is less by the growth of ln psi.
        let end: [f64; 2] = self.stepper.state()[1].ln().interfaces();
        let growth: f64 = (0..N - 1).map(|i| end[i] - self.start[i]).sum();
        Derivatives {
            start: std::array::from_fn(column),
            parameters: self.free.iter().map(parameter).collect(),
            log_determinant: self.log_determinant.first() - growth,
            log_transverse: (N == 2).then(|| self.log_transverse.first() - growth),
        }
    }
}
