//! Branches of periodic orbits of oscillators of AUTO-07p's demos, MatCont's tutorials and textbooks, against AUTO-07p: every special point,
//! in its order along its branch, to the digits that AUTO gives.

use crate::command::{self, number};
use crate::common::ROOT;
use serde_json::Value;
use std::fs;

/// Parts of their branches, or their ends, are missing.
const NOT_WHOLE: [&str; 4] = ["abc-reaction", "bazykin", "chua-smooth", "torus-circuit"];

/// They take longest.
const LONG: [&str; 4] = [
    "co-oxidation",
    "decroly-goldbeter",
    "hindmarsh-rose",
    "peroxidase",
];

/// A label, the parameter and the period.
type Point = (String, f64, f64);

/// The special points by branch, as the program writes them.
fn branches(name: &str, known: &Value) -> Vec<Vec<Point>> {
    let parameter = known["along"].as_str().expect("a name");
    let text = format!(
        "branch orbits --system tests/data/oscillators/{name}.toml --along {parameter} --from {} --to {} --format json -q",
        known["from"], known["to"]
    );
    let ended = command::twinslip(&text);
    // A row may fall so near a branch point that its stability is undecided.
    assert!(matches!(ended.code, 0 | 3), "{name}: {}", ended.err);
    let made: Value = serde_json::from_str(&ended.out).expect("JSON");
    let mut found: Vec<(Value, Vec<Point>)> = Vec::new();
    for one in made["result"]["special"].as_array().expect("a list") {
        let label = one["label"].as_str().expect("a label").to_owned();
        let value = number(one, &format!("/{parameter}/value"));
        let point = (label, value, number(one, "/period/value"));
        match found
            .iter_mut()
            .find(|(branch, _)| *branch == one["branch"])
        {
            Some((_, points)) => points.push(point),
            None => found.push((one["branch"].clone(), vec![point])),
        }
    }
    found.into_iter().map(|(_, points)| points).collect()
}

/// Whether the point is the known one, to the decimals that are told.
fn is_known((label, value, period): &Point, known: &Value) -> bool {
    let near = |value: f64, part: &str, digits: &str| {
        known[part].as_f64().is_none_or(|at| {
            let digits = known[digits].as_i64().expect("decimals") as i32;
            (value - at).abs() <= 10.0_f64.powi(-digits)
        })
    };
    let wanted = known["label"].as_str().expect("a label");
    // All branch points of orbits have the label of pitchforks.
    (label == wanted || (wanted == "BP" && label == "PF"))
        && near(*value, "parameter", "digits")
        && near(*period, "period", "period_digits")
}

fn is_whole(name: &str) {
    let text =
        fs::read_to_string(format!("{ROOT}/tests/data/oscillators/known.json")).expect("a file");
    let all: Value = serde_json::from_str(&text).expect("JSON");
    let known = &all["systems"][name];
    let found = branches(name, known);
    let wanted = known["branches"].as_array().expect("branches");
    assert_eq!(found.len(), wanted.len(), "{name}: {found:?}");
    for (mut points, wanted) in found.into_iter().zip(wanted) {
        let wanted = wanted.as_array().expect("points");
        // A branch may be gone along either way.
        if !points.first().is_some_and(|one| is_known(one, &wanted[0])) {
            points.reverse();
        }
        if known["more"] == true {
            // In their order, with others between them.
            let mut rest = points.iter();
            for known in wanted {
                let found = rest.any(|one| is_known(one, known));
                assert!(found, "{name}: {known} is not among {points:?}");
            }
        } else {
            assert_eq!(points.len(), wanted.len(), "{name}: {points:?}");
            for (one, known) in points.iter().zip(wanted) {
                assert!(is_known(one, known), "{name}: {one:?} is not {known}");
            }
        }
    }
}

fn are_whole(chosen: impl Fn(&str) -> bool) {
    let text =
        fs::read_to_string(format!("{ROOT}/tests/data/oscillators/known.json")).expect("a file");
    let all: Value = serde_json::from_str(&text).expect("JSON");
    let systems = all["systems"].as_object().expect("systems");
    for name in systems.keys().filter(|name| chosen(name.as_str())) {
        is_whole(name);
    }
}

#[test]
fn branches_of_oscillators_have_all_points_that_auto_finds() {
    are_whole(|name| !NOT_WHOLE.contains(&name) && !LONG.contains(&name));
}

#[test]
#[ignore = "takes minutes"]
fn branches_that_take_longest_have_all_points_that_auto_finds() {
    are_whole(|name| LONG.contains(&name));
}

/// The coefficient needs the mean square length of the eigenvector along the orbit. Along bursts a fixed number of points in each arc gave that to four digits only.
#[test]
fn coefficients_along_relaxation_oscillations_are_sharp() {
    /// Computed independently with SciPy: Taylor maps of third order between the planes of 40 nodes (and of 55) by DOP853 at 3e-14, the eigenvector and its adjoint
    /// from a singular value decomposition of the cyclic system, the squared length as one more variable of the flow.
    const TRUTH: f64 = -30.815_163_313;
    let made = command::object(
        "branch orbits --system tests/data/oscillators/hindmarsh-rose.toml --along I --from 1.2 --to 1.4",
    );
    let all = made["result"]["special"].as_array().expect("points");
    let mut doublings = all.iter().filter(|one| one["label"] == "PD");
    let subcritical = doublings.find(|one| one["criticality"] == "subcritical");
    let point = subcritical.expect("a subcritical doubling");
    let [value, off] =
        ["", "_uncertainty"].map(|part| number(point, &format!("/coefficient{part}")));
    assert!((value - TRUTH).abs() < off, "{value} ± {off:e}");
    assert!((value - TRUTH).abs() < 1e-8, "{value}");
    assert!(off < 1e-7 * value.abs(), "{value} ± {off:e}");
}
