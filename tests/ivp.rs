//! Initial value problems: against closed forms and end states of others, by every method, forwards and backwards; what is refused,
//! and what remains of runs that fail or are stopped.

use crate::common::ivp::{between, linear, methods, oscillator, plan, planned, sampled, solved};
use crate::common::text::{file, near};
use crate::common::trajectories::Run;
use std::convert::Infallible;
use twinslip::Error;
use twinslip::friction::AnyLaw;
use twinslip::integrate::Control;
use twinslip_tasks::scene::{IvpAsked, IvpOutcome, IvpPlan};

/// How far errors of these methods at rtol 1e-12 are above it on the problems here: multistep methods add up more.
fn factor(method: &str) -> f64 {
    match method {
        "auto" | "taylor" | "rodas5p" => 10.0,
        "rodas4" => 100.0,
        _ => 1e4,
    }
}

fn is_send<T: Send + Sync + Clone>(_: &T) {}

#[test]
fn the_oscillator_is_a_circle_by_every_method_either_way() {
    let system = oscillator("ivp-oscillator");
    for method in methods() {
        // A method of order 2 would take millions of steps.
        let (rtol, allowed) = match method {
            "rosenbrock23" => (1e-6, 1e-3),
            _ => (1e-13, 1e-13 * factor(method)),
        };
        for end in [7.0, -7.0] {
            let words = format!("--system {system} --method {method} --rtol {rtol}");
            let plan = plan(&words, (0.5, 0.5 + end), &[0.5_f64.sin(), 0.5_f64.cos()]);
            is_send(&plan);
            let times = between(0.5, 0.5 + end, 40);
            let outcome = sampled(&plan, &times, false);
            for (t, y) in times.iter().zip(outcome.y.chunks(2)) {
                let off = (y[0] - t.sin()).abs().max((y[1] - t.cos()).abs());
                assert!(off < allowed, "{method}, to {end}: {off:e} at {t}");
            }
            assert!(outcome.solution.is_none() && outcome.t_events.is_empty());
        }
    }
}

#[test]
fn a_stiff_linear_system_is_its_exponentials() {
    let system = linear("ivp-linear");
    for method in methods() {
        let (rtol, allowed) = match method {
            "rosenbrock23" => (1e-6, 1e-4),
            _ => (1e-12, 1e-12 * factor(method)),
        };
        let words = format!("--system {system} --method {method} --rtol {rtol}");
        let plan = plan(&words, (0.0, 1.0), &[2.0, -1.0]);
        let times = between(0.0, 1.0, 101);
        let outcome = sampled(&plan, &times, false);
        for (t, y) in times.iter().zip(outcome.y.chunks(2)) {
            let (slow, fast) = ((-t).exp(), (-1000.0 * t).exp());
            let off = (y[0] - slow - fast).abs().max((y[1] + fast).abs());
            assert!(off < allowed, "{method}: {off:e} at {t}");
        }
    }
}

#[test]
fn without_times_the_rows_are_the_steps() {
    let system = oscillator("ivp-steps");
    for method in methods() {
        let words = format!("--system {system} --method {method} --rtol 1e-6");
        let outcome = solved(&plan(&words, (0.0, 3.0), &[0.0, 1.0]), IvpAsked::default());
        assert_eq!(outcome.t.len(), outcome.work.steps + 1, "{method}");
        assert_eq!((outcome.t[0], outcome.t.last()), (0.0, Some(&3.0)));
        assert_eq!(outcome.y[..2], [0.0, 1.0]);
        assert!(outcome.t.is_sorted_by(|a, b| a < b));
        let last = &outcome.y[outcome.y.len() - 2..];
        near(last[0], 3.0_f64.sin(), 1e-3);
        assert!(outcome.work.rhs > 0);
    }
}

/// The words for a run of the reference data.
fn words(run: &Run, rest: &str) -> String {
    let (name, loading) = (run.law.name(), run.loading);
    format!(
        "--law {name} --driving {} --stiffness {} {rest}",
        loading.driving, loading.stiffness
    )
}

#[test]
fn slabs_end_where_others_say() {
    for run in Run::all() {
        let start = [run.start[0], run.start[1].exp(), run.start[2].exp()];
        let plan = plan(&words(&run, "--rtol 1e-14"), (0.0, run.end_time), &start);
        let outcome = sampled(&plan, &[run.end_time], false);
        assert_eq!(plan.names(), ["stress", "state_1", "state_2"]);
        let off = (0..3).map(|i| (outcome.y[i] / run.end[i] - 1.0).abs());
        let off = off.fold(0.0, f64::max);
        assert!(off < 1e-11, "{}: {off:e}", run.name);
    }
}

#[test]
fn a_slab_ends_there_by_every_method() {
    let run = Run::named("A5_K0.14_VH1000_far, t = 200");
    let start = [10.0, 0.5, 0.001];
    for method in methods() {
        let (rtol, allowed) = match method {
            "rosenbrock23" => (1e-7, 1e-4),
            "rodas4" => (1e-12, 1e-9),
            name if name.starts_with("cvode") => (1e-12, 1e-7),
            _ => (1e-12, 1e-10),
        };
        let numerics = format!("--method {method} --rtol {rtol}");
        let plan = plan(&words(&run, &numerics), (0.0, run.end_time), &start);
        let outcome = solved(&plan, IvpAsked::default());
        assert_eq!(outcome.status, 0);
        let end = &outcome.y[outcome.y.len() - 3..];
        for (made, exact) in end.iter().zip(run.end) {
            let off = (made / exact - 1.0).abs();
            assert!(off < allowed, "{method}: {off:e}");
        }
    }
}

#[test]
fn there_and_back_is_where_it_began() {
    let there = plan(
        "--driving 10 --stiffness 0.14 --rtol 1e-13",
        (0.0, 1.0),
        &[10.0, 0.5, 0.001],
    );
    let end = sampled(&there, &[1.0], false).y;
    let back = plan(
        "--driving 10 --stiffness 0.14 --rtol 1e-13",
        (1.0, 0.0),
        &end,
    );
    let begin = solved(&back, IvpAsked::default());
    assert_eq!(begin.t.last(), Some(&0.0));
    let begin = &begin.y[begin.y.len() - 3..];
    for (made, exact) in begin.iter().zip([10.0, 0.5, 0.001]) {
        assert!((made / exact - 1.0).abs() < 1e-9, "{made} for {exact}");
    }
}

#[test]
fn laws_from_files_and_one_interface_are_the_built_in_ones() {
    let numerics = "--driving 1 --stiffness 2 --rtol 1e-13";
    let cases: [(&str, &[f64]); 3] = [
        ("--interfaces 2", &[10.0, 0.5, 0.2]),
        ("--interfaces 2", &[10.0, 0.3, 0.3]),
        ("--interfaces 1", &[10.0, 0.3]),
    ];
    for (interfaces, start) in cases {
        for law in AnyLaw::NAMES {
            let of = |law: &str| {
                let words = format!("--law {law} {interfaces} {numerics}");
                let times = between(0.0, 5.0, 11);
                sampled(&plan(&words, (0.0, 5.0), start), &times, false).y
            };
            let (built_in, from_file) = (of(law), of(&format!("scenes/laws/{law}.toml")));
            assert_eq!(built_in[..start.len()], *start);
            for (a, b) in built_in.iter().zip(&from_file) {
                assert!((a / b - 1.0).abs() < 1e-8, "{law}, {interfaces}: {a} {b}");
            }
        }
    }
    let three = plan(
        "--interfaces 3 --driving 10 --stiffness 0.14",
        (0.0, 1.0),
        &[10.0, 0.5, 0.1, 0.001],
    );
    assert_eq!(three.dimension(), 4);
    assert_eq!(solved(&three, IvpAsked::default()).status, 0);
}

#[test]
fn equal_interfaces_stay_equal_to_the_bit() {
    let plan = plan(
        "--driving 0.2 --stiffness 0.05",
        (0.0, 3000.0),
        &[11.37729, 0.091, 0.091],
    );
    let outcome = solved(
        &plan,
        IvpAsked {
            dense_output: true,
            ..IvpAsked::default()
        },
    );
    assert_eq!(outcome.status, 0);
    assert!(outcome.y.chunks(3).all(|y| y[1] == y[2]));
    let solution = outcome.solution.unwrap();
    let many = solution.fill(&between(0.0, 3000.0, 1000));
    assert!(many.chunks(3).all(|y| y[1] == y[2]));
}

#[test]
fn si_units_are_another_scale_of_the_same() {
    // One unit of time is 0.9 s, of stress 0.0349 MPa, of velocity 1e-6 m/s, and of stiffness 0.0349e6/0.9e-6 Pa/m.
    let (time, stress) = (0.9, 0.0349e6);
    let plain = plan(
        "--driving 10 --stiffness 0.14 --rtol 1e-13",
        (0.0, 5.0),
        &[10.0, 0.5, 0.001],
    );
    let stiffness = 0.14 * stress / 0.9e-6;
    let si = plan(
        &format!("--si --driving 1e-5 --stiffness {stiffness:e} --rtol 1e-13"),
        (0.0, 5.0 * time),
        &[10.0 * stress, 0.5, 0.001],
    );
    let times = between(0.0, 5.0, 21);
    let si_times: Vec<f64> = times.iter().map(|t| t * time).collect();
    let plain = sampled(&plain, &times, false).y;
    let outcome = sampled(&si, &si_times, true);
    for (a, b) in plain.chunks(3).zip(outcome.y.chunks(3)) {
        assert!((a[0] * stress / b[0] - 1.0).abs() < 1e-9);
        assert!((a[1] / b[1] - 1.0).abs() < 1e-9 && (a[2] / b[2] - 1.0).abs() < 1e-9);
    }
    // The steps end at the end that was given, and the law whose state is a time has it in seconds.
    let steps = solved(&si, IvpAsked::default());
    assert_eq!(steps.t.last(), Some(&(5.0 * time)));
    assert!(steps.t.is_sorted_by(|a, b| a < b));
    let ageing = plan(
        "--si --law regularised-ageing --driving 1e-5 --stiffness 5e9",
        (0.0, 1e-3),
        &[10.0 * stress, 0.45, 0.45],
    );
    let outcome = solved(&ageing, IvpAsked::default());
    near(outcome.y[1], 0.45, 1e-15);
    near(outcome.y[outcome.y.len() - 1], 0.45, 1e-1);
}

#[test]
fn a_blow_up_keeps_its_rows() {
    let text = "name = \"q\"\nstates = [\"x\"]\n[rates]\nx = \"x^2\"\n";
    let system = file("ivp-blow-up", text);
    let times = [0.0, 0.25, 0.5, 1.5];
    // To name a singularity takes seconds here: one method of each kind.
    let kinds = ["taylor", "rodas5p", "cvode-bdf"];
    let kinds = kinds.into_iter().filter(|kind| methods().contains(kind));
    for (method, times) in kinds.zip([None, Some(&times[..]), Some(&times)]) {
        let words = format!("--system {system} --method {method}");
        let asked = IvpAsked {
            times,
            dense_output: true,
            ..IvpAsked::default()
        };
        let outcome = solved(&plan(&words, (0.0, 2.0), &[1.0]), asked);
        assert_eq!(outcome.status, -1, "{method}");
        assert!(!outcome.stopped);
        match outcome.failure {
            Some(Error::BlowUp { t, .. }) => near(t, 1.0, 1e-4),
            ref other => panic!("{method}: {other:?}"),
        }
        match times {
            Some(times) => assert_eq!(outcome.t, times[..3]),
            None => assert!(outcome.t.len() > 5 && outcome.t.last() > Some(&0.99)),
        }
        for (t, x) in outcome.t.iter().zip(&outcome.y) {
            // x^2 is how fast it moves, and so what an error of the time does.
            let allowed = 1e-4 * (1.0 + x * x);
            assert!(
                (x - 1.0 / (1.0 - t)).abs() < allowed,
                "{method}: {x} at {t}"
            );
        }
        near(outcome.solution.unwrap().at(0.3)[0], 1.0 / 0.7, 1e-4);
    }
    // Backwards it goes to rest.
    let words = format!("--system {system} --rtol 1e-13");
    let outcome = sampled(&plan(&words, (0.0, -9.0), &[1.0]), &[-9.0], false);
    near(outcome.y[0], 0.1, 1e-13);
}

#[test]
fn too_many_steps_are_told() {
    let problem = plan(
        "--driving 10 --stiffness 0.14 --max-steps 20",
        (0.0, 100.0),
        &[10.0, 0.5, 0.001],
    );
    let outcome = solved(&problem, IvpAsked::default());
    assert_eq!((outcome.status, outcome.t.len()), (-1, 21));
    assert!(matches!(
        outcome.failure,
        Some(Error::TooManySteps { limit: 20, .. })
    ));
}

#[test]
fn a_hook_stops_a_run_and_sees_all_of_it() {
    let problem = plan(
        "--driving 10 --stiffness 0.14",
        (20.0, 0.0),
        &[10.0, 0.01, 0.011],
    );
    let mut fractions = Vec::new();
    let mut whole = |fraction: f64| {
        fractions.push(fraction);
        Control::Continue
    };
    let run = |hook: &mut dyn FnMut(f64) -> Control| -> IvpOutcome {
        let asked: IvpAsked<'_, Infallible> = IvpAsked {
            reached: Some(hook),
            ..IvpAsked::default()
        };
        problem.solve(asked).expect("no error")
    };
    let outcome = run(&mut whole);
    assert_eq!(outcome.t.len(), fractions.len() + 1);
    assert!(fractions.is_sorted() && fractions[0] > 0.0);
    let mut calls = 0;
    let stopped = run(&mut |_| {
        calls += 1;
        if calls == 3 {
            Control::Stop
        } else {
            Control::Continue
        }
    });
    assert_eq!((stopped.status, stopped.stopped), (-1, true));
    assert_eq!(stopped.failure, Some(Error::Interrupted));
    assert_eq!(stopped.t, outcome.t[..4]);
    assert_eq!(stopped.work.steps, 3);
}

#[test]
fn what_is_wrong_is_named() {
    let slab = "--driving 10 --stiffness 0.14";
    let good = [10.0, 0.5, 0.001];
    let said = |made: Result<IvpPlan, Error>| made.expect_err("refused").to_string();
    let of = |words: &str, span, start: &[f64]| said(planned(words, span, start));
    let unit = (0.0, 1.0);
    for (told, parts) in [
        (
            of(slab, unit, &good[..2]),
            ["`start` is 2", "3: stress, state_1, state_2"],
        ),
        (
            of(slab, unit, &[10.0, f64::NAN, 0.1]),
            ["start[1] is NaN", "finite"],
        ),
        (
            of(slab, unit, &[10.0, 0.1, 0.0]),
            ["start[2] (state_2) is 0", "positive"],
        ),
        (
            of(slab, unit, &[10.0, 0.1, 2.0]),
            ["`start` is 2", "(0, 1]"],
        ),
        (
            of(slab, (0.0, f64::INFINITY), &good),
            ["span is (0, inf)", "finite"],
        ),
        (of(slab, (3.0, 3.0), &good), ["span is (3, 3)", "differ"]),
        (
            of(&format!("{slab} --interfaces 9"), unit, &[0.5; 10]),
            ["`interfaces` 9", "at most 7"],
        ),
        (
            of("--stiffness 1", unit, &good),
            ["`driving` V_H is missing", ""],
        ),
        (
            of(&format!("{slab} --rtol 2"), unit, &good),
            ["rtol is 2", "less than 1"],
        ),
        (
            of(&format!("{slab} --max-steps 0"), unit, &good),
            ["max-steps is 0", "at least 1"],
        ),
        (
            of("--system lorenz", unit, &[1.0]),
            ["`start` is 1", "3: x, y, z"],
        ),
        (
            of("--system lorenz --method euler", unit, &good),
            ["method is euler", "taylor"],
        ),
    ] {
        assert!(parts.iter().all(|part| told.contains(part)), "{told}");
    }
    let forward = plan(slab, unit, &good);
    let backward = plan(slab, (1.0, 0.0), &good);
    for (plan, times, part) in [
        (
            &forward,
            [0.0, 1.5],
            "t_eval[1] is 1.5, but must be within `span`, from 0 to 1",
        ),
        (
            &forward,
            [0.5, 0.5],
            "t_eval[1] is 0.5, but must be greater than 0.5",
        ),
        (
            &backward,
            [0.2, 0.4],
            "t_eval[1] is 0.4, but must be less than 0.2",
        ),
        (&forward, [f64::NAN, 0.4], "t_eval[0] is NaN"),
    ] {
        let asked: IvpAsked<'_, Infallible> = IvpAsked {
            times: Some(&times),
            ..IvpAsked::default()
        };
        let told = plan.solve(asked).expect_err("refused").to_string();
        assert!(told.contains(part), "{told}");
    }
}
