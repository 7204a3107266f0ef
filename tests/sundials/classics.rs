//! The stiff classics against their published digits, and stock operations against ours, bit by bit.

use super::*;
use stiff_classics::*;
use twinslip::sundials::{Mode, Problem, Reason};

use crate::common::stiff_classics;

fn check<const N: usize>(
    field: &dyn VectorField<N>,
    y0: [f64; N],
    end: f64,
    published: [f64; N],
    (rtol, atol): (f64, f64),
    bound: f64,
) {
    for operations in OPERATIONS {
        let mut cvode = cvode::<N>(MultistepMethod::Bdf, operations, rtol, atol);
        cvode.start(0.0, &State::from(y0)).unwrap();
        let arrival = cvode
            .advance(&Problem::new(field), end, Mode::Normal)
            .unwrap();
        assert_eq!((arrival.t, arrival.reason), (end, Reason::Time));
        let error = relative_error(cvode.state().as_slice(), &published);
        assert!(error < bound, "{operations:?}: relative error {error:e}");
    }
}

#[test]
fn robertson_reaches_its_published_state_after_1e11() {
    let y0 = [1.0, 0.0, 0.0];
    check(
        &Robertson,
        y0,
        1e11,
        ROBERTSON_AT_1E11,
        (1e-11, 1e-22),
        1e-7,
    );
}

#[test]
fn van_der_pol_reaches_its_published_state() {
    for (t, published) in [1.0, 2.0].into_iter().zip(VAN_DER_POL) {
        check(&VanDerPol, [2.0, 0.0], t, published, (1e-11, 1e-11), 1e-7);
    }
}

#[test]
fn oregonator_reaches_its_published_state() {
    check(
        &Orego,
        [1.0, 2.0, 3.0],
        360.0,
        OREGO_AT_360,
        (1e-12, 1e-12),
        1e-6,
    );
}

#[test]
fn hires_reaches_its_published_state() {
    let y0 = [1.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0057];
    check(&Hires, y0, 321.8122, HIRES_AT_END, (1e-11, 1e-14), 1e-6);
}

#[test]
fn our_operations_give_the_bits_of_the_stock_ones() {
    fn both<const N: usize>(field: &dyn VectorField<N>, y0: [f64; N], end: f64) {
        for method in METHODS {
            let [fixed, stock] = OPERATIONS.map(|operations| {
                let mut cvode = cvode::<N>(method, operations, 1e-8, 1e-8);
                cvode.start(0.0, &State::from(y0)).unwrap();
                cvode
                    .advance(&Problem::new(field), end, Mode::Normal)
                    .unwrap();
                (cvode.work().unwrap(), cvode.state())
            });
            assert_eq!(fixed, stock, "{method:?}");
        }
    }
    both(&Orego, [1.0, 2.0, 3.0], 360.0);
    both(
        &Hires,
        [1.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0057],
        321.8122,
    );
    both(&oscillator(), [0.3, 0.7], 100.0);
}

#[test]
fn dense_output_agrees_with_a_tight_run_and_ends_at_the_step() {
    let field = oscillator();
    for method in METHODS {
        let mut cvode = cvode::<2>(method, Operations::Fixed, 1e-9, 1e-9);
        cvode.start(0.0, &State::<2>::new(0.0, 1.0)).unwrap();
        let mut t0 = 0.0;
        let mut looked = 0;
        while t0 < 10.0 {
            let arrival = cvode
                .advance(&Problem::new(&field), 10.0, Mode::OneStep)
                .unwrap();
            assert_eq!(arrival.reason, Reason::Step);
            for share in [0.0, 0.25, 0.5, 1.0] {
                let t: f64 = t0 + share * (arrival.t - t0);
                let y = cvode.dense(t).unwrap();
                assert!((y[0] - t.sin()).abs() < 3e-7, "{method:?} at {t}");
                let slope = cvode.dense_derivative(t, 1).unwrap();
                assert!((slope[0] - t.cos()).abs() < 3e-5, "{method:?} at {t}");
                looked += 1;
            }
            assert_eq!(cvode.dense(arrival.t).unwrap(), cvode.state());
            let beyond = arrival.t + 0.1 * (arrival.t - t0);
            let error = cvode.dense(beyond).unwrap_err().to_string();
            assert!(
                error.starts_with("CVodeGetDky returned CV_BAD_T (-25)"),
                "{error}"
            );
            t0 = arrival.t;
        }
        assert!(looked > 100);
    }
}

#[test]
fn a_stop_time_is_met_exactly_never_passed_and_forgotten_when_unset() {
    let field = oscillator();
    let problem = Problem::new(&field);
    for end in [2.0, -2.0] {
        let mut cvode = cvode::<2>(MultistepMethod::Bdf, Operations::Fixed, 1e-9, 1e-9);
        for _ in 0..2 {
            cvode.start(0.0, &State::<2>::new(0.0, 1.0)).unwrap();
            cvode.set_stop_time(Some(0.5 * end));
            let arrival = cvode.advance(&problem, end, Mode::Normal).unwrap();
            assert_eq!((arrival.t, arrival.reason), (0.5 * end, Reason::StopTime));
            assert!(cvode.time().unwrap().abs() <= 0.5 * end.abs());
            assert!((cvode.state()[0] - (0.5 * end).sin()).abs() < 1e-7);
            // A new stop time, then none.
            cvode.set_stop_time(Some(0.75 * end));
            let arrival = cvode.advance(&problem, end, Mode::Normal).unwrap();
            assert_eq!((arrival.t, arrival.reason), (0.75 * end, Reason::StopTime));
            cvode.set_stop_time(None);
            let arrival = cvode.advance(&problem, end, Mode::Normal).unwrap();
            assert_eq!((arrival.t, arrival.reason), (end, Reason::Time));
            assert!((cvode.state()[0] - end.sin()).abs() < 1e-7);
        }
        // A stop time that was not reached must not live on after a new start.
        cvode.start(0.0, &State::<2>::new(0.0, 1.0)).unwrap();
        cvode.set_stop_time(Some(3.0 * end));
        cvode.advance(&problem, end, Mode::Normal).unwrap();
        cvode.set_stop_time(None);
        cvode.start(0.0, &State::<2>::new(0.0, 1.0)).unwrap();
        let arrival = cvode.advance(&problem, 4.0 * end, Mode::Normal).unwrap();
        assert_eq!((arrival.t, arrival.reason), (4.0 * end, Reason::Time));
    }
}

#[test]
fn a_reused_solver_repeats_itself_to_the_last_bit() {
    let field = Robertson;
    let mut cvode = cvode::<3>(MultistepMethod::Bdf, Operations::Fixed, 1e-8, 1e-14);
    let mut run = || {
        cvode.start(0.0, &State::<3>::new(1.0, 0.0, 0.0)).unwrap();
        cvode
            .advance(&Problem::new(&field), 4e4, Mode::Normal)
            .unwrap();
        (cvode.state(), cvode.work().unwrap())
    };
    let first = run();
    assert_eq!(first, run());
    assert!(first.1.steps > 100 && first.1.jacobians > 5 && first.1.factorisations > 20);
}
