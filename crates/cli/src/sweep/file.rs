//! The CSV of a sweep: remarks that say which sweep it is, and one line for each row in the order of the grid. So a file of an
//! interrupted sweep is the beginning of that of a finished one, and going on is to cut the torn line and to append.

use super::super::report;
use super::super::resume::same;
use std::fs::File;
use std::io::{BufRead, BufReader, ErrorKind, Read, Seek, SeekFrom};
use std::path::Path;
use twinslip::error::{Error, Result};
use twinslip::sweep::SweepRow;
use twinslip_output::{Head, ROW_CHECK, Status, checked_cells, checked_line, damage, shortest};
use twinslip_tasks::scene::{Column, Described, Quantity, Shard, SweepPlan};
use twinslip_tasks::views::{self, Dot};

/// What the remark on a part begins with.
const SHARD: &str = "shard: ";
/// No remarks are longer.
const LONGEST_HEAD: u64 = 1 << 16;

/// The remarks of a sweep; its part, if it is one, is told in the last.
pub fn remarks(plan: &SweepPlan, shard: Option<Shard>) -> Vec<String> {
    let mut remarks = report::remarks(&plan.canonical, &plan.system, &plan.numerics);
    remarks.extend(shard.map(|shard| format!("{SHARD}{shard}")));
    remarks
}

/// What the rows begin with: remarks and names of columns. In a file a remark says how far it is.
pub fn beginning<R>(
    plan: &SweepPlan,
    shard: Option<Shard>,
    columns: &[Column<R>],
    status: Option<Status>,
) -> Vec<u8> {
    let names = views::names(columns, false);
    let names = names.into_iter().map(|(name, _)| name);
    let names: Vec<String> = names.chain([ROW_CHECK.to_owned()]).collect();
    let mut remarks = remarks(plan, shard);
    remarks.extend(status.map(Status::remark));
    twinslip_output::head(&remarks, &names)
}

/// Rows as lines, checked by their numbers: so the lines of parts are those of the whole.
pub fn lines(plan: &SweepPlan, columns: &[Column<SweepRow>], rows: &[SweepRow]) -> Vec<u8> {
    let line = |row: &SweepRow| {
        let cells = views::cells(columns, row, plan.system.units(), false);
        checked_line(&row.number.to_string(), &cells)
    };
    rows.iter().map(line).collect::<String>().into_bytes()
}

/// The rows of a diagram as lines, checked by the numbers of their points.
pub fn dot_lines(plan: &SweepPlan, columns: &[Column<Dot>], rows: &[SweepRow]) -> Vec<u8> {
    let each = rows.iter().flat_map(|row| {
        views::dots(row, plan.settings.starts).map(|dot| {
            let cells = views::cells(columns, &dot, plan.system.units(), false);
            checked_line(&row.number.to_string(), &cells)
        })
    });
    each.collect::<String>().into_bytes()
}

/// How far a file has come.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq)]
pub struct Standing {
    /// Units whose rows are complete.
    pub units: usize,
    /// Where the first row begins.
    pub rows: u64,
    /// Where the last of these rows ends; what follows is torn.
    pub bytes: u64,
}

/// Reads a file up to its last complete unit and shows the cells of each row that stays, with the row's number.
///
/// Nothing stays of a file that does not exist or ends before its first row.
///
/// # Errors
/// [`Error::File`] if it can't be read; [`Error::Input`] if it is of another sweep, or has a line that is not as it was written or
/// does not belong where it is.
pub fn read(
    path: &Path,
    plan: &SweepPlan,
    columns: &[Column<SweepRow>],
    kept: &mut dyn FnMut(usize, &[String]),
) -> Result<Standing> {
    let mut file = match File::open(path) {
        Ok(file) => BufReader::new(file),
        Err(error) if error.kind() == ErrorKind::NotFound => return Ok(Standing::default()),
        Err(error) => return Err(unreadable(path, error)),
    };
    let Some(beginning) = begins(path, &mut file, plan, columns)? else {
        return Ok(Standing::default());
    };
    let (per_unit, part) = (plan.rows_per_unit(), plan.part());
    let bytes = beginning.len() as u64;
    let mut standing = Standing {
        units: 0,
        rows: bytes,
        bytes,
    };
    let mut number_of_line = beginning.iter().filter(|&&byte| byte == b'\n').count();
    let (mut rows, mut length) = (Vec::new(), 0);
    while let Some(line) = whole_line(path, &mut file)? {
        number_of_line += 1;
        let unit = part.unit(standing.units);
        let number = unit * per_unit + rows.len();
        if standing.units >= part.units(plan.settings.units()) {
            return Err(wrong(path, "it has more rows than the sweep"));
        }
        let cells = checked_cells(&line, [((), number.to_string())]);
        let Some(((), cells)) = cells.filter(|(_, cells)| belongs(plan, number, cells)) else {
            let place = standing.units * per_unit + rows.len();
            let number = |place| part.unit(place / per_unit) * per_unit + place % per_unit;
            let why = damage(&line, place, |place| [number(place).to_string()]);
            return Err(wrong(
                path,
                format!("line {number_of_line} is damaged: {why}"),
            ));
        };
        length += line.len() as u64 + 1;
        rows.push(cells);
        if rows.len() == per_unit {
            for (i, cells) in rows.drain(..).enumerate() {
                kept(unit * per_unit + i, &cells);
            }
            standing.units += 1;
            standing.bytes += std::mem::take(&mut length);
        }
    }
    Ok(standing)
}

/// What a file of this sweep begins with, its status aside; nothing if it is torn before its first row.
fn begins(
    path: &Path,
    file: &mut BufReader<File>,
    plan: &SweepPlan,
    columns: &[Column<SweepRow>],
) -> Result<Option<Vec<u8>>> {
    let marked = beginning(plan, plan.shard, columns, Some(Status::Unfinished));
    let mut found = Vec::new();
    file.take(marked.len() as u64)
        .read_to_end(&mut found)
        .map_err(|error| unreadable(path, error))?;
    let mut plain = found.clone();
    if let Some(place) = Status::place(&marked)
        && let Some(status) = plain.get_mut(place.clone())
    {
        status.copy_from_slice(&marked[place]);
    }
    if plain == marked {
        return Ok(Some(marked));
    }
    // What came through a pipe says nothing of how far it is.
    let bare = beginning(plan, plan.shard, columns, None);
    if found.starts_with(&bare) {
        let sought = file.seek(SeekFrom::Start(bare.len() as u64));
        sought.map_err(|error| unreadable(path, error))?;
        return Ok(Some(bare));
    }
    if marked.starts_with(&plain) || bare.starts_with(&found) {
        return Ok(None);
    }
    // Another sweep: its remarks to their end say in what it differs.
    let mut rest = Vec::new();
    file.take(LONGEST_HEAD)
        .read_to_end(&mut rest)
        .map_err(|error| unreadable(path, error))?;
    found.extend(rest);
    Err(wrong(path, difference(&found, &marked)))
}

/// In what the first lines of a file differ from those of this sweep.
fn difference(mut found: &[u8], mut expected: &[u8]) -> String {
    let head = |bytes: &mut &[u8]| Head::read(bytes).unwrap_or_default();
    let (theirs, ours) = (head(&mut found), head(&mut expected));
    let shard = |rows: &Head| {
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
    twinslip_output::whole_line(file).map_err(|error| unreadable(path, error))
}

/// Whether cells begin with the parameters of a row of that number.
fn belongs(plan: &SweepPlan, number: usize, cells: &[String]) -> bool {
    let values = plan.settings.parameters(number);
    let parameters = plan.layout.parameters.iter().zip(values);
    let told = |((_, quantity), value): (&(_, Quantity), f64)| {
        shortest(plan.system.units().outward(*quantity, value))
    };
    let expected: Vec<String> = parameters.map(told).collect();
    cells.starts_with(&expected)
}

/// A row from its cells; `None` if they are not those of a row.
pub fn row(
    plan: &SweepPlan,
    columns: &[Column<SweepRow>],
    number: usize,
    cells: &[String],
) -> Option<SweepRow> {
    let names = views::names(columns, false);
    let cell = |name: &str| {
        let at = names.iter().position(|(one, _)| one == name);
        at.and_then(|at| cells.get(at)).map_or("", String::as_str)
    };
    views::sweep_row(number, &cell, &plan.layout, plan.system.units())
}

/// Which of the cells of a row tells the regime.
pub fn regime_place(columns: &[Column<SweepRow>]) -> usize {
    let names = views::names(columns, false);
    let found = names.iter().position(|(name, _)| name == "regime");
    found.expect("all rows tell it")
}

/// The remarks of a sweep's file, without `# `.
pub fn remarks_of(path: &Path) -> Result<Vec<String>> {
    let mut file = BufReader::new(File::open(path).map_err(|error| unreadable(path, error))?);
    let head = Head::read(&mut file).map_err(|error| unreadable(path, error))?;
    Ok(head.remarks)
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
