//! The bialternate product: of a matrix the sums of any two eigenvalues; and of a field with a pair on the imaginary axis the first
//! Lyapunov coefficient.

use crate::field::{State, VectorField};
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

type Vector = DVector<Complex<f64>>;

/// The real and the imaginary part.
fn parts<const N: usize>(x: &Vector) -> [State<N>; 2] {
    [
        State::from_fn(|i, _| x[i].re),
        State::from_fn(|i, _| x[i].im),
    ]
}

/// A real bilinear form applied to complex vectors.
fn bilinear<const N: usize>(
    form: impl Fn(&State<N>, &State<N>) -> State<N>,
    x: &Vector,
    y: &Vector,
) -> Vector {
    let ([a, b], [c, d]) = (parts::<N>(x), parts::<N>(y));
    let (re, im) = (form(&a, &c) - form(&b, &d), form(&a, &d) + form(&b, &c));
    DVector::from_fn(N, |i, _| Complex::new(re[i], im[i]))
}

/// D3f[x, y, z] as the difference of second derivatives along z.
fn trilinear<const N: usize>(
    field: &dyn VectorField<N>,
    at: &State<N>,
    [x, y, z]: [&Vector; 3],
) -> Vector {
    let h = 1e-4 * (1.0 + at.amax());
    let along = |direction: State<N>| {
        let there = |step: f64| {
            let place = at + direction * (step * h);
            bilinear(|a, b| field.second_derivative(&place, a, b), x, y)
        };
        // fourth order
        let (near, far) = (there(1.0) - there(-1.0), there(2.0) - there(-2.0));
        (near * Complex::from(8.0) - far) / Complex::from(12.0 * h)
    };
    let [re, im] = parts::<N>(z).map(along);
    re + im * Complex::i()
}

/// l_1 (Kuznetsov 2004, (5.62)) with <q, q> = 1 at an equilibrium with the eigenvalues +-i omega. None if a matrix is singular.
pub(super) fn lyapunov<const N: usize>(
    field: &dyn VectorField<N>,
    at: &State<N>,
    omega: f64,
) -> Option<f64> {
    let real = field.jacobian(at);
    let a = DMatrix::from_fn(N, N, |i, j| Complex::from(real[(i, j)]));
    let i_omega = Complex::new(0.0, omega);
    let one = DMatrix::<Complex<f64>>::identity(N, N);
    let q = null_vector(&(&a - &one * i_omega))?;
    let p = null_vector(&(a.adjoint() + &one * i_omega))?;
    // <p, q> = 1, conjugate-linear in p
    let p = &p / p.dotc(&q).conj();
    let conjugate = q.map(|x| x.conj());
    let b = |x: &Vector, y: &Vector| bilinear(|u, v| field.second_derivative(at, u, v), x, y);
    let mean = a.clone().lu().solve(&b(&q, &conjugate))?;
    let double = (&one * (i_omega * 2.0) - &a).lu().solve(&b(&q, &q))?;
    let sum = p.dotc(&trilinear(field, at, [&q, &q, &conjugate])) - p.dotc(&b(&q, &mean)) * 2.0
        + p.dotc(&b(&conjugate, &double));
    let l_1 = sum.re / (2.0 * omega);
    l_1.is_finite().then_some(l_1)
}

/// The unit vector that the matrix maps to nearly zero.
fn null_vector(matrix: &DMatrix<Complex<f64>>) -> Option<Vector> {
    let decomposed = matrix.clone().svd(false, true);
    let smallest = decomposed.singular_values.imin();
    Some(decomposed.v_t?.row(smallest).adjoint())
}
