//! The files of laboratories: columns of numbers, with a header or without, separated by whatever there is.

use crate::error::{Error, Result};
use crate::scene::file::read_bounded;
use crate::scene::text::given_text;
use std::path::Path;

/// No file is longer, in bytes.
const LONGEST: u64 = 1 << 30;
/// What a line of remarks begins with.
const REMARKS: [&str; 4] = ["#", "%", "//", "!"];

/// A column as its header has it.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct Heading {
    /// The name, without the unit.
    pub name: String,
    /// The unit in parentheses or brackets, or on a line of its own.
    pub unit: Option<String>,
}

/// A file, in columns of text.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct Table {
    /// The file's name, for messages.
    pub file: String,
    /// Empty where the file has no header.
    pub headings: Vec<Heading>,
    /// The rows, each with its line.
    rows: Vec<(usize, csv::StringRecord)>,
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
        let text = read_bounded(path, LONGEST)?;
        Self::parse(&path.display().to_string(), &text)
    }

    /// Reads a text, under the name that messages shall use for it.
    ///
    /// # Errors
    /// [`Error::Input`] for a text without rows of numbers.
    pub fn parse(file: &str, text: &str) -> Result<Self> {
        let is_remark = |line: &str| {
            REMARKS
                .iter()
                .any(|sign| line.trim_start().starts_with(sign))
        };
        let told: Vec<&str> = text
            .trim_start_matches('\u{feff}')
            .lines()
            .map(|line| if is_remark(line) { "" } else { line })
            .collect();
        let is_data = |line: &&&str| {
            line.split([',', ';', '\t', ' '])
                .any(|x| number(x).is_some())
        };
        let first = told.iter().find(is_data).copied().unwrap_or_default();
        let separator = [';', ',', '\t']
            .into_iter()
            .find(|&sign| first.contains(sign));
        let lines: Vec<String> = match separator {
            Some(_) => told.iter().map(|line| (*line).to_owned()).collect(),
            None => told
                .iter()
                .map(|line| line.split_whitespace().collect::<Vec<_>>().join("\t"))
                .collect(),
        };
        let joined = lines.join("\n");
        let mut reader = csv::ReaderBuilder::new()
            .has_headers(false)
            .flexible(true)
            .trim(csv::Trim::All)
            .delimiter(separator.map_or(b'\t', |sign| sign as u8))
            .from_reader(joined.as_bytes());
        let mut headings: Vec<Heading> = Vec::new();
        let mut rows = Vec::new();
        for record in reader.records() {
            let record = record.map_err(|error| Error::Input(format!("{file}: {error}")))?;
            let line = record.position().map_or(0, |place| place.line() as usize);
            let numbers = record.iter().filter(|cell| number(cell).is_some()).count();
            if rows.is_empty() && 2 * numbers < record.len() {
                if headings.is_empty() {
                    headings = record.iter().map(Heading::of).collect();
                } else {
                    // A second line of words are units.
                    for (heading, unit) in headings.iter_mut().zip(&record) {
                        let bare = unit.trim_matches(['(', ')', '[', ']']);
                        heading.unit.get_or_insert_with(|| bare.to_owned());
                    }
                }
                continue;
            }
            rows.push((line, record));
        }
        if rows.is_empty() {
            return Err(Error::Input(format!("{file} has no rows of numbers")));
        }
        Ok(Table {
            file: file.to_owned(),
            headings,
            rows,
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
        let named = self.headings.iter().position(|heading| heading.is(column));
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

    /// The first column that has one of these names, or one that begins with it.
    pub fn like(&self, names: &[&str]) -> Option<usize> {
        let plain: Vec<String> = self.headings.iter().map(|one| plain(&one.name)).collect();
        let same = names
            .iter()
            .find_map(|name| plain.iter().position(|own| own == name));
        let begins = |name: &&str| {
            let long = name.len() > 2;
            plain.iter().position(|own| long && own.starts_with(*name))
        };
        same.or_else(|| names.iter().find_map(begins))
    }

    /// The numbers of a column.
    ///
    /// # Errors
    /// [`Error::Input`] with file and line for what is no finite number.
    pub fn numbers(&self, column: usize, what: &str) -> Result<Vec<f64>> {
        let of = |(line, record): &(usize, csv::StringRecord)| {
            let cell = record.get(column);
            let cell = cell.ok_or_else(|| {
                Error::Input(format!("{}:{line}: the {what} is missing", self.file))
            })?;
            number(cell).filter(|x| x.is_finite()).ok_or_else(|| {
                Error::Input(format!(
                    "{}:{line}: the {what} {cell:?} is not a finite number",
                    self.file
                ))
            })
        };
        self.rows.iter().map(of).collect()
    }
}

impl Heading {
    /// `Displ(microns)`, `Time [s]`, `friction`.
    fn of(text: &str) -> Self {
        let (name, unit) = match text.find(['(', '[']) {
            Some(at) if at > 0 => {
                let unit = text[at + 1..].trim_end_matches([')', ']']).trim();
                (&text[..at], Some(unit.to_owned()).filter(|u| !u.is_empty()))
            }
            _ => (text, None),
        };
        Heading {
            name: name.trim().to_owned(),
            unit,
        }
    }

    fn is(&self, name: &str) -> bool {
        self.name == name || plain(&self.name) == plain(name)
    }
}

/// A name without case and signs.
fn plain(name: &str) -> String {
    let letters = name.chars().filter(|c| c.is_alphanumeric());
    letters.flat_map(char::to_lowercase).collect()
}

/// A number, NaN and infinity among them.
fn number(cell: &str) -> Option<f64> {
    let begins_as_number = cell.starts_with(|c: char| c.is_ascii_digit() || "+-.".contains(c));
    let is_word = ["nan", "inf"].contains(&cell.to_lowercase().as_str());
    (begins_as_number || is_word).then(|| cell.parse().ok())?
}
