//! The interfaces in power series: the laws' own formulas, in the state (tau, psi_1, psi_2).
//!
//! In psi a law takes two series fewer than in ln psi, an exponential and a quotient. Two equal interfaces are the symmetric
//! subspace, and one interface is two equal ones driven twice as fast by a spring half as stiff, so one code serves all.

use super::{Loading, stress_rate};
use crate::friction::Law;
use crate::series::{
    Accuracy, Both, Element, Expansion, Formula, Order, Pair, Rates, Series, Solution, Stepper,
    value,
};

/// Both interfaces in the lanes of E, variables (tau, psi).
#[derive(Debug, Clone, Copy)]
pub(super) struct Interfaces<E, L> {
    law: L,
    driving: E,
    stiffness: E,
}

impl<E: Element, L: Law> Formula<E, 2> for Interfaces<E, L> {
    // |v| has a kink where v = 0, which is where tau = 0.
    const KINK: Option<usize> = Some(0);

    #[inline(always)]
    fn rates<'t, O: Order>(&self, [tau, psi]: [Series<'t, E, O>; 2]) -> Rates<'t, E, O, 2> {
        let v = self.law.slip_rate(self.law.activation(tau), psi);
        let loading = (value(self.driving), value(self.stiffness));
        Rates {
            variables: [
                stress_rate(loading, v.over_interfaces()),
                self.law.evolution(v, psi),
            ],
            watched: [v, v],
        }
    }

    #[inline(always)]
    fn units(&self, x: &[E; 2], (rtol, atol): (f64, f64)) -> [E; 2] {
        let [tau, psi] = *x;
        let of_tau = tau.abs().mul_add(tau.like(rtol), tau.like(atol));
        [of_tau, psi * tau.like(atol + rtol)]
    }

    #[inline(always)]
    fn allows(&self, x: &[E; 2]) -> bool {
        x[0].all_finite() && x[1].all_positive()
    }
}

/// From (tau, psi) to (tau, ln psi).
fn logarithms<const N: usize>(mut x: [f64; N]) -> [f64; N] {
    for psi in &mut x[1..] {
        *psi = psi.max(f64::MIN_POSITIVE).ln();
    }
    x
}

/// A solution in N = 2 or 3 dimensions.
pub(super) enum Track<L> {
    Plain(Stepper<Both<f64>, Interfaces<Both<f64>, L>, 2>),
    #[cfg(target_arch = "x86_64")]
    Vector(pulp::x86::V3, Stepper<Pair, Interfaces<Pair, L>, 2>),
}

impl<L: Law> Track<L> {
    pub fn new(law: L, loading: &Loading) -> Self {
        #[cfg(target_arch = "x86_64")]
        if let Some(simd) = pulp::x86::V3::try_new() {
            let all = |x: f64| Pair::new(simd, [x; 2]);
            let formula = Interfaces {
                law,
                driving: all(loading.driving),
                stiffness: all(loading.stiffness),
            };
            return Track::Vector(simd, Stepper::new(formula, all(0.0)));
        }
        let all = |x: f64| Both([x; 2]);
        let formula = Interfaces {
            law,
            driving: all(loading.driving),
            stiffness: all(loading.stiffness),
        };
        Track::Plain(Stepper::new(formula, all(0.0)))
    }
}

struct Step<'a, L> {
    solution: &'a mut Stepper<Pair, Interfaces<Pair, L>, 2>,
    accuracy: &'a Accuracy,
    limit: f64,
}

impl<L: Law> pulp::NullaryFnOnce for Step<'_, L> {
    type Output = f64;
    #[inline(always)]
    fn call(self) -> f64 {
        let limit = self.solution.state()[0].like(self.limit);
        self.solution.advance(self.accuracy, limit).first()
    }
}

impl<L: Law, const N: usize> Solution<N> for Track<L> {
    fn start(&mut self, y: &[f64; N]) {
        let (tau, psi) = (y[0], [y[1].exp(), y[N - 1].exp()]);
        match self {
            Track::Plain(solution) => solution.start([Both([tau; 2]), Both(psi)]),
            Track::Vector(simd, solution) => {
                solution.start([Pair::new(*simd, [tau; 2]), Pair::new(*simd, psi)])
            }
        }
    }

    fn advance(&mut self, accuracy: &Accuracy, limit: f64) -> f64 {
        match self {
            Track::Plain(solution) => solution.advance(accuracy, Both([limit; 2])).first(),
            Track::Vector(simd, solution) => simd.vectorize(Step {
                solution,
                accuracy,
                limit,
            }),
        }
    }

    fn state(&self) -> [f64; N] {
        let (tau, psi) = match self {
            Track::Plain(solution) => (solution.state()[0].first(), solution.state()[1].0),
            Track::Vector(_, solution) => {
                (solution.state()[0].first(), solution.state()[1].lanes())
            }
        };
        let mut y = [tau; N];
        for i in 1..N {
            y[i] = psi[i - 1].ln();
        }
        y
    }

    fn expansion(&self, order: usize, into: &mut Expansion<N>) {
        into.order = order;
        into.unit = match self {
            Track::Plain(s) => s.unit().first(),
            Track::Vector(_, s) => s.unit().first(),
        };
        into.chart = logarithms;
        for j in 0..=order {
            let (tau, psi) = match self {
                Track::Plain(s) => (s.coefficient(0, j).first(), s.coefficient(1, j).0),
                Track::Vector(_, s) => (s.coefficient(0, j).first(), s.coefficient(1, j).lanes()),
            };
            into.variables[0][j] = tau;
            for i in 1..N {
                into.variables[i][j] = psi[i - 1];
            }
            if j < order {
                let v = match self {
                    Track::Plain(s) => s.watched(0, j).map(|x| x.0),
                    Track::Vector(_, s) => s.watched(0, j).map(Pair::lanes),
                };
                if let Some(v) = v {
                    into.slip_rates[0][j] = v[0];
                    into.slip_rates[1][j] = v[1];
                }
            }
        }
    }
}
