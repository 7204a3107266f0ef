//! The numbers behind a picture, as CSV: several sets of rows one below the other, each under its own name.

use super::piece::{Branches, Curves, GeneralCurves, Map, Run};
use twinslip::bifurcation::Special;
use twinslip::error::{Error, Result};
use twinslip_output::{Cell, CsvRows, RowList, RowWriter};
use twinslip_tasks::scene::{BranchKind, Column, Described, GeneralRow, Units};
use twinslip_tasks::views::{self, branch_columns, locus_columns, special_columns};

/// Sets of rows. In the CSV the first column, `part`, has the name of the set, and the other columns are those of all sets.
#[derive(Debug, Clone, Default, PartialEq)]
pub struct Sheet {
    /// From top to bottom.
    pub parts: Vec<SheetPart>,
}

/// A set of rows with equal columns.
#[derive(Debug, Clone, PartialEq)]
pub struct SheetPart {
    /// What it is.
    pub name: String,
    /// The names of its columns.
    pub columns: Vec<String>,
    /// As many cells each as there are columns.
    pub rows: Vec<Vec<Cell>>,
}

impl Sheet {
    /// Nothing yet.
    pub fn new() -> Self {
        Sheet::default()
    }

    /// Adds a set of rows.
    pub fn add(&mut self, name: impl Into<String>, columns: &[&str], rows: Vec<Vec<Cell>>) {
        self.parts.push(SheetPart {
            name: name.into(),
            columns: columns.iter().map(|&column| column.to_owned()).collect(),
            rows,
        });
    }

    /// Adds rows of numbers as they are.
    pub fn add_numbers(&mut self, name: impl Into<String>, rows: &RowList) {
        let cells = |row: &[f64]| row.iter().map(|&x| Cell::Number(x)).collect();
        self.parts.push(SheetPart {
            name: name.into(),
            columns: rows.columns.clone(),
            rows: rows.iter().map(cells).collect(),
        });
    }

    /// Adds a run in time.
    pub fn add_run(&mut self, name: impl Into<String>, run: &Run) {
        self.add_numbers(name, &run.rows);
    }

    /// Adds the returns of a map.
    pub fn add_map(&mut self, name: impl Into<String>, map: &Map) {
        self.add_numbers(name, &map.rows);
    }

    /// Adds branches, in the columns of the command `branch`, and their special points.
    pub fn add_branches(&mut self, name: &str, branches: &Branches) {
        let plan = &branches.plan;
        let columns = branch_columns(plan.of == BranchKind::Orbits, plan.system.interfaces);
        self.add_rows(name.into(), &columns, &branches.rows, &plan.system.units);
        self.add_special(name, &branches.special, &plan.system.units);
    }

    /// Adds curves, in the columns of the command `locus`, and their special points.
    pub fn add_curves(&mut self, name: &str, curves: &Curves) {
        let units = &curves.plan.system.units;
        self.add_rows(name.into(), &locus_columns(2), &curves.rows, units);
        self.add_special(name, &curves.special, units);
    }

    /// Adds branches or curves in any parameters, in the columns of their commands, and their special points.
    pub fn add_general(&mut self, name: &str, curves: &GeneralCurves) {
        let (subject, names) = (&curves.subject, &curves.names);
        let columns = GeneralRow::columns(subject, curves.kind, names);
        self.add_rows(name.into(), &columns, &curves.rows, subject.units());
        let columns = GeneralRow::special_columns(subject, names);
        let name = format!("special points of {name}");
        self.add_rows(name, &columns, &curves.special, subject.units());
    }

    fn add_special(&mut self, name: &str, special: &[Special], units: &Units) {
        let name = format!("special points of {name}");
        self.add_rows(name, &special_columns(), special, units);
    }

    fn add_rows<R>(&mut self, name: String, columns: &[Column<R>], rows: &[R], units: &Units) {
        let names = views::names(columns, false);
        let cells = |row| views::cells(columns, row, units, false);
        self.parts.push(SheetPart {
            name,
            columns: names.into_iter().map(|(name, _)| name).collect(),
            rows: rows.iter().map(cells).collect(),
        });
    }

    /// The CSV, below remarks.
    ///
    /// # Errors
    /// [`Error::Input`] if a row has not as many cells as its set has columns.
    pub fn csv(&self, remarks: &[String]) -> Result<Vec<u8>> {
        let mut columns = vec!["part".to_owned()];
        for name in self.parts.iter().flat_map(|part| &part.columns) {
            if !columns.contains(name) {
                columns.push(name.clone());
            }
        }
        let mut bytes = Vec::new();
        let wrong =
            |error: std::io::Error| Error::Input(format!("the rows can't be written: {error}"));
        {
            let mut csv = CsvRows::new(&mut bytes, remarks, &columns).map_err(wrong)?;
            for part in &self.parts {
                let places: Vec<Option<usize>> = columns
                    .iter()
                    .map(|name| part.columns.iter().position(|column| column == name))
                    .collect();
                for row in &part.rows {
                    if row.len() != part.columns.len() {
                        return Err(Error::Input(format!(
                            "a row of {} has {} cells for {} columns",
                            part.name,
                            row.len(),
                            part.columns.len()
                        )));
                    }
                    let mut cells: Vec<Cell> = places
                        .iter()
                        .map(|place| place.map_or(Cell::Missing, |i| row[i].clone()))
                        .collect();
                    cells[0] = Cell::Text(part.name.clone());
                    csv.row(&cells).map_err(wrong)?;
                }
            }
        }
        Ok(bytes)
    }
}
