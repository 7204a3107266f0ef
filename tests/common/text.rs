//! What tests of systems and laws from files share.

use crate::command::{folder, number, object};
use serde_json::Value;
use std::fs;

/// The law of the paper and two interfaces, written as a user would.
pub const SPINODAL: &str = include_str!("../data/two-interfaces.toml");

/// The path of the file with the law of this built-in name.
pub fn law(name: &str) -> String {
    format!("scenes/laws/{name}.toml")
}

/// All numbers of an object that another has under the same names too.
#[track_caller]
pub fn alike(made: &Value, known: &Value, tolerance: f64, names: &[&str]) {
    for name in names {
        let value = |object: &Value| object[*name].as_f64();
        let (made, known) = (value(made), value(known));
        let both = made.zip(known);
        let (made, known) = both.unwrap_or_else(|| panic!("{name}: {made:?} for {known:?}"));
        let off = (made - known).abs();
        assert!(
            off <= tolerance * known.abs().max(1e-3),
            "{name}: {made} for {known}"
        );
    }
}

/// Fails unless a number is as near to another as is claimed, in units of 1 + |x|.
#[track_caller]
pub fn near(made: f64, exact: f64, tolerance: f64) {
    let off = (made - exact).abs();
    assert!(off <= tolerance * (1.0 + exact.abs()), "{made} for {exact}");
}

/// A file of this test's own.
pub fn file(folder_name: &str, text: &str) -> String {
    let path = folder(folder_name).join("system.toml");
    fs::write(&path, text).expect("a file");
    path.display().to_string()
}

/// The end of a run, each value within its uncertainty of the truth, and this near.
#[track_caller]
pub fn ends_at(arguments: &str, truths: &[(&str, f64)], near: f64) -> Value {
    let made = object(&format!(
        "integrate --system tests/data/cases/{arguments} --final-only --estimate-error"
    ));
    for (name, truth) in truths {
        let value = number(&made, &format!("/result/final/{name}"));
        let uncertainty = number(&made, &format!("/result/final/{name}_uncertainty"));
        // The truth has as many digits as are written here.
        let off = (value - truth).abs();
        assert!(
            off <= uncertainty + 1e-8 * truth.abs() && off <= near,
            "{arguments}: {name} = {value} ± {uncertainty} for {truth}"
        );
    }
    made
}
