//! The files of laboratories: columns of numbers, with a header or without, separated by whatever there is.

use super::cells::{Separator, decoded, is_mark, number, numeral, with_point};
use super::heading::{Heading, headings};
use crate::scene::file::read_bytes;
use crate::scene::text::given_text;
use std::path::Path;
use twinslip::error::{Error, Result};

/// No file is longer, in bytes.
const LONGEST: u64 = 1 << 30;
/// What a line of remarks begins with.
const REMARKS: [&str; 4] = ["#", "%", "//", "!"];
/// A number that stands for a missing one is farther from the others than this, in sizes of these.
const FAR: f64 = 3.0;

/// A file, in columns of text.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct Table {
    /// The file's name, for messages.
    pub file: String,
    /// Empty where the file has no header.
    pub headings: Vec<Heading>,
    /// The rows, each with its line.
    rows: Vec<(usize, Vec<String>)>,
    /// Whether numbers have a decimal comma.
    has_comma: bool,
}

impl Table {
    /// Reads a file, or a text in its place.
    ///
    /// # Errors
    /// [`Error::File`], and [`Error::Input`] for a file without rows of numbers.
    pub fn read(path: &Path) -> Result<Self> {
        if let Some(text) = given_text(path) {
            return Self::parse("the record", text);
        }
        let text = decoded(read_bytes(path, LONGEST)?);
        Self::parse(&path.display().to_string(), &text)
    }

    /// Reads a text, under the name that messages shall use for it.
    ///
    /// # Errors
    /// [`Error::Input`] for a text without rows of numbers.
    pub fn parse(file: &str, text: &str) -> Result<Self> {
        let remark = |line: &str| {
            let sign = REMARKS
                .iter()
                .find(|sign| line.trim_start().starts_with(**sign));
            sign.is_some()
        };
        let lines: Vec<&str> = text.trim_start_matches('\u{feff}').lines().collect();
        let told = |line: &&&str| !remark(line) && !line.trim().is_empty();
        let is_data = |line: &&str| {
            let cells = Separator::of(line).cells(line);
            let numbers = cells.iter().filter(|cell| numeral(cell).is_some()).count();
            numbers > 0 && 2 * numbers >= cells.len()
        };
        let first = lines.iter().position(|line| told(&line) && is_data(line));
        let first = first.ok_or_else(|| Error::Input(format!("{file} has no rows of numbers")))?;
        let separator = Separator::of(lines[first]);
        let numbered = lines.iter().enumerate().skip(first);
        let rows: Vec<(usize, Vec<String>)> = numbered
            .filter(|(_, line)| told(line))
            .map(|(i, line)| (i + 1, separator.cells(line)))
            .collect();
        let words: Vec<&str> = lines[..first].iter().filter(told).copied().collect();
        let remarks: Vec<&str> = lines[..first]
            .iter()
            .filter(|line| remark(line))
            .map(|line| line.trim_start().trim_start_matches(['#', '%', '/', '!']))
            .collect();
        let headings = headings(&words, &remarks, (separator, rows[0].1.len()));
        let cells = || rows.iter().flat_map(|(_, cells)| cells);
        let has_comma = cells().any(|cell| numeral(cell).is_some() && cell.contains(','))
            && !cells().any(|cell| cell.contains('.') && number(cell).is_some());
        Ok(Table {
            file: file.to_owned(),
            headings,
            rows,
            has_comma,
        })
    }

    /// How many rows there are.
    pub fn len(&self) -> usize {
        self.rows.len()
    }

    /// The line of a row in the file.
    pub fn line(&self, row: usize) -> usize {
        self.rows[row].0
    }

    /// The place of a column that is asked for by `option`, by name or by number from 1 on.
    ///
    /// # Errors
    /// [`Error::Input`] for one that is not there.
    pub fn asked(&self, option: &str, column: &str) -> Result<usize> {
        let exactly = self.headings.iter().position(|own| own.name == column);
        let bare = Heading::of(column).name;
        let column = bare.as_str();
        let named = exactly.or_else(|| self.headings.iter().position(|own| own.is(column)));
        if let Some(place) = named {
            return Ok(place);
        }
        let width = self.rows[0].1.len();
        match column.parse::<usize>() {
            Ok(number) if (1..=width).contains(&number) => Ok(number - 1),
            Ok(_) => Err(Error::Input(format!(
                "`{option}` {column}: {} has {width} columns",
                self.file
            ))),
            Err(_) if self.headings.is_empty() => Err(Error::Input(format!(
                "`{option}` {column}: {} has no header; give the column's number, from 1 to {width}",
                self.file
            ))),
            Err(_) => Err(Error::Input(format!(
                "`{option}` {column}: {} has the columns {}",
                self.file,
                self.names().join(", ")
            ))),
        }
    }

    /// The names of all columns.
    pub fn names(&self) -> Vec<&str> {
        self.headings.iter().map(|one| one.name.as_str()).collect()
    }

    /// What columns there are, in words.
    pub fn seen(&self) -> String {
        match self.headings.is_empty() {
            true => format!("there is no header, and {} columns", self.rows[0].1.len()),
            false => format!("the columns are {}", self.names().join(", ")),
        }
    }

    /// The first column that has one of these names, or one that begins with it, or else the only one that has it in its name, but
    /// for names with one of `others` in them, and for columns that something else was found in.
    pub fn like(&self, names: &[&str], others: &[&str], taken: &[usize]) -> Option<usize> {
        let plain: Vec<[String; 2]> = self.headings.iter().map(Heading::plain_names).collect();
        let free = || (0..plain.len()).filter(|at| !taken.contains(at));
        let place = |is: &dyn Fn(&String) -> bool| free().find(|&at| plain[at].iter().any(is));
        let same = names.iter().find_map(|name| place(&|own| own == name));
        let long = || names.iter().filter(|name| name.len() > 2);
        let is_other = |own: &String| others.iter().any(|other| own.contains(other));
        let begins =
            || long().find_map(|name| place(&|own| own.starts_with(name) && !is_other(own)));
        let within = || {
            let has =
                |[own, _]: &[String; 2]| long().any(|name| own.contains(name)) && !is_other(own);
            let mut all = free().filter(|&at| has(&plain[at]));
            all.next().filter(|_| all.next().is_none())
        };
        same.or_else(begins).or_else(within)
    }

    /// The numbers of a column.
    ///
    /// # Errors
    /// [`Error::Input`] with file and line for what is no finite number.
    pub fn numbers(&self, column: usize, what: &str) -> Result<Vec<f64>> {
        let of = |(line, cells): &(usize, Vec<String>)| {
            let cell = cells.get(column);
            let cell = cell.ok_or_else(|| {
                Error::Input(format!("{}:{line}: the {what} is missing", self.file))
            })?;
            let read = match self.has_comma {
                true => number(cell).or_else(|| number(&with_point(cell)?)),
                false => number(cell),
            };
            read.filter(|x| x.is_finite()).ok_or_else(|| {
                Error::Input(format!(
                    "{}:{line}: the {what} {cell:?} is not a finite number",
                    self.file
                ))
            })
        };
        let numbers: Vec<f64> = self.rows.iter().map(of).collect::<Result<_>>()?;
        let others = numbers.iter().filter(|x| !is_mark(**x));
        let size = others.fold(0.0, |size: f64, x| size.max(x.abs()));
        let missing = |&(_, x): &(usize, &f64)| is_mark(*x) && x.abs() > FAR * size;
        match numbers.iter().enumerate().find(missing) {
            None => Ok(numbers),
            Some((row, mark)) => Err(Error::Input(format!(
                "{}:{}: the {what} {mark} stands for one that is missing, the others being at most {size}; leave out such rows",
                self.file,
                self.line(row)
            ))),
        }
    }
}
