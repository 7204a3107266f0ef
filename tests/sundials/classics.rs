//! Stiff classics against the digits that the Test Set for IVP Solvers publishes (F. Mazzia and C. Magherini, Test Set for
//! Initial Value Problem Solvers, release 2.4, University of Bari, 2008: chapters HIRES, OREGO, ROBER, VDPOL; the problems
//! are those of E. Hairer and G. Wanner, Solving Ordinary Differential Equations II, section IV.10).

use super::*;
use twinslip::sundials::{Mode, Problem, Reason};

fn robertson() -> impl VectorField<3> {
    Field(
        |y: &State<3>| {
            let slow = -0.04 * y[0] + 1e4 * y[1] * y[2];
            let fast = 3e7 * y[1] * y[1];
            State::<3>::new(slow, -slow - fast, fast)
        },
        |y: &State<3>| {
            #[rustfmt::skip]
            let j = Jacobian::<3>::new(
                -0.04,  1e4 * y[2],                1e4 * y[1],
                 0.04, -1e4 * y[2] - 6e7 * y[1],  -1e4 * y[1],
                 0.0,   6e7 * y[1],                0.0,
            );
            j
        },
    )
}

fn van_der_pol() -> impl VectorField<2> {
    const EPS: f64 = 1e-6;
    Field(
        |y: &State<2>| State::<2>::new(y[1], ((1.0 - y[0] * y[0]) * y[1] - y[0]) / EPS),
        |y: &State<2>| {
            Jacobian::<2>::new(
                0.0,
                1.0,
                (-2.0 * y[0] * y[1] - 1.0) / EPS,
                (1.0 - y[0] * y[0]) / EPS,
            )
        },
    )
}

fn oregonator() -> impl VectorField<3> {
    const S: f64 = 77.27;
    const Q: f64 = 8.375e-6;
    const W: f64 = 0.161;
    Field(
        |y: &State<3>| {
            State::<3>::new(
                S * (y[1] + y[0] * (1.0 - Q * y[0] - y[1])),
                (y[2] - (1.0 + y[0]) * y[1]) / S,
                W * (y[0] - y[2]),
            )
        },
        |y: &State<3>| {
            #[rustfmt::skip]
            let j = Jacobian::<3>::new(
                S * (1.0 - 2.0 * Q * y[0] - y[1]), S * (1.0 - y[0]),     0.0,
                -y[1] / S,                         -(1.0 + y[0]) / S,    1.0 / S,
                W,                                 0.0,                  -W,
            );
            j
        },
    )
}

fn hires() -> impl VectorField<8> {
    Field(
        |y: &State<8>| {
            State::<8>::from([
                -1.71 * y[0] + 0.43 * y[1] + 8.32 * y[2] + 0.0007,
                1.71 * y[0] - 8.75 * y[1],
                -10.03 * y[2] + 0.43 * y[3] + 0.035 * y[4],
                8.32 * y[1] + 1.71 * y[2] - 1.12 * y[3],
                -1.745 * y[4] + 0.43 * y[5] + 0.43 * y[6],
                -280.0 * y[5] * y[7] + 0.69 * y[3] + 1.71 * y[4] - 0.43 * y[5] + 0.69 * y[6],
                280.0 * y[5] * y[7] - 1.81 * y[6],
                -280.0 * y[5] * y[7] + 1.81 * y[6],
            ])
        },
        |y: &State<8>| {
            let (a, b) = (280.0 * y[7], 280.0 * y[5]);
            #[rustfmt::skip]
            let j = Jacobian::<8>::from_row_slice(&[
                -1.71, 0.43,  8.32,   0.0,   0.0,    0.0,      0.0,   0.0,
                1.71,  -8.75, 0.0,    0.0,   0.0,    0.0,      0.0,   0.0,
                0.0,   0.0,   -10.03, 0.43,  0.035,  0.0,      0.0,   0.0,
                0.0,   8.32,  1.71,   -1.12, 0.0,    0.0,      0.0,   0.0,
                0.0,   0.0,   0.0,    0.0,   -1.745, 0.43,     0.43,  0.0,
                0.0,   0.0,   0.0,    0.69,  1.71,   -a - 0.43, 0.69, -b,
                0.0,   0.0,   0.0,    0.0,   0.0,    a,        -1.81, b,
                0.0,   0.0,   0.0,    0.0,   0.0,    -a,       1.81,  -b,
            ]);
            j
        },
    )
}

fn check<const N: usize>(
    field: &dyn VectorField<N>,
    y0: [f64; N],
    end: f64,
    published: [f64; N],
    (rtol, atol): (f64, f64),
    bound: f64,
) {
    for operations in OPERATIONS {
        let mut cvode = cvode::<N>(Method::Bdf, operations, rtol, atol);
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
    let published = [
        0.2083340149701255e-07,
        0.8333360770334713e-13,
        0.999999979166505,
    ];
    check(
        &robertson(),
        [1.0, 0.0, 0.0],
        1e11,
        published,
        (1e-11, 1e-22),
        1e-7,
    );
}

#[test]
fn van_der_pol_reaches_its_published_state() {
    let published = [1.706167732170483, -0.8928097010247975];
    check(
        &van_der_pol(),
        [2.0, 0.0],
        2.0,
        published,
        (1e-11, 1e-11),
        1e-7,
    );
}

#[test]
fn oregonator_reaches_its_published_state() {
    let published = [1.000814870318523, 1228.178521549917, 132.0554942846706];
    check(
        &oregonator(),
        [1.0, 2.0, 3.0],
        360.0,
        published,
        (1e-12, 1e-12),
        1e-6,
    );
}

#[test]
fn hires_reaches_its_published_state() {
    let published = [
        0.7371312573325668e-3,
        0.1442485726316185e-3,
        0.5888729740967575e-4,
        0.1175651343283149e-2,
        0.2386356198831331e-2,
        0.6238968252742796e-2,
        0.2849998395185769e-2,
        0.2850001604814231e-2,
    ];
    let y0 = [1.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0057];
    check(&hires(), y0, 321.8122, published, (1e-11, 1e-14), 1e-6);
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
    both(&oregonator(), [1.0, 2.0, 3.0], 360.0);
    both(
        &hires(),
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
        let mut cvode = cvode::<2>(Method::Bdf, Operations::Fixed, 1e-9, 1e-9);
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
    let field = robertson();
    let mut cvode = cvode::<3>(Method::Bdf, Operations::Fixed, 1e-8, 1e-14);
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
