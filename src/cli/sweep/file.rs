//! The CSV of a sweep: remarks that say which sweep it is, and one line for each row in the order of the grid. So a file of an
//! interrupted sweep is the beginning of that of a finished one, and going on is to cut the torn line and to append.

use super::super::report;
use super::super::resume::same;
use crate::error::{Error, Result};
use crate::output::{CsvRows, EarlierRows, RowWriter, shortest};
use crate::scene::{Quantity, Shard, SweepPlan};
use crate::sweep::Row;
use crate::views::{self, Column};
use std::fs::File;
use std::io::{BufRead, BufReader, ErrorKind, Read};
use std::path::Path;

/// What the remark on a part begins with.
const SHARD: &str = "shard: ";
/// No line of remarks or rows is longer.
const LONGEST_LINE: u64 = 1 << 16;
/// No sweep has more remarks.
const MOST_REMARKS: usize = 100;

/// The remarks of a sweep; its part, if it is one, is told in the last.
pub fn remarks(plan: &SweepPlan, shard: Option<Shard>) -> Vec<String> {
    let mut remarks = report::remarks(&plan.canonical, &plan.system, &plan.numerics);
    remarks.extend(shard.map(|shard| format!("{SHARD}{shard}")));
    remarks
}

/// What the file begins with: remarks and names of columns.
pub fn beginning(plan: &SweepPlan, shard: Option<Shard>, columns: &[Column<Row>]) -> Vec<u8> {
    let names = views::names(columns, false);
    let names: Vec<String> = names.into_iter().map(|(name, _)| name).collect();
    let mut bytes = Vec::new();
    CsvRows::new(&mut bytes, &remarks(plan, shard), &names).expect("memory can be written");
    bytes
}

/// Rows as lines.
pub fn lines(plan: &SweepPlan, columns: &[Column<Row>], rows: &[Row]) -> Vec<u8> {
    let mut bytes = Vec::new();
    {
        let mut writer = CsvRows::continued(&mut bytes);
        for row in rows {
            let cells = views::cells(columns, row, &plan.system.units, false);
            writer.row(&cells).expect("memory can be written");
        }
    }
    bytes
}

/// How far a file has come.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq)]
pub struct Standing {
    /// Units whose rows are complete.
    pub units: usize,
    /// Where the last of these rows ends; what follows is torn.
    pub bytes: u64,
}

/// Reads a file up to its last complete unit and shows the line of each row that stays, with the row's number.
///
/// Nothing stays of a file that does not exist or ends before its first row.
///
/// # Errors
/// [`Error::File`] if it can't be read; [`Error::Input`] if it is of another sweep, or has rows that do not belong where they
/// are.
pub fn read(
    path: &Path,
    plan: &SweepPlan,
    columns: &[Column<Row>],
    kept: &mut dyn FnMut(usize, &str),
) -> Result<Standing> {
    let mut file = match File::open(path) {
        Ok(file) => BufReader::new(file),
        Err(error) if error.kind() == ErrorKind::NotFound => return Ok(Standing::default()),
        Err(error) => return Err(unreadable(path, error)),
    };
    let expected = beginning(plan, plan.shard, columns);
    if !begins_with(path, &mut file, &expected)? {
        return Ok(Standing::default());
    }
    let (per_unit, part) = (plan.rows_per_unit(), plan.part());
    let mut standing = Standing {
        units: 0,
        bytes: expected.len() as u64,
    };
    let (mut lines, mut length) = (Vec::new(), 0);
    while let Some(line) = whole_line(path, &mut file)? {
        let unit = part.unit(standing.units);
        let number = unit * per_unit + lines.len();
        if standing.units >= part.units(plan.settings.units()) {
            return Err(wrong(path, "it has more rows than the sweep"));
        }
        if !belongs(plan, number, &line) {
            let which = standing.units * per_unit + lines.len() + 1;
            return Err(wrong(path, format!("row {which} is not that of its point")));
        }
        length += line.len() as u64 + 1;
        lines.push(line);
        if lines.len() == per_unit {
            for (i, line) in lines.drain(..).enumerate() {
                kept(unit * per_unit + i, &line);
            }
            standing.units += 1;
            standing.bytes += std::mem::take(&mut length);
        }
    }
    Ok(standing)
}

/// Whether a file begins with this; not if it is torn before.
fn begins_with(path: &Path, file: &mut impl BufRead, expected: &[u8]) -> Result<bool> {
    let mut found = Vec::new();
    file.take(expected.len() as u64)
        .read_to_end(&mut found)
        .map_err(|error| unreadable(path, error))?;
    if found == expected {
        return Ok(true);
    }
    if expected.starts_with(&found) {
        return Ok(false);
    }
    // Another sweep: its remarks to their end say in what it differs.
    let mut rest = Vec::new();
    file.take(LONGEST_LINE)
        .read_to_end(&mut rest)
        .map_err(|error| unreadable(path, error))?;
    found.extend(rest);
    let text = |bytes: &[u8]| String::from_utf8_lossy(bytes).into_owned();
    Err(wrong(path, difference(&text(&found), &text(expected))))
}

/// In what the first lines of a file differ from those of this sweep.
fn difference(found: &str, expected: &str) -> String {
    let (theirs, ours) = (EarlierRows::read(found), EarlierRows::read(expected));
    let shard = |rows: &EarlierRows| {
        let remark = rows.remarks.iter().find(|remark| remark.starts_with(SHARD));
        remark.map_or("of the whole sweep".to_owned(), |remark| {
            format!("of the part {}", &remark[SHARD.len()..])
        })
    };
    if !theirs
        .remarks
        .iter()
        .any(|r| r.starts_with("command: twinslip sweep"))
    {
        return "it is not the CSV of a sweep".into();
    }
    if let Err(why) = same(&theirs, &ours.remarks, &ours.columns) {
        return why;
    }
    if shard(&theirs) != shard(&ours) {
        return format!("it is {}, but this run is {}", shard(&theirs), shard(&ours));
    }
    match (theirs.remarks.first(), ours.remarks.first()) {
        (Some(theirs), Some(ours)) if theirs != ours => {
            format!("it was written by {theirs}, but this is {ours}")
        }
        _ => "its first lines are not those of this sweep".into(),
    }
}

/// The next line if it is complete.
pub fn whole_line(path: &Path, file: &mut impl BufRead) -> Result<Option<String>> {
    let mut line = Vec::new();
    file.take(LONGEST_LINE)
        .read_until(b'\n', &mut line)
        .map_err(|error| unreadable(path, error))?;
    if line.pop() != Some(b'\n') {
        return Ok(None);
    }
    String::from_utf8(line)
        .map(Some)
        .map_err(|_| wrong(path, "a row is no text"))
}

/// Whether a line begins with V_H and K of a row of that number.
fn belongs(plan: &SweepPlan, number: usize, line: &str) -> bool {
    let units = &plan.system.units;
    let (driving, stiffness) = plan.loading(number);
    let mut cells = line.split(',');
    cells.next() == Some(&*shortest(units.outward(Quantity::SlipRate, driving)))
        && cells.next() == Some(&*shortest(units.outward(Quantity::Stiffness, stiffness)))
}

/// A row from its line; `None` if the line is none.
pub fn row(plan: &SweepPlan, columns: &[Column<Row>], number: usize, line: &str) -> Option<Row> {
    let names = views::names(columns, false);
    let cells = crate::output::cells_of(line)?;
    let cell = |name: &str| {
        let at = names.iter().position(|(one, _)| one == name);
        at.and_then(|at| cells.get(at)).map_or("", String::as_str)
    };
    views::sweep_row(number, &cell, &plan.system.units)
}

/// The regime that the line of a row tells.
pub fn regime(line: &str) -> &str {
    line.split(',').nth(2).unwrap_or_default()
}

/// The remarks of a sweep's file, without `# `.
pub fn remarks_of(path: &Path) -> Result<Vec<String>> {
    let mut file = BufReader::new(File::open(path).map_err(|error| unreadable(path, error))?);
    let mut remarks = Vec::new();
    while let Some(line) = whole_line(path, &mut file)? {
        match line.strip_prefix("# ") {
            Some(_) if remarks.len() == MOST_REMARKS => {
                return Err(wrong(path, "it is not the CSV of a sweep"));
            }
            Some(remark) => remarks.push(remark.to_owned()),
            None => break,
        }
    }
    Ok(remarks)
}

/// The plan of the sweep that a file is of, with its part.
///
/// # Errors
/// [`Error::File`] and [`Error::Input`].
pub fn plan_of(path: &Path) -> Result<SweepPlan> {
    let remarks = remarks_of(path)?;
    let told = |subject: &str| {
        let mut found = remarks
            .iter()
            .filter_map(|remark| remark.strip_prefix(subject));
        found.next()
    };
    let Some(command) = told("command: ") else {
        return Err(wrong(path, "it is not the CSV of a sweep"));
    };
    let within = |error: Error| wrong(path, error);
    let mut plan = SweepPlan::of_command(command).map_err(within)?;
    plan.shard = told(SHARD).map(Shard::parse).transpose().map_err(within)?;
    Ok(plan)
}

/// A file that is not what it should be.
pub fn wrong(path: &Path, why: impl std::fmt::Display) -> Error {
    Error::Input(format!("{}: {why}", path.display()))
}

/// A file that the system does not give.
pub fn unreadable(path: &Path, error: std::io::Error) -> Error {
    Error::File {
        action: "read",
        path: path.to_owned(),
        reason: error.to_string(),
    }
}
