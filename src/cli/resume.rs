//! Going on with the CSV file of an interrupted run: what is complete in it stays, if it is of the same command and model.

use super::rows::{Row, unknown};
use crate::bifurcation::{Label, Special};
use crate::error::{Error, Result};
use crate::output::EarlierRows;
use crate::scene::Units;
use std::collections::BTreeMap;
use std::path::Path;

/// What stays of an earlier run.
#[derive(Debug)]
pub struct Kept<R> {
    /// The lines, as they stand.
    pub lines: Vec<String>,
    /// What they say.
    pub rows: Vec<R>,
    /// The numbers of the branches or curves, which are not computed again.
    pub numbers: Vec<usize>,
}

impl<R> Default for Kept<R> {
    fn default() -> Self {
        Kept {
            lines: Vec::new(),
            rows: Vec::new(),
            numbers: Vec::new(),
        }
    }
}

impl<R: Row> Kept<R> {
    /// Reads the file; nothing stays of one that does not exist, is empty or ends before the first complete branch.
    ///
    /// # Errors
    /// [`Error::File`] if it can't be read; [`Error::Input`] if it is of another command or model than the one with these
    /// remarks and columns.
    pub fn read(
        path: &Path,
        remarks: &[String],
        columns: &[String],
        units: &Units,
    ) -> Result<Self> {
        let text = text_of(path)?;
        if text.is_empty() {
            return Ok(Kept::default());
        }
        let earlier = EarlierRows::read(&text);
        same(&earlier, remarks, columns)
            .map_err(|why| Error::Input(format!("--resume {}: {why}", path.display())))?;
        let mut branches: BTreeMap<usize, Vec<(&String, R)>> = BTreeMap::new();
        let mut last = None;
        for line in &earlier.lines {
            let row = R::read(&|column| earlier.cell(line, column), units).ok_or_else(|| {
                Error::Input(format!(
                    "--resume {}: the row {line:?} can't be read",
                    path.display()
                ))
            })?;
            last = Some(row.number());
            branches.entry(row.number()).or_default().push((line, row));
        }
        let mut kept = Kept::default();
        for (number, rows) in branches {
            let label = rows.last().and_then(|(_, row)| row.label());
            if rows.len() > 1 && whole(label, Some(number) == last) {
                kept.numbers.push(number);
                for (line, row) in rows {
                    kept.lines.push(line.clone());
                    kept.rows.push(row);
                }
            }
        }
        Ok(kept)
    }

    /// The special points, without what a row does not hold.
    pub fn special(&self) -> Vec<Special> {
        let special = |row: &R| {
            let (driving, stiffness) = row.loading();
            Some(Special {
                label: row.label()?,
                driving,
                stiffness,
                period: row.period().map(unknown),
                criticality: None,
                coefficient: None,
                coefficient_uncertainty: None,
                note: Some("of the earlier run".into()),
                orbit: None,
            })
        };
        self.rows.iter().filter_map(special).collect()
    }
}

/// What a file holds; nothing if there is none.
fn text_of(path: &Path) -> Result<String> {
    match std::fs::read_to_string(path) {
        Ok(text) => Ok(text),
        Err(error) if error.kind() == std::io::ErrorKind::NotFound => Ok(String::new()),
        Err(error) => Err(Error::File {
            action: "read",
            path: path.to_owned(),
            reason: error.to_string(),
        }),
    }
}

/// Whether a branch is complete by the label of its last row: one comes after the other, so that it is if another one follows.
/// What the method gave up is tried again; that a last branch ends in a bifurcation is not told from one that only passes it.
fn whole(label: Option<Label>, last: bool) -> bool {
    label == Some(Label::Ep) || (!last && label != Some(Label::Mx))
}

/// Whether a file was written by the same command with the same model; if not, why not.
pub(super) fn same(
    earlier: &EarlierRows,
    remarks: &[String],
    columns: &[String],
) -> Result<(), String> {
    if !earlier.columns.is_empty() && earlier.columns != columns {
        return Err("its columns are not those of this command".into());
    }
    for subject in ["model", "numerics", "units"] {
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
