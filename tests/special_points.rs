//! Special points of equilibria of any system that are easily told wrong: formulas that cancel, coefficients with poles, eigenvalues that cross
//! together, and how branches cross.

use crate::command;
use crate::common::text::file;
use command::{number, object};
use serde_json::Value;

/// The special points with this label, as (name, value of the parameter, uncertainty).
fn points(special: &Value, label: &str, parameter: &str) -> Vec<(String, f64, f64)> {
    let all = special.as_array().expect("special points").iter();
    let own = all.filter(|one| one["label"] == label);
    own.map(|one| {
        let value = |part: &str| number(one, &format!("/{parameter}/{part}"));
        let name = one["name"].as_str().expect("a name").to_owned();
        (name, value("value"), value("uncertainty"))
    })
    .collect()
}

/// Those of a command, which may leave something undecided.
fn special(arguments: &str) -> Value {
    let ended = command::twinslip(&format!("{arguments} --format json -q"));
    assert!([0, 3].contains(&ended.code), "{arguments}: {}", ended.err);
    let made: Value = serde_json::from_str(&ended.out).expect("JSON");
    made["result"]["special"].clone()
}

/// (1e6 + x^2) - p - 1e6 turns at p = 0, where doubles are off by 1e-10.
#[test]
fn a_fold_of_a_formula_that_cancels_is_known_to_its_bound() {
    let run = "branch equilibria --system tests/data/cases/fold-with-cancellation.toml --along p --from 1 --to -1";
    let folds = points(&special(run), "LP", "p");
    let [(_, p, off)] = &folds[..] else {
        panic!("{folds:?}");
    };
    assert!(p.abs() <= *off && *off < 1e-20, "{p} ± {off}");
}

#[test]
fn branch_points_are_named_as_branches_cross() {
    let run = "branch equilibria --system tests/data/cases/coral-transcritical.toml --along g --from 0.01 --to 1";
    let crossings = points(&special(run), "BP", "g");
    for truth in [0.17952, 0.8, 0.3927272727272727] {
        let near = crossings.iter().find(|one| (one.1 - truth).abs() < 1e-12);
        let (name, value, off) = near.unwrap_or_else(|| panic!("{truth} of {crossings:?}"));
        assert_eq!(name, "transcritical");
        assert!((value - truth).abs() <= off + 1e-15, "{value} ± {off}");
    }
    let run =
        "branch equilibria --system tests/data/cases/pitchfork-1d.toml --along al --from -1 --to 1";
    let all = special(run);
    let crossings = points(&all, "BP", "al");
    assert_eq!(crossings, [("pitchfork".to_owned(), 0.0, 0.0)]);
    assert_eq!(points(&all, "LP", "al"), []);
}

/// Of the Lorenz system of 1984 at a = 1/4, b = 4 and of an injected laser: the first Lyapunov coefficient changes its sign through infinity at the
/// zero-Hopf point, and no Hopf point is degenerate. Of the Roessler system one is: its place is from 40 digits.
#[test]
fn a_pole_of_the_lyapunov_coefficient_is_no_zero() {
    for (run, names, truth) in [
        (
            "--system lorenz-84 --set a=0.25 --set b=4 --in F,G --range F=0,4 --range G=0,4",
            ["F", "G"],
            [1.684051724137931, 1.6829685526609],
        ),
        (
            "--system tests/data/cases/false-GH.toml --in K,w --range K=0.01,1 --range w=-1,1",
            ["K", "w"],
            [0.0389302017003, 0.0872636754251],
        ),
    ] {
        let all = special(&format!("locus hopf {run}"));
        assert_eq!(points(&all, "GH", names[0]), []);
        for (name, truth) in names.into_iter().zip(truth) {
            let found = points(&all, "ZH", name);
            assert_eq!(found.len(), 1, "{run}");
            assert!((found[0].1 - truth).abs() < 1e-12, "{found:?}");
        }
    }
    let run = "locus hopf --system roessler --in a,c --range a=0.05,1.5 --range c=0.2,6";
    let all = special(run);
    for (name, truth) in [("a", 0.2003632419596), ("c", 0.4008178572417)] {
        let found = points(&all, "GH", name);
        assert_eq!(found.len(), 1);
        let (_, value, off) = found[0];
        assert!(
            (value - truth).abs() <= off + 5e-14 && off < 1e-9,
            "{value} ± {off}"
        );
    }
    // Where both meet nothing is known of the side.
    let run = "branch equilibria --system roessler --along c --from 0.2 --to 6";
    let made = special(run);
    let hopf = made.as_array().expect("a list").iter();
    let sides: Vec<_> = hopf
        .filter(|one| one["label"] == "HB")
        .map(|one| one["criticality"].clone())
        .collect();
    assert_eq!(sides, ["undecided"]);
}

/// Two pairs cross together: no test function changes its sign.
#[test]
fn eigenvalues_that_cross_together_are_met() {
    let run =
        "--system tests/data/cases/equal-lyapunov-double-hopf.toml --along m --from -0.5 --to 0.5";
    let all = special(&format!("branch equilibria {run}"));
    let hopf = points(&all, "HB", "m");
    assert_eq!(hopf.len(), 2, "{hopf:?}");
    for (_, m, off) in hopf {
        assert!(m.abs() <= off && off < 1e-10, "{m} ± {off}");
    }
    // And orbits leave with either frequency.
    let made = object(&format!("branch orbits {run}"));
    let ends = points(&made["result"]["special"], "EP", "m");
    assert_eq!(ends.len(), 2, "{ends:?}");
    // An eigenvalue of multiplicity two.
    let path = file(
        "two-zeros",
        r#"
        name = "two eigenvalues that are 0 together"
        states = ["x", "y"]
        [parameters]
        m = -1.0
        [rates]
        x = "m*x - x^3"
        y = "m*y - y^3"
        [start]
        x = 0.0
        y = 0.0
        "#,
    );
    let all = special(&format!(
        "branch equilibria --system {path} --along m --from -0.53 --to 0.71"
    ));
    let found = points(&all, "BP", "m");
    assert!(
        found
            .iter()
            .any(|(name, m, off)| name == "branch point" && m.abs() <= *off),
        "{found:?}"
    );
}

/// Prey falls to 1e-20 between its outbreaks: what a run loses below its tolerance its verdict must not have.
#[test]
fn a_periodic_verdict_has_the_period_of_the_orbit() {
    let run = "section --system tests/data/cases/slow-saddles.toml --set K=10 --surface R=1 --returns 100";
    for tolerances in ["", "--atol 1e-14", "--rtol 1e-12 --atol 1e-40"] {
        let ended = command::twinslip(&format!("{run} {tolerances} --format json -q"));
        let made: Value = serde_json::from_str(&ended.out).expect("JSON");
        assert_eq!(made["result"]["regime"], "periodic", "{tolerances}");
        let [period, off] =
            ["value", "uncertainty"].map(|part| number(&made, &format!("/result/period/{part}")));
        assert!(
            (period - 122.92726717).abs() <= off + 1e-8,
            "{period} ± {off}"
        );
        assert!(off < 1e-9, "{off}");
    }
}

/// Hodgkin and Huxley's axon: the rate 0.1 (25 - v)/(exp((25 - v)/10) - 1) is 0/0 on its way. The period is from an independent method.
#[test]
fn rates_that_are_a_quotient_of_zeros_have_orbits() {
    let made = object("orbit --system tests/data/cases/hodgkin-huxley.toml --set I=20");
    let [period, off] =
        ["value", "uncertainty"].map(|part| number(&made, &format!("/result/orbit/period/{part}")));
    assert!(
        (period - 11.565492385838525).abs() <= off + 1e-14 && off < 1e-6,
        "{period} ± {off}"
    );
    let run = "branch equilibria --system tests/data/cases/hodgkin-huxley.toml --along I --from 0 --to 200";
    let hopf = points(&special(run), "HB", "I");
    let truths = [9.7796379953931, 154.5266336658];
    assert_eq!(hopf.len(), 2, "{hopf:?}");
    for ((_, current, off), truth) in hopf.iter().zip(truths) {
        assert!((current - truth).abs() <= off + 1e-10, "{current} ± {off}");
    }
}

/// Three equal oscillators that move alike: their coupling decides at K = 0 on two multipliers at once, which no product of multipliers less 1 sees;
/// their product is 1 as at a torus bifurcation, which it is none.
#[test]
fn two_multipliers_that_reach_1_together_are_found() {
    let run = "branch orbits --system tests/data/cases/three-oscillators.toml --along K --from 0.6 --to -0.3 --start 1,0,1,0,1,0";
    let all = special(run);
    let [(name, value, off)] = &points(&all, "BP", "K")[..] else {
        panic!("{all}");
    };
    assert_eq!(name, "branch point");
    assert!(value.abs() <= *off && *off < 1e-8, "{value} ± {off}");
    assert_eq!(points(&all, "TR", "K"), []);
    let note = all.as_array().expect("a list").iter();
    let note: Vec<_> = note.filter(|one| one["label"] == "BP").collect();
    assert!(note[0]["note"].as_str().expect("a note").contains("1: 2"));
}
