//! `fit --look`: what a record holds; long records; questions on sizes and trends.

use super::command::{folder, number, object, refused, twinslip};
use serde_json::Value;
use std::fmt::Write;
use std::fs;
use std::time::{Duration, Instant};

const HOLD: &str = "tests/data/cases/slide-hold-slide.txt";

#[test]
fn a_hold_is_seen_with_its_friction() {
    let picture = folder("fit_look").join("look.svg");
    let made = object(&format!("fit {HOLD} --look --plot {}", picture.display()));
    let look = &made["result"]["look"];
    let columns = look["columns"].as_array().expect("a list");
    let told = |one: &Value| format!("{} {} {}", one["name"], one["unit"], one["role"]);
    assert_eq!(
        columns.iter().map(told).collect::<Vec<_>>(),
        [
            "\"Time\" \"s\" \"time\"",
            "\"Displ\" \"microns\" \"displacement\"",
            "\"Friction\" null \"friction\""
        ]
    );
    assert_eq!(look["samples"], 2000);
    assert!((number(look, "/sampling/rate") - 10.0).abs() < 1e-6);
    assert!(
        (number(look, "/displacement") / 9.99e-4 - 1.0).abs() < 1e-3,
        "{look}"
    );
    // Slid at 10 um/s to 40 s, held to 140 s; the noise has a standard deviation of 1e-4.
    assert!((number(look, "/friction/noise/value") / 1e-4 - 1.0).abs() < 0.1);
    assert_eq!(look["steps"].as_array().map(Vec::len), Some(0));
    let holds = look["holds"].as_array().expect("a list");
    let [hold] = &holds[..] else { panic!("{look}") };
    let near = |path: &str, x: f64, by: f64| {
        let own = number(hold, path);
        assert!((own - x).abs() < by, "{path}: {own}");
    };
    near("/start", 40.0, 0.01);
    near("/duration", 100.0, 0.01);
    near("/velocity_before/value", 1e-5, 1e-9);
    near("/velocity_after/value", 1e-5, 1e-9);
    near("/friction_before/value", 0.62, 5e-5);
    near("/minimum/value", 0.5910, 3e-4);
    near("/peak/value", 0.6731, 3e-4);
    let rows = made["result"]["rows"].as_array().expect("rows");
    assert_eq!(
        rows.iter()
            .map(|row| row["kind"].as_str().expect("a word"))
            .collect::<Vec<_>>(),
        ["slide", "hold", "slide"]
    );
    let drawn = fs::read_to_string(picture).expect("a picture");
    assert!(drawn.contains("hold") && !drawn.contains("NaN"));
}

/// Velocities that rise and fall in turn: two lines through all of them have one slope. Between samples, and with sampling that is exact.
#[test]
fn steps_up_and_down_are_all_seen() {
    let folder = folder("fit_look_steps");
    let program = [
        (0.0, 1e-6),
        (200.0, 1e-5),
        (350.0, 1e-6),
        (550.03, 3e-6),
        (700.0, 1e-5),
        (850.0, 1e-6),
    ];
    let mut text = "time_s,displacement_um,friction\n".to_owned();
    for i in 0..10_000 {
        let t = 0.1 * f64::from(i);
        let parts = program.windows(2).map(|pair| (pair[0], pair[1].0));
        let parts = parts.chain([(program[5], f64::INFINITY)]);
        let moved: f64 = parts
            .map(|((from, v), to)| v * (t.min(to) - from).max(0.0))
            .sum();
        writeln!(text, "{t:.1},{:.5},0.6", moved * 1e6).expect("memory");
    }
    let path = folder.join("steps.csv");
    fs::write(&path, text).expect("a file");
    let made = object(&format!("fit {} --look", path.display()));
    let steps = made["result"]["look"]["steps"].as_array().expect("a list");
    assert_eq!(steps.len(), 5, "{steps:?}");
    for (step, pair) in steps.iter().zip(program.windows(2)) {
        assert!((number(step, "/time") - pair[1].0).abs() < 0.01, "{step}");
        assert!(
            (number(step, "/velocity_after/value") / pair[1].1 - 1.0).abs() < 1e-3,
            "{step}"
        );
    }
}

#[test]
fn a_gap_is_told_and_not_refused_by_a_look() {
    let folder = folder("fit_look_gap");
    let text = fs::read_to_string(super::common::ROOT.to_owned() + "/" + HOLD).expect("the record");
    let lines: Vec<&str> = text.lines().collect();
    let path = folder.join("gap.txt");
    fs::write(&path, [&lines[..100], &lines[250..]].concat().join("\n")).expect("a file");
    let made = object(&format!("fit {} --look", path.display()));
    let gaps = made["result"]["look"]["gaps"].as_array().expect("a list");
    assert_eq!(gaps.len(), 1);
    assert!(
        (number(&gaps[0], "/from") - 9.8).abs() < 1e-9
            && (number(&gaps[0], "/to") - 24.9).abs() < 1e-9
    );
    refused(
        &format!("fit {}", path.display()),
        "a gap from 9.8 to 24.9 s",
    );
    // What a fit would use is not accepted and ignored.
    refused(
        &format!("fit {HOLD} --look --law slip"),
        "'--look' cannot be used with '--law <NAME[,NAME...]>'",
    );
}

/// Three hundred thousand rows of eight columns; a build for changes takes a second.
#[test]
fn a_long_record_is_looked_at_in_seconds() {
    let mut text = "time_s,displacement_um,friction,a,b,c,d,e\n".to_owned();
    for i in 0..300_000 {
        let t = 0.01 * f64::from(i);
        let moved = t.min(1500.0) + 10.0 * (t - 1500.0).max(0.0);
        let noise = 1e-3 * (12.9898 * f64::from(i)).sin();
        writeln!(
            text,
            "{t:.2},{:.5},{:.6},1.5,2.5,3.5,4.5,5.5",
            moved + 10.0 * noise,
            0.6 + noise
        )
        .expect("memory");
    }
    let path = folder("fit_look_long").join("long.csv");
    fs::write(&path, text).expect("a file");
    let begun = Instant::now();
    let made = object(&format!("fit {} --look", path.display()));
    assert!(
        begun.elapsed() < Duration::from_secs(20),
        "{:?}",
        begun.elapsed()
    );
    let steps = made["result"]["look"]["steps"].as_array().expect("a list");
    assert_eq!(steps.len(), 1);
    assert!((number(&steps[0], "/time") - 1500.0).abs() < 0.1);
}

#[test]
fn sizes_that_rocks_do_not_have_and_trends_are_questioned() {
    let folder = folder("fit_questions");
    let record = |name: &str, scale: f64, slope: f64| {
        let rows = super::fit_records::samples();
        let rows = rows.map(|(t, x, mu)| format!("{t},{},{}\n", x * scale, mu + slope * x));
        let text: String = std::iter::once("time_s,displacement_mm,friction\n".to_owned())
            .chain(rows)
            .collect();
        let path = folder.join(name);
        fs::write(&path, text).expect("a file");
        path.display().to_string()
    };
    let fit = "--law slip --intervals linear --free direct_effect,evolution_effect,slip_length,reference_friction --format json";
    // Micrometres that were called millimetres.
    let large = record("large.csv", 1e6, 0.0);
    let ended = twinslip(&format!("fit {large} {fit} --stiffness 0.5/mm"));
    assert!(
        ended.err.contains("slip_length is 0.0100 m")
            || ended.err.contains("slip_length is 0.0101 m"),
        "{}",
        ended.err
    );
    let made: Value = serde_json::from_str(&ended.out).expect("JSON");
    let notes = made["result"]["notes"].as_array().expect("a list");
    assert!(
        notes.iter().any(|note| note
            .as_str()
            .is_some_and(|note| note.contains("rocks and gouges"))),
        "{notes:?}"
    );
    let plain = record("plain.csv", 1e3, 0.0);
    let ended = twinslip(&format!("fit {plain} {fit} --stiffness 0.5/um"));
    assert!(
        !ended.err.contains('?') && !ended.err.contains("straight line"),
        "{}",
        ended.err
    );
    let drifting = record("drifting.csv", 1e3, 20.0);
    let ended = twinslip(&format!("fit {drifting} {fit} --stiffness 0.5/um"));
    assert!(ended.err.contains("add drift to --free"), "{}", ended.err);
    let free = fit.replace("reference_friction", "reference_friction,drift");
    let ended = twinslip(&format!("fit {drifting} {free} --stiffness 0.5/um"));
    assert!(!ended.err.contains("add drift"), "{}", ended.err);
}
