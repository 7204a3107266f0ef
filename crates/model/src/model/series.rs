//! The interfaces in power series: the laws' own formulas, in the state (tau, psi_1, psi_2).
//!
//! In psi a law takes two series fewer than in ln psi, an exponential and a quotient. Two equal interfaces are the symmetric
//! subspace, and one interface is two equal ones driven twice as fast by a spring half as stiff, so one code serves all.

use super::{Loading, stress_rate};
use crate::friction::{AgeingForm, LawForm, Slopes};
use crate::number::{DoubleDouble, Real};
use crate::series::{
    Accuracy, Both, Element, Expansion, Formula, ONE_OVER, Order, Rates, Series, Solution, Stepper,
    WATCHED, usual_order, value,
};
#[cfg(target_arch = "x86_64")]
use {
    super::ageing_series::AgeingSolution,
    crate::series::{ByFormula, Pair, Recurrences},
    pulp::x86::V3,
};

/// What an interface does under a stress: all that series take of a law.
pub(super) trait Motion: Copy {
    /// Whether series are compiled order by order, and not made in loops.
    const UNROLLED: bool = false;
    /// s(tau), which all interfaces under this stress share.
    fn activation<T: Real>(&self, tau: T) -> T;
    /// v and dpsi/dt.
    fn motion<T: Real>(&self, activation: T, psi: T) -> (T, T);
    /// These at tau and psi with their derivatives.
    fn slopes<T: Real>(&self, tau: T, psi: T) -> Slopes<T>;
}

macro_rules! motion_of_form {
    ($form:ident, $unrolled:expr) => {
        impl Motion for $form {
            const UNROLLED: bool = $unrolled;

            #[inline(always)]
            fn activation<T: Real>(&self, tau: T) -> T {
                $form::activation(self, tau)
            }

            #[inline(always)]
            fn motion<T: Real>(&self, activation: T, psi: T) -> (T, T) {
                let v = self.slip_rate(activation, psi);
                (v, self.evolution(v, psi))
            }

            #[inline(always)]
            fn slopes<T: Real>(&self, tau: T, psi: T) -> Slopes<T> {
                LawForm::from(*self).slopes(tau, psi)
            }
        }
    };
}
motion_of_form!(LawForm, false);
// Where there are vector instructions it has recurrences of its own.
motion_of_form!(AgeingForm, cfg!(not(target_arch = "x86_64")));

/// Both interfaces in the lanes of E, variables (tau, psi).
#[derive(Debug, Clone, Copy)]
pub(super) struct Interfaces<E, L> {
    pub law: L,
    pub driving: E,
    pub stiffness: E,
}

impl<E: Element, L: Motion> Formula<E, 2> for Interfaces<E, L> {
    const UNROLLED: bool = E::UNROLLED && L::UNROLLED;
    // |v| has a kink where v = 0, which is where tau = 0.
    const KINK: Option<usize> = Some(0);

    #[inline(always)]
    fn rates<'t, O: Order>(&self, [tau, psi]: [Series<'t, E, O>; 2]) -> Rates<'t, E, O, 2> {
        let (v, g) = self.law.motion(self.law.activation(tau), psi);
        let loading = (value(self.driving), value(self.stiffness));
        Rates {
            variables: [stress_rate(loading, v.over_interfaces()), g],
            watched: [v; WATCHED],
        }
    }

    #[inline(always)]
    fn units(&self, &[tau, psi]: &[E; 2], (rtol, atol): (f64, f64)) -> [E; 2] {
        let of_tau = tau.abs().mul_add(tau.like(rtol), tau.like(atol));
        [of_tau, psi * tau.like(atol + rtol)]
    }

    #[inline(always)]
    fn allows(&self, [tau, psi]: &[E; 2]) -> E {
        // psi, and no number where tau is not finite.
        tau.mul_add(tau.like(0.0), *psi)
    }
}

/// A solution in N = 2 or 3 dimensions, in the best arithmetic of this processor.
pub(super) enum SeriesSolution {
    #[cfg(target_arch = "x86_64")]
    Pair(V3, Stepper<Pair, Interfaces<Pair, LawForm>, 2>),
    #[cfg(target_arch = "x86_64")]
    Ageing(AgeingSolution),
    /// Compiled order by order.
    #[cfg(not(target_arch = "x86_64"))]
    Unrolled(Stepper<Both<f64>, Interfaces<Both<f64>, AgeingForm>, 2>),
    Plain(Stepper<Both<f64>, Interfaces<Both<f64>, LawForm>, 2>),
}

/// The same expression for every variant, `$s` its stepper.
macro_rules! each {
    ($track:expr, $s:ident => $body:expr) => {
        match $track {
            #[cfg(target_arch = "x86_64")]
            SeriesSolution::Pair(_, $s) => $body,
            #[cfg(target_arch = "x86_64")]
            SeriesSolution::Ageing(AgeingSolution { stepper: $s, .. }) => $body,
            #[cfg(not(target_arch = "x86_64"))]
            SeriesSolution::Unrolled($s) => $body,
            SeriesSolution::Plain($s) => $body,
        }
    };
}

impl SeriesSolution {
    pub fn new(form: LawForm, loading: &Loading) -> Self {
        #[cfg(target_arch = "x86_64")]
        if let Some(simd) = crate::series::avx2() {
            if let Some(form) = form.undamped_ageing() {
                return SeriesSolution::Ageing(AgeingSolution::new(form, loading, simd));
            }
            let zero = Pair::new(simd, [0.0; 2]);
            return SeriesSolution::Pair(simd, stepper(form, loading, zero));
        }
        let zero = Both([0.0; 2]);
        #[cfg(not(target_arch = "x86_64"))]
        if let Some(form) = form.undamped_ageing() {
            return SeriesSolution::Unrolled(stepper(form, loading, zero));
        }
        SeriesSolution::Plain(stepper(form, loading, zero))
    }
}

/// The interfaces in elements as `zero`.
pub(super) fn interfaces<E: Element, L>(law: L, loading: &Loading, zero: E) -> Interfaces<E, L> {
    Interfaces {
        law,
        driving: zero.like(loading.driving),
        stiffness: zero.like(loading.stiffness),
    }
}

/// A stepper of them, to be started.
pub(super) fn stepper<E: Element, L: Motion>(
    law: L,
    loading: &Loading,
    zero: E,
) -> Stepper<E, Interfaces<E, L>, 2> {
    Stepper::new(interfaces(law, loading, zero), zero)
}

/// A step of a pair, to be compiled for the processor's vector instructions.
#[cfg(target_arch = "x86_64")]
pub(super) struct PairStep<'a, F, R> {
    pub stepper: &'a mut Stepper<Pair, F, 2>,
    pub recurrences: &'a mut R,
    pub accuracy: &'a Accuracy,
    pub limit: f64,
}

#[cfg(target_arch = "x86_64")]
impl<F, R> pulp::NullaryFnOnce for PairStep<'_, F, R>
where
    F: Formula<Pair, 2>,
    R: Recurrences<Pair, F, 2>,
{
    type Output = f64;
    #[inline(always)]
    fn call(self) -> f64 {
        let limit = self.stepper.state()[0].like(self.limit);
        let stepper = self.stepper;
        let h = stepper.advance_with(self.recurrences, self.accuracy, limit);
        h.first()
    }
}

impl<const N: usize> Solution<N> for SeriesSolution {
    fn order(&self, rtol: f64) -> usize {
        match self {
            #[cfg(target_arch = "x86_64")]
            SeriesSolution::Ageing(_) => AgeingSolution::order(rtol),
            _ => usual_order(rtol),
        }
    }

    fn start(&mut self, y: &[f64; N]) {
        let log_states = [y[1], y[N - 1]];
        match self {
            #[cfg(target_arch = "x86_64")]
            SeriesSolution::Pair(simd, stepper) => {
                let tau = Pair::new(*simd, [y[0]; 2]);
                stepper.start([tau, Pair::new(*simd, log_states.map(f64::exp))]);
            }
            #[cfg(target_arch = "x86_64")]
            SeriesSolution::Ageing(AgeingSolution { simd, stepper, .. }) => {
                let tau = Pair::new(*simd, [y[0]; 2]);
                stepper.start([tau, Pair::new(*simd, log_states.map(f64::exp))]);
            }
            #[cfg(not(target_arch = "x86_64"))]
            SeriesSolution::Unrolled(stepper) => {
                stepper.start([Both([y[0]; 2]), Both(log_states.map(f64::exp))]);
            }
            SeriesSolution::Plain(stepper) => {
                stepper.start([Both([y[0]; 2]), Both(log_states.map(f64::exp))]);
            }
        }
    }

    fn advance(&mut self, accuracy: &Accuracy, limit: DoubleDouble) -> DoubleDouble {
        match self {
            #[cfg(target_arch = "x86_64")]
            SeriesSolution::Pair(simd, stepper) => {
                let limit = limit.hi();
                let step = PairStep {
                    stepper,
                    recurrences: &mut ByFormula,
                    accuracy,
                    limit,
                };
                DoubleDouble::from(simd.vectorize(step))
            }
            #[cfg(target_arch = "x86_64")]
            SeriesSolution::Ageing(solution) => {
                DoubleDouble::from(solution.advance(accuracy, limit.hi()))
            }
            #[cfg(not(target_arch = "x86_64"))]
            SeriesSolution::Unrolled(stepper) => {
                DoubleDouble::from(stepper.advance(accuracy, Both([limit.hi(); 2])).first())
            }
            SeriesSolution::Plain(stepper) => {
                DoubleDouble::from(stepper.advance(accuracy, Both([limit.hi(); 2])).first())
            }
        }
    }

    fn state(&self) -> [f64; N] {
        let x = each!(self, s => s.state().map(Element::interfaces));
        chart(x[0][0], x[1].map(f64::ln))
    }

    fn slips(&self, order: usize, length: f64) -> Option<[f64; 2]> {
        each!(self, s => slips(s, order, length))
    }

    fn expansion(&self, order: usize, into: &mut Expansion<N>) {
        each!(self, s => copy(s, order, into));
    }
}

/// The slip rates of the last step, what is watched first, integrated.
fn slips<E: Element, F: Formula<E, 2>>(
    stepper: &Stepper<E, F, 2>,
    order: usize,
    length: f64,
) -> Option<[f64; 2]> {
    let rates = stepper.watched_series(0)?;
    let time = stepper.unit().like(length);
    let slips = time.run(Integral {
        rates: &rates[..order],
        time,
        unit: stepper.unit(),
    });
    Some(slips.interfaces())
}

/// The integral of a series over a time.
struct Integral<'a, E> {
    rates: &'a [E],
    time: E,
    unit: E,
}

impl<E: Element> pulp::NullaryFnOnce for Integral<'_, E> {
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

/// The series of the last step, with the slip rate as what is watched first.
pub(super) fn copy<E: Element, F: Formula<E, 2>, const N: usize>(
    stepper: &Stepper<E, F, 2>,
    order: usize,
    into: &mut Expansion<N>,
) {
    into.order = order;
    into.unit = stepper.unit().first();
    into.chart = logarithms;
    let (tau, psi) = (stepper.series(0), stepper.series(1));
    for j in 0..=order {
        let x = chart::<N>(tau[j].first(), psi[j].interfaces());
        for (series, x) in into.variables.iter_mut().zip(x) {
            series[j] = x;
        }
    }
    let Some(v) = stepper.watched_series(0) else {
        return;
    };
    for (j, v) in v[..order].iter().enumerate() {
        let [first, second] = v.interfaces();
        into.slip_rates[0][j] = first;
        into.slip_rates[1][j] = second;
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
