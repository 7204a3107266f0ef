//! How rows are shown: their columns, declared once, from which CSV, tables and objects follow, and their pictures.

use crate::number::Uncertain;
use crate::output::{self, Cell};
use crate::scene::{Quantity, Units};
use serde_json::{Map, Value, json};

mod bifurcation;
mod diagram;
mod map;
mod points;
mod run;
pub(crate) mod sweep;

pub use bifurcation::{branch_columns, locus_columns, special_columns};
pub use diagram::{axis_label, branch_lines, branches, curves, named_strokes, parameters};
pub use map::{return_map, states_at_returns};
pub use points::{REGIMES, outcome, sweep_columns, sweep_row};
pub use run::{panels_in_time, phase_plane};
pub use sweep::{GridSide, PointOutcome, basin_map, regime_map};

/// What a row has in a column, dimensionless.
pub enum CellValue {
    /// A number, where there is one.
    Number(Option<f64>),
    /// A number with its error budget.
    Uncertain(Option<Uncertain>),
    /// A word.
    Word(Option<String>),
    /// A count.
    Count(usize),
}

impl From<f64> for CellValue {
    fn from(x: f64) -> Self {
        CellValue::Number(Some(x))
    }
}

impl From<Option<f64>> for CellValue {
    fn from(x: Option<f64>) -> Self {
        CellValue::Number(x)
    }
}

impl From<Uncertain> for CellValue {
    fn from(x: Uncertain) -> Self {
        CellValue::Uncertain(Some(x))
    }
}

impl From<Option<Uncertain>> for CellValue {
    fn from(x: Option<Uncertain>) -> Self {
        CellValue::Uncertain(x)
    }
}

impl From<&'static str> for CellValue {
    fn from(word: &'static str) -> Self {
        CellValue::Word(Some(word.to_owned()))
    }
}

impl From<Option<&'static str>> for CellValue {
    fn from(word: Option<&'static str>) -> Self {
        CellValue::Word(word.map(str::to_owned))
    }
}

impl From<usize> for CellValue {
    fn from(n: usize) -> Self {
        CellValue::Count(n)
    }
}

/// A column of rows of the kind R.
pub struct Column<R> {
    /// Its name in CSV and JSON.
    pub name: &'static str,
    /// What it measures.
    pub quantity: Quantity,
    /// Whether it has an error budget.
    pub uncertain: bool,
    /// Whether a table, which has less room, shows it.
    pub in_table: bool,
    /// What a row has in it.
    pub entry: fn(&R) -> CellValue,
}

impl<R> Column<R> {
    /// A column that tables show too.
    pub fn new(name: &'static str, quantity: Quantity, entry: fn(&R) -> CellValue) -> Self {
        Column {
            name,
            quantity,
            uncertain: false,
            in_table: true,
            entry,
        }
    }

    /// With an error budget.
    pub fn uncertain(name: &'static str, quantity: Quantity, entry: fn(&R) -> CellValue) -> Self {
        Column {
            uncertain: true,
            ..Column::new(name, quantity, entry)
        }
    }
}

/// The names as written, error budgets in columns of their own but in tables.
pub fn names<R>(columns: &[Column<R>], table: bool) -> Vec<(String, Quantity)> {
    let mut names = Vec::new();
    for column in columns.iter().filter(|column| column.in_table || !table) {
        names.push((column.name.to_owned(), column.quantity));
        if column.uncertain && !table {
            names.push((format!("{}_uncertainty", column.name), column.quantity));
        }
    }
    names
}

/// A row in the user's units.
pub fn cells<R>(columns: &[Column<R>], row: &R, units: &Units, table: bool) -> Vec<Cell> {
    let mut cells = Vec::new();
    for column in columns.iter().filter(|column| column.in_table || !table) {
        match (column.entry)(row) {
            CellValue::Number(x) => cells.push(x.map(|x| units.outward(column.quantity, x)).into()),
            CellValue::Uncertain(x) => {
                let x = x.map(|x| units.outward_uncertain(column.quantity, x));
                cells.push(x.map(|x| x.value).into());
                if !table {
                    cells.push(x.map(|x| x.uncertainty).into());
                }
            }
            CellValue::Word(word) => cells.push(word.map_or(Cell::Missing, Cell::Text)),
            CellValue::Count(n) => cells.push(Cell::Text(n.to_string())),
        }
    }
    cells
}

/// A row as an object.
pub fn object<R>(columns: &[Column<R>], row: &R, units: &Units) -> Map<String, Value> {
    let value = |column: &Column<R>| match (column.entry)(row) {
        CellValue::Number(x) => json!(x.map(|x| units.outward(column.quantity, x))),
        CellValue::Uncertain(x) => x.map_or(Value::Null, |x| {
            let x = units.outward_uncertain(column.quantity, x);
            output::uncertain((x.value, x.uncertainty))
        }),
        CellValue::Word(word) => json!(word),
        CellValue::Count(n) => json!(n),
    };
    let pairs = columns.iter();
    pairs
        .map(|column| (column.name.to_owned(), value(column)))
        .collect()
}
