//! The rows of a sweep on their way out.

use super::super::progress::Progress;
use super::super::report::{Report, unit_names};
use super::file;
use crate::error::Result;
use crate::output::{Format, RowWriter};
use crate::scene::SweepPlan;
use crate::section::Regime;
use crate::sweep::Row;
use crate::views::{self, Column, REGIMES};
use std::fs::OpenOptions;
use std::io::{self, IsTerminal, Write};
use std::ops::ControlFlow;
use std::path::Path;

/// Takes rows in their order: writes, counts and, where they are needed once more, keeps them.
pub struct Out<'a> {
    plan: &'a SweepPlan,
    report: &'a Report<'a>,
    pub columns: &'a [Column<Row>],
    to: To,
    /// Where the rows of an earlier run end.
    torn: u64,
    keeps: bool,
    /// Rows for the picture and the object.
    pub rows: Vec<Row>,
    counts: [usize; REGIMES.len()],
    /// Rows of this run.
    pub new: usize,
    /// What went wrong with writing.
    pub broken: Option<io::Error>,
    pub progress: Progress,
}

enum To {
    Nothing,
    Lines(Box<dyn Write>),
    Table(Box<dyn RowWriter>),
}

impl<'a> Out<'a> {
    pub fn new(
        plan: &'a SweepPlan,
        report: &'a Report<'a>,
        columns: &'a [Column<Row>],
        drawn: bool,
    ) -> Self {
        // Rows that scroll by on the terminal are progress enough.
        let scrolling = report.format != Format::Json
            && report.place.path().is_none()
            && io::stdout().is_terminal();
        Out {
            plan,
            report,
            columns,
            to: To::Nothing,
            torn: 0,
            keeps: drawn || report.format == Format::Json,
            rows: Vec::new(),
            counts: [0; REGIMES.len()],
            new: 0,
            broken: None,
            progress: Progress::new(report.quiet || scrolling),
        }
    }

    /// Reads the rows of an earlier run, and says of how many units they are.
    pub fn keep(&mut self, path: &Path, columns: &[Column<Row>]) -> Result<usize> {
        let plan = self.plan;
        let mut unreadable = None;
        let standing = file::read(path, plan, columns, &mut |number, line| {
            let name = file::regime(line);
            let regime = REGIMES.iter().position(|regime| regime.name() == name);
            let row = self.keeps.then(|| file::row(plan, columns, number, line));
            match (regime, row) {
                (Some(regime), None) => self.counts[regime] += 1,
                (Some(regime), Some(Some(row))) => {
                    self.counts[regime] += 1;
                    self.rows.push(row);
                }
                _ => unreadable = Some(line.to_owned()),
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
        let place = &self.report.place;
        let stream = || place.stream().map_err(io::Error::other);
        let remarks = file::remarks(self.plan, self.plan.shard);
        self.to = match (self.report.format, place.path()) {
            (Format::Json, _) => To::Nothing,
            (Format::Table, _) => {
                let names = views::names(self.columns, true);
                let (names, quantities): (Vec<_>, Vec<_>) = names.into_iter().unzip();
                let units = unit_names(&self.plan.system.units, quantities.into_iter());
                To::Table(self.report.rows(stream()?, &remarks, &names, &units)?)
            }
            (Format::Csv, Some(path)) if resumed && self.torn > 0 => {
                let file = OpenOptions::new().append(true).open(path)?;
                file.set_len(self.torn)?;
                To::Lines(Box::new(file))
            }
            (Format::Csv, _) => {
                let mut to = stream()?;
                to.write_all(&file::beginning(self.plan, self.plan.shard, self.columns))?;
                to.flush()?;
                To::Lines(to)
            }
        };
        Ok(())
    }

    /// The next rows.
    pub fn take(&mut self, rows: &[Row]) -> ControlFlow<()> {
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
        }
        self.new += rows.len();
        let all: usize = self.counts.iter().sum();
        self.progress.come(all as f64 / self.plan.rows() as f64);
        ControlFlow::Continue(())
    }

    fn write(&mut self, rows: &[Row]) -> io::Result<()> {
        match &mut self.to {
            To::Nothing => Ok(()),
            To::Lines(to) => {
                to.write_all(&file::lines(self.plan, self.columns, rows))?;
                to.flush()
            }
            To::Table(writer) => rows.iter().try_for_each(|row| {
                let units = &self.plan.system.units;
                writer.row(&views::cells(self.columns, row, units, true))
            }),
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
            .map(|(name, count)| format!("{count} {name}"))
            .collect();
        let earlier = self.counts.iter().sum::<usize>() - self.new;
        let earlier = match earlier {
            0 => String::new(),
            n => format!(" after {n} of an earlier run"),
        };
        format!(
            "{} points{earlier} in {seconds:.3} s, {rate:.1} a second: {}",
            self.new,
            regimes.join(", ")
        )
    }
}
