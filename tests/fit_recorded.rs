//! Load points that move as they were recorded: what friction follows of it, and what is noise of the transducer.

use super::command::{folder, object};
use super::common::laboratory::Slid;
use serde_json::Value;
use std::fs;

fn parameter<'a>(result: &'a Value, name: &str) -> &'a Value {
    let all = result["fit"]["parameters"].as_array().expect("a list");
    all.iter().find(|one| one["name"] == name).expect("it")
}

fn rms(result: &Value) -> f64 {
    result["fit"]["residual_rms"].as_f64().expect("a number")
}

fn column(result: &Value, name: &str) -> Vec<f64> {
    let rows = result["rows"].as_array().expect("rows");
    rows.iter()
        .map(|row| row[name].as_f64().expect("a number"))
        .collect()
}

/// The root of the mean square of what a column changes by from sample to sample.
fn jitter(result: &Value, name: &str) -> f64 {
    let all = column(result, name);
    let squares = all.windows(2).map(|pair| (pair[1] - pair[0]).powi(2));
    (squares.sum::<f64>() / (all.len() - 1) as f64).sqrt()
}

#[test]
fn noise_of_the_transducer_is_no_motion() {
    let words = "fit tests/data/laboratory/basalt.txt --law slip --to 11690";
    let steps = object(words)["result"].clone();
    let recorded = object(&format!("{words} --load-point recorded"))["result"].clone();
    // What a root of a mean square is known to.
    let samples = steps["fit"]["effective_samples"]
        .as_f64()
        .expect("a number");
    let noise = rms(&steps) / (2.0 * samples).sqrt();
    let more = rms(&recorded) - rms(&steps);
    assert!(more < noise, "{more:e} of {noise:e}");
    for own in steps["fit"]["parameters"].as_array().expect("a list") {
        let end = |one: &Value, i: usize| one["interval_95"][i].as_f64().expect("a number");
        let other = parameter(&recorded, own["name"].as_str().expect("a name"));
        assert!(
            end(own, 0) < end(other, 1) && end(other, 0) < end(own, 1),
            "{own} {other}"
        );
    }
    // No spikes: the fit changes as that of the steps does, far less from sample to sample than what was measured.
    assert!(jitter(&recorded, "fitted") < 1.5 * jitter(&steps, "fitted"));
    assert!(jitter(&recorded, "fitted") < 0.3 * jitter(&recorded, "observed"));
}

#[test]
fn a_motor_that_takes_seconds_is_followed_through_the_noise() {
    let (slow, fast) = (1e-6, 1e-5);
    let mut program = vec![(0.0, slow)];
    program.extend((0..200).map(|i| {
        let since = 0.1 * f64::from(i) + 0.05;
        (
            60.0 + 0.1 * f64::from(i),
            fast - (fast - slow) * (-since / 2.0).exp(),
        )
    }));
    let slid = Slid {
        stiffness: 5e3,
        direct_effect: 0.010,
        evolution_effect: 0.013,
        slip_length: 1.2e-5,
        noise: 1e-4,
        scatter: 1e-7,
        program,
        until: 110.0,
    };
    let path = folder("fit_motor").join("motor.csv");
    fs::write(&path, slid.record(4000, 11)).expect("a file");
    let words = format!("fit {} --intervals linear", path.display());
    let steps = object(&words)["result"].clone();
    let recorded = object(&format!("{words} --load-point recorded"))["result"].clone();
    assert!(
        rms(&recorded) < rms(&steps),
        "{} {}",
        rms(&recorded),
        rms(&steps)
    );
    // What the steps of such a motor give is wrong by far more than the error that they tell.
    let length = parameter(&steps, "slip_length")["value"]
        .as_f64()
        .expect("a number");
    assert!((length / slid.slip_length - 1.0).abs() > 0.1, "{length}");
    for (name, truth) in [
        ("direct_effect", slid.direct_effect),
        ("evolution_effect", slid.evolution_effect),
        ("slip_length", slid.slip_length),
    ] {
        let value = parameter(&recorded, name)["value"]
            .as_f64()
            .expect("a number");
        assert!((value / truth - 1.0).abs() < 0.03, "{name}: {value}");
    }
    let notes = recorded["notes"][0].as_str().expect("a note");
    assert!(notes.contains("smoothed over"), "{notes}");
}
