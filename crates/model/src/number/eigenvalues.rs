//! Eigenvalues and singular values of matrices, by iterations that end.

use nalgebra::linalg::{SVD, Schur, SymmetricEigen};
use nalgebra::{Complex, ComplexField, DMatrix, DVector, Dyn};

/// Iterations that are allowed for each eigenvalue; two or three are usual.
const ITERATIONS: usize = 100;
/// Bases in which the matrix is tried.
const BASES: usize = 8;
/// The same of matrices that are no longer small, where an iteration that does not end costs most: single shifts then come next.
const SMALL: usize = 8;
const ITERATIONS_OF_LARGE: usize = 30;
const BASES_OF_LARGE: usize = 1;

/// The eigenvalues of a square matrix, as often as they are multiple, in no order, by the real Schur form. `None` where the matrix has
/// entries that are not finite.
///
/// Francis's shifts do not move some matrices whose eigenvalues all have one modulus, such as permutations and circulants: the iteration
/// then ends after a bounded number of steps, and is done in another basis, by a reflection of the coordinates. That changes the
/// eigenvalues by rounding alone. At last, and of large matrices at once, single shifts in complex arithmetic are tried.
///
/// # Panics
/// If the matrix is not square.
pub fn eigenvalues(matrix: &DMatrix<f64>) -> Option<Vec<Complex<f64>>> {
    let n = matrix.nrows();
    let (each, bases) = match n > SMALL {
        true => (ITERATIONS_OF_LARGE, BASES_OF_LARGE),
        false => (ITERATIONS, BASES),
    };
    let most = each * n.max(1);
    if !matrix.iter().all(|x| x.is_finite()) {
        return None;
    }
    let found = (0..bases).find_map(|basis| {
        let same = if basis == 0 {
            matrix.clone()
        } else {
            reflected(matrix, basis)
        };
        let schur = Schur::try_new(same, f64::EPSILON, most)?;
        Some(schur.complex_eigenvalues().iter().copied().collect())
    });
    found.or_else(|| by_single_shifts(matrix))
}

/// The same by single shifts in complex arithmetic, for matrices on which double shifts stand still in every basis, as some with several equal complex pairs.
fn by_single_shifts(matrix: &DMatrix<f64>) -> Option<Vec<Complex<f64>>> {
    /// Steps with no other way to count an entry as zero than beside its neighbours; every one of so many has a shift of no meaning, against cycles.
    const STRICT: usize = 12;
    const EXCEPTIONAL: usize = 10;
    let n = matrix.nrows();
    let size = matrix.norm();
    let mut h = matrix.clone().hessenberg().h().map(Complex::from);
    let (mut high, mut steps) = (n.checked_sub(1)?, 0);
    while high > 0 {
        let negligible = |h: &DMatrix<Complex<f64>>, i: usize| {
            let beside = h[(i - 1, i - 1)].norm() + h[(i, i)].norm();
            let beside = if beside == 0.0 || steps > STRICT {
                size
            } else {
                beside
            };
            h[(i, i - 1)].norm() <= f64::EPSILON * beside
        };
        let low = (1..=high).rev().find(|&i| negligible(&h, i)).unwrap_or(0);
        if low == high {
            (high, steps) = (high - 1, 0);
            continue;
        }
        if steps == ITERATIONS {
            return None;
        }
        steps += 1;
        let last = h[(high, high)];
        let shift = if steps % EXCEPTIONAL == 0 {
            last + 0.75 * h[(high, high - 1)].norm()
        } else {
            // Of the last two rows and columns the eigenvalue that is nearer to the last entry.
            let half = (h[(high - 1, high - 1)] - last) * 0.5;
            let product = h[(high - 1, high)] * h[(high, high - 1)];
            let root = (half * half + product).sqrt();
            let far = if (half + root).norm() > (half - root).norm() {
                half + root
            } else {
                half - root
            };
            if far == Complex::ZERO {
                last
            } else {
                last - product / far
            }
        };
        step(&mut h, (low, high), shift);
    }
    conjugated(
        h.diagonal().iter().copied(),
        16.0 * n as f64 * f64::EPSILON * size,
    )
}

/// A QR step on a block of a Hessenberg matrix of which the eigenvalues alone are asked for.
fn step(h: &mut DMatrix<Complex<f64>>, (low, high): (usize, usize), shift: Complex<f64>) {
    for i in low..=high {
        h[(i, i)] -= shift;
    }
    let mut rotations = Vec::with_capacity(high - low);
    for i in low..high {
        let (a, b) = (h[(i, i)], h[(i + 1, i)]);
        let length = a.norm().hypot(b.norm());
        let (c, s) = match length > 0.0 {
            true => (a / length, b / length),
            false => (Complex::ONE, Complex::ZERO),
        };
        for j in i..=high {
            let (x, y) = (h[(i, j)], h[(i + 1, j)]);
            h[(i, j)] = c.conj() * x + s.conj() * y;
            h[(i + 1, j)] = c * y - s * x;
        }
        rotations.push((c, s));
    }
    for (i, (c, s)) in (low..high).zip(rotations) {
        for j in low..=(i + 1).min(high) {
            let (x, y) = (h[(j, i)], h[(j, i + 1)]);
            h[(j, i)] = x * c + y * s;
            h[(j, i + 1)] = y * c.conj() - x * s.conj();
        }
    }
    for i in low..=high {
        h[(i, i)] += shift;
    }
}

/// Complex numbers in conjugate pairs, and real ones, that are so but for this rounding; `None` where they are not.
fn conjugated(all: impl Iterator<Item = Complex<f64>>, rounding: f64) -> Option<Vec<Complex<f64>>> {
    let (real, others): (Vec<_>, Vec<_>) = all.partition(|z| z.im.abs() <= rounding);
    let (upper, mut lower): (Vec<_>, Vec<_>) = others.into_iter().partition(|z| z.im > 0.0);
    let mut made: Vec<_> = real.iter().map(|z| Complex::from(z.re)).collect();
    for z in upper {
        let off = |other: &Complex<f64>| (other.conj() - z).norm();
        let near = (0..lower.len()).min_by(|&i, &j| off(&lower[i]).total_cmp(&off(&lower[j])))?;
        let middle = (z + lower.swap_remove(near).conj()) * 0.5;
        made.extend([middle, middle.conj()]);
    }
    (lower.is_empty() && made.iter().all(|z| z.is_finite())).then_some(made)
}

/// The eigenvalues of a symmetric square matrix, and its eigenvectors as columns, in no order. `None` where the matrix has entries that are
/// not finite, or the iteration does not end.
///
/// It is done in units of the largest entry: beside the smallest of all numbers nothing is negligible, and the iteration would not end.
///
/// # Panics
/// If the matrix is not square.
pub fn symmetric_eigenvalues(matrix: &DMatrix<f64>) -> Option<(DVector<f64>, DMatrix<f64>)> {
    let largest = matrix.amax();
    if !matrix.iter().all(|x| x.is_finite()) {
        return None;
    }
    let unit = if largest > 0.0 { largest } else { 1.0 };
    let most = ITERATIONS * matrix.nrows().max(1);
    let made = SymmetricEigen::try_new(matrix / unit, f64::EPSILON, most)?;
    Some((made.eigenvalues * unit, made.eigenvectors))
}

/// The singular values of a matrix, with the vectors that are asked for: those of its range, and those of its domain as rows. `None` where the
/// matrix has entries that are not finite, or the iteration does not end.
pub fn singular_values<T: ComplexField<RealField = f64>>(
    matrix: DMatrix<T>,
    [of_range, of_domain]: [bool; 2],
) -> Option<SVD<T, Dyn, Dyn>> {
    let most = ITERATIONS * matrix.nrows().max(matrix.ncols()).max(1);
    if !matrix.iter().all(|x| x.clone().is_finite()) {
        return None;
    }
    SVD::try_new(matrix, of_range, of_domain, 5.0 * f64::EPSILON, most)
}

/// The unit vector that the matrix maps to the least one: to zero where it is singular. `None` as of [`singular_values`].
pub fn null_vector<T: ComplexField<RealField = f64>>(matrix: DMatrix<T>) -> Option<DVector<T>> {
    let decomposed = singular_values(matrix, [false, true])?;
    let least = decomposed.singular_values.imin();
    Some(decomposed.v_t?.row(least).adjoint())
}

/// The unit vector q with A q = z q, of an eigenvalue z. `None` as of [`singular_values`].
pub fn eigenvector(matrix: &DMatrix<f64>, z: Complex<f64>) -> Option<DVector<Complex<f64>>> {
    let n = matrix.nrows();
    null_vector(matrix.map(Complex::from) - DMatrix::identity(n, n) * z)
}

/// The matrix in coordinates that are reflected at a plane, a different one for each basis.
fn reflected(matrix: &DMatrix<f64>, basis: usize) -> DMatrix<f64> {
    let golden = 0.5 * (5.0_f64.sqrt() - 1.0);
    let normal = DVector::from_fn(matrix.nrows(), |i, _| {
        0.5 + (golden * (i + 1) as f64 * basis as f64).fract()
    });
    let twice = 2.0 / normal.norm_squared();
    let reflection =
        DMatrix::identity(matrix.nrows(), matrix.nrows()) - &normal * normal.transpose() * twice;
    &reflection * matrix * &reflection
}
