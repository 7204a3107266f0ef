//! Rows of results and the files that keep them.

use serde::{Deserialize, Serialize};
use std::io;
use std::path::Path;

/// The status of a row with a time and an error.
pub const OK: &str = "ok";

/// One method at one tolerance in one scene.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct Row {
    pub scene: String,
    pub method: String,
    pub tolerance: f64,
    /// Thread CPU time of a run, median; none if there is none.
    pub seconds: Option<f64>,
    pub error: Option<f64>,
    pub steps: Option<usize>,
    pub rejected: Option<usize>,
    /// [`OK`], why it was skipped, or the error that ended the run.
    pub status: String,
}

impl Row {
    /// A row without a time.
    pub fn without(scene: &str, method: &str, tolerance: f64, status: impl ToString) -> Self {
        Row {
            scene: scene.to_owned(),
            method: method.to_owned(),
            tolerance,
            seconds: None,
            error: None,
            steps: None,
            rejected: None,
            status: status.to_string(),
        }
    }

    /// (error, seconds) where both are known.
    pub fn point(&self) -> Option<(f64, f64)> {
        self.error.zip(self.seconds)
    }
}

/// A number to so many digits as a measurement has.
pub fn rounded(x: f64) -> f64 {
    format!("{x:.3e}").parse().unwrap_or(x)
}

/// A time for a reader, three digits.
pub fn time_text(seconds: f64) -> String {
    let (number, unit) = match seconds {
        s if s < 1e-3 => (1e6 * s, "µs"),
        s if s < 1.0 => (1e3 * s, "ms"),
        s => (s, "s"),
    };
    let decimals = if number < 9.995 {
        2
    } else {
        usize::from(number < 99.95)
    };
    format!("{number:.decimals$} {unit}")
}

/// The points (error, seconds) of a method in a scene.
pub fn points(rows: &[Row], scene: &str, method: &str) -> Vec<(f64, f64)> {
    rows.iter()
        .filter(|row| row.scene == scene && row.method == method)
        .filter_map(Row::point)
        .collect()
}

/// What is different in `pick` among rows, in their order.
pub fn distinct(rows: &[Row], pick: impl Fn(&Row) -> &str) -> Vec<String> {
    let mut names: Vec<String> = Vec::new();
    for name in rows.iter().map(pick) {
        if !names.iter().any(|known| known == name) {
            names.push(name.to_owned());
        }
    }
    names
}

/// The rows of a file; none if there is no file yet.
pub fn read(path: &Path) -> io::Result<Vec<Row>> {
    if !path.exists() {
        return Ok(Vec::new());
    }
    let rows = csv::Reader::from_path(path)?.into_deserialize();
    Ok(rows.collect::<Result<_, _>>()?)
}

/// Writes rows into a file, in place of the older ones of the same methods in the same scenes at the same tolerances: a part can
/// be measured again.
pub fn merge(path: &Path, new: &[Row]) -> io::Result<()> {
    let replaced = |old: &Row| {
        new.iter().any(|row| {
            (&row.scene, &row.method, row.tolerance) == (&old.scene, &old.method, old.tolerance)
        })
    };
    let mut rows = read(path)?;
    rows.retain(|row| !replaced(row));
    rows.extend_from_slice(new);
    if let Some(folder) = path.parent() {
        std::fs::create_dir_all(folder)?;
    }
    let mut writer = csv::Writer::from_path(path)?;
    for row in &rows {
        writer.serialize(row)?;
    }
    writer.flush()
}
