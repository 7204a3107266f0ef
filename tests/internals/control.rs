//! The step control of Rosenbrock methods.

use twinslip::field::{Jacobian, State};
use twinslip::integrate::Tolerances;
use twinslip::internals::{MayErr, error_norm, first_step};
#[test]
fn an_error_that_is_not_finite_is_none() {
    let tolerances = Tolerances::equal(1e-3).unwrap();
    let y = State::<2>::new(1.0, 2.0);
    for bad in [f64::NAN, f64::INFINITY] {
        for error in [State::<2>::new(bad, 0.0), State::<2>::new(0.0, bad)] {
            assert_eq!(
                error_norm(MayErr::equally(tolerances), &error, &y, &y),
                None
            );
            assert_eq!(
                error_norm(MayErr::equally(tolerances), &y, &y, &error),
                None
            );
        }
    }
    let error = State::<2>::new(1e-3, -6e-3);
    let norm = error_norm(MayErr::equally(tolerances), &error, &y, &y).unwrap();
    assert!((norm - 2.0).abs() < 1e-12);
}

#[test]
fn the_first_step_follows_the_time_scale_whatever_its_size() {
    let tolerances = Tolerances::equal(1e-6).unwrap();
    let length = |rate: f64, y: f64| {
        let (y, f) = (State::<1>::new(y), State::<1>::new(-rate * y));
        first_step(
            MayErr::equally(tolerances),
            4,
            1e300,
            &y,
            &f,
            &Jacobian::<1>::new(-rate),
        )
    };
    for y in [1.0, 1e-12] {
        for rate in [1e-200, 1e-3, 1e7, 1e250] {
            let ratio = length(rate, y) * rate / length(1.0, y);
            assert!((ratio - 1.0).abs() < 1e-6, "{rate}: {ratio}");
        }
    }
    assert!(length(1.0, 1.0) < 0.1);
    let rest = State::<1>::zeros();
    let still = first_step(
        MayErr::equally(tolerances),
        4,
        7.0,
        &rest,
        &rest,
        &Jacobian::<1>::zeros(),
    );
    assert_eq!(still, 7.0);
}
