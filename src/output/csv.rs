//! Comma-separated values, all digits, flushed row by row: what is written is not lost, however the run ends.

use super::{Cell, RowWriter, shortest};
use std::io::{Result, Write};

/// CSV of an earlier run, which may have been cut off at any byte.
#[derive(Debug, Clone, Default, PartialEq)]
pub struct EarlierRows {
    /// The remarks, without `# `.
    pub remarks: Vec<String>,
    /// The names of the columns.
    pub columns: Vec<String>,
    /// The rows that are complete, as they stand.
    pub lines: Vec<String>,
}

impl EarlierRows {
    /// From the text of a file whose cells need no quotes.
    pub fn read(text: &str) -> Self {
        let mut earlier = EarlierRows::default();
        // What follows the last line break was being written when the run ended.
        let whole = text.rfind('\n').map_or("", |end| &text[..end]);
        for line in whole.lines() {
            if let Some(remark) = line.strip_prefix("# ") {
                earlier.remarks.push(remark.to_owned());
            } else if earlier.columns.is_empty() {
                earlier.columns = line.split(',').map(str::to_owned).collect();
            } else if line.split(',').count() == earlier.columns.len() {
                earlier.lines.push(line.to_owned());
            }
        }
        earlier
    }

    /// A cell of a row by the name of its column; empty where there is none.
    pub fn cell<'a>(&self, line: &'a str, column: &str) -> &'a str {
        let at = self.columns.iter().position(|name| name == column);
        at.and_then(|at| line.split(',').nth(at))
            .unwrap_or_default()
    }
}

/// The cells of a line; `None` if its quotes do not close.
pub fn cells_of(line: &str) -> Option<Vec<String>> {
    let mut reader = csv::ReaderBuilder::new();
    let mut reader = reader.has_headers(false).from_reader(line.as_bytes());
    let record = reader.records().next()?.ok()?;
    Some(record.iter().map(str::to_owned).collect())
}

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

    /// Goes on where remarks, header and rows are written already.
    pub fn continued(to: W) -> Self {
        CsvRows {
            writer: csv::Writer::from_writer(to),
        }
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

#[cfg(test)]
mod test {
    use super::*;

    #[test]
    fn a_torn_file_is_read_up_to_its_last_whole_row() {
        let text = "# model: K = 1\na,b\n1,2\n3,4,5\n6,7\n8,9";
        let earlier = EarlierRows::read(text);
        assert_eq!(earlier.remarks, ["model: K = 1"]);
        assert_eq!(earlier.columns, ["a", "b"]);
        assert_eq!(earlier.lines, ["1,2", "6,7"]);
        assert_eq!(earlier.cell("6,7", "b"), "7");
        assert_eq!(earlier.cell("6,7", "c"), "");
        assert_eq!(EarlierRows::read("a,b"), EarlierRows::default());
    }
}
