//! Eigenvalues of matrices on which an iteration without a limit does not end, and of others.

use crate::command;
use crate::common::assert_close;
use command::{number, object, twinslip};
use nalgebra::{Complex, DMatrix, DVector};
use std::f64::consts::TAU;
use twinslip::number::{eigenvalues, null_vector, singular_values, symmetric_eigenvalues};

/// Each of these is found, as often as it is there, and no other.
#[track_caller]
fn are(matrix: &DMatrix<f64>, exact: &[Complex<f64>], near: f64) {
    let mut found = eigenvalues(matrix).expect("a finite matrix");
    assert_eq!(found.len(), exact.len());
    for z in exact {
        let distances = found.iter().map(|other| (z - other).norm());
        let nearest = distances.enumerate().min_by(|a, b| a.1.total_cmp(&b.1));
        let (place, off) = nearest.expect("as many");
        assert!(off < near, "{z} is {off:e} off in {matrix}");
        found.swap_remove(place);
    }
}

/// The matrix that moves every component to the next place, times a number.
fn shift(n: usize, by: f64) -> DMatrix<f64> {
    DMatrix::from_fn(n, n, |i, j| if i == (j + 1) % n { by } else { 0.0 })
}

#[test]
fn permutations_and_circulants_have_roots_of_unity() {
    for n in 1..=12 {
        let turn = |k: usize| Complex::from_polar(1.0, TAU * k as f64 / n as f64);
        let all: Vec<_> = (0..n).map(turn).collect();
        are(&shift(n, 1.0), &all, 1e-13);
        for c in [0.5, 1e8, 1e-8] {
            let moved: Vec<_> = all.iter().map(|z| z * c - 1.0).collect();
            let circulant = shift(n, c) - DMatrix::identity(n, n);
            are(&circulant, &moved, 1e-12 * f64::max(c, 1.0));
        }
    }
    // Two that do not know of each other.
    let mut both = DMatrix::zeros(6, 6);
    both.view_mut((0, 0), (3, 3)).copy_from(&shift(3, 1.0));
    both.view_mut((3, 3), (3, 3)).copy_from(&shift(3, 1.0));
    let third = |k: usize| Complex::from_polar(1.0, TAU * k as f64 / 3.0);
    are(&both, &[0, 1, 2, 0, 1, 2].map(third), 1e-13);
}

#[test]
fn companions_defective_and_other_matrices_have_their_own() {
    // (x - 1) (x - 2) (x - 3) (x - 4)
    #[rustfmt::skip]
    let companion = DMatrix::from_row_slice(4, 4, &[
        10.0, -35.0, 50.0, -24.0,
        1.0, 0.0, 0.0, 0.0,
        0.0, 1.0, 0.0, 0.0,
        0.0, 0.0, 1.0, 0.0,
    ]);
    are(
        &companion,
        &[1.0, 2.0, 3.0, 4.0].map(|x| Complex::new(x, 0.0)),
        1e-11,
    );
    // One that is there thrice is known to a third of the digits.
    let jordan = DMatrix::from_fn(3, 3, |i, j| {
        if i == j {
            2.0
        } else if j == i + 1 {
            1.0
        } else {
            0.0
        }
    });
    are(&jordan, &[Complex::new(2.0, 0.0); 3], 1e-4);
    are(&DMatrix::zeros(3, 3), &[Complex::new(0.0, 0.0); 3], 1e-300);
    let rotation = DMatrix::from_row_slice(2, 2, &[0.0, -1.0, 1.0, 0.0]);
    are(
        &rotation,
        &[Complex::new(0.0, 1.0), Complex::new(0.0, -1.0)],
        1e-15,
    );
    let unknown = DMatrix::from_element(3, 3, f64::NAN);
    assert_eq!(eigenvalues(&unknown), None);
}

/// x' = -x + c z and so on around: -1 + c and -1 - c/2 ± i c sqrt(3)/2.
#[test]
fn the_equilibrium_of_a_ring_has_its_stability() {
    let made = object("equilibria --system tests/data/cases/ring.toml");
    let first = &made["result"]["equilibria"][0];
    assert_eq!(first["verdict"], "stable", "{first}");
    let leading = number(first, "/eigenvalues/0/0");
    assert!((leading + 0.5).abs() < 1e-14, "{leading}");
    // At c = 1 it is not alone: x = y = z.
    let run =
        "branch equilibria --system tests/data/cases/ring.toml --along c --from 0.1 --to 0.99";
    let branch = twinslip(run);
    assert_eq!(branch.code, 0, "{}", branch.err);
}

/// What iterations without a limit never end on: entries that are no numbers, and the smallest numbers there are, beside which nothing is
/// negligible.
#[test]
fn symmetric_matrices_and_singular_values_end_too() {
    let matrix = |unit: f64| DMatrix::from_row_slice(2, 2, &[2.0 * unit, unit, unit, 2.0 * unit]);
    for unit in [1.0, 1e-310, 1e-323, 1e300] {
        let (values, vectors) = symmetric_eigenvalues(&matrix(unit)).expect("finite");
        let mut sizes: Vec<f64> = values.iter().map(|x| x / unit).collect();
        sizes.sort_by(f64::total_cmp);
        assert_close(sizes[0], 1.0, 1e-14, "eigenvalue");
        assert_close(sizes[1], 3.0, 1e-14, "eigenvalue");
        assert!((vectors.transpose() * &vectors - DMatrix::identity(2, 2)).amax() < 1e-14);
        let values = singular_values(matrix(unit), [false, false]).expect("finite");
        assert_close(values.singular_values.max() / unit, 3.0, 1e-14, "singular");
    }
    let mut none = matrix(1.0);
    none[(0, 1)] = f64::NAN;
    assert!(symmetric_eigenvalues(&none).is_none());
    assert!(singular_values(none.clone(), [true, true]).is_none());
    assert!(null_vector(none).is_none());
    let singular = DMatrix::from_row_slice(2, 2, &[1.0, 2.0, 2.0, 4.0]);
    let null: DVector<f64> = null_vector(singular.clone()).expect("finite");
    assert!((singular * &null).amax() < 1e-15 && (null.norm() - 1.0).abs() < 1e-15);
}

/// Cells along a ring, in each of which two variables turn: at these rates double shifts stand still in every basis that is tried.
#[test]
fn equal_pairs_of_a_ring_are_found() {
    const CELLS: usize = 6;
    const COUPLING: f64 = 50.0;
    for i in 0..40 {
        let square = 0.3 - 0.0011 * i as f64;
        let mut ring = DMatrix::zeros(2 * CELLS, 2 * CELLS);
        for cell in 0..CELLS {
            ring[(2 * cell, 2 * cell + 1)] = 1.0;
            ring[(2 * cell + 1, 2 * cell)] = -square;
            for part in 0..2 {
                let at = |cell: usize| 2 * (cell % CELLS) + part;
                ring[(at(cell), at(cell))] = -2.0 * COUPLING;
                ring[(at(cell), at(cell + 1))] = COUPLING;
                ring[(at(cell), at(cell + CELLS - 1))] = COUPLING;
            }
        }
        let exact = |pair: usize| {
            let sine = (0.5 * TAU * (pair / 2) as f64 / CELLS as f64).sin();
            let sign = if pair.is_multiple_of(2) { 1.0 } else { -1.0 };
            Complex::new(-4.0 * COUPLING * sine * sine, sign * square.sqrt())
        };
        are(&ring, &(0..2 * CELLS).map(exact).collect::<Vec<_>>(), 1e-11);
    }
}
