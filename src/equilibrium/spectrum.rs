//! Eigenvalues of a matrix that is known within bounds, each with a disc in which it certainly lies.
//!
//! In the basis of the approximate eigenvectors the matrix is nearly diagonal: the discs are those of Gershgorin there, computed
//! in interval arithmetic, with what the basis is off.

use super::eigenvalues::{Stability, Verdict};
use crate::number::{Interval, eigenvalues};
use nalgebra::{Complex, DMatrix, DVector};

type Cell = [Interval; 2];

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
fn discs(
    bounds: &[Interval],
    middle: &DMatrix<f64>,
    found: &[Complex<f64>],
) -> Option<Vec<(Complex<f64>, f64)>> {
    let n = found.len();
    let basis = basis(middle, found)?;
    let inverse = basis.clone().try_inverse()?;
    let cells = |m: &DMatrix<Complex<f64>>| -> Vec<Cell> {
        let cell = |at: usize| [m[(at / n, at % n)].re, m[(at / n, at % n)].im].map(exact);
        (0..n * n).map(cell).collect()
    };
    let (v, w) = (cells(&basis), cells(&inverse));
    let a: Vec<Cell> = bounds.iter().map(|&x| [x, exact(0.0)]).collect();
    let changed = product(&product(&w, &a, n), &v, n);
    let unit = product(&w, &v, n);
    let largest_row = |size: &dyn Fn(usize, usize) -> f64| {
        let row = |i: usize| (0..n).map(|j| size(i, j)).sum::<f64>();
        (0..n).map(row).fold(0.0, f64::max)
    };
    // W V = 1 - E, and so V^-1 A V = (1 - E)^-1 W A V.
    let off = largest_row(&|i, j| {
        let [re, im] = unit[i * n + j];
        let one = exact(f64::from(u8::from(i == j)));
        largest([re - one, im])
    });
    let whole = largest_row(&|i, j| largest(changed[i * n + j]));
    /// For the rounding of these few sums.
    const ROUNDED: f64 = 1.0 + 1e-12;
    let off = off * ROUNDED;
    if !(off < 0.5 && whole.is_finite()) {
        return None;
    }
    let moved = off / (1.0 - off) * whole * ROUNDED;
    let disc = |i: usize| {
        let [re, im] = changed[i * n + i];
        let centre = Complex::new(re.lo() * 0.5 + re.hi() * 0.5, im.lo() * 0.5 + im.hi() * 0.5);
        let own = re.distance_from(centre.re) + im.distance_from(centre.im);
        let others = (0..n)
            .filter(|&j| j != i)
            .map(|j| largest(changed[i * n + j]));
        (centre, (own + others.sum::<f64>() + moved) * ROUNDED)
    };
    Some(joined((0..n).map(disc).collect()))
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

fn exact(x: f64) -> Interval {
    Interval::new(x, x)
}

fn product(a: &[Cell], b: &[Cell], n: usize) -> Vec<Cell> {
    let cell = |at: usize| {
        let (i, j) = (at / n, at % n);
        (0..n).fold([exact(0.0); 2], |[re, im], k| {
            let ([a_re, a_im], [b_re, b_im]) = (a[i * n + k], b[k * n + j]);
            [
                re + (a_re * b_re - a_im * b_im),
                im + (a_re * b_im + a_im * b_re),
            ]
        })
    };
    (0..n * n).map(cell).collect()
}

/// A bound on the modulus.
fn largest([re, im]: Cell) -> f64 {
    re.distance_from(0.0) + im.distance_from(0.0)
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
