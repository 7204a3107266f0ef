//! Files that name the version, the licence or the keywords of the program agree, and what packaging names is there.

use crate::common::ROOT;
use std::collections::BTreeSet;
use std::path::Path;

const VERSION: &str = env!("CARGO_PKG_VERSION");

fn text(name: &str) -> String {
    std::fs::read_to_string(Path::new(ROOT).join(name)).unwrap_or_else(|e| panic!("{name}: {e}"))
}

fn manifest(name: &str) -> toml::Table {
    text(name).parse().unwrap_or_else(|e| panic!("{name}: {e}"))
}

fn names_in(folder: &str) -> BTreeSet<String> {
    let entries = std::fs::read_dir(Path::new(ROOT).join(folder)).expect(folder);
    let names = entries.map(|entry| entry.expect("an entry").file_name());
    names
        .map(|name| name.to_str().expect("UTF-8").to_owned())
        .collect()
}

/// What stands in the one line of a file that begins so.
fn after(file: &str, start: &str) -> String {
    let text = text(file);
    let mut found = text.lines().filter_map(|line| line.strip_prefix(start));
    let rest = found.next().unwrap_or_else(|| panic!("{file}: {start}"));
    assert_eq!(found.next(), None, "{file}: two lines begin with {start}");
    rest.to_owned()
}

/// The items of a list in YAML, one a line, below this line.
fn listed(file: &str, heading: &str) -> Vec<String> {
    let text = text(file);
    let below = text.lines().skip_while(|line| *line != heading).skip(1);
    let items = below.map_while(|line| line.strip_prefix("  - "));
    items.map(str::to_owned).collect()
}

fn codemeta() -> serde_json::Value {
    serde_json::from_str(&text("codemeta.json")).expect("JSON")
}

/// The versions of the list of changes, the newest first, with their dates.
fn releases() -> Vec<(String, String)> {
    let text = text("CHANGELOG.md");
    let headings = text.lines().filter_map(|line| line.strip_prefix("## "));
    let split = |heading: &str| {
        let (version, date) = heading.split_once(" (").expect("a date");
        let date = date.strip_suffix(')').expect("a date");
        (version.to_owned(), date.to_owned())
    };
    headings.map(split).collect()
}

#[test]
fn every_file_names_the_same_version() {
    assert_eq!(after("CITATION.cff", "version: "), VERSION);
    assert_eq!(codemeta()["version"], VERSION);
    assert_eq!(
        after("packaging/conda/meta.yaml", "{% set version = "),
        format!("\"{VERSION}\" %}}")
    );
    let dependencies = &manifest("Cargo.toml")["workspace"]["dependencies"];
    let dependencies = dependencies.as_table().expect("a table");
    let ours = dependencies
        .iter()
        .filter(|(name, _)| name.starts_with("twinslip"));
    let mut seen = 0;
    for (name, wanted) in ours {
        let version = wanted["version"].as_str();
        assert_eq!(version, Some(format!("={VERSION}").as_str()), "{name}");
        seen += 1;
    }
    assert!(seen > 5, "{seen}");
}

/// Names of packages in documents, as `twinslip-0.1.0-` and `twinslip_0.1.0-`.
#[test]
fn documents_name_packages_of_this_version() {
    let mut seen = 0;
    for name in ["README.md", "docs/install.md", "docs/python.md"] {
        let text = text(name);
        for start in ["twinslip-", "twinslip_"] {
            let digit = |rest: &&str| rest.starts_with(|c: char| c.is_ascii_digit());
            for rest in text.split(start).skip(1).filter(digit) {
                assert!(
                    rest.starts_with(&format!("{VERSION}-")),
                    "{name}: {rest:.20}"
                );
                seen += 1;
            }
        }
    }
    assert!(seen > 5, "{seen}");
}

#[test]
fn every_release_has_a_page_and_one_date() {
    let releases = releases();
    let (version, date) = releases.first().expect("a release");
    assert_eq!(version, VERSION);
    if date != "unreleased" {
        assert_eq!(&after("CITATION.cff", "date-released: "), date);
        assert_eq!(codemeta()["datePublished"], date.as_str());
    }
    let released = releases.iter().filter(|(_, date)| date != "unreleased");
    let wanted: BTreeSet<_> = released
        .map(|(version, _)| format!("{version}.md"))
        .collect();
    assert_eq!(names_in("docs/releases"), wanted);
    for (version, _) in &releases {
        let page = text(&format!("docs/releases/{version}.md"));
        assert!(page.starts_with(&format!("# twinslip {version}\n")));
    }
}

#[test]
fn citation_and_codemeta_say_the_same() {
    let codemeta = codemeta();
    let list = |name: &str| -> Vec<String> {
        serde_json::from_value(codemeta[name].clone()).expect("a list of words")
    };
    assert_eq!(listed("CITATION.cff", "keywords:"), list("keywords"));
    let licences = listed("CITATION.cff", "license:");
    let address = |licence: &String| format!("https://spdx.org/licenses/{licence}");
    assert_eq!(
        licences.iter().map(address).collect::<Vec<_>>(),
        list("license")
    );
    let package = &manifest("Cargo.toml")["workspace"]["package"];
    assert_eq!(package["license"].as_str(), Some(&*licences.join(" OR ")));
    for licence in licences {
        let short = licence.split('-').next().unwrap_or(&licence).to_uppercase();
        assert!(Path::new(ROOT).join(format!("LICENSE-{short}")).exists());
    }
    let rust = package["rust-version"].as_str().expect("a version");
    let needed = format!("Rust {rust} or newer");
    for name in ["README.md", "codemeta.json"] {
        assert!(text(name).contains(&needed), "{name}");
    }
    assert!(
        text(".github/workflows/test.yml").contains(&format!("rustup default {rust}\n")),
        "the oldest Rust is tried"
    );
}

/// The machines that build the documentation of crates have no SUNDIALS.
#[test]
fn documentation_of_crates_is_built_without_the_c_solvers() {
    let crates = names_in("crates");
    let crates = crates
        .iter()
        .map(|name| format!("crates/{name}/Cargo.toml"));
    let mut with_c = 0;
    for name in crates.chain(["Cargo.toml".to_owned()]) {
        let manifest = manifest(&name);
        let has = |feature: &str| {
            manifest
                .get("features")
                .and_then(|f| f.get(feature))
                .is_some()
        };
        if !has("sundials") {
            continue;
        }
        let docs = &manifest["package"]["metadata"]["docs"]["rs"];
        assert_eq!(docs["no-default-features"].as_bool(), Some(true), "{name}");
        with_c += 1;
    }
    assert!(with_c >= 4, "{with_c}");
}

/// Scripts that workflows, recipes and pages call, by the words that begin with their folder.
#[test]
fn packaging_calls_scripts_that_are_there() {
    let workflows = names_in(".github/workflows");
    let workflows = workflows
        .iter()
        .map(|name| format!(".github/workflows/{name}"));
    let others = [
        "Dockerfile",
        "packaging/conda/meta.yaml",
        "docs/install.md",
        "python/test",
    ];
    let mut seen = 0;
    for name in workflows.chain(others.map(str::to_owned)) {
        let end = |c: char| c.is_whitespace() || "`,:;)".contains(c);
        for word in text(&name)
            .split(end)
            .filter(|w| w.starts_with("packaging/"))
        {
            assert!(Path::new(ROOT).join(word).exists(), "{name}: {word}");
            seen += 1;
        }
    }
    assert!(seen > 10, "{seen}");
}
