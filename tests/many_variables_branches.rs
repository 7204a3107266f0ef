//! Branches and curves of systems from formulas in more variables than most, with special points in closed form: Hopf points of Lorenz's ring of 1996 and of the
//! Brusselator in cells, folds, cusps and branch points of a ring of bistable cells; and orbits that a ring shares with a smaller one.

use super::many_variables::text;
use super::many_variables_orbits::{brusselator, within};
use crate::command::{object, twinslip};
use crate::common::text::file;
use serde_json::Value;
use std::f64::consts::{PI, TAU};

/// The special points of a command with this label.
fn special(command: &str, label: &str) -> Vec<Value> {
    let made = object(command);
    let all = made["result"]["special"].as_array().expect("a list");
    let those = all.iter().filter(|point| point["label"] == label);
    those.cloned().collect()
}

/// p + q x - x^3 in each of so many cells, along whose ring it diffuses.
fn cells(count: usize, coupling: f64) -> String {
    let names: Vec<String> = (0..count).map(|i| format!("x{i}")).collect();
    let (mut rates, mut start) = (String::new(), String::new());
    for i in 0..count {
        let (next, last) = ((i + 1) % count, (i + count - 1) % count);
        rates += &format!("x{i} = \"p + q*x{i} - x{i}^3 + k*(x{next} + x{last} - 2*x{i})\"\n");
        start += &format!("x{i} = -1.0\n");
    }
    format!(
        "name = \"bistable\"\nstates = {names:?}\n[parameters]\np = -0.1\nq = 1.0\nk = {coupling:?}\n[rates]\n{rates}[start]\n{start}"
    )
}

#[test]
fn the_hopf_points_of_a_ring_of_forty_are_those_of_a_circulant() {
    const COUNT: usize = 40;
    let path = file("many_variables_hopf", &text(COUNT, 0.5));
    let found = special(
        &format!("branch equilibria --system {path} --along F --from 0.5 --to 1.5"),
        "HB",
    );
    let angle = |k: usize| TAU * k as f64 / COUNT as f64;
    let hopf = |k: usize| {
        let forcing = 1.0 / (angle(k).cos() - angle(2 * k).cos());
        let omega = forcing * (angle(k).sin() + angle(2 * k).sin());
        (forcing, TAU / omega.abs())
    };
    let mut known: Vec<(f64, f64)> = (1..COUNT / 2).map(hopf).collect();
    known.retain(|(forcing, _)| (0.5..1.5).contains(forcing));
    known.sort_by(|a, b| a.0.total_cmp(&b.0));
    assert_eq!(found.len(), known.len());
    for (point, (forcing, period)) in found.iter().zip(known) {
        within(&point["F"], forcing, 1e-10);
        within(&point["period"], period, 1e-10);
        assert_eq!(point["criticality"], "supercritical");
    }
}

#[test]
fn the_hopf_points_of_cells_between_held_ends_are_those_of_their_waves() {
    const CELLS: usize = 10;
    let path = file("many_variables_waves", &brusselator(CELLS, 0.4, 0.0));
    let found = special(
        &format!("branch equilibria --system {path} --along L --from 0.3 --to 1.2"),
        "HB",
    );
    let squared = |wave: usize| {
        let size = (CELLS + 1) as f64;
        let sine = (PI * wave as f64 / (2.0 * size)).sin();
        4.0 * (size * sine).powi(2)
    };
    assert_eq!(found.len(), 2);
    for (wave, point) in (1..).zip(&found) {
        let length = (0.012 * squared(wave) / 0.45).sqrt();
        let slow = 4.0 + 0.004 * squared(wave) / length.powi(2);
        let omega = (4.0 * 5.45 - slow.powi(2)).sqrt();
        within(&point["L"], length, 1e-10);
        within(&point["period"], TAU / omega, 1e-10);
    }
    // Along the curve of the first wave, L^2 (B - 5) is the same.
    let curve = object(&format!(
        "locus hopf --system {path} --in L,B --range L=0.4,0.8 --range B=5.2,5.6"
    ));
    let rows = curve["result"]["rows"].as_array().expect("rows");
    let first = rows.iter().filter(|row| row["curve"] == 0);
    assert!(first.clone().count() > 3);
    for row in first {
        let of = |name: &str| match &row[name] {
            Value::Object(parts) => parts["value"].as_f64().expect("a number"),
            one => one.as_f64().expect("a number"),
        };
        let length = (0.012 * squared(1) / (of("B") - 5.0)).sqrt();
        assert!((of("L") - length).abs() < 1e-10, "{row}");
    }
}

#[test]
fn a_ring_of_bistable_cells_has_the_folds_and_the_cusp_of_one() {
    for count in [10, 30] {
        let path = file("many_variables_folds", &cells(count, 50.0));
        let folds = special(
            &format!("branch equilibria --system {path} --along p --from=-1 --to 1"),
            "LP",
        );
        let fold = 2.0 / 27.0_f64.sqrt();
        assert_eq!(folds.len(), 2);
        within(&folds[0]["p"], fold, 1e-10);
        within(&folds[1]["p"], -fold, 1e-10);
    }
    let path = file("many_variables_cusp", &cells(10, 50.0));
    let curve = format!("locus saddle-node --system {path} --in p,q --range p=-1,1 --range q=-1,2");
    let cusps = special(&curve, "CP");
    assert_eq!(cusps.len(), 1, "{cusps:?}");
    within(&cusps[0]["p"], 0.0, 1e-10);
    within(&cusps[0]["q"], 0.0, 1e-10);
    let ends = special(&curve, "EP");
    assert_eq!(ends.len(), 2);
    for end in ends {
        // Where p is 1 in size.
        within(&end["q"], 3.0 * 0.25_f64.cbrt(), 1e-10);
    }
}

#[test]
fn two_eigenvalues_vanish_together_along_a_ring_of_ten_cells() {
    let path = file("many_variables_multiple", &cells(10, 2.0));
    // Some of the branches that begin there go no further beside others, which is told by the status.
    let made = twinslip(&format!(
        "branch equilibria --system {path} --along p --from=-1 --to 1 --format json -q"
    ));
    assert!(made.code <= 1, "{}", made.err);
    let made: Value = serde_json::from_str(&made.out).expect("JSON");
    let found = made["result"]["special"].as_array().expect("a list");
    let crosses = |one: &&Value| one["branch"] == 0 && one["label"] == "BP";
    let first: Vec<&Value> = found.iter().filter(crosses).collect();
    assert_eq!(first.len(), 2);
    // Of wave number 1: q - 3 x^2 = 4 k sin^2(pi / 10).
    let x = ((1.0 - 8.0 * (PI / 10.0).sin().powi(2)) / 3.0).sqrt();
    let p = x - x.powi(3);
    for (point, p) in first.into_iter().zip([p, -p]) {
        assert_eq!(point["multiplicity"], 2);
        within(&point["p"], p, 1e-10);
    }
}

#[test]
fn a_wave_of_a_ring_of_ten_is_that_of_a_ring_of_five() {
    let period = |count: usize| {
        let path = file(&format!("many_variables_wave_{count}"), &text(count, 0.5));
        let ends = special(
            &format!("branch orbits --system {path} --along F --from 0.8 --to 0.95"),
            "EP",
        );
        // The first wave to grow has a length of five.
        ends[0]["period"].clone()
    };
    let [one, other] = [5, 10].map(period);
    let known = one["value"].as_f64().expect("a number");
    let own = one["uncertainty"].as_f64().expect("a number");
    let made = other["value"].as_f64().expect("a number");
    let uncertainty = other["uncertainty"].as_f64().expect("a number");
    assert!(own < 1e-12 && uncertainty < 1e-12);
    assert!((made - known).abs() <= own + uncertainty, "{one} {other}");
}
