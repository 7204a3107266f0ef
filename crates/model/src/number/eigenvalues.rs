//! Eigenvalues and singular values of matrices, by iterations that end.

use nalgebra::linalg::{SVD, Schur, SymmetricEigen};
use nalgebra::{Complex, ComplexField, DMatrix, DVector, Dyn};

/// Iterations that are allowed for each eigenvalue; two or three are usual.
const ITERATIONS: usize = 100;
/// Bases in which the matrix is tried.
const BASES: usize = 8;

/// The eigenvalues of a square matrix, as often as they are multiple, in no order, by the real Schur form. `None` where the matrix has
/// entries that are not finite.
///
/// Francis's shifts do not move some matrices whose eigenvalues all have one modulus, such as permutations and circulants: the iteration
/// then ends after a bounded number of steps, and is done in another basis, by a reflection of the coordinates. That changes the
/// eigenvalues by rounding alone.
///
/// # Panics
/// If the matrix is not square.
pub fn eigenvalues(matrix: &DMatrix<f64>) -> Option<Vec<Complex<f64>>> {
    let n = matrix.nrows();
    let most = ITERATIONS * n.max(1);
    if !matrix.iter().all(|x| x.is_finite()) {
        return None;
    }
    (0..BASES).find_map(|basis| {
        let same = if basis == 0 {
            matrix.clone()
        } else {
            reflected(matrix, basis)
        };
        let schur = Schur::try_new(same, f64::EPSILON, most)?;
        Some(schur.complex_eigenvalues().iter().copied().collect())
    })
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
