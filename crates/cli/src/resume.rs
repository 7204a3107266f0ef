//! Going on with the CSV file of an interrupted run: the rows of all branches but the last one that it had begun stay as they are,
//! with their special points in the file beside it. What follows is computed as if nothing had happened.

use super::rows::{CurveRow, SpecialPoint};
use std::collections::BTreeMap;
use std::fs::File;
use std::io::{BufReader, ErrorKind, Read};
use std::path::{Path, PathBuf};
use twinslip::error::{Error, Result};
use twinslip_output::{Head, OURS, Status, checked_cells, damage, whole_line};

/// Between two rows there are never as many special points.
const FEW: usize = 300;

/// What stays of an earlier run.
pub struct EarlierRun<R: CurveRow> {
    /// The rows.
    pub rows: Vec<R>,
    /// The special points.
    pub special: Vec<R::Special>,
    /// The numbers of the branches or curves, which are not told of again.
    pub numbers: Vec<usize>,
    /// Whether all is there.
    pub complete: bool,
    /// Where in the file ends what stays; 0 where not even its head is whole.
    pub bytes: u64,
    /// The same of the file of special points.
    pub special_bytes: u64,
}

impl<R: CurveRow> Default for EarlierRun<R> {
    fn default() -> Self {
        EarlierRun {
            rows: Vec::new(),
            special: Vec::new(),
            numbers: Vec::new(),
            complete: false,
            bytes: 0,
            special_bytes: 0,
        }
    }
}

/// The file of the special points beside that of the rows: `orbits.special.csv` beside `orbits.csv`.
pub fn beside(rows: &Path) -> PathBuf {
    let mut name = rows.file_stem().unwrap_or_default().to_owned();
    name.push(".special.");
    name.push(rows.extension().unwrap_or("csv".as_ref()));
    rows.with_file_name(name)
}

/// What the check of a row is made with: its number, and how many special points were told of before it. So the rows know whether
/// any of these is missing.
pub fn row_key(row: usize, special: usize) -> String {
    format!("{row} {special}")
}

/// What the check of a special point is made with: its number.
pub fn special_key(number: usize) -> String {
    number.to_string()
}

/// What a file must begin with to be gone on with.
pub struct Expected<'a> {
    /// Its remarks, but for the command, what the second method is, and how far it is.
    pub remarks: &'a [String],
    /// The names of its columns.
    pub columns: &'a [String],
}

/// What the check of a row may have been made with.
type Keys = Box<dyn Iterator<Item = String>>;

/// Makes a row of its cells by name, and of which of its keys the check was made with.
type MakeRow<'a, R> = &'a mut dyn FnMut(&dyn Fn(&str) -> String, usize) -> Option<R>;

/// Makes a row of its cells by name.
pub type ReadRow<'a, R> = &'a dyn Fn(&dyn Fn(&str) -> String) -> Option<R>;

/// The rows of a file, each with where it ends.
struct SavedRows<R> {
    head: Head,
    rows: Vec<R>,
    ends: Vec<u64>,
}

impl<R> SavedRows<R> {
    /// Reads a file; `None` if there is none, or its head is torn.
    fn read(
        path: &Path,
        expected: &Expected<'_>,
        keys: &dyn Fn(usize) -> Keys,
        row: MakeRow<'_, R>,
    ) -> Result<Option<Self>> {
        let unreadable = |error: std::io::Error| Error::File {
            action: "read",
            path: path.to_owned(),
            reason: error.to_string(),
        };
        let mut file = match File::open(path) {
            Ok(file) => BufReader::new(file),
            Err(error) if error.kind() == ErrorKind::NotFound => return Ok(None),
            Err(error) => return Err(unreadable(error)),
        };
        let head = Head::read(&mut file).map_err(unreadable)?;
        if head.columns.is_empty() {
            let mut begin = Vec::new();
            File::open(path)
                .and_then(|file| file.take(OURS.len() as u64).read_to_end(&mut begin))
                .map_err(unreadable)?;
            return match OURS.as_bytes().starts_with(&begin) {
                true => Ok(None),
                false => Err(wrong(path, "it is not a CSV of this program")),
            };
        }
        same(&head, expected.remarks, expected.columns).map_err(|why| wrong(path, &why))?;
        let mut table = SavedRows {
            ends: vec![head.bytes],
            rows: Vec::new(),
            head,
        };
        while let Some(line) = whole_line(&mut file).map_err(unreadable)? {
            let number = table.rows.len();
            let known = keys(number).enumerate();
            let read = checked_cells(&line, known).and_then(|(key, cells)| {
                row(&|column| table.head.cell(&cells, column).to_owned(), key)
            });
            let Some(read) = read else {
                let at = table.head.lines + number + 1;
                let why = damage(&line, number, keys);
                return Err(wrong(path, &format!("line {at} is damaged: {why}")));
            };
            table.rows.push(read);
            table.ends.push(table.ends[number] + line.len() as u64 + 1);
        }
        Ok(Some(table))
    }

    /// Whether the file says that its rows are all there, and they are.
    fn complete(&self) -> bool {
        let remarks = self.head.remarks.iter().map(String::as_str);
        Status::of(remarks) == Some(Status::Complete(Some(self.rows.len())))
    }

    /// The first rows that are to stay, and where they end.
    fn staying(mut self, stays: impl Fn(&R) -> bool) -> (Vec<R>, u64) {
        let first = self.rows.iter().position(|row| !stays(row));
        let count = first.unwrap_or(self.rows.len());
        self.rows.truncate(count);
        (self.rows, self.ends[count])
    }
}

impl<R: CurveRow> EarlierRun<R> {
    /// Reads both files; nothing stays of what does not exist, is empty or ends before a second branch begins.
    ///
    /// # Errors
    /// [`Error::File`] if one can't be read; [`Error::Input`] if it is of another command, model or version than this one, or has
    /// a line that is not as it was written.
    pub fn read(
        path: &Path,
        rows: &Expected<'_>,
        special: &Expected<'_>,
        (read, read_special): (ReadRow<'_, R>, ReadRow<'_, R::Special>),
    ) -> Result<Self> {
        // How many special points there were before the last row.
        let before = std::cell::Cell::new(0);
        let rows = SavedRows::read(
            path,
            rows,
            &|row| {
                let some = before.get()..before.get() + FEW;
                Box::new(some.map(move |special| row_key(row, special)))
            },
            &mut |cell, more| {
                before.set(before.get() + more);
                read(cell)
            },
        )?;
        let Some(rows) = rows else {
            return Ok(EarlierRun::default());
        };
        let points = beside(path);
        let special = SavedRows::read(
            &points,
            special,
            &|number| Box::new(std::iter::once(special_key(number))),
            &mut |cell, _| read_special(cell),
        )?;
        let bytes = rows.head.bytes;
        let Some(special) = special else {
            // Without their special points the rows are of no use: all is computed again.
            return Ok(EarlierRun {
                bytes,
                ..EarlierRun::default()
            });
        };
        if special.rows.len() < before.get() {
            let (there, told) = (special.rows.len(), before.get());
            return Err(wrong(
                &points,
                &format!(
                    "it ends after {there} special points, but {told} are on the branches of {}",
                    path.display()
                ),
            ));
        }
        let complete = rows.complete() && special.complete();
        let last = rows.rows.last().map_or(0, R::number);
        let (special, special_bytes) = special.staying(|one| complete || one.number() < last);
        let (rows, bytes) = rows.staying(|row| complete || row.number() < last);
        Ok(EarlierRun {
            rows,
            special,
            numbers: (0..last).collect(),
            complete,
            bytes,
            special_bytes,
        })
    }
}

fn wrong(path: &Path, why: &str) -> Error {
    Error::Input(format!("--resume {}: {why}", path.display()))
}

/// Whether a file was written by the same command with the same model; if not, why not.
pub(super) fn same(earlier: &Head, remarks: &[String], columns: &[String]) -> Result<(), String> {
    if !earlier.columns.is_empty() && earlier.columns != columns {
        return Err("its columns are not those of this command".into());
    }
    let version = |remarks: &[String]| remarks.first().cloned().unwrap_or_default();
    let (theirs, ours) = (version(&earlier.remarks), version(remarks));
    if theirs.starts_with("twinslip ") && theirs != ours {
        return Err(format!("it was written by {theirs}, but this is {ours}"));
    }
    for subject in ["model", "numerics", "units"] {
        // Systems without units have no such line.
        if [&earlier.remarks[..], remarks]
            .iter()
            .all(|all| pairs(all, subject).is_none())
        {
            continue;
        }
        let (Some(theirs), Some(ours)) =
            (pairs(&earlier.remarks, subject), pairs(remarks, subject))
        else {
            return Err(format!("it has no line \"# {subject}:\" of this command"));
        };
        // What a second method says changes no row.
        let changed =
            |name: &&&str| **name != "crosscheck" && theirs.get(**name) != ours.get(**name);
        if let Some(name) = ours.keys().chain(theirs.keys()).find(changed) {
            let said = |pairs: &BTreeMap<&str, &str>| {
                pairs
                    .get(name)
                    .map_or(format!("no {name}"), |value| format!("{name} = {value}"))
            };
            if *name == "formulas" {
                return Err(
                    "it was written with other formulas: the file of the system or law has changed since".into(),
                );
            }
            return Err(format!(
                "it was written with {}, but this run has {}",
                said(&theirs),
                said(&ours)
            ));
        }
    }
    Ok(())
}

/// The pairs `name = value` (`name [unit]` of units) in the remark on a subject.
fn pairs<'a>(remarks: &'a [String], subject: &str) -> Option<BTreeMap<&'a str, &'a str>> {
    let list = remarks
        .iter()
        .find_map(|remark| remark.strip_prefix(subject)?.strip_prefix(": "))?;
    let pair = |pair: &'a str| pair.split_once(" = ").or_else(|| pair.split_once(' '));
    Some(list.split(", ").filter_map(pair).collect())
}
