//! Steady states and steady curves of user-defined friction laws from files: those of the built-in laws.

use crate::command;
use crate::common::text::{alike, law, near};
use command::{number, object};
use serde_json::Value;

#[test]
fn equilibria_are_all_those_of_the_built_in_law() {
    let file = law("spinodal");
    for loading in [
        "--driving 0.12 --stiffness 0.14",
        "--driving 100 --stiffness 0.05",
    ] {
        let known = object(&format!("equilibria {loading}"));
        let known = known["result"]["equilibria"]
            .as_array()
            .expect("a list")
            .clone();
        let made = object(&format!("equilibria --law {file} {loading}"));
        assert_eq!(made["result"]["complete"], true);
        let made = made["result"]["equilibria"]
            .as_array()
            .expect("a list")
            .clone();
        // Each of a pair on its own.
        let count = known
            .iter()
            .map(|one| if one["symmetry"] == "symmetric" { 1 } else { 2 });
        assert_eq!(made.len(), count.sum::<usize>());
        for one in &known {
            let stress = one["stress"]["value"].as_f64().expect("a number");
            let near_it = |made: &&Value| (number(made, "/stress/value") - stress).abs() < 1e-9;
            let found: Vec<&Value> = made.iter().filter(near_it).collect();
            assert!(!found.is_empty(), "{stress}");
            for found in found {
                near(number(found, "/stress/value"), stress, 1e-12);
                assert!(number(found, "/stress/uncertainty") < 1e-9);
                assert_eq!(found["verdict"], one["verdict"]);
                let leading = |one: &Value| number(one, "/eigenvalues/0/0");
                near(leading(found), leading(one), 1e-10);
            }
        }
    }
}

#[test]
fn the_steady_curve_is_that_of_the_built_in_law() {
    for (name, extrema) in [
        ("spinodal", 2),
        ("bounded", 1),
        ("regularised-ageing", 0),
        ("slip", 0),
    ] {
        let file = law(name);
        let curve = |law: &str| object(&format!("law --law {law} --points 60"));
        let (made, known) = (curve(&file), curve(name));
        let rows = |made: &Value| made["result"]["rows"].as_array().cloned().expect("rows");
        for (made, known) in rows(&made).iter().zip(&rows(&known)) {
            let names = ["slip_rate", "stress", "friction"];
            alike(made, known, 1e-13, &names);
            let value = |row: &Value, name: &str| row[name].as_f64().expect("a number");
            let off = |name: &str| (value(made, name) - value(known, name)).abs();
            assert!(off("stress") <= value(made, "stress_uncertainty"));
            assert!(off("state") <= value(made, "state_uncertainty"));
            assert!(off("state") <= 1e-12 * value(known, "state"));
            let stiffness = value(known, "critical_stiffness");
            assert!(off("critical_stiffness") <= 1e-11 * (stiffness.abs() + 1e-3));
        }
        let list = |made: &Value| {
            made["result"]["extrema"]
                .as_array()
                .cloned()
                .expect("a list")
        };
        assert_eq!(list(&made).len(), extrema, "{name}");
        for (made, known) in list(&made).iter().zip(&list(&known)) {
            assert_eq!(made["kind"], known["kind"]);
            for of in ["slip_rate", "stress"] {
                let value = |one: &Value| number(one, &format!("/{of}/value"));
                let error = number(made, &format!("/{of}/uncertainty"));
                let off = (value(made) - value(known)).abs();
                assert!(
                    off <= error + 1e-14 * value(known),
                    "{of}: {off} of {error}"
                );
                assert!(error < 1e-6 * value(known), "{error}");
            }
        }
        let top = |made: &Value, of: &str| {
            made["result"]["critical_stiffness_maximum"][of]["value"].as_f64()
        };
        // Built-in laws have one between two extrema alone; others may have a flat one elsewhere.
        if name == "spinodal" {
            for of in ["slip_rate", "stiffness"] {
                let both = top(&made, of).zip(top(&known, of));
                let (made, known) = both.expect("a maximum");
                near(made, known, 1e-9);
            }
        }
    }
}

#[test]
fn the_law_that_the_program_carries_slides() {
    // At low rates x = v psi solves x ln x = 1, at high ones it is 1.
    let made = object("law --law composite.toml --from 1e-9 --to 1e3 --points 2");
    let state = |row: usize| {
        let pointer = format!("/result/rows/{row}");
        number(&made, &format!("{pointer}/slip_rate")) * number(&made, &format!("{pointer}/state"))
    };
    near(state(0), 1.763_222_834_351_896_7, 1e-6);
    near(state(1), 1.0, 1e-12);
    let made = object(
        "integrate --law scenes/laws/composite.toml --driving 1 --stiffness 2 --until 5 --final-only",
    );
    assert_eq!(made["model"]["law"], "composite");
    assert!(number(&made, "/result/final/state_1") > 0.0);
}

/// Radiation damping: equilibria, their stability and steady curves are those of the built-in law.
#[test]
fn damped_steady_states_are_those_of_the_built_in_law() {
    let file = law("spinodal");
    for law in ["--damping 0.001", "--damping 0.5"] {
        let of = |name: &str, command: &str| object(&format!("{command} --law {name} {law}"));
        let both = |command: &str| (of(&file, command), of("spinodal", command));
        let (made, known) = both("law --points 40");
        let rows = |made: &Value| made["result"]["rows"].as_array().cloned().expect("rows");
        for (made, known) in rows(&made).iter().zip(&rows(&known)) {
            alike(made, known, 1e-12, &["stress", "state"]);
            let critical = |row: &Value| number(row, "/critical_stiffness");
            near(critical(made), critical(known), 1e-11);
        }
        let (made, known) = both("equilibria --driving 10 --stiffness 0.14 --interfaces 1");
        for at in ["stress/value", "eigenvalues/0/0", "eigenvalues/0/1"] {
            let at = format!("/result/equilibria/0/{at}");
            near(number(&made, &at), number(&known, &at), 1e-11);
        }
        let verdict = |made: &Value| made["result"]["equilibria"][0]["verdict"].clone();
        assert_eq!(verdict(&made), verdict(&known));
    }
}
