//! Fits of steps of velocity by the program: long records, several steps, parameters that records do not determine.

use super::command::{folder, run};
use super::common::laboratory::Slid;
use serde_json::Value;
use std::fs;

fn result(name: &str, text: &str, options: &[&str]) -> Value {
    let path = folder("fit_steps").join(name);
    fs::write(&path, text).expect("a file");
    let mut words = vec!["fit", path.to_str().expect("a name")];
    words.extend(["--format=json", "-q"]);
    words.extend(options);
    let ended = run(&words);
    assert!([0, 3].contains(&ended.code), "{name}: {}", ended.err);
    let object: Value = serde_json::from_str(&ended.out).expect("JSON");
    object["result"].clone()
}

fn parameters(fit: &Value) -> &Vec<Value> {
    fit["parameters"].as_array().expect("a list")
}

fn parameter<'a>(fit: &'a Value, name: &str) -> &'a Value {
    let own = parameters(fit).iter().find(|one| one["name"] == name);
    own.expect("it is fitted")
}

/// Every parameter of the slider is found within `most` standard errors.
fn is_near(fit: &Value, slid: &Slid, most: f64) {
    for (name, truth) in [
        ("direct_effect", slid.direct_effect),
        ("evolution_effect", slid.evolution_effect),
        ("slip_length", slid.slip_length),
        ("stiffness", slid.stiffness),
    ] {
        let own = parameter(fit, name);
        let number = |key: &str| own[key].as_f64().expect("a number");
        let off = (number("value") - truth).abs() / number("uncertainty");
        assert!(off < most, "{name}: {off} standard errors: {own}");
        assert!(number("uncertainty") < 0.1 * truth, "{own}");
    }
}

fn one_step() -> Slid {
    Slid {
        stiffness: 5e3,
        direct_effect: 0.008,
        evolution_effect: 0.010,
        slip_length: 2e-5,
        noise: 2e-4,
        program: vec![(0.0, 1e-6), (600.0, 1e-5)],
        until: 1000.0,
    }
}

#[test]
fn a_long_record_of_one_step_is_fitted() {
    let slid = one_step();
    let found = result("long.csv", &slid.record(16_467, 1), &[]);
    assert_eq!(found["fit"]["verdict"], "converged", "{}", found["fit"]);
    is_near(&found["fit"], &slid, 4.0);
    // Of a step that is not there nothing is known: no length of 1e30 m.
    let flat = Slid {
        direct_effect: 0.05,
        evolution_effect: 1e-9,
        noise: 1e-3,
        ..slid
    };
    let found = result("flat.csv", &flat.record(4000, 2), &["--intervals=linear"]);
    let fit = &found["fit"];
    assert_eq!(fit["verdict"], "undecided", "{fit}");
    let length = parameter(fit, "slip_length")["value"].as_f64();
    assert!(length.is_none_or(|x| x < 1.0), "{fit}");
}

#[test]
fn what_is_not_determined_has_no_error_of_zero() {
    let slid = one_step();
    let text = slid.record(2000, 3);
    let found = result("two.csv", &text, &["--states=2", "--intervals=linear"]);
    let fit = &found["fit"];
    assert_eq!(fit["verdict"], "undecided", "{fit}");
    let undetermined = fit["undetermined"].as_array().expect("a list");
    assert!(!undetermined.is_empty(), "{fit}");
    for one in parameters(fit) {
        let error = one["uncertainty"].as_f64();
        assert!(error != Some(0.0), "{one}");
        let is_told = undetermined.contains(&one["name"]);
        assert!(error.is_some() || is_told, "{one}");
    }
    let law = slid.record(2000, 3);
    // Healing of a law in which it does not show.
    let found = result(
        "none.csv",
        &law,
        &[
            "--law=slip",
            "--free=direct_effect,evolution_effect,slip_length,stiffness,reference_friction,drift",
        ],
    );
    for one in parameters(&found["fit"]) {
        assert!(one["uncertainty"].as_f64() != Some(0.0), "{one}");
    }
}

#[test]
fn each_step_begins_in_what_the_steps_before_left() {
    let slid = Slid {
        direct_effect: 0.010,
        evolution_effect: 0.013,
        slip_length: 3e-5,
        noise: 5e-5,
        program: vec![(0.0, 1e-6), (60.0, 1e-5), (66.0, 1e-6), (90.0, 1e-5)],
        until: 140.0,
        ..one_step()
    };
    let text = slid.record(4000, 4);
    let found = result("near.csv", &text, &["--each-step", "--intervals=linear"]);
    let steps = found["steps"].as_array().expect("steps");
    assert_eq!(steps.len(), 3, "{steps:?}");
    for step in steps {
        let own = parameter(&step["fit"], "direct_effect");
        let number = |key: &str| own[key].as_f64().expect("a number");
        let off = (number("value") - slid.direct_effect).abs();
        assert!(off < 4.0 * number("uncertainty"), "{step}");
        assert!(off < 5e-4, "{step}");
    }
}

#[test]
fn evidence_by_information_and_by_prediction_agree() {
    let slid = Slid {
        program: vec![(0.0, 1e-6), (100.0, 1e-5)],
        until: 150.0,
        ..one_step()
    };
    let words = ["--law=slip,dieterich-ruina", "--intervals=linear"];
    let found = result("laws.csv", &slid.record(2000, 5), &words);
    let laws = found["laws"].as_array().expect("laws");
    let of = |law: &str, key: &str| {
        let own = laws.iter().find(|own| own["law"] == law).expect("it");
        own[key].as_f64().expect("a number")
    };
    let (right, wrong) = ("dieterich-ruina", "slip");
    assert!(of(wrong, "aicc_difference") > 10.0, "{laws:?}");
    assert_eq!(of(right, "aicc_difference"), 0.0);
    let missed = |law| of(law, "cross_validation_rms");
    assert!(missed(right) < missed(wrong), "{laws:?}");
    assert!(missed(right) < 1.1 * slid.noise, "{laws:?}");
}

#[test]
fn given_values_are_starts_where_the_record_shows_no_step() {
    let slid = Slid {
        program: vec![(0.0, 1e-5), (40.0, 0.0), (100.0, 1e-5)],
        until: 160.0,
        noise: 5e-5,
        ..one_step()
    };
    let text = slid.record(2000, 6);
    let words = [
        "--program=40:0,100:1e-5",
        "--driving=1e-5",
        "--direct-effect=0.01",
        "--evolution-effect=0.01",
        "--slip-length=1e-5",
        "--stiffness=0.003/um",
        "--reference-friction=0.6",
    ];
    let found = result("hold.csv", &text, &words);
    assert_eq!(found["fit"]["verdict"], "converged", "{}", found["fit"]);
    is_near(&found["fit"], &slid, 4.0);
}
