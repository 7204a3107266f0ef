//! Cyclic systems of linear equations.

use twinslip::field::{Jacobian, State};
use twinslip::internals::solve_cyclic as solve;
#[test]
fn growth_and_decay_by_fifty_decades_are_kept_apart() {
    let turn = nalgebra::Rotation2::new(0.3);
    let maps: Vec<Jacobian<2>> = (0..40)
        .map(|_| turn * Jacobian::<2>::new(20.0, 1.0, 0.0, 0.05) * turn.inverse())
        .collect();
    let exact: Vec<State<2>> = (0..40)
        .map(|k| State::<2>::new((k as f64).sin(), (1.7 * k as f64).cos()))
        .collect();
    let right: Vec<State<2>> = (0..40)
        .map(|k| exact[(k + 1) % 40] - maps[k] * exact[k])
        .collect();
    let found = solve(&maps, &right).unwrap();
    for (found, exact) in found.iter().zip(&exact) {
        assert!((found - exact).amax() < 1e-13);
    }
}

#[test]
fn complex_ones_are_solved_as_real_ones_are() {
    let turn = nalgebra::Complex::from_polar(1.0, 0.4);
    let maps: Vec<_> = (0..40)
        .map(|k| Jacobian::<2>::new(20.0, 1.0, 0.0, 0.05).map(|x| turn.powi(k) * x))
        .collect();
    let exact: Vec<_> = (0..40)
        .map(|k| State::<2>::new((k as f64).sin(), (1.7 * k as f64).cos()).map(|x| turn * x))
        .collect();
    let right: Vec<_> = (0..40)
        .map(|k| exact[(k + 1) % 40] - maps[k] * exact[k])
        .collect();
    let found = solve(&maps, &right).unwrap();
    for (found, exact) in found.iter().zip(&exact) {
        assert!((found - exact).camax() < 1e-13);
    }
}

#[test]
fn a_free_direction_is_singular() {
    let maps = vec![Jacobian::<2>::identity(); 3];
    assert!(solve(&maps, &[State::<2>::new(1.0, 0.0); 3]).is_none());
}
