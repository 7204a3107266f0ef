//! Runs the program as a user does.
#![allow(dead_code)]

#[cfg(unix)]
pub mod durable;
#[cfg(feature = "explore")]
pub mod explore;
pub mod sweeps;

use crate::common::ROOT;
use serde_json::Value;
use std::path::{Path, PathBuf};
use std::process::{Command, Output};

/// A run of a moment.
pub const RUN: &str = "integrate --driving 0.12 --stiffness 0.14 --until 10";

/// How a run of the program ended.
pub struct Ended {
    /// Exit status.
    pub code: i32,
    /// Standard output.
    pub out: String,
    /// Standard error.
    pub err: String,
}

/// The program, to be run in the folder of the repository.
pub fn program() -> Command {
    let mut program = Command::new(env!("CARGO_BIN_EXE_twinslip"));
    program.current_dir(ROOT);
    program
}

/// Runs it with arguments separated by spaces.
pub fn twinslip(arguments: &str) -> Ended {
    run(&arguments.split_whitespace().collect::<Vec<_>>())
}

/// Runs it with these arguments.
pub fn run(arguments: &[&str]) -> Ended {
    let Output {
        status,
        stdout,
        stderr,
    } = program()
        .args(arguments)
        .output()
        .expect("the program starts");
    Ended {
        code: status.code().expect("no signal"),
        out: String::from_utf8(stdout).expect("UTF-8"),
        err: String::from_utf8(stderr).expect("UTF-8"),
    }
}

/// The object that a command writes, which must succeed.
pub fn object(arguments: &str) -> Value {
    let ended = twinslip(&format!("{arguments} --format json -q"));
    assert_eq!(ended.code, 0, "{arguments}: {}", ended.err);
    serde_json::from_str(&ended.out).expect("JSON")
}

/// The object that a command writes which may leave a verdict undecided.
pub fn object_or_undecided(arguments: &str) -> Value {
    let ended = twinslip(&format!("{arguments} --format json -q"));
    let done = [0, 3].contains(&ended.code);
    assert!(done, "{arguments}: {}", ended.err);
    serde_json::from_str(&ended.out).expect("JSON")
}

/// Exit code 2, nothing on standard output, and the sentence.
#[track_caller]
pub fn refused(arguments: &str, sentence: &str) -> Ended {
    let ended = twinslip(arguments);
    assert_eq!(ended.code, 2, "{arguments}: {}", ended.err);
    assert_eq!(ended.out, "", "{arguments}");
    assert!(
        ended.err.starts_with("error: ") && ended.err.contains(sentence),
        "{arguments}: {}",
        ended.err
    );
    ended
}

/// Refused with the sentence and no usage below it.
#[track_caller]
pub fn refused_in_one_line(arguments: &str, sentence: &str) {
    let Ended { err, .. } = refused(arguments, sentence);
    assert_eq!(err.lines().count(), 1, "{arguments}: {err}");
}

/// The rows of a CSV as texts, header first, without remarks.
pub fn csv(text: &str) -> Vec<Vec<String>> {
    text.lines()
        .filter(|line| !line.starts_with('#'))
        .map(|line| line.split(',').map(str::to_owned).collect())
        .collect()
}

/// A folder that is this test's own and empty.
pub fn folder(name: &str) -> PathBuf {
    let path = Path::new(env!("CARGO_TARGET_TMPDIR")).join(name);
    let _ = std::fs::remove_dir_all(&path);
    std::fs::create_dir_all(&path).expect("a folder");
    path
}

/// What lies in a folder.
pub fn contents(folder: &Path) -> Vec<String> {
    std::fs::read_dir(folder)
        .expect("a readable folder")
        .map(|entry| {
            entry
                .expect("an entry")
                .file_name()
                .to_string_lossy()
                .into_owned()
        })
        .collect()
}

/// A number in an object, by a path such as `/result/final/time`.
pub fn number(object: &Value, path: &str) -> f64 {
    object
        .pointer(path)
        .and_then(Value::as_f64)
        .unwrap_or_else(|| panic!("{path} is no number"))
}
