//! Eigenvalues of a matrix that is known within bounds, each with a disc in which it certainly lies.
//!
//! In the basis of the approximate eigenvectors the matrix is nearly diagonal: the discs are those of Gershgorin there, with all that
//! rounding, the bounds and the basis are off.

use super::eigenvalues::{Stability, Verdict};
use crate::number::{DoubleDouble, Interval, eigenvalues};
use nalgebra::{Complex, DMatrix, DVector};

/// The eigenvalues of any matrix between these bounds, given row by row, with the verdict on stability.
pub fn spectrum_within(bounds: &[Interval]) -> Stability {
    let n = bounds.len().isqrt();
    let middle = DMatrix::from_fn(n, n, |i, j| {
        bounds[i * n + j].lo() * 0.5 + bounds[i * n + j].hi() * 0.5
    });
    if n == 0 {
        return unknown(Vec::new());
    }
    let Some(mut found) = eigenvalues(&middle) else {
        return unknown(Vec::new());
    };
    found.sort_by(|a, b| b.re.total_cmp(&a.re).then(b.im.total_cmp(&a.im)));
    let Some(discs) = discs(bounds, &middle, &found) else {
        return unknown(found);
    };
    let verdict = if discs.iter().all(|(z, r)| z.re + r < 0.0) {
        Verdict::Stable
    } else if discs.iter().any(|(z, r)| z.re - r > 0.0) {
        Verdict::Unstable
    } else {
        Verdict::Undecided
    };
    let uncertainty = found.iter().zip(&discs).map(|(z, (centre, radius))| {
        let reach = (z - centre).norm() + radius;
        reach + f64::EPSILON * reach
    });
    Stability {
        uncertainty: uncertainty.collect(),
        eigenvalues: found,
        verdict,
    }
}

fn unknown(eigenvalues: Vec<Complex<f64>>) -> Stability {
    Stability {
        uncertainty: vec![f64::INFINITY; eigenvalues.len()],
        eigenvalues,
        verdict: Verdict::Undecided,
    }
}

/// A disc for every eigenvalue, that contains as many as there are discs it meets; those that meet are one. `None` where the
/// eigenvectors are no basis.
///
/// With the approximate eigenvalues L, eigenvectors V and W close to the inverse of V it is V^-1 A V = L + (1 - E)^-1 W (A V - V L), where
/// W V = 1 - E. The difference A V - V L cancels, and is computed in 31 digits.
fn discs(
    bounds: &[Interval],
    middle: &DMatrix<f64>,
    found: &[Complex<f64>],
) -> Option<Vec<(Complex<f64>, f64)>> {
    /// For the rounding of these sums, of no more than some hundred numbers that are not negative.
    const ROUNDED: f64 = 1.0 + 1e-12;
    let n = found.len();
    let basis = basis(middle, found)?;
    let inverse = basis.clone().try_inverse()?;
    let [v, w] = [&basis, &inverse].map(|matrix| matrix.map(size));
    let sizes = &w * &v;
    let unit = &inverse * &basis;
    let off = DMatrix::from_fn(n, n, |i, j| {
        let one = Complex::from(f64::from(u8::from(i == j)));
        // Complex products and sums of n of them, rounded.
        size(unit[(i, j)] - one) + (n + 8) as f64 * f64::EPSILON * sizes[(i, j)]
    });
    let within = DMatrix::from_fn(n, n, |i, j| bounds[i * n + j].distance_from(middle[(i, j)]));
    let left = residual(middle, &basis, found) + within * &v;
    let moved = w * left * ROUNDED;
    if !off.iter().chain(&moved).all(|x| x.is_finite()) {
        return None;
    }
    let row_sums = |matrix: &DMatrix<f64>| -> Vec<f64> {
        let sums = matrix.row_iter().map(|row| row.sum() * ROUNDED);
        sums.collect()
    };
    let largest = |sums: &[f64]| sums.iter().copied().fold(0.0, f64::max);
    let (off, moved) = (largest(&row_sums(&off)), row_sums(&moved));
    if off >= 0.5 {
        return None;
    }
    let rest = off / (1.0 - off) * largest(&moved) * ROUNDED;
    let radius = |own: &f64| (own + rest) * ROUNDED;
    let radii = moved.iter().map(radius);
    Some(joined(found.iter().copied().zip(radii).collect()))
}

/// A bound on the modulus.
fn size(z: Complex<f64>) -> f64 {
    z.re.abs() + z.im.abs()
}

/// Bounds on the moduli of the entries of A V - V L, where L are the eigenvalues.
fn residual(
    a: &DMatrix<f64>,
    v: &DMatrix<Complex<f64>>,
    eigenvalues: &[Complex<f64>],
) -> DMatrix<f64> {
    /// What an operation in 31 digits errs by, relative, with a margin; and where products leave the range of normal doubles.
    const ERROR: f64 = 1e-30;
    const LEAST: f64 = 1e-300;
    let n = eigenvalues.len();
    let rows: Vec<Vec<(usize, f64)>> = (0..n)
        .map(|i| {
            let row = (0..n).map(|j| (j, a[(i, j)]));
            row.filter(|entry| entry.1 != 0.0).collect()
        })
        .collect();
    DMatrix::from_fn(n, n, |i, k| {
        let z = eigenvalues[k];
        let exact = |x: f64| DoubleDouble::from(x);
        let own = v[(i, k)];
        let mut re = exact(z.im) * own.im - exact(z.re) * own.re;
        let mut im = -(exact(z.re) * own.im + exact(z.im) * own.re);
        let mut sizes = 2.0 * size(z) * size(own);
        for &(j, a) in &rows[i] {
            let x = v[(j, k)];
            re = re + exact(a) * x.re;
            im = im + exact(a) * x.im;
            sizes += a.abs() * size(x);
        }
        let operations = (2 * rows[i].len() + 8) as f64;
        let left = re.to_f64().abs() + im.to_f64().abs();
        left + operations * (ERROR * sizes + LEAST)
    })
}

/// Approximate eigenvectors as columns, by inverse iteration.
fn basis(a: &DMatrix<f64>, found: &[Complex<f64>]) -> Option<DMatrix<Complex<f64>>> {
    /// Beside the eigenvalue, where the matrix has an inverse.
    const BESIDE: f64 = 1e-10;
    const ITERATIONS: usize = 3;
    let n = found.len();
    let size = a.norm().max(f64::MIN_POSITIVE);
    let mut columns = Vec::with_capacity(n);
    for (k, &z) in found.iter().enumerate() {
        let shift = z + Complex::new(BESIDE * size, BESIDE * size);
        let shifted = DMatrix::from_fn(n, n, |i, j| {
            Complex::new(a[(i, j)], 0.0)
                - if i == j {
                    shift
                } else {
                    Complex::new(0.0, 0.0)
                }
        });
        let factors = shifted.lu();
        // Of equal eigenvalues, different vectors.
        let begin = |i: usize| Complex::new(1.0 + ((i * (k + 2)) % 7) as f64, i as f64 * 0.3);
        let mut x = DVector::from_fn(n, |i, _| begin(i));
        for _ in 0..ITERATIONS {
            x = factors.solve(&x)?;
            x /= Complex::new(x.norm(), 0.0);
        }
        columns.push(x);
    }
    let basis = DMatrix::from_columns(&columns);
    basis
        .iter()
        .all(|z| z.re.is_finite() && z.im.is_finite())
        .then_some(basis)
}

/// Discs that meet become, all of them, the smallest known one around both.
fn joined(mut discs: Vec<(Complex<f64>, f64)>) -> Vec<(Complex<f64>, f64)> {
    let mut groups: Vec<usize> = (0..discs.len()).collect();
    loop {
        let meets = |i: usize, j: usize| {
            let ((a, r), (b, s)) = (discs[i], discs[j]);
            groups[i] != groups[j] && (a - b).norm() <= r + s
        };
        let pairs = (0..discs.len()).flat_map(|i| (0..i).map(move |j| (i, j)));
        let Some((i, j)) = { pairs }.find(|&(i, j)| meets(i, j)) else {
            return discs;
        };
        let ((a, r), (b, s)) = (discs[i], discs[j]);
        let apart = (a - b).norm();
        let around = (0.5 * (a + b), 0.5 * apart + r.max(s) + f64::EPSILON * apart);
        let (from, to) = (groups[j], groups[i]);
        for (disc, group) in discs.iter_mut().zip(&mut groups) {
            if *group == from || *group == to {
                *group = to;
                *disc = around;
            }
        }
    }
}
