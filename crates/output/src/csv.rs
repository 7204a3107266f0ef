//! Comma-separated values, all digits, flushed row by row: what is written is not lost, however the run ends.

use super::{Cell, RowWriter, shortest};
use std::io::{BufRead, Error, ErrorKind, Read, Result, Write};

/// No line of remarks or rows is longer.
const LONGEST_LINE: u64 = 1 << 16;
/// No file has more remarks.
const MOST_REMARKS: usize = 100;

/// What a CSV begins with.
#[derive(Debug, Clone, Default, PartialEq)]
pub struct Head {
    /// The remarks, without `# `.
    pub remarks: Vec<String>,
    /// The names of the columns; none if the head is not whole.
    pub columns: Vec<String>,
    /// Its lines.
    pub lines: usize,
    /// Where it ends.
    pub bytes: u64,
}

impl Head {
    /// Up to the names of the columns.
    ///
    /// # Errors
    /// The system's; [`std::io::ErrorKind::InvalidData`] for what is no CSV of this program.
    pub fn read(from: &mut impl BufRead) -> Result<Self> {
        let mut head = Head::default();
        while let Some(line) = whole_line(from)? {
            head.lines += 1;
            head.bytes += line.len() as u64 + 1;
            match line.strip_prefix("# ") {
                Some(remark) if head.lines < MOST_REMARKS => head.remarks.push(remark.to_owned()),
                Some(_) => {
                    return Err(Error::new(
                        ErrorKind::InvalidData,
                        "it has too many remarks",
                    ));
                }
                None => {
                    head.columns = line.split(',').map(str::to_owned).collect();
                    break;
                }
            }
        }
        Ok(head)
    }

    /// A cell of a row by the name of its column; empty where there is none.
    pub fn cell<'a>(&self, cells: &'a [String], column: &str) -> &'a str {
        let at = self.columns.iter().position(|name| name == column);
        at.and_then(|at| cells.get(at)).map_or("", String::as_str)
    }
}

/// The next line if it is complete: what follows the last line break was being written when the run ended.
///
/// # Errors
/// The system's; [`std::io::ErrorKind::InvalidData`] for a line that is no text or has no end.
pub fn whole_line(from: &mut impl BufRead) -> Result<Option<String>> {
    let mut line = Vec::new();
    from.by_ref()
        .take(LONGEST_LINE)
        .read_until(b'\n', &mut line)?;
    if line.pop() != Some(b'\n') {
        return match line.len() as u64 + 1 < LONGEST_LINE {
            true => Ok(None),
            false => Err(Error::new(ErrorKind::InvalidData, "a line has no end")),
        };
    }
    let text = String::from_utf8(line);
    text.map(Some)
        .map_err(|_| Error::new(ErrorKind::InvalidData, "a line is no text"))
}

/// The name of the last column of rows that can be gone on with.
pub const ROW_CHECK: &str = "row_check";

/// The CRC-32 of bytes.
pub fn check_sum(bytes: &[u8]) -> u32 {
    crc32fast::hash(bytes)
}

/// The CRC-32 of a line's text and of a key, which says which row it is: a row that was changed, cut, moved or repeated, or
/// before which one is missing, does not have it.
fn row_check(key: &str, text: &str) -> u32 {
    let mut sum = crc32fast::Hasher::new();
    sum.update(key.as_bytes());
    sum.update(b":");
    sum.update(text.as_bytes());
    sum.finalize()
}

/// A row as a line that ends with its check.
pub fn checked_line(key: &str, cells: &[Cell]) -> String {
    let text = line(cells);
    let check = row_check(key, &text);
    format!("{text},{check}\n")
}

/// The cells of a line without its check, and the first of these keys that the check fits; `None` if it fits none.
pub fn checked_cells<K>(
    line: &str,
    keys: impl IntoIterator<Item = (K, String)>,
) -> Option<(K, Vec<String>)> {
    let (text, check) = line.rsplit_once(',')?;
    let check: u32 = check.parse().ok()?;
    let (key, _) = keys
        .into_iter()
        .find(|(_, key)| row_check(key, text) == check)?;
    Some((key, cells_of(text)?))
}

/// Why the row of that number is not what a line holds. `key` is what it would be as row of another number.
pub fn damage<K: IntoIterator<Item = String>>(
    line: &str,
    number: usize,
    key: impl Fn(usize) -> K,
) -> String {
    /// So many rows are looked for before and after.
    const NEAR: usize = 1000;
    let fits = |other: &usize| {
        let keys = key(*other).into_iter().map(|key| ((), key));
        checked_cells(line, keys).is_some()
    };
    let near = number.saturating_sub(NEAR)..number + NEAR;
    match near.into_iter().find(fits) {
        Some(other) if other > number => match other - number {
            1 => "a row is missing before it".into(),
            n => format!("{n} rows are missing before it"),
        },
        Some(_) => "it is a row that stands before it already".into(),
        None => "it is not as it was written, by its row_check".into(),
    }
}

/// A row without the line break.
fn line(cells: &[Cell]) -> String {
    /// Longer than nearly all rows.
    const ROOM: usize = 1024;
    let mut builder = csv::WriterBuilder::new();
    let mut writer = builder
        .buffer_capacity(ROOM)
        .from_writer(Vec::with_capacity(ROOM));
    let written = cells.iter().try_for_each(|cell| match cell {
        Cell::Number(x) => writer.write_field(shortest(*x)),
        Cell::Text(text) => writer.write_field(text),
        Cell::Missing => writer.write_field(""),
    });
    written
        .and_then(|()| writer.write_record(None::<&[u8]>))
        .expect("memory can be written");
    let mut bytes = writer.into_inner().expect("memory can be written");
    bytes.pop();
    String::from_utf8(bytes).expect("cells are text")
}

/// The cells of a line; `None` if its quotes do not close.
fn cells_of(line: &str) -> Option<Vec<String>> {
    let mut reader = csv::ReaderBuilder::new();
    let mut reader = reader.has_headers(false).from_reader(line.as_bytes());
    let record = reader.records().next()?.ok()?;
    Some(record.iter().map(str::to_owned).collect())
}

/// Writes rows as CSV.
pub struct CsvRows<W: Write> {
    to: W,
}

impl<W: Write> CsvRows<W> {
    /// Writes the remarks as `# ` lines, then the header.
    ///
    /// # Errors
    /// Those of the file or pipe.
    pub fn new(mut to: W, remarks: &[String], columns: &[String]) -> Result<Self> {
        to.write_all(&head(remarks, columns))?;
        to.flush()?;
        Ok(CsvRows { to })
    }

    /// Goes on after rows that are there.
    pub fn after(to: W) -> Self {
        CsvRows { to }
    }
}

impl<W: Write> RowWriter for CsvRows<W> {
    fn row(&mut self, cells: &[Cell]) -> Result<()> {
        let mut line = line(cells);
        line.push('\n');
        self.to.write_all(line.as_bytes())?;
        self.to.flush()
    }
}

/// Remarks and names of columns.
pub fn head(remarks: &[String], columns: &[String]) -> Vec<u8> {
    let mut text: String = remarks
        .iter()
        .map(|remark| format!("# {remark}\n"))
        .collect();
    let names: Vec<Cell> = columns
        .iter()
        .map(|name| Cell::Text(name.clone()))
        .collect();
    text += &line(&names);
    text.push('\n');
    text.into_bytes()
}

#[cfg(test)]
mod test {
    use super::*;

    #[test]
    fn a_torn_head_has_no_columns() {
        let read = |text: &str| Head::read(&mut text.as_bytes()).expect("memory can be read");
        let head = read("# model: K = 1\na,b\n1,2\n");
        assert_eq!(head.remarks, ["model: K = 1"]);
        assert_eq!(head.columns, ["a", "b"]);
        assert_eq!((head.lines, head.bytes), (2, 19));
        assert_eq!(read("# model: K = 1\na,b").columns, [""; 0]);
    }

    #[test]
    fn a_check_knows_its_row() {
        let cells = [
            Cell::Number(0.1),
            Cell::Text("a, \"b\"".into()),
            Cell::Missing,
        ];
        let line = checked_line("3", &cells);
        let line = line.trim_end();
        let keys = |range: std::ops::Range<usize>| range.map(|n| (n, n.to_string()));
        let (key, found) = checked_cells(line, keys(0..9)).expect("it fits");
        assert_eq!(
            (key, found),
            (3, vec!["0.1".to_owned(), "a, \"b\"".into(), String::new()])
        );
        assert_eq!(checked_cells(line, keys(4..9)), None);
        let key = |n: usize| vec![n.to_string()];
        assert_eq!(damage(line, 1, key), "2 rows are missing before it");
        assert_eq!(
            damage(line, 5, key),
            "it is a row that stands before it already"
        );
        let changed = line.replacen("0.1", "0.2", 1);
        assert!(damage(&changed, 3, key).contains("not as it was written"));
        assert!(damage("0.1,a", 3, key).contains("not as it was written"));
    }
}
