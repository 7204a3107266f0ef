//! Pitchforks of orbits of a system whose symmetry it does not tell: where they are, and the orbits that begin there.

use crate::command::{self, number};
use serde_json::Value;

/// Of Lorenz's system with sigma = 10, b = 8/3, in 40 digits: half a period followed by the mirror image has the multiplier -1 (Taylor series of order 34 in mpmath, Newton's
/// method on the orbit, the period and r).
const PITCHFORK: f64 = 312.973_532_984_161_6;
const PERIOD: f64 = 0.411_166_056_121_265_55;

#[test]
fn the_asymmetric_orbits_of_lorenz_begin_at_the_pitchfork() {
    let made = command::object("branch orbits --system lorenz --along r --from 350 --to 228");
    let special = made["result"]["special"].as_array().expect("points");
    let of = |label: &str| -> Vec<&Value> {
        let found = special.iter().filter(|one| one["label"] == label);
        found.collect()
    };
    let is = |one: &Value, name: &str, truth: f64| {
        let value = number(one, &format!("/{name}/value"));
        let off = number(one, &format!("/{name}/uncertainty"));
        assert!(
            (value - truth).abs() <= off && off < 1e-12 * truth.max(100.0),
            "{name} = {value} ± {off:e} for {truth}"
        );
    };
    let [pitchfork] = of("PF")[..] else {
        panic!("{special:#?}");
    };
    is(pitchfork, "r", PITCHFORK);
    is(pitchfork, "period", PERIOD);
    assert_eq!(pitchfork["note"], Value::Null);
    // Sparrow (1982), The Lorenz Equations, has the doubling of the asymmetric orbits at 229.42. A search at smaller r finds them too.
    let searched = command::object("branch orbits --system lorenz --along r --from 228 --to 240");
    let other = searched["result"]["special"].as_array().expect("points");
    let doubling = |all: &[Value]| -> [f64; 2] {
        let found = all.iter().find(|one| one["label"] == "PD");
        let found = found.expect("a doubling");
        ["value", "uncertainty"].map(|part| number(found, &format!("/r/{part}")))
    };
    let ([here, off], [there, other_off]) = (doubling(special), doubling(other));
    assert!(
        (here - there).abs() <= off + other_off,
        "{here} ± {off:e}, {there} ± {other_off:e}"
    );
    assert!((here - 229.42).abs() < 0.02, "{here}");
}

/// The special points of the first branch of orbits of a system, and the largest value of a parameter on its rows.
fn first_branch(words: &str, along: &str) -> (Vec<Value>, f64) {
    let made = command::object(words);
    let of_first = |name: &str| -> Vec<Value> {
        let all = made["result"][name].as_array().expect("a list");
        let first = all.iter().filter(|one| one["branch"] == 0);
        first.cloned().collect()
    };
    let rows = of_first("rows");
    let values = rows.iter().map(|row| number(row, &format!("/{along}")));
    (
        of_first("special"),
        values.fold(f64::NEG_INFINITY, f64::max),
    )
}

#[test]
fn a_branch_of_asymmetric_orbits_ends_at_its_pitchfork() {
    let (special, largest) = first_branch(
        "branch orbits --system lorenz --along r --from 200 --to 330",
        "r",
    );
    let last = special.last().expect("points");
    assert_eq!(last["label"], "PF", "{special:#?}");
    for (name, truth) in [("r", PITCHFORK), ("period", PERIOD)] {
        let value = number(last, &format!("/{name}/value"));
        let off = number(last, &format!("/{name}/uncertainty"));
        assert!(
            (value - truth).abs() <= off && off < 1e-12 * truth.max(100.0),
            "{name} = {value} ± {off:e} for {truth}"
        );
    }
    assert!(largest < PITCHFORK + 1e-9, "{largest}");
}

/// x' = x - x^3 + e cos t: the orbit about 0, its own image half a period later, and the two that begin at its pitchfork. That is where x(pi) = -x(0) and the integral of
/// 1 - 3 x^2 vanishes: by mpmath's `odefun` in 22 digits.
#[test]
fn forced_orbits_in_one_well_end_where_the_orbit_through_both_becomes_stable() {
    const WELLS: f64 = 0.931_053_696_634_958_1;
    let file = command::folder("two-wells").join("wells.toml");
    let text = r#"name = "wells"
states = ["x"]
period = "2*pi"

[parameters]
e = 0.5

[rates]
x = "x - x^3 + e*cos(t)"

[start]
x = 1.0
"#;
    std::fs::write(&file, text).expect("a file");
    let file = file.to_str().expect("a path");
    for range in ["--from 0.1 --to 3", "--from 3 --to 0.1"] {
        let made = command::object(&format!("branch orbits --system {file} --along e {range}"));
        let special = made["result"]["special"].as_array().expect("points");
        let of = |label: &str| -> Vec<&Value> {
            special.iter().filter(|one| one["label"] == label).collect()
        };
        let pitchforks = of("PF");
        assert_eq!(pitchforks.len(), 2, "{special:#?}");
        for one in pitchforks {
            let value = number(one, "/e/value");
            let off = number(one, "/e/uncertainty");
            assert!(
                (value - WELLS).abs() <= off && off < 1e-8,
                "{value} ± {off:e}"
            );
        }
        // No branch comes back to where it began.
        let ends = of("EP");
        assert_eq!(ends.len(), 3, "{special:#?}");
    }
}

#[test]
fn a_branch_of_doubled_orbits_ends_at_its_period_doubling() {
    let words = "branch orbits --system lorenz --along r --from 220 --to 240";
    let (special, largest) = first_branch(words, "r");
    let last = special.last().expect("points");
    assert_eq!(last["label"], "PD", "{special:#?}");
    let made = command::object(words);
    let all = made["result"]["special"].as_array().expect("points");
    let simple = all
        .iter()
        .find(|one| one["label"] == "PD" && one["branch"] != 0)
        .expect("the same doubling on the other branch");
    let of = |one: &Value, part: &str| number(one, &format!("/r/{part}"));
    let apart = (of(last, "value") - of(simple, "value")).abs();
    assert!(apart <= of(last, "uncertainty") + of(simple, "uncertainty"));
    // A whole period later, and not twice the period, is what is told.
    let periods = [last, simple].map(|one| number(one, "/period/value"));
    assert!((periods[0] / periods[1] - 1.0).abs() < 1e-12, "{periods:?}");
    assert!(largest < of(simple, "value") + 1e-9, "{largest}");
}
