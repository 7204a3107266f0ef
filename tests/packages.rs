//! Who uses the library alone compiles none of the packages that only the command needs; and all features share one build of the
//! models.

use crate::common::ROOT;
use std::collections::BTreeSet;
use std::process::Command;

/// What the command, its files and its pictures need, and nothing else does.
const OF_THE_COMMAND: &[&str] = &[
    "clap",
    "clap_builder",
    "clap_complete",
    "clap_mangen",
    "csv",
    "ctrlc",
    "include_dir",
    "indicatif",
    "maud",
    "resvg",
    "roxmltree",
    "rustix",
    "serde",
    "serde_json",
    "sha2",
    "signal-hook",
    "terminal_size",
    "toml",
    "ttf-parser",
    "twinslip-output",
    "winnow",
];

/// All packages that go into this one with these features.
fn packages(of: &str, features: &[&str]) -> BTreeSet<String> {
    let lines = tree(
        "{p}",
        &[&["--edges", "normal", "--package", of], features].concat(),
    );
    lines.iter().map(|line| name(line)).collect()
}

fn name(line: &str) -> String {
    line.split_whitespace().next().unwrap_or(line).to_owned()
}

/// The packages in this format, each once.
fn tree(format: &str, options: &[&str]) -> BTreeSet<String> {
    let tree = Command::new(env!("CARGO"))
        .current_dir(ROOT)
        .args(["tree", "--offline", "--locked"])
        .args(["--prefix", "none", "--no-dedupe", "--format", format])
        .args(options)
        .output()
        .expect("cargo runs");
    assert!(
        tree.status.success(),
        "{}",
        String::from_utf8_lossy(&tree.stderr)
    );
    let text = String::from_utf8(tree.stdout).expect("UTF-8");
    text.lines().map(str::to_owned).collect()
}

fn of_the_command(found: &BTreeSet<String>) -> Vec<&str> {
    let named = OF_THE_COMMAND.iter().copied();
    named.filter(|&name| found.contains(name)).collect()
}

#[test]
fn the_library_alone_is_without_the_packages_of_the_command() {
    for features in [
        &["--no-default-features"] as &[_],
        &["--no-default-features", "--features", "sundials"],
    ] {
        let found = packages("twinslip", features);
        assert!(found.contains("twinslip-model"), "{found:?}");
        let none: [&str; 0] = [];
        assert_eq!(of_the_command(&found), none, "with {features:?}");
    }
}

/// Two versions of one of these would both be compiled, for seconds each, in every build from nothing.
#[test]
fn the_program_is_built_with_one_bindgen_and_one_syn() {
    let lines = tree(
        "{p}",
        &["--edges", "normal,build", "--package", "twinslip-cli"],
    );
    for package in ["bindgen", "syn"] {
        let versions = lines.iter().filter(|line| name(line) == package);
        assert_eq!(versions.count(), 1, "of {package}");
    }
}

/// A name that no package has would be looked for in vain.
#[test]
fn the_command_has_these_packages() {
    assert_eq!(
        of_the_command(&packages("twinslip-cli", &[])),
        OF_THE_COMMAND
    );
}

/// Where a feature of the project turns a feature on in a package that the models need, their kernels, which take the compiler longest,
/// are compiled once more for it.
#[test]
#[ignore = "needs the packages of all features, which `cargo fetch --locked` downloads"]
fn all_features_share_one_build_of_the_models() {
    const EDGES: &[&str] = &["--edges", "normal,build"];
    let version = |line: &str| {
        let words: Vec<_> = line.split_whitespace().take(2).collect();
        words.join(" ")
    };
    let below = tree("{p}", &[EDGES, &["--package", "twinslip-model"]].concat());
    let below: BTreeSet<_> = below.iter().map(|line| version(line)).collect();
    let with = |features: &[&str]| {
        let command = &["--package", "twinslip-cli"];
        let mut all = tree("{p} [{f}]", &[EDGES, command, features].concat());
        all.retain(|line| below.contains(&version(line)));
        all
    };
    let all = with(&["--features", "mpi,parquet"]);
    assert!(
        all.iter().any(|line| line.starts_with("nalgebra ")),
        "{all:?}"
    );
    for features in [&[] as &[_], &["--no-default-features"]] {
        let missing: Vec<_> = with(features).difference(&all).cloned().collect();
        assert_eq!(missing, [""; 0], "with {features:?}");
    }
}

/// Else `./test` compiles again what `./reproduce` has built, and so does every command for one package alone.
#[test]
fn tests_share_the_build_of_the_command() {
    let command = tree("{p} [{f}]", &["--edges", "normal,build"]);
    let all = &["--workspace", "--exclude", "twinslip-python"];
    let tests = tree(
        "{p} [{f}]",
        &[&["--edges", "normal,build,dev"], all as &[_]].concat(),
    );
    let alone = ["--edges", "normal,build", "--package", "twinslip-cli"];
    for (which, other) in [("tests", tests), ("alone", tree("{p} [{f}]", &alone))] {
        let ours = command.iter().filter(|line| line.contains(ROOT));
        let again: Vec<_> = ours.filter(|&line| !other.contains(line)).collect();
        assert_eq!(again, [""; 0], "{which}");
    }
    assert!(
        command
            .iter()
            .any(|line| line.starts_with("twinslip-tasks ")),
        "{command:?}"
    );
}

/// Else whoever builds both compiles all twice.
#[test]
#[ignore = "needs the packages of the Python package, which `cargo fetch --locked` downloads"]
fn the_python_package_shares_the_build_of_the_command() {
    const EDGES: &[&str] = &["--edges", "normal,build"];
    let of = |package: &str| tree("{p} [{f}]", &[EDGES, &["--package", package]].concat());
    let (command, python) = (of("twinslip-cli"), of("twinslip-python"));
    let missing: Vec<_> = command.difference(&python).cloned().collect();
    assert_eq!(missing, [""; 0]);
    assert!(
        python.iter().any(|line| line.starts_with("pyo3 ")),
        "{python:?}"
    );
}
