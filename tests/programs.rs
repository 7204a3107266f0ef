//! Loading histories: steps, holds and ramps of the driving velocity, against references of 27 digits and what is known in closed form.

use crate::command;
use crate::common;
use command::{number, object};
use common::{assert_close, data};
use serde_json::Value;

/// The methods and the tolerances at which each comes to ten digits.
const METHODS: &[&str] = &[
    "taylor --rtol 1e-13",
    "auto --rtol 1e-13",
    "rodas5p --rtol 1e-13",
    #[cfg(feature = "sundials")]
    "cvode-bdf --rtol 1e-14",
];

fn rows(object: &Value) -> &Vec<Value> {
    object["result"]["rows"].as_array().expect("rows")
}

fn column(object: &Value, name: &str) -> Vec<f64> {
    let value = |row: &Value| row[name].as_f64().unwrap_or_else(|| panic!("{name}"));
    rows(object).iter().map(value).collect()
}

/// The run of a record of the references, as flags: the model, the start, and the program with more of it.
fn flags(record: &Value, more: &[String]) -> String {
    let text = |value: &Value| value.as_str().expect("a number").to_owned();
    let segments = record["segments"].as_array().expect("segments");
    let mut program = Vec::new();
    for pair in segments.windows(2) {
        program.push(format!(
            "{}:{}",
            text(&pair[0]["until"]),
            text(&pair[1]["V_H"])
        ));
    }
    let until = text(&segments[segments.len() - 1]["until"]);
    program.extend_from_slice(more);
    format!(
        "integrate --law {} --interfaces 1 --driving {} --stiffness {} --start {},{} --program {} --until {until}",
        record["law"].as_str().expect("a law"),
        text(&segments[0]["V_H"]),
        text(&record["K"]),
        text(&record["start"]["tau"]),
        text(&record["start"]["psi"]),
        program.join(","),
    )
}

/// The records without damping.
fn records() -> Vec<(String, Value)> {
    let file = data("loading.json");
    let records = file.as_object().expect("records").iter();
    let undamped = records.filter(|(_, record)| record["eta"] == "0");
    undamped
        .map(|(name, record)| (name.clone(), record.clone()))
        .collect()
}

#[test]
fn velocity_steps_and_holds_meet_the_references() {
    let records = records();
    assert!(records.len() >= 2);
    for (name, record) in &records {
        let flags = flags(record, &[]);
        for method in METHODS {
            // All times of the references are multiples of a half.
            let made = object(&format!("{flags} --method {method} --every 0.5"));
            let states = record["states"].as_array().expect("states");
            assert!(states.len() >= 9);
            for state in states {
                let time = common::number(&state["t"]);
                let row = rows(&made).iter().find(|row| row["time"] == time);
                let row = row.unwrap_or_else(|| panic!("{name}: no row at {time}"));
                let what = format!("{name} by {method} at {time}");
                assert_close(
                    number(row, "/stress"),
                    common::number(&state["tau"]),
                    1e-10,
                    &what,
                );
                assert_close(
                    number(row, "/state_1"),
                    common::number(&state["psi"]),
                    1e-10,
                    &what,
                );
            }
        }
    }
}

/// Maxima of the stress are the onsets of events, and what slips fastest in them their peaks.
#[test]
fn peaks_after_a_change_are_those_of_the_references() {
    let mut compared = 0;
    for (name, record) in records() {
        // The last excursion comes back to V_H without end: a step up ends it.
        let segments = record["segments"].as_array().expect("segments");
        let late = common::number(&segments[segments.len() - 1]["until"]) - 10.0;
        let flags = flags(&record, &[format!("{late}:10")]);
        for method in METHODS {
            let made = object(&format!(
                "{flags} --method {method} --events --event-threshold 1 --final-only"
            ));
            let events = made["result"]["events"].as_array().expect("events");
            let extrema = record["extrema"].as_array().expect("extrema");
            let peaks = extrema
                .windows(2)
                .filter(|pair| pair[0]["quantity"] == "tau" && pair[1]["quantity"] == "v")
                .filter(|pair| pair[0]["kind"] == "max" && pair[1]["kind"] == "max");
            for peak in peaks {
                let (onset, fastest) = (
                    common::number(&peak[0]["t"]),
                    common::number(&peak[1]["value"]),
                );
                let near = |event: &&Value| (number(event, "/onset") - onset).abs() < 1e-6;
                let event = events.iter().find(near);
                let event = event.unwrap_or_else(|| panic!("{name} by {method}: none at {onset}"));
                assert_close(number(event, "/onset"), onset, 1e-10, &name);
                assert_close(number(event, "/peak_slip_rate"), fastest, 1e-10, &name);
                compared += 1;
            }
        }
    }
    assert!(compared >= 2 * METHODS.len());
}

/// K (the drive's way - all slips) = tau - tau(0), along steps, holds and ramps.
#[test]
fn slips_balance_the_drive_across_changes() {
    // V_H 10, 0 from 2 on, a ramp up to 4 from 3 to 5, down to 1 at once, a ramp to rest.
    let program = "2:0,3-5:4,5:1,6-8:0";
    let way = |t: f64| {
        let t_in = |from: f64, to: f64| (t.min(to) - from).max(0.0);
        let rising = t_in(3.0, 5.0);
        let falling = t_in(6.0, 8.0);
        10.0 * t_in(0.0, 2.0) + rising * rising + t_in(5.0, 6.0) + falling * (1.0 - falling / 4.0)
    };
    for (model, k) in [
        ("--stiffness 0.14", 0.14),
        ("--stiffness 0.14 --start near-symmetric:0", 0.14),
        ("--stiffness 2 --interfaces 1 --law slip", 2.0),
        ("--stiffness 0.5 --law dieterich-ruina", 0.5),
    ] {
        for method in METHODS {
            let made = object(&format!(
                "integrate --driving 10 {model} --program {program} --until 9 --method {method}"
            ));
            let [time, stress, first] =
                ["time", "stress", "slip_1"].map(|name| column(&made, name));
            let second = if model.contains("interfaces 1") {
                vec![0.0; first.len()]
            } else {
                column(&made, "slip_2")
            };
            assert_eq!(time[time.len() - 1], 9.0);
            for i in 0..time.len() {
                let pull = k * (way(time[i]) - first[i] - second[i]);
                let defect = (pull - (stress[i] - stress[0])).abs();
                let scale = stress[0].abs().max(k * way(9.0));
                assert!(
                    defect < 1e-10 * scale,
                    "{model} by {method}: {defect:e} at {}",
                    time[i]
                );
            }
        }
    }
}

/// A stiff spring holds the slip rate at V_H, and the state of the ageing law comes to its steady value over D_c: after a step from V_1 to
/// V_2 psi = 1/V_2 + (1/V_1 - 1/V_2) exp(-V_2 t), for the slip law ln(psi V_2) = ln(V_2/V_1) exp(-V_2 t).
#[test]
fn a_stiff_spring_shows_the_evolution_over_the_slip_length() {
    let (before, after) = (1.0_f64, 3.0_f64);
    for law in ["dieterich-ruina", "slip"] {
        let made = object(&format!(
            "integrate --law {law} --interfaces 1 --driving {before} --stiffness 1e9 --start near-symmetric:0 --program 1:{after} --until 2 --every 0.125 --rtol 1e-12"
        ));
        let late = rows(&made).iter().filter(|row| number(row, "/time") > 1.0);
        let mut compared = 0;
        for row in late {
            let decay = (-after * (number(row, "/time") - 1.0)).exp();
            let expected = match law {
                "slip" => ((after / before).ln() * decay).exp() / after,
                _ => 1.0 / after + (1.0 / before - 1.0 / after) * decay,
            };
            assert_close(number(row, "/state_1"), expected, 1e-7, law);
            assert_close(number(row, "/slip_rate_1"), after, 1e-7, law);
            compared += 1;
        }
        assert_eq!(compared, 8);
    }
}

/// Along a ramp the driving velocity is linear in time, and many short steps come to the same.
#[test]
fn a_ramp_is_the_limit_of_steps() {
    let scene = "integrate --stiffness 0.5 --driving 2 --start 10,0.4,0.3 --until 3 --final-only";
    let ends = |program: &str| {
        let made = object(&format!("{scene} --rtol 1e-12 --program {program}"));
        ["stress", "log_state_1", "log_state_2", "slip_1"]
            .map(|name| number(&made, &format!("/result/final/{name}")))
    };
    let ramp = ends("1-2:6");
    // Each step has the mean of the ramp over it: the error falls with the square of their length.
    let steps = |many: usize| {
        let of = |i: usize| {
            let at = 1.0 + i as f64 / many as f64;
            format!("{at}:{}", 2.0 + 4.0 * (i as f64 + 0.5) / many as f64)
        };
        let all: Vec<String> = (0..many).map(of).chain(["2:6".into()]).collect();
        ends(&all.join(","))
    };
    let (coarse, fine) = (steps(64), steps(128));
    for (i, ramp) in ramp.into_iter().enumerate() {
        let (far, near) = (coarse[i] - ramp, fine[i] - ramp);
        let extrapolated = near - (far - near) / 3.0;
        assert!(
            extrapolated.abs() < 1e-3 * near.abs() + 1e-11,
            "{i}: {far:e}, {near:e}"
        );
        assert!((far / near - 4.0).abs() < 0.05, "{i}: {far:e}, {near:e}");
    }
    for method in METHODS {
        let made = object(&format!("{scene} --program 1-2:6 --method {method}"));
        assert_close(
            number(&made, "/result/final/stress"),
            ramp[0],
            1e-10,
            method,
        );
        assert_close(
            number(&made, "/result/final/slip_1"),
            ramp[3],
            1e-10,
            method,
        );
    }
    let every =
        object("integrate --stiffness 0.5 --driving 2 --program 1-2:6 --until 3 --every 0.25");
    let driving = column(&every, "driving");
    for (time, driving) in column(&every, "time").into_iter().zip(driving) {
        assert_eq!(driving, 2.0 + 4.0 * (time - 1.0).clamp(0.0, 1.0));
    }
}

#[test]
fn a_velocity_that_does_not_change_is_no_program() {
    let scene = "integrate --stiffness 0.14 --until 12 --events";
    let plain = object(&format!("{scene} --driving 10"));
    for program in ["--program 0:10", "--driving 10 --program 12:10"] {
        let made = object(&format!("{scene} {program}"));
        for (row, other) in rows(&made).iter().zip(rows(&plain)) {
            let mut row = row.clone();
            let driving = row.as_object_mut().expect("a row").remove("driving");
            assert_eq!((driving, &row), (Some(10.0.into()), other), "{program}");
        }
        assert_eq!(made["result"]["events"], plain["result"]["events"]);
    }
    // Where it is begun anew on the way the end is the same but for the errors of the method.
    let halved = object(&format!("{scene} --driving 10 --program 5:10 --rtol 1e-13"));
    let whole = object(&format!("{scene} --driving 10 --rtol 1e-13"));
    for name in ["stress", "state_1", "slip_1"] {
        let path = format!("/result/final/{name}");
        assert_close(number(&halved, &path), number(&whole, &path), 1e-10, name);
    }
}

#[test]
fn rows_stand_at_both_sides_of_a_change() {
    let scene = "integrate --driving 10 --stiffness 0.14 --program 2:0,3:5,4:5 --until 4";
    for sampling in [
        "",
        "--points 9",
        "--points 8",
        "--every 0.5",
        "--every 0.1",
        "--every 0.7",
    ] {
        let made = object(&format!("{scene} {sampling}"));
        let at = |time: f64| -> Vec<f64> {
            let there = rows(&made).iter().filter(|row| row["time"] == time);
            there.map(|row| number(row, "/driving")).collect()
        };
        assert_eq!(at(0.0), [10.0], "{sampling}");
        assert_eq!(at(2.0), [10.0, 0.0], "{sampling}");
        assert_eq!(at(3.0), [0.0, 5.0], "{sampling}");
        assert_eq!(at(4.0), [5.0], "{sampling}");
        let times = column(&made, "time");
        assert!(
            times.windows(2).all(|pair| pair[0] <= pair[1]),
            "{sampling}"
        );
        let sides: Vec<&Value> = rows(&made)
            .iter()
            .filter(|row| row["time"] == 2.0)
            .collect();
        for name in ["stress", "state_1", "slip_rate_1", "slip_1"] {
            assert_eq!(sides[0][name], sides[1][name], "{sampling}");
        }
    }
    let last = object(&format!("{scene} --final-only"));
    assert_eq!(
        (rows(&last).len(), number(&last, "/result/final/driving")),
        (1, 5.0)
    );
    // A change at the end is seen on its far side.
    let end = object("integrate --driving 10 --stiffness 0.14 --program 4:1 --until 4 --points 5");
    assert_eq!(column(&end, "driving"), [10.0, 10.0, 10.0, 10.0, 10.0, 1.0]);
}

/// One event lasts over changes of V_H; where V_H rises above the slip rate it ends, where it falls below one begins.
#[test]
fn events_across_changes() {
    let scene = "integrate --stiffness 0.14 --start 10,0.5,0.001 --driving 10 --until 20";
    let events = |program: &str, method: &str| -> Vec<Value> {
        let made = object(&format!(
            "{scene} --events --final-only --method {method} {program}"
        ));
        made["result"]["events"].as_array().expect("events").clone()
    };
    let plain = events("", METHODS[0]);
    let onset = |event: &Value| number(event, "/onset");
    let end = |event: &Value| onset(event) + number(event, "/duration");
    let second = &plain[1];
    let middle = 0.5 * (onset(second) + end(second));
    for method in METHODS {
        // While it slips at a thousand times V_H, V_H is a little more: still one event, with the same onset.
        let lasting = events(&format!("--program {middle}:11"), method);
        assert_close(onset(&lasting[1]), onset(second), 1e-9, method);
        assert!(onset(&lasting[2]) > end(second), "{method}");
        let stopped = events(&format!("--program {middle}:1e5"), method);
        assert_close(end(&stopped[1]), middle, 1e-15, method);
        assert_eq!(stopped.len(), 2);
    }
    // Sliding steadily to the last digit, then a hold and a load again: the hold is an event from its begin to its end.
    for method in METHODS {
        let made = object(&format!(
            "integrate --law regularised-ageing --interfaces 1 --driving 1 --stiffness 5 --start near-symmetric:0 --program 50:0,150:1 --until 250 --events --final-only --method {method}"
        ));
        let held = &made["result"]["events"][0];
        assert_eq!(number(held, "/onset"), 50.0, "{method}");
        assert_close(number(held, "/duration"), 100.0, 1e-14, method);
        assert_close(number(held, "/peak_slip_rate"), 1.0, 1e-7, method);
        let slipped = number(held, "/slip_1");
        assert_close(number(held, "/stress_drop"), 5.0 * slipped, 1e-8, method);
    }
}

/// The peak of an event while V_H rises, by series and by dense output.
#[test]
fn events_along_ramps_are_the_same_by_two_methods() {
    let scene = "integrate --stiffness 0.14 --start 10,0.5,0.001 --driving 10 --until 12 --program 1-11:2 --events --final-only";
    let events = |method: &str| -> Vec<Value> {
        let made = object(&format!("{scene} --method {method}"));
        made["result"]["events"].as_array().expect("events").clone()
    };
    let (ours, theirs) = (
        events("taylor --rtol 1e-13"),
        events("rodas5p --rtol 1e-12"),
    );
    assert!(ours.len() >= 2 && ours.len() == theirs.len(), "{ours:?}");
    for (a, b) in ours.iter().zip(&theirs) {
        for field in [
            "onset",
            "duration",
            "stress_drop",
            "peak_slip_rate",
            "slip_1",
            "slip_2",
        ] {
            let path = format!("/{field}");
            assert_close(number(a, &path), number(b, &path), 1e-9, field);
        }
    }
}

#[test]
fn the_error_of_a_run_with_changes_is_estimated() {
    let scene =
        "integrate --driving 10 --stiffness 0.14 --program 2:0,3-5:4,7:10 --until 12 --final-only";
    let exact = object(&format!("{scene} --rtol 1e-14 --method taylor"));
    for method in ["auto", "rodas5p", "taylor"] {
        for reference in ["", "--reference"] {
            let made = object(&format!(
                "{scene} --rtol 1e-7 --method {method} --estimate-error {reference}"
            ));
            let estimate = number(&made, "/result/final/error_estimate");
            for name in ["stress", "state_1", "state_2"] {
                let path = format!("/result/final/{name}");
                let off = common::relative(number(&made, &path), number(&exact, &path));
                assert!(
                    off <= estimate,
                    "{method}: {name} is off by {off:e}, {estimate:e}"
                );
            }
            assert!(estimate < 1e-2, "{method}: {estimate:e}");
        }
    }
}

#[test]
fn a_run_may_begin_at_rest() {
    for program in ["--driving 0 --program 5:10", "--program 0:0,5:10"] {
        let made = object(&format!(
            "integrate --stiffness 0.14 --start 10,0.5,0.4 {program} --until 8 --every 1"
        ));
        let stress = column(&made, "stress");
        assert!(
            stress[..6].windows(2).all(|pair| pair[1] < pair[0]),
            "{stress:?}"
        );
        assert!(stress[stress.len() - 1] > stress[5]);
        assert_eq!(column(&made, "driving")[..6], [0.0; 6]);
    }
}
