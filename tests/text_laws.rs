//! User-defined friction laws from files in motion: those that are built in, written as files, give the same numbers.

use crate::command;
use crate::common::text::{alike, law, near};
use command::{folder, number, object, twinslip};
use serde_json::Value;
use std::fs;

const COLUMNS: [&str; 10] = [
    "time",
    "stress",
    "state_1",
    "state_2",
    "log_state_1",
    "log_state_2",
    "slip_rate_1",
    "slip_rate_2",
    "slip_1",
    "slip_2",
];

#[test]
fn runs_are_those_of_built_in_laws() {
    for (name, loading) in [
        ("spinodal", "--driving 10 --stiffness 0.14 --until 2"),
        ("bounded", "--driving 1 --stiffness 0.5 --until 3"),
        ("regularised-ageing", "--driving 1 --stiffness 2 --until 3"),
        ("dieterich-ruina", "--driving 1 --stiffness 2 --until 3"),
        ("slip", "--driving 1 --stiffness 2 --until 3"),
    ] {
        let file = law(name);
        for interfaces in [1, 2] {
            let run = |law: &str| {
                object(&format!(
                    "integrate --law {law} --interfaces {interfaces} {loading} --rtol 1e-15 --method taylor --points 7 --start near-symmetric:-0.2"
                ))
            };
            let (made, known) = (run(&file), run(name));
            let rows = |made: &Value| made["result"]["rows"].as_array().cloned().expect("rows");
            assert_eq!(rows(&made).len(), 7);
            let columns = COLUMNS
                .iter()
                .filter(|column| interfaces == 2 || !column.ends_with('2'));
            let columns: Vec<&str> = columns.copied().collect();
            for (made, known) in rows(&made).iter().zip(&rows(&known)) {
                assert_eq!(made.as_object().map(|row| row.len()), Some(columns.len()));
                alike(made, known, 1e-12, &columns);
            }
        }
    }
}

#[test]
fn every_method_runs_a_law_from_a_file() {
    let file = law("spinodal");
    let run = |method: &str, rtol: &str| {
        object(&format!(
            "integrate --law {file} --driving 1 --stiffness 0.14 --until 1 --method {method} --rtol {rtol} --final-only"
        ))
    };
    let exact = run("taylor", "1e-15");
    for method in twinslip::integrate::Choice::names() {
        let made = run(method, "1e-9");
        for column in ["stress", "log_state_2", "slip_rate_1", "slip_2"] {
            let pointer = format!("/result/final/{column}");
            near(number(&made, &pointer), number(&exact, &pointer), 2e-5);
        }
    }
}

#[test]
fn an_estimate_holds_the_error() {
    let file = law("spinodal");
    let arguments = format!(
        "integrate --law {file} --driving 10 --stiffness 0.14 --until 3 --estimate-error --final-only"
    );
    let exact = object(&format!("{arguments} --rtol 1e-15 --reference"));
    for rtol in ["1e-6", "1e-10"] {
        let made = object(&format!("{arguments} --rtol {rtol}"));
        for state in ["stress", "log_state_1", "log_state_2"] {
            let value = |made: &Value| number(made, &format!("/result/final/{state}"));
            let error = |made: &Value| number(made, &format!("/result/final/{state}_uncertainty"));
            let off = (value(&made) - value(&exact)).abs();
            assert!(off <= error(&made) + error(&exact), "{rtol}: {off}");
        }
        assert!(number(&made, "/result/final/error_estimate") < 1e-2);
    }
}

#[test]
fn programs_are_followed_as_by_built_in_laws() {
    let file = law("spinodal");
    for interfaces in [1, 2] {
        let run = |law: &str| {
            object(&format!(
                "integrate --law {law} --interfaces {interfaces} --stiffness 0.5 --driving 1 --until 6 --program 1:3,2:0,3-4:2,5:1 --rtol 1e-15 --method taylor --every 0.5 --start near-symmetric:-0.1"
            ))
        };
        let (made, known) = (run(&file), run("spinodal"));
        let rows = |made: &Value| made["result"]["rows"].as_array().cloned().expect("rows");
        assert_eq!(rows(&made).len(), rows(&known).len());
        for (made, known) in rows(&made).iter().zip(&rows(&known)) {
            let names = [
                "time",
                "driving",
                "stress",
                "state_1",
                "slip_rate_1",
                "slip_1",
            ];
            alike(made, known, 1e-12, &names);
            if interfaces == 2 {
                alike(made, known, 1e-12, &["state_2", "slip_rate_2", "slip_2"]);
            }
        }
        assert_eq!(made["result"]["program"], known["result"]["program"]);
        assert_eq!(made["model"]["driving"], 1.0);
    }
    // An error estimate goes through the changes as well.
    let made = object(&format!(
        "integrate --law {file} --stiffness 0.5 --program 0:1,1-2:3 --until 3 --final-only --estimate-error"
    ));
    let estimate = number(&made, "/result/final/error_estimate");
    assert!(estimate > 0.0 && estimate < 1e-4, "{estimate}");
}

#[test]
fn orbits_are_those_of_the_built_in_law() {
    let file = law("spinodal");
    for loading in [
        "--symmetry symmetric --driving 10 --stiffness 0.14",
        "--symmetry asymmetric --driving 10 --stiffness 0.14",
        "--interfaces 1 --driving 10 --stiffness 0.1",
    ] {
        let orbit = |law: &str| object(&format!("orbit --law {law} {loading}"));
        let (made, known) = (orbit(&file), orbit("spinodal"));
        for (made_at, known_at) in [
            ("period/value", "period/value"),
            ("stress_min/value", "stress_min/value"),
            ("stress_max/value", "stress_max/value"),
            ("state_min", "state_min"),
            ("extremes/stress/max/value", "stress_max/value"),
            (
                "extremes/log_state_1/min/value",
                "extremes/log_state_1/min/value",
            ),
        ] {
            near(
                number(&made, &format!("/result/orbit/{made_at}")),
                number(&known, &format!("/result/orbit/{known_at}")),
                1e-12,
            );
        }
        let rate = "/result/orbit/slip_rate_max";
        near(number(&made, rate) / number(&known, rate), 1.0, 1e-10);
        assert_eq!(
            made["result"]["orbit"]["symmetry"],
            known["result"]["orbit"]["symmetry"]
        );
        let ln_abs = "/result/orbit/log_multipliers/0/ln_abs/value";
        near(number(&made, ln_abs), number(&known, ln_abs), 1e-9);
        assert_eq!(
            made["result"]["orbit"]["verdict"],
            known["result"]["orbit"]["verdict"]
        );
    }
}

#[test]
fn returns_are_those_of_the_built_in_law() {
    let file = law("spinodal");
    let section = |law: &str, surface: &str| -> Value {
        let ended = twinslip(&format!(
            "section --law {law} --driving 10 --stiffness 0.14 --surface {surface} --returns 5 --skip 0 --rtol 1e-15 --format json -q"
        ));
        // So few returns leave the regime undecided.
        assert_eq!(ended.code, 3, "{}", ended.err);
        serde_json::from_str(&ended.out).expect("JSON")
    };
    let rows = |made: &Value| made["result"]["rows"].as_array().cloned().expect("rows");
    for surface in ["stress=auto", "stress=9.7", "log_state_1=-6"] {
        let (made, known) = (section(&file, surface), section("spinodal", surface));
        assert_eq!(rows(&made).len(), 5);
        assert_eq!(
            made["numerics"]["surface_stress"].is_number(),
            surface != "log_state_1=-6"
        );
        for (made, known) in rows(&made).iter().zip(&rows(&known)) {
            let names = |row: &Value| -> Vec<String> {
                let row = row.as_object().expect("a row");
                row.keys().cloned().collect()
            };
            assert_eq!(names(made), names(known));
            let columns = [
                "n",
                "time",
                "stress",
                "log_state_1",
                "log_state_2",
                "slip_rate_1",
                "slip_rate_sum",
                "next_slip_rate_sum",
            ];
            alike(made, known, 1e-9, &columns);
        }
    }
}

#[test]
fn events_are_those_of_the_built_in_law() {
    let file = law("spinodal");
    for (interfaces, method) in [(1, "taylor"), (2, "taylor"), (2, "rodas5p")] {
        let run = |law: &str| {
            object(&format!(
                "integrate --law {law} --interfaces {interfaces} --driving 10 --stiffness 0.14 --start near-symmetric --until 9 --program 8:3 --events --rtol 1e-12 --method {method} --final-only"
            ))
        };
        let events = |made: Value| made["result"]["events"].as_array().cloned();
        let (made, known) = (events(run(&file)), events(run("spinodal")));
        let (made, known) = (made.expect("events"), known.expect("events"));
        assert!(known.len() > 1 && made.len() == known.len(), "{made:?}");
        for (made, known) in made.iter().zip(&known) {
            let columns = [
                "onset",
                "duration",
                "stress_drop",
                "peak_slip_rate",
                "slip_1",
            ];
            alike(made, known, 1e-6, &columns);
            assert_eq!(made["leader"], known["leader"]);
        }
    }
}

/// An absolute error by 1 of ln psi is a factor of e, of whatever law.
#[test]
fn tolerances_are_those_of_built_in_laws() {
    for command in ["integrate --until 1", "section", "orbit"] {
        for law in [law("spinodal"), "spinodal".into()] {
            let ended = twinslip(&format!(
                "{command} --law {law} --driving 10 --stiffness 0.14 --atol 2"
            ));
            assert_eq!(ended.code, 2, "{}", ended.out);
            assert!(ended.err.contains("atol is 2"), "{}", ended.err);
        }
    }
}

#[test]
fn interfaces_may_differ() {
    let file = law("spinodal");
    let by_law = object(&format!(
        "integrate --law {file} --driving 1 --stiffness 0.5 --set residual_strength_2=0.01 --until 2 --rtol 1e-15 --method taylor --final-only --start 9,0.01,0.02"
    ));
    let parameters = &by_law["model"]["parameters"];
    assert_eq!(parameters["residual_strength_1"], 0.001);
    assert_eq!(parameters["residual_strength_2"], 0.01);
    // The same system, written out.
    let path = folder("law_differ").join("system.toml");
    let text = crate::common::text::SPINODAL
        .replace("/(c + (1 + R)*exp(w2))", "/(0.01 + (1 + R)*exp(w2))")
        .replace("V = 10.0", "V = 1.0")
        .replace("K = 0.14", "K = 0.5");
    fs::write(&path, text).expect("a file");
    let by_system = object(&format!(
        "integrate --system {} --until 2 --rtol 1e-15 --method taylor --final-only --start 9,{},{}",
        path.display(),
        0.01_f64.ln(),
        0.02_f64.ln()
    ));
    for (name, other) in [
        ("stress", "tau"),
        ("log_state_1", "w1"),
        ("log_state_2", "w2"),
    ] {
        near(
            number(&by_law, &format!("/result/final/{name}")),
            number(&by_system, &format!("/result/final/{other}")),
            1e-12,
        );
    }
}

/// Radiation damping of laws from files: numbers are those of the built-in laws, whose slip rate is defined by the same equation.
#[test]
fn damped_runs_are_those_of_built_in_laws() {
    for (name, interfaces, options) in [
        ("spinodal", 2, "--damping 0.05"),
        ("bounded", 1, "--damping 3"),
        ("regularised-ageing", 2, "--set damping=1e-3"),
        ("dieterich-ruina", 1, "--damping 0.2"),
        ("slip", 2, "--damping 0.2"),
    ] {
        let file = law(name);
        let run = |law: &str| {
            object(&format!(
                "integrate --law {law} --interfaces {interfaces} {options} --driving 10 --stiffness 0.5 --until 1 --rtol 1e-15 --method taylor --points 5 --start near-symmetric:-0.2"
            ))
        };
        let (made, known) = (run(&file), run(name));
        let rows = |made: &Value| made["result"]["rows"].as_array().cloned().expect("rows");
        let columns = COLUMNS
            .iter()
            .filter(|column| interfaces == 2 || !column.ends_with('2'));
        let columns: Vec<&str> = columns.copied().collect();
        for (made, known) in rows(&made).iter().zip(&rows(&known)) {
            alike(made, known, 1e-12, &columns);
        }
        let value = options.split(['=', ' ']).next_back().unwrap_or_default();
        let told = number(&made, "/model/parameters/damping");
        assert_eq!(Ok(told), value.parse());
    }
}

/// By methods that take Jacobians and by those that take the rates alone.
#[test]
fn every_method_runs_a_damped_law_from_a_file() {
    let file = law("spinodal");
    let end = |law: &str, method: &str, rtol: f64| {
        let made = object(&format!(
            "integrate --law {law} --damping 0.1 --driving 10 --stiffness 0.14 --until 2 --rtol {rtol} --method {method} --final-only"
        ));
        number(&made, "/result/final/stress")
    };
    let exact = end("spinodal", "taylor", 1e-15);
    for method in twinslip::integrate::Choice::names() {
        near(end(&file, method, 1e-9), exact, 1e-6);
    }
}

/// Formulas with a factor within and without: stress in other units, sums within exp, quotients.
#[test]
fn damping_is_found_in_formulas_of_other_shape() {
    let known = law("dieterich-ruina");
    let other = folder("law_damped_shapes").join("other.toml");
    let text = "slip_rate = \"-exp(-(mu - S*tau/unit)/a)*(-1)/psi^(b/a)\"\nevolution = \"1 - v*psi\"\n[parameters]\na = 0.0349\nb = 0.0489\nmu = 0.369\nunit = 2.0\n[where]\nS = \"2*a\"\n";
    fs::write(&other, text).expect("a file");
    let curve =
        |law: &str| format!("law --law {law} --damping 0.05 --points 9 --from 0.1 --to 100");
    let (made, known) = (
        object(&curve(&other.display().to_string())),
        object(&curve(&known)),
    );
    let rows = |made: &Value| made["result"]["rows"].as_array().cloned().expect("rows");
    assert_eq!(rows(&made).len(), 9);
    for (made, known) in rows(&made).iter().zip(&rows(&known)) {
        alike(
            made,
            known,
            1e-12,
            &["stress", "state", "critical_stiffness"],
        );
    }
}
