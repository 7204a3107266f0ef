//! The difference chart with its tangents, for laws that are powers of a linear strength and whose state ages, by recurrences of their
//! own: an optimisation. The recorded formula serves for everything else, and tests hold this to it.
//!
//! The interfaces themselves are the pair of [`super::ageing_series`], whose first state is put at psi_1 = psi_2 + D with every step.
//! With rho = a_1 D / a(psi_2), c = a_1 psi_2 / a(psi_2) and
//!
//!   m = ((1 + rho)^(-beta) - 1) / rho,   f = (1 + rho)^(-beta - 1),
//!
//! which are smooth and of order one however small D is, the logarithm l = ln D changes by
//!
//!   l' = g_1 - |v_1| - |v_2| c m,
//!
//! and, P_i = beta a_i'/a_i being known from the pair, the next coefficients of all come out of sums of products:
//!
//!   m' = -(l' - P_2/beta) (m + beta f),        f' = -(1 + 1/beta) (P_1 - P_2) f,
//!   (D/D(0))' = l' D/D(0),                     w' = -(P_2/beta) w  for w = a(0)/a(psi_2), with c = 1 - a_0 w / a(0).
//!
//! The linearised equations are in (tau, l, psi_2/psi_2(0)). Their Jacobian is that of the pair but for
//!
//!   dtau'/dl = K beta |v_1| a_1 D/a(psi_1),
//!   dl'/dtau = -z_1 - z_2 c m,   dl'/dl = beta |v_1| a_1 D/a(psi_1) + |v_2| c (m + beta f),
//!   dl'/dpsi_2 = beta |v_1| a_1/a(psi_1) - |v_2| a_1/a(psi_2) (m - beta c (m - f)),
//!
//! with the sign of v in the derivatives of tau' and in z. What is as small as D keeps its relative accuracy: along canards it grows
//! by many decades.

use super::Loading;
use super::ageing_series::{AgeingRecurrences, Best};
use super::series::{Interfaces, order};
use super::tangent::{Expand, Linearised, larger, mean_traces};
use crate::friction::AgeingForm;
use crate::number::DoubleDouble;
use crate::series::{
    Accuracy, Along, Derivatives, Eight, Element, Expansion, Four, JacobianTerm, ONE_OVER, Pair,
    ROOM, Solution, Stepper, Tangent, VariationalEquations, avx2, longest_of_terms,
};
use pulp::NullaryFnOnce;
use pulp::x86::V3;

/// The variables of the pair.
const TAU: usize = 0;
const PSI: usize = 1;

/// The solution in (tau, ln psi_2, ln D) with its derivatives in its start and in the parameters of these places. `None` on a
/// processor without AVX2.
pub(super) fn tangent(
    form: AgeingForm,
    loading: Loading,
    free: &[usize],
) -> Option<Box<dyn Tangent<3>>> {
    let simd = avx2()?;
    let best = Best::new(simd);
    Some(match best.wide() {
        Some(wide) => {
            let any = Eight::new(wide, [0.0; 8]);
            Box::new(DifferenceTangent::new(best, simd, form, loading, free, any))
        }
        None => {
            let any = Four::new(simd, [0.0; 4]);
            Box::new(DifferenceTangent::new(best, simd, form, loading, free, any))
        }
    })
}

/// Such a solution, its columns in the lanes of X.
struct DifferenceTangent<X> {
    best: Best,
    simd: V3,
    form: AgeingForm,
    loading: Loading,
    /// The places of the parameters in which derivatives are asked for.
    free: Vec<usize>,
    pair: Stepper<Pair, Interfaces, 2>,
    recurrences: Box<AgeingRecurrences<true>>,
    difference: Box<DifferenceSeries>,
    /// Columns in (tau, ln D, psi_2/psi_2(0)): the derivatives in the start, then those in parameters.
    columns: Vec<VariationalEquations<X, true>>,
    /// ln D, and what rounding took from it.
    log_gap: (f64, f64),
    log_determinant: f64,
    /// ln psi_2 at the start.
    start: f64,
}

/// The series of ln D, and what they are made of.
struct DifferenceSeries {
    /// l
    log_gap: [f64; ROOM],
    /// (s, l', P_1 - P_2, P_2) and (m + beta f, D/D(0), f, w), with s = l' - P_2/beta: their products are the next coefficients.
    rates: [Four; ROOM],
    values: [Four; ROOM],
    /// (w, w, |v_2|, z_2) and (m, f, c m, c m)
    states: [Four; ROOM],
    powers: [Four; ROOM],
    /// (|v_2|, |u_2|, |u_2|, |u_2|) and (c f, m, c m, c f)
    slips: [Four; ROOM],
    factors: [Four; ROOM],
    /// |u_1| and D/D(0); slip rates and all that is in units of them are in the unit of time.
    over_strength: [f64; ROOM],
    gap: [f64; ROOM],
    jacobian: [JacobianTerm; ROOM],
}

/// sum of left_j right_(k-j) over all j, k + 1 being the length of both. In two sums, which the processor forms side by side; what
/// is newest in the right comes last.
#[inline(always)]
fn product(left: &[Four], right: &[Four]) -> Four {
    let mut sums = [left[0].like(0.0); 2];
    let mut pairs = left.iter().rev().zip(right);
    while let Some((a, b)) = pairs.next() {
        sums[0] = a.mul_add(*b, sums[0]);
        let Some((a, b)) = pairs.next() else { break };
        sums[1] = a.mul_add(*b, sums[1]);
    }
    sums[0] + sums[1]
}

impl DifferenceSeries {
    fn new(simd: V3) -> Self {
        let zero = [Four::new(simd, [0.0; 4]); ROOM];
        DifferenceSeries {
            log_gap: [0.0; ROOM],
            rates: zero,
            values: zero,
            states: zero,
            powers: zero,
            slips: zero,
            factors: zero,
            over_strength: [0.0; ROOM],
            gap: [0.0; ROOM],
            jacobian: [JacobianTerm::ZERO; ROOM],
        }
    }

    /// Makes the series from those of the pair, whose states begin at these; D begins at `gap`.
    #[inline(always)]
    fn expand(
        &mut self,
        order: usize,
        pair: &AgeingRecurrences<true>,
        form: &AgeingForm,
        start: Start,
    ) {
        let Start { psi, gap, unit } = start;
        let beta = form.beta;
        let per_beta = 1.0 / beta;
        let [a_0, a_1] = form.strength;
        let [a_first, a_second] = psi.map(|psi| a_0 + a_1 * psi);
        let any = self.rates[0];
        let rho = a_1 * gap / a_second;
        let log = rho.ln_1p();
        let mut m = match (-beta * log).exp_m1() / rho {
            m if rho > 0.0 => m,
            _ => -beta,
        };
        let mut f = (-(beta + 1.0) * log).exp();
        let (mut grown, mut w) = (1.0, 1.0);
        let healed = a_0 / a_second;
        // dtau'/dl and |v_1| a_1 D/a(psi_1) are as |u_1| D, by these factors; dtau'/dpsi_1 is as |u_1| too.
        let u_start = pair.interface(0, 0).over_strength * unit;
        let tau_by_gap = pair.jacobian()[0].stress[0][1] / u_start * gap / psi[0];
        let weakening = a_1 * gap / a_first;
        let per_strength = [a_1 * psi[1] / a_first, a_1 * psi[1] / a_second];
        let of_second = psi[1] / psi[0];
        let mut k = 0;
        while k < order {
            let (first, second) = (pair.interface(0, k), pair.interface(1, k));
            let (v, u) = (second.slip_rate, second.over_strength * unit);
            let z = second.by_stress * unit;
            self.states[k] = any.like_lanes([w, w, v, z]);
            self.powers[k] = any.like_lanes([m, f, 0.0, 0.0]);
            let [wm, wf, v_known, z_known] =
                product(&self.states[..=k], &self.powers[..=k]).lanes();
            let (cm, cf) = (m - healed * wm, f - healed * wf);
            self.powers[k] = any.like_lanes([m, f, cm, cm]);
            let [_, _, v_first, z_first] = self.states[0].lanes();
            let v_cm = v_known + v_first * cm;
            let z_cm = z_known + z_first * cm;
            let healing = if k == 0 { form.healing[1] * unit } else { 0.0 };
            let log_rate = healing - first.slip_rate - v_cm;
            let p = second.strengthening;
            let s = log_rate - p * per_beta;
            self.rates[k] = any.like_lanes([s, log_rate, first.strengthening - p, p]);
            self.values[k] = any.like_lanes([m + beta * f, grown, f, w]);
            self.slips[k] = any.like_lanes([v, u, u, u]);
            self.factors[k] = any.like_lanes([cf, m, cm, cf]);
            let u_first = first.over_strength * unit;
            self.over_strength[k] = u_first;
            self.gap[k] = grown;
            let [v_cf, um, u_cm, u_cf] = product(&self.slips[..=k], &self.factors[..=k]).lanes();
            let mut u_gap = 0.0;
            let mut j = 0;
            while j <= k {
                u_gap += self.over_strength[j] * self.gap[k - j];
                j += 1;
            }
            let of_pair = pair.jacobian()[k];
            let by_first = of_pair.stress[0][1];
            self.jacobian[k] = JacobianTerm {
                stress: [
                    [of_pair.stress[0][0], tau_by_gap * u_gap],
                    [
                        beta * per_strength[0] * u_first
                            - per_strength[1] * (um - beta * (u_cm - u_cf)),
                        of_pair.stress[1][1] + of_second * by_first,
                    ],
                ],
                states: [
                    [
                        -(first.by_stress * unit + z_cm),
                        beta * weakening * u_gap + v_cm + beta * v_cf,
                    ],
                    of_pair.states[1],
                ],
            };
            let [of_m, of_gap, of_f, of_w] = product(&self.rates[..=k], &self.values[..=k]).lanes();
            k += 1;
            let over = ONE_OVER[k];
            self.log_gap[k] = log_rate * over;
            m = -of_m * over;
            grown = of_gap * over;
            f = of_f * over * -(1.0 + per_beta);
            w = of_w * over * -per_beta;
        }
    }

    /// The change of ln D in h units.
    #[inline(always)]
    fn change(&self, order: usize, h: f64) -> f64 {
        let squared = h * h;
        // Even and odd terms apart. All orders are even.
        let (mut even, mut odd) = (self.log_gap[order], self.log_gap[order - 1]);
        let mut k = order - 2;
        while k > 0 {
            even = even * squared + self.log_gap[k];
            odd = odd * squared + self.log_gap[k - 1];
            k -= 2;
        }
        even * squared + odd * h
    }
}

/// Where a step begins.
struct Start {
    psi: [f64; 2],
    gap: f64,
    /// The unit of time.
    unit: f64,
}

impl<X: Element> DifferenceTangent<X> {
    fn new(
        best: Best,
        simd: V3,
        form: AgeingForm,
        loading: Loading,
        free: &[usize],
        any: X,
    ) -> Self {
        let directions = 3 + free.len();
        let columns = (0..directions.div_ceil(X::LANES))
            .map(|_| VariationalEquations::new([any; 3], any, any))
            .collect();
        DifferenceTangent {
            best,
            simd,
            form,
            loading,
            free: free.to_vec(),
            pair: Interfaces::stepper(form.into(), &loading, simd),
            recurrences: Box::new(AgeingRecurrences::new(simd)),
            difference: Box::new(DifferenceSeries::new(simd)),
            columns,
            log_gap: (0.0, 0.0),
            log_determinant: 0.0,
            start: 0.0,
        }
    }

    /// A step along the series of the pair, which are made.
    #[inline(always)]
    fn step(&mut self, accuracy: &Accuracy, limit: f64) -> f64 {
        let order = accuracy.order;
        let unit = self.pair.unit().first();
        let psi = self.pair.state()[PSI].lanes();
        let start = Start {
            psi,
            gap: self.log_gap.0.exp(),
            unit,
        };
        let difference = &mut self.difference;
        difference.log_gap[0] = self.log_gap.0;
        difference.expand(order, &self.recurrences, &self.form, start);
        let along = Along {
            jacobian: &difference.jacobian[..order],
            stress: &self.pair.series(TAU)[..=order],
            stiffness: self.loading.stiffness,
            unit,
        };
        let most = self
            .pair
            .longest(accuracy)
            .first()
            .min((limit / unit).abs());
        let (rtol, atol) = accuracy.tolerances;
        let tolerable = atol + rtol * self.log_gap.0.abs();
        let mut terms = [order - 1, order].map(|k| (difference.log_gap[k] / tolerable).abs());
        for columns in &mut self.columns {
            columns.expand(order, &along);
            let [before, last] = columns.last_terms(accuracy, most);
            terms = [larger(terms[0], before), larger(terms[1], last)];
        }
        let h = most.min(longest_of_terms(order, terms));
        let any = self.pair.state()[TAU];
        let taken = self
            .pair
            .advance_by(accuracy, any.like(h), any.like(limit))
            .first();
        let h = taken / unit;
        let second = self.pair.state()[PSI].lane(1);
        for columns in &mut self.columns {
            columns.advance_by(order, h, [1.0, second / psi[1]]);
        }
        let (trace, _) = mean_traces(&self.difference.jacobian[..order], 1.0, h);
        self.log_determinant += h * trace;
        let (before, lost) = self.log_gap;
        let change = self.difference.change(order, h) + lost;
        let sum = before + change;
        self.log_gap = (sum, change - (sum - before));
        self.put_first(second);
        taken
    }

    /// psi_1 = psi_2 + D
    #[inline(always)]
    fn put_first(&mut self, second: f64) {
        let first = second + self.log_gap.0.exp();
        let psi = self.pair.state()[PSI].with_lane(0, first);
        self.pair.replace(PSI, psi);
    }
}

/// A step whose series of the pair are made, to be compiled for the processor.
struct DifferenceStep<'a, X> {
    track: &'a mut DifferenceTangent<X>,
    accuracy: &'a Accuracy,
    limit: f64,
}

impl<X: Element> NullaryFnOnce for DifferenceStep<'_, X> {
    type Output = f64;
    #[inline(always)]
    fn call(self) -> f64 {
        self.track.step(self.accuracy, self.limit)
    }
}

impl<X: Element> Solution<3> for DifferenceTangent<X> {
    fn order(&self, rtol: f64) -> usize {
        order(rtol)
    }

    fn start(&mut self, &[tau, log_second, log_gap]: &[f64; 3]) {
        self.start = log_second;
        self.log_gap = (log_gap, 0.0);
        let second = log_second.exp();
        let psi = Pair::new(self.simd, [second + log_gap.exp(), second]);
        self.pair.start([Pair::new(self.simd, [tau; 2]), psi]);
        for (chunk, columns) in self.columns.iter_mut().enumerate() {
            let nothing = columns.state()[0].like(0.0);
            let unit = |direction: usize| match direction.checked_sub(chunk * X::LANES) {
                Some(lane) if lane < X::LANES => nothing.with_lane(lane, 1.0),
                _ => nothing,
            };
            let of = |place: usize| match self.free.iter().position(|&free| free == place) {
                Some(at) => unit(3 + at),
                None => nothing,
            };
            columns.restart([unit(0), unit(2), unit(1)], of(0), of(1));
        }
        self.log_determinant = 0.0;
    }

    fn advance(&mut self, accuracy: &Accuracy, limit: DoubleDouble) -> DoubleDouble {
        let best = self.best;
        best.vectorize(Expand {
            stepper: &mut self.pair,
            recurrences: &mut *self.recurrences,
            accuracy,
        });
        let step = DifferenceStep {
            track: self,
            accuracy,
            limit: limit.hi(),
        };
        DoubleDouble::from(best.vectorize(step))
    }

    fn state(&self) -> [f64; 3] {
        let [tau, psi] = self.pair.state();
        [tau.first(), psi.lane(1).ln(), self.log_gap.0]
    }

    fn expansion(&self, order: usize, into: &mut Expansion<3>) {
        into.order = order;
        into.unit = self.pair.unit().first();
        into.chart = |[tau, psi, log_gap]| [tau, psi.ln(), log_gap];
        let (tau, psi) = (self.pair.series(TAU), self.pair.series(PSI));
        for j in 0..=order {
            into.variables[0][j] = tau[j].first();
            into.variables[1][j] = psi[j].lane(1);
            into.variables[2][j] = self.difference.log_gap[j];
        }
    }
}

impl<X: Element> Tangent<3> for DifferenceTangent<X> {
    fn derivatives(&self) -> Derivatives<3> {
        let column = |direction: usize| {
            let columns = &self.columns[direction / X::LANES];
            let [tau, log_gap, second] = columns.state().map(|x| x.lane(direction % X::LANES));
            [tau, second, log_gap]
        };
        // The trace in ln psi_2 is less by the growth of ln psi_2.
        let growth = self.pair.state()[PSI].lane(1).ln() - self.start;
        Derivatives {
            start: std::array::from_fn(column),
            parameters: (0..self.free.len()).map(|at| column(3 + at)).collect(),
            log_determinant: self.log_determinant - growth,
            log_transverse: None,
        }
    }
}
