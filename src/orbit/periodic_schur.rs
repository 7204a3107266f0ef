//! The eigenvalues of a product of matrices by its periodic Schur form: the product itself is never made.
//!
//! There are unitary Q_k, Q_p = Q_0, such that every Q_{k+1}^* A_k Q_k is upper triangular. The eigenvalues of A_{p-1} ... A_0
//! are the products of these diagonals, so their logarithms are sums, and a multiplier of 1e-60 beside one of 1e3 has all the
//! digits that the factors leave it. First p - 1 factors are made triangular and the last one a Hessenberg matrix; QR steps with
//! implicit shifts, which keep that form, then make the last one triangular too. In complex arithmetic single shifts do.
//!
//! Bojanczyk, A., Golub, G. H. and Van Dooren, P. (1992). The periodic Schur decomposition: algorithms and applications. Proc.
//! SPIE 1770, 31-42.

use nalgebra::linalg::givens::GivensRotation;
use nalgebra::{Complex, DMatrix, Matrix2, Matrix3, Vector2};
use std::f64::consts::{PI, TAU};

type C = Complex<f64>;

/// An eigenvalue by its logarithm, which is in range where it is not.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct LogEigenvalue {
    /// ln |mu|; minus infinity for zero.
    pub ln_abs: f64,
    /// arg mu, in (-pi, pi].
    pub arg: f64,
}

/// QR steps for an eigenvalue, at most.
const STEPS: usize = 60;
/// The first steps of a block have no shift: they put what grows above what decays.
const UNSHIFTED: usize = 2;
/// Every one of so many has a shift of no meaning, against cycles: that of a permutation is itself.
const EXCEPTIONAL: usize = 10;

/// The eigenvalues of A_{p-1} ... A_0, all of one size, the largest modulus first. `None` for no factors, for ones that are not
/// finite, and where the QR steps do not converge.
pub fn eigenvalues(factors: &[DMatrix<f64>]) -> Option<Vec<LogEigenvalue>> {
    let finite = |factor: &DMatrix<f64>| factor.iter().all(|x| x.is_finite());
    let (last, others) = factors.split_last()?;
    if !factors.iter().all(finite) {
        return None;
    }
    if last.is_empty() {
        return Some(Vec::new());
    }
    let mut cycle = Cycle::new(last, others);
    cycle.triangulate()?;
    let mut all: Vec<_> = (0..last.nrows()).map(|i| cycle.eigenvalue(i)).collect();
    all.sort_by(|a, b| b.ln_abs.total_cmp(&a.ln_abs));
    Some(all)
}

/// A Hessenberg matrix after triangular ones, of which the first is applied first.
struct Cycle {
    hessenberg: DMatrix<C>,
    triangular: Vec<DMatrix<C>>,
}

impl Cycle {
    fn new(last: &DMatrix<f64>, others: &[DMatrix<f64>]) -> Self {
        let size = last.nrows();
        let mut basis = DMatrix::<C>::identity(size, size);
        let mut triangular = Vec::with_capacity(others.len());
        for factor in others {
            let mut r = factor.map(C::from) * basis;
            basis = DMatrix::identity(size, size);
            // By rotations: reflections would mix rows of very unlike sizes, and lose those whose squares are zero.
            for column in 0..size {
                for row in (column + 1..size).rev() {
                    let pair = [r[(row - 1, column)], r[(row, column)]];
                    if let Some(rotation) = cancelling(pair) {
                        rotation.rotate(&mut r.fixed_rows_mut::<2>(row - 1));
                        r[(row, column)] = C::ZERO;
                        let mut columns = basis.fixed_columns_mut::<2>(row - 1);
                        rotation.inverse().rotate_rows(&mut columns);
                    }
                }
            }
            triangular.push(r);
        }
        let mut cycle = Cycle {
            hessenberg: last.map(C::from) * basis,
            triangular,
        };
        for column in 0..size.saturating_sub(2) {
            for row in (column + 1..size - 1).rev() {
                cycle.cancel(row, column);
            }
        }
        cycle
    }

    /// Makes the entry below this one of the Hessenberg matrix zero.
    fn cancel(&mut self, row: usize, column: usize) {
        let pair = [row, row + 1].map(|i| self.hessenberg[(i, column)]);
        self.turn(row, pair);
        self.hessenberg[(row + 1, column)] = C::ZERO;
    }

    /// Rotates rows i and i + 1 of the Hessenberg matrix as takes this pair's second component to zero, and all other factors so
    /// that they stay triangular and the eigenvalues what they are.
    fn turn(&mut self, i: usize, pair: [C; 2]) {
        let Some(mut rotation) = cancelling(pair) else {
            return;
        };
        rotation.rotate(&mut self.hessenberg.fixed_rows_mut::<2>(i));
        for factor in &mut self.triangular {
            rotation
                .inverse()
                .rotate_rows(&mut factor.fixed_columns_mut::<2>(i));
            // None is needed after a factor that is singular there.
            let Some(next) = cancelling([factor[(i, i)], factor[(i + 1, i)]]) else {
                return;
            };
            next.rotate(&mut factor.fixed_rows_mut::<2>(i));
            factor[(i + 1, i)] = C::ZERO;
            rotation = next;
        }
        rotation
            .inverse()
            .rotate_rows(&mut self.hessenberg.fixed_columns_mut::<2>(i));
    }

    /// Makes the Hessenberg matrix triangular, from below.
    fn triangulate(&mut self) -> Option<()> {
        let (mut high, mut steps) = (self.hessenberg.nrows() - 1, 0);
        while high > 0 {
            let low = self.split(high);
            if low == high {
                (high, steps) = (high - 1, 0);
                continue;
            }
            if steps == STEPS {
                return None;
            }
            steps += 1;
            let shift = if steps % EXCEPTIONAL == 0 {
                let below = self.hessenberg[(low + 1, low)].norm();
                Some(self.hessenberg[(low, low)] + C::new(0.75, 0.4375) * below)
            } else if steps > UNSHIFTED {
                self.shift(low, high)
            } else {
                None
            };
            self.step(low, high, shift.unwrap_or(C::ZERO));
        }
        Some(())
    }

    /// The first row of the block that ends with this one: entries below the diagonal that are noise beside it are zero.
    fn split(&mut self, high: usize) -> usize {
        let h = &mut self.hessenberg;
        for i in (1..=high).rev() {
            let mut beside = h[(i - 1, i - 1)].norm() + h[(i, i)].norm();
            if beside == 0.0 {
                beside = h.camax();
            }
            if h[(i, i - 1)].norm() <= f64::EPSILON * beside {
                h[(i, i - 1)] = C::ZERO;
                return i;
            }
        }
        0
    }

    /// One QR step on a block; the shift is in units of the triangular factors' product at the block's first diagonal place.
    fn step(&mut self, low: usize, high: usize, shift: C) {
        let h = &self.hessenberg;
        self.turn(low, [h[(low, low)] - shift, h[(low + 1, low)]]);
        for i in low + 1..high {
            self.cancel(i, i - 1);
        }
    }

    /// Wilkinson's: the eigenvalue of the last two rows and columns of the block's product that is nearest to its last entry, in
    /// the units of [`Self::step`]; `None` where these are out of all proportion to it.
    fn shift(&self, low: usize, high: usize) -> Option<C> {
        // The row above them counts too; the identity's where the block has but two.
        let three = high - low >= 2;
        let first = if three { high - 2 } else { high - 1 };
        let offset = usize::from(!three);
        let corner = |m: &DMatrix<C>| {
            Matrix3::from_fn(|i, j| {
                if i < offset || j < offset {
                    return C::from(f64::from(u8::from(i == j)));
                }
                m[(first + i - offset, first + j - offset)]
            })
        };
        let (mut product, mut unit) = (Matrix3::<C>::identity(), C::from(1.0));
        for factor in &self.triangular {
            product = corner(factor) * product;
            unit *= factor[(low, low)];
            // Both in the same units, near one.
            let size = product.fixed_view::<2, 2>(1, 1).camax();
            if !(size > 0.0 && unit.is_finite()) {
                return None;
            }
            product /= C::from(size);
            unit /= size;
        }
        let last: Matrix3<C> = corner(&self.hessenberg);
        let w: Matrix2<C> = last.fixed_rows::<2>(1) * product.fixed_columns::<2>(1);
        let half = (w[(0, 0)] - w[(1, 1)]) * 0.5;
        let root = (half * half + w[(0, 1)] * w[(1, 0)]).sqrt();
        // Away from cancellation: both differences from the last entry have the product -w_01 w_10.
        let far = if (half + root).norm() > (half - root).norm() {
            half + root
        } else {
            half - root
        };
        let near = if far == C::ZERO {
            C::ZERO
        } else {
            -w[(0, 1)] * w[(1, 0)] / far
        };
        let shift = (w[(1, 1)] + near) / unit;
        (shift.norm() <= self.hessenberg.camax() / f64::EPSILON).then_some(shift)
    }

    /// The product of the diagonals at i.
    fn eigenvalue(&self, i: usize) -> LogEigenvalue {
        let diagonal = self.triangular.iter().chain([&self.hessenberg]);
        let (mut ln_abs, mut arg) = (0.0, 0.0);
        for factor in diagonal {
            let (size, angle) = factor[(i, i)].to_polar();
            ln_abs += size.ln();
            arg += angle;
        }
        let arg = PI - (PI - arg).rem_euclid(TAU);
        LogEigenvalue { ln_abs, arg }
    }
}

/// The rotation that takes the second component to zero; `None` where it is.
fn cancelling(pair: [C; 2]) -> Option<GivensRotation<C>> {
    let pair = Vector2::from(pair);
    if pair[1] == C::ZERO {
        return None;
    }
    // Squares of tiny numbers would be zero.
    let scaled = pair / C::from(pair.camax());
    GivensRotation::cancel_y(&scaled).map(|(rotation, _)| rotation)
}
