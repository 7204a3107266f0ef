//! Rows beside those of a run.

use super::{cells, names, object};
use crate::scene::{Column, Quantity, Units};
use serde_json::{Map, Value};
use std::borrow::Cow;
use twinslip_output::Cell;

/// Rows of some kind, as they are shown.
pub trait Listing {
    /// How the columns are called, in a table or in a file.
    fn names(&self, table: bool) -> Vec<(String, Quantity)>;
    /// How many rows there are.
    fn count(&self) -> usize;
    /// A row as cells of a table or of a file.
    fn cells(&self, row: usize, table: bool) -> Vec<Cell>;
    /// All rows as objects.
    fn objects(&self) -> Vec<Map<String, Value>>;
}

/// Rows with their columns.
pub struct Listed<'a, R: Clone> {
    /// What is shown of each.
    pub columns: Vec<Column<R>>,
    /// The rows.
    pub rows: Cow<'a, [R]>,
    /// The user's units.
    pub units: &'a Units,
}

impl<R: Clone> Listing for Listed<'_, R> {
    fn names(&self, table: bool) -> Vec<(String, Quantity)> {
        names(&self.columns, table)
    }

    fn count(&self) -> usize {
        self.rows.len()
    }

    fn cells(&self, row: usize, table: bool) -> Vec<Cell> {
        cells(&self.columns, &self.rows[row], self.units, table)
    }

    fn objects(&self) -> Vec<Map<String, Value>> {
        let rows = self.rows.iter();
        rows.map(|row| object(&self.columns, row, self.units))
            .collect()
    }
}
