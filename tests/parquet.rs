//! What is written as Parquet is read back, by the same library and by another implementation.

use parquet::file::reader::{FileReader, SerializedFileReader};
use parquet::record::Field;
use std::fs::{self, File};
use std::path::{Path, PathBuf};
use std::process::Command;
use twinslip_cli::internals::{GROUP, from_csv};

/// More than one group, the last one short.
const ROWS: usize = GROUP + 1234;

fn number(i: usize) -> Option<f64> {
    (i % 7 != 3).then(|| (i as f64 * 0.1).sin() * 1e-300)
}

fn word(i: usize) -> &'static str {
    ["periodic", "", "ψ, \"a\""][i % 3]
}

/// A file of all kinds of columns, made from CSV.
fn converted(name: &str) -> PathBuf {
    let folder = Path::new(env!("CARGO_TARGET_TMPDIR"));
    let csv = folder.join(name).with_extension("csv");
    let out = csv.with_extension("parquet");
    let mut text = String::from("# command: a \"b, c\nnumber,driving,regime\n");
    for i in 0..ROWS {
        let x = number(i).map_or(String::new(), |x| format!("{x:e}"));
        text += &format!("{i},{x},\"{}\"\n", word(i).replace('"', "\"\""));
    }
    fs::write(&csv, text).expect("written");
    from_csv(&csv, &out, &["number"], &["regime"]).expect("converted");
    out
}

#[test]
fn rows_and_remarks_are_read_back() {
    let file = File::open(converted("again")).expect("there");
    let reader = SerializedFileReader::new(file).expect("Parquet");
    let metadata = reader.metadata().file_metadata();
    let groups = reader.metadata().num_row_groups();
    assert_eq!((metadata.num_rows(), groups), (ROWS as i64, 2));
    let pairs = metadata.key_value_metadata().expect("remarks");
    let command = pairs.iter().find(|pair| pair.key == "command");
    assert_eq!(command.unwrap().value.as_deref(), Some("a \"b, c"));
    let mut count = 0;
    for (i, row) in reader.get_row_iter(None).expect("rows").enumerate() {
        let row = row.expect("a row");
        let fields: Vec<Field> = row
            .get_column_iter()
            .map(|(_, field)| field.clone())
            .collect();
        let word = match word(i) {
            "" => Field::Null,
            word => Field::Str(word.to_owned()),
        };
        let expected = [
            Field::ULong(i as u64),
            number(i).map_or(Field::Null, Field::Double),
            word,
        ];
        assert_eq!(fields, expected, "row {i}");
        count += 1;
    }
    assert_eq!(count, ROWS);
}

/// Arrow in C++, by Python.
#[test]
#[ignore = "needs Python's pyarrow"]
fn another_reader_finds_the_same_rows() {
    let script = r#"
import math, sys
from pyarrow import parquet
file = parquet.ParquetFile(sys.argv[1])
rows = file.read()
assert file.num_row_groups == 2
assert rows.schema.metadata[b"command"] == b'a "b, c'
number, driving, regime = (rows.column(name).to_pylist() for name in ("number", "driving", "regime"))
assert number == list(range(int(sys.argv[2])))
for i, (x, word) in enumerate(zip(driving, regime)):
    assert word == ("periodic", None, 'ψ, "a"')[i % 3], i
    expected = None if i % 7 == 3 else math.sin(i * 0.1) * 1e-300
    assert (x is None) == (expected is None), i
    assert x is None or abs(x - expected) <= 4e-16 * abs(expected), i
"#;
    let mut python = Command::new("python3");
    let python = python.args(["-c", script]).arg(converted("other"));
    let done = python.arg(ROWS.to_string()).output().expect("Python");
    assert!(
        done.status.success(),
        "{}",
        String::from_utf8_lossy(&done.stderr)
    );
}

#[test]
fn what_cannot_be_read_leaves_no_file() {
    let folder = PathBuf::from(env!("CARGO_TARGET_TMPDIR"));
    let (csv, out) = (folder.join("torn.csv"), folder.join("torn.parquet"));
    for text in [
        "number,driving\n0,1.5\n1,abc\n",
        "number,driving\n0,1.5\n1\n",
        "number\n-1\n",
    ] {
        fs::write(&csv, text).expect("written");
        let refused = from_csv(&csv, &out, &["number"], &[])
            .expect_err(text)
            .to_string();
        assert!(refused.contains("torn.csv"), "{refused}");
        assert!(!out.exists(), "{text}");
    }
    let left = fs::read_dir(&folder).expect("a folder").flatten();
    let left: Vec<_> = left
        .filter(|one| one.file_name().to_string_lossy().contains("torn.parquet"))
        .collect();
    assert!(left.is_empty(), "{left:?}");
}
