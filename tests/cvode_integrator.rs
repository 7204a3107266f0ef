//! CVODES as an integrator of the paper's systems: reference end states, blow-up, observers, tangents, and extremes.

use crate::common::trajectories;
use serde_json::Value;
use trajectories::Run;
use twinslip::error::Error;
use twinslip::field::{Jacobian, State};
use twinslip::friction::{AnyLaw, Parameters};
use twinslip::integrate::{Control, CvodeIntegrator, Integrator, MAX_STEPS, Step, Tolerances};
use twinslip::model::{Driven, Loading, two_interfaces};
use twinslip::sundials::MultistepMethod;

const METHODS: [MultistepMethod; 2] = [MultistepMethod::Bdf, MultistepMethod::Adams];

/// (tau, psi1, psi2) as text or numbers, into numbers.
fn three(value: &Value) -> [f64; 3] {
    let number = |v: &Value| v.as_str().expect("text").parse().expect("a number");
    [number(&value[0]), number(&value[1]), number(&value[2])]
}

fn chart(y: [f64; 3]) -> State<3> {
    State::<3>::new(y[0], y[1].ln(), y[2].ln())
}

fn number(value: &Value) -> f64 {
    value.as_str().expect("text").parse().expect("a number")
}

fn reference() -> Value {
    serde_json::from_str(include_str!("data/trajectories.json")).expect("valid JSON")
}

fn integrator(method: MultistepMethod, tolerance: f64) -> CvodeIntegrator<3> {
    CvodeIntegrator::new(method, Tolerances::equal(tolerance).unwrap(), MAX_STEPS).unwrap()
}

fn field(law: &str, stiffness: f64, driving: f64) -> Box<dyn Driven<3>> {
    let law = AnyLaw::named(law, Parameters::heslot_1994()).unwrap();
    two_interfaces(law, Loading::new(driving, stiffness).unwrap())
}

/// Stick-slip, one cycle and a half.
fn stick_slip() -> (Box<dyn Driven<3>>, State<3>, f64) {
    (
        field("spinodal", 0.14, 10.0),
        chart([9.0, 0.01, 0.0101]),
        10.0,
    )
}

#[test]
fn every_reference_end_state_is_reached_and_the_error_falls_with_the_tolerance() {
    for run in Run::all() {
        let field = two_interfaces(run.law, run.loading);
        for method in METHODS {
            let [loose, tight] = [1e-6, 1e-12].map(|tolerance| {
                let y = integrator(method, tolerance)
                    .flow(&*field, (0.0, run.end_time), &run.start, None)
                    .unwrap_or_else(|e| panic!("{} {method:?}: {e}", run.name));
                run.error(&y)
            });
            let name = &run.name;
            assert!(tight < 1e-7, "{name} {method:?}: {tight:e}");
            // At a steady state a loose run may be a thousand times better than its tolerance: there is nothing to fall then.
            let nothing_to_fall = loose < 1e-9 && tight < 1e-10;
            assert!(
                tight < 0.02 * loose || tight < 1e-11 || nothing_to_fall,
                "{name} {method:?}: {loose:e} falls to {tight:e} only"
            );
        }
    }
}

#[test]
fn the_finite_time_blow_up_is_named_with_its_time() {
    let blow_up = &reference()["dieterich_ruina_blow_up"];
    let expected = number(&blow_up["t_where_v1_passes_1e14"]);
    let field = field(
        "dieterich-ruina",
        number(&blow_up["K"]),
        number(&blow_up["V_H"]),
    );
    let y0 = chart(three(&blow_up["y0"]));
    for method in METHODS {
        for (tolerance, bound) in [
            (1e-4, 10.0),
            (1e-6, 0.1),
            (1e-8, 0.01),
            (1e-10, 1e-4),
            (1e-12, 1e-6),
        ] {
            let mut cvode = integrator(method, tolerance);
            let mut last = 0.0;
            let mut observer = |step: &Step<'_, 3>| {
                last = step.t1;
                Ok(Control::Continue)
            };
            let errors = [
                cvode.flow(&*field, (0.0, 1e3), &y0, None).unwrap_err(),
                cvode
                    .flow(&*field, (0.0, 1e3), &y0, Some(&mut observer))
                    .unwrap_err(),
                cvode.tangent_flow(&*field, (0.0, 1e3), &y0).unwrap_err(),
            ];
            for error in errors {
                let (t, rate) = match error {
                    Error::BlowUp { t, rate, .. } => (t, rate),
                    // So far off that from where the solution has got to there is a burst that ends.
                    Error::StepTooSmall { t, .. } | Error::TooFast { t, .. }
                        if tolerance == 1e-4 =>
                    {
                        (t, f64::INFINITY)
                    }
                    error => panic!("{method:?} {tolerance}: {error}"),
                };
                assert!((t - expected).abs() < bound, "{method:?}: {t}");
                assert!(rate > 1e9);
            }
            assert!((last - expected).abs() < bound);
            assert!(cvode.work().steps > 1000);
        }
    }
}

#[test]
fn backwards_undoes_forwards() {
    let field = field("dieterich-ruina", 0.45, 1.0);
    let y0 = chart([10.85, 1.99, 2.01]);
    for method in METHODS {
        let mut cvode = integrator(method, 1e-11);
        let y = cvode.flow(&*field, (3.0, 23.0), &y0, None).unwrap();
        assert!((y - y0).amax() > 0.1);
        let mut times = Vec::new();
        let mut observer = |step: &Step<'_, 3>| {
            times.push((step.t0, step.t1));
            let middle = step.dense(0.5 * (step.t0 + step.t1));
            assert!((middle - step.y0).amax() <= 2.0 * (step.y1 - step.y0).amax() + 1e-9);
            Ok(Control::Continue)
        };
        let back = cvode
            .flow(&*field, (23.0, 3.0), &y, Some(&mut observer))
            .unwrap();
        assert!((back - y0).amax() < 1e-7, "{method:?}: {}", back - y0);
        assert!(times.iter().all(|(t0, t1)| t1 < t0));
        assert_eq!(times.last().unwrap().1, 3.0);
        let (_, there) = cvode.tangent_flow(&*field, (3.0, 23.0), &y0).unwrap();
        let (_, back) = cvode.tangent_flow(&*field, (23.0, 3.0), &y).unwrap();
        assert!((there * back - Jacobian::<3>::identity()).amax() < 1e-5);
    }
}

#[test]
fn an_observer_sees_contiguous_steps_and_changes_nothing() {
    let (field, y0, end) = stick_slip();
    for method in METHODS {
        let mut cvode = integrator(method, 1e-9);
        let plain = cvode.flow(&*field, (0.0, end), &y0, None).unwrap();
        let work = cvode.work();
        let (mut t, mut y, mut steps) = (0.0, y0, 0);
        let mut observer = |step: &Step<'_, 3>| {
            assert_eq!((step.t0, *step.y0), (t, y));
            assert_eq!(step.dense(step.t1), *step.y1);
            assert!((step.dense(step.t0) - step.y0).amax() < 1e-6);
            (t, y) = (step.t1, *step.y1);
            steps += 1;
            Ok(Control::Continue)
        };
        let seen = cvode
            .flow(&*field, (0.0, end), &y0, Some(&mut observer))
            .unwrap();
        assert_eq!((seen, cvode.work()), (plain, work), "{method:?}");
        assert_eq!((t, y, steps), (end, plain, work.steps));
    }
}

#[test]
fn dense_output_agrees_with_tight_runs_from_the_same_step() {
    let (field, y0, end) = stick_slip();
    for method in METHODS {
        let mut seen = Vec::new();
        let mut observer = |step: &Step<'_, 3>| {
            let t = step.t0 + 0.37 * (step.t1 - step.t0);
            seen.push((step.t0, *step.y0, t, step.dense(t)));
            Ok(Control::Continue)
        };
        integrator(method, 1e-8)
            .flow(&*field, (0.0, end), &y0, Some(&mut observer))
            .unwrap();
        assert!(seen.len() > 300);
        let mut tight = integrator(method, 1e-12);
        for (t0, y0, t, y) in seen {
            let exact = tight.flow(&*field, (t0, t), &y0, None).unwrap();
            let error = (y - exact).amax();
            assert!(error < 1e-6, "{method:?} at {t}: {error:e}");
        }
    }
}

#[test]
fn an_observer_may_stop_or_fail() {
    let (field, y0, end) = stick_slip();
    let mut cvode = integrator(MultistepMethod::Bdf, 1e-8);
    let mut stopped = None;
    let mut observer = |step: &Step<'_, 3>| {
        if step.t1 < 5.0 {
            return Ok(Control::Continue);
        }
        stopped = Some((step.t1, *step.y1));
        Ok(Control::Stop)
    };
    let y = cvode
        .flow(&*field, (0.0, end), &y0, Some(&mut observer))
        .unwrap();
    let (t, seen) = stopped.unwrap();
    assert_eq!(y, seen);
    assert!(t < end);
    let mut fails = |_: &Step<'_, 3>| Err(Error::Input("enough".to_owned()));
    let error = cvode
        .flow(&*field, (0.0, end), &y0, Some(&mut fails))
        .unwrap_err();
    assert_eq!(error, Error::Input("enough".to_owned()));
}

#[test]
fn too_many_steps_say_where_and_how_many() {
    let (field, y0, end) = stick_slip();
    for limit in [7, 1500] {
        let mut cvode = CvodeIntegrator::new(
            MultistepMethod::Bdf,
            Tolerances::equal(1e-12).unwrap(),
            limit,
        )
        .unwrap();
        let mut observer = |_: &Step<'_, 3>| Ok(Control::Continue);
        let errors = [
            cvode.flow(&*field, (0.0, end), &y0, None),
            cvode.flow(&*field, (0.0, end), &y0, Some(&mut observer)),
        ];
        for result in errors {
            match result {
                Err(Error::TooManySteps {
                    t,
                    end: asked,
                    limit: bound,
                }) => {
                    assert_eq!((asked, bound), (end, limit));
                    assert!(t > 0.0 && t < end);
                }
                other => panic!("{other:?}"),
            }
            assert_eq!(cvode.work().steps, limit);
        }
    }
}

#[test]
fn the_tangent_agrees_with_differences_and_with_liouville() {
    let (field, y0, end) = stick_slip();
    for method in METHODS {
        let mut cvode = integrator(method, 1e-11);
        let (y, m) = cvode.tangent_flow(&*field, (0.0, end), &y0).unwrap();
        let plain = cvode.flow(&*field, (0.0, end), &y0, None).unwrap();
        assert!((y - plain).amax() < 1e-6);
        const STEP: f64 = 1e-5;
        for column in 0..3 {
            let mut shifted = |by: f64| {
                let mut start = y0;
                start[column] += by;
                cvode.flow(&*field, (0.0, end), &start, None).unwrap()
            };
            let difference = (shifted(STEP) - shifted(-STEP)) / (2.0 * STEP);
            let error = (m.column(column) - difference).amax() / m.amax();
            assert!(error < 1e-3, "{method:?} column {column}: {error:e}");
        }
        // ln det M = integral of tr J dt, by Simpson's rule over every step.
        let mut integral = 0.0;
        let mut observer = |step: &Step<'_, 3>| {
            let trace = |y: &State<3>| field.jacobian(y).trace();
            let middle = step.dense(0.5 * (step.t0 + step.t1));
            integral += (step.t1 - step.t0) / 6.0
                * (trace(step.y0) + 4.0 * trace(&middle) + trace(step.y1));
            Ok(Control::Continue)
        };
        cvode
            .flow(&*field, (0.0, end), &y0, Some(&mut observer))
            .unwrap();
        // The determinant is tiny: M loses it to cancellation of about the product of its scale.
        let noise = 1e-6 * m.amax().powi(3);
        assert!(
            (m.determinant() - integral.exp()).abs() < noise,
            "{method:?}: {} {}",
            m.determinant(),
            integral.exp()
        );
    }
}

#[test]
fn a_flow_over_no_time_is_the_identity_and_names_are_those_of_the_command_line() {
    let (field, y0, _) = stick_slip();
    let mut cvode = integrator(MultistepMethod::Bdf, 1e-8);
    assert_eq!(cvode.flow(&*field, (2.0, 2.0), &y0, None).unwrap(), y0);
    let (y, m) = cvode.tangent_flow(&*field, (2.0, 2.0), &y0).unwrap();
    assert_eq!((y, m), (y0, Jacobian::<3>::identity()));
    assert_eq!(cvode.name(), "cvode-bdf");
    assert_eq!(
        integrator(MultistepMethod::Adams, 1e-8).name(),
        "cvode-adams"
    );
}

#[test]
fn an_interval_of_a_few_spacings_of_time_is_integrated_too() {
    let (field, y0, _) = stick_slip();
    for method in METHODS {
        let mut cvode = integrator(method, 1e-8);
        for end in [
            1e6_f64.next_up(),
            1e6_f64.next_down(),
            1e6 + 1e-9,
            1e6 + 1e-8,
        ] {
            let expected = y0 + field.f(&y0) * (end - 1e6);
            let mut seen = 0.0;
            let mut observer = |step: &Step<'_, 3>| {
                assert!((step.dense(step.t1) - step.y1).amax() < 1e-12);
                seen = step.t1;
                Ok(Control::Continue)
            };
            let y = cvode
                .flow(&*field, (1e6, end), &y0, Some(&mut observer))
                .unwrap();
            assert!(
                (y - expected).amax() < 1e-10,
                "{method:?}: {}",
                y - expected
            );
            assert_eq!(seen, end);
            let (_, m) = cvode.tangent_flow(&*field, (1e6, end), &y0).unwrap();
            let expected = Jacobian::<3>::identity() + field.jacobian(&y0) * (end - 1e6);
            assert!((m - expected).amax() < 1e-10);
        }
    }
}

#[test]
fn one_solver_serves_many_fields_as_fresh_ones_would() {
    let (first, y0, end) = stick_slip();
    let second = field("dieterich-ruina", 0.45, 1.0);
    let mut reused = integrator(MultistepMethod::Adams, 1e-9);
    for field in [&first, &second, &first] {
        let fresh = integrator(MultistepMethod::Adams, 1e-9).flow(&**field, (0.0, end), &y0, None);
        assert_eq!(reused.flow(&**field, (0.0, end), &y0, None), fresh);
        reused.tangent_flow(&**field, (0.0, 1.0), &y0).unwrap();
    }
}

#[test]
fn extremes_end_in_a_right_answer_or_a_typed_error() {
    // A third of them, another one each time.
    const PARTS: u64 = 3;
    let mut at = crate::common::random() % PARTS;
    let (mut answers, mut failures) = (0, 0);
    for law in AnyLaw::NAMES {
        for k in [1e-6, 1e-2, 1.0, 1e4] {
            for v_h in [1e-8, 1e-3, 1.0, 1e8] {
                for tau in [-50.0, 0.0, 10.0, 500.0] {
                    for psi in [1e-300, 1e-10, 0.5, 1.0] {
                        at += 1;
                        if !at.is_multiple_of(PARTS) {
                            continue;
                        }
                        let field = field(law, k, v_h);
                        let y0 = chart([tau, psi, 0.9 * psi]);
                        // Long enough to leave the start, short enough for Adams at stiff points.
                        let end = 10.0 / (k * v_h).max(v_h).min(1e3);
                        let ends = METHODS.map(|method| {
                            CvodeIntegrator::new(method, Tolerances::equal(1e-8).unwrap(), 20_000)
                                .unwrap()
                                .flow(&*field, (0.0, end), &y0, None)
                        });
                        for end in &ends {
                            match end {
                                Ok(y) => {
                                    assert!(y.iter().all(|x| x.is_finite()));
                                    answers += 1;
                                }
                                Err(
                                    Error::NonFinite { .. }
                                    | Error::BlowUp { .. }
                                    | Error::TooFast { .. }
                                    | Error::StepTooSmall { .. }
                                    | Error::TooManySteps { .. },
                                ) => failures += 1,
                                Err(other) => panic!("{law} {k} {v_h} {tau} {psi}: {other}"),
                            }
                        }
                        // The other laws have runs there whose errors grow beyond comparison.
                        if let ("spinodal", [Ok(bdf), Ok(adams)]) = (law, &ends) {
                            let difference = (bdf - adams).amax() / (1.0 + bdf.amax());
                            assert!(difference < 1e-4, "{k} {v_h} {tau} {psi}: {difference:e}");
                        }
                    }
                }
            }
        }
    }
    assert!(answers > failures, "{answers} answers, {failures} failures");
}
