//! What is said where something is undecided, left out, or blows up.

use crate::command;
use crate::common::ROOT;
use command::{folder, refused, twinslip};
use serde_json::Value;

/// A verdict that is undecided is told in a sentence, which says what may decide it.
#[test]
fn exit_status_3_comes_with_a_sentence() {
    let place = folder("said");
    let part = |n: usize| place.join(format!("part{n}.csv")).display().to_string();
    let whole = place.join("whole.csv").display().to_string();
    let parts = [1, 2].map(|n| {
        let grid = "sweep --driving 0.05:0.1:2 --stiffness 0.1 --max-steps 1";
        format!("{grid} --shard {n}/2 -o {}", part(n))
    });
    let merge = format!("merge {} {} -o {whole}", part(1), part(2));
    let equilibria = "equilibria --driving 0.049863166268876906 --stiffness 0.45 --format json";
    let section = "section --driving 0.102 --stiffness 0.2 --returns 50 --format json";
    for (line, what) in [
        (equilibria, "undecided: the number of steady states"),
        (section, "undecided: the regime: fewer than 200 returns"),
        (&parts[0], "undecided: the regime of 1 row"),
        (&parts[1], "undecided: the regime of 1 row"),
        (&merge, "undecided: the regime of 2 rows"),
    ] {
        let ended = twinslip(line);
        assert_eq!(ended.code, 3, "{line}: {}", ended.err);
        assert!(ended.err.contains(what), "{line}: {}", ended.err);
    }
}

#[test]
fn a_crosscheck_that_is_not_done_has_its_reason() {
    let none = twinslip("orbit --driving 1 --stiffness 0.14 --crosscheck none --format json");
    let made: Value = serde_json::from_str(&none.out).expect("JSON");
    let orbit = &made["result"]["orbit"];
    assert_eq!((none.code, &orbit["crosscheck"]), (0, &Value::Null));
    assert_eq!(orbit["crosscheck_note"], "none is asked for");
    let done = twinslip("orbit --driving 1 --stiffness 0.14 --format json");
    let made: Value = serde_json::from_str(&done.out).expect("JSON");
    assert!(made["result"]["orbit"]["crosscheck"].is_object());
    assert!(made["result"]["orbit"]["crosscheck_note"].is_null());
}

/// Without radiation damping nothing bounds the slip rate of the slip law.
#[test]
fn a_blow_up_without_damping_is_told_with_advice() {
    let run = "integrate --law slip --driving 1 --stiffness 0.01 --until 1000 --final-only";
    let advice = "radiation damping (--damping) bounds the slip rates";
    let undamped = twinslip(run);
    assert_eq!(undamped.code, 1);
    assert!(undamped.err.contains(advice), "{}", undamped.err);
    let damped = twinslip(&format!("{run} --damping 0.01"));
    assert_eq!(damped.code, 0, "{}", damped.err);
    // What is no interface has none.
    let own = "name = 'square'\nstates = ['x']\n[rates]\nx = 'x^2'\n[start]\nx = 1.0\n";
    let file = folder("said-square").join("square.toml");
    std::fs::write(&file, own).expect("a file");
    let ended = twinslip(&format!("integrate --system {} --until 3", file.display()));
    assert_eq!(ended.code, 1, "{}", ended.err);
    assert!(!ended.err.contains("damping"), "{}", ended.err);
}

#[test]
fn an_unknown_parameter_is_told_with_those_that_there_are() {
    let slab = "--driving 1 --stiffness 1 --until 1";
    refused(
        &format!("integrate --set foo=1 {slab}"),
        "--set: no parameter `foo`; known are driving, stiffness, damping",
    );
    refused(
        "integrate --system lorenz --set foo=1 --until 1",
        "--set: no parameter `foo`; known are s, r, b",
    );
    refused(
        &format!("integrate --interfaces 3 --set foo=1 {slab}"),
        "--set: no parameter `foo`; known are driving, stiffness",
    );
}

/// A run that has made all returns that were asked for, and none after them.
#[test]
fn all_returns_that_were_asked_for_are_enough() {
    // It passes the section once.
    let own = "name = 'falling'\nstates = ['x', 'u']\n[rates]\nx = '-1'\nu = '-u'\n[start]\nx = 0.0\nu = 1.0\n";
    let file = folder("said-falling").join("falling.toml");
    std::fs::write(&file, own).expect("a file");
    let section = |returns: usize| {
        let file = file.display();
        twinslip(&format!(
            "section --system {file} --surface x=-2 --skip 0 --returns {returns} --patience 50 --format csv"
        ))
    };
    let asked = section(1);
    assert!(!asked.err.contains("no return"), "{}", asked.err);
    assert_eq!(asked.code, 3, "{}", asked.err);
    let rows = asked.out.lines().filter(|line| !line.starts_with('#'));
    assert_eq!(rows.count(), 2, "{}", asked.out);
    let more = section(2);
    assert_eq!(more.code, 1, "{}", more.err);
    assert!(more.err.contains("no return"), "{}", more.err);
}

/// What tells nothing of a single interface is in no table.
#[test]
fn tables_of_one_interface_have_what_one_has() {
    let run = "integrate --interfaces 1 --driving 1 --stiffness 0.1 --until 100 --events --format table --points 2";
    let table = twinslip(run);
    assert_eq!(table.code, 0, "{}", table.err);
    assert!(
        table.out.contains("onset") && !table.out.contains("leader"),
        "{}",
        table.out
    );
    for line in [
        "equilibria --interfaces 1 --driving 1 --stiffness 0.1 --format table",
        "orbit --interfaces 1 --driving 1 --stiffness 0.1 --crosscheck none --format table",
        "locus hopf --interfaces 1 --driving-range 1,2 --format table",
    ] {
        let table = twinslip(line);
        assert_eq!(table.code, 0, "{line}: {}", table.err);
        assert!(!table.out.contains("symmetr"), "{line}: {}", table.out);
    }
}

/// Where there is nothing to show it is said what was looked for.
#[test]
fn a_curve_that_is_nowhere_is_told_of() {
    let any = "--in stiffness,residual_strength --range stiffness=2,3 --range residual_strength=5e-4,2e-3 --driving 2";
    for (ranges, code) in [("--stiffness-range 2,3 --driving-range 1,2", 0), (any, 1)] {
        let ended = twinslip(&format!("locus hopf {ranges} --format csv"));
        assert_eq!(ended.code, code, "{}", ended.err);
        let sentence = "no hopf bifurcation is found in these ranges";
        assert!(ended.err.contains(sentence), "{}", ended.err);
    }
}

/// The estimate strengthens with velocity: no draw is followed for a band that nothing has.
#[test]
fn an_ensemble_of_a_law_without_a_curve_says_so() {
    let root = std::path::Path::new(ROOT);
    let fit = std::fs::read_to_string(root.join("tests/data/fit.json")).expect("a fit");
    let strengthening = fit.replace("0.0152", "0.0082");
    assert_ne!(fit, strengthening);
    let file = folder("said-ensemble").join("fit.json");
    std::fs::write(&file, strengthening).expect("a file");
    let line = format!("locus hopf --ensemble {}:500 --format json", file.display());
    let ended = twinslip(&line);
    assert_eq!(ended.code, 0, "{}", ended.err);
    assert!(
        ended.err.contains("no hopf bifurcation is found"),
        "{}",
        ended.err
    );
    let made: Value = serde_json::from_str(&ended.out).expect("JSON");
    assert_eq!(made["result"]["ensemble"]["draws"], 0);
}

/// Points that are undecided in all draws have no regime in common.
#[test]
fn undecided_is_no_regime_that_draws_share() {
    let root = std::path::Path::new(ROOT);
    let fit = root.join("tests/data/fit.json");
    let line = format!(
        "sweep --interfaces 1 --driving 1e-6 --stiffness 1e9:3e9:3 --ensemble {}:2 --max-steps 1 --format csv",
        fit.display()
    );
    let ended = twinslip(&line);
    assert_eq!(ended.code, 3, "{}", ended.err);
    let sentence = "at 0 points of 3 points the same regime in at least 95 % of draws, at 3 undecided in as many";
    assert!(ended.err.contains(sentence), "{}", ended.err);
}
