//! The rows of a run on their way out: written as they come, kept, or both.

use super::call::Call;
use super::progress::Progress;
use super::report::{Report, unit_names};
use std::io;
use twinslip::integrate::Control;
use twinslip_output::{Cell, CsvRows, RowList, RowWriter};
use twinslip_tasks::scene::{Quantity, Sink, Units};

/// Takes the rows of a run.
pub struct StreamOut<'a> {
    writer: Option<Box<dyn RowWriter>>,
    /// What went wrong with writing.
    pub broken: Option<io::Error>,
    keep: bool,
    counts: bool,
    /// What is kept.
    pub rows: RowList,
    /// Points of the picture.
    pub drawn: RowList,
    cells: Vec<Cell>,
    pub progress: Progress,
    call: &'a Call,
}

impl<'a> StreamOut<'a> {
    /// Begins the table or CSV, below remarks. Rows are kept for an object anyway.
    pub fn new(
        report: &Report<'a>,
        remarks: Vec<String>,
        (columns, units): (Vec<(String, Quantity)>, &Units),
        keep: bool,
    ) -> io::Result<Self> {
        if !report.streams() {
            return Ok(Self::kept(report, columns));
        }
        let (names, quantities): (Vec<_>, Vec<_>) = columns.iter().cloned().unzip();
        let units = unit_names(units, quantities.into_iter());
        Ok(StreamOut {
            keep,
            writer: Some(report.begin(remarks, &names, &units)?),
            ..Self::kept(report, columns)
        })
    }

    /// Goes on with the CSV of an earlier run, after so many bytes of it.
    pub fn after(
        report: &Report<'a>,
        columns: Vec<(String, Quantity)>,
        bytes: u64,
    ) -> io::Result<Self> {
        Ok(StreamOut {
            keep: false,
            writer: Some(Box::new(CsvRows::after(report.stream(bytes)?))),
            ..Self::kept(report, columns)
        })
    }

    /// Writes nothing, and keeps the rows.
    pub fn kept(report: &Report<'a>, columns: Vec<(String, Quantity)>) -> Self {
        StreamOut {
            keep: true,
            writer: None,
            broken: None,
            counts: false,
            rows: RowList::new(columns.into_iter().map(|(name, _)| name).collect()),
            drawn: RowList::default(),
            cells: Vec::new(),
            progress: report.progress(),
            call: report.call,
        }
    }

    /// The first column counts: its whole numbers need no point.
    pub fn counting(self) -> Self {
        StreamOut {
            counts: true,
            ..self
        }
    }

    /// The picture has these columns.
    pub fn drawing(self, columns: Vec<(String, Quantity)>) -> Self {
        StreamOut {
            drawn: RowList::new(columns.into_iter().map(|(name, _)| name).collect()),
            ..self
        }
    }
}

impl Sink for StreamOut<'_> {
    fn row(&mut self, row: &[f64]) -> Control {
        if self.keep {
            self.rows.numbers.extend_from_slice(row);
        }
        if let Some(writer) = &mut self.writer {
            self.cells.clear();
            self.cells.extend(
                row.iter()
                    .map(|&x| Cell::from(Some(x).filter(|x| !x.is_nan()))),
            );
            if self.counts {
                self.cells[0] = Cell::Text(format!("{}", row[0]));
            }
            if let Err(error) = writer.row(&self.cells) {
                self.broken = Some(error);
                return Control::Stop;
            }
        }
        Control::Continue
    }

    fn drawn(&mut self, point: &[f64]) {
        self.drawn.numbers.extend_from_slice(point);
        self.call.draws(self.drawn.numbers.len());
    }

    fn reached(&mut self, fraction: f64) -> Control {
        self.progress.reached(fraction);
        if self.call.stops() {
            Control::Stop
        } else {
            Control::Continue
        }
    }
}
