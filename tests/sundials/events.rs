//! Event location: every crossing, in both directions or one, forwards and backwards in time.

use super::*;
use std::f64::consts::PI;
use twinslip::error::Error;
use twinslip::friction::{AnyLaw, Parameters};
use twinslip::integrate::{Control, CvodeIntegrator, Integrator, MAX_STEPS};
use twinslip::model::{Loading, two_interfaces};
use twinslip::sundials::{Mode, Problem, Reason};

/// Times and flags of all events up to `end`.
fn events<const N: usize>(
    cvode: &mut Cvode<N>,
    problem: &Problem<'_, N>,
    end: f64,
) -> Vec<(f64, Vec<i32>)> {
    let mut found = Vec::new();
    loop {
        let arrival = cvode.advance(problem, end, Mode::Normal).unwrap();
        match arrival.reason {
            Reason::Event => found.push((arrival.t, cvode.events_found().unwrap())),
            Reason::Time => return found,
            other => panic!("{other:?}"),
        }
    }
}

#[test]
fn all_zeros_of_sine_and_cosine_are_found_in_order() {
    let field = oscillator();
    let problem = Problem {
        events: Some(&|_, y: &State<2>, g| g.copy_from_slice(y.as_slice())),
        ..Problem::new(&field)
    };
    for operations in OPERATIONS {
        for sign in [1.0, -1.0] {
            let mut cvode = cvode::<2>(MultistepMethod::Bdf, operations, 1e-9, 1e-9);
            cvode.watch_events(2, &[]).unwrap();
            // x = sin(t + 1/4)
            let start = State::<2>::new(0.25_f64.sin(), 0.25_f64.cos());
            cvode.start(0.0, &start).unwrap();
            let found = events(&mut cvode, &problem, sign * 20.0 * PI);
            assert_eq!(found.len(), 40);
            for (i, (t, flags)) in found.iter().enumerate() {
                let phase = sign * t + sign * 0.25;
                let quarter = (phase / (0.5 * PI)).round();
                assert!(
                    (phase - quarter * 0.5 * PI).abs() < 1e-6,
                    "event {i} at {t}"
                );
                let which = usize::from(quarter.rem_euclid(2.0) == 1.0);
                assert!(flags[which].abs() == 1 && flags[1 - which] == 0);
            }
        }
    }
}

#[test]
fn one_direction_gives_half_the_crossings() {
    let field = oscillator();
    let problem = Problem {
        events: Some(&|_, y, g| g[0] = y[0]),
        ..Problem::new(&field)
    };
    for direction in [1, -1] {
        let mut cvode = cvode::<2>(MultistepMethod::Adams, Operations::Fixed, 1e-9, 1e-9);
        cvode.watch_events(1, &[direction]).unwrap();
        cvode.start(0.0, &State::<2>::new(1.0, 0.0)).unwrap();
        let found = events(&mut cvode, &problem, 20.0 * PI);
        assert_eq!(found.len(), 10);
        assert!(found.iter().all(|(_, flags)| flags == &[direction]));
    }
}

#[test]
fn every_crossing_of_a_stick_slip_run_is_found() {
    // Against the sign changes that an observer sees between steps.
    let law = AnyLaw::named("spinodal", Parameters::heslot_1994()).unwrap();
    let field = two_interfaces(law, Loading::new(10.0, 0.14).unwrap());
    let y0 = State::<3>::new(9.0, 0.01_f64.ln(), 0.0101_f64.ln());
    let level = |y: &State<3>| y[0] - 9.5;
    let tolerances = Tolerances::equal(1e-8).unwrap();
    let mut watched = 0;
    let mut observer = |step: &twinslip::integrate::Step<'_, 3>| {
        watched += usize::from(level(step.y0) * level(step.y1) < 0.0);
        Ok(Control::Continue)
    };
    CvodeIntegrator::new(MultistepMethod::Bdf, tolerances, MAX_STEPS)
        .unwrap()
        .flow(&*field, (0.0, 60.0), &y0, Some(&mut observer))
        .unwrap();

    let mut cvode = cvode::<3>(MultistepMethod::Bdf, Operations::Fixed, 1e-8, 1e-8);
    cvode.watch_events(1, &[]).unwrap();
    cvode.start(0.0, &y0).unwrap();
    let problem = Problem {
        events: Some(&|_, y, g| g[0] = level(y)),
        ..Problem::new(&*field)
    };
    let found = events(&mut cvode, &problem, 60.0);
    assert_eq!(found.len(), watched);
    assert!(watched >= 10, "{watched}");
}

#[test]
fn watching_nothing_given_and_non_finite_events_are_errors() {
    let field = oscillator();
    let mut cvode = cvode::<2>(MultistepMethod::Bdf, Operations::Fixed, 1e-8, 1e-8);
    cvode.watch_events(1, &[]).unwrap();
    cvode.start(0.0, &State::<2>::new(0.0, 1.0)).unwrap();
    assert!(matches!(
        cvode.advance(&Problem::new(&field), 1.0, Mode::Normal),
        Err(Error::Input(_))
    ));
    let problem = Problem {
        events: Some(&|_, _, g| g[0] = f64::NAN),
        ..Problem::new(&field)
    };
    assert!(matches!(
        cvode.advance(&problem, 1.0, Mode::Normal),
        Err(Error::NonFinite {
            what: "an event function",
            ..
        })
    ));
}

#[test]
fn more_events_than_c_can_count_are_refused() {
    let mut cvode = cvode::<2>(MultistepMethod::Bdf, OPERATIONS[0], 1e-9, 1e-9);
    let refused = cvode.watch_events(1 << 31, &[]);
    assert!(
        matches!(&refused, Err(Error::Parameter { value, .. }) if value.starts_with("2147483648")),
        "{refused:?}"
    );
    cvode.watch_events(1, &[]).unwrap();
}
