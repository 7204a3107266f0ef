//! Who uses the library alone compiles none of the packages that only the command needs.

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
];

/// All packages that go into the library with these features.
fn packages(features: &[&str]) -> BTreeSet<String> {
    let tree = Command::new(env!("CARGO"))
        .current_dir(env!("CARGO_MANIFEST_DIR"))
        .args(["tree", "--offline", "--locked", "--edges", "normal"])
        .args(["--prefix", "none", "--format", "{p}"])
        .args(features)
        .output()
        .expect("cargo runs");
    assert!(
        tree.status.success(),
        "{}",
        String::from_utf8_lossy(&tree.stderr)
    );
    let text = String::from_utf8(tree.stdout).expect("UTF-8");
    let name = |line: &str| line.split_whitespace().next().map(str::to_owned);
    text.lines().filter_map(name).collect()
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
        let found = packages(features);
        assert!(found.contains("twinslip-model"), "{found:?}");
        let none: [&str; 0] = [];
        assert_eq!(of_the_command(&found), none, "with {features:?}");
    }
}

/// A name that no package has would be looked for in vain.
#[test]
fn the_command_has_these_packages() {
    assert_eq!(of_the_command(&packages(&[])), OF_THE_COMMAND);
}
