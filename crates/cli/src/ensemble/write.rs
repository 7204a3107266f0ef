//! An ensemble on its way out: the rows of the estimate with what is added to them.

use super::added::Added;
use super::member::Yield;
use crate::Ending;
use crate::report::{Report, remarks_of};
use crate::resume::beside;
use crate::written;
use serde_json::{Map, Value};
use std::io::{self, Write};
use twinslip::error::Result;
use twinslip_output::{Cell, CsvRows, Format, Over, Place, RowFile, RowWriter, Status};

/// The estimate with what is added, and where it goes.
pub struct Finished<'a> {
    /// Where to.
    pub report: &'a Report<'a>,
    /// The estimate; what is added is in its object already.
    pub estimate: Yield,
    /// What is added.
    pub parts: Parts,
    /// Whether all that was asked for is there.
    pub whole: bool,
}

/// What is added to an estimate.
pub struct Parts {
    /// To its rows.
    pub rows: Added,
    /// To its special points.
    pub special: Added,
    /// Remarks, and messages.
    pub lines: Vec<String>,
    /// Whether a program takes rows by columns, and not in the object.
    pub streams: bool,
    /// The file of special points, where there is one.
    pub special_file: Option<RowFile>,
}

impl Parts {
    /// Without special points.
    pub fn of_rows(rows: Added, lines: Vec<String>, streams: bool) -> Self {
        Parts {
            rows,
            special: Added::default(),
            lines,
            streams,
            special_file: None,
        }
    }
}

/// The file of special points beside that of rows, claimed before anything is computed.
///
/// # Errors
/// [`twinslip::Error::File`] if it can't be written, or holds what must not be lost.
pub fn claim_special(report: &Report<'_>, force: bool) -> Result<Option<RowFile>> {
    let csv = report.file.is_some() && report.format == Format::Csv;
    match report.place.path().filter(|_| csv) {
        Some(path) => RowFile::claim(&beside(path), if force { Over::All } else { Over::Ours }),
        None => Ok(None),
    }
}

impl Finished<'_> {
    /// Writes all of it.
    ///
    /// # Errors
    /// [`twinslip::Error::File`] if a file can't be written.
    pub fn write(self) -> Result<Ending> {
        let report = self.report;
        if report.format != Format::Json {
            let rows = written(self.write_rows(), &report.place);
            if !self.whole && rows.is_ok() {
                report.end(Status::Unfinished)?;
            } else {
                report.ended(rows.clone())?;
            }
            return self.write_special().and(rows);
        }
        if report.streams() && self.parts.streams {
            let (columns, units) = self.named();
            let begun = report.begin(Vec::new(), &columns, &units);
            let all = begun.and_then(|mut to| self.each_row(|cells| to.row(cells)));
            written(all, &Place::Standard)?;
        }
        let mut object = self.estimate.object;
        if report.streams() && self.parts.streams {
            // Those that were handed on need not be there twice.
            object["result"]["rows"] = Value::Array(Vec::new());
        }
        let mut bytes = serde_json::to_vec(&object).expect("it was read as JSON");
        bytes.push(b'\n');
        report.write(&bytes)
    }

    fn remarks(&self) -> Vec<String> {
        let object = &self.estimate.object;
        let (nothing, units) = (Map::new(), object["units"].as_object());
        let units: Vec<(&str, &str)> = units
            .unwrap_or(&nothing)
            .iter()
            .map(|(name, unit)| (name.as_str(), unit.as_str().unwrap_or_default()))
            .collect();
        let echo = object["model"].as_object().unwrap_or(&nothing);
        let words = &self.report.call.words;
        let mut remarks = remarks_of(words, echo, &object["numerics"], &units);
        remarks.extend(self.parts.lines.iter().cloned());
        remarks
    }

    /// All columns, and their units.
    fn named(&self) -> (Vec<String>, Vec<String>) {
        let both = |own: &[String], added: &[String]| [own, added].concat();
        (
            both(&self.estimate.columns, &self.parts.rows.columns),
            both(&self.estimate.units, &self.parts.rows.units),
        )
    }

    fn each_row(&self, mut write: impl FnMut(&[Cell]) -> io::Result<()>) -> io::Result<()> {
        for (i, row) in self.estimate.rows.iter().enumerate() {
            let added = self.parts.rows.rows.get(i).map_or(&[][..], Vec::as_slice);
            let mut cells = [row, added].concat();
            cells.resize(row.len() + self.parts.rows.columns.len(), Cell::Missing);
            write(&cells)?;
        }
        Ok(())
    }

    fn write_rows(&self) -> io::Result<()> {
        let (columns, units) = self.named();
        let shown = shown(&columns, self.report.format == Format::Table);
        let pick =
            |all: &[String]| -> Vec<String> { shown.iter().map(|&i| all[i].clone()).collect() };
        let mut to = self
            .report
            .begin(self.remarks(), &pick(&columns), &pick(&units))?;
        self.each_row(|cells| {
            let cells: Vec<Cell> = shown.iter().map(|&i| cells[i].clone()).collect();
            to.row(&cells)
        })
    }

    fn write_special(&self) -> Result<()> {
        let Some(file) = &self.parts.special_file else {
            return Ok(());
        };
        let estimate = &self.estimate;
        let columns = [&estimate.special_columns[..], &self.parts.special.columns].concat();
        let mut remarks = self.remarks();
        remarks.push(Status::Unfinished.remark());
        let write = || -> io::Result<()> {
            let mut to = file.after(0)?;
            to.write_all(&twinslip_output::head(&remarks, &columns))?;
            let mut to = CsvRows::after(to);
            for (i, one) in estimate.special.iter().enumerate() {
                let added = self.parts.special.rows.get(i).cloned();
                let mut cells = [&one[..], &added.unwrap_or_default()].concat();
                cells.resize(columns.len(), Cell::Missing);
                to.row(&cells)?;
            }
            Ok(())
        };
        let place = Place::File(beside(self.report.place.path().unwrap_or("-".as_ref())));
        written(write(), &place)?;
        file.end(match self.whole {
            true => Status::Complete(Some(estimate.special.len())),
            false => Status::Unfinished,
        })
    }
}

/// Which columns are shown, in which order: in a table, which has less room, the ends of a band beside the number and no error budgets.
fn shown(columns: &[String], table: bool) -> Vec<usize> {
    if !table {
        return (0..columns.len()).collect();
    }
    let aside = |name: &str| {
        ["_uncertainty", "_im", "residual", "note"]
            .iter()
            .any(|end| name.ends_with(end))
            || ["log_state", "start_", "eigenvalue_uncertainty"]
                .iter()
                .any(|begin| name.starts_with(begin))
    };
    let is_end = |name: &str| name.ends_with("_lower") || name.ends_with("_upper");
    let place = |name: &str| columns.iter().position(|own| own == name);
    let mut shown = Vec::with_capacity(columns.len());
    for (i, name) in columns.iter().enumerate() {
        if aside(name) || is_end(name) {
            continue;
        }
        shown.push(i);
        shown.extend(
            ["lower", "upper"]
                .iter()
                .filter_map(|end| place(&format!("{name}_{end}"))),
        );
    }
    shown
}
