//! The rows of a sweep on their way out.

use super::super::interrupt;
use super::super::progress::Progress;
use super::super::report::{Report, unit_names};
use super::super::words::{count, several, time};
use super::file;
use std::io::{self, IsTerminal, Write};
use std::ops::ControlFlow;
use std::path::Path;
use twinslip::error::Result;
use twinslip::section::Regime;
use twinslip::sweep::SweepRow;
use twinslip_output::{Format, RowWriter, Status};
use twinslip_tasks::scene::{Column, Described, SweepPlan};
use twinslip_tasks::views::{self, Dot, REGIMES};

/// Takes rows in their order: writes, counts and, where they are needed once more, keeps them.
pub struct SweepOut<'a> {
    plan: &'a SweepPlan,
    report: &'a Report<'a>,
    pub columns: &'a [Column<SweepRow>],
    /// Of the rows of a diagram, which then are in the place of those.
    pub of_dots: Option<Vec<Column<Dot>>>,
    to: SweepSink,
    /// Where the rows of an earlier run end.
    torn: u64,
    keeps: bool,
    /// Rows for the picture and the object.
    pub rows: Vec<SweepRow>,
    counts: [usize; REGIMES.len()],
    /// Rows of this run.
    pub new: usize,
    /// What went wrong with writing.
    pub broken: Option<io::Error>,
    pub progress: Progress,
}

enum SweepSink {
    Nothing,
    Lines(Box<dyn Write>),
    Table(Box<dyn RowWriter>),
}

impl<'a> SweepOut<'a> {
    pub fn new(
        plan: &'a SweepPlan,
        report: &'a Report<'a>,
        columns: &'a [Column<SweepRow>],
        drawn: bool,
    ) -> Self {
        // Rows that scroll by on the terminal are progress enough.
        let scrolling = report.format != Format::Json
            && report.place.path().is_none()
            && io::stdout().is_terminal();
        SweepOut {
            plan,
            report,
            columns,
            of_dots: plan
                .diagram
                .as_ref()
                .map(|diagram| views::diagram_columns(&plan.layout, diagram, plan.settings.starts)),
            to: SweepSink::Nothing,
            torn: 0,
            keeps: drawn || report.repeats(),
            rows: Vec::new(),
            counts: [0; REGIMES.len()],
            new: 0,
            broken: None,
            progress: report.call.progress(report.quiet || scrolling),
        }
    }

    /// Reads the rows of an earlier run, and says of how many units they are.
    pub fn keep(&mut self, path: &Path, columns: &[Column<SweepRow>]) -> Result<usize> {
        let plan = self.plan;
        let place = file::regime_place(columns);
        let mut unreadable = None;
        let standing = file::read(path, plan, columns, &mut |number, cells| {
            let name = cells.get(place).map(String::as_str);
            let regime = REGIMES
                .iter()
                .position(|regime| Some(regime.name()) == name);
            let row = self.keeps.then(|| file::row(plan, columns, number, cells));
            match (regime, row) {
                (Some(regime), None) => self.counts[regime] += 1,
                (Some(regime), Some(Some(row))) => {
                    self.counts[regime] += 1;
                    self.rows.push(row);
                }
                _ => unreadable = Some(cells.join(",")),
            }
        })?;
        if let Some(line) = unreadable {
            return Err(file::wrong(path, format!("the row {line:?} can't be read")));
        }
        self.torn = standing.bytes;
        Ok(standing.units)
    }

    /// Begins the table or CSV, or goes on with that of an earlier run after what is whole in it.
    pub fn open(&mut self, resumed: bool) -> io::Result<()> {
        let report = self.report;
        self.to = match report.format {
            Format::Json if !report.streams() => SweepSink::Nothing,
            Format::Table | Format::Json => {
                let in_table = report.format == Format::Table;
                let names = match &self.of_dots {
                    Some(columns) => views::names(columns, in_table),
                    None => views::names(self.columns, in_table),
                };
                let (names, quantities): (Vec<_>, Vec<_>) = names.into_iter().unzip();
                let units = unit_names(self.plan.system.units(), quantities.into_iter());
                let remarks = file::remarks(self.plan, self.plan.shard);
                SweepSink::Table(report.begin(remarks, &names, &units)?)
            }
            Format::Csv if resumed && self.torn > 0 => SweepSink::Lines(report.stream(self.torn)?),
            Format::Csv => {
                let mut to = report.stream(0)?;
                let status = report.file.as_ref().map(|_| Status::Unfinished);
                let beginning = match &self.of_dots {
                    Some(columns) => file::beginning(self.plan, None, columns, status),
                    None => file::beginning(self.plan, self.plan.shard, self.columns, status),
                };
                to.write_all(&beginning)?;
                to.flush()?;
                SweepSink::Lines(to)
            }
        };
        Ok(())
    }

    /// Says in the file how far its rows are.
    pub fn end(&self, interrupted: bool) -> Result<()> {
        self.report.end(match interrupted {
            true => Status::Unfinished,
            false => Status::Complete(Some(self.counts.iter().sum())),
        })
    }

    /// The next rows.
    pub fn take(&mut self, rows: &[SweepRow]) -> ControlFlow<()> {
        let told = rows.iter().map(|row| SweepRow {
            note: row.note.as_deref().map(|note| self.report.call.told(note)),
            ..row.clone()
        });
        let rows: &[SweepRow] = &told.collect::<Vec<_>>();
        if let Err(error) = self.write(rows) {
            self.broken = Some(error);
            return ControlFlow::Break(());
        }
        for row in rows {
            let regime = REGIMES.iter().position(|&regime| regime == row.regime);
            self.counts[regime.expect("all regimes are listed")] += 1;
        }
        if self.keeps {
            self.rows.extend_from_slice(rows);
            if matches!(self.to, SweepSink::Nothing) {
                interrupt::holds();
            }
        }
        self.new += rows.len();
        let all: usize = self.counts.iter().sum();
        self.progress.come(all as f64 / self.plan.rows() as f64);
        ControlFlow::Continue(())
    }

    fn write(&mut self, rows: &[SweepRow]) -> io::Result<()> {
        let table = self.report.format == Format::Table;
        match &mut self.to {
            SweepSink::Nothing => Ok(()),
            SweepSink::Lines(to) => {
                to.write_all(&match &self.of_dots {
                    Some(columns) => file::dot_lines(self.plan, columns, rows),
                    None => file::lines(self.plan, self.columns, rows),
                })?;
                to.flush()
            }
            SweepSink::Table(writer) => {
                let units = self.plan.system.units();
                rows.iter().try_for_each(|row| match &self.of_dots {
                    Some(columns) => views::dots(row, self.plan.settings.starts)
                        .try_for_each(|dot| writer.row(&views::cells(columns, &dot, units, table))),
                    None => writer.row(&views::cells(self.columns, row, units, table)),
                })
            }
        }
    }

    /// How many rows there are of each regime, those of an earlier run included.
    pub fn regimes(&self) -> impl Iterator<Item = (&'static str, usize)> {
        let names = REGIMES.iter().map(|regime| regime.name());
        names.zip(self.counts)
    }

    /// How many rows are undecided, those of an earlier run included.
    pub fn undecided(&self) -> usize {
        let undecided = REGIMES.iter().zip(self.counts);
        undecided
            .filter(|(regime, _)| **regime == Regime::Undecided)
            .map(|(_, count)| count)
            .sum()
    }

    /// One line.
    pub fn summary(&self, seconds: f64) -> String {
        let rate = self.new as f64 / seconds.max(f64::MIN_POSITIVE);
        let regimes: Vec<String> = self
            .regimes()
            .filter(|(_, count)| *count > 0)
            .map(|(name, number)| format!("{} {name}", count(number)))
            .collect();
        let earlier = self.counts.iter().sum::<usize>() - self.new;
        let earlier = match earlier {
            0 => String::new(),
            n => format!(" after {} of an earlier run", count(n)),
        };
        format!(
            "{}{earlier} in {}, {} a second: {}",
            several(self.new, "point", "points"),
            time(seconds),
            if rate < 10.0 {
                format!("{rate:.1}")
            } else {
                count(rate as usize)
            },
            regimes.join(", ")
        )
    }
}
