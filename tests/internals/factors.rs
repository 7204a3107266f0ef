//! Factors of small matrices.

use twinslip::field::{Jacobian, State};
use twinslip::internals::Factors;
#[test]
fn solves_where_pivoting_is_needed() {
    let j = Jacobian::<3>::new(2.0, -4.0, 1.0, -1.0, 2.0, 3.0, 7.0, 1.0, 0.5);
    // 2 I - J has a zero in the first place
    let factors = Factors::shifted(3, 2.0, &j).unwrap();
    let x = State::<3>::new(1.0, -2.0, 3.0);
    let b = x * 2.0 - j * x;
    assert!((factors.solve(&b) - x).amax() < 1e-14);
}

#[test]
fn a_singular_or_infinite_matrix_is_refused() {
    assert!(Factors::shifted(2, 1.0, &Jacobian::<2>::identity()).is_none());
    assert!(Factors::shifted(2, 1.0, &Jacobian::<2>::from_element(f64::NAN)).is_none());
    assert!(Factors::shifted(2, f64::INFINITY, &Jacobian::<2>::zeros()).is_none());
}
