//! Two equal interfaces in the state (tau, psi_1, psi_2), and their series by the recorded formula of any law.
//!
//! In psi a law takes two series fewer than in ln psi, an exponential and a quotient. Two equal interfaces are the symmetric
//! subspace, and one interface is two equal ones driven twice as fast by a spring half as stiff, so one code serves all.

use super::{Loading, stress_rate};
use crate::friction::{AgeingForm, LawForm};
use crate::number::{DoubleDouble, Real};
use crate::series::{
    Accuracy, Element, Equations, Expansion, Formula, KeptFormula, LaneFormula, ONE_OVER, ROOM,
    Recurrences, Solution, Stepper,
};
use pulp::NullaryFnOnce;
use std::cell::Cell;

/// (19) in (tau, psi_1, psi_2), with the parameters V_H and K.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct InStates(pub LawForm);

impl Equations<3, 2> for InStates {
    const PARAMETERS: [&'static str; 2] = super::Parameter::LOADING;

    fn rates<T: Real>(&self, x: [T; 3], [driving, stiffness]: [T; 2]) -> [T; 3] {
        let [first, second] = self.motions(x);
        [
            stress_rate((driving, stiffness), first.0 + second.0),
            first.1,
            second.1,
        ]
    }

    fn slip_rates<T: Real>(&self, x: [T; 3], _: [T; 2]) -> [Option<T>; 2] {
        self.motions(x).map(|(v, _)| Some(v))
    }
}

impl InStates {
    /// v and dpsi/dt of both interfaces.
    fn motions<T: Real>(&self, [tau, first, second]: [T; 3]) -> [(T, T); 2] {
        let activation = self.0.activation(tau);
        [first, second].map(|psi| {
            let v = self.0.slip_rate(activation, psi);
            (v, self.0.evolution(v, psi))
        })
    }
}

/// A slip rate, of which a factor that all interfaces share is left out, and dpsi/dt.
pub(super) struct Motion<E> {
    pub slip_rate: E,
    pub factor: E,
    pub evolution: E,
}

impl<E: Element> Motion<E> {
    /// Of a law whose state ages, without damping, in all lanes at once.
    #[inline(always)]
    pub fn of(law: &AgeingForm, tau: E, psi: E) -> Self {
        let (s, factor) = if law.exponential {
            (tau.exp(), 0.5 * law.gamma0)
        } else {
            (tau.sinh_cosh().0, law.gamma0)
        };
        let [constant, linear] = law.strength.map(|a| tau.like(a));
        let a = if law.strength == [0.0, 1.0] {
            psi
        } else {
            psi * linear + constant
        };
        let slip_rate = s * a.powf(-law.beta);
        let factor = tau.like(factor);
        let [healing, growth] = law.healing.map(|g| tau.like(g));
        let sliding = factor * slip_rate.sign();
        Motion {
            slip_rate,
            factor,
            evolution: (slip_rate * psi).mul_add(-sliding, psi * growth + healing),
        }
    }
}

/// Rows in the memory: the variables', and those of the slip rates.
pub(super) const TAU: usize = 0;
pub(super) const PSI: [usize; 2] = [1, 2];
pub(super) const SLIP_RATES: [usize; 2] = [3, 4];

/// Both interfaces of a trajectory in every lane of E, variables (tau, psi_1, psi_2).
#[derive(Debug, Clone, Copy)]
pub(super) struct Trajectories<E> {
    pub law: LawForm,
    pub driving: E,
    pub stiffness: E,
}

impl<E: Element> Formula<E, 3> for Trajectories<E> {
    #[inline(always)]
    fn rates(&self, x: &[E; 3]) -> [E; 3] {
        if let Some(law) = self.law.undamped_ageing() {
            let [tau, first, second] = *x;
            let [first, second] = [first, second].map(|psi| Motion::of(&law, tau, psi));
            let slip_rates = first.slip_rate * first.factor;
            let slip_rates = second.slip_rate.mul_add(second.factor, slip_rates);
            let of_tau = (self.driving - slip_rates) * self.stiffness;
            return [of_tau, first.evolution, second.evolution];
        }
        let mut rates = *x;
        for lane in 0..E::LANES {
            let at = x.map(|x| x.lane(lane));
            let loading = [self.driving, self.stiffness].map(|x| x.lane(lane));
            let here = InStates(self.law).rates(at, loading);
            for (all, here) in rates.iter_mut().zip(here) {
                *all = all.with_lane(lane, here);
            }
        }
        rates
    }

    #[inline(always)]
    fn units(&self, [tau, p, q]: &[E; 3], (rtol, atol): (f64, f64)) -> [E; 3] {
        let of_tau = tau.abs().mul_add(tau.like(rtol), tau.like(atol));
        let of_psi = tau.like(atol + rtol);
        [of_tau, *p * of_psi, *q * of_psi]
    }

    #[inline(always)]
    fn allows(&self, [tau, p, q]: &[E; 3]) -> E {
        // psi_1 where psi_2 allows it, and no number where tau is not finite.
        let zero = tau.like(0.0);
        tau.mul_add(zero, *q)
            .if_positive(tau.mul_add(zero, *p), tau.like(-1.0))
    }
}

impl<E: Element> Trajectories<E> {
    /// The series by the recorded formula, in the lanes where this is negative.
    #[inline(always)]
    pub fn expand_where(
        &self,
        these: E,
        recorded: &mut LaneFormula<E>,
        memory: &[Cell<E>],
        (order, unit): (usize, E),
    ) {
        let [tau, p, q] = [TAU, PSI[0], PSI[1]].map(|row| memory[row * ROOM].get());
        recorded.expand(&[tau, p, q, self.driving, self.stiffness], order, unit);
        let put = |row: usize, k: usize, made: E| {
            let x = &memory[row * ROOM + k];
            x.set(these.if_negative(made, x.get()));
        };
        for k in 0..order {
            for (i, row) in [TAU, PSI[0], PSI[1]].into_iter().enumerate() {
                put(row, k + 1, recorded.variable(i)[k + 1]);
            }
            for (i, row) in SLIP_RATES.into_iter().enumerate() {
                put(row, k, recorded.other(i, k));
            }
        }
    }
}

impl<E: Element> Recurrences<E, Trajectories<E>, 3> for LaneFormula<E> {
    #[inline(always)]
    fn make(&mut self, formula: &Trajectories<E>, memory: &[Cell<E>], order: usize, unit: E) {
        formula.expand_where(unit.like(-1.0), self, memory, (order, unit));
    }
}

impl Recurrences<f64, Trajectories<f64>, 3> for KeptFormula {
    fn make(&mut self, formula: &Trajectories<f64>, memory: &[Cell<f64>], order: usize, unit: f64) {
        formula.expand_where(-1.0, self, memory, (order, unit));
    }
}

/// A solution in N = 2 or 3 dimensions.
struct StateSolution {
    stepper: Stepper<f64, Trajectories<f64>, 3>,
    recurrences: KeptFormula,
}

/// A solution by the recorded formula.
pub(super) fn solution<const N: usize>(law: LawForm, loading: &Loading) -> Box<dyn Solution<N>> {
    let formula = Trajectories {
        law,
        driving: loading.driving,
        stiffness: loading.stiffness,
    };
    Box::new(StateSolution {
        stepper: Stepper::new(formula, 0.0),
        recurrences: KeptFormula::new(InStates(law), false),
    })
}

impl<const N: usize> Solution<N> for StateSolution {
    fn start(&mut self, y: &[f64; N]) {
        self.stepper.start([y[0], y[1].exp(), y[N - 1].exp()]);
    }

    fn advance(&mut self, accuracy: &Accuracy, limit: DoubleDouble) -> DoubleDouble {
        let recurrences = &mut self.recurrences;
        let step = (self.stepper).advance_with(recurrences, accuracy, limit.hi());
        DoubleDouble::from(step)
    }

    fn state(&self) -> [f64; N] {
        let [tau, first, second] = *self.stepper.state();
        chart(tau, [first.ln(), second.ln()])
    }

    fn slips(&self, order: usize, length: f64) -> Option<[f64; 2]> {
        let integral = |i: usize| Integral {
            rates: &self.stepper.slip_rates(i)[..order],
            time: length,
            unit: self.stepper.unit(),
        };
        Some([0, 1].map(|i| integral(i).call()))
    }

    fn expansion(&self, order: usize, into: &mut Expansion<N>) {
        into.order = order;
        into.unit = self.stepper.unit();
        into.chart = logarithms;
        for j in 0..=order {
            let [tau, first, second] = [0, 1, 2].map(|i| self.stepper.series(i)[j]);
            let x = chart::<N>(tau, [first, second]);
            for (series, x) in into.variables.iter_mut().zip(x) {
                series[j] = x;
            }
        }
        for (i, rates) in into.slip_rates.iter_mut().enumerate() {
            rates[..order].copy_from_slice(&self.stepper.slip_rates(i)[..order]);
        }
    }
}

/// The integral of a series over a time.
pub(super) struct Integral<'a, E> {
    pub rates: &'a [E],
    pub time: E,
    pub unit: E,
}

impl<E: Element> NullaryFnOnce for Integral<'_, E> {
    type Output = E;
    /// With the order a constant the sums are unrolled.
    #[inline(always)]
    fn call(self) -> E {
        match self.rates.len() {
            12 => self.sum(12),
            16 => self.sum(16),
            20 => self.sum(20),
            24 => self.sum(24),
            order => self.sum(order),
        }
    }
}

impl<E: Element> Integral<'_, E> {
    /// To an even order; even and odd terms apart, for two short chains.
    #[inline(always)]
    fn sum(&self, order: usize) -> E {
        let rates = &self.rates[..order];
        let s = self.time / self.unit;
        let (squared, zero) = (s * s, s.like(0.0));
        let (mut even, mut odd) = (zero, zero);
        let mut k = order;
        while k > 0 {
            k -= 2;
            even = even.mul_add(squared, rates[k] * s.like(ONE_OVER[k + 1]));
            odd = odd.mul_add(squared, rates[k + 1] * s.like(ONE_OVER[k + 2]));
        }
        odd.mul_add(s, even) * self.time
    }
}

/// (tau, x_1, x_2), or (tau, x_1) where both are equal.
pub(super) fn chart<const N: usize>(tau: f64, x: [f64; 2]) -> [f64; N] {
    let mut all = [tau; N];
    all[1..].copy_from_slice(&x[..N - 1]);
    all
}

/// From (tau, psi) to (tau, ln psi).
pub(super) fn logarithms<const N: usize>(mut x: [f64; N]) -> [f64; N] {
    for psi in &mut x[1..] {
        *psi = psi.max(f64::MIN_POSITIVE).ln();
    }
    x
}
