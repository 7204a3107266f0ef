//! Failures carry SUNDIALS's own names, non-finite values end in typed errors, and nothing is printed.

use super::*;
use std::process::Command;
use twinslip::error::Error;
use twinslip::sundials::{Mode, Problem};

/// (function, name, code) of a SUNDIALS error.
fn named(error: Error) -> (&'static str, String, i32) {
    match error {
        Error::Sundials {
            function,
            name,
            code,
            ..
        } => (function, name, code),
        other => panic!("not an error of SUNDIALS: {other}"),
    }
}

/// y' = 1 up to y = 1; beyond, what is given.
fn wall(beyond: f64) -> impl VectorField<1> {
    Field(
        move |y: &State<1>| State::<1>::new(if y[0] <= 1.0 { 1.0 } else { beyond }),
        |_: &State<1>| Jacobian::<1>::zeros(),
    )
}

fn run(field: &dyn VectorField<1>, max_steps: usize) -> Error {
    let mut cvode = cvode::<1>(MultistepMethod::Bdf, Operations::Fixed, 1e-8, 1e-8);
    cvode.set_max_steps(max_steps);
    cvode.start(0.0, &State::<1>::new(0.0)).unwrap();
    let error = cvode
        .advance(&Problem::new(field), 10.0, Mode::Normal)
        .unwrap_err();
    assert!(cvode.state()[0].is_finite());
    error
}

#[test]
fn a_repeated_error_test_failure_has_its_name_time_and_message() {
    let mut cvode = cvode::<1>(MultistepMethod::Bdf, Operations::Fixed, 1e-8, 1e-8);
    cvode.set_max_failures(3).unwrap();
    cvode.start(0.0, &State::<1>::new(0.0)).unwrap();
    let error = cvode
        .advance(&Problem::new(&wall(1e3)), 10.0, Mode::Normal)
        .unwrap_err();
    let Error::Sundials { time, message, .. } = &error else {
        panic!("{error}");
    };
    assert!((time.unwrap() - 1.0).abs() < 0.1);
    assert!(
        message.contains("error test failed repeatedly"),
        "{message}"
    );
    assert_eq!(named(error), ("CVode", "CV_ERR_FAILURE".to_owned(), -3));
}

#[test]
fn the_bound_on_steps_has_its_name_in_both_modes() {
    let field = oscillator();
    let mut cvode = cvode::<2>(MultistepMethod::Bdf, Operations::Fixed, 1e-10, 1e-10);
    cvode.set_max_steps(50);
    for mode in [Mode::Normal, Mode::OneStep] {
        cvode.start(0.0, &State::<2>::new(0.0, 1.0)).unwrap();
        let error = loop {
            match cvode.advance(&Problem::new(&field), 1e3, mode) {
                Ok(arrival) => assert!(arrival.t < 1e3),
                Err(error) => break error,
            }
        };
        assert_eq!(cvode.work().unwrap().steps, 50);
        assert!(!error.to_string().ends_with(')'), "a message: {error}");
        assert_eq!(named(error), ("CVode", "CV_TOO_MUCH_WORK".to_owned(), -1));
    }
}

#[test]
fn more_steps_than_one_portion_are_taken() {
    let field = oscillator();
    let mut cvode = cvode::<2>(MultistepMethod::Bdf, Operations::Fixed, 1e-10, 1e-10);
    cvode.start(0.0, &State::<2>::new(0.0, 1.0)).unwrap();
    cvode
        .advance(&Problem::new(&field), 100.0, Mode::Normal)
        .unwrap();
    assert!(cvode.work().unwrap().steps > 2500);
    assert!((cvode.state()[0] - 100.0_f64.sin()).abs() < 1e-6);
}

#[test]
fn a_time_too_close_and_a_missing_sensitivity_have_their_names() {
    let field = oscillator();
    let mut cvode = cvode::<2>(MultistepMethod::Bdf, Operations::Fixed, 1e-8, 1e-8);
    cvode.start(1.0, &State::<2>::new(0.0, 1.0)).unwrap();
    let error = cvode
        .advance(&Problem::new(&field), 1.0, Mode::Normal)
        .unwrap_err();
    assert_eq!(named(error).1, "CV_TOO_CLOSE");
    let error = cvode.sensitivities().unwrap_err();
    assert_eq!(named(error), ("CVodeGetSens", "CV_NO_SENS".to_owned(), -40));
}

#[test]
fn a_right_hand_side_that_stays_non_finite_is_a_typed_error_and_not_a_long_search() {
    for beyond in [f64::NAN, f64::INFINITY, f64::NEG_INFINITY] {
        match run(&wall(beyond), 1_000_000) {
            Error::NonFinite { what, t } => {
                assert_eq!(what, "the right-hand side");
                assert!((t - 1.0).abs() < 0.1, "{t}");
            }
            Error::StepTooSmall { t, .. } => assert!((t - 1.0).abs() < 1e-6, "{t}"),
            other => panic!("{other}"),
        }
    }
}

#[test]
fn a_non_finite_start_is_a_typed_error() {
    let error = run(
        &Field(
            |_: &State<1>| State::<1>::new(f64::NAN),
            |_: &State<1>| Jacobian::<1>::zeros(),
        ),
        1000,
    );
    assert_eq!(
        error,
        Error::NonFinite {
            what: "the right-hand side",
            t: 0.0
        }
    );
    let mut cvode = cvode::<1>(MultistepMethod::Bdf, Operations::Fixed, 1e-8, 1e-8);
    for bad in [f64::NAN, f64::INFINITY] {
        assert!(matches!(
            cvode.start(0.0, &State::<1>::new(bad)),
            Err(Error::NonFinite { .. })
        ));
    }
}

#[test]
fn a_jacobian_that_stays_non_finite_is_an_error_of_its_set_up() {
    let field = Field(
        |y: &State<1>| -y,
        |_: &State<1>| Jacobian::<1>::new(f64::NAN),
    );
    for operations in OPERATIONS {
        let mut cvode = cvode::<1>(MultistepMethod::Bdf, operations, 1e-8, 1e-8);
        cvode.start(0.0, &State::<1>::new(1.0)).unwrap();
        let error = cvode
            .advance(&Problem::new(&field), 1.0, Mode::Normal)
            .unwrap_err();
        assert!(
            matches!(
                error,
                Error::NonFinite {
                    what: "the Jacobian",
                    ..
                }
            ),
            "{error}"
        );
    }
}

#[test]
fn a_recoverable_excursion_is_stepped_around() {
    // sqrt is not defined for the negative trial values of a long first step.
    let field = Field(
        |y: &State<1>| State::<1>::new(-y[0].sqrt()),
        |y: &State<1>| Jacobian::<1>::new(-0.5 / y[0].sqrt()),
    );
    let mut cvode = cvode::<1>(MultistepMethod::Adams, Operations::Fixed, 1e-8, 1e-8);
    cvode.start(0.0, &State::<1>::new(1.0)).unwrap();
    cvode
        .advance(&Problem::new(&field), 1.9, Mode::Normal)
        .unwrap();
    // y = (1 - t/2)^2
    assert!((cvode.state()[0] - 0.0025).abs() < 1e-6);
}

/// Everything that makes SUNDIALS print when nobody listens.
fn provoke() {
    for beyond in [1e30, f64::NAN] {
        run(&wall(beyond), 100_000);
    }
    run(&wall(1.0), 3);
    let field = oscillator();
    let mut cvode = cvode::<2>(MultistepMethod::Bdf, Operations::Fixed, 1e-8, 1e-8);
    cvode.start(1e15, &State::<2>::new(0.0, 1e-3)).unwrap();
    cvode.sensitivities().unwrap_err();
    cvode.dense(7.0).unwrap_err();
    let _ = cvode.advance(&Problem::new(&field), 1e15 + 1.0, Mode::Normal);
    super::kinsol::provoke();
}

const CHILD: &str = "TWINSLIP_TEST_SILENCE_CHILD";

#[test]
fn nothing_is_printed() {
    if std::env::var_os(CHILD).is_some() {
        provoke();
        return;
    }
    let child = Command::new(std::env::current_exe().unwrap())
        .args([
            "--exact",
            "sundials::errors::nothing_is_printed",
            "--nocapture",
        ])
        .env(CHILD, "1")
        .output()
        .unwrap();
    let printed = String::from_utf8_lossy(&child.stdout);
    assert!(
        child.status.success() && printed.contains("1 passed"),
        "{printed}"
    );
    assert_eq!(String::from_utf8_lossy(&child.stderr), "");
    for line in ["CVODE", "KINSOL", "WARNING", "ERROR"] {
        assert!(!printed.contains(line), "{printed}");
    }
}

/// dy/dt = -a (e^y - 1) falls from 500 within 1e-214 and then creeps: 1 - e^-y = e^(-a t). CVODES's own first step, a
/// hundred spacings of t, would wipe out the state, and 0 is an equilibrium: the run would end there, with success.
#[test]
fn a_field_too_fast_for_the_first_step_does_not_wipe_out_the_state() {
    let a = 1e-3;
    let field = Field(
        move |y: &State<1>| State::<1>::new(-a * y[0].exp_m1()),
        move |y: &State<1>| Jacobian::<1>::new(-a * y[0].exp()),
    );
    let expected = -(-(-a).exp_m1()).ln();
    for method in METHODS {
        for operations in OPERATIONS {
            let mut cvode = cvode::<1>(method, operations, 1e-8, 1e-8);
            cvode.start(0.0, &State::<1>::new(500.0)).unwrap();
            cvode
                .advance(&Problem::new(&field), 1.0, Mode::Normal)
                .unwrap();
            assert!(
                relative_error(cvode.state().as_slice(), &[expected]) < 1e-5,
                "{}",
                cvode.state()
            );
        }
    }
}
