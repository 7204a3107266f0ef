//! Dense solutions: what they are between, at and beyond the ends of steps, and as plain numbers.

use crate::common::ivp::{between, methods, oscillator, plan, sampled, solved};
use proptest::prelude::*;
use twinslip_tasks::scene::{IvpAsked, IvpParts, IvpSolution};

fn is_send<T: Send + Sync + Clone>(_: &T) {}

/// Rows at times of one run by the dense output of its steps, and the same by its solution: the largest difference, relative or in
/// units of the state.
#[track_caller]
fn apart(words: &str, span: (f64, f64), start: &[f64], count: usize) -> f64 {
    let plan = plan(words, span, start);
    let times = between(span.0, span.1, count);
    let outcome = sampled(&plan, &times, true);
    let solution = outcome.solution.expect("asked for");
    is_send(&solution);
    assert_eq!(solution.dimension(), start.len());
    let filled = solution.fill(&times);
    assert_eq!(filled.len(), outcome.y.len());
    let one_by_one: Vec<f64> = times.iter().flat_map(|&t| solution.at(t)).collect();
    assert_eq!(filled, one_by_one);
    let off = filled.iter().zip(&outcome.y);
    let unit = if words.contains("system") { 1.0 } else { 0.0 };
    off.map(|(a, b)| (a - b).abs() / b.abs().max(unit))
        .fold(0.0, f64::max)
}

#[test]
fn the_solution_agrees_with_rows_to_rounding() {
    let system = oscillator("ivp-dense");
    for method in methods() {
        let rtol = if method == "rosenbrock23" { 1e-4 } else { 1e-8 };
        let numerics = format!("--method {method} --rtol {rtol}");
        for span in [(0.0, 5.0), (5.0, 0.0)] {
            let words = format!("--system {system} {numerics}");
            let off = apart(&words, span, &[0.3, 0.7], 300);
            assert!(off < 1e-14, "{method}: {off:e}");
        }
        for start in [&[10.0, 0.5, 0.001][..], &[10.0, 0.1, 0.1]] {
            let words = format!("--driving 10 --stiffness 0.14 {numerics}");
            let off = apart(&words, (0.0, 6.0), start, 300);
            assert!(off < 1e-12, "{method}: {off:e}");
        }
        let words =
            format!("--law scenes/laws/spinodal.toml --driving 10 --stiffness 0.14 {numerics}");
        let off = apart(&words, (0.0, 6.0), &[10.0, 0.5, 0.001], 300);
        assert!(off < 1e-12, "{method}: {off:e}");
    }
}

#[test]
fn fast_slip_late_in_a_run_agrees_too() {
    // Rates of 1e4 at times of 1e3: rounded times alone would cost nine digits.
    let words = "--driving 0.12 --stiffness 0.14";
    for method in ["auto", "taylor", "rodas5p"] {
        let words = format!("{words} --method {method}");
        let off = apart(
            &words,
            (0.0, 2000.0),
            &[11.499706, 0.143, 0.14285714],
            20_001,
        );
        assert!(off < 1e-11, "{method}: {off:e}");
    }
}

#[test]
fn ends_of_steps_are_met() {
    for method in methods() {
        let rtol = if method == "rosenbrock23" { 1e-4 } else { 1e-8 };
        for (scale, si) in [(1.0, ""), (0.0349e6, "--si --time-unit day")] {
            let (driving, stiffness) = if si.is_empty() {
                (10.0, 0.14)
            } else {
                (1e-5, 5.4e9)
            };
            let words = format!(
                "--driving {driving} --stiffness {stiffness} {si} --method {method} --rtol {rtol}"
            );
            let end = if si.is_empty() { 6.0 } else { 6e-5 };
            let plan = plan(&words, (0.0, end), &[10.0 * scale, 0.5, 0.001]);
            let asked = IvpAsked {
                dense_output: true,
                ..IvpAsked::default()
            };
            let outcome = solved(&plan, asked);
            let solution = outcome.solution.expect("asked for");
            assert_eq!(solution.times(), outcome.t);
            let filled = solution.fill(&outcome.t);
            for (a, b) in filled.iter().zip(&outcome.y) {
                assert!((a / b - 1.0).abs() < 1e-12, "{method}: {a} {b}");
            }
        }
    }
}

#[test]
fn beyond_its_ends_the_nearest_piece_goes_on() {
    let system = oscillator("ivp-beyond");
    for (method, allowed) in [("taylor", 1e-10), ("rodas5p", 1e-6)] {
        for (begin, end) in [(0.0, 1.0), (1.0, 0.0)] {
            let words = format!("--system {system} --method {method} --rtol 1e-12");
            let plan = plan(&words, (begin, end), &[f64::sin(begin), f64::cos(begin)]);
            let solution = sampled(&plan, &[end], true).solution.expect("asked for");
            for t in [-0.02, 1.02_f64] {
                let off = (solution.at(t)[0] - t.sin()).abs();
                assert!(off < allowed, "{method}: {off:e} at {t}");
            }
            assert!(solution.at(f64::NAN)[0].is_nan());
        }
    }
}

#[test]
fn parts_make_the_same_solution() {
    for method in methods() {
        let rtol = if method == "rosenbrock23" { 1e-4 } else { 1e-8 };
        let words = format!("--driving 10 --stiffness 0.14 --method {method} --rtol {rtol}");
        let times = between(0.0, 6.0, 50);
        let plan = plan(&words, (0.0, 6.0), &[10.0, 0.1, 0.1]);
        let solution = sampled(&plan, &times, true).solution.expect("asked for");
        let parts = solution.to_parts();
        let again = IvpSolution::from_parts(parts.clone()).expect("parts of a solution");
        assert_eq!(again, solution);
        assert_eq!(again.fill(&times), solution.fill(&times));
        let cut = |by: fn(&mut IvpParts)| {
            let mut parts = parts.clone();
            by(&mut parts);
            let told = IvpSolution::from_parts(parts).expect_err("no solution");
            told.to_string()
        };
        assert!(cut(|parts| parts.chart[0] = 0.5).contains("`chart`"));
        assert!(cut(|parts| parts.times.truncate(parts.times.len() - 1)).contains("`times`"));
        assert!(cut(|parts| parts.pieces.truncate(parts.pieces.len() - 1)).contains("`pieces`"));
        assert!(
            cut(|parts| parts.coefficients.truncate(parts.coefficients.len() - 1))
                .contains("coefficients")
        );
        assert!(cut(|parts| parts.pieces[4] = 3.0).contains("kind"));
        assert!(cut(|parts| parts.pieces[5] = -1.0).contains("order"));
        assert!(cut(|parts| parts.pieces[5] = f64::NAN).contains("order"));
        assert!(cut(|parts| *parts = IvpParts::default()).contains("`chart`"));
    }
}

#[test]
fn a_solution_is_small() {
    let words = "--driving 10 --stiffness 0.14 --rtol 1e-8";
    let plan = plan(words, (0.0, 20.0), &[10.0, 0.5, 0.001]);
    let outcome = sampled(&plan, &[20.0], true);
    let parts = outcome.solution.expect("asked for").to_parts();
    let steps = outcome.work.steps;
    assert_eq!(parts.times.len(), steps + 1);
    // Three series of order 16 at most.
    assert!(parts.coefficients.len() <= 3 * 17 * steps);
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(24))]
    #[test]
    fn any_start_and_span_agree(
        method in 0..methods().len(),
        tau in 5.0..12.0_f64,
        ln_psi in [-7.0..-0.1_f64, -7.0..-0.1],
        begin in -100.0..100.0_f64,
        length in 0.01..3.0_f64,
        ln_driving in -2.0..3.0_f64,
    ) {
        let method = methods()[method];
        let rtol = if method == "rosenbrock23" { 1e-4 } else { 1e-9 };
        let words = format!(
            "--driving {} --stiffness 0.14 --method {method} --rtol {rtol}",
            ln_driving.exp()
        );
        let start = [tau, ln_psi[0].exp(), ln_psi[1].exp()];
        let off = apart(&words, (begin, begin + length), &start, 97);
        prop_assert!(off < 1e-12, "{method}: {off:e}");
    }
}
