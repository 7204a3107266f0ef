//! Rows as Parquet: columns of numbers, words and counts in groups of rows, with the remarks as metadata of the file.
//!
//! A Parquet file ends with the directory of all that is in it, so it cannot be appended to, and one that is cut off is lost.
//! Rows that must outlive an interruption are therefore kept as CSV, which is also what a run is resumed from; when it is done,
//! [`from_csv`] makes a Parquet file of it, which appears complete or not at all. Columns have Parquet's plain encoding and no
//! compression, which all readers know.

use parquet::basic::{LogicalType, Repetition, Type as Physical};
use parquet::data_type::{ByteArray, ByteArrayType, DoubleType, Int64Type};
use parquet::errors::ParquetError;
use parquet::file::metadata::KeyValue;
use parquet::file::properties::WriterProperties;
use parquet::file::writer::{SerializedColumnWriter, SerializedFileWriter};
use parquet::schema::types::{Type, TypePtr};
use std::fs::File;
use std::io::{BufRead, BufReader, Seek, SeekFrom, Write};
use std::path::Path;
use std::sync::Arc;
use twinslip::error::{Error, Result};
use twinslip_output::write_whole_by;

/// Rows of a group: readers take a group at a time, some megabytes.
pub const GROUP: usize = 100_000;

/// What a column holds.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum ColumnType {
    /// Doubles, which may be missing.
    Number,
    /// UTF-8, which may be missing.
    Word,
    /// Unsigned integers of 64 bits, never missing.
    Count,
}

/// Some rows of a column.
#[derive(Debug, Clone, PartialEq)]
pub enum ColumnChunk {
    /// Doubles.
    Number(Vec<Option<f64>>),
    /// Words.
    Word(Vec<Option<String>>),
    /// Counts.
    Count(Vec<u64>),
}

/// Writes groups of rows to a file or a buffer; without [`ParquetRows::finish`] nothing can be read.
pub struct ParquetRows<W: Write + Send> {
    writer: SerializedFileWriter<W>,
    kinds: Vec<ColumnType>,
}

impl<W: Write + Send> ParquetRows<W> {
    /// With named columns. The remarks are metadata with the words before their first colon as the key.
    ///
    /// # Errors
    /// [`Error::Input`] with the words of the library.
    pub fn new(to: W, remarks: &[String], columns: &[(String, ColumnType)]) -> Result<Self> {
        let fields = columns.iter().map(|(name, kind)| field(name, *kind));
        let fields = fields.collect::<std::result::Result<_, _>>();
        let schema =
            fields.and_then(|fields| Type::group_type_builder("rows").with_fields(fields).build());
        let metadata = remarks.iter().map(|remark| {
            let (key, value) = remark.split_once(": ").unwrap_or(("remark", remark));
            KeyValue::new(key.to_owned(), value.to_owned())
        });
        let properties = WriterProperties::builder()
            .set_dictionary_enabled(false)
            .set_key_value_metadata(Some(metadata.collect()))
            .build();
        let schema = Arc::new(schema.map_err(unwritten)?);
        let writer = SerializedFileWriter::new(to, schema, Arc::new(properties));
        Ok(ParquetRows {
            writer: writer.map_err(unwritten)?,
            kinds: columns.iter().map(|(_, kind)| *kind).collect(),
        })
    }

    /// Writes a group of rows: all columns, equally long.
    ///
    /// # Errors
    /// [`Error::Input`] for columns that are not those that were named, or with the words of the library or the system.
    pub fn group(&mut self, columns: &[ColumnChunk]) -> Result<()> {
        let kinds: Vec<ColumnType> = columns.iter().map(ColumnChunk::kind).collect();
        if kinds != self.kinds
            || columns
                .iter()
                .any(|column| column.len() != columns[0].len())
        {
            return Err(unwritten(
                "the columns of a group differ from those of the file",
            ));
        }
        let mut group = self.writer.next_row_group().map_err(unwritten)?;
        for column in columns {
            let next = group.next_column().map_err(unwritten)?;
            let mut next = next.ok_or_else(|| unwritten("a column has no room"))?;
            column.write(&mut next).map_err(unwritten)?;
            next.close().map_err(unwritten)?;
        }
        group.close().map(drop).map_err(unwritten)
    }

    /// Writes the directory, and gives back what was written to.
    ///
    /// # Errors
    /// As [`ParquetRows::group`].
    pub fn finish(self) -> Result<W> {
        self.writer.into_inner().map_err(unwritten)
    }
}

fn field(name: &str, kind: ColumnType) -> std::result::Result<TypePtr, ParquetError> {
    let (physical, logical, repetition) = match kind {
        ColumnType::Number => (Physical::DOUBLE, None, Repetition::OPTIONAL),
        ColumnType::Word => (
            Physical::BYTE_ARRAY,
            Some(LogicalType::String),
            Repetition::OPTIONAL,
        ),
        ColumnType::Count => {
            let unsigned = LogicalType::integer(64, false);
            (Physical::INT64, Some(unsigned), Repetition::REQUIRED)
        }
    };
    let field = Type::primitive_type_builder(name, physical);
    let field = field.with_repetition(repetition).with_logical_type(logical);
    field.build().map(Arc::new)
}

impl ColumnChunk {
    /// Without rows yet.
    pub fn empty(kind: ColumnType) -> Self {
        match kind {
            ColumnType::Number => ColumnChunk::Number(Vec::new()),
            ColumnType::Word => ColumnChunk::Word(Vec::new()),
            ColumnType::Count => ColumnChunk::Count(Vec::new()),
        }
    }

    /// What it holds.
    pub fn kind(&self) -> ColumnType {
        match self {
            ColumnChunk::Number(_) => ColumnType::Number,
            ColumnChunk::Word(_) => ColumnType::Word,
            ColumnChunk::Count(_) => ColumnType::Count,
        }
    }

    fn len(&self) -> usize {
        match self {
            ColumnChunk::Number(all) => all.len(),
            ColumnChunk::Word(all) => all.len(),
            ColumnChunk::Count(all) => all.len(),
        }
    }

    /// Adds a cell as CSV has it, empty where it is missing; says whether it could be read.
    fn read(&mut self, cell: &str) -> bool {
        match self {
            ColumnChunk::Number(all) if cell.is_empty() => all.push(None),
            ColumnChunk::Number(all) => match cell.parse::<f64>() {
                Ok(x) => all.push(x.is_finite().then_some(x)),
                Err(_) => return false,
            },
            ColumnChunk::Word(all) => all.push((!cell.is_empty()).then(|| cell.to_owned())),
            ColumnChunk::Count(all) => match cell.parse() {
                Ok(n) => all.push(n),
                Err(_) => return false,
            },
        }
        true
    }

    fn write(&self, to: &mut SerializedColumnWriter<'_>) -> std::result::Result<(), ParquetError> {
        let there = |present: bool| i16::from(present);
        let written = match self {
            ColumnChunk::Number(all) => {
                let levels: Vec<i16> = all.iter().map(|x| there(x.is_some())).collect();
                let values: Vec<f64> = all.iter().copied().flatten().collect();
                let typed = to.typed::<DoubleType>();
                typed.write_batch(&values, Some(&levels), None)
            }
            ColumnChunk::Word(all) => {
                let levels: Vec<i16> = all.iter().map(|x| there(x.is_some())).collect();
                let values = all
                    .iter()
                    .flatten()
                    .map(|word| ByteArray::from(word.as_str()));
                let typed = to.typed::<ByteArrayType>();
                typed.write_batch(&values.collect::<Vec<_>>(), Some(&levels), None)
            }
            ColumnChunk::Count(all) => {
                // Parquet keeps the bits of unsigned numbers in signed ones.
                let values: Vec<i64> = all.iter().map(|&n| n.cast_signed()).collect();
                to.typed::<Int64Type>().write_batch(&values, None, None)
            }
        };
        written.map(drop)
    }
}

/// Makes a Parquet file of a CSV file with remarks, of any length. The columns in `counts` hold counts, those in `words` words,
/// all others numbers.
///
/// # Errors
/// [`Error::File`] if one can't be read or written; [`Error::Input`] for a cell that is not of its column's kind.
pub fn from_csv(csv: &Path, out: &Path, counts: &[&str], words: &[&str]) -> Result<()> {
    let failed = |action, path: &Path, reason: String| Error::File {
        action,
        path: path.to_owned(),
        reason,
    };
    let unread = |reason: String| failed("read", csv, reason);
    let (remarks, start) = remarks(csv).map_err(|error| unread(error.to_string()))?;
    // A remark may contain anything, quotes too: none is shown to the reader.
    let mut file = File::open(csv).map_err(|error| unread(error.to_string()))?;
    let sought = file.seek(SeekFrom::Start(start));
    sought.map_err(|error| unread(error.to_string()))?;
    let mut reader = csv::Reader::from_reader(file);
    let header = reader
        .headers()
        .map_err(|error| unread(error.to_string()))?;
    let kind = |name: &str| match name {
        _ if counts.contains(&name) => ColumnType::Count,
        _ if words.contains(&name) => ColumnType::Word,
        _ => ColumnType::Number,
    };
    let columns: Vec<(String, ColumnType)> = header
        .iter()
        .map(|name| (name.to_owned(), kind(name)))
        .collect();
    let system = |error: std::io::Error| failed("write", out, error.to_string());
    write_whole_by(out, system, |to| {
        let mut rows = ParquetRows::new(to, &remarks, &columns)?;
        let mut group = empty(&columns);
        for (i, record) in reader.records().enumerate() {
            let record = record.map_err(|error| unread(error.to_string()))?;
            for ((column, cell), (name, _)) in group.iter_mut().zip(&record).zip(&columns) {
                if !column.read(cell) {
                    let where_ = format!("row {}, column {name}: {cell:?}", i + 1);
                    return Err(unread(format!("{where_} cannot be read")));
                }
            }
            if (i + 1) % GROUP == 0 {
                rows.group(&group)?;
                group = empty(&columns);
            }
        }
        if group.first().is_some_and(|column| column.len() > 0) {
            rows.group(&group)?;
        }
        rows.finish().map(drop)
    })
}

fn empty(columns: &[(String, ColumnType)]) -> Vec<ColumnChunk> {
    columns
        .iter()
        .map(|(_, kind)| ColumnChunk::empty(*kind))
        .collect()
}

/// The remarks at the beginning of a CSV file, without `# `, and where they end.
fn remarks(csv: &Path) -> std::io::Result<(Vec<String>, u64)> {
    let (mut remarks, mut end) = (Vec::new(), 0);
    let mut file = BufReader::new(File::open(csv)?);
    let mut line = String::new();
    while file.read_line(&mut line)? > 0 {
        let Some(remark) = line.strip_prefix("# ") else {
            break;
        };
        remarks.push(remark.trim_end().to_owned());
        end += line.len() as u64;
        line.clear();
    }
    Ok((remarks, end))
}

fn unwritten(reason: impl ToString) -> Error {
    Error::Input(format!(
        "the Parquet file can't be written: {}",
        reason.to_string()
    ))
}
