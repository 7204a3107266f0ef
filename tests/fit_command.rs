//! `twinslip fit` as a user meets it: on the basalt record, on written files, and where input is wrong.

use crate::command;
use command::{folder, object, refused_in_one_line, run, twinslip};
use serde_json::Value;
use std::fs;

const BASALT: &str = "tests/data/laboratory/basalt.txt";

fn parameter<'a>(fit: &'a Value, name: &str) -> &'a Value {
    let all = fit["parameters"].as_array().expect("a list");
    let found = all.iter().find(|one| one["name"] == name);
    found.unwrap_or_else(|| panic!("{name} in {fit}"))
}

fn value(fit: &Value, name: &str) -> f64 {
    parameter(fit, name)["value"].as_f64().expect("a number")
}

/// A record of a step on a rigid apparatus, whose friction is a closed form; columns and units as given. On a spring, as stiff as it is, a and b
/// come out different by a percent.
fn written(header: &str, between: &str, row: impl Fn(f64, f64, f64) -> Vec<f64>) -> String {
    let (a, b, length) = (0.01_f64, 0.013_f64, 1e-5_f64);
    let mut text = header.to_owned();
    for i in 0..400 {
        let t = 0.1 * f64::from(i);
        let since = t - 20.0;
        let (x, mu) = if since <= 0.0 {
            (1e-6 * t, 0.6)
        } else {
            let decay = (-1e-5 * since / length).exp();
            let ratio = 10.0_f64;
            let log_state = decay * ratio.ln() - ratio.ln();
            (2e-5 + 1e-5 * since, 0.6 + a * ratio.ln() + b * log_state)
        };
        // Noise that a reader of the record can't tell from any: of 1e-5.
        let noise = 1e-5 * (12.9898 * f64::from(i)).sin() * (78.233 * f64::from(i)).cos();
        let cells = row(t, x, mu + noise);
        let cells: Vec<String> = cells.iter().map(f64::to_string).collect();
        text += &cells.join(between);
        text += "\n";
    }
    text
}

#[test]
fn the_basalt_step_is_fitted() {
    let made = object(&format!(
        "fit {BASALT} --law slip --load-point recorded --to 11690"
    ));
    let fit = &made["result"]["fit"];
    assert_eq!(fit["verdict"], "converged", "{}", fit["undecided"]);
    // a and b of gouges are near 0.01, L some micrometres to tens of them.
    assert!(
        (0.004..0.02).contains(&value(fit, "direct_effect")),
        "{fit}"
    );
    assert!(
        (0.004..0.02).contains(&value(fit, "evolution_effect")),
        "{fit}"
    );
    assert!((1e-6..5e-5).contains(&value(fit, "slip_length")), "{fit}");
    assert!(
        fit["residual_rms"].as_f64().expect("a number") < 1.2e-3,
        "{fit}"
    );
    let rows = made["result"]["rows"].as_array().expect("rows");
    assert_eq!(
        rows.len() as u64,
        made["model"]["samples"].as_u64().expect("a count")
    );
    for one in fit["parameters"].as_array().expect("a list") {
        let number = |x: &Value| x.as_f64().expect("a number");
        let (low, high) = (
            number(&one["interval_95"][0]),
            number(&one["interval_95"][1]),
        );
        let (best, error) = (number(&one["value"]), number(&one["uncertainty"]));
        assert!(low < best && best < high, "{one}");
        assert!(
            (high - low) / error > 2.0 && (high - low) / error < 8.0,
            "{one}"
        );
    }
}

#[test]
fn the_same_record_in_other_units_and_signs_is_the_same() {
    let folder = folder("fit_units");
    let plain = written("time,displacement,friction\n", ",", |t, x, mu| {
        vec![t, x, mu]
    });
    let files = [
        ("si.csv", plain.clone()),
        (
            "units.tsv",
            written(
                "# a laboratory\nTime(ms)\tDispl(microns)\tShear stress (MPa)\tNormal stress (MPa)\n",
                "\t",
                |t, x, mu| vec![t * 1e3, x * 1e6, mu * 5.0, 5.0],
            ),
        ),
        (
            "lines.txt",
            written("Time Displ Mu\n(s) (mm) (-)\n", "   ", |t, x, mu| {
                vec![t, x * 1e3, mu]
            }),
        ),
        ("bare.csv", written("", "; ", |t, x, mu| vec![mu, t, x])),
    ];
    let mut all = Vec::new();
    for (name, text) in files {
        let path = folder.join(name);
        fs::write(&path, text).expect("a file");
        let mut words = vec![
            "fit",
            path.to_str().expect("a name"),
            "--law=slip",
            "--intervals=linear",
        ];
        words.extend(["--free=direct_effect,evolution_effect,slip_length,reference_friction"]);
        words.extend(["--stiffness=0.5/um", "--format=json", "-q"]);
        if name == "bare.csv" {
            words.extend(["--time=2", "--displacement=3", "--friction=1"]);
        }
        let ended = run(&words);
        assert_eq!(ended.code, 0, "{name}: {}", ended.err);
        let object: Value = serde_json::from_str(&ended.out).expect("JSON");
        let fit = object["result"]["fit"].clone();
        for (parameter, truth) in [
            ("direct_effect", 0.01),
            ("evolution_effect", 0.013),
            ("slip_length", 1e-5),
        ] {
            let off = value(&fit, parameter) / truth - 1.0;
            assert!(off.abs() < 0.02, "{name} {parameter}: {off:e}");
        }
        all.push(fit);
    }
    for other in &all[1..] {
        for name in ["direct_effect", "evolution_effect", "slip_length"] {
            let off = value(other, name) / value(&all[0], name) - 1.0;
            assert!(off.abs() < 1e-5, "{name}: {off:e}");
        }
    }
    // By its program instead of its displacement.
    let by_program = format!(
        "fit {} --law slip --intervals linear --stiffness 0.5/um --program 20:1e-5 --driving 1e-6 --free direct_effect,evolution_effect,slip_length",
        folder.join("si.csv").display()
    );
    let made = object(&by_program);
    let off = value(&made["result"]["fit"], "slip_length") / value(&all[0], "slip_length") - 1.0;
    assert!(off.abs() < 0.02, "{off:e}");
    // The spring in Pa/m where the normal stress is known.
    let unit = |fit: &Value| fit["fixed"]["stiffness"].as_f64().expect("a number");
    assert!((unit(&all[1]) / (5e5 * 5e6) - 1.0).abs() < 1e-12);
    assert!((unit(&all[0]) / 5e5 - 1.0).abs() < 1e-12);
}

#[test]
fn laws_are_compared_and_never_called_best_alone() {
    let folder = folder("fit_laws");
    let path = folder.join("record.csv");
    let text = written("time,displacement,friction\n", ",", |t, x, mu| {
        vec![t, x, mu]
    });
    fs::write(&path, text).expect("a file");
    let words = format!(
        "fit {} --law dieterich-ruina,slip,scenes/laws/composite.toml --stiffness 0.5/um --intervals linear",
        path.display()
    );
    let file = folder.join("made.json");
    let ended = twinslip(&format!("{words} -o {}", file.display()));
    assert_eq!(ended.code, 0, "{}", ended.err);
    let made: Value = serde_json::from_slice(&fs::read(file).expect("a result")).expect("JSON");
    let laws = made["result"]["laws"].as_array().expect("a list");
    assert_eq!(laws.len(), 3);
    // Made by the slip law.
    let difference = |name: &str| {
        let law = laws.iter().find(|law| law["law"] == name).expect("a law");
        law["aicc_difference"].as_f64().expect("a number")
    };
    assert!(difference("dieterich-ruina") > 100.0, "{laws:?}");
    assert!(difference("slip").abs() < 10.0, "{laws:?}");
    let predicted = |name: &str| {
        let law = laws.iter().find(|law| law["law"] == name).expect("a law");
        law["cross_validation_rms"].as_f64().expect("a number")
    };
    assert!(
        predicted("slip") < 0.1 * predicted("dieterich-ruina"),
        "{laws:?}"
    );
    assert!(ended.err.contains("above that of"), "{}", ended.err);
    assert!(!ended.err.contains("best"), "{}", ended.err);
}

#[test]
fn a_law_from_a_file_gives_what_the_built_in_one_gives() {
    let folder = folder("fit_text");
    let path = folder.join("slip.toml");
    let law = "slip_rate = \"exp((tau*direct_effect - reference_friction)/direct_effect)*psi^(-evolution_effect/direct_effect)\"\n\
               evolution = \"-v*psi*ln(v*psi)\"\n\
               [parameters]\ndirect_effect = 0.01\nevolution_effect = 0.01\nreference_friction = 0.6\n";
    fs::write(&path, law).expect("a file");
    let of = |law: &str| {
        let words = format!("fit {BASALT} --law {law} --intervals linear --from 11650 --to 11690");
        object(&words)["result"]["fit"].clone()
    };
    let (built_in, read) = (of("slip"), of(path.to_str().expect("a name")));
    for name in [
        "direct_effect",
        "evolution_effect",
        "slip_length",
        "stiffness",
    ] {
        let error = parameter(&built_in, name)["uncertainty"]
            .as_f64()
            .expect("a number");
        let off = (value(&read, name) - value(&built_in, name)).abs();
        assert!(off < 1e-2 * error, "{name}: {off:e} of {error:e}");
    }
}

#[test]
fn pictures_and_a_page_are_written() {
    let folder = folder("fit_files");
    let file = |name: &str| folder.join(name).display().to_string();
    let ended = run(&[
        "fit",
        BASALT,
        "--law=slip",
        "--from=11650",
        "--to=11690",
        "--each-step",
        "--plot",
        &file("fit.svg"),
        "--plot-parameters",
        &file("parameters.svg"),
        "--plot-law",
        &file("law.png"),
        "--report",
        &file("fit.html"),
        "-o",
        &file("rows.csv"),
    ]);
    assert!([0, 3].contains(&ended.code), "{}", ended.err);
    let page = fs::read_to_string(folder.join("fit.html")).expect("a page");
    for part in [
        "slip_length",
        "Correlation",
        "Steady-state law",
        "<svg",
        "step at",
    ] {
        assert!(page.contains(part) || page.contains("data:image"), "{part}");
    }
    let parameters = fs::read_to_string(folder.join("parameters.svg")).expect("a picture");
    assert!(parameters.contains("correlation"));
    assert!(fs::metadata(folder.join("law.png")).is_ok_and(|file| file.len() > 1000));
    let rows = fs::read_to_string(folder.join("rows.csv")).expect("rows");
    assert!(
        rows.contains("time,displacement,observed,fitted,residual"),
        "{rows:.400}"
    );
}

#[test]
fn wrong_input_is_told_in_one_sentence() {
    let folder = folder("fit_input");
    let plain = written("time,displacement,friction\n", ",", |t, x, mu| {
        vec![t, x, mu]
    });
    let with = |name: &str, text: String| {
        let path = folder.join(name);
        fs::write(&path, text).expect("a file");
        path.display().to_string()
    };
    let good = with("good.csv", plain.clone());
    let lines: Vec<&str> = plain.lines().collect();
    let changed = |at: usize, line: &str| {
        let mut lines = lines.clone();
        lines[at] = line;
        lines.join("\n")
    };
    let back = with("back.csv", changed(50, "1.0,4.9e-6,0.6"));
    let nan = with("nan.csv", changed(50, "4.9,4.9e-6,NaN"));
    let word = with("word.csv", changed(50, "4.9,4.9e-6,lost"));
    let short = with("short.csv", lines[..12].join("\n"));
    let still = with("still.csv", lines[..150].join("\n"));
    let mut gap = lines.clone();
    gap.drain(60..180);
    let gap = with("gap.csv", gap.join("\n"));
    let unit = with(
        "unit.csv",
        changed(0, "time (furlongs),displacement,friction"),
    );
    let bare = with("bare.csv", lines[1..].join("\n"));
    let empty = with("empty.csv", String::new());
    for (words, says) in [
        (
            format!("fit {back}"),
            "back.csv:51: the time 1 must be after 4.8",
        ),
        (
            format!("fit {nan}"),
            "nan.csv:51: the friction \"NaN\" is not a finite number",
        ),
        (
            format!("fit {word}"),
            "word.csv:51: the friction \"lost\" is not a finite number",
        ),
        (format!("fit {short}"), "the window has 11 samples"),
        (format!("fit {still}"), "has no step of velocity"),
        (format!("fit {gap}"), "a gap from"),
        (
            format!("fit {unit}"),
            "the unit \"furlongs\" of the column time is none of",
        ),
        (format!("fit {bare}"), "which column is the time?"),
        (format!("fit {empty}"), "has no rows of numbers"),
        (
            format!("fit {good} --friction strength"),
            "has the columns time, displacement, friction",
        ),
        (format!("fit {good} --friction 7"), "has 3 columns"),
        (format!("fit {good} --from 5 --to 5.5"), "the window has"),
        (format!("fit {good} --law sliip"), "slip"),
        (
            format!("fit {good} --law slip --free residual_strength"),
            "the law slip has the parameters",
        ),
        (
            format!("fit {good} --law slip --healing-time 5"),
            "--healing-time is no parameter of the law slip",
        ),
        (format!("fit {good} --states 3"), "1 or 2"),
        (
            format!("fit {good} --stiffness 1e9"),
            "needs the --normal-stress",
        ),
        (
            format!("fit {good} --stiffness 5/furlong"),
            "friction per length",
        ),
        (format!("fit {good} --bounds slip_length=5:1"), "A below B"),
        (format!("fit {good} --bounds slip_length=-5:1"), "positive"),
        (
            format!("fit {good} --bounds residual_strength=1:2"),
            "is not fitted",
        ),
        (format!("fit {good} --loss quadratic"), "linear"),
        (
            format!("fit {good} --program 20:1e-5 --load-point recorded"),
            "one or the other",
        ),
        (format!("fit {good} --report page.txt"), ".html"),
        ("fit".into(), "the file of the record is missing"),
        ("fit nowhere.csv".into(), "nowhere.csv"),
    ] {
        refused_in_one_line(&words, says);
    }
}
