//! What the paper says against what is computed.

use super::pieces::Pieces;
use super::product::{Made, Make, Product};
use crate::error::Result;
use serde_json::{Value, json};

/// How the entries are computed, in a sentence.
pub const METHOD: &str = "each entry by the method that its note names";

/// Table 1 again.
pub const TABLE1: Product = Product {
    id: "table1",
    title: "Strong resonances along the torus bifurcation curve",
    caption: "",
    alt: "",
    scenes: &["fig12"],
    make: Make::Table(table1),
};

/// All that can be held against a computation.
pub const SCORECARD: Product = Product {
    id: "scorecard",
    title: "What the paper says and what is computed",
    caption: "",
    alt: "",
    scenes: &["fig12"],
    make: Make::Scorecard,
};

/// One of them.
#[derive(Debug)]
pub struct Entry {}

/// All entries, in the order of the paper.
///
/// # Errors
/// Those of the computations.
pub fn entries(_pieces: &Pieces<'_>) -> Result<Vec<Entry>> {
    Ok(Vec::new())
}

/// As `scorecard.json` has them.
pub fn json(_entries: &[Entry]) -> Value {
    json!({"entries": []})
}

/// Table 1 with the values computed.
///
/// # Errors
/// Those of the curve.
pub fn table1(_pieces: &Pieces<'_>) -> Result<Made> {
    Ok(Made {
        sheet: super::Sheet::new(),
        drawing: None,
        method: String::new(),
    })
}
