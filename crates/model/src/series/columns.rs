//! Variational equations: solutions of the equations linearised along a solution, in power series.
//!
//! With the Jacobian's entries as series along the solution the linearised equations need one product of series for each
//! entry, and their solutions, the columns, share it: they stand in lanes.

use super::element::Element;
use super::linearised::last_terms;
use super::{Accuracy, MAX_ORDER, ONE_OVER};

/// Orders whose sums are made at once, out of one read of the columns.
const BLOCK: usize = 4;

/// One coefficient of the Jacobian's entries along a solution of (tau, psi_1, psi_2) in the unit of time, the states counted in their
/// sizes at the beginning of the step, x_i = psi_i/psi_i(0); or of three variables in general, of which the rate of the last does
/// not depend on the one before it.
#[derive(Debug, Clone, Copy)]
#[repr(C, align(64))]
pub struct JacobianTerm {
    /// Of tau', for each interface: in tau, the same for both, and in x_i. Where x_1' depends on x_2, that stands in the place of the
    /// second of what is the same.
    pub stress: [[f64; 2]; 2],
    /// Of x_i': in tau, and in x_i.
    pub states: [[f64; 2]; 2],
}

impl JacobianTerm {
    pub const ZERO: JacobianTerm = JacobianTerm {
        stress: [[0.0; 2]; 2],
        states: [[0.0; 2]; 2],
    };
}

/// The series along a solution that its linearised equations need.
pub struct Along<'a, E> {
    pub jacobian: &'a [JacobianTerm],
    /// tau itself.
    pub stress: &'a [E],
    /// K.
    pub stiffness: f64,
    /// The unit of time.
    pub unit: f64,
}

/// Columns in the lanes of X, each a perturbation of (tau, ln psi_1, ln psi_2); or of others, where COUPLED: then the rate of the
/// second depends on the third too.
pub struct VariationalEquations<X, const COUPLED: bool = false> {
    /// At the beginning of the next step.
    x: [X; 3],
    /// The series, in the order of the powers.
    series: Box<[[X; 3]; MAX_ORDER + 1]>,
    /// One in the lane of the derivative in V_H, and in that in K; zero elsewhere.
    driving: X,
    stiffness: X,
}

impl<X: Element, const COUPLED: bool> VariationalEquations<X, COUPLED> {
    /// Beginning at x, of which one lane each may be the derivative in V_H and in K.
    pub fn new(x: [X; 3], driving: X, stiffness: X) -> Self {
        VariationalEquations {
            x,
            series: Box::new([x; MAX_ORDER + 1]),
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
    ///   dtau' = K (dV_H - dv_1 - dv_2) + dK tau'/K,  dx_i' = dg_i/psi_i(0).
    #[inline(always)]
    pub fn expand<E: Element>(&mut self, order: usize, along: &Along<'_, E>) {
        let any = self.x[0];
        let nothing = [any.like(0.0); 3];
        let jacobian = along.jacobian;
        // In V_H: in the first rate alone. In K: the series of tau holds tau' = K (V_H - v_1 - v_2) already.
        let loading = (
            self.driving * any.like(along.stiffness * along.unit),
            self.stiffness / any.like(along.stiffness),
        );
        self.series[0] = self.x;
        let mut k = 0;
        while k < order % BLOCK {
            let mut sum = nothing;
            let terms = jacobian[..=k].iter().rev();
            for (x, term) in self.series[..=k].iter().zip(terms) {
                add::<X, COUPLED>(&mut sum, term, x);
            }
            self.series[k + 1] = next(k, sum, along.stress, loading);
            k += 1;
        }
        while k < order {
            let mut sums = [nothing; BLOCK];
            let windows = jacobian[..k + BLOCK].windows(BLOCK).rev();
            for (x, terms) in self.series[..=k].iter().zip(windows) {
                for (sum, term) in sums.iter_mut().zip(terms) {
                    add::<X, COUPLED>(sum, term, x);
                }
            }
            let mut m = 0;
            while m < BLOCK {
                let x = next(k + m, sums[m], along.stress, loading);
                self.series[k + m + 1] = x;
                let mut later = m + 1;
                while later < BLOCK {
                    add::<X, COUPLED>(&mut sums[later], &jacobian[later - m - 1], &x);
                    later += 1;
                }
                m += 1;
            }
            k += BLOCK;
        }
    }

    /// The largest of the last two terms, in what may err relative to the column at the step's beginning.
    #[inline(always)]
    pub fn last_terms(&self, accuracy: &Accuracy, most: f64) -> [f64; 2] {
        let order = accuracy.order;
        let sizes = [
            size(&self.series[0]),
            size(&self.series[1]),
            size(&self.series[order - 1]),
            size(&self.series[order]),
        ];
        last_terms(accuracy, most, sizes)
    }

    /// Goes on by h, counted in units of the series, where the states are as many times what they were.
    #[inline(always)]
    pub fn advance_by(&mut self, order: usize, h: f64, growth: [f64; 2]) {
        let any = self.x[0];
        let (h, squared) = (any.like(h), any.like(h * h));
        // Even and odd terms apart: two short chains instead of a long one. All orders are even.
        let (mut even, mut odd) = (self.series[order], self.series[order - 1]);
        let mut k = order - 2;
        while k > 0 {
            add_to(&mut even, squared, &self.series[k]);
            add_to(&mut odd, squared, &self.series[k - 1]);
            k -= 2;
        }
        add_to(&mut even, squared, &self.series[0]);
        add_to(&mut odd, h, &even);
        let [tau, first, second] = odd;
        self.x = [
            tau,
            first / any.like(growth[0]),
            second / any.like(growth[1]),
        ];
    }
}

/// sum h + x, in place of the sum.
#[inline(always)]
fn add_to<X: Element>(sum: &mut [X; 3], h: X, x: &[X; 3]) {
    sum[0] = sum[0].mul_add(h, x[0]);
    sum[1] = sum[1].mul_add(h, x[1]);
    sum[2] = sum[2].mul_add(h, x[2]);
}

/// Adds a term's product with a column.
#[inline(always)]
fn add<X: Element, const COUPLED: bool>(
    sum: &mut [X; 3],
    term: &JacobianTerm,
    &[tau, first, second]: &[X; 3],
) {
    let [[by_stress, by_first], [first_by_second, by_second]] = term.stress;
    let states = term.states;
    sum[0] = tau.mul_add(tau.like(by_stress), sum[0]);
    sum[1] = tau.mul_add(tau.like(states[0][0]), sum[1]);
    sum[2] = tau.mul_add(tau.like(states[1][0]), sum[2]);
    sum[0] = first.mul_add(tau.like(by_first), sum[0]);
    sum[1] = first.mul_add(tau.like(states[0][1]), sum[1]);
    sum[2] = second.mul_add(tau.like(states[1][1]), sum[2]);
    sum[0] = second.mul_add(tau.like(by_second), sum[0]);
    if COUPLED {
        sum[1] = second.mul_add(tau.like(first_by_second), sum[1]);
    }
}

/// The coefficients after those of order k, of whose rates this is the sum, but for what comes by a change of the loading.
#[inline(always)]
fn next<E: Element, X: Element>(
    k: usize,
    mut sum: [X; 3],
    stress: &[E],
    (driven, of_stiffness): (X, X),
) -> [X; 3] {
    if k == 0 {
        sum[0] = sum[0] + driven;
    }
    let one_over = sum[0].like(ONE_OVER[k + 1]);
    let pulled = of_stiffness * one_over.like(stress[k + 1].first());
    [
        sum[0].mul_add(one_over, pulled),
        sum[1] * one_over,
        sum[2] * one_over,
    ]
}

/// The largest of a column.
#[inline(always)]
fn size<X: Element>(x: &[X; 3]) -> X {
    Element::max(x[0].abs(), Element::max(x[1].abs(), x[2].abs()))
}
