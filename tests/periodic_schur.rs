//! Eigenvalues of products of matrices that are never made.

use crate::common::{data, number};
use nalgebra::{Complex, DMatrix};
use serde_json::Value;
use twinslip::internals::{LogEigenvalue, eigenvalues};

fn list(value: &Value) -> &[Value] {
    value.as_array().expect("a list")
}

fn matrix(rows: &Value) -> DMatrix<f64> {
    let rows = list(rows);
    DMatrix::from_fn(rows.len(), rows.len(), |i, j| number(&rows[i][j]))
}

/// From the nearest of those that are left, which is taken: in ln |mu| and in the angle.
fn off(found: &mut Vec<LogEigenvalue>, ln_abs: f64, arg: f64) -> (f64, f64) {
    let off = |one: &LogEigenvalue| {
        let turn = Complex::from_polar(1.0, one.arg - arg).arg();
        ((one.ln_abs - ln_abs).abs(), turn.abs())
    };
    let size = |one: &LogEigenvalue| off(one).0 + off(one).1;
    let nearest = (0..found.len())
        .min_by(|&i, &j| size(&found[i]).total_cmp(&size(&found[j])))
        .expect("as many");
    off(&found.swap_remove(nearest))
}

/// From 1e-60 to 4e1, a complex pair and negative ones among them: to what the rounding of the factors leaves of each.
#[test]
fn eigenvalues_of_forty_matrices_over_sixty_decades() {
    let all = data("foreign_orbits.json");
    for name in ["6a_product_40x5_order_one", "6b_product_40x5_up_to_1e3"] {
        let record = &all["records"][name];
        let factors: Vec<_> = list(&record["matrices"]).iter().map(matrix).collect();
        assert_eq!(factors.len(), 40);
        let mut found = eigenvalues(&factors).expect("eigenvalues");
        assert!(found.windows(2).all(|two| two[0].ln_abs >= two[1].ln_abs));
        for known in list(&record["values"]["multipliers"]) {
            let arg = std::f64::consts::PI * number(&known["arg_over_pi"]);
            let (size, turn) = off(&mut found, number(&known["ln_abs"]), arg);
            let bar = f64::EPSILON * number(&known["ln_sensitivity"]);
            assert!(
                size < bar && turn < bar,
                "{name}: {known}, {size:e}, {turn:e}"
            );
        }
    }
}

/// Numbers of order one, the same each time.
fn numbers(mut seed: u64) -> impl FnMut() -> f64 {
    move || {
        seed = seed
            .wrapping_mul(6_364_136_223_846_793_005)
            .wrapping_add(1_442_695_040_888_963_407);
        (seed >> 11) as f64 / (1_u64 << 52) as f64 - 1.0
    }
}

#[test]
fn a_single_matrix_has_the_eigenvalues_of_the_library() {
    let mut next = numbers(1);
    for size in 1..=12 {
        let one = DMatrix::from_fn(size, size, |_, _| next());
        let mut found = eigenvalues(std::slice::from_ref(&one)).expect("eigenvalues");
        for known in one.complex_eigenvalues().iter() {
            let (of_size, turn) = off(&mut found, known.norm().ln(), known.arg());
            assert!(of_size < 1e-11 && turn < 1e-11, "{size}: {known}");
        }
    }
}

/// Wherever the circle begins, the eigenvalues are the same, of as many factors as there are.
#[test]
fn the_first_factor_does_not_matter() {
    let mut next = numbers(2);
    let mut factors: Vec<_> = (0..7)
        .map(|_| DMatrix::from_fn(6, 6, |_, _| next()))
        .collect();
    let first = eigenvalues(&factors).expect("eigenvalues");
    for _ in 0..6 {
        factors.rotate_left(1);
        let mut found = eigenvalues(&factors).expect("eigenvalues");
        for one in &first {
            let (size, turn) = off(&mut found, one.ln_abs, one.arg);
            assert!(size < 1e-11 && turn < 1e-11, "{one:?}");
        }
    }
}

/// Diagonals are their own periodic Schur form; equal, zero, tiny and huge entries on them are no trouble, in any order.
#[test]
fn diagonals_equal_zero_and_out_of_range() {
    let diagonals = [
        [1e-200, 1.0, 3.0, 0.0, -2.0],
        [1e-200, 1.0, 3.0, 5.0, 1e200],
        [1e-200, 1.0, 3.0, 5.0, 1e200],
    ];
    let factors = diagonals.map(|diagonal| DMatrix::from_diagonal(&diagonal.to_vec().into()));
    let found = eigenvalues(&factors).expect("eigenvalues");
    let ln_abs: Vec<_> = found.iter().map(|one| one.ln_abs).collect();
    let ten = std::f64::consts::LN_10;
    let known = [
        400.0 * ten + 2.0_f64.ln(),
        3.0 * 3.0_f64.ln(),
        0.0,
        -600.0 * ten,
    ];
    for (found, known) in ln_abs.iter().zip(known) {
        assert!((found - known).abs() <= 1e-12, "{ln_abs:?}");
    }
    assert_eq!(ln_abs[4], f64::NEG_INFINITY);
    assert_eq!(found[0].arg, std::f64::consts::PI);
}

/// A nilpotent block, a rotation and a defective pair: no steps without end.
#[test]
fn blocks_on_which_steps_without_shifts_stand_still() {
    let shift = DMatrix::from_fn(4, 4, |i, j| f64::from(u8::from((i + 1) % 4 == j)));
    let found = eigenvalues(&[shift.clone(), shift.clone(), shift]).expect("eigenvalues");
    assert!(
        found.iter().all(|one| one.ln_abs.abs() < 1e-14),
        "{found:?}"
    );
    let jordan = DMatrix::from_fn(3, 3, |i, j| f64::from(u8::from(i == j || i + 1 == j)));
    let found = eigenvalues(&[jordan.clone(), jordan]).expect("eigenvalues");
    assert!(found.iter().all(|one| one.ln_abs.abs() < 1e-4), "{found:?}");
    let nilpotent = DMatrix::from_fn(3, 3, |i, j| f64::from(u8::from(i + 1 == j)));
    let found = eigenvalues(&[nilpotent]).expect("eigenvalues");
    assert!(
        found.iter().all(|one| one.ln_abs == f64::NEG_INFINITY),
        "{found:?}"
    );
}

#[test]
fn what_has_no_eigenvalues_has_none() {
    assert!(eigenvalues(&[]).is_none());
    assert!(eigenvalues(&[DMatrix::from_element(2, 2, f64::NAN)]).is_none());
    assert!(eigenvalues(&[DMatrix::from_element(2, 2, f64::INFINITY)]).is_none());
    assert_eq!(eigenvalues(&[DMatrix::zeros(0, 0)]), Some(Vec::new()));
}
