//! Forward sensitivities against closed forms, differences, and without the error control that CVODES leaves off.

use super::*;
use twinslip::friction::{AnyLaw, Parameters};
use twinslip::model::{Loading, Parameter, two_interfaces};
use twinslip::sundials::{ErrorControl, Mode, Problem, Sensitivity, SensitivityMethod};

const SCHEMES: [SensitivityMethod; 2] = [
    SensitivityMethod::Simultaneous,
    SensitivityMethod::Staggered,
];

fn settings(scheme: SensitivityMethod) -> Sensitivity {
    Sensitivity {
        scheme,
        ..Sensitivity::default()
    }
}

fn unit<const N: usize>() -> Vec<State<N>> {
    (0..N)
        .map(|i| {
            let mut e = State::zeros();
            e[i] = 1.0;
            e
        })
        .collect()
}

#[test]
fn logistic_growth_has_its_closed_form_for_initial_value_and_rate() {
    // y' = r y (1 - y): y = y0 / (y0 + (1 - y0) e), e = exp(-r t);
    // dy/dy0 = e / (y0 + (1 - y0) e)^2, dy/dr = y0 (1 - y0) t e / (y0 + (1 - y0) e)^2.
    let (r, y0, t) = (1.3_f64, 0.2_f64, 3.0_f64);
    let field = Field(
        |y: &State<1>| y * (r * (1.0 - y[0])),
        |y: &State<1>| Jacobian::<1>::new(r * (1.0 - 2.0 * y[0])),
    );
    let problem = Problem {
        forcing: Some(&|column, y| match column {
            0 => State::<1>::zeros(),
            _ => State::<1>::new(y[0] * (1.0 - y[0])),
        }),
        ..Problem::new(&field)
    };
    let e = (-r * t).exp();
    let below = (y0 + (1.0 - y0) * e).powi(2);
    let exact = [e / below, y0 * (1.0 - y0) * t * e / below];
    let columns = [State::<1>::new(1.0), State::<1>::new(0.0)];
    for method in METHODS {
        for operations in OPERATIONS {
            for scheme in SCHEMES {
                let mut cvode = cvode::<1>(method, operations, 1e-10, 1e-10);
                for _ in 0..2 {
                    cvode
                        .start_with_sensitivities(
                            0.0,
                            &State::<1>::new(y0),
                            &columns,
                            &settings(scheme),
                        )
                        .unwrap();
                    cvode.advance(&problem, t, Mode::Normal).unwrap();
                    let s = cvode.sensitivities().unwrap();
                    let error = relative_error(&[s[0][0], s[1][0]], &exact);
                    assert!(
                        error < 1e-7,
                        "{method:?} {operations:?} {scheme:?}: {error:e}"
                    );
                }
            }
        }
    }
}

#[test]
fn the_oscillator_turns_its_tangents_and_dense_ones_agree() {
    let field = oscillator();
    let problem = Problem::new(&field);
    for scheme in SCHEMES {
        let mut cvode = cvode::<2>(MultistepMethod::Adams, Operations::Fixed, 1e-10, 1e-10);
        cvode
            .start_with_sensitivities(0.0, &State::<2>::new(0.3, 0.7), &unit(), &settings(scheme))
            .unwrap();
        let arrival = loop {
            let arrival = cvode.advance(&problem, 5.0, Mode::OneStep).unwrap();
            if arrival.t > 4.0 {
                break arrival;
            }
        };
        let t = arrival.t - 0.3 * cvode.step_size().unwrap();
        let s = cvode.dense_sensitivities(t).unwrap();
        for (value, exact) in [
            (s[0][0], t.cos()),
            (s[0][1], -t.sin()),
            (s[1][0], t.sin()),
            (s[1][1], t.cos()),
        ] {
            assert!((value - exact).abs() < 1e-7, "{scheme:?}: {value} {exact}");
        }
        assert!(cvode.dense_sensitivities(t + 100.0).is_err());
    }
}

#[test]
fn sensitivities_come_and_go_between_starts() {
    let field = oscillator();
    let problem = Problem::new(&field);
    let y0 = State::<2>::new(0.3, 0.7);
    let mut cvode = cvode::<2>(MultistepMethod::Bdf, Operations::Fixed, 1e-9, 1e-9);
    let mut plain = None;
    for count in [0, 2, 0, 1, 2, 2, 0] {
        if count == 0 {
            cvode.start(0.0, &y0).unwrap();
        } else {
            let columns = unit();
            cvode
                .start_with_sensitivities(0.0, &y0, &columns[..count], &Sensitivity::default())
                .unwrap();
        }
        cvode.advance(&problem, 1.0, Mode::Normal).unwrap();
        match count {
            0 => {
                assert!(cvode.sensitivities().is_err());
                let state = *plain.get_or_insert(cvode.state());
                assert_eq!(cvode.state(), state);
            }
            count => {
                let s = cvode.sensitivities().unwrap();
                assert_eq!(s.len(), count);
                assert!((s[0][0] - 1.0_f64.cos()).abs() < 1e-6);
            }
        }
    }
}

/// One cycle and a half of stick-slip.
fn stick_slip() -> (Box<dyn twinslip::model::Driven<3>>, State<3>, f64) {
    let law = AnyLaw::named("spinodal", Parameters::heslot_1994()).unwrap();
    let field = two_interfaces(law, Loading::new(10.0, 0.14).unwrap());
    (
        field,
        State::<3>::new(9.0, 0.01_f64.ln(), 0.0101_f64.ln()),
        10.0,
    )
}

fn tangent(rtol: f64, settings: &Sensitivity) -> Jacobian<3> {
    let (field, y0, t) = stick_slip();
    let mut cvode = cvode::<3>(MultistepMethod::Bdf, Operations::Fixed, rtol, rtol);
    cvode
        .start_with_sensitivities(0.0, &y0, &unit(), settings)
        .unwrap();
    cvode
        .advance(&Problem::new(&*field), t, Mode::Normal)
        .unwrap();
    Jacobian::<3>::from_columns(&cvode.sensitivities().unwrap())
}

#[test]
fn stick_slip_agrees_with_central_differences_in_state_and_parameters() {
    let (field, y0, t) = stick_slip();
    let mut cvode = cvode::<3>(MultistepMethod::Bdf, Operations::Fixed, 1e-11, 1e-11);
    let mut columns = unit::<3>();
    columns.extend([State::<3>::zeros(); 2]);
    let problem = Problem {
        forcing: Some(&|column, y| match column {
            0..3 => State::zeros(),
            _ => field.parameter_derivative(y, Parameter::PLANE[column - 3]),
        }),
        ..Problem::new(&*field)
    };
    cvode
        .start_with_sensitivities(0.0, &y0, &columns, &Sensitivity::default())
        .unwrap();
    cvode.advance(&problem, t, Mode::Normal).unwrap();
    let s = cvode.sensitivities().unwrap();

    let law = AnyLaw::named("spinodal", Parameters::heslot_1994()).unwrap();
    let mut end = |y0: State<3>, v: f64, k: f64| {
        let field = two_interfaces(law, Loading::new(v, k).unwrap());
        cvode.start(0.0, &y0).unwrap();
        cvode
            .advance(&Problem::new(&*field), t, Mode::Normal)
            .unwrap();
        cvode.state()
    };
    const STEP: f64 = 1e-5;
    for column in 0..5 {
        let mut shifted = |sign: f64| match column {
            0..3 => {
                let mut y = y0;
                y[column] += sign * STEP;
                end(y, 10.0, 0.14)
            }
            3 => end(y0, 10.0 + sign * STEP, 0.14),
            _ => end(y0, 10.0, 0.14 + sign * STEP),
        };
        let difference = (shifted(1.0) - shifted(-1.0)) / (2.0 * STEP);
        let scale = s[column].amax();
        let error = (s[column] - difference).amax() / scale;
        assert!(error < 1e-3, "column {column}: {error:e} of {scale}");
    }
}

#[test]
fn own_tolerances_are_kept() {
    let reference = tangent(1e-12, &Sensitivity::default());
    let own = |tolerance| Sensitivity {
        tolerances: Some(Tolerances::equal(tolerance).unwrap()),
        ..Sensitivity::default()
    };
    let error = |s: &Sensitivity| (tangent(1e-6, s) - reference).amax() / reference.amax();
    let (tight, loose) = (error(&own(1e-10)), error(&own(1e-4)));
    assert!(tight < 0.1 * loose, "tight {tight:e}, loose {loose:e}");
}

#[test]
fn without_error_control_sensitivities_are_worse_than_their_tolerance_says() {
    let reference = tangent(1e-12, &Sensitivity::default());
    let error = |error_control| {
        let settings = Sensitivity {
            error_control,
            ..Sensitivity::default()
        };
        (tangent(1e-6, &settings) - reference).amax() / reference.amax()
    };
    let on = error(ErrorControl::Full);
    let off = error(ErrorControl::OffAndWrongWithoutWarning);
    assert!(off > 10.0 * on, "off {off:e}, on {on:e}");
}

#[test]
fn non_finite_columns_and_no_columns_are_refused() {
    let mut cvode = cvode::<2>(MultistepMethod::Bdf, Operations::Fixed, 1e-8, 1e-8);
    let y0 = State::<2>::new(0.3, 0.7);
    let bad = [State::<2>::new(f64::NAN, 0.0)];
    let default = Sensitivity::default();
    assert!(
        cvode
            .start_with_sensitivities(0.0, &y0, &bad, &default)
            .is_err()
    );
    assert!(
        cvode
            .start_with_sensitivities(0.0, &y0, &[], &default)
            .is_err()
    );
}
