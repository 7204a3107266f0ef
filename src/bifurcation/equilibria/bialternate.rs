//! The bialternate product: of a matrix the sums of any two eigenvalues; and of a field with a pair on the imaginary axis the first
//! Lyapunov coefficient.

use crate::field::{Matrix, Vector};
use crate::integrate::AnyField;
use crate::number::{eigenvector, null_vector};
use nalgebra::{Complex, DMatrix, DVector};

/// The bialternate product 2 A (.) 1, of size N (N - 1) / 2: its eigenvalues are the sums of two of A's.
pub(super) fn bialternate(a: &DMatrix<f64>) -> DMatrix<f64> {
    let n = a.nrows();
    let pairs: Vec<_> = (1..n).flat_map(|p| (0..p).map(move |q| (p, q))).collect();
    DMatrix::from_fn(pairs.len(), pairs.len(), |row, column| {
        let ((p, q), (r, s)) = (pairs[row], pairs[column]);
        let delta = |i: usize, j: usize| if i == j { 1.0 } else { 0.0 };
        // the coefficient of e_p ^ e_q in A e_r ^ e_s + e_r ^ A e_s
        a[(p, r)] * delta(q, s) - a[(q, r)] * delta(p, s) + a[(q, s)] * delta(p, r)
            - a[(p, s)] * delta(q, r)
    })
}

/// What rounding of the entries of a Jacobian, to so many units in the last place, may make of a determinant that is computed from them: a sum
/// over a few choices of signs.
pub(super) fn rounding_of(
    jacobian: &Matrix,
    units: f64,
    determinant: impl Fn(&Matrix) -> f64,
) -> f64 {
    /// So often, with other signs.
    const TIMES: usize = 4;
    let here = determinant(jacobian);
    let moved = |time: usize| {
        let sign = |i: usize, j: usize| ((i + 1) * (j + 1) * (7 + 2 * time) / 2) % 2;
        let entry =
            |i, j, x: f64| x * (1.0 + units * f64::EPSILON * (1.0 - 2.0 * sign(i, j) as f64));
        (determinant(&jacobian.map_with_location(entry)) - here).abs()
    };
    (0..TIMES).map(moved).sum()
}

type CVector = DVector<Complex<f64>>;

/// The real and the imaginary part.
fn parts(x: &CVector) -> [Vector; 2] {
    [x.map(|z| z.re), x.map(|z| z.im)]
}

/// A real bilinear form applied to complex vectors.
fn bilinear(form: impl Fn(&Vector, &Vector) -> Vector, x: &CVector, y: &CVector) -> CVector {
    let ([a, b], [c, d]) = (parts(x), parts(y));
    let (re, im) = (form(&a, &c) - form(&b, &d), form(&a, &d) + form(&b, &c));
    re.zip_map(&im, Complex::new)
}

/// The distance of the states of a difference, in units of 1 + |y|.
pub(super) const CHANGE: f64 = 1e-4;

/// D3f[x, y, z] as the difference of second derivatives along z.
fn trilinear(field: &AnyField<'_>, at: &Vector, [x, y, z]: [&CVector; 3], change: f64) -> CVector {
    let h = change * (1.0 + at.amax());
    let along = |direction: Vector| {
        let there = |step: f64| {
            let place = at + &direction * (step * h);
            bilinear(|a, b| field.second_derivative(&place, a, b), x, y)
        };
        // fourth order
        let (near, far) = (there(1.0) - there(-1.0), there(2.0) - there(-2.0));
        (near * Complex::from(8.0) - far) / Complex::from(12.0 * h)
    };
    let [re, im] = parts(z).map(along);
    re + im * Complex::i()
}

/// l_1 (Kuznetsov 2004, (5.62)) with <q, q> = 1 at an equilibrium with the eigenvalues +-i omega. None if a matrix is singular.
pub(super) fn lyapunov(field: &AnyField<'_>, at: &Vector, omega: f64) -> Option<f64> {
    lyapunov_by(field, at, omega, CHANGE)
}

/// The same with third derivatives by differences of this distance.
pub(super) fn lyapunov_by(
    field: &AnyField<'_>,
    at: &Vector,
    omega: f64,
    change: f64,
) -> Option<f64> {
    let n = at.len();
    let a = field.jacobian(at).map(Complex::from);
    let i_omega = Complex::new(0.0, omega);
    let one = DMatrix::<Complex<f64>>::identity(n, n);
    let q = eigenvector(&field.jacobian(at), i_omega)?;
    let p = null_vector(a.adjoint() + &one * i_omega)?;
    // <p, q> = 1, conjugate-linear in p
    let p = &p / p.dotc(&q).conj();
    let conjugate = q.map(|x| x.conj());
    let b = |x: &CVector, y: &CVector| bilinear(|u, v| field.second_derivative(at, u, v), x, y);
    let mean = a.clone().lu().solve(&b(&q, &conjugate))?;
    let double = (&one * (i_omega * 2.0) - &a).lu().solve(&b(&q, &q))?;
    let sum = p.dotc(&trilinear(field, at, [&q, &q, &conjugate], change))
        - p.dotc(&b(&q, &mean)) * 2.0
        + p.dotc(&b(&conjugate, &double));
    let l_1 = sum.re / (2.0 * omega);
    l_1.is_finite().then_some(l_1)
}
