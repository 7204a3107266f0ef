//! The friction laws that the program carries as files, by their names: their steady friction against closed forms, and their critical
//! stiffness against the Hopf points of steady sliding.

use crate::command::{number, object, object_or_undecided, refused_in_one_line};
use serde_json::Value;

/// The rows of a law at slip rates in decades.
fn rows(law: &str) -> Vec<[f64; 3]> {
    let made = object(&format!("law --law {law} --from 1e-3 --to 1e8 --points 12"));
    let rows = made["result"]["rows"].as_array().expect("rows").clone();
    let row = |row: &Value| {
        ["/slip_rate", "/friction", "/critical_stiffness"].map(|name| number(row, name))
    };
    rows.iter().map(row).collect()
}

#[test]
fn steady_friction_is_that_of_the_closed_forms() {
    let (a, b, mu) = (0.0349, 0.0489, 0.369);
    let logarithmic = move |v: f64| mu + (a - b) * v.ln();
    let regularised = move |v: f64| {
        let tau = (mu - b * v.ln()) / a;
        a * (0.5 * v * tau.exp()).asinh()
    };
    let cutoff = move |v: f64| {
        let (one, two): (f64, f64) = (1e8, 1.0);
        mu - a * ((one / v + 1.0) / (one + 1.0)).ln() + b * ((two / v + 1.0) / (two + 1.0)).ln()
    };
    let flash = |v: f64| {
        let (a, b, mu, weak, rate): (f64, f64, f64, f64, f64) = (0.01, 0.014, 0.6, 0.2, 1e5);
        let slow = mu - (b - a) * v.ln();
        weak + (slow - weak) / (1.0 + (v / rate).powi(8)).powf(0.125)
    };
    type Curve<'a> = &'a dyn Fn(f64) -> f64;
    let laws: [(&str, Curve<'_>); 4] = [
        ("nagata", &logarithmic),
        ("perrin-rice-zheng", &regularised),
        ("cutoff", &cutoff),
        ("flash-heating", &flash),
    ];
    for (law, known) in laws {
        for [v, friction, _] in rows(law) {
            let known = known(v);
            let off = (friction - known).abs();
            assert!(off < 1e-11, "{law} at {v}: {friction} for {known}");
        }
    }
}

#[test]
fn critical_stiffness_is_where_steady_sliding_turns_unstable() {
    for law in [
        "nagata",
        "perrin-rice-zheng",
        "cutoff",
        "flash-heating",
        "composite",
    ] {
        let at = object(&format!("law --law {law} --from 0.1 --to 1 --points 2"));
        let critical = number(&at, "/result/rows/0/critical_stiffness");
        assert!(critical > 0.0, "{law}");
        let ends = (0.5 * critical, 2.0 * critical);
        let made = object_or_undecided(&format!(
            "branch equilibria --law {law} --interfaces 1 --driving 0.1 --along stiffness={:?}:{:?}",
            ends.0, ends.1
        ));
        let all = made["result"]["special"].as_array().expect("a list");
        let hopf = all.iter().find(|one| one["label"] == "HB");
        let found = number(hopf.expect("a Hopf point"), "/stiffness/value");
        assert!((found / critical - 1.0).abs() < 1e-9, "{law}: {found}");
    }
    // (b/a - 1)/(1 + c)
    let nagata = rows("nagata");
    for [v, _, critical] in nagata {
        let known = (0.0489 / 0.0349 - 1.0) / 3.0;
        assert!((critical / known - 1.0).abs() < 1e-9, "{critical} at {v}");
    }
}

#[test]
fn names_and_units_are_those_of_built_in_laws() {
    let plain = object("law --law cutoff --from 1e-2 --to 1 --points 3");
    let in_si = object(
        "law --law cutoff.toml --from 1e-8 --to 1e-6 --points 3 --slip-length 10um --normal-stress 5MPa --set evolution_cutoff_rate=1um/s",
    );
    let unit = 0.0349 * 5e6;
    for i in 0..3 {
        let stress = |made: &Value| number(made, &format!("/result/rows/{i}/stress"));
        let (x, y) = (stress(&plain) * unit, stress(&in_si));
        assert!((x / y - 1.0).abs() < 1e-10, "{x} and {y}");
    }
    refused_in_one_line("law --law nagatta", "did you mean \"nagata\"?");
}
