//! Two equal interfaces in the vector registers of an x86-64 processor, both in one, in power series.

use super::Loading;
use super::ageing_series::{AgeingRecurrences, Best};
use super::in_states::{InStates, Integral, Motion, chart, logarithms};
use crate::friction::LawForm;
use crate::number::DoubleDouble;
use crate::series::{
    Accuracy, Element, Equations, Expansion, Formula, JacobianTerm, KeptFormula, MAX_ORDER, Pair,
    ROOM, Recurrences, Solution, Stepper, avx2,
};
use pulp::x86::V3;
use std::cell::Cell;

/// Rows in the memory: the variables', and that of v.
pub(super) const TAU: usize = 0;
pub(super) const PSI: usize = 1;
pub(super) const SLIP_RATE: usize = 2;

/// Both interfaces in the lanes of a pair, variables (tau, psi).
#[derive(Debug, Clone, Copy)]
pub(super) struct Interfaces {
    pub law: LawForm,
    pub driving: Pair,
    pub stiffness: Pair,
}

impl Interfaces {
    /// A stepper of them, to be started.
    pub fn stepper(law: LawForm, loading: &Loading, simd: V3) -> Stepper<Pair, Self, 2> {
        let zero = Pair::new(simd, [0.0; 2]);
        let interfaces = Interfaces {
            law,
            driving: zero.like(loading.driving),
            stiffness: zero.like(loading.stiffness),
        };
        Stepper::new(interfaces, zero)
    }
}

impl Formula<Pair, 2> for Interfaces {
    fn rates(&self, &[tau, psi]: &[Pair; 2]) -> [Pair; 2] {
        if let Some(law) = self.law.undamped_ageing() {
            let both = Motion::of(&law, tau, psi);
            let [first, second] = (both.slip_rate * both.factor).lanes();
            let of_tau = (self.driving - tau.like(first + second)) * self.stiffness;
            return [of_tau, both.evolution];
        }
        let [first, second] = psi.lanes();
        let loading = [self.driving.first(), self.stiffness.first()];
        let [of_tau, first, second] =
            InStates(self.law).rates([tau.first(), first, second], loading);
        [tau.like(of_tau), tau.like_lanes([first, second])]
    }

    #[inline(always)]
    fn units(&self, &[tau, psi]: &[Pair; 2], (rtol, atol): (f64, f64)) -> [Pair; 2] {
        let of_tau = tau.abs().mul_add(tau.like(rtol), tau.like(atol));
        [of_tau, psi * tau.like(atol + rtol)]
    }

    #[inline(always)]
    fn allows(&self, [tau, psi]: &[Pair; 2]) -> Pair {
        // psi, and no number where tau is not finite.
        tau.mul_add(tau.like(0.0), *psi)
    }
}

/// By the recorded formula.
impl Recurrences<Pair, Interfaces, 2> for KeptFormula {
    fn make(&mut self, formula: &Interfaces, memory: &[Cell<Pair>], order: usize, unit: Pair) {
        let [first, second] = memory[PSI * ROOM].get().lanes();
        let tau = memory[TAU * ROOM].get();
        let [tau, driving, stiffness] = [tau, formula.driving, formula.stiffness].map(Pair::first);
        let begin = [tau, first, second, driving, stiffness];
        self.expand(&begin, order, unit.first());
        for k in 0..order {
            let [tau, first, second] = [0, 1, 2].map(|i| self.variable(i)[k + 1]);
            memory[TAU * ROOM + k + 1].set(unit.like(tau));
            memory[PSI * ROOM + k + 1].set(unit.like_lanes([first, second]));
            let v = [0, 1].map(|i| self.other(i, k));
            memory[SLIP_RATE * ROOM + k].set(unit.like_lanes(v));
        }
    }
}

/// The coefficients of one order of v, dv/dtau, dv/dpsi, dg/dtau and dg/dpsi of both interfaces, g = dpsi/dt.
pub(super) struct Slopes {
    pub v: [f64; 2],
    pub v_tau: [f64; 2],
    pub v_psi: [f64; 2],
    g_tau: [f64; 2],
    g_psi: [f64; 2],
}

impl Slopes {
    /// Those of a formula that gives slopes.
    #[inline(always)]
    pub fn of(made: &KeptFormula, k: usize) -> Self {
        // For tau, psi_1 and psi_2 one after the other: of both slip rates, and of both states' rates.
        let of = |place: fn(usize) -> usize| [0, 1].map(|i| made.other(place(i), k));
        Slopes {
            v: of(|i| i),
            v_tau: of(|i| 2 + i),
            v_psi: of(|i| 2 + 4 * (1 + i) + i),
            g_tau: of(|i| 4 + i),
            g_psi: of(|i| 4 + 4 * (1 + i) + i),
        }
    }

    /// The Jacobian, where the step begins at these states.
    #[inline(always)]
    pub fn jacobian(&self, psi: [f64; 2], stiffness: f64, unit: f64) -> JacobianTerm {
        let pull = -(stiffness * unit);
        let stress = (self.v_tau[0] + self.v_tau[1]) * pull;
        JacobianTerm {
            stress: [0, 1].map(|i| [stress, self.v_psi[i] * (pull * psi[i])]),
            states: [0, 1].map(|i| [self.g_tau[i] * (unit / psi[i]), self.g_psi[i] * unit]),
        }
    }
}

/// A solution in N = 2 or 3 dimensions.
struct PairSolution {
    simd: V3,
    best: Best,
    stepper: Stepper<Pair, Interfaces, 2>,
    recurrences: Box<AgeingRecurrences<false>>,
}

/// A solution by recurrences of its own, for laws and processors that have these.
pub(super) fn solution<const N: usize>(
    law: LawForm,
    loading: &Loading,
) -> Option<Box<dyn Solution<N>>> {
    law.undamped_ageing()?;
    let simd = avx2()?;
    Some(Box::new(PairSolution {
        simd,
        best: Best::new(simd),
        stepper: Interfaces::stepper(law, loading, simd),
        recurrences: Box::new(AgeingRecurrences::new(simd)),
    }))
}

/// The order with which the recurrences take the least time for a relative tolerance.
pub(super) fn order(rtol: f64) -> usize {
    /// Tolerances above which lower orders win.
    const FROM: [(f64, usize); 3] = [(2e-6, 12), (4e-9, 16), (3e-11, 20)];
    let least = FROM.iter().find(|(above, _)| rtol > *above);
    least.map_or(MAX_ORDER, |(_, order)| *order)
}

/// A step of a pair, to be compiled for the processor's vector instructions.
struct PairStep<'a> {
    stepper: &'a mut Stepper<Pair, Interfaces, 2>,
    recurrences: &'a mut AgeingRecurrences<false>,
    accuracy: &'a Accuracy,
    limit: f64,
}

impl pulp::NullaryFnOnce for PairStep<'_> {
    type Output = f64;
    #[inline(always)]
    fn call(self) -> f64 {
        let limit = self.stepper.state()[0].like(self.limit);
        let stepper = self.stepper;
        let h = stepper.advance_with(self.recurrences, self.accuracy, limit);
        h.first()
    }
}

impl<const N: usize> Solution<N> for PairSolution {
    fn order(&self, rtol: f64) -> usize {
        order(rtol)
    }

    fn start(&mut self, y: &[f64; N]) {
        let tau = Pair::new(self.simd, [y[0]; 2]);
        let psi = Pair::new(self.simd, [y[1], y[N - 1]].map(f64::exp));
        self.stepper.start([tau, psi]);
    }

    fn advance(&mut self, accuracy: &Accuracy, limit: DoubleDouble) -> DoubleDouble {
        let step = PairStep {
            stepper: &mut self.stepper,
            recurrences: &mut self.recurrences,
            accuracy,
            limit: limit.hi(),
        };
        DoubleDouble::from(self.best.vectorize(step))
    }

    fn state(&self) -> [f64; N] {
        let [tau, psi] = self.stepper.state();
        chart(tau.first(), psi.lanes().map(f64::ln))
    }

    fn slips(&self, order: usize, length: f64) -> Option<[f64; 2]> {
        let time = self.stepper.unit().like(length);
        let slips = time.run(Integral {
            rates: &self.stepper.slip_rates(0)[..order],
            time,
            unit: self.stepper.unit(),
        });
        Some(slips.lanes())
    }

    fn expansion(&self, order: usize, into: &mut Expansion<N>) {
        copy(&self.stepper, order, into);
    }
}

/// The series of the last step.
pub(super) fn copy<const N: usize>(
    stepper: &Stepper<Pair, Interfaces, 2>,
    order: usize,
    into: &mut Expansion<N>,
) {
    into.order = order;
    into.unit = stepper.unit().first();
    into.chart = logarithms;
    let (tau, psi) = (stepper.series(0), stepper.series(1));
    for j in 0..=order {
        let x = chart::<N>(tau[j].first(), psi[j].lanes());
        for (series, x) in into.variables.iter_mut().zip(x) {
            series[j] = x;
        }
    }
    for (j, v) in stepper.slip_rates(0)[..order].iter().enumerate() {
        let [first, second] = v.lanes();
        into.slip_rates[0][j] = first;
        into.slip_rates[1][j] = second;
    }
}
