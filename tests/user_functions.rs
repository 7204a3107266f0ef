//! Zeros of the user's functions along branches and curves: against closed forms, against curves and landings found otherwise.

use crate::command;
use command::{Ended, folder, object, refused_in_one_line, run};
use serde_json::Value;
use std::f64::consts::{LN_2, TAU};
use std::fs;
use std::path::Path;

/// Orbits of amplitude sqrt(mu) and period 2 pi/(1 + b mu).
const HOPF: &str = r#"
name = "Hopf normal form"
states = ["x", "y"]
[parameters]
mu = -0.5
b = 0.7
[rates]
x = "mu*x - y - (x + b*y)*(x^2 + y^2)"
y = "x + mu*y - (y - b*x)*(x^2 + y^2)"
[start]
x = 0.0
y = 0.0
"#;
/// A fold at mu = 0.
const FOLD: &str = r#"
name = "Fold"
states = ["x"]
[parameters]
mu = 1.0
[rates]
x = "mu - x^2"
[start]
x = 1.0
"#;
/// Hopf points on mu = s^2, of the frequency 1 + s; folds of equilibria in z on s = 0.
const CURVE: &str = r#"
name = "A curve of Hopf points"
states = ["x", "y", "z"]
[parameters]
mu = 0.0
s = 1.0
[rates]
x = "(mu - s^2)*x - (1 + s)*y - x*(x^2 + y^2)"
y = "(1 + s)*x + (mu - s^2)*y - y*(x^2 + y^2)"
z = "s - z"
[start]
x = 0.0
y = 0.0
z = 1.0
"#;

/// Orbits of radius r with mu + a r^2 = r^4 and the period 2 pi/(1 + r^2), with folds at 2 r^2 = a.
const FOLDS: &str = r#"
name = "Degenerate Hopf point"
states = ["x", "y"]
[parameters]
mu = 0.1
a = 1.0
[where]
q = "x^2 + y^2"
[rates]
x = "(mu + a*q - q^2)*x - (1 + q)*y"
y = "(1 + q)*x + (mu + a*q - q^2)*y"
[start]
x = 0.0
y = 0.0
"#;

fn written(folder: &Path, name: &str, text: &str) -> String {
    let path = folder.join(name);
    fs::write(&path, text).expect("a file");
    path.display().to_string()
}

/// The object of a command with these formulas, which may have spaces.
#[track_caller]
fn watching(arguments: &str, formulas: &[&str]) -> Value {
    let mut words: Vec<&str> = arguments.split_whitespace().collect();
    for formula in formulas {
        words.extend(["--watch", formula]);
    }
    words.extend(["--format", "json", "-q"]);
    let Ended { code, out, err } = run(&words);
    assert!([0, 3].contains(&code), "{arguments}: {err}");
    serde_json::from_str(&out).expect("JSON")
}

/// The zeros that were found, as their notes and a number with its bound.
fn zeros(made: &Value, name: &str) -> Vec<(String, f64, f64)> {
    let all = made["result"]["special"]
        .as_array()
        .expect("special points");
    let users = all.iter().filter(|one| one["label"] == "UF");
    let number = |of: &Value| of.as_f64().expect("a number");
    users
        .map(|one| {
            assert_eq!(one["name"], "user function");
            let at = &one[name];
            let note = one["note"].as_str().expect("a note");
            (
                note.to_owned(),
                number(&at["value"]),
                number(&at["uncertainty"]),
            )
        })
        .collect()
}

/// That the zeros are these, each within its bound, which is at most this part of the value.
#[track_caller]
fn zeros_are(made: &Value, name: &str, wanted: &[(&str, f64)]) {
    const BOUND: f64 = 1e-12;
    let found = zeros(made, name);
    let mut left = found.clone();
    for (note, exact) in wanted {
        let here = |one: &(String, f64, f64)| one.0 == *note && (one.1 - exact).abs() < 1e-9;
        let place = left.iter().position(here);
        let place = place.unwrap_or_else(|| panic!("{note} at {exact}: {found:?}"));
        let (_, value, bound) = left.remove(place);
        let rounding = f64::EPSILON * exact.abs();
        assert!(
            (value - exact).abs() <= bound + rounding,
            "{note}: {value} +- {bound}, {exact}"
        );
        assert!(bound <= BOUND * exact.abs().max(1.0), "{note}: {bound}");
    }
    assert!(left.is_empty(), "more than was to be found: {left:?}");
}

#[test]
fn zeros_on_a_branch_of_orbits_are_those_of_closed_forms() {
    let folder = folder("user-functions-orbits");
    let system = written(&folder, "hopf.toml", HOPF);
    let made = watching(
        &format!("branch orbits --system {system} --along mu=-0.5:2"),
        &[
            "x_max = 1.2",
            "period - 5",
            "mu*(x_max - x_min) - 1",
            // Zero throughout, zero nowhere, and zero without another sign behind it.
            "x_max + x_min",
            "period + mu",
            "(x_max - 0.9)^2",
        ],
    );
    let wanted = [
        ("x_max = 1.2", 1.44),
        ("period - 5 = 0", (TAU / 5.0 - 1.0) / 0.7),
        ("mu*(x_max - x_min) - 1 = 0", 0.25_f64.cbrt()),
    ];
    zeros_are(&made, "mu", &wanted);
    assert_eq!(made["numerics"]["watch"][0], "x_max = 1.2");
    let rows = made["result"]["rows"].as_array().expect("rows");
    let users = rows.iter().filter(|row| row["label"] == "UF").count();
    assert_eq!(users, 3);
}

#[test]
fn zeros_on_branches_of_equilibria_are_those_of_closed_forms() {
    let folder = folder("user-functions-equilibria");
    let system = written(&folder, "fold.toml", FOLD);
    let made = watching(
        &format!("branch equilibria --system {system} --along mu=-1:4 --box x=-3:3"),
        &[
            "x = 1.5",
            "exp(x) - 0.5",
            // On both sides of the fold, much nearer to each other than steps are long.
            "1e9*(mu - 1e-6)",
            "1e-9*(x - 0.01)",
            "(x - 0.7)^2",
            "x^2",
        ],
    );
    let wanted = [
        ("exp(x) - 0.5 = 0", LN_2 * LN_2),
        ("1e9*(mu - 1e-6) = 0", 1e-6),
        ("1e9*(mu - 1e-6) = 0", 1e-6),
        ("1e-9*(x - 0.01) = 0", 1e-4),
        ("x = 1.5", 2.25),
    ];
    zeros_are(&made, "mu", &wanted);
}

#[test]
fn zeros_on_a_curve_of_hopf_points_may_be_of_the_period() {
    let folder = folder("user-functions-curve");
    let system = written(&folder, "curve.toml", CURVE);
    let made = watching(
        &format!("locus hopf --system {system} --in mu,s --range mu=0.01:4 --range s=0.1:2"),
        &["period = 4", "z*mu - 1", "mu - s^2"],
    );
    let s = TAU / 4.0 - 1.0;
    zeros_are(&made, "s", &[("period = 4", s), ("z*mu - 1 = 0", 1.0)]);
    zeros_are(&made, "mu", &[("period = 4", s * s), ("z*mu - 1 = 0", 1.0)]);
}

/// Of two interfaces of which V_H and K may vary, by other ways: landings on values.
#[test]
fn zeros_of_interfaces_are_where_landings_say() {
    let branch = "branch orbits --stiffness 0.14 --from 185 --to 192 --symmetry symmetric";
    let landed = object(&format!("{branch} --at 188"));
    let rows = landed["result"]["rows"].as_array().expect("rows");
    let row = rows.iter().find(|row| row["label"] == "UZ").expect("UZ");
    let number = |name: &str| row[name].as_f64().expect("a number");
    // Rows have some six digits of extremes and all of the period.
    let period = format!("period = {:?}", number("period"));
    let drop = format!(
        "stress_max - stress_min = {:?}",
        number("stress_max") - number("stress_min")
    );
    let made = watching(branch, &[&period, &drop, "state_2 - state_1"]);
    let found = zeros(&made, "driving");
    assert_eq!(found.len(), 2, "{found:?}");
    for (note, driving, bound) in &found {
        let is_period = note.starts_with("period");
        let within = if is_period { bound + 1e-10 } else { 1e-2 };
        assert!(
            (driving - 188.0).abs() < within,
            "{note}: {driving} +- {bound}"
        );
        assert!(*bound < 1e-10 * driving, "{note}: {bound}");
    }
    // Equilibria, which without functions are followed by closed forms.
    let along = "branch equilibria --stiffness 0.14 --from 180 --to 250";
    let made = watching(
        along,
        &[
            "slip_rate_1 = 100",
            "driving - 200",
            "slip_rate_2 - slip_rate_1",
        ],
    );
    let found = zeros(&made, "driving");
    // Both slide with half of V_H, or one of them does; V_H itself is on both branches.
    assert_eq!(found.len(), 3, "{found:?}");
    for (note, driving, bound) in &found {
        let near = (driving - 200.0).abs() <= bound + 1e-13 && *bound < 1e-9;
        assert!(near, "{note}: {driving} +- {bound}");
    }
    let along = "branch equilibria --along stiffness --driving 200 --from 0.1 --to 1";
    let made = watching(along, &["stiffness*stress = 2"]);
    let rows = made["result"]["rows"].as_array().expect("rows");
    let stress = rows[0]["stress"].as_f64().expect("a number");
    let (_, stiffness, bound) = zeros(&made, "stiffness").remove(0);
    assert!(
        (stiffness - 2.0 / stress).abs() <= bound && bound < 1e-12,
        "{stiffness} +- {bound}"
    );
    let si = "branch orbits --si --stiffness 5.43e9 --from 1.8e-4 --to 2e-4 --symmetry symmetric";
    let made = watching(si, &["driving = 1.85e-4"]);
    let (_, driving, bound) = zeros(&made, "driving").remove(0);
    assert!(
        (driving - 1.85e-4).abs() <= bound + 1e-18,
        "{driving} +- {bound}"
    );
}

#[test]
fn a_formula_that_is_wrong_is_refused_in_one_sentence() {
    let folder = folder("user-functions-refused");
    let system = written(&folder, "fold.toml", FOLD);
    let base = format!("branch equilibria --system {system} --along mu=-1:4 --watch");
    for (formula, sentence) in [
        ("q", "letter 1: \"q\" has no value here; there are mu, x"),
        ("x+", "letter 3: the formula ends"),
        ("2+mux", "letter 3: \"mux\" has no value here"),
        ("1+1", "names nothing that varies"),
        ("x=1=2", "letter 4: a second `=`"),
        ("x*sin", "\"sin\" is a function"),
        ("period", "\"period\" has no value here"),
    ] {
        refused_in_one_line(&format!("{base} {formula}"), sentence);
    }
    let system = written(&folder, "hopf.toml", HOPF);
    let base = format!("branch orbits --system {system} --along mu=-0.5:2 --watch");
    refused_in_one_line(
        &format!("{base} x-1"),
        "x varies along an orbit and has no one value",
    );
    let many = "branch equilibria --stiffness 0.14 --interfaces 4 --watch stress";
    refused_in_one_line(many, "say by --clusters which ones slide alike");
}

#[test]
fn a_scene_may_have_several_formulas() {
    let folder = folder("user-functions-scene");
    let system = written(&folder, "hopf.toml", HOPF);
    let scene = format!(
        "command = \"branch\"\nof = \"orbits\"\nsystem = {system:?}\nalong = \"mu=-0.5:2\"\nwatch = [\"max(x_max, 1) = 1.2\", \"period - 5\"]\n"
    );
    let scene = written(&folder, "scene.toml", &scene);
    let made = watching(&format!("run {scene}"), &[]);
    let wanted = [
        ("max(x_max, 1) = 1.2", 1.44),
        ("period - 5 = 0", (TAU / 5.0 - 1.0) / 0.7),
    ];
    zeros_are(&made, "mu", &wanted);
}

#[test]
fn a_second_method_finds_the_zeros_too() {
    let folder = folder("user-functions-crosscheck");
    let system = written(&folder, "hopf.toml", HOPF);
    let along = format!("branch orbits --system {system} --along mu=-0.5:2 --crosscheck rodas5p");
    let made = watching(&along, &["x_max = 1.2"]);
    let all = made["result"]["special"]
        .as_array()
        .expect("special points");
    let zero = all.iter().find(|one| one["label"] == "UF").expect("a zero");
    let apart = zero["crosscheck"]["mu_difference"].as_f64();
    assert!(apart.expect("a number").abs() < 1e-10, "{zero}");
}

/// The special points of this label, as two numbers with their bounds.
fn labelled(made: &Value, label: &str, names: [&str; 2]) -> Vec<[(f64, f64); 2]> {
    let all = made["result"]["special"]
        .as_array()
        .expect("special points");
    let wanted = all.iter().filter(|one| one["label"] == label);
    let number = |of: &Value| of.as_f64().expect("a number");
    wanted
        .map(|one| {
            names.map(|name| {
                (
                    number(&one[name]["value"]),
                    number(&one[name]["uncertainty"]),
                )
            })
        })
        .collect()
}

#[track_caller]
fn is(made: [(f64, f64); 2], exact: [f64; 2]) {
    for ((value, bound), exact) in made.into_iter().zip(exact) {
        let rounding = 2.0 * f64::EPSILON * exact.abs();
        assert!(
            (value - exact).abs() <= bound + rounding,
            "{value} +- {bound}, not {exact}"
        );
        assert!(bound < 1e-11, "{bound}");
    }
}

#[test]
fn orbits_of_one_period_and_of_one_amplitude_are_curves() {
    let folder = folder("user-functions-held");
    let system = written(&folder, "hopf.toml", HOPF);
    let plane =
        format!("locus orbits --system {system} --in mu,b --range mu=-0.1:3 --range b=0.05:2");
    let hold = |hold: &str, formulas: &[&str]| {
        let arguments = format!("{plane} --hold={hold}");
        watching(&arguments, formulas)
    };
    let made = hold("period=5", &["x_max = 1.2"]);
    let product = TAU / 5.0 - 1.0;
    let names = ["mu", "b"];
    is(labelled(&made, "UF", names)[0], [1.44, product / 1.44]);
    let mut ends = labelled(&made, "EP", names);
    ends.sort_by(|a, b| a[0].0.total_cmp(&b[0].0));
    assert_eq!(ends.len(), 2);
    is(ends[0], [product / 2.0, 2.0]);
    is(ends[1], [3.0, product / 3.0]);
    let rows = made["result"]["rows"].as_array().expect("rows");
    assert!(rows.len() > 5);
    for row in rows {
        let number = |name: &str| {
            let of = &row[name];
            of.as_f64().or(of["value"].as_f64()).expect("a number")
        };
        assert!((number("mu") * number("b") - product).abs() < 1e-9, "{row}");
        assert!((number("period") - 5.0).abs() < 1e-9, "{row}");
    }
    assert_eq!(made["numerics"]["hold"], "period=5");
    // An amplitude is sqrt(mu), whatever b is.
    let made = hold("x_max-x_min=2", &[]);
    let ends = labelled(&made, "EP", names);
    assert_eq!(ends.len(), 2);
    assert!(
        ends.iter()
            .all(|end| (end[0].0 - 1.0).abs() <= end[0].1 + 1e-15),
        "{ends:?}"
    );
}

#[test]
fn a_curve_of_one_period_ends_at_the_hopf_point_of_that_period() {
    let folder = folder("user-functions-shrinks");
    let system = written(&folder, "curve.toml", CURVE);
    let ranges = "--in mu,s --range mu=0.01:4 --range s=0.1:2";
    let made = watching(
        &format!("locus orbits --system {system} {ranges} --hold period=4"),
        &[],
    );
    let s = TAU / 4.0 - 1.0;
    let names = ["mu", "s"];
    is(labelled(&made, "HB", names)[0], [s * s, s]);
    is(labelled(&made, "EP", names)[0], [4.0, s]);
}

#[test]
fn multipliers_that_come_to_the_unit_circle_are_met_at_a_held_period() {
    let folder = folder("user-functions-folds");
    let system = written(&folder, "folds.toml", FOLDS);
    let ranges = "--in mu,a --range mu=-2:0.5 --range a=0.6:3.1";
    let period = format!("period={:?}", TAU / 2.0);
    let made = watching(
        &format!("locus orbits --system {system} {ranges} --hold {period}"),
        &[],
    );
    let folds = labelled(&made, "SN", ["mu", "a"]);
    assert_eq!(folds.len(), 1);
    is(folds[0], [-1.0, 2.0]);
}

#[test]
fn what_is_held_belongs_to_orbits() {
    let folder = folder("user-functions-held-refused");
    let system = written(&folder, "hopf.toml", HOPF);
    let plane = format!("--system {system} --in mu,b --range mu=0.1:3 --range b=0.05:2");
    refused_in_one_line(
        &format!("locus orbits {plane}"),
        "say by --hold what the orbits",
    );
    refused_in_one_line(
        &format!("locus hopf {plane} --hold period=5"),
        "belongs to a curve of orbits",
    );
    refused_in_one_line(
        &format!("locus orbits {plane} --hold perod=5"),
        "\"perod\" has no value here",
    );
    refused_in_one_line("locus orbits", "say by --hold what the orbits");
}
