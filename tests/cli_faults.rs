//! Runs of faults in SI: the summary, the warning on defaults of the law, and progress in pipes.

use crate::command;
use command::{number, object, program, twinslip};
use serde_json::Value;

/// Stick-slip of a fault with radiation damping, softer than critical.
const FAULT: &str = "integrate --law ageing --interfaces 1 --set a=0.01,b=0.015,mu0=0.6 --slip-length 10mm --normal-stress 50MPa \
    --driving 35mm/year --stiffness 5MPa/m --shear-modulus 30GPa --shear-wave-speed 3km/s --time-unit year";

#[test]
fn a_run_of_a_fault_has_a_summary() {
    let made = object(&format!("{FAULT} --until 500year --events"));
    let summary = &made["result"]["summary"];
    let events = made["result"]["events"].as_array().expect("events");
    assert!(events.len() > 2, "{}", events.len());
    // Rate weakening: k_c = (b - a) sigma/D_c.
    let critical = 0.005 * 5e7 / 0.01;
    let off = |x: f64, y: f64| (x / y - 1.0).abs();
    assert!(
        off(number(summary, "/critical_stiffness"), critical) < 1e-3,
        "{summary}"
    );
    assert!(
        off(number(summary, "/stiffness_ratio"), 5e6 / critical) < 1e-3,
        "{summary}"
    );
    assert_eq!(summary["events"], events.len());
    let all = |name: &str| -> Vec<f64> {
        events
            .iter()
            .filter_map(|event| event[name].as_f64())
            .collect()
    };
    for name in ["recurrence", "stress_drop"] {
        // The first event depends on the start.
        let first = usize::from(name == "stress_drop");
        let all = all(name).split_off(first);
        let mean = all.iter().sum::<f64>() / all.len() as f64;
        let bound = |pick: fn(f64, f64) -> f64| all.iter().copied().reduce(pick).expect("some");
        assert!(
            off(number(summary, &format!("/{name}/mean")), mean) < 1e-12,
            "{name}: {summary}"
        );
        assert_eq!(
            number(summary, &format!("/{name}/min")),
            bound(f64::min),
            "{name}"
        );
        assert_eq!(
            number(summary, &format!("/{name}/max")),
            bound(f64::max),
            "{name}"
        );
    }
    let peak = all("peak_slip_rate").into_iter().reduce(f64::max);
    assert_eq!(summary["peak_slip_rate"].as_f64(), peak);
    // The same without the list of events, and as a line.
    let without = object(&format!("{FAULT} --until 500year"));
    assert_eq!(without["result"]["summary"], *summary);
    assert_eq!(without["result"].get("events"), None);
    let said = twinslip(&format!("{FAULT} --until 500year -o -")).err;
    let line = format!("k/k_c = 0.2; {} events: mean recurrence ", events.len());
    assert!(said.contains(&line) && said.contains(" year ("), "{said}");
}

/// Where V_H changes events answer to that: there is no recurrence and no one k_c, and the first event is left out as elsewhere.
#[test]
fn a_loading_program_has_a_summary_of_the_events_that_are_asked_for() {
    let run = format!("{FAULT} --until 500year --program 250year:70mm/year --events");
    let made = object(&run);
    let summary = &made["result"]["summary"];
    let events = made["result"]["events"].as_array().expect("events");
    assert!(events.len() > 2);
    assert_eq!(summary["events"], events.len());
    assert_eq!(summary["recurrence"], Value::Null);
    assert_eq!(summary["critical_stiffness"], Value::Null);
    assert_eq!(summary["first_event_left_out"], true);
    let drops = events
        .iter()
        .skip(1)
        .map(|event| number(event, "/stress_drop"));
    assert_eq!(
        number(summary, "/stress_drop/max"),
        drops.fold(0.0, f64::max)
    );
    let said = twinslip(&format!("{run} -o - --format table")).err;
    assert!(
        said.contains("events: mean stress drop without the first event "),
        "{said}"
    );
}

#[test]
fn only_runs_in_si_have_a_summary() {
    let summary = |arguments: &str| object(arguments)["result"]["summary"].clone();
    let run = "integrate --driving 0.12 --stiffness 0.14 --until 10";
    assert_eq!(summary(run), Value::Null);
    // Interfaces that differ have no one k_c; a rate-strengthening law has no ratio.
    let si = "integrate --si --driving 1e-7 --stiffness 1e9 --until 10";
    let differ = summary(&format!("{si} --set slip_length_2=2e-6"));
    assert_eq!(differ["critical_stiffness"], Value::Null);
    assert_eq!(differ["events"], 0);
    // Where V_H changes nothing recurs.
    let steps = "--program 1:1e-6,2:1e-7";
    assert_eq!(summary(&format!("{si} {steps}")), Value::Null);
    let strong = summary(&format!("{si} --law ageing --set a=0.02,b=0.01"));
    assert!(number(&strong, "/critical_stiffness") < 0.0, "{strong}");
    assert_eq!(strong["stiffness_ratio"], Value::Null);
}

#[test]
fn defaults_of_the_law_beside_numbers_of_a_fault_are_pointed_out() {
    let warning = |arguments: &str| {
        let err = twinslip(&format!("law --points 2 {arguments}")).err;
        let line = err
            .lines()
            .find(|line| line.starts_with("warning: the defaults"));
        line.map(str::to_owned)
    };
    let line = warning("--slip-length 10um --normal-stress 50MPa").expect("a warning");
    for name in [
        "--direct-effect",
        "--evolution-effect",
        "--reference-friction",
    ] {
        assert!(line.contains(name), "{line}");
    }
    assert!(
        line.contains("--slip-length and --normal-stress describe"),
        "{line}"
    );
    let line =
        warning("--si --law ageing --set a=0.01,b=0.015 --driving 1nm/s").expect("a warning");
    assert!(
        line.ends_with("set --reference-friction and --slip-length too"),
        "{line}"
    );
    for complete in [
        "",
        "--si",
        "--driving 1e-9",
        "--si --slip-length 0.9e-6",
        "--slip-length 10um --normal-stress 50MPa -q",
        "--law ageing --slip-length 10um --normal-stress 50MPa --set a=0.01,b=0.015,mu0=0.6",
    ] {
        assert_eq!(warning(complete), None, "{complete}");
    }
}

/// Where standard error is no terminal there are lines with pauses between, and none with -q.
#[test]
fn progress_in_a_pipe_is_lines() {
    let lines = |arguments: &str, pause: &str| -> Vec<String> {
        let ended = program()
            .args(arguments.split_whitespace())
            .env("TWINSLIP_PROGRESS", pause)
            .output()
            .expect("the program starts");
        let err = String::from_utf8(ended.stderr).expect("UTF-8");
        let command = arguments.split(' ').next().expect("a command");
        let lines = err
            .lines()
            .filter(|line| line.starts_with(&format!("{command}: ")));
        lines.map(str::to_owned).collect()
    };
    let branch = "branch orbits --stiffness 0.14 -o -";
    let said = lines(branch, "1e-9");
    assert!(said.len() > 1, "{said:?}");
    let last = said.last().expect("a line");
    assert!(
        last.contains(" points, V_H = ") && last.ends_with('s'),
        "{last}"
    );
    assert_eq!(lines(branch, "600"), Vec::<String>::new());
    assert_eq!(lines(&format!("{branch} -q"), "1e-9"), Vec::<String>::new());
    // Commands without a fraction to report.
    let place = crate::command::folder("progress").join("paper");
    let reproduce = format!("reproduce --only fig05 --out {}", place.display());
    let said = lines(&reproduce, "1e-9");
    assert!(said.iter().any(|line| line.contains(" of ")), "{said:?}");
    let run = "integrate --driving 0.12 --stiffness 0.14 --until 1e6 --columns time -o -";
    let said = lines(run, "1e-9");
    assert!(said.iter().any(|line| line.contains(" %, ")), "{said:?}");
}
