//! The matrix of a step, factorised once and used for all its stages.
//!
//! The sizes are mostly two to a dozen: everything unrolls, and a general library's checks cost more than the arithmetic. Of systems that have
//! room for more variables than there are only these are eliminated.

use crate::field::{Jacobian, State};

/// Dimensions up to which all of the room is worked through, with loops that unroll, and second derivatives are kept.
pub(super) const SMALL: usize = 8;

/// P W = L U, with partial pivoting.
#[derive(Debug, Clone, Copy)]
pub struct Factors<const N: usize> {
    /// L below the diagonal, U above it, and the reciprocals of U's diagonal.
    rows: [[f64; N]; N],
    /// Row i of P W is row `order[i]` of W.
    order: [usize; N],
    variables: usize,
}

/// How many of the N components to work with: constant, where loops of as many unroll.
#[inline(always)]
const fn worked_through<const N: usize>(variables: usize) -> usize {
    if N > SMALL { variables } else { N }
}

impl<const N: usize> Factors<N> {
    /// Of W = I `diagonal` - J in so many variables; `None` if W is singular or not finite.
    #[inline]
    pub fn shifted(variables: usize, diagonal: f64, jacobian: &Jacobian<N>) -> Option<Self> {
        let variables = worked_through::<N>(variables);
        let mut rows = [[0.0; N]; N];
        let mut order = [0; N];
        for i in 0..variables {
            order[i] = i;
            for k in 0..variables {
                rows[i][k] = -jacobian[(i, k)];
            }
            rows[i][i] += diagonal;
        }
        let mut factors = Factors {
            rows,
            order,
            variables,
        };
        factors.eliminate().then_some(factors)
    }

    #[expect(clippy::needless_range_loop, reason = "two rows of one matrix")]
    #[inline]
    fn eliminate(&mut self) -> bool {
        let rows = &mut self.rows;
        let variables = worked_through::<N>(self.variables);
        for k in 0..variables {
            if N > SMALL {
                let mut pivot = k;
                for i in k + 1..variables {
                    if rows[i][k].abs() > rows[pivot][k].abs() {
                        pivot = i;
                    }
                }
                rows.swap(pivot, k);
                self.order.swap(pivot, k);
            } else {
                // Exchanges at fixed places instead of a search for the largest: the loops unroll.
                for i in k + 1..variables {
                    if rows[i][k].abs() > rows[k][k].abs() {
                        rows.swap(i, k);
                        self.order.swap(i, k);
                    }
                }
            }
            let reciprocal = 1.0 / rows[k][k];
            // Infinite for a zero pivot, zero for an infinite one.
            if !(reciprocal.is_finite() && reciprocal != 0.0) {
                return false;
            }
            rows[k][k] = reciprocal;
            for i in k + 1..variables {
                let factor = rows[i][k] * reciprocal;
                rows[i][k] = factor;
                for l in k + 1..variables {
                    rows[i][l] -= factor * rows[k][l];
                }
            }
        }
        true
    }

    /// W^-1 b.
    #[inline]
    pub fn solve(&self, b: &State<N>) -> State<N> {
        let variables = worked_through::<N>(self.variables);
        let mut x = State::<N>::zeros();
        for i in 0..variables {
            let mut sum = b[self.order[i]];
            for k in 0..i {
                sum -= self.rows[i][k] * x[k];
            }
            x[i] = sum;
        }
        for i in (0..variables).rev() {
            let mut sum = x[i];
            for k in i + 1..variables {
                sum -= self.rows[i][k] * x[k];
            }
            x[i] = sum * self.rows[i][i];
        }
        x
    }
}
