//! Friction laws of one's own from files: those that are built in, written as files, give the same numbers.

use crate::command;
use crate::common::text::near;
use command::{folder, number, object, refused_in_one_line, run, twinslip};
use serde_json::Value;
use std::fs;

const PARAMETERS: &str = "[parameters]
healing_time = 100.0
residual_strength = 0.001
direct_effect = 0.0349
evolution_effect = 0.0489
reference_friction = 0.369
[where]
gamma = \"2*exp(-reference_friction/direct_effect)\"
beta = \"evolution_effect/direct_effect\"
";

/// The laws as the paper and others print them: the built-in name, v and dpsi/dt.
const LAWS: [(&str, &str, &str); 5] = [
    (
        "spinodal",
        "gamma*sinh(tau)/(residual_strength + (1 + healing_time)*psi)^beta",
        "(1 - psi)/healing_time - abs(v)*psi",
    ),
    (
        "bounded",
        "gamma*sinh(tau)*((1 + healing_time)*psi)^(-beta)",
        "(1 - psi)/healing_time - abs(v)*psi",
    ),
    (
        "regularised-ageing",
        "gamma*sinh(tau)*psi^(-beta)",
        "1 - abs(v)*psi",
    ),
    (
        "dieterich-ruina",
        "gamma/2*exp(tau)*psi^(-beta)",
        "1 - v*psi",
    ),
    (
        "slip",
        "gamma/2*exp(tau - beta*ln(psi))",
        "-v*psi*ln(v*psi)",
    ),
];

/// The path of a file with the law of this built-in name, in a folder of the test's own.
fn law(test: &str, name: &str) -> String {
    let (_, slip_rate, evolution) = LAWS
        .iter()
        .find(|(known, ..)| *known == name)
        .expect("a law");
    let path = folder(test).join(format!("{name}.toml"));
    let text = format!("slip_rate = \"{slip_rate}\"\nevolution = \"{evolution}\"\n{PARAMETERS}");
    fs::write(&path, text).expect("a file");
    path.display().to_string()
}

/// All numbers of an object that another has under the same names too.
#[track_caller]
fn alike(made: &Value, known: &Value, tolerance: f64, names: &[&str]) {
    for name in names {
        let value = |object: &Value| object[*name].as_f64();
        let (made, known) = (value(made), value(known));
        let both = made.zip(known);
        let (made, known) = both.unwrap_or_else(|| panic!("{name}: {made:?} for {known:?}"));
        let off = (made - known).abs();
        assert!(
            off <= tolerance * known.abs().max(1e-3),
            "{name}: {made} for {known}"
        );
    }
}

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
        let file = law("law_runs", name);
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
    let file = law("law_methods", "spinodal");
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
    let file = law("law_estimate", "spinodal");
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
    let file = law("law_programs", "spinodal");
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
fn equilibria_are_all_those_of_the_built_in_law() {
    let file = law("law_equilibria", "spinodal");
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
fn orbits_are_those_of_the_built_in_law() {
    let file = law("law_orbits", "spinodal");
    for loading in [
        "--symmetry symmetric --driving 10 --stiffness 0.14",
        "--symmetry asymmetric --driving 10 --stiffness 0.14",
        "--interfaces 1 --driving 10 --stiffness 0.1",
    ] {
        let orbit = |law: &str| object(&format!("orbit --law {law} {loading}"));
        let (made, known) = (orbit(&file), orbit("spinodal"));
        for (made_at, known_at) in [
            ("period/value", "period/value"),
            ("extremes/stress/min/value", "stress_min/value"),
            ("extremes/stress/max/value", "stress_max/value"),
        ] {
            near(
                number(&made, &format!("/result/orbit/{made_at}")),
                number(&known, &format!("/result/orbit/{known_at}")),
                1e-12,
            );
        }
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
    let file = law("law_section", "spinodal");
    let section = |law: &str| -> Value {
        let ended = twinslip(&format!(
            "section --law {law} --driving 10 --stiffness 0.14 --returns 5 --skip 0 --rtol 1e-15 --format json -q"
        ));
        // So few returns leave the regime undecided.
        assert_eq!(ended.code, 3, "{}", ended.err);
        serde_json::from_str(&ended.out).expect("JSON")
    };
    let (made, known) = (section(&file), section("spinodal"));
    let rows = |made: &Value| made["result"]["rows"].as_array().cloned().expect("rows");
    assert_eq!(rows(&made).len(), 5);
    for (made, known) in rows(&made).iter().zip(&rows(&known)) {
        alike(made, known, 1e-10, &["time", "log_state_1", "log_state_2"]);
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
        let file = law("law_curve", name);
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
fn interfaces_may_differ() {
    let file = law("law_differ", "spinodal");
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

#[test]
fn parameters_are_set_by_flags_and_by_name() {
    let file = law("law_set", "spinodal");
    let end = |options: &str| {
        let made = object(&format!(
            "integrate {options} --driving 1 --stiffness 0.5 --until 1 --final-only --rtol 1e-14 --method taylor"
        ));
        number(&made, "/result/final/stress")
    };
    let known = end("--law spinodal --residual-strength 0.003");
    for options in [
        "--residual-strength 0.003",
        "--set residual_strength=0.003",
        "--set residual_strength_1=0.003,residual_strength_2=0.003",
    ] {
        near(end(&format!("--law {file} {options}")), known, 1e-12);
    }
    let scene = std::path::Path::new(&file).with_file_name("scene.toml");
    let text = "command = \"integrate\"\nlaw = \"spinodal.toml\"\ndriving = 1\nset = { stiffness = 0.5 }\nuntil = 1\nfinal-only = true\nformat = \"json\"\n";
    fs::write(&scene, text).expect("a file");
    let ended = run(&["run", scene.to_str().unwrap(), "-q"]);
    assert_eq!(ended.code, 0, "{}", ended.err);
    let made: Value = serde_json::from_str(&ended.out).expect("JSON");
    near(
        number(&made, "/result/final/stress"),
        end("--law spinodal"),
        1e-6,
    );
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

#[test]
fn pictures_of_runs_and_curves_are_drawn() {
    let place = folder("law_pictures");
    let file = law("law_pictures", "spinodal");
    for (command, name) in [
        (
            format!("integrate --law {file} --driving 1 --stiffness 0.5 --until 2 --program 1:2"),
            "run.svg",
        ),
        (format!("law --law {file}"), "law.svg"),
        (
            format!("section --law {file} --driving 10 --stiffness 0.14 --returns 5 --skip 0"),
            "map.svg",
        ),
    ] {
        let path = place.join(name);
        let ended = twinslip(&format!("{command} -q --plot {}", path.display()));
        assert!([0, 3].contains(&ended.code), "{command}: {}", ended.err);
        let picture = fs::read_to_string(&path).expect("a picture");
        assert!(
            picture.starts_with("<svg") && picture.len() > 2000,
            "{name}"
        );
    }
}

/// A run of this text as a law: status and standard error.
fn broken(text: &str) -> (i32, String) {
    let path = folder("law_broken").join("law.toml");
    fs::write(&path, text).expect("a file");
    let path = path.to_str().expect("a path");
    let ended = run(&[
        "integrate",
        "--law",
        path,
        "--driving",
        "1",
        "--stiffness",
        "1",
        "--until",
        "1e-3",
        "--final-only",
    ]);
    assert_eq!(ended.out, "");
    (ended.code, ended.err)
}

#[test]
fn broken_files_are_told_in_one_sentence() {
    let good = "slip_rate = \"g*sinh(tau)/psi^beta\"\nevolution = \"1 - v*psi\"\n[parameters]\ng = 1e-4\nbeta = 1.4\n";
    let changed = |from: &str, to: &str| {
        assert!(good.contains(from), "{from}");
        good.replacen(from, to, 1)
    };
    let cases = [
        (
            changed("slip_rate", "sliprate"),
            "1:1: unknown key \"sliprate\", there are name, slip_rate, evolution, parameters, where; did you mean \"slip_rate\"?",
        ),
        (
            changed("evolution = \"1 - v*psi\"\n", ""),
            "1:1: the key evolution is missing: at which rate does the state change, in v and psi?",
        ),
        (
            changed("slip_rate = \"g*sinh(tau)/psi^beta\"\n", ""),
            "1:1: the key slip_rate is missing",
        ),
        (
            changed("g*sinh(tau)", "g*sinh(v)"),
            "1:21: \"v\" has no value in what this formula is part of, which is in tau and psi",
        ),
        (
            changed("1 - v*psi", "1 - tau*psi"),
            "2:18: \"tau\" has no value in what this formula is part of, which is in psi and v",
        ),
        (
            changed("psi^beta", "psi^betta"),
            "1:30: \"betta\" is no state, no parameter and not defined in [where]; did you mean \"beta\"?",
        ),
        (
            changed("1 - v*psi", "1 - v psi"),
            "2:20: `p` stands where an operator is expected; products need `*`",
        ),
        (
            changed("\"1 - v*psi\"", "3"),
            "2:13: a formula is a text in quotes, not integer",
        ),
        (
            changed("beta = 1.4", "beta = 1.4\ndriving = 3"),
            "6:1: no parameter of a law can be called driving",
        ),
        (
            changed("beta = 1.4", "beta = 1.4\nslip_rate_1 = 3"),
            "6:1: no parameter of a law can be called slip_rate_1",
        ),
        (
            changed("beta = 1.4", "beta = 1.4\npsi = 3"),
            "6:1: \"psi\" is given twice",
        ),
        (
            changed("beta = 1.4", "beta = inf"),
            "5:8: inf is not a finite number",
        ),
        (
            changed("beta = 1.4", "beta = 1.4\n[where]\nx = \"y\"\ny = \"x\""),
            "\"x\" is defined by",
        ),
        (String::new(), "1:1: the key slip_rate is missing"),
        ("slip_rate = ".into(), "1:"),
    ];
    for (text, sentence) in cases {
        let (code, err) = broken(&text);
        assert_eq!(code, 2, "{text}: {err}");
        assert!(
            err.starts_with("error: ") && err.lines().count() == 1,
            "{err}"
        );
        assert!(err.contains(sentence), "{err} for {sentence}");
    }
}

#[test]
fn what_has_no_meaning_for_a_law_from_a_file_is_refused() {
    let file = folder("law_refused").join("law.toml");
    let text = "slip_rate = \"1e-4*sinh(tau)/psi^1.4\"\nevolution = \"1 - v*psi\"\n";
    fs::write(&file, text).expect("a file");
    let file = file.display();
    let run = format!("integrate --law {file} --driving 1 --stiffness 1 --until 1");
    for (arguments, sentence) in [
        (
            format!("{run} --healing-time 3"),
            "is from a file, and has no parameter healing_time",
        ),
        (
            format!("{run} --damping 0.1"),
            "is from a file, and has no parameter damping",
        ),
        (format!("{run} --si"), "whose numbers have no units"),
        (format!("{run} --interfaces 3"), "1 or 2"),
        (
            format!("{run} --set beta=3"),
            "set is beta, but must be driving or stiffness",
        ),
        (
            format!("{run} --events"),
            "which need interfaces that are built in",
        ),
        (
            format!("{run} --start 1,2"),
            "must be TAU,PSI1,PSI2 or near-symmetric[:EPS]",
        ),
        (format!("{run} --start 1,2,-1"), "psi in --start"),
        (
            format!("integrate --law {file} --stiffness 1 --until 1"),
            "--driving V_H is missing",
        ),
        (
            format!("orbit --law {file} --driving 1"),
            "--stiffness K is missing",
        ),
        (
            format!("equilibria --law {file} --driving 1 --stiffness 1 --box stress=0:1"),
            "has no range of log_state_1",
        ),
        (
            format!("sweep --law {file} --driving 1:2:2 --stiffness 1:2:2"),
            "is a law from a file",
        ),
        (
            "integrate --law nowhere.toml --driving 1 --stiffness 1 --until 1".into(),
            "nowhere.toml",
        ),
        (
            "equilibria --driving 1 --box stress=0:1".into(),
            "is where steady states of a",
        ),
    ] {
        refused_in_one_line(&arguments, sentence);
    }
    // A law that does not weaken as the laws here do may have no steady state.
    let path = folder("law_refused").join("none.toml");
    fs::write(
        &path,
        "slip_rate = \"sinh(tau)\"\nevolution = \"1 + psi\"\n",
    )
    .expect("a file");
    let ended = twinslip(&format!("law --law {}", path.display()));
    assert_eq!(ended.code, 1, "{}", ended.err);
    assert!(
        ended.err.contains("the steady state of the law"),
        "{}",
        ended.err
    );
}
