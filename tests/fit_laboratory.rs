//! Slide-hold-slide, several records and posteriors, as a user meets them.

use crate::command;
use command::{folder, object, refused_in_one_line, run};
use serde_json::Value;
use std::fs;

use super::common::laboratory::Slid;

fn number(value: &Value) -> f64 {
    value
        .as_f64()
        .unwrap_or_else(|| panic!("{value} is no number"))
}

/// By a second code.
#[test]
fn holds_of_runs_are_those_of_references() {
    let text = include_str!("data/holds.json");
    let cases: Value = serde_json::from_str(text).expect("JSON");
    for case in cases["cases"].as_array().expect("a list") {
        let of = |name: &str| number(&case["parameters"][name]);
        let law = case["law"].as_str().expect("a name");
        for hold in case["holds"].as_array().expect("a list") {
            let lasts = number(&hold["duration"]);
            let made = object(&format!(
                "integrate --law {law} --interfaces 1 --driving 1 --stiffness {} --damping {} --direct-effect {} --evolution-effect {} --reference-friction {} \
                 --program 0:0,{lasts}:1 --until {} --rtol 1e-13 --atol 1e-13 --final-only",
                of("K"),
                of("eta"),
                of("a"),
                of("b"),
                of("mustar"),
                lasts + 50.0
            ));
            let own = &made["result"]["holds"][0];
            for name in ["minimum", "peak"] {
                let (made, exact) = (number(&own[name]["value"]), number(&hold[name]));
                assert!(
                    (made - exact).abs() < 1e-9,
                    "{} {lasts} {name}: {made}, {exact}",
                    case["id"]
                );
            }
        }
    }
}

fn sliding(noise: f64, stiffness: f64, program: Vec<(f64, f64)>, until: f64) -> Slid {
    Slid {
        stiffness,
        direct_effect: 0.009,
        evolution_effect: 0.011,
        slip_length: 1.2e-5,
        noise,
        scatter: 0.0,
        program,
        until,
    }
}

fn holds(noise: f64, stiffness: f64) -> Slid {
    let program = vec![
        (0.0, 1e-5),
        (30.0, 0.0),
        (40.0, 1e-5),
        (80.0, 0.0),
        (180.0, 1e-5),
        (220.0, 0.0),
        (420.0, 1e-5),
    ];
    sliding(noise, stiffness, program, 460.0)
}

fn steps(noise: f64, stiffness: f64) -> Slid {
    let program = vec![(0.0, 1e-5), (30.0, 1e-4), (40.0, 1e-5), (80.0, 1e-6)];
    sliding(noise, stiffness, program, 160.0)
}

fn file(name: &str, slid: &Slid, rows: usize, seed: u64) -> String {
    let path = folder(&format!("fit_laboratory_{name}")).join(format!("{name}.csv"));
    fs::write(&path, slid.record(rows, seed)).expect("a file");
    path.to_str().expect("a name").to_owned()
}

fn parameter<'a>(list: &'a Value, name: &str) -> &'a Value {
    let all = list.as_array().expect("a list");
    let own = all.iter().find(|one| one["name"] == name);
    own.unwrap_or_else(|| panic!("{name} in {list}"))
}

#[test]
fn a_fit_and_a_run_say_the_same_of_holds() {
    let path = file("holds", &holds(2e-4, 1500.0), 4600, 1);
    let fitted = object(&format!("fit {path}"));
    let result = &fitted["result"];
    assert_eq!(result["fit"]["verdict"], "converged");
    let run = object(
        "integrate --si --law ageing --interfaces 1 --direct-effect 0.009 --evolution-effect 0.011 --slip-length 1.2e-5 --reference-friction 0.6 \
         --reference-rate 1e-5 --normal-stress 1e6 --stiffness 1.5e9 --driving 1e-5 --program 30:0,40:1e-5,80:0,180:1e-5,220:0,420:1e-5 --until 460 --damping 0 --final-only",
    );
    let pairs = result["holds"].as_array().expect("holds");
    let exact = run["result"]["holds"].as_array().expect("holds");
    assert_eq!(pairs.len(), 3);
    assert_eq!(exact.len(), 3);
    for (own, exact) in pairs.iter().zip(exact) {
        assert!((number(&own["start"]) - number(&exact["start"])).abs() < 0.2);
        for name in ["minimum", "peak", "healing"] {
            let truth = number(&exact[name]["value"]);
            for shown in [&own[name], &own["fitted"][name]] {
                let off = (number(&shown["value"]) - truth) / number(&shown["uncertainty"]);
                assert!(off.abs() < 4.5, "{name}: {off}: {own}, {exact}");
                assert!(number(&shown["uncertainty"]) < 5e-4, "{own}");
            }
        }
    }
    let (rate, exact) = (&result["healing_rate"], &run["result"]["healing_rate"]);
    let off = number(&rate["value"]) - number(&exact["value"]);
    assert!(
        off.abs() < 4.0 * number(&rate["uncertainty"]) + number(&exact["uncertainty"]),
        "{rate} {exact}"
    );
}

/// Friction still rises as the record ends: there is no peak yet, in a run and in a fit.
#[test]
fn a_hold_that_no_peak_follows_has_none() {
    let slid = Slid {
        until: 422.0,
        ..holds(2e-4, 1500.0)
    };
    let path = file("no-peak", &slid, 4220, 11);
    let fitted = object(&format!("fit {path} --intervals linear"));
    let run = object(
        "integrate --law ageing --interfaces 1 --stiffness 5 --driving 1 --program 0:0,10:1 --until 10.2 --final-only",
    );
    let of_fit = &fitted["result"]["holds"][2];
    for hold in [of_fit, &of_fit["fitted"]] {
        assert!(
            hold["peak"].is_null() && hold["healing"].is_null(),
            "{of_fit}"
        );
        assert!(number(&hold["minimum"]["uncertainty"]) > 0.0, "{of_fit}");
    }
    let stress = &run["result"]["holds"][0]["stress"];
    assert!(stress["peak"].is_null() && stress["healing"].is_null());
    assert!(number(&stress["minimum"]) < number(&stress["before"]));
}

#[test]
fn records_share_parameters_and_those_that_differ_are_named() {
    let one = file("share-1", &steps(2e-4, 2000.0), 1600, 2);
    let two = file("share-2", &holds(4e-4, 1500.0), 1600, 3);
    let three = file("share-3", &steps(3e-4, 3000.0), 1600, 4);
    let made = object(&format!("fit {one} {two} {three}"));
    let result = &made["result"];
    let fit = &result["fit"];
    assert_eq!(fit["verdict"], "converged", "{}", fit["undecided"]);
    let all = fit["parameters"].as_array().expect("a list");
    // a, b, L; and three springs and levels.
    assert_eq!(all.len(), 9);
    for (name, truth) in [
        ("direct_effect", 0.009),
        ("evolution_effect", 0.011),
        ("slip_length", 1.2e-5),
    ] {
        let own = parameter(&fit["parameters"], name);
        let off = (number(&own["value"]) - truth) / number(&own["uncertainty"]);
        assert!(off.abs() < 4.0, "{own}");
        // Better known than by any record alone.
        for record in result["records"].as_array().expect("records") {
            let alone = parameter(&record["fit"]["parameters"], name);
            assert!(number(&own["uncertainty"]) < number(&alone["uncertainty"]));
        }
    }
    let springs = all.iter().filter(|one| one["name"] == "stiffness");
    for (own, (truth, record)) in springs.zip([(2000.0, 1), (1500.0, 2), (3000.0, 3)]) {
        assert_eq!(own["record"], record);
        let off = (number(&own["value"]) - truth) / number(&own["uncertainty"]);
        assert!(off.abs() < 4.0, "{own}");
    }
    // The record with the least noise weighs most.
    assert_eq!(result["records"][0]["weight"], 1.0);
    assert!(number(&result["records"][1]["weight"]) < 0.4);
    assert_eq!(made["result"]["rows"][1600]["record"], 2);

    let other = Slid {
        direct_effect: 0.014,
        ..steps(2e-4, 2000.0)
    };
    let odd = file("share-odd", &other, 1600, 5);
    let ended = run(&["fit", &one, &three, &two, &odd, "--format=json"]);
    let made: Value = serde_json::from_str(&ended.out).expect("JSON");
    let agreement = parameter(&made["result"]["agreement"], "direct_effect");
    assert!(number(&agreement["widening"]) > 2.0, "{agreement}");
    let outlying = made["result"]["records"][3]["outlying"]
        .as_array()
        .expect("a list");
    assert!(outlying.contains(&"direct_effect".into()), "{outlying:?}");
    assert!(
        ended.err.contains("far from the others: record 4"),
        "{}",
        ended.err
    );
}

#[test]
fn draws_agree_with_the_fit_and_go_into_ensembles() {
    let path = file("draws", &steps(1e-4, 2000.0), 4000, 6);
    let object_of = folder("fit_laboratory_draws_of").join("fit.json");
    let name = object_of.to_str().expect("a name");
    let ended = run(&[
        "fit",
        &path,
        "--posterior",
        "2000",
        "--normal-stress",
        "5e6",
        "-o",
        name,
        "--force",
    ]);
    assert_eq!(ended.code, 0, "{}", ended.err);
    let made: Value =
        serde_json::from_str(&fs::read_to_string(&object_of).expect("a file")).expect("JSON");
    let posterior = &made["result"]["posterior"];
    assert_eq!(posterior["verdict"], "converged", "{posterior}");
    assert!(number(&posterior["r_hat"]) < 1.01);
    assert!(number(&posterior["effective_sample_size"]) > 400.0);
    for own in posterior["parameters"].as_array().expect("a list") {
        assert_eq!(own["draws"].as_array().expect("draws").len(), 2000);
        let fitted = parameter(
            &made["result"]["fit"]["parameters"],
            own["name"].as_str().expect("a name"),
        );
        let error = number(&fitted["uncertainty"]);
        // White noise: the two are the same but for the shape and the chance of draws.
        assert!(
            (number(&own["mean"]) - number(&fitted["value"])).abs() < 0.25 * error,
            "{own}"
        );
        let ratio = number(&own["standard_deviation"]) / error;
        assert!((0.85..1.18).contains(&ratio), "{ratio}");
    }
    // The same seed, the same draws; another one, others.
    let again = object(&format!("fit {path} --posterior 2000 --normal-stress 5e6"));
    assert_eq!(again["result"]["posterior"], *posterior);
    let law = object(&format!("law --ensemble {name}:40"));
    assert!(law["result"].is_object(), "{law}");
}

/// Ctrl-C on the way through the posterior ends it, not what is known by then.
#[cfg(unix)]
#[test]
fn an_interrupted_posterior_keeps_the_fit() {
    use std::io::{BufRead, BufReader};
    use std::process::{Command, Stdio};

    let path = file("interrupted", &steps(1e-4, 2000.0), 2000, 10);
    let object_of = folder("fit_laboratory_interrupted_of").join("fit.json");
    let words = format!("fit {path} --posterior 4000000 -o {}", object_of.display());
    let mut child = command::program()
        .args(words.split_whitespace())
        .env("TWINSLIP_PROGRESS", "0.02")
        .stdout(Stdio::null())
        .stderr(Stdio::piped())
        .spawn()
        .expect("the program starts");
    let said = BufReader::new(child.stderr.take().expect("messages"));
    let mut lines = said.lines();
    let drawing = |line: std::io::Result<String>| line.expect("text").contains("drawing");
    assert!(lines.any(drawing), "no draw came");
    let pid = child.id().to_string();
    let sent = Command::new("kill").args(["-INT", &pid]).status();
    assert!(sent.expect("kill").success());
    lines.for_each(drop);
    assert_eq!(child.wait().expect("it ends").code(), Some(130));
    let made: Value =
        serde_json::from_str(&fs::read_to_string(&object_of).expect("a file")).expect("JSON");
    assert_eq!(made["result"]["fit"]["verdict"], "converged");
    assert!(made["result"]["posterior"].is_null());
}

#[test]
fn priors_hold_where_the_data_say_nothing() {
    let path = file("priors", &steps(1e-4, 2000.0), 2000, 7);
    let made = object(&format!(
        "fit {path} --posterior 2000 --prior slip_length=normal:2e-5:1e-9 --prior direct_effect=uniform:0.001:0.02"
    ));
    let all = &made["result"]["posterior"]["parameters"];
    let length = parameter(all, "slip_length");
    assert!((number(&length["mean"]) - 2e-5).abs() < 1e-8, "{length}");
    assert_eq!(length["prior"], "normal:0.00002:0.000000001");
    assert_eq!(
        parameter(all, "direct_effect")["prior"],
        "uniform:0.001:0.02"
    );
}

#[test]
fn wrong_words_are_refused_in_one_line() {
    let path = file("wrong", &steps(1e-4, 2000.0), 1600, 8);
    let holds = file("wrong-holds", &holds(1e-4, 2000.0), 1600, 9);
    for (words, said) in [
        (format!("fit {path} --each stiffness"), "each"),
        (format!("fit {path} --plot-holds x.svg"), "plot-holds"),
        (format!("fit {path} --plot-records x.svg"), "plot-records"),
        (
            format!("fit {path} --prior slip_length=normal:1:2"),
            "posterior",
        ),
        (format!("fit {path} --seed 2"), "posterior"),
        (format!("fit {path} --posterior 20"), "at least 100"),
        (
            format!("fit {path} --posterior 500 --loss huber"),
            "normal noise",
        ),
        (
            format!("fit {path} --posterior 500 --prior slip_length=flat:1:2"),
            "log-uniform",
        ),
        (
            format!("fit {path} --posterior 500 --prior slip_length=uniform:2:1"),
            "A below B",
        ),
        (
            format!("fit {path} --posterior 500 --prior drift=uniform:1:2"),
            "not fitted",
        ),
        (format!("fit {path} {holds} --each color"), "not fitted"),
    ] {
        refused_in_one_line(&words, said);
    }
}
