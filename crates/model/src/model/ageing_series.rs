//! Series of two interfaces of laws that are powers of a linear strength and whose state ages, by recurrences of their own: an
//! optimisation. The laws' formulas on [`crate::series::Series`] serve for everything else and near tau = 0, and tests hold this to
//! them.
//!
//! For v = s(tau) a^(-beta), a = a_0 + a_1 psi, dpsi/dt = g_0 + g_1 psi - |v| psi, with b = a_1 psi / a(0) and
//!
//!   v = e+ - e-, z = e+ + e-, e+- = gamma0 e^(+-tau) a^(-beta) / 2,   T = dtau/dt, P = beta a'/a, q+- = +-T - P,
//!
//! four sums of products for both interfaces make the next coefficients:
//!
//!   k e_k = sum over j < k of e_j q_(k-1-j),
//!   k b_k = g_1 b_(k-1) - sum of b_j |v|_(k-1-j), and g_0 a_1 / a(0) for k = 1,
//!   P_k = beta (k+1) b_(k+1) - sum over j > 0 of b_j P_(k-j).
//!
//! No order waits for the newest terms of these: k v_k = z_0 T_(k-1) - v_0 P_(k-1) + T_0 z_(k-1) - P_0 v_(k-1) + older ones, where T
//! and P are linear in the newest v. So the sums of four orders are made at once, out of pairs of rows side by side: what is read of
//! memory is what limits them.

use super::series::{PairStep, allows, units};
use super::{Loading, stress_rate};
use crate::friction::AgeingForm;
use crate::series::{
    Accuracy, ByFormula, Element, Formula, Four, MAX_ORDER, ONE_OVER, Order, Pair, ROOM, Rates,
    Recurrences, Series, Stepper, WATCHED, avx512, value,
};
use pulp::x86::{V3, V4};
use std::cell::Cell;

/// Where |tau| is less, e+ and e- cancel, and series are made by the formula.
const NEAR: f64 = 0.5;
/// Orders whose sums are made at once.
const BLOCK: usize = 4;

/// Rows in the memory: the variables', and that of v.
const TAU: usize = 0;
const PSI: usize = 1;
const SLIP_RATE: usize = 2;

/// Two interfaces of such a law.
#[derive(Clone, Copy)]
pub(super) struct AgeingInterfaces {
    form: AgeingForm,
    driving: Pair,
    stiffness: Pair,
}

impl Formula<Pair, 2> for AgeingInterfaces {
    // |v| has a kink where v = 0, which is where tau = 0.
    const KINK: Option<usize> = Some(0);

    #[inline(always)]
    fn rates<'t, O: Order>(&self, [tau, psi]: [Series<'t, Pair, O>; 2]) -> Rates<'t, Pair, O, 2> {
        let v = self.form.slip_rate(tau, psi);
        let loading = (value(self.driving), value(self.stiffness));
        Rates {
            variables: [
                stress_rate(loading, v.over_interfaces()),
                self.form.evolution(v, psi),
            ],
            watched: [v; WATCHED],
        }
    }

    #[inline(always)]
    fn units(&self, x: &[Pair; 2], tolerances: (f64, f64)) -> [Pair; 2] {
        units(x, tolerances)
    }

    #[inline(always)]
    fn allows(&self, x: &[Pair; 2]) -> Pair {
        allows(x)
    }
}

/// A solution by them.
pub(super) struct AgeingSolution {
    pub simd: V3,
    /// Twice as many registers, where the processor has them.
    wide: Option<V4>,
    pub stepper: Stepper<Pair, AgeingInterfaces, 2>,
    recurrences: Box<AgeingRecurrences>,
}

impl AgeingSolution {
    /// To be started.
    pub fn new(form: AgeingForm, loading: &Loading, simd: V3) -> Self {
        let zero = Pair::new(simd, [0.0; 2]);
        let formula = AgeingInterfaces {
            form,
            driving: zero.like(loading.driving),
            stiffness: zero.like(loading.stiffness),
        };
        let nothing = [[zero.twice(); 2]; ROOM];
        AgeingSolution {
            simd,
            wide: avx512(),
            stepper: Stepper::new(formula, zero),
            recurrences: Box::new(AgeingRecurrences {
                left: nothing,
                right: nothing,
            }),
        }
    }

    /// The order with which it takes the least time for a relative tolerance.
    pub fn order(rtol: f64) -> usize {
        /// Tolerances above which lower orders win.
        const FROM: [(f64, usize); 3] = [(2e-6, 12), (4e-9, 16), (3e-11, 20)];
        let least = FROM.iter().find(|(above, _)| rtol > *above);
        least.map_or(MAX_ORDER, |(_, order)| *order)
    }

    /// [`crate::series::Solution::advance`].
    pub fn advance(&mut self, accuracy: &Accuracy, limit: f64) -> f64 {
        let step = PairStep {
            stepper: &mut self.stepper,
            recurrences: &mut *self.recurrences,
            accuracy,
            limit,
        };
        match self.wide {
            Some(wide) => wide.vectorize(step),
            None => self.simd.vectorize(step),
        }
    }
}

/// The series that the sums are made of. In a register stand both interfaces, each with two lanes.
struct AgeingRecurrences {
    /// e_j, and b_(j+1): (e+, e-), (b, b).
    left: [[Four; 2]; ROOM],
    /// q_j, and v_j with P_j: (q+, q-), (-|v|, -P) in the unit of time. The first ones are 0, their products are not in the sums.
    right: [[Four; 2]; ROOM],
}

impl Recurrences<Pair, AgeingInterfaces, 2> for AgeingRecurrences {
    #[inline(always)]
    fn make(
        &mut self,
        formula: &AgeingInterfaces,
        memory: &[Cell<Pair>],
        order: usize,
        unit: Pair,
    ) -> [Option<usize>; WATCHED] {
        let tau = memory[TAU * ROOM].get();
        let far = (tau.abs() - tau.like(NEAR)).none_negative();
        if far && order.is_multiple_of(BLOCK) && self.expand(formula, memory, order, unit) {
            return [Some(SLIP_RATE); WATCHED];
        }
        ByFormula.make(formula, memory, order, unit)
    }
}

/// a + b
#[inline(always)]
fn plus(a: [Four; 2], b: [Four; 2]) -> [Four; 2] {
    [a[0] + b[0], a[1] + b[1]]
}

/// sum + a b
#[inline(always)]
fn add(sum: &mut [Four; 2], a: [Four; 2], b: [Four; 2]) {
    sum[0] = a[0].mul_add(b[0], sum[0]);
    sum[1] = a[1].mul_add(b[1], sum[1]);
}

impl AgeingRecurrences {
    /// The series to this order, a multiple of four; false where the first coefficients are no ordinary numbers.
    #[inline(always)]
    fn expand(
        &mut self,
        formula: &AgeingInterfaces,
        memory: &[Cell<Pair>],
        order: usize,
        unit: Pair,
    ) -> bool {
        let AgeingRecurrences { left, right } = self;
        let AgeingInterfaces {
            form,
            driving,
            stiffness,
        } = formula;
        let (tau, psi) = (memory[TAU * ROOM].get(), memory[PSI * ROOM].get());
        let a = psi.mul_add(psi.like(form.strength[1]), psi.like(form.strength[0]));
        let per_psi = (psi.like(form.strength[1]) / a).twice();
        let Some(e) = a.power_and_exponentials(-form.beta, tau) else {
            return false;
        };
        let number = |x: f64| e.like(x);
        let half = 0.5 * form.gamma0;
        let below = if form.exponential { 0.0 } else { half };
        let e = e * e.like_lanes([half, below, half, below]);
        let opposite = e.like_lanes([1.0, -1.0, 1.0, -1.0]);
        let (v, z) = ((e - e.swapped()) * opposite, e + e.swapped());
        let unit = unit.twice();
        let b = per_psi * psi.twice();
        let beta = number(form.beta);
        let sliding = -(v.sign() * unit);
        let by_state = number(form.healing[1]).mul_add(unit, sliding * v);
        let pull = -(stiffness.twice() * unit);
        let healing = number(form.healing[0]) * per_psi * unit;
        let rate = by_state.mul_add(b, healing);
        let p = rate * beta;
        let sum = v + v.crossed() - driving.twice();
        let t = sum * pull;
        let q = t.mul_add(opposite, -p);
        let level = Level {
            e,
            q,
            v,
            z,
            t,
            p,
            pull,
            v_by_sum: pull * z,
            z_by_sum: pull * v,
            by_state,
            by_slip: sliding * b,
            beta,
            p_by_state: by_state.mul_add(beta, -p),
            p_by_slip: beta * sliding * b,
            b_1: rate,
            slip_1: rate * sliding,
            opposite,
            scales: sliding.beside(number(-1.0)),
            psi_per_b: (a / a.like(form.strength[1])).twice(),
        };
        // In memory, and so the stack is aligned, and no register is spilled across lines of the cache.
        let level = std::hint::black_box(&level);
        memory[SLIP_RATE * ROOM].set(v.once());
        memory[TAU * ROOM + 1].set(t.once());
        memory[PSI * ROOM + 1].set((rate * level.psi_per_b).once());
        left[0][1] = rate;
        let first = Newest {
            v,
            z,
            sum,
            p,
            q,
            e,
            b: rate,
        };
        let nothing = [number(0.0); 2];
        let last = level.next::<true>(left, right, memory, 1, &first, nothing);
        let last = level.next::<false>(left, right, memory, 2, &last, nothing);
        let mut sums = nothing;
        add(&mut sums, left[1], right[1]);
        let mut last = level.next::<false>(left, right, memory, 3, &last, sums);
        let mut k = BLOCK;
        while k < order {
            let mut sums = [nothing; BLOCK];
            let windows = right[..k].windows(BLOCK).rev();
            for (left, right) in left[3..k].iter().zip(windows) {
                for (sum, right) in sums.iter_mut().zip(right) {
                    add(sum, *left, *right);
                }
            }
            // With the newest of before.
            let (near, next) = (left[1], left[2]);
            add(&mut sums[2], next, right[k - 1]);
            add(&mut sums[1], next, right[k - 2]);
            add(&mut sums[0], next, right[k - 3]);
            add(&mut sums[1], near, right[k - 1]);
            add(&mut sums[0], near, right[k - 2]);
            last = level.next::<false>(left, right, memory, k, &last, sums[0]);
            last = level.next::<false>(left, right, memory, k + 1, &last, sums[1]);
            add(&mut sums[2], near, right[k]);
            add(&mut sums[2], left[k], right[1]);
            last = level.next::<false>(left, right, memory, k + 2, &last, sums[2]);
            let mut newest = nothing;
            add(&mut newest, next, right[k]);
            add(&mut newest, left[k], right[2]);
            add(&mut sums[3], near, right[k + 1]);
            add(&mut sums[3], left[k + 1], right[1]);
            last = level.next::<false>(left, right, memory, k + 3, &last, plus(sums[3], newest));
            k += BLOCK;
        }
        true
    }
}

/// The newest coefficients.
#[derive(Clone, Copy)]
struct Newest {
    v: Four,
    z: Four,
    /// Of the slip rates of both interfaces, less V_H.
    sum: Four,
    p: Four,
    q: Four,
    e: Four,
    /// The next one.
    b: Four,
}

/// What all orders take: the first coefficients and products of them.
#[repr(align(64))]
struct Level {
    e: Four,
    q: Four,
    v: Four,
    z: Four,
    t: Four,
    p: Four,
    pull: Four,
    v_by_sum: Four,
    z_by_sum: Four,
    by_state: Four,
    by_slip: Four,
    beta: Four,
    p_by_state: Four,
    p_by_slip: Four,
    b_1: Four,
    slip_1: Four,
    /// (1, -1)
    opposite: Four,
    /// (-sign v, -1), the first in the unit of time.
    scales: Four,
    psi_per_b: Four,
}

impl Level {
    /// The coefficients of order k, from those before. What comes last is multiplied last.
    #[inline(always)]
    fn next<const FIRST: bool>(
        &self,
        left: &mut [[Four; 2]; ROOM],
        right: &mut [[Four; 2]; ROOM],
        memory: &[Cell<Pair>],
        k: usize,
        last: &Newest,
        sums: [Four; 2],
    ) -> Newest {
        let over = self.e.like(ONE_OVER[k]);
        let over_next = self.e.like(ONE_OVER[k + 1]);
        let by_p = -last.p;
        let (v_by_sum, z_by_sum) = (self.v_by_sum * over, self.z_by_sum * over);
        let (v_0, z_0) = (self.v * over, self.z * over);
        let (v, z, e) = if FIRST {
            let v = last.sum.mul_add(v_by_sum, by_p * v_0);
            let z = last.sum.mul_add(z_by_sum, by_p * z_0);
            (v, z, self.e * last.q)
        } else {
            let (t_0, p_0) = (self.t * over, self.p * over);
            let swapped = sums[0].swapped();
            let (less, more) = (sums[0] - swapped, sums[0] + swapped);
            let v_known = less.mul_add(self.opposite * over, last.z * t_0);
            let z_known = more.mul_add(over, last.v * t_0);
            let v_known = by_p.mul_add(v_0, v_known);
            let z_known = by_p.mul_add(z_0, z_known);
            let v_new = last.sum.mul_add(v_by_sum, -(last.v * p_0));
            let z_new = last.sum.mul_add(z_by_sum, -(last.z * p_0));
            let e = self.e.mul_add(last.q, last.e.mul_add(self.q, sums[0]));
            (v_new + v_known, z_new + z_known, e)
        };
        let e = e * over;
        let sum = v + v.crossed();
        let t = sum * self.pull;
        let (rate_known, p_known) = if FIRST {
            (last.b * self.by_state, last.b * self.p_by_state)
        } else {
            let slip = last.v.mul_add(self.slip_1, sums[1].firsts());
            let p_known = slip.mul_add(self.beta, sums[1].seconds());
            let p_known = last.b.mul_add(self.p_by_state, p_known);
            (
                last.b.mul_add(self.by_state, slip),
                by_p.mul_add(self.b_1, p_known),
            )
        };
        let p = v.mul_add(self.p_by_slip, p_known);
        let rate = v.mul_add(self.by_slip, rate_known);
        let q = t.mul_add(self.opposite, -p);
        let b = rate * over_next;
        right[k] = [q, v.beside(p) * self.scales];
        left[k] = [e, b];
        memory[SLIP_RATE * ROOM + k].set(v.once());
        memory[TAU * ROOM + k + 1].set((t * over_next).once());
        memory[PSI * ROOM + k + 1].set((b * self.psi_per_b).once());
        Newest {
            v,
            z,
            sum,
            p,
            q,
            e,
            b,
        }
    }
}
