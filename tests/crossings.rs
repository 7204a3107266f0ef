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
