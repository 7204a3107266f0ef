//! What a run computes: slips, events, error estimates, the symmetric subspace, failures that keep their rows.

use crate::command;
use crate::common;
use command::{csv, folder, number, object, twinslip};
use serde_json::Value;
use std::process::{Command, Stdio};
use std::time::Duration;

const CYCLES: &str = "integrate --driving 10 --stiffness 0.14 --until 20";

fn rows(object: &Value) -> &Vec<Value> {
    object["result"]["rows"].as_array().expect("rows")
}

fn column(object: &Value, name: &str) -> Vec<f64> {
    let value = |row: &Value| row[name].as_f64().unwrap_or_else(|| panic!("{name}"));
    rows(object).iter().map(value).collect()
}

#[test]
fn slips_satisfy_the_balance_of_the_spring() {
    // K (V_H t - sum of slips) = tau - tau(0), which the quadrature of the slip rates knows nothing of.
    let cases = [
        (CYCLES.to_owned(), 10.0, 0.14),
        (format!("{CYCLES} --start near-symmetric:0 --rtol 1e-10"), 10.0, 0.14),
        (format!("{CYCLES} --interfaces 1 --points 77"), 10.0, 0.14),
        (
            "integrate --driving 0.2 --stiffness 0.05 --start 11.4,0.3,0.05 --until 3000 --rtol 1e-10".into(),
            0.2,
            0.05,
        ),
        (
            "integrate --driving 1000 --stiffness 0.14 --start 10,0.5,0.001 --until 100".into(),
            1000.0,
            0.14,
        ),
    ];
    for (arguments, v_h, k) in cases {
        let made = object(&arguments);
        let two = made["model"]["interfaces"] == 2;
        let [time, stress, first] = ["time", "stress", "slip_1"].map(|name| column(&made, name));
        let second = if two {
            column(&made, "slip_2")
        } else {
            vec![0.0; first.len()]
        };
        let rtol = made["numerics"]["rtol"].as_f64().unwrap();
        for i in 0..time.len() {
            let pull = k * (v_h * time[i] - first[i] - second[i]);
            let defect = (pull - (stress[i] - stress[0])).abs();
            let bound = 1e3 * rtol * stress[0].max(k * v_h * time[i]);
            assert!(defect < bound, "{arguments}: {defect:e} at t = {}", time[i]);
        }
    }
}

#[test]
fn a_symmetric_start_stays_symmetric_to_the_last_bit() {
    for start in ["near-symmetric:0", "11.37729,0.091,0.091"] {
        let arguments =
            format!("integrate --driving 0.2 --stiffness 0.05 --until 3000 --start {start}");
        let made = object(&arguments);
        assert_eq!(made["numerics"]["dimension"], 2);
        for name in ["state", "log_state", "slip_rate", "slip"] {
            let [first, second] = [1, 2].map(|i| column(&made, &format!("{name}_{i}")));
            assert_eq!(first, second, "{name}");
        }
        let told = twinslip(&format!("{arguments} --explain"));
        assert!(
            told.err.contains("dimension         2: psi1 = psi2"),
            "{}",
            told.err
        );
    }
    let told = twinslip(&format!("{CYCLES} --explain"));
    assert!(told.err.contains("dimension         3"), "{}", told.err);
    let told = twinslip(&format!(
        "{CYCLES} --explain --final-only --columns time,stress"
    ));
    assert!(
        told.err.contains("no output needs the steps"),
        "{}",
        told.err
    );
    assert!(told.err.contains("dense output      off"), "{}", told.err);
}

#[test]
fn the_end_does_not_depend_on_what_is_asked() {
    let all = object(CYCLES);
    let last = rows(&all).last().expect("a row");
    let only = object(&format!("{CYCLES} --final-only"));
    assert_eq!(rows(&only).len(), 1);
    assert_eq!(&rows(&only)[0], last);
    for name in ["stress", "state_1", "slip_1", "slip_2"] {
        let path = format!("/result/final/{name}");
        assert_eq!(number(&only, &path), number(&all, &path));
        let points = object(&format!("{CYCLES} --points 9 --events"));
        assert_eq!(number(&points, &path), number(&all, &path));
    }
    let few = object(&format!("{CYCLES} --final-only --columns stress,time"));
    assert_eq!(
        few["result"]["final"],
        serde_json::json!({"stress": last["stress"], "time": 20.0, "error_estimate": null})
    );
}

/// Where only the end is shown most steps pass unseen, but none is missing from what is kept of a run that fails.
#[test]
fn a_run_that_fails_keeps_where_it_has_come_to() {
    for method in ["taylor", "auto", "rodas5p"] {
        let failing = |rows: &str| {
            let told = twinslip(&format!(
                "{CYCLES} --method {method} --max-steps 150 --format json {rows}"
            ));
            assert_eq!(told.code, 1, "{}", told.err);
            serde_json::from_str::<Value>(&told.out).expect("JSON")
        };
        let (all, only) = (failing(""), failing("--final-only"));
        assert_eq!(only["result"]["final"], all["result"]["final"], "{method}");
        assert!(number(&only, "/result/final/slip_1") > 0.0);
    }
}

#[test]
fn rows_come_at_the_times_asked_for() {
    let points = column(&object(&format!("{CYCLES} --points 5")), "time");
    assert_eq!(points, [0.0, 5.0, 10.0, 15.0, 20.0]);
    let every = column(&object(&format!("{CYCLES} --every 6")), "time");
    assert_eq!(every, [0.0, 6.0, 12.0, 18.0]);
    let tenths = column(&object(&format!("{CYCLES} --every 0.1")), "time");
    assert_eq!((tenths.len(), tenths[200]), (201, 20.0));
}

/// True error and estimate of a run of `trajectories.json`, relative, largest of stress and states.
fn error_and_estimate(scene: &str, end: &str, law: &str, rtol: f64) -> (f64, f64) {
    let data = common::data("trajectories.json");
    let case = &data["scenes"][scene];
    let start: Vec<&str> = case["y0(tau,psi1,psi2)"]
        .as_array()
        .unwrap()
        .iter()
        .map(|x| x.as_str().unwrap())
        .collect();
    let made = object(&format!(
        "integrate --law {law} --driving {} --stiffness {} --start {} --until {end} --rtol {rtol} --final-only --estimate-error",
        case["V_H"].as_str().unwrap(),
        case["K"].as_str().unwrap(),
        start.join(",")
    ));
    // the start is rounded to doubles: their own end, where it is known
    let ends = &case["ends"][end];
    let truth = ends.get("y_end_f64inputs").unwrap_or(&ends["y_end"]);
    let error = ["stress", "state_1", "state_2"]
        .iter()
        .zip(truth.as_array().unwrap())
        .map(|(name, y)| {
            (number(&made, &format!("/result/final/{name}")) / common::number(y) - 1.0).abs()
        })
        .fold(0.0, f64::max);
    (error, number(&made, "/result/final/error_estimate"))
}

#[test]
fn error_estimates_are_within_a_factor_ten() {
    for (scene, end, law, rtol) in [
        ("A1_K0.14_VH0.12", "1000", "spinodal", 1e-6),
        ("A1_K0.14_VH0.12", "2000", "spinodal", 1e-8),
        ("A3_K0.14_VH100", "4", "spinodal", 1e-7),
        ("A5_K0.14_VH1000_far", "1", "spinodal", 1e-5),
        ("B2_K0.05_VH0.2_exact_sym", "2000", "spinodal", 1e-7),
        ("D_K0.2_VH0.102_torus", "2000", "spinodal", 1e-7),
        ("E1_DR_K0.45", "50", "dieterich-ruina", 1e-6),
        ("E6_DR_K0.35", "100", "dieterich-ruina", 1e-6),
    ] {
        let (error, estimate) = error_and_estimate(scene, end, law, rtol);
        assert!(
            estimate < 10.0 * error && estimate > error,
            "{scene} at {end}: {error:e} estimated as {estimate:e}"
        );
    }
}

/// Where no tighter run can be had the estimate is a bound, and not zero.
#[test]
fn error_estimates_hold_where_doubles_end() {
    for (scene, end, law, rtol) in [
        ("A3_K0.14_VH100", "4", "spinodal", 1e-13),
        ("A3_K0.14_VH100", "4", "spinodal", 1e-14),
        ("D_K0.2_VH0.102_torus", "2000", "spinodal", 1e-13),
        ("E1_DR_K0.45", "50", "dieterich-ruina", 1e-13),
    ] {
        let (error, estimate) = error_and_estimate(scene, end, law, rtol);
        // What rounding ln psi at the start to a double does is in both.
        assert!(
            estimate < 100.0 * error && estimate > error,
            "{scene} at {end}: {error:e} estimated as {estimate:e}"
        );
    }
}

#[test]
fn no_event_is_missed() {
    // Against the rows of a fine sampling, with loose tolerances, which make long steps.
    for (arguments, v_h) in [
        (
            "integrate --driving 10 --stiffness 0.14 --until 40 --method rodas5p --rtol 1e-4",
            10.0,
        ),
        (
            "integrate --driving 10 --stiffness 0.14 --until 40 --rtol 1e-7",
            10.0,
        ),
        (
            "integrate --driving 0.2 --stiffness 0.05 --until 3500 --start 11.4,0.3,0.05 --method rodas5p --rtol 1e-4",
            0.2,
        ),
        (
            "integrate --driving 0.102 --stiffness 0.2 --until 4000 --start 11.5,0.3,0.05 --method rodas5p --rtol 1e-5",
            0.102,
        ),
        (
            "integrate --driving 0.2 --stiffness 0.05 --until 3500 --start 11.4,0.3,0.05 --rtol 1e-7",
            0.2,
        ),
        (
            "integrate --driving 0.102 --stiffness 0.2 --until 4000 --start 11.5,0.3,0.05 --rtol 1e-7",
            0.102,
        ),
    ] {
        let events = object(&format!("{arguments} --events --final-only"));
        let events = events["result"]["events"].as_array().unwrap();
        let fine = object(&format!(
            "{arguments} --points 160001 --columns time,stress,slip_rate_1,slip_rate_2"
        ));
        let [time, stress, first, second] =
            ["time", "stress", "slip_rate_1", "slip_rate_2"].map(|name| column(&fine, name));
        let mut seen = Vec::new();
        let (mut open, mut peak): (Option<usize>, f64) = (None, 0.0);
        for i in 1..time.len() {
            let total = first[i] + second[i];
            let before = first[i - 1] + second[i - 1];
            if before <= v_h && total > v_h {
                (open, peak) = (Some(i), 0.0);
            }
            peak = peak.max(total);
            if before > v_h
                && total <= v_h
                && let Some(from) = open.take()
                && peak > 2.0 * v_h
            {
                seen.push((time[from], time[i], stress[from] - stress[i]));
            }
        }
        assert!(seen.len() > 3, "{arguments}");
        assert_eq!(events.len(), seen.len(), "{arguments}");
        let spacing = time[1] - time[0];
        for (event, (onset, end, drop)) in events.iter().zip(seen) {
            let field = |name: &str| event[name].as_f64().unwrap();
            assert!((field("onset") - onset).abs() <= spacing);
            assert!((field("onset") + field("duration") - end).abs() <= spacing);
            assert!((field("stress_drop") - drop).abs() < 1e-2 * drop);
            assert!(field("peak_slip_rate") > 2.0 * v_h);
            let leader = if field("slip_1") > field("slip_2") {
                1
            } else {
                2
            };
            assert_eq!(event["leader"], leader);
        }
    }
}

#[test]
fn equal_interfaces_and_single_ones_have_no_leader() {
    for start in [
        "--start 11.37729,0.1,0.1",
        "--interfaces 1 --start 11.37729,0.1",
    ] {
        let made = object(&format!(
            "integrate --driving 0.2 --stiffness 0.05 --until 2000 --events --final-only {start}"
        ));
        let events = made["result"]["events"].as_array().unwrap();
        assert!(events.len() > 1, "{start}");
        assert!(events.iter().all(|event| event["leader"].is_null()));
        let single = made["model"]["interfaces"] == 1;
        assert!(
            events
                .iter()
                .all(|event| event["slip_2"].is_null() == single)
        );
    }
}

#[test]
fn events_have_a_table_of_their_own() {
    let place = folder("events");
    let ended = twinslip(&format!(
        "{CYCLES} --events -q -o {}",
        place.join("run.csv").display()
    ));
    assert_eq!(ended.code, 0, "{}", ended.err);
    let text = std::fs::read_to_string(place.join("run.events.csv")).expect("events");
    let table = csv(&text);
    assert_eq!(table[0][..2], ["onset", "recurrence"]);
    assert_eq!(table.len(), 6);
    assert_eq!(table[1][1], "");
    // Below the rows of one table, on a terminal or asked for, but not below those of one CSV.
    let told = twinslip(&format!("{CYCLES} --events -q --format table"));
    let (_, second) = told.out.split_once("\n\n").expect("two tables");
    assert_eq!(second.lines().count(), 2 + table.len() - 1);
    let piped = twinslip(&format!("{CYCLES} --events -q"));
    assert_eq!((piped.code, piped.out.as_str()), (2, ""), "{}", piped.err);
    assert!(piped.err.contains("--events FILE"), "{}", piped.err);
    let named = place.join("named.csv");
    let piped = twinslip(&format!("{CYCLES} --events {} -q", named.display()));
    assert_eq!(piped.code, 0, "{}", piped.err);
    let rows = csv(&piped.out);
    assert!(rows.iter().all(|row| row.len() == rows[0].len()));
    let events = std::fs::read_to_string(&named).expect("events");
    assert_eq!(csv(&events), table);
    let object = twinslip(&format!(
        "{CYCLES} --events {} --format json",
        named.display()
    ));
    assert_eq!(object.code, 2, "{}", object.err);
}

const BLOW_UP: &str = "integrate --law dieterich-ruina --driving 1 --stiffness 0.35 --start 10.85,1.99,2.01 --until 300";

#[test]
fn a_blow_up_keeps_its_rows_and_says_when() {
    let ended = twinslip(&format!("{BLOW_UP} --format json -q"));
    assert_eq!(ended.code, 1);
    assert!(
        ended
            .err
            .contains("blows up in finite time: it grows without bound at t = 226.64"),
        "{}",
        ended.err
    );
    let made: Value = serde_json::from_str(&ended.out).expect("JSON");
    assert!(
        made["error"]
            .as_str()
            .is_some_and(|text| text.contains("blows up"))
    );
    let last = rows(&made).last().expect("rows are kept");
    assert!((last["time"].as_f64().unwrap() - 226.641267).abs() < 1e-3);
    assert_eq!(made["result"]["final"]["time"], last["time"]);
    assert!(made["result"]["final"]["error_estimate"].is_null());

    let place = folder("blow-up");
    let path = place.join("run.csv");
    let ended = twinslip(&format!("{BLOW_UP} -o {}", path.display()));
    assert_eq!(ended.code, 1);
    let kept = csv(&std::fs::read_to_string(&path).expect("kept"));
    assert_eq!(kept.len() - 1, rows(&made).len());

    let only = twinslip(&format!(
        "{BLOW_UP} --final-only --columns stress --format json"
    ));
    assert_eq!(only.code, 1);
    let made: Value = serde_json::from_str(&only.out).expect("JSON");
    assert!(made["result"]["final"].is_null() && rows(&made).is_empty());
}

/// The time in a message `... t = T ± U ...`.
fn told_time(message: &str) -> (f64, f64) {
    let (_, rest) = message.split_once("t = ").expect(message);
    let mut words = rest.split_whitespace();
    let mut number = || {
        let word = words.next().expect(message).trim_end_matches([':', ',']);
        word.parse::<f64>().ok()
    };
    let t = number().expect(message);
    assert_eq!(number(), None, "{message}");
    (t, number().expect(message))
}

#[test]
fn the_time_of_a_blow_up_has_an_uncertainty_that_holds() {
    const T: f64 = 226.641267031787;
    for (method, rtol) in [
        ("auto", 1e-6),
        ("auto", 1e-8),
        ("auto", 1e-12),
        ("taylor", 1e-10),
        ("rodas5p", 1e-8),
        ("rodas4", 1e-8),
    ] {
        let ended = twinslip(&format!(
            "{BLOW_UP} --method {method} --rtol {rtol} --final-only"
        ));
        assert_eq!(ended.code, 1, "{}", ended.err);
        let (t, uncertainty) = told_time(&ended.err);
        let error = (t - T).abs();
        assert!(error <= uncertainty, "{method} {rtol}: {}", ended.err);
        assert!(
            uncertainty < 30.0 * error.max(1e-12 * T),
            "{method} {rtol}: {}",
            ended.err
        );
    }
}

#[test]
fn what_leaves_the_doubles_is_no_blow_up_where_solutions_exist() {
    // ln v peaks at 1148.9 there, and falls.
    const PEAK: f64 = 3.477158366720671;
    let burst = "integrate --law bounded --driving 10.3189 --stiffness 0.0141452 --until 421.06 --rtol 2.13e-10 \
                 --start 11.35606192,0.03828542661,0.03785970339";
    let mut methods = vec!["auto", "taylor", "rodas5p", "rodas4"];
    if cfg!(feature = "sundials") {
        methods.push("cvode-bdf");
    }
    for method in methods {
        let ended = twinslip(&format!("{burst} --method {method}"));
        assert_eq!(ended.code, 1, "{}", ended.err);
        assert!(!ended.err.contains("blows up"), "{}", ended.err);
        assert!(!ended.err.contains("no solution"), "{}", ended.err);
        assert!(
            ended
                .err
                .contains("solutions of the law bounded exist for all time"),
            "{}",
            ended.err
        );
        let (t, uncertainty) = told_time(&ended.err);
        assert!((t - PEAK).abs() <= uncertainty, "{method}: {}", ended.err);
        assert!(csv(&ended.out).len() > 50, "the rows are kept");
    }
    for scene in [
        "integrate --law bounded --driving 10 --stiffness 0.3 --until 100",
        "integrate --law regularised-ageing --driving 10 --stiffness 0.03 --until 100",
    ] {
        let ended = twinslip(scene);
        assert_eq!(ended.code, 1, "{}", ended.err);
        assert!(ended.err.contains("exist for all time"), "{}", ended.err);
        // From 1e-3 to 1e-14 it ends there.
        assert!(!ended.err.contains("larger tolerance"), "{}", ended.err);
    }
}

#[test]
fn messages_tell_times_in_the_units_of_the_user() {
    // L/V* is 0.9 s, and a sigma 34900 Pa.
    let ended = twinslip(
        "integrate --si --law dieterich-ruina --driving 1e-6 --stiffness 1.3572222222222222e10 \
         --start 378665,1.791,1.809 --until 300 --final-only",
    );
    let plain = twinslip(&format!("{BLOW_UP} --final-only"));
    assert_eq!((ended.code, plain.code), (1, 1), "{}", ended.err);
    let ((t, uncertainty), (dimensionless, _)) = (told_time(&ended.err), told_time(&plain.err));
    assert!((t - 0.9 * dimensionless).abs() < 1e-6, "{}", ended.err);
    assert!(
        ended.err.contains(&format!("± {uncertainty:.1e} s")),
        "{}",
        ended.err
    );
    let ended = twinslip(
        "integrate --si --driving 1e-5 --stiffness 5.43e9 --until 10 --max-steps 5 --final-only",
    );
    assert!(
        ended.err.contains("before t = 10 s; raise --max-steps"),
        "{}",
        ended.err
    );
    let ended = twinslip(
        "section --si --driving 1e-5 --stiffness 5.43e9 --surface stress=7e5 --patience 9 --format csv",
    );
    assert!(
        ended.err.contains("from t = 0 s to t = ") && ended.err.contains("lies at 700000 Pa"),
        "{}",
        ended.err
    );
}

/// The default start moves psi_2 to the side on which the law has states, in a run and in a sweep; what the user names is refused
/// in the user's words.
#[test]
fn the_default_start_is_one_that_the_law_has() {
    let made = object("integrate --driving 1e-4 --stiffness 0.14 --until 10 --final-only");
    assert!(number(&made, "/result/final/state_2") < 1.0);
    let first = object("integrate --driving 1e-4 --stiffness 0.14 --until 10 --points 2");
    let start = &rows(&first)[0];
    let apart = start["log_state_2"].as_f64().unwrap() - start["log_state_1"].as_f64().unwrap();
    assert!((apart + 0.01).abs() < 1e-15, "{apart}");
    let refused =
        twinslip("integrate --driving 1e-4 --stiffness 0.14 --until 10 --start near-symmetric:0.5");
    assert_eq!(refused.code, 2);
    assert!(
        refused.err.contains("EPS must be at most"),
        "{}",
        refused.err
    );
}

/// K = 1e100 relaxes the stress within 1e-100: damping, which `auto` must see however large it is.
#[test]
fn the_stiffest_springs_take_few_steps() {
    for stiffness in ["1e20", "1e100", "1e200", "1e300"] {
        let made = object(&format!(
            "integrate --driving 10 --stiffness {stiffness} --until 10"
        ));
        assert!(
            rows(&made).len() < 3000,
            "{stiffness}: {}",
            rows(&made).len()
        );
        let total =
            number(&made, "/result/final/slip_rate_1") + number(&made, "/result/final/slip_rate_2");
        assert!((total - 10.0).abs() < 1e-6, "{stiffness}: {total}");
    }
}

#[test]
fn too_many_steps_is_a_failure_that_keeps_rows() {
    let ended = twinslip(&format!("{CYCLES} --max-steps 100"));
    assert_eq!(ended.code, 1);
    assert!(ended.err.contains("raise --max-steps"), "{}", ended.err);
    assert!(csv(&ended.out).len() > 50);
}

#[cfg(unix)]
#[test]
fn an_interrupt_keeps_finished_rows() {
    for format in ["csv", "json"] {
        let place = folder(&format!("interrupt-{format}"));
        let path = place.join(format!("run.{format}"));
        let endless = format!(
            "integrate --driving 10 --stiffness 0.14 --until 1e9 --max-steps 1000000000000 --every 100 --columns time,stress -o {}",
            path.display()
        );
        let child = crate::command::program()
            .args(endless.split(' '))
            .stderr(Stdio::piped())
            .spawn()
            .expect("the program starts");
        // Long enough for the handler to be there; a run of 1e9 does not end by itself.
        std::thread::sleep(Duration::from_millis(1500));
        let killed = Command::new("kill")
            .args(["-INT", &child.id().to_string()])
            .status()
            .expect("kill");
        assert!(killed.success());
        let ended = child.wait_with_output().expect("it ends");
        assert_eq!(ended.status.code(), Some(130));
        let text = std::fs::read_to_string(&path).expect("kept");
        let count = if format == "json" {
            rows(&serde_json::from_str(&text).expect("whole")).len()
        } else {
            assert!(text.ends_with('\n'));
            csv(&text).len() - 1
        };
        assert!(count > 1, "{count}");
    }
}
