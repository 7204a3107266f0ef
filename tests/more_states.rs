//! Interfaces with a second state variable and with mass, against references of thirty digits and against interfaces that have neither.

use crate::command::{number, object, object_or_undecided, refused_in_one_line, twinslip};
use crate::common::{self, data};
use serde_json::Value;
use std::f64::consts::TAU;

/// The cases of a file whose name has this word.
fn cases(file: &str, word: &str) -> Vec<Value> {
    let all = data(file);
    let all = all["cases"].as_array().expect("a list").iter();
    let named = all.filter(|case| case["id"].as_str().is_some_and(|id| id.contains(word)));
    named.cloned().collect()
}

fn text(value: &Value) -> &str {
    let text = value.as_str().expect("a text");
    text.split(' ').next().unwrap_or(text)
}

/// A value with its uncertainty contains the known one, and the uncertainty is no larger than this.
#[track_caller]
fn holds(made: &Value, known: f64, sharp: f64) {
    let (value, uncertainty) = (number(made, "/value"), number(made, "/uncertainty"));
    // The known one is rounded to a double, too.
    let rounded = 2.0 * f64::EPSILON * known.abs();
    assert!(
        (value - known).abs() <= uncertainty + rounded,
        "{made} for {known}"
    );
    assert!(uncertainty <= sharp, "{made} for {known}");
}

/// The options of a case, without K.
fn model(case: &Value, law: &str) -> String {
    let all = &case["problem"]["parameters"];
    let of = |name: &str| text(&all[name]);
    let mut model = format!(
        "--interfaces 1 --law {law} --driving {} --direct-effect {} --reference-friction {}",
        of("VL"),
        of("a"),
        of("mustar")
    );
    model += &match all.get("b1") {
        Some(_) => format!(
            " --evolution-effect {} --second-evolution-effect {} --second-slip-length {}",
            of("b1"),
            of("b2"),
            of("r")
        ),
        None => format!(" --evolution-effect {} --mass {}", of("b"), of("m")),
    };
    match all.get("eta").map(text) {
        None | Some("0") => model,
        Some(eta) => model + " --damping " + eta,
    }
}

fn law_of(case: &Value) -> &'static str {
    match case["id"].as_str().is_some_and(|id| id.contains("slip")) {
        true => "slip",
        false => "ageing",
    }
}

#[test]
fn critical_stiffness_and_frequency_meet_their_references() {
    let two = cases("two_states.json", "critical");
    let mass = cases("inertia.json", "critical");
    assert!(two.len() > 1 && mass.len() > 1);
    for case in two.iter().chain(&mass) {
        let values = &case["values"];
        let hopf = values.get("hopf").map_or(values, |all| &all[0]);
        let k = common::number(hopf.get("k").or(hopf.get("k_c")).expect("a stiffness"));
        let period = TAU / common::number(&hopf["omega"]);
        for law in ["ageing", "slip"] {
            let model = model(case, law);
            let made = object_or_undecided(&format!(
                "branch equilibria {model} --along stiffness=0.05:2"
            ));
            let all = made["result"]["special"].as_array().expect("a list");
            let found: Vec<&Value> = all.iter().filter(|one| one["label"] == "HB").collect();
            assert_eq!(found.len(), 1, "{model}");
            holds(&found[0]["stiffness"], k, 1e-9);
            holds(&found[0]["period"], period, 1e-9);
            // The same from the derivatives at steady sliding, and the verdicts on its sides.
            let v = text(&case["problem"]["parameters"]["VL"]);
            let curve = object(&format!("law {model} --from {v} --to 10 --points 2"));
            let critical = number(&curve, "/result/rows/0/critical_stiffness");
            assert!((critical / k - 1.0).abs() < 1e-12, "{critical} for {k}");
            for (part, verdict) in [(0.999, "unstable"), (1.001, "stable")] {
                let made = object(&format!("equilibria {model} --stiffness {}", part * k));
                assert_eq!(made["result"]["equilibria"][0]["verdict"], verdict);
            }
        }
    }
}

#[test]
fn cycles_meet_their_references() {
    let two = cases("two_states.json", "cycle");
    let mass = cases("inertia.json", "cycle_slip");
    for case in two.iter().chain(&mass) {
        let (values, law) = (&case["values"], law_of(case));
        let k = text(&case["problem"]["parameters"]["K"]);
        let made = object(&format!(
            "orbit {} --stiffness {k} --crosscheck none",
            model(case, law)
        ));
        let orbit = &made["result"]["orbit"];
        holds(&orbit["period"], common::number(&values["period"]), 1e-9);
        let known = values["ln_abs_multipliers"].as_array().expect("a list");
        for (i, known) in known.iter().enumerate() {
            // One below the rounding of the reference is not known there.
            const FLOOR: f64 = -70.0;
            let known = common::number(known);
            let made = &orbit["log_multipliers"][i]["ln_abs"];
            match known > FLOOR {
                true => holds(made, known, 1e-9),
                false => assert!(number(made, "/value") < FLOOR),
            }
        }
        let fastest = number(orbit, "/slip_rate_max");
        let known = common::number(&values["V_max"]);
        assert!(
            (fastest / known - 1.0).abs() < 1e-9,
            "{fastest} for {known}"
        );
        assert_eq!(orbit["verdict"], "stable");
        // The least state is that of the state variable, not of the slip rate.
        let least = number(orbit, "/extremes/log_state_1/min/value").exp();
        assert_eq!(number(orbit, "/state_min"), least);
    }
}

#[test]
fn steps_of_the_driving_velocity_meet_their_references() {
    for case in cases("two_states.json", "step") {
        let length = common::number(&case["problem"]["parameters"]["r"]);
        let made = object(&format!(
            "integrate {} --stiffness {} --program 0:10 --start near-symmetric:0 --until 30 --every 0.1 --rtol 1e-12",
            model(&case, law_of(&case)),
            text(&case["problem"]["parameters"]["K"])
        ));
        let rows = made["result"]["rows"].as_array().expect("rows");
        let response = case["values"]["response"].as_array().expect("a list");
        for known in response {
            let t = common::number(&known["t"]);
            if t > 30.0 {
                continue;
            }
            let is_then = |row: &&Value| (number(row, "/time") - t).abs() < 1e-9;
            let row = rows.iter().find(is_then).expect("a row");
            for (name, known, unit) in [
                ("stress", "tau", 1.0),
                ("slip_rate_1", "V", 1.0),
                ("state_1", "theta1", 1.0),
                ("second_state_1", "theta2", length),
            ]
            .map(|(name, field, unit)| (name, common::number(&known[field]), unit))
            {
                let value = row[name].as_f64().expect("a number") / unit;
                assert!((value / known - 1.0).abs() < 1e-9, "{name} at {t}: {value}");
            }
        }
    }
}

/// A second state variable without strength is none, and two interfaces keep their symmetry.
#[test]
fn what_has_no_strength_changes_nothing() {
    let loading = "--driving 10 --stiffness 0.14";
    let none = "--second-evolution-effect 0 --second-slip-length 3";
    let period = |more: &str, symmetry: &str| {
        let command = format!("orbit {loading} {more} --symmetry {symmetry} --crosscheck none");
        object(&command)["result"]["orbit"].clone()
    };
    for symmetry in ["symmetric", "asymmetric"] {
        let (plain, more) = (period("", symmetry), period(none, symmetry));
        assert_eq!(more["symmetry"], symmetry);
        let (plain, more) = (&plain["period"], &more["period"]);
        let off = (number(plain, "/value") - number(more, "/value")).abs();
        let bound = number(plain, "/uncertainty") + number(more, "/uncertainty");
        assert!(off <= bound + 1e-13, "{plain} and {more}");
    }
}

/// Mass and a second state variable leave steady friction as it is but for their own terms: the branches of two equal interfaces meet at the
/// same pitchforks.
#[test]
fn two_equal_interfaces_keep_their_pitchforks() {
    let special = |more: &str| {
        let command = format!("branch equilibria --along driving=20:2000 --stiffness 0.5 {more}");
        let made = object_or_undecided(&command);
        let all = made["result"]["special"]
            .as_array()
            .expect("a list")
            .clone();
        let found = all.into_iter().filter(|one| one["label"] == "BP");
        found
            .map(|one| one["driving"].clone())
            .collect::<Vec<Value>>()
    };
    let (plain, massive) = (special(""), special("--mass 1e-3"));
    assert!(plain.len() == 1 && !massive.is_empty());
    // Found on both branches that meet there.
    for massive in &massive {
        holds(massive, number(&plain[0], "/value"), 1e-6);
    }
}

/// In SI as without units.
#[test]
fn units_change_nothing() {
    let (length, rate, sigma, a): (f64, f64, f64, f64) = (1e-5, 1e-6, 5e6, 0.0349);
    let (stress, time) = (a * sigma, length / rate);
    let (k, m) = (0.5, 0.3);
    let law = "--interfaces 1 --law ageing --second-evolution-effect 0.003";
    let plain = object(&format!(
        "integrate {law} --second-slip-length 4 --mass {m} --driving 1 --stiffness {k} --until 30 --final-only --rtol 1e-11"
    ));
    let in_si = object(&format!(
        "integrate {law} --second-slip-length 40um --mass {}kg/m^2 --driving 1um/s --stiffness {}Pa/m --until {}s --slip-length 10um --normal-stress 5MPa --final-only --rtol 1e-11",
        m * stress * length / (rate * rate),
        k * stress / length,
        30.0 * time
    ));
    let (plain, in_si) = (&plain["result"]["final"], &in_si["result"]["final"]);
    for (name, unit) in [
        ("stress", stress),
        ("state_1", time),
        ("second_state_1", time),
        ("slip_rate_1", rate),
        ("slip_1", length),
    ] {
        let (x, y) = (plain[name].as_f64(), in_si[name].as_f64());
        let (x, y) = (x.expect("a number"), y.expect("a number") / unit);
        assert!((x / y - 1.0).abs() < 1e-9, "{name}: {x} and {y}");
    }
}

/// Runs of clusters in SI are those of built-in interfaces.
#[test]
fn formulas_have_units_as_built_in_laws_have() {
    let run = |which: &str| {
        object(&format!(
            "integrate {which} --si --driving 1e-6 --stiffness 1e10 --program 1:2e-6,2-2.5:5e-7 --until 3 --final-only --rtol 1e-11"
        ))["result"]["final"]
            .clone()
    };
    let (formulas, built_in) = (run("--clusters 1,1"), run("--interfaces 2"));
    for (name, value) in built_in.as_object().expect("an object") {
        let (Some(x), Some(y)) = (value.as_f64(), formulas[name].as_f64()) else {
            continue;
        };
        assert!((x - y).abs() <= 1e-8 * x.abs(), "{name}: {x} and {y}");
    }
}

#[test]
fn what_cannot_be_is_refused() {
    for (arguments, sentence) in [
        ("equilibria --mass -1 --driving 1", "mass is -1"),
        (
            "equilibria --second-evolution-effect 0.01 --driving 1",
            "--second-slip-length L2 is missing",
        ),
        (
            "equilibria --second-slip-length 2 --driving 1",
            "--second-evolution-effect b2 is missing",
        ),
        (
            "equilibria --second-evolution-effect 0.01 --second-slip-length -2 --driving 1",
            "second_slip_length is -2",
        ),
        (
            "integrate --interfaces 100 --mass 1 --driving 1 --stiffness 1 --until 1",
            "many interfaces have one state variable",
        ),
        (
            "equilibria --interfaces 2000 --mass 1 --driving 1",
            "at most 7 can move independently",
        ),
        (
            "orbit --clusters 2,2 --mass 1 --driving 1 --stiffness 1",
            "--clusters that split",
        ),
        (
            "equilibria --mass 1 --set mass_2=-1 --driving 1 --stiffness 1",
            "mass_2 is -1",
        ),
        (
            "integrate --mass 1 --start 9,1 --interfaces 1 --driving 1 --stiffness 1 --until 1",
            "must be TAU,PSI,V",
        ),
        (
            "integrate --mass 1 --start 9,1,-1 --interfaces 1 --driving 1 --stiffness 1 --until 1",
            "v in --start is -1",
        ),
        (
            "law --law cutoff --mass 1",
            "must be a factor times sinh or exp of a multiple of tau",
        ),
        (
            "law --law nagata --second-evolution-effect 0.01 --second-slip-length 2",
            "takes no second state variable",
        ),
    ] {
        refused_in_one_line(arguments, sentence);
    }
    // No mass is none.
    let massless = twinslip("equilibria --driving 10 --stiffness 0.14 --mass 0 -q --format csv");
    assert!(massless.out.contains("\nasymmetric,"), "{}", massless.out);
}
