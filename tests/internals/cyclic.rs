//! Cyclic systems of linear equations.

use twinslip::field::{Matrix, Vector};
use twinslip::internals::solve_cyclic as solve;

/// A map that grows by 20 in one direction and shrinks by as much in another.
fn map() -> Matrix {
    Matrix::from_row_slice(2, 2, &[20.0, 1.0, 0.0, 0.05])
}

fn vector(x: f64, y: f64) -> Vector {
    Vector::from_column_slice(&[x, y])
}

#[test]
fn growth_and_decay_by_fifty_decades_are_kept_apart() {
    let turn = nalgebra::Rotation2::new(0.3);
    let turn = Matrix::from_column_slice(2, 2, turn.matrix().as_slice());
    let maps = vec![&turn * map() * turn.transpose(); 40];
    let exact: Vec<Vector> = (0..40)
        .map(|k| vector((k as f64).sin(), (1.7 * k as f64).cos()))
        .collect();
    let right: Vec<Vector> = (0..40)
        .map(|k| &exact[(k + 1) % 40] - &maps[k] * &exact[k])
        .collect();
    let found = solve(&maps, &right).unwrap();
    for (found, exact) in found.iter().zip(&exact) {
        assert!((found - exact).amax() < 1e-13);
    }
}

#[test]
fn complex_ones_are_solved_as_real_ones_are() {
    let turn = nalgebra::Complex::from_polar(1.0, 0.4);
    let maps: Vec<_> = (0..40).map(|k| map().map(|x| turn.powi(k) * x)).collect();
    let exact: Vec<_> = (0..40)
        .map(|k| vector((k as f64).sin(), (1.7 * k as f64).cos()).map(|x| turn * x))
        .collect();
    let right: Vec<_> = (0..40)
        .map(|k| &exact[(k + 1) % 40] - &maps[k] * &exact[k])
        .collect();
    let found = solve(&maps, &right).unwrap();
    for (found, exact) in found.iter().zip(&exact) {
        assert!((found - exact).camax() < 1e-13);
    }
}

#[test]
fn a_free_direction_is_singular() {
    let maps = vec![Matrix::identity(2, 2); 3];
    assert!(solve(&maps, &vec![vector(1.0, 0.0); 3]).is_none());
}
