//! One JSON object per command. Numbers are shortest round-trip, complex numbers are `[re, im]`, what is not known is null.

use serde::ser::{Serialize, SerializeMap, SerializeSeq, Serializer};
use serde_json::{Map, Value, json};

/// What every command's object holds.
#[derive(Debug, Clone, serde::Serialize)]
pub struct Envelope<'a, R: Serialize> {
    /// Version of this program.
    pub twinslip: &'static str,
    /// The command line.
    pub command: &'a [String],
    /// Version of SUNDIALS, where it is built in.
    pub sundials: Option<String>,
    /// The model's parameters.
    pub model: &'a Map<String, Value>,
    /// What numbers are measured in.
    pub units: Value,
    /// Method and tolerances.
    pub numerics: Value,
    /// What was asked for.
    pub result: R,
    /// What it cost.
    pub work: Value,
    /// Why the computation ended early.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub error: Option<String>,
}

/// Rows of numbers as a list of objects, kept flat and turned into objects only on the way out.
#[derive(Debug, Clone, Default, PartialEq)]
pub struct RowList {
    /// Names of the columns.
    pub columns: Vec<String>,
    /// Row after row.
    pub numbers: Vec<f64>,
}

impl RowList {
    /// None yet.
    pub fn new(columns: Vec<String>) -> Self {
        RowList {
            columns,
            numbers: Vec::new(),
        }
    }

    /// One after the other.
    pub fn iter(&self) -> impl ExactSizeIterator<Item = &[f64]> {
        self.numbers.chunks_exact(self.columns.len().max(1))
    }

    /// A column by name.
    pub fn column(&self, name: &str) -> Option<Vec<f64>> {
        let at = self.columns.iter().position(|column| column == name)?;
        Some(self.iter().map(|row| row[at]).collect())
    }
}

impl Serialize for RowList {
    fn serialize<S: Serializer>(&self, serializer: S) -> Result<S::Ok, S::Error> {
        let mut list = serializer.serialize_seq(Some(self.iter().len()))?;
        for row in self.iter() {
            list.serialize_element(&RowObject {
                columns: &self.columns,
                row,
            })?;
        }
        list.end()
    }
}

struct RowObject<'a> {
    columns: &'a [String],
    row: &'a [f64],
}

impl Serialize for RowObject<'_> {
    fn serialize<S: Serializer>(&self, serializer: S) -> Result<S::Ok, S::Error> {
        let mut map = serializer.serialize_map(Some(self.columns.len()))?;
        for (name, x) in self.columns.iter().zip(self.row) {
            // serde_json writes a number that is not finite as null, as the contract asks.
            map.serialize_entry(name, x)?;
        }
        map.end()
    }
}

/// An object of one row.
pub fn object(columns: &[String], row: &[f64]) -> Map<String, Value> {
    columns
        .iter()
        .zip(row)
        .map(|(name, x)| (name.clone(), json!(x)))
        .collect()
}

/// A value with the bound on its error.
pub fn uncertain((value, uncertainty): (f64, f64)) -> Value {
    json!({"value": value, "uncertainty": uncertainty})
}
