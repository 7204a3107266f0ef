//! Events that are formulas: none of their zeros is missed, whatever the steps.

use crate::common::ivp::{methods, oscillator, plan, solved};
use crate::common::text::{file, near};
use std::convert::Infallible;
use std::f64::consts::PI;
use twinslip::Error;
use twinslip_tasks::scene::{IvpAsked, IvpEvent, IvpFormula, IvpOutcome, IvpPlan};

type Event = IvpEvent<'static, Infallible>;

fn formula(states: &str, function: &str) -> Result<IvpFormula, Error> {
    // Time is no state.
    let names: Vec<&str> = states.split(' ').filter(|name| *name != "t").collect();
    let quoted: Vec<String> = names.iter().map(|name| format!("{name:?}")).collect();
    let rate = |(i, name): (usize, &&str)| match i {
        0 => format!("{name} = \"{function}\"\n"),
        _ => format!("{name} = \"0\"\n"),
    };
    let rates: String = names.iter().enumerate().map(rate).collect();
    let text = format!(
        "name = \"event\"\nstates = [{}]\n[rates]\n{rates}",
        quoted.join(", ")
    );
    IvpFormula::parse(&text, names.len())
}

fn event(states: &str, function: &str) -> Event {
    IvpEvent::of(formula(states, function).expect("a formula"))
}

#[track_caller]
fn with(plan: &IvpPlan, events: Vec<Event>) -> IvpOutcome {
    solved(
        plan,
        IvpAsked {
            events,
            ..IvpAsked::default()
        },
    )
}

/// x' = 1.
fn clock(folder: &str, span: (f64, f64)) -> IvpPlan {
    let text = "name = \"clock\"\nstates = [\"x\"]\n[rates]\nx = \"1\"\n";
    let path = file(folder, text);
    plan(&format!("--system {path}"), span, &[span.0])
}

#[track_caller]
fn all_near(made: &[f64], exact: &[f64], allowed: f64) {
    assert_eq!(made.len(), exact.len(), "{made:?} for {exact:?}");
    for (made, exact) in made.iter().zip(exact) {
        near(*made, *exact, allowed);
    }
}

#[test]
fn all_zeros_within_one_step_are_found() {
    let outcome = with(
        &clock("ivp-formulas", (0.0, 100.0)),
        vec![
            event("x", "(2.5 - x)*(5 - x)*x"),
            event("x t", "(t - 2.5)^3*(t - 50)^3*(x - 50.001)"),
            event("x", "(x - 30)^2 + 0.000001"),
        ],
    );
    all_near(&outcome.t_events[0], &[0.0, 2.5, 5.0], 1e-14);
    // A zero of the third order is known to the third root of what is rounded.
    all_near(&outcome.t_events[1], &[2.5, 50.0, 50.001], 1e-5);
    assert!(outcome.t_events[2].is_empty());
    assert_eq!(outcome.undecided, [false; 3]);
}

#[test]
fn many_zeros_within_one_step_are_found() {
    for (span, way) in [((0.0, 1000.0), 1.0), ((0.0, -1000.0), -1.0)] {
        let outcome = with(&clock("ivp-waves", span), vec![event("x", "sin(x)")]);
        let exact: Vec<f64> = (0..319).map(|k| way * PI * f64::from(k)).collect();
        all_near(&outcome.t_events[0], &exact, 1e-12);
        assert_eq!(outcome.undecided, [false]);
    }
}

#[test]
fn where_there_are_too_many_zeros_that_is_told() {
    let outcome = with(
        &clock("ivp-too-many", (0.0, 1e7)),
        vec![event("x", "sin(x)"), event("x", "x - 5")],
    );
    assert_eq!(outcome.undecided, [true, false]);
    assert!(outcome.t_events[0].len() > 1000);
    all_near(&outcome.t_events[1], &[5.0], 1e-14);
}

#[test]
fn close_pairs_are_found_by_every_method() {
    for method in methods() {
        let rtol = if method == "rosenbrock23" {
            1e-7
        } else {
            1e-10
        };
        let words = format!(
            "--system {} --method {method} --rtol {rtol}",
            oscillator("ivp-pairs")
        );
        let plan = plan(&words, (0.1, 40.0), &[0.1_f64.sin(), 0.1_f64.cos()]);
        let outcome = with(&plan, vec![event("x y", "x - 0.995")]);
        let half = 0.995_f64.acos();
        let crests = (0..7).map(|k| PI * (0.5 + 2.0 * f64::from(k)));
        let exact: Vec<f64> = crests.flat_map(|t| [t - half, t + half]).collect();
        all_near(&outcome.t_events[0], &exact, 0.01);
    }
}

#[test]
fn values_of_interfaces_are_those_of_the_user() {
    let words = "--driving 10 --stiffness 0.14 --rtol 1e-10";
    let plan = plan(words, (0.0, 20.0), &[9.95, 0.002, 0.001_99]);
    let outcome = with(
        &plan,
        vec![
            event("a b c", "a - 9.5"),
            IvpEvent::new(|_, y| Ok(y[0] - 9.5)),
            event("a b c", "ln(c/b)"),
            IvpEvent::new(|_, y| Ok((y[2] / y[1]).ln())),
        ],
    );
    for pair in outcome.t_events.chunks(2) {
        assert!(!pair[1].is_empty() || pair[0].is_empty());
        all_near(&pair[0], &pair[1], 1e-9);
    }
    assert!(!outcome.t_events[0].is_empty());
}

#[test]
fn a_side_is_kept_until_the_other_one_is_reached() {
    let on = |side: f64| Event {
        side: Some(side),
        ..event("x", "x*(x - 3)")
    };
    // It is 0 at the start: on its negative side nothing changes before 3.
    let outcome = with(&clock("ivp-sides", (0.0, 10.0)), vec![on(-1.0), on(1.0)]);
    all_near(&outcome.t_events[0], &[3.0], 1e-14);
    all_near(&outcome.t_events[1], &[0.0], 1e-14);
    // What only touches 0 stays on its side.
    let touching = Event {
        side: Some(1.0),
        ..event("x", "(x - 3)^2")
    };
    let outcome = with(&clock("ivp-touching", (0.0, 10.0)), vec![touching]);
    assert!(outcome.t_events[0].is_empty());
}

#[test]
fn formulas_of_other_values_are_refused() {
    let told = IvpFormula::parse("name = \"a\"\nstates = [\"x\"]\n[rates]\nx = \"x\"\n", 3);
    let told = told.expect_err("too few").to_string();
    assert!(
        told.contains("1 states, but must have the 3 values"),
        "{told}"
    );
    let told = formula("x", "sinn(x)")
        .expect_err("no function")
        .to_string();
    assert!(told.contains("sinn"), "{told}");
}
