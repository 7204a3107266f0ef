//! Records as laboratories write them: units, numbers, names; and what is refused of them.

use super::command::{folder, object, refused_in_one_line, run, twinslip};
use serde_json::Value;
use std::fs;

/// What a sample is in a file: its cells from t in s, x in m and mu.
type Cells = fn(f64, f64, f64) -> Vec<String>;

const TRUTH: [(&str, f64); 3] = [
    ("direct_effect", 0.01),
    ("evolution_effect", 0.013),
    ("slip_length", 1e-5),
];

/// A step of velocity by a factor of ten of the slip law on a rigid apparatus, which is a closed form.
pub fn samples() -> impl Iterator<Item = (f64, f64, f64)> {
    let [(_, a), (_, b), (_, length)] = TRUTH;
    (0..400).map(move |i| {
        let t = 0.1 * f64::from(i);
        let since = t - 20.0;
        let noise = 1e-5 * (12.9898 * f64::from(i)).sin() * (78.233 * f64::from(i)).cos();
        if since <= 0.0 {
            return (t, 1e-6 * t, 0.6 + noise);
        }
        let decay = (-1e-5 * since / length).exp();
        let log = 10.0_f64.ln();
        (
            t,
            2e-5 + 1e-5 * since,
            0.6 + a * log + b * log * (decay - 1.0) + noise,
        )
    })
}

fn written(header: &str, between: &str, cells: Cells) -> String {
    let rows = samples().map(|(t, x, mu)| cells(t, x, mu).join(between));
    rows.fold(header.to_owned(), |text, row| text + &row + "\n")
}

pub fn fitted(path: &std::path::Path, options: &[&str]) -> Value {
    let name = path.to_str().expect("a name");
    let mut words = vec!["fit", name, "--law=slip", "--intervals=linear"];
    words.extend(["--free=direct_effect,evolution_effect,slip_length,reference_friction"]);
    words.extend(["--stiffness=0.5/um", "--format=json", "-q"]);
    words.extend(options);
    let ended = run(&words);
    assert_eq!(ended.code, 0, "{name}: {}", ended.err);
    let object: Value = serde_json::from_str(&ended.out).expect("JSON");
    object["result"].clone()
}

pub fn is_the_truth(name: &str, result: &Value) {
    let all = result["fit"]["parameters"].as_array().expect("a list");
    for (parameter, truth) in TRUTH {
        let own = all.iter().find(|one| one["name"] == parameter).expect("it");
        let off = own["value"].as_f64().expect("a number") / truth - 1.0;
        assert!(off.abs() < 0.02, "{name} {parameter}: {off:e}");
    }
}

pub fn shown(values: &[f64]) -> Vec<String> {
    values.iter().map(f64::to_string).collect()
}

pub fn comma(values: &[f64]) -> Vec<String> {
    shown(values).iter().map(|x| x.replace('.', ",")).collect()
}

fn um(t: f64, x: f64, mu: f64) -> Vec<String> {
    shown(&[t, x * 1e6, mu])
}

fn um_comma(t: f64, x: f64, mu: f64) -> Vec<String> {
    comma(&[t, x * 1e6, mu])
}

#[test]
fn units_numbers_and_names_of_laboratories_are_read() {
    let folder = folder("fit_records");
    let files: [(&str, &str, &str, Cells); 23] = [
        ("suffix", "time_s,displacement_um,friction\n", ",", um),
        ("mm", "t_s,LP_disp_mm,mu\n", ",", |t, x, mu| {
            shown(&[t, x * 1e3, mu])
        }),
        ("words", "time s\tdisplacement um\tfriction\n", "\t", um),
        (
            "stress",
            "time_s,displacement (um),shear_stress_MPa,normal_stress_MPa\n",
            ",",
            |t, x, mu| shown(&[t, x * 1e6, mu * 20.0, 20.0]),
        ),
        (
            "effective",
            "Time [s]\tdisp [um]\tShear stress [MPa]\tEffective_Normal_stress [MPa]\n",
            "\t",
            |t, x, mu| shown(&[t, x * 1e6, mu * 20.0, 20.0]),
        ),
        (
            "semicolons",
            "Time (s);Displacement (um);Friction\n",
            ";",
            um_comma,
        ),
        (
            "tabs",
            "Time (s)\tDisplacement (um)\tFriction\n",
            "\t",
            um_comma,
        ),
        (
            "blanks",
            "Time (s)  Displacement (um)  Friction\n",
            "  ",
            um_comma,
        ),
        (
            "quoted",
            "\"time (s)\",\"displacement (um)\",\"friction\"\n",
            ",",
            |t, x, mu| {
                let cells = um(t, x, mu);
                cells.iter().map(|cell| format!("\"{cell}\"")).collect()
            },
        ),
        (
            "quoted commas",
            "\"time (s)\",\"displacement (um)\",\"friction\"\n",
            ",",
            |t, x, mu| {
                let cells = um_comma(t, x, mu);
                cells.iter().map(|cell| format!("\"{cell}\"")).collect()
            },
        ),
        (
            "fortran",
            "time displacement friction\n(s) (um) (-)\n",
            " ",
            |t, x, mu| {
                [t, x * 1e6, mu]
                    .iter()
                    .map(|x| format!("{x:e}").replace('e', "D"))
                    .collect()
            },
        ),
        (
            "greek",
            "time (s)\tdisplacement (\u{3bc}m)\t\u{3bc}\n",
            "\t",
            um,
        ),
        (
            "micro",
            "time (s)\tdisplacement (\u{b5}m)\t\u{b5}\n",
            "\t",
            um,
        ),
        (
            "title",
            "Experiment b12, basalt\ntime (s),displacement (um),friction\n",
            ",",
            um,
        ),
        (
            "long title",
            "b12, basalt, dry\ntime (s),displacement (um),friction\n",
            ",",
            um,
        ),
        (
            "title and units",
            "b12, basalt, dry\ntime,disp,mu\ns,um,-\n",
            ",",
            um,
        ),
        ("remark", "# time_s displacement_um friction\n", " ", um),
        (
            "brackets",
            "Time [s],LP displacement [um],friction\n",
            ",",
            um,
        ),
        ("short", "Time [s]\tLP disp [um]\tfriction\n", "\t", um),
        (
            "across",
            "Time [s]\tNormal disp [um]\tLP disp [um]\tfriction\n",
            "\t",
            |t, x, mu| shown(&[t, 3.0, x * 1e6, mu]),
        ),
        (
            "ratio",
            "time (s);load point displacement (um);shear/normal\n",
            ";",
            um,
        ),
        ("symbols", "t [s];lp [um];tau/sigma_n\n", ";", um),
        (
            "down",
            "time_s,displacement_um,friction\n",
            ",",
            |t, x, mu| shown(&[t, 7e3 - x * 1e6, mu]),
        ),
    ];
    for (name, header, between, cells) in files {
        let path = folder.join(name.replace(' ', "_") + ".txt");
        fs::write(&path, written(header, between, cells)).expect("a file");
        let result = fitted(&path, &[]);
        is_the_truth(name, &result);
        let says = result["notes"].as_array().expect("a list").len();
        assert_eq!(
            says,
            usize::from(name == "down"),
            "{name}: {}",
            result["notes"]
        );
    }
    // Latin-1, as instruments write it.
    let path = folder.join("latin.txt");
    let text = written("Time (s)\tDisplacement (\u{b5}m)\tFriction\n", "\t", um);
    let bytes: Vec<u8> = text.chars().map(|c| c as u8).collect();
    fs::write(&path, bytes).expect("a file");
    is_the_truth("latin", &fitted(&path, &[]));
    // A unit that is asked for.
    let path = folder.join("bare.txt");
    fs::write(&path, written("", " ", um)).expect("a file");
    let asked = ["--time=1", "--displacement=2 [um]", "--friction=3"];
    is_the_truth("bare", &fitted(&path, &asked));
}

#[test]
fn impossible_sizes_and_missing_values_are_refused() {
    let folder = folder("fit_sizes");
    let with = |name: &str, text: String| {
        let path = folder.join(name);
        fs::write(&path, text).expect("a file");
        path.display().to_string()
    };
    let um_text = written("time,displacement,friction\n", ",", um);
    let millimetres: Cells = |t, x, mu| shown(&[t, x * 1e3, mu]);
    let mm_text = written("time,displacement,friction\n", ",", millimetres);
    let stress: Cells = |t, x, mu| shown(&[t, x * 1e6, mu * 20.0]);
    let stress = written("time,displacement_um,shear stress\n", ",", stress);
    let missing = um_text.replace("time,displacement", "time,displacement_um");
    let lines: Vec<&str> = missing.lines().collect();
    let mut marked = lines.clone();
    marked[50] = "4.9,4.9,-9999";
    let marked = marked.join("\n");
    let mut lost = lines.clone();
    lost[50] = "4.9,-9999,0.6";
    let lost = lost.join("\n");
    let strange = missing.replace("displacement_um", "ram");
    for (text, says) in [
        (
            ("um.csv", um_text),
            "column displacement, states no unit, and would be",
        ),
        (
            ("mm.csv", mm_text),
            "column displacement, states no unit, and would be",
        ),
        (
            ("stress.csv", stress),
            "stress.csv:2: the friction, column shear stress, is 12",
        ),
        (
            ("marked.csv", marked),
            "marked.csv:51: the friction -9999 stands for one that is missing",
        ),
        (
            ("lost.csv", lost),
            "lost.csv:51: the displacement -9999 stands for one that is missing",
        ),
        (
            ("strange.csv", strange),
            "the columns are time, ram, friction",
        ),
    ] {
        let file = with(text.0, text.1);
        refused_in_one_line(&format!("fit {file} --law slip"), says);
    }
    // What may be metres is said to be taken so.
    let metres = written("time,displacement,friction\n", ",", |t, x, mu| {
        shown(&[t, x, mu])
    });
    let file = with("metres.csv", metres);
    let ended = twinslip(&format!(
        "fit {file} --law slip --intervals linear --stiffness 0.5/um -o {file}.out.csv"
    ));
    assert!(
        ended.err.contains("states no unit and is taken in m"),
        "{}",
        ended.err
    );
}

/// Friction that is noise answers to no step: what its steps suggest is beyond the law, and that is what is said.
#[test]
fn a_record_without_a_response_is_told_as_such() {
    let rows = (0..4000).map(|i| {
        let t = 0.1 * f64::from(i);
        let x = t.min(200.0) + 10.0 * (t - 200.0).max(0.0);
        let noise = 5e-4 * (12.9898 * f64::from(i)).sin() * (78.233 * f64::from(i)).cos();
        format!("{t},{x},{}\n", 0.6 + noise)
    });
    let text = rows.fold(
        "time_s,displacement_um,friction\n".to_owned(),
        |all, row| all + &row,
    );
    let file = folder("no-response").join("record.csv");
    fs::write(&file, text).expect("a file");
    let ended = twinslip(&format!("fit {}", file.display()));
    assert_eq!(ended.code, 1, "{}", ended.err);
    assert!(
        ended.err.contains("no response above its noise"),
        "{}",
        ended.err
    );
}

/// The values that `docs/fit.md` shows beside each other, by scipy 1.17's `curve_fit` around `odeint` at 1e-11, from two starts:
/// `python/benchmarks/fit_peers.py`.
#[test]
fn a_public_record_has_the_minima_that_scipy_finds() {
    let names = [
        "direct_effect",
        "evolution_effect",
        "slip_length",
        "stiffness",
        "reference_friction",
    ];
    let slip = [0.00920893, 0.00936141, 8.76126e-6, 1.319075e11, 0.607_809_2];
    let ageing = [0.00884182, 0.00897488, 6.53325e-6, 1.390475e11, 0.607_806_4];
    for (law, values) in [("slip", slip), ("ageing", ageing)] {
        let made = object(&format!(
            "fit tests/data/laboratory/basalt.txt --law {law} --from 11650 --to 11690"
        ));
        let all = made["result"]["fit"]["parameters"].as_array();
        for (one, (name, value)) in all.expect("a list").iter().zip(names.iter().zip(values)) {
            assert_eq!(one["name"], *name);
            let number = |key: &str| one[key].as_f64().expect("a number");
            let apart = (number("value") - value).abs() / number("uncertainty");
            assert!(apart < 2e-3, "{law} {name}: {apart} standard errors: {one}");
            // The standard error of white noise is that of scipy's covariance.
            assert!(number("widening") >= 1.0, "{one}");
        }
    }
}
