//! Difference quotients in place of what is no number in a Jacobian: implicit methods step with them, tangents are never made of them.

use twinslip::error::Error;
use twinslip::field::{Jacobian, State, VectorField, with_differences};
use twinslip::integrate::{Integrator, MAX_STEPS, Rosenbrock, RosenbrockMethod, Tolerances};

/// x' = (sqrt(max(0, y/s - 1)) - x)/t, y' = s/t: in units of s and t the same system for all of them.
struct Rooted {
    s: f64,
    t: f64,
}

impl VectorField<2> for Rooted {
    fn f(&self, y: &State<2>) -> State<2> {
        let Rooted { s, t } = *self;
        State::<2>::new(((y[1] / s - 1.0).max(0.0).sqrt() - y[0]) / t, s / t)
    }
    fn jacobian(&self, y: &State<2>) -> Jacobian<2> {
        let Rooted { s, t } = *self;
        let above = y[1] / s - 1.0;
        let slope = match above {
            x if x < 0.0 => 0.0 * f64::INFINITY,
            0.0 => f64::INFINITY,
            x => 0.5 / x.sqrt(),
        };
        Jacobian::<2>::new(-1.0 / t, slope / (s * t), 0.0, 0.0)
    }
    fn second_derivative(&self, _: &State<2>, _: &State<2>, _: &State<2>) -> State<2> {
        State::zeros()
    }
    fn may_lack_slopes(&self) -> bool {
        true
    }
}

#[test]
fn differences_are_the_same_in_any_units() {
    for s in [1.0, 1e-150_f64.log2().round().exp2(), 2.0_f64.powi(400)] {
        for t in [1.0, 2.0_f64.powi(-90), 2.0_f64.powi(90)] {
            let field = Rooted { s, t };
            for at in [0.0, 0.5, -3.0] {
                // Whatever x is: it has units of its own.
                for x in [0.0, 1.0, 2.0_f64.powi(100)] {
                    let y = State::<2>::new(x, at * s);
                    let made = with_differences(&field, &y, field.jacobian(&y));
                    let truth = Jacobian::<2>::new(-1.0 / t, 0.0, 0.0, 0.0);
                    assert_eq!(made, truth, "s = {s:e}, t = {t:e}, x = {x:e}, y/s = {at}");
                }
            }
        }
    }
}

/// A root has one where it begins, and a run may begin there.
#[test]
fn infinite_slopes_are_differences_over_a_part_of_the_variable() {
    let field = Rooted { s: 1.0, t: 1.0 };
    let y = State::<2>::new(0.5, 1.0);
    let made = with_differences(&field, &y, field.jacobian(&y));
    assert!((1e3..1e5).contains(&made[(0, 1)]), "{made}");
    let tolerances = Tolerances::equal(1e-8).expect("tolerances");
    let mut rodas = Rosenbrock::new(RosenbrockMethod::Rodas5P, tolerances, MAX_STEPS).expect("one");
    let end = rodas.flow(&field, (0.0, 1.0), &y, None).expect("a run");
    // 0.5 / e, and the integral of sqrt(t) e^(t - 1) from 0 to 1, which is 1 - D(1), D Dawson's function.
    let truth = 0.5 * (-1.0_f64).exp() + 1.0 - 0.538_079_506_912_768_4;
    assert!((end[0] - truth).abs() < 1e-6, "{} for {truth}", end[0]);
}

/// The last digits of tangents would be those of the differences.
#[test]
fn tangents_are_not_made_of_differences() {
    let (field, start) = (Rooted { s: 1.0, t: 1.0 }, State::<2>::new(1.0, 0.0));
    let tolerances = Tolerances::equal(1e-8).expect("tolerances");
    for method in RosenbrockMethod::ALL {
        let mut rosenbrock = Rosenbrock::new(method, tolerances, MAX_STEPS).expect("a method");
        let end = rosenbrock.flow(&field, (0.0, 0.9), &start, None);
        let end = end.unwrap_or_else(|e| panic!("{method:?}: {e}"));
        assert!((end[0] - (-0.9_f64).exp()).abs() < 1e-6, "{method:?}");
        let made = rosenbrock.tangent_flow(&field, (0.0, 0.9), &start);
        assert!(
            matches!(made, Err(Error::NonFinite { .. })),
            "{method:?}: {made:?}"
        );
    }
    #[cfg(feature = "sundials")]
    for method in [
        twinslip::sundials::MultistepMethod::Bdf,
        twinslip::sundials::MultistepMethod::Adams,
    ] {
        let cvode = twinslip::integrate::CvodeIntegrator::new(method, tolerances, MAX_STEPS);
        let mut cvode = cvode.expect("a method");
        let end = cvode.flow(&field, (0.0, 0.9), &start, None);
        let end = end.unwrap_or_else(|e| panic!("{method:?}: {e}"));
        assert!((end[0] - (-0.9_f64).exp()).abs() < 1e-6, "{method:?}");
        let made = cvode.tangent_flow(&field, (0.0, 0.9), &start);
        assert!(made.is_err(), "{method:?}: {made:?}");
    }
}
