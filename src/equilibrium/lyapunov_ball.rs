//! Neighbourhoods of stable equilibria that no run leaves, for certain: balls of a Lyapunov function of the linearisation.
//!
//! P solves A^T P + P A = -1, A the Jacobian at the equilibrium. Along the flow V = x^T P x, x the distance from it, changes by
//! x^T (P J + J^T P) x, J the mean of the Jacobian between both. Where P J + J^T P is negative definite for all J that the Jacobian has in a
//! box, by the discs of Gershgorin in interval arithmetic, V falls on all of {V < c} that lies in the box: what is in there ends at the
//! equilibrium.
//!
//! Khalil, H. K. (2002). Nonlinear Systems, chapter 4. Prentice Hall.

use super::boxes::{Enclosed, zero_near};
use crate::field::{Matrix, Vector};
use crate::number::Interval;

/// A ball in the norm of V that no run leaves.
#[derive(Debug, Clone, PartialEq)]
pub struct LyapunovBall {
    equilibrium: Vector,
    /// P.
    form: Matrix,
    /// c.
    level: f64,
}

/// Balls that are tried: the first reaches as far as the equilibrium is from zero, and each other one half as far.
const TRIED: usize = 40;
/// A box is wider than its ball by this part, and a ball holds what is in this part of it: for rounding.
const MARGIN: f64 = 1e-3;

impl LyapunovBall {
    /// The largest that is found around the equilibrium within a millionth of a point; `None` where no ball is known, as around unstable
    /// equilibria, or where no equilibrium is certainly so near.
    pub fn around(equations: &dyn Enclosed, near: &Vector) -> Option<Self> {
        let zero = zero_near(equations, near.as_slice())?;
        let n = zero.at.len();
        let jacobian = equations.jacobian(&zero.within);
        let middle = |x: Interval| 0.5 * x.lo() + 0.5 * x.hi();
        let linear = Matrix::from_fn(n, n, |i, j| middle(jacobian[i * n + j]));
        let form = lyapunov_equation(&linear)?;
        // Where P is not positive definite the equilibrium is not stable.
        let inverse = form.clone().cholesky()?.inverse();
        // On {V < c} the i-th distance is below sqrt(c P^-1_ii).
        let reach = Vector::from_fn(n, |i, _| inverse[(i, i)].max(0.0).sqrt());
        let equilibrium = Vector::from_vec(zero.at);
        let mut size = (1.0 + equilibrium.amax()) / reach.amax();
        for _ in 0..TRIED {
            let around = |i: usize| {
                let by = (1.0 + MARGIN) * size * reach[i];
                let within = zero.within[i];
                Interval::new(within.lo() - by, within.hi() + by)
            };
            let part: Vec<Interval> = (0..n).map(around).collect();
            if falls(&form, &equations.jacobian(&part)) {
                return Some(LyapunovBall {
                    equilibrium,
                    form,
                    level: size * size,
                });
            }
            size *= 0.5;
        }
        None
    }

    /// The equilibrium that all runs within end at.
    pub fn equilibrium(&self) -> &Vector {
        &self.equilibrium
    }

    /// V of a state.
    pub fn value(&self, y: &[f64]) -> f64 {
        let x = Vector::from_column_slice(y) - &self.equilibrium;
        x.dot(&(&self.form * &x))
    }

    /// Whether a state is within, so that the run from it ends at the equilibrium.
    pub fn holds(&self, y: &[f64]) -> bool {
        self.value(y) < (1.0 - MARGIN) * self.level
    }
}

/// P of A^T P + P A = -1, symmetric; `None` where two eigenvalues have no sum but zero.
fn lyapunov_equation(a: &Matrix) -> Option<Matrix> {
    let n = a.nrows();
    let place = |i: usize, j: usize| i * n + j;
    let mut equations = Matrix::zeros(n * n, n * n);
    let mut right = Vector::zeros(n * n);
    for i in 0..n {
        for j in 0..n {
            for k in 0..n {
                equations[(place(i, j), place(k, j))] += a[(k, i)];
                equations[(place(i, j), place(i, k))] += a[(k, j)];
            }
        }
        right[place(i, i)] = -1.0;
    }
    let solution = equations.lu().solve(&right)?;
    let form = Matrix::from_fn(n, n, |i, j| {
        0.5 * (solution[place(i, j)] + solution[place(j, i)])
    });
    form.iter().all(|x| x.is_finite()).then_some(form)
}

/// Whether P J + J^T P is negative definite for all J of an interval matrix, row by row.
fn falls(form: &Matrix, jacobian: &[Interval]) -> bool {
    let n = form.nrows();
    let exact = |x: f64| Interval::new(x, x);
    let entry = |i: usize, j: usize| {
        let zero = exact(0.0);
        (0..n).fold(zero, |sum, k| {
            sum + exact(form[(i, k)]) * jacobian[k * n + j]
                + jacobian[k * n + i] * exact(form[(k, j)])
        })
    };
    (0..n).all(|i| {
        let others = (0..n).filter(|&j| j != i);
        let disc = others.fold(exact(0.0), |sum, j| {
            let off = entry(i, j);
            let size = off.hi().abs().max(off.lo().abs());
            sum + exact(size)
        });
        let edge = entry(i, i) + disc;
        // Bounds that are no numbers compare as false.
        edge.hi() < 0.0
    })
}
