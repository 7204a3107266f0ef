//! The columns that an ensemble adds to rows.

use super::bands::{Band, Banded, Ends};
use super::member::Yield;
use serde_json::{Map, Value, json};
use twinslip_output::Cell;

/// Columns, and their cells in each row.
#[derive(Debug, Clone, Default, PartialEq)]
pub struct Added {
    /// Their names.
    pub columns: Vec<String>,
    /// Their units.
    pub units: Vec<String>,
    /// The cells of each row.
    pub rows: Vec<Vec<Cell>>,
}

impl Added {
    /// The ends of the bands of these columns, of each row what is known of it; both have the same numbers in the same order.
    pub fn bands(estimate: &Yield, names: &[String], rows: &[Option<&Banded>]) -> Self {
        let ends = names
            .iter()
            .flat_map(|name| ["lower", "upper"].map(|end| format!("{name}_{end}")));
        let unit = |name: &String| {
            let at = estimate.column(name);
            let unit = at.and_then(|at| estimate.units.get(at)).cloned();
            unit.unwrap_or_else(|| "1".into())
        };
        let cells = |row: &Option<&Banded>| {
            let band = |i: usize| row.and_then(|row| row.bands.get(i)?.linear);
            let cells = |i: usize| match band(i) {
                Some(ends) => ends.map(Cell::Number),
                None => [Cell::Missing, Cell::Missing],
            };
            (0..names.len()).flat_map(cells).collect()
        };
        Added {
            columns: ends.collect(),
            units: names
                .iter()
                .flat_map(|name| [unit(name), unit(name)])
                .collect(),
            rows: rows.iter().map(cells).collect(),
        }
    }

    /// With another column, which has no unit.
    pub fn with(mut self, name: &str, cells: impl IntoIterator<Item = Option<f64>>) -> Self {
        self.columns.push(name.to_owned());
        self.units.push("1".to_owned());
        for (row, cell) in self.rows.iter_mut().zip(cells) {
            row.push(cell.into());
        }
        self
    }

    /// Puts them into the objects that the rows are in JSON.
    pub fn put_into(&self, objects: &mut Value) {
        let objects = objects.as_array_mut().into_iter().flatten();
        for (object, row) in objects.zip(&self.rows) {
            let Some(object) = object.as_object_mut() else {
                continue;
            };
            for (name, cell) in self.columns.iter().zip(row) {
                object.insert(name.clone(), value(cell));
            }
        }
    }
}

fn value(cell: &Cell) -> Value {
    match cell {
        Cell::Number(x) => json!(x),
        Cell::Text(text) => json!(text),
        Cell::Missing => Value::Null,
    }
}

/// Puts both kinds of bands of a number into an object.
pub fn put_band(object: &mut Map<String, Value>, name: &str, band: &Band) {
    let end = |i: usize| json!(band.linear.map(|ends: Ends| ends[i]));
    object.insert(format!("{name}_lower"), end(0));
    object.insert(format!("{name}_upper"), end(1));
    object.insert(format!("{name}_draws"), json!(band.draws));
}
