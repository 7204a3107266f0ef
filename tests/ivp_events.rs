//! Events of initial value problems: times, directions, ends, order and errors, against closed forms and the semantics of SciPy.

use crate::common::ivp::{between, methods, oscillator, plan, planned, solved};
use crate::common::text::{file, near};
use proptest::prelude::*;
use std::convert::Infallible;
use std::f64::consts::PI;
use twinslip::Error;
use twinslip_tasks::scene::{Halt, IvpAsked, IvpError, IvpEvent, IvpOutcome, IvpPlan};

type Event<'a> = IvpEvent<'a, Infallible>;

fn x_is_zero(direction: f64, terminal: Option<usize>) -> Event<'static> {
    Event {
        direction,
        terminal,
        ..Event::new(|_, y| Ok(y[0]))
    }
}

/// The oscillator from (sin t, cos t).
fn circle(folder: &str, numerics: &str, span: (f64, f64)) -> IvpPlan {
    let words = format!("--system {} {numerics}", oscillator(folder));
    plan(&words, span, &[span.0.sin(), span.0.cos()])
}

#[track_caller]
fn with_events(plan: &IvpPlan, events: Vec<Event<'_>>) -> IvpOutcome {
    let asked = IvpAsked {
        events,
        dense_output: true,
        ..IvpAsked::default()
    };
    solved(plan, asked)
}

#[track_caller]
fn all_near(made: &[f64], exact: &[f64], allowed: f64) {
    assert_eq!(made.len(), exact.len(), "{made:?} for {exact:?}");
    for (made, exact) in made.iter().zip(exact) {
        near(*made, *exact, allowed);
    }
}

#[test]
fn zeros_of_the_oscillator_by_direction_and_method() {
    for method in methods() {
        let (rtol, allowed) = match method {
            "rosenbrock23" => (1e-6, 1e-4),
            "auto" | "taylor" => (1e-13, 1e-12),
            // The dense output is of a lower order than the steps.
            _ => (1e-12, 1e-8),
        };
        let numerics = format!("--method {method} --rtol {rtol}");
        let forward = circle("ivp-zeros", &numerics, (0.1, 10.0));
        let three = || {
            vec![
                x_is_zero(0.0, None),
                x_is_zero(1.0, None),
                x_is_zero(-2.0, None),
            ]
        };
        let outcome = with_events(&forward, three());
        assert_eq!(outcome.status, 0);
        all_near(&outcome.t_events[0], &[PI, 2.0 * PI, 3.0 * PI], allowed);
        all_near(&outcome.t_events[1], &[2.0 * PI], allowed);
        all_near(&outcome.t_events[2], &[PI, 3.0 * PI], allowed);
        all_near(&outcome.y_events[1], &[0.0, 1.0], allowed);
        assert_eq!(outcome.y_events[0].len(), 6);
        // Backwards what rises along the run falls in time.
        let backward = circle("ivp-zeros-back", &numerics, (10.0, 0.1));
        let outcome = with_events(&backward, three());
        all_near(&outcome.t_events[0], &[3.0 * PI, 2.0 * PI, PI], allowed);
        all_near(&outcome.t_events[1], &[3.0 * PI, PI], allowed);
        all_near(&outcome.t_events[2], &[2.0 * PI], allowed);
    }
}

#[test]
fn terminal_events_end_the_run_at_their_root() {
    for (span, end) in [((0.1, 100.0), 4.0 * PI), ((13.0, -100.0), 2.0 * PI)] {
        for times in [None, Some(between(span.0, span.1, 500))] {
            let plan = circle("ivp-terminal", "--rtol 1e-13", span);
            let asked = IvpAsked {
                times: times.as_deref(),
                events: vec![x_is_zero(0.0, None), x_is_zero(span.1.signum(), Some(2))],
                dense_output: true,
                ..IvpAsked::default()
            };
            let outcome = solved(&plan, asked);
            assert_eq!(outcome.status, 1);
            assert_eq!((outcome.failure, outcome.stopped), (None, false));
            let root = outcome.t_events[1][1];
            near(root, end, 1e-12);
            assert_eq!(outcome.t_events[1].len(), 2);
            // The other event is at the same time, and comes first where both are equal.
            assert!(outcome.t_events[0].len() >= 3);
            let last = outcome.t[outcome.t.len() - 1];
            match &times {
                None => {
                    assert_eq!(last, root);
                    let y = &outcome.y[outcome.y.len() - 2..];
                    assert_eq!(*y, outcome.y_events[1][2..]);
                }
                Some(times) => {
                    let within = |t: &&f64| {
                        if span.1 > span.0 {
                            **t <= root
                        } else {
                            **t >= root
                        }
                    };
                    let kept: Vec<f64> = times.iter().filter(within).copied().collect();
                    assert_eq!(outcome.t, kept);
                }
            }
            let solution = outcome.solution.expect("asked for");
            assert_eq!(solution.times().last(), Some(&root));
            near(solution.at(root)[0], 0.0, 1e-12);
        }
    }
}

#[test]
fn of_events_in_one_step_those_up_to_the_terminal_one_count() {
    // x = t, of which Taylor's series ends: in one step there are roots at 0.5, 0.3, 0.7 and 0.6, of which the last ends the run.
    let system = file(
        "ivp-order",
        "name = \"l\"\nstates = [\"x\"]\n[rates]\nx = \"1\"\n",
    );
    let words = format!("--system {system} --method taylor");
    for (span, roots) in [
        ((0.0, 1.0), [vec![0.5], vec![0.3], vec![], vec![0.6]]),
        ((1.0, 0.0), [vec![], vec![], vec![0.7], vec![0.6]]),
    ] {
        let at = |place: f64, terminal| Event {
            terminal,
            ..Event::new(move |t, y| {
                assert!((t - y[0]).abs() < 1e-15);
                Ok(y[0] - place)
            })
        };
        let events = vec![
            at(0.5, None),
            at(0.3, None),
            at(0.7, None),
            at(0.6, Some(1)),
        ];
        let problem = plan(&words, span, &[span.0]);
        // The last step has them all.
        let steps = with_events(&problem, Vec::new()).t;
        assert!((steps[steps.len() - 2] - span.0).abs() < 0.1, "{steps:?}");
        let outcome = with_events(&problem, events);
        for (made, exact) in outcome.t_events.iter().zip(&roots) {
            all_near(made, exact, 1e-15);
        }
        assert_eq!(outcome.status, 1);
        assert_eq!(outcome.t.len(), steps.len());
    }
}

#[test]
fn a_terminal_count_of_nought_never_ends() {
    let problem = circle("ivp-nought", "--rtol 1e-10", (0.1, 10.0));
    let outcome = with_events(&problem, vec![x_is_zero(0.0, Some(0))]);
    assert_eq!((outcome.status, outcome.t_events[0].len()), (0, 3));
}

#[test]
fn a_zero_at_the_start_is_an_event() {
    // As scipy.integrate.solve_ivp has it: with y0 = (0, 1) and the terminal event x = 0 it ends at once, with two rows.
    let problem = circle("ivp-at-start", "--rtol 1e-10", (0.0, 10.0));
    for (direction, ends) in [(0.0, true), (1.0, true), (-1.0, false)] {
        let outcome = with_events(&problem, vec![x_is_zero(direction, Some(1))]);
        assert_eq!(outcome.status, 1);
        if ends {
            assert_eq!(outcome.t, [0.0, 0.0]);
            assert_eq!(outcome.t_events, [[0.0]]);
            assert_eq!(outcome.y_events, [[0.0, 1.0]]);
            assert_eq!(outcome.solution.expect("asked for").at(0.0), [0.0, 1.0]);
        } else {
            near(outcome.t_events[0][0], PI, 1e-9);
        }
    }
}

#[test]
fn a_zero_at_the_joint_of_two_steps_is_one_of_either() {
    // As scipy.integrate.solve_ivp has it.
    let problem = circle("ivp-joint", "--rtol 1e-10", (0.1, 10.0));
    let joint = with_events(&problem, Vec::new()).t[3];
    let outcome = with_events(&problem, vec![Event::new(move |t, _| Ok(t - joint))]);
    assert_eq!(outcome.t_events, [[joint, joint]]);
    assert_eq!(outcome.y_events[0][..2], outcome.y_events[0][2..]);
    assert_eq!(outcome.y_events[0][..2], outcome.y[6..8]);
}

#[test]
fn events_of_a_slab_are_in_the_users_numbers() {
    let plain = plan(
        "--driving 10 --stiffness 0.14 --rtol 1e-12",
        (0.0, 20.0),
        &[10.0, 0.5, 0.001],
    );
    let event = |level: f64| Event {
        direction: -1.0,
        ..Event::new(move |_, y| Ok(y[0] - level))
    };
    let outcome = with_events(&plain, vec![event(10.0)]);
    let (times, states) = (&outcome.t_events[0], &outcome.y_events[0]);
    assert!(times.len() > 1);
    for (t, y) in times.iter().zip(states.chunks(3)) {
        near(y[0], 10.0, 1e-11);
        assert!(y[1] > 0.0 && y[1] < 1.0 && y[2] > 0.0 && y[2] < 1.0);
        let again = outcome.solution.as_ref().expect("asked for").at(*t);
        all_near(&again, y, 1e-11);
    }
    let (time, stress) = (0.9, 0.0349e6);
    let stiffness = 0.14 * stress / 0.9e-6;
    let words = format!("--si --driving 1e-5 --stiffness {stiffness:e} --rtol 1e-12");
    let si = plan(&words, (0.0, 20.0 * time), &[10.0 * stress, 0.5, 0.001]);
    let outcome = with_events(&si, vec![event(10.0 * stress)]);
    let scaled: Vec<f64> = times.iter().map(|t| t * time).collect();
    all_near(&outcome.t_events[0], &scaled, 1e-7);
}

#[test]
fn errors_of_functions_pass_unchanged() {
    #[derive(Debug, PartialEq)]
    struct Mine(u32);
    let problem = circle("ivp-errors", "", (0.1, 10.0));
    let run = |from: f64, halt: fn() -> Halt<Mine>| {
        let event =
            IvpEvent::new(move |t, y: &[f64]| if t >= from { Err(halt()) } else { Ok(y[0]) });
        problem.solve(IvpAsked {
            events: vec![event],
            ..IvpAsked::default()
        })
    };
    for from in [0.0, 2.0] {
        assert_eq!(run(from, || Mine(7).into()), Err(IvpError::Event(Mine(7))));
        let stopped = run(from, || Halt::Stop).expect("an outcome");
        assert_eq!((stopped.status, stopped.stopped), (-1, true));
        assert_eq!(stopped.failure, Some(Error::Interrupted));
        assert_eq!(stopped.t_events.len(), 1);
        assert!(stopped.t.iter().all(|&t| t < 2.0));
    }
    // A function that is no number between values of different signs.
    let event = Event::new(|t, _| {
        Ok(match t {
            t if t < 0.2 => -1.0,
            t if t < 9.9 => f64::NAN,
            _ => 1.0,
        })
    });
    let words = format!(
        "--system {} --method taylor",
        file(
            "ivp-nan",
            "name = \"l\"\nstates = [\"x\"]\n[rates]\nx = \"1\"\n"
        )
    );
    let outcome = with_events(&planned(&words, (0.0, 10.0), &[0.0]).unwrap(), vec![event]);
    assert_eq!(outcome.status, -1);
    let told = outcome.failure.expect("a failure").to_string();
    assert!(
        told.contains("event 0 is not a number between t = "),
        "{told}"
    );
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(40))]
    /// Zeros of sin(t) - c within the span, where they are simple and not near an end: two of them are often within one step.
    #[test]
    fn levels_are_met_where_they_are(level in -0.95..0.95_f64, begin in -30.0..30.0_f64, length in 0.5..20.0_f64, back: bool) {
        let end = if back { begin - length } else { begin + length };
        let problem = circle("ivp-levels", "--method taylor --rtol 1e-13", (begin, end));
        let event = Event::new(move |_, y| Ok(y[0] - level));
        let outcome = with_events(&problem, vec![event]);
        let (low, high) = (begin.min(end), begin.max(end));
        let branch = level.asin();
        let mut exact: Vec<f64> = (-20..20)
            .flat_map(|k| [f64::from(k) * 2.0 * PI + branch, (f64::from(k) * 2.0 + 1.0) * PI - branch])
            .filter(|t| (low..high).contains(t))
            .collect();
        exact.sort_by(f64::total_cmp);
        if back {
            exact.reverse();
        }
        let clear = exact.iter().all(|t| (t - low).min(high - t) > 1e-6);
        prop_assume!(clear);
        let found = &outcome.t_events[0];
        prop_assert_eq!(found.len(), exact.len());
        for (made, exact) in found.iter().zip(&exact) {
            prop_assert!((made - exact).abs() < 1e-11, "{} for {}", made, exact);
        }
    }
}
