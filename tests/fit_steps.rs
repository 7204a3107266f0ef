//! Fits of steps of velocity by the program: long records, several steps, parameters that records do not determine.

use super::command::{folder, run};
use super::common::laboratory::Slid;
use crate::common::ROOT;
use serde_json::Value;
use std::fs;

fn result(name: &str, text: &str, options: &[&str]) -> Value {
    let path = folder(&format!("fit_steps_{name}")).join(name);
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
        assert!(number("uncertainty") < 0.1 * truth.abs(), "{own}");
    }
}

fn one_step() -> Slid {
    Slid {
        stiffness: 5e3,
        direct_effect: 0.008,
        evolution_effect: 0.010,
        slip_length: 2e-5,
        noise: 2e-4,
        scatter: 0.0,
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
}

#[test]
fn friction_that_goes_on_in_the_direction_of_the_step_has_a_negative_b() {
    let clay = Slid {
        evolution_effect: -0.006,
        ..one_step()
    };
    let text = clay.record(2_001, 4);
    let found = result("positive.csv", &text, &["--intervals=linear"]);
    assert_eq!(found["fit"]["verdict"], "undecided", "{}", found["fit"]);
    let notes = found["notes"].to_string();
    assert!(notes.contains("evolution_effect=-0.1:0.1"), "{notes}");
    let signed = ["--bounds=evolution_effect=-0.1:0.1"];
    let found = result("signed.csv", &text, &signed);
    assert_eq!(found["fit"]["verdict"], "converged", "{}", found["fit"]);
    is_near(&found["fit"], &clay, 4.0);
    // Draws have that sign, too.
    let posterior = [signed[0], "--posterior=400", "--intervals=linear"];
    let drawn = result("signed.csv", &text, &posterior);
    let b = drawn["posterior"]["parameters"][1]["mean"].as_f64();
    let off = b.expect("a number") / clay.evolution_effect - 1.0;
    assert!(off.abs() < 0.1, "{}", drawn["posterior"]);
    // The bounds do not decide the sign.
    let found = result("rock.csv", &one_step().record(2_001, 4), &signed);
    assert_eq!(found["fit"]["verdict"], "converged", "{}", found["fit"]);
    is_near(&found["fit"], &one_step(), 4.0);
    // A value is one to fix, or a start.
    let fixed = result("fixed.csv", &text, &["--evolution-effect=-0.006"]);
    let off = parameter(&fixed["fit"], "direct_effect")["value"].as_f64();
    assert!((off.expect("a number") / clay.direct_effect - 1.0).abs() < 0.02);
}

#[test]
fn a_record_may_begin_with_its_step() {
    let slid = one_step();
    let text = slid.record(10_001, 5);
    let begins = ["--from=600", "--program=600:1e-5", "--driving=1e-6"];
    let found = result("begins.csv", &text, &begins);
    assert_eq!(found["fit"]["verdict"], "converged", "{}", found["fit"]);
    is_near(&found["fit"], &slid, 4.0);
    // What a program says earlier is the velocity before, too.
    let earlier = ["--from=600", "--program=0:1e-6,600:1e-5"];
    let again = result("begins.csv", &text, &earlier);
    assert_eq!(again["fit"]["parameters"], found["fit"]["parameters"]);
}

#[test]
fn what_a_step_without_evolution_does_not_determine_has_no_value() {
    let flat = Slid {
        evolution_effect: 1e-9,
        ..one_step()
    };
    let text = flat.record(1_001, 2);
    for intervals in ["--intervals=profile", "--intervals=linear"] {
        let found = result("flat.csv", &text, &[intervals]);
        let fit = &found["fit"];
        assert_eq!(fit["verdict"], "undecided", "{fit}");
        let told = fit["undetermined"].as_array().expect("a list");
        let unknown = ["evolution_effect", "slip_length"];
        for name in unknown {
            assert!(told.iter().any(|one| one == name), "{fit}");
        }
        let truth = [
            ("direct_effect", flat.direct_effect),
            ("evolution_effect", flat.evolution_effect),
            ("slip_length", flat.slip_length),
            ("stiffness", flat.stiffness),
        ];
        for (name, truth) in truth {
            let own = parameter(fit, name);
            if unknown.contains(&name) {
                assert!(own["value"].is_null(), "{own}");
            }
            if own["value"].is_null() {
                assert!(told.iter().any(|one| one == name), "{fit}");
            } else {
                let number = |key: &str| own[key].as_f64().expect("a number");
                let off = (number("value") - truth).abs() / number("uncertainty");
                assert!(off < 5.0, "{name}: {off} standard errors: {own}");
            }
        }
        // A search along what is not known ends, too: after some six looks at each of the points that the profiles may have.
        let evaluations = fit["evaluations"].as_f64().expect("a count");
        let points = 2.0 * 12.0 * parameters(fit).len() as f64;
        assert!(evaluations < 6.0 * points, "{evaluations}");
    }
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

/// The parameters of the record in `slide-hold-slide.txt`.
fn hold() -> Slid {
    Slid {
        direct_effect: 0.010,
        evolution_effect: 0.013,
        slip_length: 1.2e-5,
        ..one_step()
    }
}

const GIVEN: [&str; 5] = [
    "--direct-effect=0.008",
    "--evolution-effect=0.008",
    "--slip-length=1e-5",
    "--stiffness=0.003/um",
    "--reference-friction=0.6",
];

#[test]
fn a_hold_is_fitted_from_its_displacement_or_by_a_program() {
    let text = fs::read_to_string(format!("{ROOT}/tests/data/cases/slide-hold-slide.txt"))
        .expect("a record");
    let program = ["--program=40:0,140:1e-5", "--driving=1e-5"];
    let fit = |more: &[&str]| result("hold.csv", &text, more)["fit"].clone();
    let by_displacement = fit(&["--intervals=linear"]);
    let by_program = fit(&[&program[..], &["--intervals=linear"]].concat());
    // Values of all are where the search begins, as they are where `--free` names all.
    let from_values = fit(&[&program[..], &GIVEN, &["--intervals=linear"]].concat());
    for fit in [&by_displacement, &by_program, &from_values] {
        assert_eq!(fit["verdict"], "converged", "{fit}");
        is_near(fit, &hold(), 5.0);
        assert!(fit["fixed"]["slip_length"].is_null(), "{fit}");
    }
    // A value without `--free` is fixed, of a hold as of a step.
    let fixed = fit(&[
        &program[..],
        &["--stiffness=0.005/um", "--intervals=linear"],
    ]
    .concat());
    let stiffness = fixed["fixed"]["stiffness"].as_f64().expect("a number");
    assert!((stiffness / 5e3 - 1.0).abs() < 1e-12, "{fixed}");
    assert_eq!(parameters(&fixed).len(), 4, "{fixed}");
    assert_eq!(fixed["verdict"], "converged", "{fixed}");
}

#[test]
fn one_sample_before_a_step_is_enough() {
    let text = fs::read_to_string(format!(
        "{ROOT}/tests/data/cases/step-without-displacement.txt"
    ));
    let words = [
        "--time=1",
        "--friction=2",
        "--driving=1e-6",
        "--program=0:1e-5",
    ];
    let found = result("tim.txt", &text.expect("a record"), &words);
    let fit = &found["fit"];
    assert_eq!(fit["verdict"], "converged", "{fit}");
    // As the head of the file says: a, b, Dc in µm, and k per µm.
    for (name, truth) in [
        ("direct_effect", 0.005),
        ("evolution_effect", 0.010),
        ("slip_length", 1e-5),
        ("stiffness", 1e3),
    ] {
        let value = parameter(fit, name)["value"].as_f64().expect("a number");
        assert!((value / truth - 1.0).abs() < 1e-3, "{name}: {value}");
    }
}

#[test]
fn given_values_are_starts_where_the_record_shows_nothing_to_begin_with() {
    // A load point that is accelerated all the time.
    let slid = Slid {
        program: (0..200)
            .map(|i| (0.5 * f64::from(i), 1e-6 * 1.03_f64.powi(i)))
            .collect(),
        until: 100.0,
        noise: 5e-5,
        ..one_step()
    };
    let text = slid.record(2000, 6);
    let path = folder("fit_ramp").join("ramp.csv");
    fs::write(&path, &text).expect("a file");
    let changes = slid.program[1..].iter().map(|(t, v)| format!("{t}:{v}"));
    let program = format!("--program={}", changes.collect::<Vec<_>>().join(","));
    let file = path.to_str().expect("a name");
    let ended = run(&[
        "fit",
        file,
        &program,
        "--driving=1e-6",
        "--slip-length=2e-5",
    ]);
    assert_eq!(ended.code, 2, "{}", ended.err);
    let says = "give values of direct_effect, evolution_effect, stiffness, reference_friction";
    assert!(ended.err.contains(says), "{}", ended.err);
    let names = "--free=direct_effect,evolution_effect,slip_length,stiffness,reference_friction";
    for free in [&[names][..], &[]] {
        let words = [&[program.as_str(), "--driving=1e-6"], &GIVEN[..], free].concat();
        let found = result("ramp.csv", &text, &words);
        assert_eq!(parameters(&found["fit"]).len(), 5, "{}", found["fit"]);
    }
}
