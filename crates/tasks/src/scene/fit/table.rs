//! The files of laboratories: columns of numbers, with a header or without, separated by whatever there is.

use super::cells::{Separator, decoded};
use super::clock::Moment;
use super::heading::{Heading, headings_of};
use super::numeral::{Decimal, is_mark, numeral};
use crate::scene::file::read_bytes;
use crate::scene::text::given_text;
use std::ops::Range;
use std::path::Path;
use twinslip::error::{Error, Result};

/// No file is longer, in bytes.
const LONGEST: u64 = 1 << 30;
/// What a line of remarks begins with.
const REMARKS: [&str; 4] = ["#", "%", "//", "!"];
/// Between what remarks of several lines stand, as in the files of PANGAEA.
const BLOCK: (&str, &str) = ("/*", "*/");
/// A number that stands for a missing one is farther from the others than this, in sizes of these.
const FAR: f64 = 3.0;

/// A row of numbers.
#[derive(Debug, Clone, PartialEq)]
struct Row {
    /// Its line in the file.
    line: usize,
    /// Where it stands in the text.
    span: Range<usize>,
}

/// A file, in columns of text.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct Table {
    /// The file's name, for messages.
    pub file: String,
    /// Empty where the file has no header.
    pub headings: Vec<Heading>,
    text: String,
    rows: Vec<Row>,
    separator: Separator,
    decimal: Decimal,
    width: usize,
}

impl Table {
    /// Reads a file, or a text in its place.
    ///
    /// # Errors
    /// [`Error::File`], and [`Error::Input`] for a file without rows of numbers.
    pub fn read(path: &Path) -> Result<Self> {
        if let Some(text) = given_text(path) {
            return Self::parse("the record", text.to_owned());
        }
        let text = decoded(read_bytes(path, LONGEST)?).map_err(|reason| Error::File {
            action: "read",
            path: path.to_owned(),
            reason: reason.into(),
        })?;
        Self::parse(&path.display().to_string(), text)
    }

    /// Reads a text, under the name that messages shall use for it.
    ///
    /// # Errors
    /// [`Error::Input`] for a text without rows of numbers.
    pub fn parse(file: &str, text: String) -> Result<Self> {
        let mut lines = Lines::of(&text);
        // A line in the middle shows how rows are made: what stands above them may have numbers too.
        let of_data = lines.told.iter().skip(lines.told.len() / 2);
        let of_data = of_data.chain(&lines.told);
        let sample = of_data.map(|row| &text[row.span.clone()]).find_map(|line| {
            let separator = lines.separator.unwrap_or_else(|| Separator::of(line));
            let numeric = numeric(separator, line);
            (numeric.contains(&true)).then_some((separator, numeric))
        });
        let (separator, numeric_cells) =
            sample.ok_or_else(|| Error::Input(format!("{file} has no rows of numbers")))?;
        let is_data = |line: &str| {
            let own = numeric(separator, line);
            let is = |at: usize| numeric_cells[at] && own.get(at) == Some(&true);
            let same = (0..numeric_cells.len()).filter(|&at| is(at)).count();
            let all = numeric_cells.iter().filter(|is| **is).count();
            let is_as_wide =
                own.len() == numeric_cells.len() || 2 * own.len() > numeric_cells.len();
            // `2900 recs 2900 recs` is a line of words with numbers.
            let numbers = own.iter().filter(|is| **is).count();
            let is_of_words = own.len() > numeric_cells.len() && 2 * numbers <= own.len();
            is_as_wide && !is_of_words && 2 * same > all
        };
        let first = lines
            .told
            .iter()
            .position(|row| is_data(&text[row.span.clone()]));
        let first = first.ok_or_else(|| Error::Input(format!("{file} has no rows of numbers")))?;
        let mut rows = lines.told.split_off(first);
        let begin = rows[0].span.start;
        // A row of empty cells is what a spreadsheet has below its table.
        let is_empty = |line: &str| line.bytes().all(|byte| b";,\t \"".contains(&byte));
        while rows
            .last()
            .is_some_and(|row| is_empty(&text[row.span.clone()]))
        {
            rows.pop();
        }
        let content = |row: &Row| &text[row.span.clone()];
        let width = |row: &Row| separator.filled(content(row)).len();
        /// Rows that say how many columns there are.
        const LOOKED_AT: usize = 100;
        let width = rows.iter().take(LOOKED_AT).map(width).max().unwrap_or(0);
        let words: Vec<&str> = lines.told.iter().map(content).collect();
        let remarks = lines.remarks.iter().filter(|span| span.end <= begin);
        let remarks: Vec<&str> = remarks
            .map(|span| {
                text[span.clone()]
                    .trim_start()
                    .trim_start_matches(['#', '%', '/', '!'])
            })
            .collect();
        let mut headings = headings_of(&words, &remarks, (separator, width));
        if headings.is_empty() && is_counted(separator, &text, &rows) {
            headings = headings_of(&words, &remarks, (separator, width - 1));
            if !headings.is_empty() {
                headings.insert(0, Heading::of(""));
            }
        }
        let body = &text[begin..];
        let may_have_commas = match separator {
            Separator::Sign(b',') => body.contains('"'),
            _ => body.contains(','),
        };
        let cells = || rows.iter().flat_map(|row| separator.cells(content(row)));
        let decimal = match may_have_commas {
            true => Decimal::of(cells()),
            false => Decimal::Point,
        };
        Ok(Table {
            file: file.to_owned(),
            rows,
            separator,
            decimal,
            width: width.max(headings.len()),
            headings,
            text,
        })
    }

    /// How many rows there are.
    pub fn len(&self) -> usize {
        self.rows.len()
    }

    /// How many columns there are.
    pub fn width(&self) -> usize {
        self.width
    }

    /// The line of a row in the file.
    pub fn line(&self, row: usize) -> usize {
        self.rows[row].line
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
        let width = self.width;
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

    /// The name of a column, or its number where there is no header.
    pub fn name(&self, column: usize) -> String {
        let heading = self.headings.get(column);
        heading.map_or((column + 1).to_string(), |one| one.name.clone())
    }

    /// What columns there are, in words.
    pub fn seen(&self) -> String {
        if !self.headings.is_empty() {
            return format!("the columns are {}", self.names().join(", "));
        }
        let ends = |column: usize| {
            let cell = |row: &Row| self.cell(row, column).unwrap_or("nothing").to_owned();
            let (first, last) = (&self.rows[0], &self.rows[self.rows.len() - 1]);
            format!("{} from {} to {}", column + 1, cell(first), cell(last))
        };
        /// More columns are not told one by one.
        const TOLD: usize = 8;
        let each: Vec<String> = (0..self.width.min(TOLD)).map(ends).collect();
        let more = if self.width > TOLD { ", ..." } else { "" };
        format!(
            "there is no header, and {} columns: {}{more}",
            self.width,
            each.join(", ")
        )
    }

    fn cell(&self, row: &Row, column: usize) -> Option<&str> {
        let mut cells = self.separator.cells(&self.text[row.span.clone()]);
        cells.nth(column).filter(|cell| !cell.is_empty())
    }

    /// Whether a column begins with a number.
    pub fn is_numeric(&self, column: usize) -> bool {
        let first = self.cell(&self.rows[0], column);
        first.is_some_and(|cell| numeral(cell).is_some())
    }

    /// Whether a column begins with a time of day.
    pub fn is_clock(&self, column: usize) -> bool {
        let first = self.cell(&self.rows[0], column);
        first.is_some_and(|cell| Moment::read(cell).is_some())
    }

    /// What each row has in a column.
    ///
    /// # Errors
    /// [`Error::Input`] with file and line for what `read` refuses, which is no `kind`.
    fn each<T>(
        &self,
        column: usize,
        (what, kind): (&str, &str),
        read: impl Fn(&str) -> Option<T>,
    ) -> Result<Vec<T>> {
        let of = |row: &Row| {
            let wrong =
                |why: String| Error::Input(format!("{}:{}: the {what} {why}", self.file, row.line));
            let cell = self
                .cell(row, column)
                .ok_or_else(|| wrong("is missing".into()))?;
            read(cell).ok_or_else(|| wrong(format!("{cell:?} is not {kind}")))
        };
        self.rows.iter().map(of).collect()
    }

    /// The times of a column of dates and clocks, in s since the first.
    ///
    /// # Errors
    /// [`Error::Input`] with file and line for what is none.
    pub fn clock(&self, column: usize) -> Result<Vec<f64>> {
        let kind = "a time of day; give seconds, or times such as 2023-05-01T12:00:00.5";
        let moments = self.each(column, ("time", kind), Moment::read)?;
        Ok(Moment::seconds(&moments))
    }

    /// The numbers of a column.
    ///
    /// # Errors
    /// [`Error::Input`] with file and line for what is no finite number.
    pub fn numbers(&self, column: usize, what: &str) -> Result<Vec<f64>> {
        let read = |cell: &str| self.decimal.number(cell).filter(|x| x.is_finite());
        let numbers = self.each(column, (what, "a finite number"), read)?;
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

/// Whether the first column numbers the rows, one after the other: such a column often has no name.
fn is_counted(separator: Separator, text: &str, rows: &[Row]) -> bool {
    let first = |row: &Row| separator.cells(&text[row.span.clone()]).next();
    let counts = rows.iter().map(|row| first(row)?.parse::<i64>().ok());
    let counts: Option<Vec<i64>> = counts.collect();
    counts.is_some_and(|all| all.len() > 1 && all.windows(2).all(|pair| pair[1] == pair[0] + 1))
}

/// Which cells of a line are numbers.
fn numeric(separator: Separator, line: &str) -> Vec<bool> {
    let cells = separator.filled(line);
    cells.iter().map(|cell| numeral(cell).is_some()).collect()
}

/// The lines of a text.
struct Lines {
    /// Those that are neither blank nor remarks.
    told: Vec<Row>,
    remarks: Vec<Range<usize>>,
    /// That which a spreadsheet says in its first line, as `sep=;`.
    separator: Option<Separator>,
}

impl Lines {
    fn of(text: &str) -> Self {
        let mut lines = Lines {
            told: Vec::new(),
            remarks: Vec::new(),
            separator: None,
        };
        let mut is_within = false;
        let mut end = 0;
        for (i, whole) in text.split_inclusive('\n').enumerate() {
            let begin = end;
            end += whole.len();
            let marked = whole.trim_end_matches(['\n', '\r']);
            let line = if i == 0 {
                marked.trim_start_matches('\u{feff}')
            } else {
                marked
            };
            let span = begin + (marked.len() - line.len())..begin + marked.len();
            let bare = line.trim_start();
            is_within |= bare.starts_with(BLOCK.0);
            if is_within || REMARKS.iter().any(|sign| bare.starts_with(sign)) {
                is_within &= !line.contains(BLOCK.1);
                lines.remarks.push(span);
            } else if i == 0
                && let Some(sign) = said(bare)
            {
                lines.separator = Some(sign);
            } else if !bare.is_empty() {
                lines.told.push(Row { line: i + 1, span });
            }
        }
        lines
    }
}

/// The separator that a first line `sep=;` says.
fn said(line: &str) -> Option<Separator> {
    let line = line.trim_end().trim_matches('"');
    let head = line.get(..4)?;
    let sign = line.as_bytes()[4..].first().copied();
    let alone = line.len() <= 5 && head.eq_ignore_ascii_case("sep=");
    // A tab at the end was trimmed.
    alone.then(|| Separator::Sign(sign.unwrap_or(b'\t')))
}
