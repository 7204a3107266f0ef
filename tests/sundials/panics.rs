//! Panics in user code cross C and go on in Rust, wherever they start; the solver can be used again.

use super::*;
use std::panic::{AssertUnwindSafe, catch_unwind};
use std::sync::atomic::{AtomicUsize, Ordering};
use twinslip::sundials::{Kinsol, Mode, Problem, Residual, Sensitivity};

/// What a panic said.
fn said(work: impl FnOnce()) -> String {
    let payload = catch_unwind(AssertUnwindSafe(work)).expect_err("a panic");
    payload
        .downcast_ref::<&str>()
        .map(|text| (*text).to_owned())
        .expect("the text given")
}

#[test]
fn from_the_right_hand_side_and_no_user_code_runs_after_it() {
    let calls = AtomicUsize::new(0);
    let field = Field(
        |y: &State<2>| {
            if calls.fetch_add(1, Ordering::Relaxed) >= 10 {
                panic!("in f");
            }
            State::<2>::new(y[1], -y[0])
        },
        |_: &State<2>| Jacobian::<2>::new(0.0, 1.0, -1.0, 0.0),
    );
    for operations in OPERATIONS {
        calls.store(0, Ordering::Relaxed);
        let mut cvode = cvode::<2>(MultistepMethod::Bdf, operations, 1e-8, 1e-8);
        cvode.start(0.0, &State::<2>::new(0.0, 1.0)).unwrap();
        let text = said(|| {
            let _ = cvode.advance(&Problem::new(&field), 10.0, Mode::Normal);
        });
        assert_eq!(text, "in f");
        assert_eq!(calls.load(Ordering::Relaxed), 11);
        cvode.start(0.0, &State::<2>::new(0.0, 1.0)).unwrap();
        cvode
            .advance(&Problem::new(&oscillator()), 1.0, Mode::Normal)
            .unwrap();
        assert!((cvode.state()[0] - 1.0_f64.sin()).abs() < 1e-6);
    }
}

#[test]
fn from_the_jacobian() {
    let field = Field(|y: &State<1>| -y, |_: &State<1>| panic!("in J"));
    for operations in OPERATIONS {
        let mut cvode = cvode::<1>(MultistepMethod::Bdf, operations, 1e-8, 1e-8);
        cvode.start(0.0, &State::<1>::new(1.0)).unwrap();
        let text = said(|| {
            let _ = cvode.advance(&Problem::new(&field), 1.0, Mode::Normal);
        });
        assert_eq!(text, "in J");
    }
}

#[test]
fn from_an_event_and_from_a_parameter_derivative() {
    let field = oscillator();
    let mut cvode = cvode::<2>(MultistepMethod::Bdf, Operations::Fixed, 1e-8, 1e-8);
    cvode.watch_events(1, &[]).unwrap();
    cvode.start(0.0, &State::<2>::new(0.0, 1.0)).unwrap();
    let problem = Problem {
        events: Some(&|_, _, _| panic!("in g")),
        ..Problem::new(&field)
    };
    assert_eq!(
        said(|| {
            let _ = cvode.advance(&problem, 1.0, Mode::Normal);
        }),
        "in g"
    );

    cvode.watch_events(0, &[]).unwrap();
    let zero = [State::<2>::zeros()];
    cvode
        .start_with_sensitivities(
            0.0,
            &State::<2>::new(0.0, 1.0),
            &zero,
            &Sensitivity::default(),
        )
        .unwrap();
    let problem = Problem {
        forcing: Some(&|_, _| panic!("in df/dp")),
        ..Problem::new(&field)
    };
    assert_eq!(
        said(|| {
            let _ = cvode.advance(&problem, 1.0, Mode::Normal);
        }),
        "in df/dp"
    );
}

#[test]
fn from_a_residual() {
    struct Panics;
    impl Residual<1> for Panics {
        fn residual(&self, _: &State<1>) -> State<1> {
            panic!("in F")
        }
        fn jacobian(&self, _: &State<1>) -> Jacobian<1> {
            unreachable!("F comes first")
        }
    }
    let mut kinsol = Kinsol::<1>::new().unwrap();
    let one = State::<1>::new(1.0);
    assert_eq!(
        said(|| {
            let _ = kinsol.solve(&Panics, &one, &one, &one);
        }),
        "in F"
    );
}
