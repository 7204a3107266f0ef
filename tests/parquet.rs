//! What is written as Parquet is read back by another implementation.
#![cfg(feature = "parquet")]
#![allow(missing_docs)]

use parquet2::encoding::hybrid_rle::HybridRleDecoder;
use parquet2::page::{DataPage, Page, split_buffer};
use parquet2::read::{decompress, get_page_iterator, read_metadata};
use std::fs::{self, File};
use std::path::PathBuf;
use twinslip::output::parquet::{GROUP, from_csv};

/// The present values of a column as bytes, and which rows have one.
fn column(file: &mut File, number: usize) -> (Vec<u8>, Vec<bool>) {
    let metadata = read_metadata(file).expect("metadata");
    let (mut values, mut present) = (Vec::new(), Vec::new());
    for group in &metadata.row_groups {
        let chunk = &group.columns()[number];
        let pages = get_page_iterator(chunk, &mut *file, None, vec![], 1 << 28).expect("pages");
        for page in pages {
            let page = decompress(page.expect("a page"), &mut vec![]).expect("no compression");
            let Page::Data(page) = page else {
                panic!("a dictionary")
            };
            let (_, levels, bytes) = split_buffer(&page).expect("a page in parts");
            values.extend_from_slice(bytes);
            present.extend(levels_of(&page, levels));
        }
    }
    (values, present)
}

fn levels_of(page: &DataPage, levels: &[u8]) -> Vec<bool> {
    let rows = page.num_values();
    if page.descriptor.max_def_level == 0 {
        return vec![true; rows];
    }
    let decoder = HybridRleDecoder::try_new(levels, 1, rows).expect("levels");
    decoder.map(|level| level.expect("a level") == 1).collect()
}

fn eights(bytes: &[u8]) -> impl Iterator<Item = [u8; 8]> + '_ {
    bytes
        .chunks_exact(8)
        .map(|eight| eight.try_into().expect("eight"))
}

#[test]
fn another_reader_finds_the_same_rows() {
    let folder = PathBuf::from(env!("CARGO_TARGET_TMPDIR"));
    let (csv, out) = (folder.join("rows.csv"), folder.join("rows.parquet"));
    // More than one group, the last one short.
    let rows = GROUP + 1234;
    let number = |i: usize| (i % 7 != 3).then(|| (i as f64 * 0.1).sin() * 1e-300);
    let word = |i: usize| ["periodic", "", "ψ, \"a\""][i % 3];
    let mut text = String::from("# command: a \"b, c\nnumber,driving,regime\n");
    for i in 0..rows {
        let x = number(i).map_or(String::new(), |x| format!("{x:e}"));
        text += &format!("{i},{x},\"{}\"\n", word(i).replace('"', "\"\""));
    }
    fs::write(&csv, text).expect("written");
    from_csv(&csv, &out, &["number"], &["regime"]).expect("converted");

    let mut file = File::open(&out).expect("there");
    let metadata = read_metadata(&mut file).expect("metadata");
    assert_eq!((metadata.num_rows, metadata.row_groups.len()), (rows, 2));
    let pairs = metadata.key_value_metadata.clone().expect("remarks");
    let command = pairs.iter().find(|pair| pair.key == "command");
    assert_eq!(command.unwrap().value.as_deref(), Some("a \"b, c"));
    let names = metadata
        .schema_descr
        .columns()
        .iter()
        .map(|c| c.path_in_schema.join("."));
    assert_eq!(names.collect::<Vec<_>>(), ["number", "driving", "regime"]);

    let (counts, _) = column(&mut file, 0);
    assert!(eights(&counts).map(u64::from_le_bytes).eq(0..rows as u64));
    let (numbers, there) = column(&mut file, 1);
    let mut numbers = eights(&numbers).map(f64::from_le_bytes);
    for (i, there) in there.iter().enumerate() {
        // To the bit.
        let read = there.then(|| numbers.next().expect("a number").to_bits());
        assert_eq!(read, number(i).map(f64::to_bits), "row {i}");
    }
    let (words, there) = column(&mut file, 2);
    let mut rest = words.as_slice();
    for (i, there) in there.iter().enumerate() {
        assert_eq!(*there, !word(i).is_empty(), "row {i}");
        if *there {
            let (length, after) = rest.split_at(4);
            let length = u32::from_le_bytes(length.try_into().expect("four")) as usize;
            assert_eq!(&after[..length], word(i).as_bytes(), "row {i}");
            rest = &after[length..];
        }
    }
    assert!(there.len() == rows && rest.is_empty());
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
