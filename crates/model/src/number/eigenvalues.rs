//! Eigenvalues of real matrices.

use nalgebra::linalg::Schur;
use nalgebra::{Complex, DMatrix, DVector};

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
