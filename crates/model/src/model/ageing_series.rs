//! Series of two interfaces of laws that are powers of a linear strength and whose state ages, by recurrences of their own: an
//! optimisation. The laws' recorded formulas serve for everything else and near tau = 0, and tests hold this to them.
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
//! For the linearised equations of (tau, psi/psi(0)) two more come with them, z psi and u = v a(0)/a:
//!
//!   y_k = sum of b_j z_(k-j),   u_k = v_k - sum over j > 0 of b_j u_(k-j).
//!
//! No order waits for the newest terms of these: k v_k = z_0 T_(k-1) - v_0 P_(k-1) + T_0 z_(k-1) - P_0 v_(k-1) + older ones, where T
//! and P are linear in the newest v. So the sums of four orders are made at once, out of pairs of rows side by side: what is read of
//! memory is what limits them.

use super::in_states::InStates;
use super::series::{Interfaces, PSI, SLIP_RATE, Slopes as FormulaSlopes, TAU, order};
use super::tangent::Linearised;
use crate::series::{
    Element, Four, JacobianTerm, KeptFormula, ONE_OVER, Pair, ROOM, Recurrences, avx512,
};
use pulp::x86::{V3, V4};
use std::cell::Cell;

/// Where |tau| is less, e+ and e- cancel, and series are made by the formula.
pub(super) const NEAR: f64 = 0.5;
/// Orders whose sums are made at once.
const BLOCK: usize = 4;

/// The vector instructions of this processor.
#[derive(Clone, Copy)]
pub(super) struct Best {
    simd: V3,
    /// Twice as many registers, where the processor has them.
    wide: Option<V4>,
}

impl Best {
    pub fn new(simd: V3) -> Self {
        let wide = avx512();
        Best { simd, wide }
    }

    pub fn wide(self) -> Option<V4> {
        self.wide
    }

    #[inline(always)]
    pub fn vectorize<F: pulp::NullaryFnOnce>(self, f: F) -> F::Output {
        match self.wide {
            Some(wide) => wide.vectorize(f),
            None => self.simd.vectorize(f),
        }
    }
}

/// The series that the sums are made of. In a register stand both interfaces, each with two lanes.
pub(super) struct AgeingRecurrences<const LINEARISED: bool> {
    /// e_j, and b_(j+1): (e+, e-), (b, b).
    left: [[Four; 2]; ROOM],
    /// q_j, v_j with P_j, and z_j with u_j: (q+, q-), (-|v|, -P) in the unit of time, (z, u). The first ones are 0, their products are
    /// not in the sums.
    right: [Right; ROOM],
    /// The first ones of the last two.
    first: [Four; 2],
    /// The Jacobian along the series made last.
    jacobian: [JacobianTerm; ROOM],
    /// The formula, once it was needed.
    formula: Option<KeptFormula>,
}

/// Coefficients of one interface.
pub(super) struct InterfaceTerm {
    /// |v| in the unit of time.
    pub slip_rate: f64,
    /// P
    pub strengthening: f64,
    /// z, with the sign of v: d|v|/dtau.
    pub by_stress: f64,
    /// |u|
    pub over_strength: f64,
}

type Right = [Four; 3];

impl<const LINEARISED: bool> AgeingRecurrences<LINEARISED> {
    pub fn new(simd: V3) -> Self {
        let zero = Four::new(simd, [0.0; 4]);
        AgeingRecurrences {
            left: [[zero; 2]; ROOM],
            right: [[zero; 3]; ROOM],
            first: [zero; 2],
            jacobian: [JacobianTerm::ZERO; ROOM],
            formula: None,
        }
    }
}

impl Linearised for AgeingRecurrences<true> {
    fn order(rtol: f64) -> usize {
        order(rtol)
    }

    fn jacobian(&self) -> &[JacobianTerm] {
        &self.jacobian
    }
}

impl AgeingRecurrences<true> {
    /// The k-th coefficients of the i-th interface.
    #[inline(always)]
    pub fn interface(&self, i: usize, k: usize) -> InterfaceTerm {
        let [rates, slopes] = match k {
            0 => self.first,
            _ => [self.right[k][1], self.right[k][2]],
        };
        let (rates, slopes) = (rates.lanes(), slopes.lanes());
        let sign = 1_f64.copysign(self.first[1].lane(2 * i + 1));
        InterfaceTerm {
            slip_rate: -rates[2 * i],
            strengthening: -rates[2 * i + 1],
            by_stress: sign * slopes[2 * i],
            over_strength: sign * slopes[2 * i + 1],
        }
    }
}

impl<const LINEARISED: bool> Recurrences<Pair, Interfaces, 2> for AgeingRecurrences<LINEARISED> {
    #[inline(always)]
    fn make(&mut self, formula: &Interfaces, memory: &[Cell<Pair>], order: usize, unit: Pair) {
        let tau = memory[TAU * ROOM].get();
        let far = (tau.abs() - tau.like(NEAR)).none_negative();
        let holds = far && order.is_multiple_of(BLOCK);
        if !(holds && self.expand(formula, memory, order, unit)) {
            self.expand_by_formula(formula, memory, order, unit);
        }
    }
}

/// a + b
#[inline(always)]
fn plus(a: Right, b: Right) -> Right {
    [a[0] + b[0], a[1] + b[1], a[2] + b[2]]
}

impl<const LINEARISED: bool> AgeingRecurrences<LINEARISED> {
    /// The series by the recorded formula, which holds for all states.
    #[cold]
    #[inline(never)]
    fn expand_by_formula(
        &mut self,
        interfaces: &Interfaces,
        memory: &[Cell<Pair>],
        order: usize,
        unit: Pair,
    ) {
        let record = || KeptFormula::new(InStates(interfaces.law), LINEARISED);
        let mut made = self.formula.take().unwrap_or_else(record);
        made.make(interfaces, memory, order, unit);
        if LINEARISED {
            self.take(&made, interfaces, (order, unit.first()));
        }
        self.formula = Some(made);
    }

    /// The Jacobian, and the series that [`AgeingRecurrences::interface`] tells of, from the formula's derivatives.
    fn take(&mut self, made: &KeptFormula, formula: &Interfaces, (order, unit): (usize, f64)) {
        let law = &formula.law.ageing;
        let psi = [0, 1].map(|i| made.variable(1 + i));
        let begin = psi.map(|psi| psi[0]);
        let any = self.first[0];
        let mut p = [[0.0; ROOM]; 2];
        for k in 0..order {
            let slopes = FormulaSlopes::of(made, k);
            self.jacobian[k] = slopes.jacobian(begin, formula.stiffness.first(), unit);
            let of_interface = |i: usize| {
                let strength = |j: usize| psi[i][j] * law.strength[1];
                let first = strength(0) + law.strength[0];
                // P a = beta a'
                let of_strength = strength(k + 1) * law.beta * (k + 1) as f64;
                let older = (1..=k).map(|j| strength(j) * p[i][k - j]);
                let p = (of_strength - older.sum::<f64>()) / first;
                // dv/dpsi = -beta a_1 v/a
                let u = slopes.v_psi[i] * first / -(law.beta * law.strength[1]);
                let sliding = -(Element::sign(made.other(i, 0)) * unit);
                ([slopes.v[i] * sliding, -p], [slopes.v_tau[i], u])
            };
            let [(one, of_one), (other, of_other)] = [0, 1].map(of_interface);
            (p[0][k], p[1][k]) = (-one[1], -other[1]);
            let rates = any.like_lanes([one[0], one[1], other[0], other[1]]);
            let slopes = any.like_lanes([of_one[0], of_one[1], of_other[0], of_other[1]]);
            match k {
                0 => self.first = [rates, slopes],
                _ => [self.right[k][1], self.right[k][2]] = [rates, slopes],
            }
        }
    }

    /// sum + a b
    #[inline(always)]
    fn add(sum: &mut Right, a: [Four; 2], b: Right) {
        sum[0] = a[0].mul_add(b[0], sum[0]);
        sum[1] = a[1].mul_add(b[1], sum[1]);
        if LINEARISED {
            sum[2] = a[1].mul_add(b[2], sum[2]);
        }
    }

    /// The series to this order, a multiple of four; false where the first coefficients are no ordinary numbers.
    #[inline(always)]
    fn expand(
        &mut self,
        formula: &Interfaces,
        memory: &[Cell<Pair>],
        order: usize,
        unit: Pair,
    ) -> bool {
        let Interfaces {
            law,
            driving,
            stiffness,
        } = formula;
        let form = &law.ageing;
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
        memory[SLIP_RATE * ROOM].set(v.once());
        memory[TAU * ROOM + 1].set(t.once());
        memory[PSI * ROOM + 1].set((rate * level.psi_per_b).once());
        self.left[0][1] = rate;
        let first = Newest {
            u: v,
            v,
            z,
            sum,
            p,
            q,
            e,
            b: rate,
        };
        let nothing = [number(0.0); 3];
        let slopes = if LINEARISED {
            let over_b = number(1.0) / b;
            let kept = (a.like(form.strength[0]) / a).twice();
            let slopes = Slopes {
                by_state: -(beta * b) * pull,
                by_stress: sliding * over_b,
                by_v: sliding * (number(1.0) - beta),
                by_u: sliding * beta * kept,
                b,
            };
            let healed = number(form.healing[1]) * unit;
            self.first = [v.beside(p) * level.scales, z.beside(v)];
            self.jacobian[0] = slopes.term(pull, (v, z), b * z, v, healed);
            slopes
        } else {
            Slopes::of(number(0.0))
        };
        // In memory, and so the stack is aligned, and no register is spilled across lines of the cache.
        let level = std::hint::black_box(&level);
        let known = (level, &slopes);
        let last = self.next::<true>(known, memory, 1, &first, nothing);
        let last = self.next::<false>(known, memory, 2, &last, nothing);
        let mut sums = nothing;
        Self::add(&mut sums, self.left[1], self.right[1]);
        let mut last = self.next::<false>(known, memory, 3, &last, sums);
        let mut k = BLOCK;
        while k < order {
            let mut sums = [nothing; BLOCK];
            let windows = self.right[..k].windows(BLOCK).rev();
            for (left, right) in self.left[3..k].iter().zip(windows) {
                for (sum, right) in sums.iter_mut().zip(right) {
                    Self::add(sum, *left, *right);
                }
            }
            // With the newest of before.
            let (near, next) = (self.left[1], self.left[2]);
            Self::add(&mut sums[2], next, self.right[k - 1]);
            Self::add(&mut sums[1], next, self.right[k - 2]);
            Self::add(&mut sums[0], next, self.right[k - 3]);
            Self::add(&mut sums[1], near, self.right[k - 1]);
            Self::add(&mut sums[0], near, self.right[k - 2]);
            last = self.next::<false>(known, memory, k, &last, sums[0]);
            last = self.next::<false>(known, memory, k + 1, &last, sums[1]);
            Self::add(&mut sums[2], near, self.right[k]);
            Self::add(&mut sums[2], self.left[k], self.right[1]);
            last = self.next::<false>(known, memory, k + 2, &last, sums[2]);
            let mut newest = nothing;
            Self::add(&mut newest, next, self.right[k]);
            Self::add(&mut newest, self.left[k], self.right[2]);
            Self::add(&mut sums[3], near, self.right[k + 1]);
            Self::add(&mut sums[3], self.left[k + 1], self.right[1]);
            last = self.next::<false>(known, memory, k + 3, &last, plus(sums[3], newest));
            k += BLOCK;
        }
        true
    }

    /// The coefficients of order k, from those before. What comes last is multiplied last.
    #[inline(always)]
    fn next<const FIRST: bool>(
        &mut self,
        (level, slopes): (&Level, &Slopes),
        memory: &[Cell<Pair>],
        k: usize,
        last: &Newest,
        sums: Right,
    ) -> Newest {
        let over = level.e.like(ONE_OVER[k]);
        let over_next = level.e.like(ONE_OVER[k + 1]);
        let by_p = -last.p;
        let (v_by_sum, z_by_sum) = (level.v_by_sum * over, level.z_by_sum * over);
        let (v_0, z_0) = (level.v * over, level.z * over);
        let (v, z, e) = if FIRST {
            let v = last.sum.mul_add(v_by_sum, by_p * v_0);
            let z = last.sum.mul_add(z_by_sum, by_p * z_0);
            (v, z, level.e * last.q)
        } else {
            let (t_0, p_0) = (level.t * over, level.p * over);
            let swapped = sums[0].swapped();
            let (less, more) = (sums[0] - swapped, sums[0] + swapped);
            let v_known = less.mul_add(level.opposite * over, last.z * t_0);
            let z_known = more.mul_add(over, last.v * t_0);
            let v_known = by_p.mul_add(v_0, v_known);
            let z_known = by_p.mul_add(z_0, z_known);
            let v_new = last.sum.mul_add(v_by_sum, -(last.v * p_0));
            let z_new = last.sum.mul_add(z_by_sum, -(last.z * p_0));
            let e = level.e.mul_add(last.q, last.e.mul_add(level.q, sums[0]));
            (v_new + v_known, z_new + z_known, e)
        };
        let e = e * over;
        let sum = v + v.crossed();
        let t = sum * level.pull;
        let (rate_known, p_known) = if FIRST {
            (last.b * level.by_state, last.b * level.p_by_state)
        } else {
            let slip = last.v.mul_add(level.slip_1, sums[1].firsts());
            let p_known = slip.mul_add(level.beta, sums[1].seconds());
            let p_known = last.b.mul_add(level.p_by_state, p_known);
            (
                last.b.mul_add(level.by_state, slip),
                by_p.mul_add(level.b_1, p_known),
            )
        };
        let p = v.mul_add(level.p_by_slip, p_known);
        let rate = v.mul_add(level.by_slip, rate_known);
        let q = t.mul_add(level.opposite, -p);
        let b = rate * over_next;
        self.right[k][0] = q;
        self.right[k][1] = v.beside(p) * level.scales;
        self.left[k] = [e, b];
        memory[SLIP_RATE * ROOM + k].set(v.once());
        memory[TAU * ROOM + k + 1].set((t * over_next).once());
        memory[PSI * ROOM + k + 1].set((b * level.psi_per_b).once());
        let mut u = v;
        if LINEARISED {
            // b_k z_0 and b_1 z_(k-1) are one for k = 1, and so of u.
            let mut y = last.b.mul_add(level.z, slopes.b * z);
            u = v - last.b * level.v;
            if !FIRST {
                y = y + last.z.mul_add(level.b_1, sums[2].firsts());
                u = u - last.u.mul_add(level.b_1, sums[2].seconds());
            }
            self.right[k][2] = z.beside(u);
            self.jacobian[k] = slopes.term(level.pull, (v, z), y, u, e.like(0.0));
        }
        Newest {
            u,
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

/// The newest coefficients.
#[derive(Clone, Copy)]
struct Newest {
    u: Four,
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

/// The first coefficients that the Jacobian takes.
#[repr(align(64))]
struct Slopes {
    /// Of tau' in psi/psi(0), by u.
    by_state: Four,
    /// Of psi'/psi(0): in tau by y, in psi/psi(0) by v and by u.
    by_stress: Four,
    by_v: Four,
    by_u: Four,
    b: Four,
}

impl Slopes {
    #[inline(always)]
    fn of(x: Four) -> Self {
        Slopes {
            by_state: x,
            by_stress: x,
            by_v: x,
            by_u: x,
            b: x,
        }
    }

    /// A coefficient of the Jacobian.
    #[inline(always)]
    fn term(
        &self,
        pull: Four,
        (v, z): (Four, Four),
        y: Four,
        u: Four,
        healed: Four,
    ) -> JacobianTerm {
        let by_stress = (z + z.crossed()) * pull;
        let by_state = u.mul_add(self.by_u, v.mul_add(self.by_v, healed));
        JacobianTerm {
            stress: halves(by_stress.beside(u * self.by_state)),
            states: halves((y * self.by_stress).beside(by_state)),
        }
    }
}

#[inline(always)]
fn halves(x: Four) -> [[f64; 2]; 2] {
    let [a, b, c, d] = x.lanes();
    [[a, b], [c, d]]
}
