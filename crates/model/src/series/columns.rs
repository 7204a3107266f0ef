//! Variational equations: solutions of the equations linearised along a solution, in power series.
//!
//! With the Jacobian's entries as series along the solution the linearised equations need one product of series for each
//! entry, and their solutions, the columns, share it: they stand in lanes. The sums run in loops, as there the work is in the
//! lanes.

use super::element::{Element, rough_exp2, rough_log2};
use super::plain::Both;
use super::{Accuracy, REFERENCE_ORDER};

/// What one interface's coefficients give to all lanes of X.
pub trait Spread<X>: Element {
    /// The coefficient of an interface, in every lane.
    fn spread(self, interface: usize, any: X) -> X;
}

impl<T: Element> Spread<Both<Both<T>>> for Both<T> {
    #[inline(always)]
    fn spread(self, interface: usize, _: Both<Both<T>>) -> Both<Both<T>> {
        let x = self.0[interface];
        Both([Both([x, x]); 2])
    }
}

impl<T: Element> Spread<Both<Both<Both<T>>>> for Both<T> {
    #[inline(always)]
    fn spread(self, interface: usize, any: Both<Both<Both<T>>>) -> Both<Both<Both<T>>> {
        Both([self.spread(interface, any.0[0]); 2])
    }
}

/// The series along a solution that its linearised equations need; the lanes of E are the interfaces.
pub struct JacobianSeries<'a, E> {
    /// dv/dtau, dv/dpsi, dg/dtau, dg/dpsi of v and dpsi/dt = g.
    pub entries: [&'a [E]; 4],
    /// tau itself.
    pub stress: &'a [E],
    /// K.
    pub stiffness: E,
    /// The unit of time.
    pub unit: E,
}

/// The columns, in the lanes of X, each a perturbation of (tau, psi_1, psi_2).
pub struct VariationalEquations<X> {
    /// At the beginning of the next step.
    x: [X; 3],
    /// The series, in the order of the powers.
    series: Box<[[X; 3]; REFERENCE_ORDER + 1]>,
    /// One in the lane of the derivative in V_H, and in that in K; zero elsewhere.
    driving: X,
    stiffness: X,
}

impl<X: Element> VariationalEquations<X> {
    /// Beginning at x, of which one lane each may be the derivative in V_H and in K.
    pub fn new(x: [X; 3], driving: X, stiffness: X) -> Self {
        VariationalEquations {
            x,
            series: Box::new([x; REFERENCE_ORDER + 1]),
            driving,
            stiffness,
        }
    }

    /// The same anew, beginning at x.
    pub fn restart(&mut self, x: [X; 3], driving: X, stiffness: X) {
        (self.x, self.driving, self.stiffness) = (x, driving, stiffness);
    }

    /// The columns at the end of the last step.
    pub fn state(&self) -> &[X; 3] {
        &self.x
    }

    /// Makes the series from those of the solution:
    ///
    ///   dtau' = K (dV_H - dv_1 - dv_2) + dK tau'/K,  dpsi_i' = dg_i.
    #[inline(always)]
    pub fn expand<E: Spread<X>>(&mut self, order: usize, along: &JacobianSeries<'_, E>) {
        let any = self.x[0];
        let zero = any.like(0.0);
        let [v_tau, v_psi, g_tau, g_psi] = along.entries.map(|entry| &entry[..order]);
        let (stiffness, unit) = (along.stiffness.spread(0, any), along.unit.spread(0, any));
        let of_stiffness = self.stiffness / stiffness;
        let pull = -(stiffness * unit);
        self.series[0] = self.x;
        let mut k = 0;
        while k < order {
            // One sum for each entry of the Jacobian: they do not wait for each other.
            let mut sums = [zero; 7];
            let mut j = 0;
            let columns = &self.series[..=k];
            while j <= k {
                let [tau, psi1, psi2] = columns[k - j];
                let both = v_tau[j].over_interfaces();
                sums[0] = both.spread(0, any).mul_add(tau, sums[0]);
                sums[1] = v_psi[j].spread(0, any).mul_add(psi1, sums[1]);
                sums[2] = v_psi[j].spread(1, any).mul_add(psi2, sums[2]);
                sums[3] = g_tau[j].spread(0, any).mul_add(tau, sums[3]);
                sums[4] = g_psi[j].spread(0, any).mul_add(psi1, sums[4]);
                sums[5] = g_tau[j].spread(1, any).mul_add(tau, sums[5]);
                sums[6] = g_psi[j].spread(1, any).mul_add(psi2, sums[6]);
                j += 1;
            }
            let one_over = any.like(1.0) / any.like((k + 1) as f64);
            let mut slip_rate = sums[0] + (sums[1] + sums[2]);
            if k == 0 {
                slip_rate = slip_rate - self.driving;
            }
            // The series of tau holds tau' = K (V_H - v_1 - v_2) already.
            let stress = along.stress[k + 1].spread(0, any) * of_stiffness;
            let share = unit * one_over;
            self.series[k + 1] = [
                slip_rate.mul_add(pull * one_over, stress),
                (sums[3] + sums[4]) * share,
                (sums[5] + sums[6]) * share,
            ];
            k += 1;
        }
    }

    /// The step, in units of the series and at most `most`, at which the last two terms of every column are below the
    /// tolerance, relative to the column at the step's beginning; psi counts by its logarithm.
    #[inline(always)]
    pub fn longest<E: Spread<X>>(&self, accuracy: &Accuracy, psi: E, most: f64) -> f64 {
        /// Columns are not as small.
        const NOTHING: f64 = 1e-250;
        let order = accuracy.order;
        let any = self.x[0];
        let one = any.like(1.0);
        let of_psi = [one / psi.spread(0, any), one / psi.spread(1, any)];
        // Derivatives in parameters begin at zero.
        let begins = size(&self.series[0], of_psi);
        let grows = size(&self.series[1], of_psi) * any.like(most);
        let largest = Element::max(begins.if_zero(grows, begins), any.like(NOTHING));
        let per_tolerable = one / (largest * any.like(accuracy.tolerances.0));
        let before = size(&self.series[order - 1], of_psi) * per_tolerable;
        let last = size(&self.series[order], of_psi) * per_tolerable;
        let before = -rough_log2(before.largest_lane()) / (order - 1) as f64;
        let last = -rough_log2(last.largest_lane()) / order as f64;
        rough_exp2(before.min(last))
    }

    /// Goes on by h, counted in units of the series.
    #[inline(always)]
    pub fn advance_by<E: Spread<X>>(&mut self, order: usize, h: E) {
        let h = h.spread(0, self.x[0]);
        let mut sum = self.series[order];
        let mut k = order;
        while k > 0 {
            k -= 1;
            let mut i = 0;
            while i < 3 {
                sum[i] = sum[i].mul_add(h, self.series[k][i]);
                i += 1;
            }
        }
        self.x = sum;
    }
}

/// The largest of a column: of tau, and of psi by its logarithm.
#[inline(always)]
fn size<X: Element>(x: &[X; 3], per_psi: [X; 2]) -> X {
    let states = Element::max((x[1] * per_psi[0]).abs(), (x[2] * per_psi[1]).abs());
    Element::max(x[0].abs(), states)
}
