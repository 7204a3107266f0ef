//! Comma-separated values, all digits, flushed row by row: what is written is not lost, however the run ends.

use super::{Cell, RowWriter, shortest};
use std::io::{Result, Write};

/// Writes rows as CSV.
pub struct CsvRows<W: Write> {
    writer: csv::Writer<W>,
}

impl<W: Write> CsvRows<W> {
    /// Writes the remarks as `# ` lines, then the header.
    ///
    /// # Errors
    /// Those of the file or pipe.
    pub fn new(mut to: W, remarks: &[String], columns: &[String]) -> Result<Self> {
        for remark in remarks {
            writeln!(to, "# {remark}")?;
        }
        let mut writer = csv::Writer::from_writer(to);
        writer.write_record(columns)?;
        writer.flush()?;
        Ok(CsvRows { writer })
    }
}

impl<W: Write> RowWriter for CsvRows<W> {
    fn row(&mut self, cells: &[Cell]) -> Result<()> {
        for cell in cells {
            match cell {
                Cell::Number(x) => self.writer.write_field(shortest(*x))?,
                Cell::Text(text) => self.writer.write_field(text)?,
                Cell::Missing => self.writer.write_field("")?,
            }
        }
        self.writer.write_record(None::<&[u8]>)?;
        self.writer.flush()
    }
}
