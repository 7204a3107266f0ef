//! The Rosenbrock integrators: order, reference trajectories, landing, observers, failures.

use crate::common::trajectories;
use trajectories::Run;
use twinslip::error::{Error, Result};
use twinslip::field::{Jacobian, State, VectorField};
use twinslip::friction::{AnyLaw, Parameters};
use twinslip::integrate::{
    Control, Integrator, MAX_STEPS, Rosenbrock, RosenbrockMethod, Step, Tolerances,
};
use twinslip::model::{Driven, Loading, symmetric, two_interfaces};

fn integrator<const N: usize>(method: RosenbrockMethod, tolerance: f64) -> Rosenbrock<N> {
    Rosenbrock::new(method, Tolerances::equal(tolerance).unwrap(), MAX_STEPS).unwrap()
}

/// x' = y + (1 - r^2) x, y' = -x + (1 - r^2) y: a limit cycle, with the solution known in polar coordinates.
struct Spiral;

impl Spiral {
    const START: [f64; 2] = [0.2, 0.0];

    fn solution(t: f64) -> State<2> {
        let r = (1.0 + (1.0 / 0.04 - 1.0) * (-2.0 * t).exp()).powf(-0.5);
        State::<2>::new(r * t.cos(), -r * t.sin())
    }
}

impl VectorField<2> for Spiral {
    fn f(&self, s: &State<2>) -> State<2> {
        let g = 1.0 - s.norm_squared();
        State::<2>::new(s[1] + g * s[0], -s[0] + g * s[1])
    }

    fn jacobian(&self, s: &State<2>) -> Jacobian<2> {
        let (g, x, y) = (1.0 - s.norm_squared(), s[0], s[1]);
        Jacobian::<2>::new(
            g - 2.0 * x * x,
            1.0 - 2.0 * x * y,
            -1.0 - 2.0 * x * y,
            g - 2.0 * y * y,
        )
    }

    fn second_derivative(&self, s: &State<2>, u: &State<2>, v: &State<2>) -> State<2> {
        -2.0 * (s * u.dot(v) + u * s.dot(v) + v * s.dot(u))
    }
}

/// Errors after three time units in `steps` equal steps: of y at the end, and the largest of the continuous solution.
fn fixed_step_errors(method: RosenbrockMethod, steps: u32) -> (f64, f64) {
    // So loose that each call takes one step of its whole length.
    let tolerances = Tolerances::new(0.5, 1e9).unwrap();
    let mut rosenbrock = Rosenbrock::<2>::new(method, tolerances, 1).unwrap();
    let h = 3.0 / f64::from(steps);
    let mut y = State::<2>::from(Spiral::START);
    let mut dense_error = 0.0_f64;
    for n in 0..steps {
        let t = f64::from(n) * h;
        let mut look = |step: &Step<'_, 2>| {
            for theta in [0.15, 0.35, 0.5, 0.65, 0.85] {
                let at = step.t0 + theta * (step.t1 - step.t0);
                dense_error = dense_error.max((step.dense(at) - Spiral::solution(at)).amax());
            }
            Ok(Control::Continue)
        };
        y = rosenbrock
            .flow(&Spiral, (t, t + h), &y, Some(&mut look))
            .unwrap();
    }
    ((y - Spiral::solution(3.0)).amax(), dense_error)
}

/// The slope of log error against log step over several halvings, by least squares.
fn slope(errors: &[f64]) -> f64 {
    let middle = (errors.len() - 1) as f64 / 2.0;
    let (mut products, mut squares) = (0.0, 0.0);
    for (i, error) in errors.iter().enumerate() {
        let x = middle - i as f64;
        products += x * error.log2();
        squares += x * x;
    }
    products / squares
}

#[test]
fn every_method_converges_with_its_order() {
    for method in RosenbrockMethod::ALL {
        let tableau = method.tableau();
        // Of the continuous solution the local error shows, one order higher than its name, or that of y0 if larger.
        let (ends, dense): (Vec<f64>, Vec<f64>) =
            (0..5).map(|i| fixed_step_errors(method, 30 << i)).unzip();
        let (end, dense) = (slope(&ends), slope(&dense));
        println!(
            "{}: {end:.3}, continuous {dense:.3}; {ends:?}",
            tableau.name
        );
        assert!(
            (end - f64::from(tableau.order)).abs() < 0.15,
            "{}: {end}",
            tableau.name
        );
        let expected = f64::from((tableau.dense_order + 1).min(tableau.order));
        assert!((dense - expected).abs() < 0.2, "{}: {dense}", tableau.name);
    }
}

/// Within one step from an exact state the continuous solution errs by h to the power of its order plus one.
#[test]
fn every_continuous_solution_converges_with_its_order() {
    let tolerances = Tolerances::new(0.5, 1e9).unwrap();
    for method in RosenbrockMethod::ALL {
        let error = |halvings: i32| {
            let h = 0.2 * 0.5_f64.powi(halvings);
            let mut error = 0.0;
            let mut look = |step: &Step<'_, 2>| {
                error = (step.dense(0.4 * h) - Spiral::solution(0.4 * h)).amax();
                Ok(Control::Continue)
            };
            let mut rosenbrock = Rosenbrock::<2>::new(method, tolerances, 1).unwrap();
            let start = State::<2>::from(Spiral::START);
            rosenbrock
                .flow(&Spiral, (0.0, h), &start, Some(&mut look))
                .unwrap();
            error
        };
        let tableau = method.tableau();
        let local = slope(&(0..5).map(error).collect::<Vec<_>>());
        println!("{}: {local:.3}", tableau.name);
        let expected = f64::from(tableau.dense_order + 1);
        assert!((local - expected).abs() < 0.2, "{}: {local}", tableau.name);
    }
}

fn run_error(run: &Run, method: RosenbrockMethod, tolerance: f64) -> Result<f64> {
    let t = (0.0, run.end_time);
    if run.is_symmetric() {
        let field = symmetric(run.law, run.loading);
        let start = State::<2>::new(run.start[0], run.start[1]);
        let end = integrator::<2>(method, tolerance).flow(&*field, t, &start, None)?;
        Ok(run.error(&end))
    } else {
        let field = two_interfaces(run.law, run.loading);
        let end = integrator::<3>(method, tolerance).flow(&*field, t, &run.start, None)?;
        Ok(run.error(&end))
    }
}

#[test]
fn rodas5p_reaches_every_reference_end() {
    for run in Run::all() {
        let error = run_error(&run, RosenbrockMethod::Rodas5P, 1e-13).unwrap();
        println!("{}: {error:.1e}", run.name);
        assert!(error < 1e-9, "{}: {error:e}", run.name);
    }
}

#[test]
fn the_error_falls_with_the_tolerance() {
    // A step of tolerance^(1/(q+1)), q the order of the estimate, leaves an error of that step^p.
    let cases = [
        (RosenbrockMethod::Rodas5P, 1e-7, 1e-11, 1.0),
        (RosenbrockMethod::Rodas4, 1e-7, 1e-11, 1.0),
        (RosenbrockMethod::Ros23, 1e-5, 1e-8, 2.0 / 3.0),
    ];
    for name in [
        "A3_K0.14_VH100, t = 2",
        "D_K0.2_VH0.102_torus, t = 2000",
        "E2_DR_K0.40, t = 50",
    ] {
        let run = Run::named(name);
        for (method, loose, tight, expected) in cases {
            let [first, second] =
                [loose, tight].map(|tolerance| run_error(&run, method, tolerance).unwrap());
            let exponent = (first / second).log10() / (loose / tight).log10();
            println!("{name}, {method:?}: {first:.1e} to {second:.1e}, exponent {exponent:.2}");
            assert!(
                (exponent - expected).abs() < 0.2,
                "{name}, {method:?}: {exponent}"
            );
        }
    }
}

fn paper_field(driving: f64, stiffness: f64) -> Box<dyn Driven<3>> {
    let law = AnyLaw::Spinodal(Parameters::heslot_1994().spinodal());
    two_interfaces(law, Loading::new(driving, stiffness).unwrap())
}

#[test]
fn backwards_returns_to_the_start() {
    let field = paper_field(10.0, 0.14);
    let start = State::<3>::new(10.0, -2.0, -4.0);
    for (method, tolerance) in [
        (RosenbrockMethod::Rodas5P, 1e-11),
        (RosenbrockMethod::Rodas4, 1e-11),
        (RosenbrockMethod::Ros23, 1e-9),
    ] {
        let mut rosenbrock = integrator::<3>(method, tolerance);
        let there = rosenbrock.flow(&*field, (0.0, 0.5), &start, None).unwrap();
        assert!((there - start).amax() > 0.1);
        let back = rosenbrock.flow(&*field, (0.5, 0.0), &there, None).unwrap();
        let error = (back - start).amax();
        println!("{method:?}: {error:e}");
        assert!(error < 1e4 * tolerance, "{method:?}: {error:e}");
    }
}

#[test]
fn steps_join_land_on_the_end_and_leave_no_sliver() {
    let field = paper_field(10.0, 0.14);
    let start = State::<3>::new(10.0, -2.0, -4.0);
    for method in RosenbrockMethod::ALL {
        for end in [1.0, 1.7, -0.3] {
            let (mut now, mut y, mut lengths) = (0.0, start, Vec::new());
            let mut see = |step: &Step<'_, 3>| {
                assert_eq!((step.t0, *step.y0), (now, y));
                for (t, exact) in [(step.t0, step.y0), (step.t1, step.y1)] {
                    assert!((step.dense(t) - exact).amax() < 1e-13);
                }
                (now, y) = (step.t1, *step.y1);
                lengths.push((step.t1 - step.t0).abs());
                Ok(Control::Continue)
            };
            let mut rosenbrock = integrator::<3>(method, 1e-6);
            let last = rosenbrock
                .flow(&*field, (0.0, end), &start, Some(&mut see))
                .unwrap();
            assert_eq!((now, y), (end, last));
            assert_eq!(lengths.len(), rosenbrock.work().steps);
            let [before, last] = lengths[lengths.len() - 2..] else {
                panic!()
            };
            assert!(last > 0.15 * before, "{method:?}: {last} after {before}");
        }
    }
}

#[test]
fn an_observer_changes_nothing_and_can_stop_or_fail() {
    let field = paper_field(10.0, 0.14);
    let start = State::<3>::new(10.0, -2.0, -4.0);
    let mut rosenbrock = integrator::<3>(RosenbrockMethod::Rodas5P, 1e-6);
    let alone = rosenbrock.flow(&*field, (0.0, 1.0), &start, None).unwrap();
    let work = rosenbrock.work();
    let mut look = |step: &Step<'_, 3>| {
        step.dense(0.5 * (step.t0 + step.t1));
        Ok(Control::Continue)
    };
    let seen = rosenbrock
        .flow(&*field, (0.0, 1.0), &start, Some(&mut look))
        .unwrap();
    assert_eq!((seen, rosenbrock.work()), (alone, work));

    let mut count = 0;
    let mut end_of_third = start;
    let mut stop = |step: &Step<'_, 3>| {
        count += 1;
        end_of_third = *step.y1;
        Ok(if count == 3 {
            Control::Stop
        } else {
            Control::Continue
        })
    };
    let stopped = rosenbrock
        .flow(&*field, (0.0, 1.0), &start, Some(&mut stop))
        .unwrap();
    assert_eq!(
        (count, rosenbrock.work().steps, stopped),
        (3, 3, end_of_third)
    );

    let mut fail = |_: &Step<'_, 3>| Err(Error::Input("enough".into()));
    let failed = rosenbrock.flow(&*field, (0.0, 1.0), &start, Some(&mut fail));
    assert_eq!(failed, Err(Error::Input("enough".into())));
}

#[test]
fn no_time_no_change_and_no_nonsense() {
    let field = paper_field(10.0, 0.14);
    let start = State::<3>::new(10.0, -2.0, -4.0);
    let mut rosenbrock = integrator::<3>(RosenbrockMethod::Rodas4, 1e-6);
    assert_eq!(
        rosenbrock.flow(&*field, (3.0, 3.0), &start, None),
        Ok(start)
    );
    let (y, tangent) = rosenbrock
        .tangent_flow(&*field, (3.0, 3.0), &start)
        .unwrap();
    assert_eq!((y, tangent), (start, Jacobian::identity()));

    let lost = State::<3>::new(f64::NAN, 0.0, 0.0);
    for outcome in [
        rosenbrock.flow(&*field, (0.0, 1.0), &lost, None).map(drop),
        rosenbrock
            .tangent_flow(&*field, (0.0, 1.0), &lost)
            .map(drop),
        // sinh(1000) overflows
        rosenbrock
            .flow(
                &*field,
                (0.0, 1.0),
                &State::<3>::new(1000.0, 0.0, 0.0),
                None,
            )
            .map(drop),
    ] {
        assert!(
            matches!(outcome, Err(Error::NonFinite { t: 0.0, .. })),
            "{outcome:?}"
        );
    }
    let outcome = rosenbrock.flow(&*field, (0.0, f64::INFINITY), &start, None);
    assert!(matches!(outcome, Err(Error::Parameter { .. })));
    let tolerances = Tolerances::equal(1e-6).unwrap();
    assert!(Rosenbrock::<3>::new(RosenbrockMethod::Rodas4, tolerances, 0).is_err());
}

#[test]
fn the_bound_on_steps_holds() {
    let field = paper_field(10.0, 0.14);
    let start = State::<3>::new(10.0, -2.0, -4.0);
    for method in RosenbrockMethod::ALL {
        let tolerances = Tolerances::equal(1e-8).unwrap();
        let mut rosenbrock = Rosenbrock::<3>::new(method, tolerances, 50).unwrap();
        let outcome = rosenbrock.flow(&*field, (0.0, 100.0), &start, None);
        let work = rosenbrock.work();
        assert_eq!(work.steps + work.rejected, 50);
        assert!(
            matches!(outcome, Err(Error::TooManySteps { t, end: 100.0, limit: 50 }) if t > 0.0)
        );
    }
}

#[test]
fn a_finite_time_singularity_is_found_where_it_is() {
    let law = AnyLaw::DieterichRuina(Parameters::heslot_1994().dieterich_ruina());
    let field = two_interfaces(law, Loading::new(1.0, 0.35).unwrap());
    let start = State::<3>::new(10.85, 1.99_f64.ln(), 2.01_f64.ln());
    for (method, tolerance, allowed) in [
        (RosenbrockMethod::Rodas5P, 1e-14, 1e-9),
        (RosenbrockMethod::Rodas4, 1e-13, 1e-9),
        (RosenbrockMethod::Ros23, 1e-8, 1e-2),
    ] {
        let outcome = integrator::<3>(method, tolerance).flow(&*field, (0.0, 300.0), &start, None);
        let Err(Error::BlowUp { t, rate, .. }) = outcome else {
            panic!("{method:?}: {outcome:?}");
        };
        println!("{method:?}: t = {t:.12}, rate {rate:e}");
        assert!((t - 226.641267031787).abs() < allowed, "{method:?}: {t}");
        assert!(rate > 1e8);
    }
}

#[test]
fn methods_are_known_by_name() {
    for method in RosenbrockMethod::ALL {
        let name = method.tableau().name;
        assert_eq!(RosenbrockMethod::named(name), Ok(method));
        assert_eq!(integrator::<3>(method, 1e-6).name(), name);
    }
    assert!(RosenbrockMethod::named("rodas6").is_err_and(|error| error.is_input()));
}
