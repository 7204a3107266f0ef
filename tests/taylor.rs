//! The Taylor method: end states, convergence, tangents, parameters, Liouville, both arithmetics, the switching method.

#[allow(dead_code, reason = "one classic serves here")]
use crate::common::stiff_classics;
use crate::common::trajectories;
use stiff_classics::Robertson;
use trajectories::Run;
use twinslip::Error;
use twinslip::field::{Jacobian, State, VectorField};
use twinslip::friction::{AnyLaw, Parameters};
use twinslip::integrate::{
    Auto, Control, Integrator, MAX_STEPS, Rosenbrock, RosenbrockMethod, Step, Taylor, Tolerances,
};
use twinslip::model::normal_form::StrongResonance;
use twinslip::model::{Loading, Parameter, Smooth, single_interface, symmetric, two_interfaces};

fn taylor(tolerance: f64) -> Taylor {
    Taylor::new(Tolerances::equal(tolerance).unwrap(), MAX_STEPS).unwrap()
}

fn auto<const N: usize>(tolerance: f64) -> Auto<N> {
    Auto::new(Tolerances::equal(tolerance).unwrap(), MAX_STEPS).unwrap()
}

/// The error at the end of a run, in two dimensions where it is symmetric.
fn error_of(
    run: &Run,
    two: &mut dyn Integrator<2>,
    three: &mut dyn Integrator<3>,
) -> Result<f64, Error> {
    let t = (0.0, run.end_time);
    if run.is_symmetric() {
        let field = symmetric(run.law, run.loading);
        let start = State::<2>::new(run.start[0], run.start[1]);
        Ok(run.error(&two.flow(&*field, t, &start, None)?))
    } else {
        let field = two_interfaces(run.law, run.loading);
        Ok(run.error(&three.flow(&*field, t, &run.start, None)?))
    }
}

#[test]
fn end_states_are_met() {
    for run in Run::all() {
        let error = error_of(&run, &mut taylor(1e-15), &mut taylor(1e-15)).unwrap();
        // The rounding of ln psi at the start alone moves the ends by up to 1e-12.
        assert!(error < 5e-12, "{}: {error:e}", run.name);
        let error = error_of(&run, &mut auto(1e-12), &mut auto(1e-12)).unwrap();
        assert!(error < 1e-9, "auto, {}: {error:e}", run.name);
    }
}

#[test]
fn the_reference_meets_them_to_the_rounding_of_the_start() {
    for name in [
        "A3_K0.14_VH100, t = 2",
        "D_K0.2_VH0.102_torus, t = 2000",
        "B2_K0.05_VH0.2_exact_sym, t = 2000",
        "E1_DR_K0.45, t = 200",
    ] {
        let run = Run::named(name);
        let reference = || Taylor::reference(MAX_STEPS).unwrap();
        let error = error_of(&run, &mut reference(), &mut reference()).unwrap();
        assert!(error < 2e-12, "{name}: {error:e}");
    }
}

/// Orders 12, 16 and 18: the error follows the tolerance down to rounding.
#[test]
fn the_error_follows_the_tolerance() {
    let run = Run::named("C_K0.01_VH0.2, t = 7500");
    let at =
        |tolerance: f64| error_of(&run, &mut taylor(tolerance), &mut taylor(tolerance)).unwrap();
    for tolerance in [1e-5, 1e-7, 1e-9, 1e-11, 1e-13] {
        let error = at(tolerance);
        assert!(error < 50.0 * tolerance, "{tolerance:e}: {error:e}");
        assert!(error < 0.2 * at(100.0 * tolerance), "{tolerance:e}");
    }
}

#[test]
fn tangents_agree_with_an_unlike_method_and_with_the_reference() {
    for name in ["A3_K0.14_VH100, t = 2", "E1_DR_K0.45, t = 50"] {
        let run = Run::named(name);
        let field = two_interfaces(run.law, run.loading);
        let t = (0.0, run.end_time);
        let (end, exact) = Taylor::reference(MAX_STEPS)
            .unwrap()
            .derivatives(&*field, t, &run.start, &[0, 1])
            .unwrap();
        assert!(run.error(&end) < 2e-12);
        let exact_matrix = Jacobian::<3>::from(exact.start);
        let size = exact_matrix.amax();
        let (_, made) = taylor(1e-13)
            .derivatives(&*field, t, &run.start, &[0, 1])
            .unwrap();
        let apart = (Jacobian::<3>::from(made.start) - exact_matrix).amax() / size;
        assert!(apart < 1e-10, "{name}: {apart:e}");
        for (made, exact) in made.parameters.into_iter().zip(exact.parameters) {
            let (made, exact) = (State::from(made), State::from(exact));
            let apart = (made - exact).amax() / exact.amax();
            assert!(apart < 1e-10, "{name}, parameters: {apart:e}");
        }
        let mut rodas = Rosenbrock::new(
            RosenbrockMethod::Rodas5P,
            Tolerances::equal(1e-12).unwrap(),
            MAX_STEPS,
        )
        .unwrap();
        let (_, other) = rodas.tangent_flow(&*field, t, &run.start).unwrap();
        assert!((other - exact_matrix).amax() < 1e-7 * size, "{name}");
        let (_, switching) = auto(1e-12).tangent_flow(&*field, t, &run.start).unwrap();
        assert!((switching - exact_matrix).amax() < 1e-8 * size, "{name}");
    }
}

/// The derivatives in V_H and K against differences of two runs in double-double arithmetic, in all three systems.
#[test]
fn parameter_derivatives_are_those_of_the_system() {
    const STEP: f64 = 1e-9;
    fn check<const N: usize>(
        field: impl Fn(f64, f64) -> Box<dyn VectorField<N>>,
        start: State<N>,
        t: f64,
    ) {
        let (v, k) = (10.0, 0.14);
        let here = field(v, k);
        let (_, made) = taylor(1e-13)
            .derivatives(&*here, (0.0, t), &start, &[0, 1])
            .unwrap();
        let end = |v: f64, k: f64| {
            let mut reference = Taylor::reference(MAX_STEPS).unwrap();
            reference
                .flow(&*field(v, k), (0.0, t), &start, None)
                .unwrap()
        };
        for (p, made) in [
            (Parameter::Driving, made.parameters[0]),
            (Parameter::Stiffness, made.parameters[1]),
        ] {
            let (up, down, step) = match p {
                Parameter::Driving => (end(v + v * STEP, k), end(v - v * STEP, k), v * STEP),
                Parameter::Stiffness => (end(v, k + k * STEP), end(v, k - k * STEP), k * STEP),
            };
            let difference = (up - down) / (2.0 * step);
            let apart = (State::<N>::from(made) - difference).amax() / difference.amax();
            assert!(apart < 1e-5, "{N}-D, {p:?}: {apart:e}");
        }
        // Liouville: the determinant of the tangent by an integral that does not know it.
        let matrix = nalgebra::DMatrix::from_fn(N, N, |i, j| made.start[j][i]);
        let determinant = matrix.determinant().ln();
        assert!(
            (determinant - made.log_determinant).abs() < 1e-8,
            "{N}-D: {determinant}"
        );
    }
    let law = AnyLaw::Spinodal(Parameters::heslot_1994().spinodal());
    let loading = |v: f64, k: f64| Loading::new(v, k).unwrap();
    let w = 0.01_f64.ln();
    let pair = State::<2>::new(9.9, w);
    check::<3>(
        |v, k| two_interfaces(law, loading(v, k)),
        State::<3>::new(9.9, w, w + 0.1),
        0.3,
    );
    check::<2>(|v, k| symmetric(law, loading(v, k)), pair, 0.3);
    check::<2>(|v, k| single_interface(law, loading(v, k)), pair, 0.3);
}

#[test]
fn a_field_without_series_is_refused_by_taylor_and_left_to_rodas5p_by_auto() {
    let start = State::<3>::new(1.0, 0.0, 0.0);
    let refused = taylor(1e-8).flow(&Robertson, (0.0, 1.0), &start, None);
    assert_eq!(refused, Err(Error::NotAnalytic));
    let end = auto(1e-9)
        .flow(&Robertson, (0.0, 1e11), &start, None)
        .unwrap();
    assert!((end[2] - stiff_classics::ROBERTSON_AT_1E11[2]).abs() < 1e-8);
}

/// On strongly damped stretches auto leaves to Rodas5P, which takes a hundredth of the steps; along cycles it does not.
#[test]
fn auto_switches_where_damping_is_strong_and_only_there() {
    let steps = |name: &str| {
        let run = Run::named(name);
        let (mut alone, mut switching) = (taylor(1e-8), auto::<3>(1e-8));
        let alone_error = error_of(&run, &mut taylor(1e-8), &mut alone).unwrap();
        let switching_error = error_of(&run, &mut auto::<2>(1e-8), &mut switching).unwrap();
        assert!(
            alone_error < 1e-5 && switching_error < 1e-5,
            "{name}: {switching_error:e}"
        );
        (Integrator::<3>::work(&alone), switching.work())
    };
    let (alone, switching) = steps("A5_K0.14_VH1000_far, t = 200");
    assert!(switching.factorisations > 0 && 20 * switching.steps < alone.steps);
    let (alone, switching) = steps("D_K0.2_VH0.102_torus, t = 6000");
    assert_eq!(
        (switching.factorisations, switching.steps),
        (0, alone.steps)
    );
}

/// Observers see one run without a gap, whatever the method, and can stop it; the bound on steps is that of the whole run.
#[test]
fn auto_is_one_run() {
    let run = Run::named("A5_K0.14_VH1000_far, t = 200");
    let field = two_interfaces(run.law, run.loading);
    let t = (0.0, run.end_time);
    let (mut last, mut y, mut kinds) = (0.0, run.start, [0, 0]);
    let mut see = |step: &Step<'_, 3>| {
        assert_eq!((step.t0, *step.y0), (last, y));
        (last, y) = (step.t1, *step.y1);
        kinds[usize::from(step.series().is_some())] += 1;
        Ok(Control::Continue)
    };
    let end = auto(1e-8)
        .flow(&*field, t, &run.start, Some(&mut see))
        .unwrap();
    assert_eq!((last, y), (run.end_time, end));
    assert!(kinds[0] > 0 && kinds[1] > 0, "{kinds:?}");
    let total = kinds[0] + kinds[1];
    let mut short = Auto::<3>::new(Tolerances::equal(1e-8).unwrap(), total - 1).unwrap();
    let ended = short.flow(&*field, t, &run.start, None);
    assert!(
        matches!(ended, Err(Error::TooManySteps { limit, .. }) if limit == total - 1),
        "{ended:?}"
    );
    let mut seen = 0;
    let mut stop = |_: &Step<'_, 3>| {
        seen += 1;
        Ok(if seen == total - 2 {
            Control::Stop
        } else {
            Control::Continue
        })
    };
    auto(1e-8)
        .flow(&*field, t, &run.start, Some(&mut stop))
        .unwrap();
    assert_eq!(seen, total - 2);
}

/// The finite-time singularity of two Dieterich-Ruina interfaces that are too compliant.
#[test]
fn a_singularity_is_told_with_its_time() {
    const T: f64 = 226.641267031787;
    let law = AnyLaw::DieterichRuina(Parameters::heslot_1994().dieterich_ruina());
    let field = two_interfaces(law, Loading::new(1.0, 0.35).unwrap());
    let start = State::<3>::new(10.85, 1.99_f64.ln(), 2.01_f64.ln());
    for (name, ended) in [
        (
            "taylor",
            taylor(1e-13).flow(&*field, (0.0, 300.0), &start, None),
        ),
        (
            "auto",
            auto(1e-13).flow(&*field, (0.0, 300.0), &start, None),
        ),
    ] {
        match ended {
            Err(Error::BlowUp { t, .. }) => assert!((t - T).abs() < 1e-8, "{name}: {t}"),
            other => panic!("{name}: {other:?}"),
        }
    }
}

/// What is zero at the start may change fast: the first unit of time then neither overflows nor costs steps.
#[test]
fn a_variable_may_start_at_zero() {
    let field = Smooth {
        equations: StrongResonance,
        parameters: [-2.0, -0.5],
    };
    let steps = |w: f64| {
        let mut taylor = taylor(1e-15);
        let start = State::<2>::new(2.0, w);
        let end = taylor.flow(&field, (0.0, 1.0), &start, None).unwrap();
        (end, <Taylor as Integrator<2>>::work(&taylor).steps)
    };
    let ((at_zero, few), (beside, usual)) = (steps(0.0), steps(1e-14));
    assert!((at_zero - beside).amax() < 1e-12);
    assert!(few <= usual + 2, "{few} steps and {usual}");
}
