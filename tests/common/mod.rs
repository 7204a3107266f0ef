//! Reference data and small comparisons, shared by the tests.

pub mod among;
pub mod branches;
pub mod heard;
pub mod in_units;
pub mod ivp;
pub mod laboratory;
pub mod lorenz;
pub mod pages;
pub mod returns;
pub mod sections;
pub mod stiff_classics;
pub mod synthetic;
pub mod text;
pub mod trajectories;

use serde_json::Value;

/// The folder of the repository.
pub const ROOT: &str = concat!(env!("CARGO_MANIFEST_DIR"), "/../..");

/// A file of `tests/data`.
pub fn data(name: &str) -> Value {
    let path = format!("{ROOT}/tests/data/{name}");
    let text = std::fs::read_to_string(&path).unwrap_or_else(|e| panic!("{path}: {e}"));
    serde_json::from_str(&text).unwrap_or_else(|e| panic!("{path}: {e}"))
}

/// Another one each time.
pub fn random() -> u64 {
    std::hash::BuildHasher::hash_one(&std::hash::RandomState::new(), 0u8)
}

/// A number that is written as a number or as a decimal string.
pub fn number(value: &Value) -> f64 {
    match value {
        Value::String(s) => s.parse().unwrap_or_else(|_| panic!("not a number: {s}")),
        _ => value
            .as_f64()
            .unwrap_or_else(|| panic!("not a number: {value}")),
    }
}

/// A complex number that mpmath wrote: `(a + bj)`, or `a`.
pub fn complex(value: &Value) -> (f64, f64) {
    let text = value
        .as_str()
        .expect("a string")
        .trim_matches(['(', ')'])
        .trim_end_matches('j');
    match text
        .split_once(" + ")
        .map(|p| (p, 1.0))
        .or_else(|| text.split_once(" - ").map(|p| (p, -1.0)))
    {
        Some(((re, im), sign)) => (
            re.parse().expect("real"),
            sign * im.parse::<f64>().expect("imaginary"),
        ),
        None => (text.parse().expect("real"), 0.0),
    }
}

pub fn relative(a: f64, b: f64) -> f64 {
    (a - b).abs() / b.abs()
}

#[track_caller]
pub fn assert_close(a: f64, b: f64, tolerance: f64, what: &str) {
    assert!(
        relative(a, b) <= tolerance,
        "{what}: {a:e} against {b:e}, off by {:e} > {tolerance:e}",
        relative(a, b)
    );
}
