//! Systems and laws whose text stands in the place of a file's name, as programs give them.

use crate::command;
use crate::common::ROOT;
use command::{Ended, run};
use serde_json::Value;
use std::fs;
use std::path::Path;

fn text_of(path: &str) -> String {
    fs::read_to_string(Path::new(ROOT).join(path)).expect("a file")
}

/// A command with one more option whose value has any letters.
fn with(arguments: &str, option: &str, value: &str) -> Ended {
    let mut words: Vec<&str> = arguments.split_whitespace().collect();
    words.extend([option, value, "-q"]);
    run(&words)
}

fn made(arguments: &str, option: &str, value: &str) -> Value {
    let ended = with(arguments, option, value);
    assert_eq!(ended.code, 0, "{}", ended.err);
    serde_json::from_str(&ended.out).expect("JSON")
}

#[test]
fn a_text_is_the_system_that_its_file_is() {
    let run = "integrate --until 3 --points 4 --format json";
    let text = text_of("scenes/systems/lorenz.toml");
    let (given, named) = (
        made(run, "--system", &text),
        made(run, "--system", "lorenz"),
    );
    assert_eq!(given["result"], named["result"]);
    assert_eq!(given["model"], named["model"]);
    assert_eq!(given["model"]["system"], "Lorenz");
}

#[test]
fn a_text_is_the_law_that_its_file_is() {
    let text = text_of("scenes/laws/composite.toml");
    for run in [
        "integrate --driving 1 --stiffness 1 --until 3 --points 4 --format json",
        "equilibria --driving 1 --stiffness 1 --format json",
        "law --points 5 --format json",
    ] {
        let (given, named) = (
            made(run, "--law", &text),
            made(run, "--law", "composite.toml"),
        );
        assert_eq!(given["result"], named["result"], "{run}");
        assert_eq!(given["model"], named["model"], "{run}");
    }
}

#[test]
fn messages_name_the_place_in_the_text_and_not_the_text() {
    let system = "name = \"n\"\nstates = [\"x\"]\n[rates]\nx = \"x + q\"\n";
    let ended = with("integrate --until 1", "--system", system);
    assert_eq!(ended.code, 2, "{}", ended.err);
    assert!(
        ended
            .err
            .starts_with("error: the system:4:10: \"q\" is no state"),
        "{}",
        ended.err
    );
    let law = "slip_rate = \"tau\"\nevolution = \"1 - v*psi*b\"\n";
    let ended = with(
        "integrate --driving 1 --stiffness 1 --until 1",
        "--law",
        law,
    );
    assert!(ended.err.starts_with("error: the law:2:"), "{}", ended.err);
    let text = text_of("scenes/laws/composite.toml");
    let ended = with(
        "equilibria --driving 1 --stiffness 1 --interfaces 4",
        "--law",
        &text,
    );
    assert_eq!(ended.code, 2, "{}", ended.err);
    assert!(
        ended.err.contains("--law (a text) is from a file") && !ended.err.contains("slip_rate"),
        "{}",
        ended.err
    );
    let long = format!("# {}\n", "long ".repeat(1 << 14));
    let ended = with("integrate --until 1", "--system", &long);
    assert_eq!(
        ended.err,
        "error: the system: its text is longer than 65536 bytes\n"
    );
}

#[test]
fn the_remarks_of_rows_have_the_text_on_one_line() {
    let text =
        "name = \"one's \\\\ own\"\nstates = [\"x\"]\n[rates]\nx = \"-x\"\n[start]\nx = 1.0\n";
    let ended = with(
        "integrate --until 1 --points 2 --format csv",
        "--system",
        text,
    );
    assert_eq!(ended.code, 0, "{}", ended.err);
    let command: Vec<&str> = ended
        .out
        .lines()
        .filter(|line| line.starts_with("# command: "))
        .collect();
    let word = r#"--system $'name = "one\'s \\\\ own"\nstates = ["x"]\n[rates]\nx = "-x"\n[start]\nx = 1.0\n'"#;
    assert_eq!(command.len(), 1);
    assert!(command[0].contains(word), "{}", command[0]);
    let rows = command::csv(&ended.out);
    assert_eq!(rows[0], ["time", "x"]);
    assert_eq!(rows.len(), 3);
}

#[test]
fn parts_of_a_sweep_are_joined_of_files_alone() {
    let path = command::folder("text_given_sweep").join("map.csv");
    let file = path.to_str().expect("a path");
    let text = text_of("scenes/systems/roessler.toml");
    let sweep = format!("sweep --surface x=0 --grid c=2.5:3:2 --max-returns 200 -o {file}");
    let ended = with(&sweep, "--system", &text);
    assert_eq!(ended.code, 0, "{}", ended.err);
    let ended = run(&["merge", file, "-o", &format!("{file}.csv")]);
    assert_eq!(ended.code, 2, "{}", ended.err);
    assert!(
        ended
            .err
            .contains("map.csv: its system or law was given as text"),
        "{}",
        ended.err
    );
}
