//! What tests of initial value problems share: problems by the words of the command line, and closed forms.

use crate::common::text::file;
use std::convert::Infallible;
use twinslip::Error;
use twinslip_tasks::scene::{IntegrateOptions, IvpAsked, IvpOutcome, IvpPlan};

/// All methods of a build with SUNDIALS, or without.
pub fn methods() -> Vec<&'static str> {
    twinslip::integrate::Choice::names()
}

#[derive(clap::Parser)]
struct Line {
    #[command(flatten)]
    options: IntegrateOptions,
}

/// The problem of a model and numerics as one would type them.
pub fn planned(words: &str, span: (f64, f64), start: &[f64]) -> Result<IvpPlan, Error> {
    let words = std::iter::once("line").chain(words.split_whitespace());
    let line = <Line as clap::Parser>::parse_from(words);
    IvpPlan::new(&line.options.model, &line.options.numerics, span, start)
}

#[track_caller]
pub fn plan(words: &str, span: (f64, f64), start: &[f64]) -> IvpPlan {
    planned(words, span, start).expect("a problem")
}

/// What a problem comes to without events that can fail.
#[track_caller]
pub fn solved(plan: &IvpPlan, asked: IvpAsked<'_, Infallible>) -> IvpOutcome {
    plan.solve(asked).expect("no error")
}

/// Rows at these times, and the solution where it is asked for.
#[track_caller]
pub fn sampled(plan: &IvpPlan, times: &[f64], dense_output: bool) -> IvpOutcome {
    let outcome = solved(
        plan,
        IvpAsked {
            times: Some(times),
            dense_output,
            ..IvpAsked::default()
        },
    );
    assert_eq!(outcome.failure, None);
    assert_eq!(outcome.status, 0);
    assert_eq!(outcome.t, times);
    outcome
}

/// The harmonic oscillator x'' = -x.
pub fn oscillator(folder: &str) -> String {
    let text = r#"
name = "oscillator"
states = ["x", "y"]
[rates]
x = "y"
y = "-x"
"#;
    file(folder, text)
}

/// A stiff linear system with the eigenvalues -1 and -1000: from (2, -1) it is (exp(-t) + exp(-1000 t), -exp(-1000 t)).
pub fn linear(folder: &str) -> String {
    let text = r#"
name = "linear"
states = ["x", "y"]
[rates]
x = "-x + 999*y"
y = "-1000*y"
"#;
    file(folder, text)
}

/// Times from one to the other, both included.
pub fn between(begin: f64, end: f64, count: usize) -> Vec<f64> {
    let part = |i: usize| i as f64 / (count - 1) as f64;
    let time = |i| match i {
        0 => begin,
        _ if i + 1 == count => end,
        _ => begin + (end - begin) * part(i),
    };
    (0..count).map(time).collect()
}
