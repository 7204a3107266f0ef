//! Records with random damage: a sentence, or a fit, but never a panic.

use super::command::{folder, run};
use proptest::test_runner::{Config, TestRunner};
use std::fs;

/// What is done to a record, by a few numbers.
fn damaged(text: &str, [what, place, other]: [usize; 3]) -> Vec<u8> {
    let lines: Vec<&str> = text.lines().collect();
    let at = place % lines.len();
    let joined = |lines: Vec<String>| lines.join("\n").into_bytes();
    let each = |of: &dyn Fn(usize, &str) -> String| {
        joined(
            lines
                .iter()
                .enumerate()
                .map(|(i, line)| of(i, line))
                .collect(),
        )
    };
    let only =
        |of: &dyn Fn(&str) -> String| each(&|i, line| if i == at { of(line) } else { line.into() });
    const SIGNS: [&str; 16] = [
        ";", ",", "\t", "\"", "(", "[", "]", "#", "/*", "-9999", "nan", "1e999", ".", "\u{b5}",
        " ", "-",
    ];
    let sign = SIGNS[other % SIGNS.len()];
    match what % 12 {
        0 => joined(lines[at..].iter().map(|line| (*line).into()).collect()),
        1 => joined(lines[..at].iter().map(|line| (*line).into()).collect()),
        2 => only(&|line| {
            line.chars()
                .enumerate()
                .filter(|(i, _)| *i != other % 12)
                .map(|(_, c)| c)
                .collect()
        }),
        3 => only(&|line| format!("{sign}{line}")),
        4 => only(&|line| format!("{line}{sign}")),
        5 => each(&|i, line| {
            if i % (2 + other % 7) == 0 {
                line.replace('.', sign)
            } else {
                line.into()
            }
        }),
        6 => each(&|_, line| line.replace(['\t', ',', ';'], sign)),
        7 => only(&|_| String::new()),
        8 => only(&|_| lines[other % lines.len()].into()),
        9 => {
            let mut bytes = text.as_bytes().to_vec();
            let at = place % bytes.len();
            bytes[at] = other as u8;
            bytes
        }
        10 => text.as_bytes()[place % text.len()..].to_vec(),
        _ => text
            .encode_utf16()
            .flat_map(u16::to_le_bytes)
            .skip(other % 3)
            .collect(),
    }
}

#[test]
fn a_damaged_record_never_ends_in_a_panic() {
    let folder = folder("fit_mutations");
    let root = super::common::ROOT.to_owned() + "/tests/data/cases/";
    let records = ["slide-hold-slide.txt", "step-without-displacement.txt"];
    // Short parts, of which a fit is quick.
    let records = records.map(|name| {
        let text = fs::read_to_string(root.clone() + name).expect("a record");
        let lines = text.lines().enumerate();
        let kept = lines.filter(|(i, _)| i % 8 == 0).map(|(_, line)| line);
        kept.collect::<Vec<_>>().join("\n")
    });
    let path = folder.join("record.txt");
    let name = path.to_str().expect("a name");
    let mut runner = TestRunner::new(Config {
        cases: 60,
        failure_persistence: None,
        max_shrink_iters: 20,
        ..Config::default()
    });
    let strategy = (0..2_usize, [0..100_000_usize, 0..100_000, 0..100_000]);
    let tried = runner.run(&strategy, |(which, how)| {
        fs::write(&path, damaged(&records[which], how)).expect("a file");
        for words in [
            vec!["fit", name, "--look", "--format=json"],
            vec!["fit", name, "--intervals=linear", "--format=json", "-q"],
            vec!["fit", name, "--time=1", "--friction=2", "--look"],
        ] {
            let ended = run(&words);
            // A fit that finds no friction at any start is a failure with a sentence.
            let is_ended = [0, 2, 3].contains(&ended.code) || ended.code == 1 && words.len() == 5;
            // What is undecided is in the object, and -q says nothing beside it.
            let is_told = [0, 3].contains(&ended.code) || ended.err.lines().count() >= 1;
            proptest::prop_assert!(
                is_ended && is_told,
                "{words:?}: {} {}",
                ended.code,
                ended.err
            );
            proptest::prop_assert!(!ended.err.contains("panicked") && !ended.out.contains("NaN"));
        }
        Ok(())
    });
    tried.expect("no record that ends in a panic");
}
