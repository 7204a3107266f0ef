//! Poles of solutions.

use twinslip::field::Jacobian;
use twinslip::field::{State, VectorField};
use twinslip::internals::time_to_singularity;

/// dy/dt = a y^p + b.
struct Power(f64, i32, f64);

impl VectorField<1> for Power {
    fn f(&self, y: &State<1>) -> State<1> {
        y.map(|y| self.0 * y.powi(self.1) + self.2)
    }
    fn jacobian(&self, y: &State<1>) -> Jacobian<1> {
        y.map(|y| self.0 * f64::from(self.1) * y.powi(self.1 - 1))
    }
    fn second_derivative(&self, _: &State<1>, _: &State<1>, _: &State<1>) -> State<1> {
        State::zeros()
    }
}

#[test]
fn a_pole_is_found_where_it_is() {
    // y = 1 / (T - t) and its like, from T - t = 1e-12.
    let y = State::<1>::new(1e12);
    let left = time_to_singularity(&Power(1.0, 2, 0.0), &y, 1.0, 1e-9).unwrap();
    assert!((left / 1e-12 - 1.0).abs() < 0.01, "{left:e}");
    // Backwards in time the pole lies at the other side.
    let left = time_to_singularity(&Power(-1.0, 3, 0.0), &State::<1>::new(-1e6), -1.0, 1.0);
    assert!((left.unwrap() / 0.5e-12 - 1.0).abs() < 0.01, "{left:?}");
    assert!(time_to_singularity(&Power(1.0, 2, 0.0), &y, -1.0, 1.0).is_none());
}

#[test]
fn a_burst_is_no_pole() {
    // Exponential growth; growth that saturates.
    assert!(time_to_singularity(&Power(1e20, 1, 0.0), &State::<1>::new(1.0), 1.0, 1e-19).is_none());
    struct Logistic;
    impl VectorField<1> for Logistic {
        fn f(&self, y: &State<1>) -> State<1> {
            y.map(|y| y * y * (1e20 - y))
        }
        fn jacobian(&self, y: &State<1>) -> Jacobian<1> {
            y.map(|y| 2e20 * y - 3.0 * y * y)
        }
        fn second_derivative(&self, _: &State<1>, _: &State<1>, _: &State<1>) -> State<1> {
            State::zeros()
        }
    }
    assert!(time_to_singularity(&Logistic, &State::<1>::new(1.0), 1.0, 1.0).is_none());
}
