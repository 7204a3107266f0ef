//! Special points that a step had jumped over or invented: each is told, and no others.

use crate::command::{self, number};
use serde_json::Value;

/// Labels of the special points of a command, with these numbers of each and their bounds.
fn points(command: &str, of: &[&str]) -> Vec<(String, Vec<[f64; 2]>)> {
    let ended = command::twinslip(&format!("{command} --format json -q"));
    assert_eq!(ended.code, 0, "{command}: {}", ended.err);
    let made: Value = serde_json::from_str(&ended.out).expect("JSON");
    let special = made["result"]["special"].as_array().expect("a list").iter();
    let told = |one: &Value, name: &str| {
        ["value", "uncertainty"].map(|part| one[name][part].as_f64().unwrap_or(f64::INFINITY))
    };
    let point = |one: &Value| {
        let label = one["label"].as_str().expect("a label").to_owned();
        (label, of.iter().map(|name| told(one, name)).collect())
    };
    special.map(point).collect()
}

fn labels(points: &[(String, Vec<[f64; 2]>)]) -> Vec<&str> {
    points.iter().map(|(label, _)| label.as_str()).collect()
}

/// Nodes of predicted orbits are moved along the flow. A fold that Newton's method finds is on the step all the same.
#[test]
fn a_fold_on_a_short_step_is_met() {
    let file = "tests/data/oscillators/ab-reaction.toml";
    let found = points(
        &format!("branch orbits --system {file} --along D --from 0.01 --to 0.4 --step-limit 0.5"),
        &["D"],
    );
    assert_eq!(labels(&found), ["HB", "SN", "HB"], "{found:?}");
    assert!((found[1].1[0][0] - 0.161_696_129).abs() < 1e-9, "{found:?}");
}

/// Of two small orbits the larger may have nodes that are less far apart, and a branch does not end where it begins to grow. Koper's model is odd: each
/// point has its image.
#[test]
fn a_branch_goes_on_to_the_hopf_point_at_its_end() {
    let file = "tests/data/cases/koper-in-units.toml";
    let found = points(
        &format!("branch orbits --system {file} --along l --from -48482.4 --to 48482.4"),
        &["l"],
    );
    let known = ["HB", "PD", "PD", "SN", "SN", "SN", "SN", "PD", "PD", "HB"];
    assert_eq!(labels(&found), known, "{found:?}");
    for (a, b) in found.iter().zip(found.iter().rev()) {
        let ([a, off], [b, other]) = (a.1[0], b.1[0]);
        assert!((a + b).abs() <= off + other, "{a} {b}");
    }
}

/// Away from cusps the kernel may be across the curve, where the sign that is taken of it changes.
#[test]
fn no_cusp_is_told_where_the_kernel_is_across_the_curve() {
    let file = "tests/data/cases/co-oxidation-in-units.toml";
    let found = points(
        &format!("locus saddle-node --system {file} --in k2,K --range k2=0.5,2 --range K=0.2,0.6"),
        &["k2"],
    );
    assert_eq!(labels(&found), ["EP", "CP", "EP"], "{found:?}");
}

/// An end of a range is the end itself, and known as well as that.
#[test]
fn curves_of_equilibria_end_at_the_ends_of_both_ranges() {
    let file = "tests/data/models/jansen-rit.toml";
    let found = points(
        &format!("locus hopf --system {file} --in p,A --range p=50,350 --range A=2.5,4"),
        &["p", "A"],
    );
    assert_eq!(labels(&found), ["EP"; 4], "{found:?}");
    for (_, at) in &found {
        let exact = |x: f64| [50.0, 350.0, 2.5, 4.0].contains(&x);
        let held = at.iter().filter(|[x, off]| exact(*x) && *off == 0.0);
        assert_eq!(held.count(), 1, "{found:?}");
    }
}

/// The frequency is zero there.
#[test]
fn a_double_zero_has_no_period() {
    let file = "tests/data/models/cstr.toml";
    let found = points(
        &format!("locus hopf --system {file} --in tau,Tc --range tau=40,90 --range Tc=295,315"),
        &["period"],
    );
    let double: Vec<_> = found.iter().filter(|(label, _)| label == "BT").collect();
    assert!(!double.is_empty(), "{found:?}");
    assert!(
        double.iter().all(|(_, of)| of[0][0].is_infinite()),
        "{found:?}"
    );
}

/// A curve of folds shrinks to the degenerate Hopf point that is on the curve of Hopf points, and is not followed back from there.
#[test]
fn a_curve_of_folds_ends_at_a_degenerate_hopf_point() {
    for (file, rho, s0) in [
        ("oscillators/enzyme-cell", "1,15", "90,130"),
        (
            "cases/enzyme-cell-in-units",
            "61541.11184171677,923116.6776257515",
            "189106.72661892368,273154.16067177866",
        ),
    ] {
        let ranges = format!("--in rho,s0 --range rho={rho} --range s0={s0}");
        let of = ["rho", "s0"];
        let file = format!("tests/data/{file}.toml");
        let curve = points(
            &format!("locus orbit-saddle-node --system {file} {ranges}"),
            &of,
        );
        assert_eq!(labels(&curve), ["EP", "GH"], "{curve:?}");
        let hopf = points(&format!("locus hopf --system {file} {ranges}"), &of);
        let on_it = hopf.iter().find(|(label, _)| label == "GH").expect("GH");
        assert_eq!(on_it.1, curve[1].1);
    }
}

/// The last point of a branch is solved anew by the method that the orbit asks for: Taylor's would take a million steps a period.
#[test]
fn a_branch_ends_at_the_period_of_a_stiff_orbit() {
    let file = "tests/data/cases/van-der-pol-stiff.toml";
    let found = points(
        &format!("branch orbits --system {file} --along mu --from 0.5 --to 1e6"),
        &["period"],
    );
    let [period, off] = found.last().expect("an end").1[0];
    // Of 18 digits in 40-digit arithmetic.
    let known = 1_613_705.709_012_797_9;
    assert!((period - known).abs() <= off, "{period} ± {off}");
    assert!(off < 1e-10 * known, "{off}");
}

/// Taylor's method makes some of a branch's orbits and Radau's others: an arc of the one is not lost because the other took few steps for it.
#[test]
fn the_steps_of_one_method_do_not_bound_those_of_another() {
    let found = points(
        "branch orbits --system van-der-pol --along mu --from 0.5 --to 1e5",
        &["mu", "period"],
    );
    assert_eq!(labels(&found), ["EP", "EP"], "{found:?}");
    assert_eq!(found[1].1[0][0], 1e5, "{found:?}");
    // Dorodnicyn's expansion (1947), to terms of 1 / mu.
    let mu = 1e5_f64;
    let known = (3.0 - 2.0 * 2.0_f64.ln()) * mu + 7.014_322_231 / mu.cbrt()
        - (2.0 / 3.0 * mu.ln() + 1.3246) / mu;
    assert!((found[1].1[1][0] - known).abs() < 1e-6, "{found:?}");
}

/// From a start far off any orbit a trial of Newton's method has an arc of millions of steps.
#[test]
fn a_search_for_a_stiff_orbit_ends() {
    let file = "tests/data/cases/brusselator-stiff.toml";
    let asked = format!("orbit --system {file} --set B=1000 --start 0.00117,125000 -q");
    let ended = command::twinslip(&asked);
    assert_eq!(ended.code, 1, "{}", ended.err);
    assert!(
        ended.err.contains("does not converge to a periodic orbit"),
        "{}",
        ended.err
    );
}

/// At a pitchfork of orbits two directions are as good as one another, and the parameter may seem to turn there. No fold can be solved for then.
#[test]
fn pitchforks_of_orbits_are_no_folds() {
    let file = "tests/data/oscillators/torus-circuit.toml";
    for step in ["1", "0.7"] {
        let found = points(
            &format!(
                "branch orbits --system {file} --along nu --from -0.9 --to -0.4 --step-limit {step}"
            ),
            &["nu"],
        );
        let first = ["HB", "SN", "PF", "SN", "PF", "PF", "SN", "SN", "PF"];
        assert_eq!(labels(&found)[..first.len()], first, "{step}: {found:?}");
        let folds = found[..first.len()].iter().filter(|one| one.0 == "SN");
        folds.for_each(|fold| assert!(fold.1[0][1] < 1e-10, "{step}: {fold:?}"));
    }
}

/// Periods of the stiff Brusselator by B: Radau's methods of order 13 and 17 in 34 digits, which agree in 20.
const STIFF_PERIODS: [(&str, f64); 5] = [
    ("100", 2_569.880_157_012_929),
    ("400", 40_293.870_346_297_606),
    ("700", 123_023.798_317_217_22),
    ("1000", 250_756.026_523_460_2),
    ("2000", 1_001_537.662_009_816_2),
];

/// A jump that takes a part of 1e-16 of the period: no node of the branch stands in it, or next to it, and it lasts for less than the spacing of the doubles
/// around its time.
#[test]
fn branches_of_relaxation_oscillations_go_far() {
    let file = "tests/data/cases/brusselator-stiff.toml";
    for (end, known) in STIFF_PERIODS {
        let text = format!(
            "branch orbits --system {file} --along B --from 1.5 --to {end} --format json -q"
        );
        let ended = command::twinslip(&text);
        assert_eq!(ended.code, 0, "{end}: {}", ended.err);
        let made: Value = serde_json::from_str(&ended.out).expect("JSON");
        let result = &made["result"];
        assert!(result["rows"].as_array().expect("rows").len() < 70, "{end}");
        let period = number(&made, "/result/special/1/period/value");
        let off = number(&made, "/result/special/1/period/uncertainty");
        assert!(off < 1e-11 * period, "{end}: {period} ± {off}");
        assert!((period - known).abs() <= off, "{end}: {period} ± {off}");
    }
}

/// Without a branch, from the start of the file.
#[test]
fn orbits_with_spikes_are_found() {
    for (b, known) in STIFF_PERIODS.into_iter().skip(1).step_by(2) {
        let file = "tests/data/cases/brusselator-stiff.toml";
        let text = format!("orbit --system {file} --set B={b} --crosscheck none --format json -q");
        let ended = command::twinslip(&text);
        assert_eq!(ended.code, 0, "{b}: {}", ended.err);
        let made: Value = serde_json::from_str(&ended.out).expect("JSON");
        let period = number(&made, "/result/orbit/period/value");
        let off = number(&made, "/result/orbit/period/uncertainty");
        assert!(off < 1e-9 * period, "{b}: {period} ± {off}");
        assert!((period - known).abs() <= off, "{b}: {period} ± {off}");
    }
}

#[test]
fn numbers_may_have_both_signs() {
    let text =
        "branch equilibria --system lorenz --along r --from -1.5e-05 --to 3 --format json -q";
    let ended = command::twinslip(text);
    assert_eq!(ended.code, 0, "{}", ended.err);
    let made: Value = serde_json::from_str(&ended.out).expect("JSON");
    assert_eq!(number(&made, "/numerics/from"), -1.5e-5);
}

/// Of a conservative system every equilibrium is a centre: a pair of eigenvalues is on the axis but for rounding, whose signs are no Hopf points.
#[test]
fn centres_are_no_hopf_points() {
    let file = "tests/data/cases/lotka-volterra-a.toml";
    let text = format!("branch equilibria --system {file} --along a --from 0.5 --to 2");
    let ended = command::twinslip(&format!("{text} --format json -q"));
    assert_eq!(ended.code, 3, "{}", ended.err);
    let made: Value = serde_json::from_str(&ended.out).expect("JSON");
    let special = made["result"]["special"].as_array().expect("a list");
    let labels: Vec<&str> = special
        .iter()
        .filter_map(|one| one["label"].as_str())
        .collect();
    assert_eq!(labels, ["EP", "EP"]);
}

/// The first orbits beside a Hopf point are neutral but for 1e-6, and so may an orbit beside a pitchfork be: they are computed again, finer.
#[test]
fn orbits_beside_a_bifurcation_are_decided() {
    for (file, along, from, to) in [
        (
            "cases/ab-reaction-in-units",
            "D",
            864.3474641184164,
            34573.89856473666,
        ),
        ("oscillators/food-chain", "p", 0.01, 1.0),
    ] {
        let text = format!(
            "branch orbits --system tests/data/{file}.toml --along {along} --from {from} --to {to}"
        );
        let found = points(&text, &[along]);
        assert!(found.len() > 2, "{found:?}");
    }
}

/// Of an odd force the quadratic coefficient is zero where the state is, to its last digits, and so are all terms of it; and the equation of the force has no
/// derivatives there at all. Of Lorenz's equations the terms that count are.
#[test]
fn symmetric_systems_have_one_pitchfork() {
    for (system, code) in [
        (
            "tests/data/cases/duffing-damped.toml --along k --from -2 --to 2",
            0,
        ),
        (
            "tests/data/cases/duffing-undamped.toml --along k --from -2 --to 2",
            3,
        ),
        ("lorenz --along r --from 0.5 --to 30", 0),
    ] {
        let text = format!("branch equilibria --system {system}");
        let ended = command::twinslip(&text);
        assert_eq!(ended.code, code, "{}", ended.err);
        let told = |word: &str| ended.err.lines().filter(|line| line.contains(word)).count();
        // On either branch.
        assert_eq!(
            [told("pitchfork"), told("  BP  "), told("  LP  ")],
            [2, 2, 0],
            "{}",
            ended.err
        );
    }
}

/// l = x^3: at l = 0 the branch has the slope of a fold, and goes on.
#[test]
fn a_bend_without_a_turn_is_no_fold() {
    let file = "tests/data/cases/hysteresis.toml";
    let text = format!("branch equilibria --system {file} --along l --from -1 --to 1");
    let found = points(&text, &["l"]);
    assert_eq!(labels(&found), ["EP", "HB", "HB", "EP"], "{found:?}");
    // l = x^3 where 1 - 3 x^2 = 0.1
    let known = 0.3_f64.powf(1.5);
    for (point, sign) in [(&found[1], -1.0), (&found[2], 1.0)] {
        let [l, off] = point.1[0];
        assert!((l - sign * known).abs() <= off, "{found:?}");
    }
}
