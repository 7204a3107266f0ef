//! Rows and objects to files, pipes and terminals. Knows columns and cells, nothing of what they mean.

mod csv;
mod json;
pub mod page;
mod place;
pub mod plot;
mod rowfile;
mod table;

pub use csv::{
    CsvRows, Head, ROW_CHECK, check_sum, checked_cells, checked_line, damage, head, whole_line,
};
pub use json::{Envelope, RowList, object, uncertain};
pub use place::{Place, remove_temporary, write_whole, write_whole_by};
pub use rowfile::{OURS, Over, RowFile, Status};
pub use table::{TableRows, number as seven_digits};

use error::{Error, Result};
use std::path::Path;
pub(crate) use twinslip_error as error;

/// In which form data is written.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Format {
    /// Columns for the eye, seven digits.
    Table,
    /// Comma-separated values with all digits, after `# ` lines that say where they come from.
    Csv,
    /// One object.
    Json,
}

impl Format {
    /// What `--format` takes.
    pub const NAMES: [&'static str; 3] = ["table", "csv", "json"];

    /// The format of that name; without one, by the ending of the file's name (`.json`; `.csv`, `.txt`, `.dat` or none); without
    /// a file, a table on a terminal, else CSV.
    ///
    /// # Errors
    /// [`Error::Parameter`] for a name that is none, [`Error::Input`] for an ending that is that of another format.
    pub fn choose(name: Option<&str>, file: Option<&Path>, terminal: bool) -> Result<Self> {
        match name {
            Some("table") => return Ok(Format::Table),
            Some("csv") => return Ok(Format::Csv),
            Some("json") => return Ok(Format::Json),
            Some(other) => return Err(Error::unknown("format", other, &Format::NAMES)),
            None => {}
        }
        let Some(file) = file else {
            return Ok(if terminal { Format::Table } else { Format::Csv });
        };
        let ending = file.extension().map(|e| e.to_string_lossy().to_lowercase());
        match ending.as_deref() {
            Some("json") => Ok(Format::Json),
            None | Some("csv" | "txt" | "dat") => Ok(Format::Csv),
            Some(other) => Err(Error::Input(format!(
                "`output` {}: data is written as .csv or .json, not as .{other}; choose such a name, or say `format`{}",
                file.display(),
                match other {
                    "svg" | "png" => "; pictures are drawn by `plot`",
                    "parquet" => "; Parquet is written by sweep alone",
                    _ => "",
                }
            ))),
        }
    }
}

/// One entry of a row.
#[derive(Debug, Clone, PartialEq)]
pub enum Cell {
    /// A number; one that is not finite is written as missing.
    Number(f64),
    /// A word.
    Text(String),
    /// Not known, or none.
    Missing,
}

impl From<f64> for Cell {
    fn from(x: f64) -> Self {
        Cell::Number(x)
    }
}

impl From<Option<f64>> for Cell {
    fn from(x: Option<f64>) -> Self {
        x.map_or(Cell::Missing, Cell::Number)
    }
}

impl From<&str> for Cell {
    fn from(text: &str) -> Self {
        Cell::Text(text.to_owned())
    }
}

/// Takes rows one by one, each complete in the file when the call returns.
pub trait RowWriter {
    /// A row of cells, as many as there are columns.
    ///
    /// # Errors
    /// Those of the file or pipe.
    fn row(&mut self, cells: &[Cell]) -> std::io::Result<()>;
}

/// The shortest decimal that reads back as the same double; empty if it is not finite.
pub fn shortest(x: f64) -> String {
    if x.is_finite() {
        serde_json::to_string(&x).expect("a finite number can be written")
    } else {
        String::new()
    }
}
