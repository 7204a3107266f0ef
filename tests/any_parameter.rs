//! Branches and curves of systems from files, in any of their parameters, against closed forms and the literature.

use crate::command;
use crate::common::text::{file, near};
use command::{csv, folder, number, object, refused_in_one_line, twinslip};
use serde_json::Value;
use std::fs;

/// y' = p + q y - y^3: folds on 27 p^2 = 4 q^3, with a cusp.
const CUSP: &str = "name = \"Cusp\"\nstates = [\"y\"]\n[parameters]\np = 0.1\nq = 1.0\n[rates]\ny = \"p + q*y - y^3\"\n";

/// The normal form of Bogdanov and Takens (Kuznetsov 2004, (8.49)): folds at p = 0, Hopf points on p = -q^2 with q > 0.
const TAKENS: &str = "name = \"Takens\"\nstates = [\"x\", \"y\"]\n[parameters]\np = -0.5\nq = 0.5\n[rates]\nx = \"y\"\ny = \"p + q*y + x^2 + x*y\"\n";

/// The special points of a label.
fn special<'o>(made: &'o Value, label: &str) -> Vec<&'o Value> {
    let all = made["result"]["special"].as_array().expect("a list");
    all.iter().filter(|one| one["label"] == label).collect()
}

/// A number with its budget holds an exact one, and is sharp.
#[track_caller]
fn holds(one: &Value, name: &str, exact: f64, sharp: f64) {
    let value = number(one, &format!("/{name}/value"));
    let uncertainty = number(one, &format!("/{name}/uncertainty"));
    let off = (value - exact).abs();
    assert!(
        off <= uncertainty + f64::EPSILON * exact.abs(),
        "{name}: {value} +- {uncertainty} for {exact}"
    );
    assert!(
        uncertainty <= sharp * (1.0 + exact.abs()),
        "{name}: +- {uncertainty}"
    );
}

#[test]
fn the_lorenz_equilibria_are_all_found_with_their_pitchfork_and_hopf_points() {
    for search in ["", "--box x=-100:100,y=-100:100,z=-10:100"] {
        let made = object(&format!(
            "branch equilibria --system lorenz --along r --from 0.5 --to 40 {search}"
        ));
        for one in special(&made, "BP") {
            holds(one, "r", 1.0, 1e-13);
        }
        assert!(!special(&made, "BP").is_empty());
        assert!(special(&made, "LP").is_empty());
        let hopf = special(&made, "HB");
        assert_eq!(hopf.len(), 2);
        for one in hopf {
            holds(one, "r", 470.0 / 19.0, 1e-11);
            // omega^2 = b (s + r)
            let omega = (8.0 / 3.0 * (10.0 + 470.0 / 19.0_f64)).sqrt();
            holds(one, "period", std::f64::consts::TAU / omega, 1e-11);
            assert_eq!(one["criticality"], "subcritical");
        }
        // At r = 28 and 40 all three, the origin unstable.
        let rows = made["result"]["rows"].as_array().expect("rows");
        let ends: Vec<f64> = rows
            .iter()
            .filter(|row| row["r"] == 40.0 && row["label"] == "EP")
            .map(|row| number(row, "/x"))
            .collect();
        assert_eq!(ends.len(), 3);
        let exact = (8.0 / 3.0 * 39.0_f64).sqrt();
        for x in [-exact, 0.0, exact] {
            assert!(ends.iter().any(|end| (end - x).abs() < 1e-10), "{x}");
        }
    }
}

#[test]
fn the_orbits_of_a_nerve_fold_alike_at_both_ends() {
    let made = object("branch orbits --system fitzhugh-nagumo --along I --from -1 --to 2 --at 0.5");
    // v = +-sqrt(1 - eps b) at the Hopf points, and the system is symmetric about I = a / b = 0.875.
    let v = -(1.0_f64 - 0.08 * 0.8).sqrt();
    let exact = (v + 0.7) / 0.8 - v + v.powi(3) / 3.0;
    let hopf = special(&made, "HB");
    assert_eq!(hopf.len(), 2);
    holds(hopf[0], "I", exact, 1e-13);
    holds(hopf[1], "I", 1.75 - exact, 1e-13);
    let folds = special(&made, "SN");
    assert_eq!(folds.len(), 2);
    let [first, second] = [0, 1].map(|i| number(folds[i], "/I/value"));
    let [by, more] = [0, 1].map(|i| number(folds[i], "/I/uncertainty"));
    assert!((first + second - 1.75).abs() <= by + more + 1e-15);
    assert!(by < 1e-13);
    // Landed on, the orbit is that of the command for one.
    let row = made["result"]["rows"].as_array().expect("rows");
    let row = row.iter().find(|row| row["label"] == "UZ").expect("0.5");
    assert_eq!(row["I"], 0.5);
    let one = object("orbit --system fitzhugh-nagumo --set I=0.5 --start=-1,1 --crosscheck none");
    near(
        number(row, "/period"),
        number(&one, "/result/orbit/period/value"),
        1e-12,
    );
    near(
        number(row, "/v_max"),
        number(&one, "/result/orbit/extremes/v/max/value"),
        1e-6,
    );
}

#[test]
fn the_roessler_cascade_begins_where_it_is_known_to() {
    let made = object(
        "branch orbits --system roessler --along c --from 2.5 --to 4.5 --start=-3,0,0.1 --doublings 2",
    );
    let doublings = special(&made, "PD");
    assert_eq!(doublings.len(), 3);
    // Each doubles the period, and the gaps shrink: by Feigenbaum's 4.669 at last.
    let c: Vec<f64> = doublings
        .iter()
        .map(|one| number(one, "/c/value"))
        .collect();
    assert!(
        (2.83..2.84).contains(&c[0]) && (3.83..3.84).contains(&c[1]),
        "{c:?}"
    );
    let ratio = (c[1] - c[0]) / (c[2] - c[1]);
    assert!((3.0..5.0).contains(&ratio), "{ratio}");
    for pair in doublings.windows(2) {
        let ratio = number(pair[1], "/period/value") / number(pair[0], "/period/value");
        assert!((1.9..2.1).contains(&ratio), "{ratio}");
    }
    for one in &doublings {
        assert!(number(one, "/c/uncertainty") < 1e-12);
        assert_eq!(one["criticality"], "supercritical");
    }
    // The same point on the curve in both parameters.
    let curve = object(
        "locus period-doubling --system roessler --in c,a --range c=2.4,3.4 --range a=0.18,0.22 --at a=0.2 --start=-3,0,0.1",
    );
    let landed = special(&curve, "UZ");
    assert_eq!(landed.len(), 1);
    let off = number(landed[0], "/c/value") - c[0];
    assert!(off.abs() < 1e-12, "{off}");
}

#[test]
fn curves_of_folds_and_hopf_points_go_where_closed_forms_say() {
    let path = file("cusp_curve", CUSP);
    let made = object(&format!(
        "locus saddle-node --system {path} --in p,q --range p=-1,1 --range q=-1,2 --at q=0.5 --at p=0.25 --box y=-3:3"
    ));
    let cusps = special(&made, "CP");
    assert_eq!(cusps.len(), 1);
    holds(cusps[0], "p", 0.0, 1e-12);
    holds(cusps[0], "q", 0.0, 1e-12);
    for row in made["result"]["rows"].as_array().expect("rows") {
        let [p, q] = ["p", "q"].map(|name| number(row, &format!("/{name}/value")));
        near(27.0 * p * p, 4.0 * q.powi(3), 1e-11);
    }
    // Two crossings of q = 0.5 and one of p = 0.25.
    assert_eq!(special(&made, "UZ").len(), 3);
    // b = 1 + a^2, the brusselator's.
    let made = object(
        "locus hopf --system brusselator --in b,a --range b=0.5,9 --range a=0.5,2.5 --at a=1,2",
    );
    for row in made["result"]["rows"].as_array().expect("rows") {
        let [a, b] = ["a", "b"].map(|name| number(row, &format!("/{name}/value")));
        near(b, 1.0 + a * a, 1e-12);
        assert_eq!(row["criticality"], "supercritical");
    }
    assert_eq!(special(&made, "UZ").len(), 2);
}

#[test]
fn curves_that_lie_along_a_parameter_and_begin_at_a_special_point_are_followed() {
    let path = file("takens_curve", TAKENS);
    // In the last range a curve is looked for at q = 0, exactly at the point where both begin.
    for from in [-1.0, -0.7, -0.4967] {
        let to = if from == -1.0 { 1.0 } else { from + 1.0 };
        let ranges = format!("--range q={from},{to} --range p=-1,0.5 --box x=-3:3,y=-3:3");
        for plane in ["p,q", "q,p"] {
            let made = |curve: &str| {
                object(&format!(
                    "locus {curve} --system {path} --in {plane} {ranges}"
                ))
            };
            let (folds, hopf) = (made("saddle-node"), made("hopf"));
            for (made, ends) in [(&folds, 2), (&hopf, 1)] {
                let double = special(made, "BT");
                assert_eq!(double.len(), 1, "{plane} {ranges}");
                holds(double[0], "p", 0.0, 1e-11);
                holds(double[0], "q", 0.0, 1e-11);
                assert_eq!(special(made, "EP").len(), ends, "{plane} {ranges}");
                assert!(special(made, "MX").is_empty(), "{plane} {ranges}");
            }
            let rows = |made: &Value| made["result"]["rows"].as_array().expect("rows").clone();
            for row in rows(&folds) {
                near(number(&row, "/p/value"), 0.0, 1e-12);
            }
            assert!(rows(&hopf).len() > 5);
            for row in rows(&hopf) {
                let [p, q] = ["p", "q"].map(|name| number(&row, &format!("/{name}/value")));
                near(p, -q * q, 1e-12);
                assert!(q > -1e-9, "beyond the end there are neutral saddles: {q}");
            }
        }
    }
}

/// Shil'nikov, A., Nicolis, G. and Nicolis, C. (1995). Bifurcation and predictability analysis of a low-order atmospheric circulation
/// model. Int. J. Bifurcation and Chaos 5, 1701-1711: the curves of folds and of Hopf points touch at (1.684, 1.683).
#[test]
fn both_curves_of_the_westerlies_meet_at_a_zero_hopf_point() {
    let ranges = "--range F=0.1,4 --range G=0.2,3 --box x=-10:10,y=-10:10,z=-10:10";
    let found = ["saddle-node", "hopf"].map(|curve| {
        let made = object(&format!(
            "locus {curve} --system lorenz-84 --in F,G {ranges}"
        ));
        let points = special(&made, "ZH");
        assert_eq!(points.len(), 1, "{curve}");
        ["F", "G"].map(|name| {
            ["value", "uncertainty"].map(|part| number(points[0], &format!("/{name}/{part}")))
        })
    });
    for (i, known) in [1.684, 1.683].into_iter().enumerate() {
        let [[first, by], [second, more]] = [found[0][i], found[1][i]];
        assert!((first - known).abs() < 5e-4, "{first}");
        assert!((first - second).abs() <= by + more, "{first}, {second}");
        assert!(by + more < 1e-11);
    }
}

#[test]
fn a_file_of_rows_is_gone_on_with_and_ends_the_same() {
    let place = folder("general_resumed");
    let path = place.join("whole.csv");
    let command = "branch equilibria --system lorenz --along r --from 0.5 --to 40 -q";
    assert_eq!(
        twinslip(&format!("{command} -o {}", path.display())).code,
        0
    );
    let whole = fs::read_to_string(&path).expect("rows");
    let header = &csv(&whole)[0];
    assert_eq!(header[..4], ["r", "x", "y", "z"]);
    let points = fs::read_to_string(place.join("whole.special.csv")).expect("special points");
    assert_eq!(csv(&points)[0][3..5], ["r", "r_uncertainty"]);
    for part in [whole.len() / 3, whole.len() * 2 / 3, whole.len() - 5] {
        let torn = place.join("torn.csv");
        fs::write(&torn, &whole[..part]).expect("written");
        fs::copy(
            place.join("whole.special.csv"),
            place.join("torn.special.csv"),
        )
        .expect("copied");
        let ended = twinslip(&format!("{command} --resume {}", torn.display()));
        assert_eq!((ended.code, ended.err.as_str()), (0, ""), "{part}");
        let again = fs::read_to_string(&torn).expect("rows");
        assert_eq!(csv(&again), csv(&whole), "{part} bytes were there");
        let special = fs::read_to_string(place.join("torn.special.csv")).expect("special points");
        assert_eq!(csv(&special), csv(&points));
    }
    // Pictures of both.
    for (picture, command) in [
        ("branch.svg", command.to_owned()),
        (
            "curve.svg",
            "locus hopf --system brusselator --in b,a --range b=0.5,9 --range a=0.5,2.5 -q"
                .to_owned(),
        ),
    ] {
        let path = place.join(picture);
        assert_eq!(
            twinslip(&format!("{command} --plot {}", path.display())).code,
            0
        );
        let svg = fs::read_to_string(path).expect("a picture");
        assert!(svg.contains("<svg"));
    }
}

#[test]
fn what_makes_no_branch_is_refused_in_one_sentence() {
    let branch = "branch equilibria --system lorenz";
    for (words, sentence) in [
        ("", "say which parameter varies"),
        (
            "--along q --from 1 --to 2",
            "along is q, but must be s, r or b",
        ),
        ("--along r --to 2", "--from is missing"),
        ("--along r --from 2 --to 2", "two different ends"),
        ("--along r --from 1 --to 2 --at 3", "must be in the range"),
        ("--along r --from 1 --to 2 --at x", "is not a finite number"),
        ("--along r --from 1 --to 2 --box x=1:2", "has no range of y"),
        ("--along r --from 1 --to 2 --start 1", "must have 3 values"),
    ] {
        refused_in_one_line(&format!("{branch} {words}"), sentence);
    }
    let locus = "locus hopf --system lorenz";
    for (words, sentence) in [
        ("", "say which two parameters vary"),
        ("--in r", "must be two different parameters"),
        ("--in r,r", "must be two different parameters"),
        ("--in r,q", "in is q, but must be s, r or b"),
        ("--in r,b", "range"),
        ("--in r,b --range r=1,2 --range b=1", "must be two numbers"),
        (
            "--in r,b --range r=1,2 --range s=1,2",
            "range is s, but must be r or b",
        ),
        (
            "--in r,b --range r=1,2 --range b=1,2 --at r=7",
            "must be in the range",
        ),
    ] {
        refused_in_one_line(&format!("{locus} {words}"), sentence);
    }
    refused_in_one_line(
        "locus pitchfork --system lorenz --in r,b --range r=1,2 --range b=1,2",
        "needs a symmetry",
    );
    // What is no wrong input: there is nothing in this range.
    let ended = twinslip("branch orbits --system brusselator --along b --from 0.5 --to 1 -q");
    assert_eq!(ended.code, 1, "{}", ended.err);
    assert!(
        ended.err.contains("there is no Hopf point"),
        "{}",
        ended.err
    );
}

#[test]
fn a_scene_has_the_ranges_in_a_table() {
    let place = folder("general_scene");
    let scene = place.join("scene.toml");
    let text = "command = \"locus\"\nof = \"hopf\"\nsystem = \"brusselator\"\nin = \"b,a\"\nrange = { b = [0.5, 9], a = [0.5, 2.5] }\nat = { a = [1, 2] }\nformat = \"json\"\n";
    fs::write(&scene, text).expect("a file");
    let ended = command::run(&["run", scene.to_str().expect("a path"), "-q"]);
    assert_eq!(ended.code, 0, "{}", ended.err);
    let made: Value = serde_json::from_str(&ended.out).expect("JSON");
    let flags = object(
        "locus hopf --system brusselator --in b,a --range b=0.5,9 --range a=0.5,2.5 --at a=1,2",
    );
    assert_eq!(made["result"], flags["result"]);
    assert_eq!(special(&made, "UZ").len(), 2);
}
