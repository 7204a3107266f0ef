//! The drawing of the rooms in CONTRIBUTING.md is true: imports point one way only.

use crate::common::ROOT;
use std::collections::{BTreeMap, BTreeSet};
use std::fs;
use std::path::{Path, PathBuf};

/// Each room and the rooms that it imports, as CONTRIBUTING.md draws them; `error` is open to all.
const MAY_IMPORT: &[(&str, &[&str])] = &[
    ("error", &[]),
    ("number", &[]),
    ("expression", &["number"]),
    ("series", &["number", "expression"]),
    ("friction", &["number"]),
    ("field", &["series"]),
    (
        "model",
        &["friction", "field", "series", "expression", "number"],
    ),
    ("contract", &[]),
    ("random", &[]),
    ("sundials", &["field", "contract"]),
    (
        "integrate",
        &[
            "model", "friction", "field", "series", "number", "contract", "sundials",
        ],
    ),
    (
        "equilibrium",
        &["friction", "model", "number", "field", "sundials"],
    ),
    ("continuation", &[]),
    (
        "section",
        &["integrate", "series", "friction", "number", "field"],
    ),
    (
        "orbit",
        &[
            "section",
            "equilibrium",
            "continuation",
            "integrate",
            "model",
            "field",
            "series",
            "friction",
            "number",
        ],
    ),
    (
        "sweep",
        &[
            "section",
            "equilibrium",
            "integrate",
            "model",
            "field",
            "series",
            "friction",
            "number",
            "random",
        ],
    ),
    (
        "bifurcation",
        &[
            "orbit",
            "equilibrium",
            "continuation",
            "integrate",
            "model",
            "field",
            "friction",
            "number",
        ],
    ),
    (
        "many",
        &[
            "integrate",
            "equilibrium",
            "model",
            "friction",
            "series",
            "number",
            "sundials",
        ],
    ),
    (
        "fit",
        &[
            "integrate",
            "model",
            "field",
            "series",
            "number",
            "sundials",
            "random",
        ],
    ),
    (
        "scene",
        &[
            "fit",
            "many",
            "sundials",
            "sweep",
            "bifurcation",
            "orbit",
            "section",
            "equilibrium",
            "integrate",
            "model",
            "series",
            "expression",
            "friction",
            "number",
            "field",
            "random",
        ],
    ),
    ("output", &[]),
    ("kernel", &[]),
    (
        "views",
        &[
            "scene",
            "fit",
            "many",
            "sweep",
            "bifurcation",
            "orbit",
            "section",
            "equilibrium",
            "friction",
            "number",
            "output",
        ],
    ),
    (
        "paper",
        &[
            "views",
            "scene",
            "bifurcation",
            "orbit",
            "section",
            "equilibrium",
            "integrate",
            "model",
            "field",
            "friction",
            "number",
            "output",
        ],
    ),
    (
        "cli",
        &[
            "paper",
            "views",
            "scene",
            "fit",
            "many",
            "sweep",
            "bifurcation",
            "orbit",
            "section",
            "equilibrium",
            "integrate",
            "sundials",
            "friction",
            "number",
            "output",
            "random",
        ],
    ),
];

fn sources(dir: &Path, found: &mut Vec<PathBuf>) {
    for entry in fs::read_dir(dir).expect("a readable folder") {
        let path = entry.expect("an entry").path();
        if path.is_dir() {
            sources(&path, found);
        } else if path.extension().is_some_and(|e| e == "rs") {
            found.push(path);
        }
    }
}

/// The lines that are no comments.
fn code(text: &str) -> impl Iterator<Item = &str> {
    let lines = text.lines();
    lines.filter(|l| !l.trim_start().starts_with("//"))
}

/// Names of rooms after `crate::` or the name of a crate, in code and not in comments, single or in braces.
fn imports(text: &str) -> Vec<String> {
    let code = code(text).collect::<Vec<_>>().join("\n");
    let code = code
        .replace("twinslip_tasks::", "crate::")
        .replace("twinslip::", "crate::")
        .replace("twinslip_output::", "crate::output::")
        .replace("twinslip_paper::", "crate::paper::");
    let mut names = Vec::new();
    for rest in code.split("crate::").skip(1) {
        let word = |s: &str| {
            s.chars()
                .take_while(|c| c.is_alphanumeric() || *c == '_')
                .collect::<String>()
        };
        if let Some(list) = rest.strip_prefix('{') {
            names.extend(
                list.split('}')
                    .next()
                    .unwrap_or("")
                    .split(',')
                    .map(|item| word(item.trim())),
            );
        } else {
            names.push(word(rest));
        }
    }
    names
}

/// Where the rooms are: those of a folder, or a crate that is one room.
const FOLDERS: [(&str, Option<&str>); 8] = [
    ("src", None),
    ("crates/model/src", None),
    ("crates/tasks/src", None),
    ("crates/paper/src", Some("paper")),
    ("crates/cli/src", Some("cli")),
    ("crates/output/src", Some("output")),
    ("crates/error/src", Some("error")),
    ("crates/kernel/src", Some("kernel")),
];

/// All files, each with its room.
fn files() -> Vec<(String, PathBuf)> {
    let mut all = Vec::new();
    for (folder, whole) in FOLDERS {
        let root = Path::new(ROOT).join(folder);
        let mut found = Vec::new();
        sources(&root, &mut found);
        all.extend(found.into_iter().map(|file| {
            let inside = file
                .strip_prefix(&root)
                .expect("below it")
                .with_extension("");
            let first = inside.iter().next().expect("a name");
            let room = whole.unwrap_or(first.to_str().expect("ASCII"));
            (room.to_string(), file)
        }));
    }
    all
}

#[test]
fn imports_point_one_way() {
    let allowed: BTreeMap<&str, &[&str]> = MAY_IMPORT.iter().copied().collect();
    let mut wrong = Vec::new();
    let mut seen = BTreeSet::new();
    for (room, file) in files() {
        if room == "lib" || room == "main" {
            continue;
        }
        let may = allowed
            .get(room.as_str())
            .unwrap_or_else(|| panic!("{} is in no known room", file.display()));
        for import in imports(&fs::read_to_string(&file).expect("readable")) {
            // an import of something that is no room (a re-export at the root, a macro) says nothing of direction
            if allowed.contains_key(import.as_str()) && import != room && import != "error" {
                seen.insert((room.clone(), import.clone()));
                if !may.contains(&import.as_str()) {
                    wrong.push(format!("{} imports {import}", file.display()));
                }
            }
        }
    }
    assert!(wrong.is_empty(), "{}", wrong.join("\n"));
    // an arrow that nothing follows would be a lie too
    for (room, rooms) in MAY_IMPORT {
        for import in *rooms {
            let arrow = (room.to_string(), import.to_string());
            assert!(seen.contains(&arrow), "{room} no longer imports {import}");
        }
    }
}

#[test]
fn the_drawing_has_these_rooms() {
    let root = Path::new(ROOT);
    let page = fs::read_to_string(root.join("CONTRIBUTING.md")).expect("readable");
    for (room, rooms) in MAY_IMPORT {
        let row = page
            .lines()
            .find(|line| line.split_whitespace().next() == Some(room) && line.ends_with(']'));
        let row = row.unwrap_or_else(|| panic!("{room} is not drawn"));
        let drawn = row
            .rsplit('[')
            .next()
            .expect("a bracket")
            .trim_end_matches(']');
        let expected = if rooms.is_empty() {
            "nothing".to_string()
        } else {
            rooms.join(", ")
        };
        assert_eq!(drawn, expected, "{room}");
    }
}

/// The string literals of a source, as they are written; comments and characters are none.
fn literals(text: &str) -> Vec<&str> {
    let mut found = Vec::new();
    let mut rest = text;
    while let Some(at) = rest.find(['"', '/', '\'', 'r']) {
        let word_before = rest[..at].ends_with(|c: char| c.is_alphanumeric() || c == '_');
        let here = &rest[at..];
        let hashes = here[1..].bytes().take_while(|&byte| byte == b'#').count();
        let raw = here.starts_with('r') && !word_before && here[1 + hashes..].starts_with('"');
        let length = if here.starts_with("//") {
            here.find('\n').unwrap_or(here.len())
        } else if raw {
            let (begin, end) = (2 + hashes, format!("\"{}", "#".repeat(hashes)));
            let inside = here[begin..].find(&end).expect("an end");
            found.push(&here[begin..begin + inside]);
            begin + inside + end.len()
        } else if let Some(inside) = here.strip_prefix('"') {
            let mut escaped = false;
            let end = inside.find(|c| {
                let closes = c == '"' && !escaped;
                escaped = c == '\\' && !escaped;
                closes
            });
            let end = end.expect("an end");
            found.push(&inside[..end]);
            end + 2
        } else if here.starts_with("'\\") {
            // An escaped character: at least one letter more before its end.
            here[3..].find('\'').map_or(1, |end| end + 4)
        } else if let Some(inside) = here.strip_prefix('\'') {
            // A character, or else a lifetime.
            let second = inside.char_indices().nth(1);
            second
                .filter(|(_, c)| *c == '\'')
                .map_or(1, |(end, _)| end + 2)
        } else {
            1
        };
        rest = &here[length..];
    }
    found
}

#[test]
fn only_the_command_line_speaks_of_flags() {
    // A scene, a sweep and what reads units and symbols make command lines of their own of what they are given, and to an ensemble one says more than it
    // holds.
    let lines = [
        "crates/tasks/src/scene/words/merge.rs",
        "crates/tasks/src/scene/words/mod.rs",
        "crates/tasks/src/scene/file.rs",
        "crates/tasks/src/scene/sweep/words.rs",
        "crates/tasks/src/scene/ensemble/implied.rs",
    ];
    let is_flag = |text: &str| {
        let mut after = text.split("--").skip(1);
        after.any(|word| word.starts_with(|c: char| c.is_ascii_lowercase() || c == '{'))
    };
    assert_eq!(
        literals(
            r##"f('"', '\'', "a\"--b") // "no"
            &'a str r#"x "--y"# "##
        ),
        ["a\\\"--b", "x \"--y"]
    );
    let mut wrong = Vec::new();
    for (room, file) in files() {
        let made = lines.iter().any(|line| file.ends_with(line));
        if room == "cli" || made {
            continue;
        }
        let text = fs::read_to_string(&file).expect("readable");
        let flags = literals(&text).into_iter().filter(|text| is_flag(text));
        wrong.extend(flags.map(|text| format!("{}: {text:?}", file.display())));
    }
    assert!(wrong.is_empty(), "{}", wrong.join("\n"));
}

/// Above the integrators the number of variables is known when the program runs: only a system written in Rust has it in its type.
#[test]
fn only_integrators_and_systems_know_their_dimension_when_compiled() {
    const ABOVE: [&str; 6] = [
        "equilibrium",
        "continuation",
        "section",
        "orbit",
        "sweep",
        "bifurcation",
    ];
    /// The family of the fields of one such system.
    const OF_SYSTEMS: &str = "OverParameters<S, ";
    for (room, file) in files() {
        if !ABOVE.contains(&room.as_str()) {
            continue;
        }
        let text = fs::read_to_string(&file).expect("readable");
        let known = code(&text).find(|line| {
            line.contains("const N: usize")
                && !line.contains(OF_SYSTEMS)
                && !line.contains("ParametrisedField")
        });
        assert_eq!(known, None, "{}", file.display());
    }
}

#[test]
fn only_the_sundials_room_and_the_call_of_kernels_allow_unsafe() {
    for (room, file) in files() {
        let text = fs::read_to_string(&file).expect("readable");
        if text.contains("unsafe_code") || text.contains("unsafe {") {
            if room == "kernel" && file.ends_with("memory.rs") {
                continue;
            }
            assert_eq!(room, "sundials", "{} has unsafe code", file.display());
        }
    }
}

/// What is named after `path::`, single or in braces.
fn named_after<'t>(path: &str, text: &'t str) -> Vec<&'t str> {
    let mut names = Vec::new();
    for (before, rest) in text
        .match_indices(path)
        .map(|(i, _)| (&text[..i], &text[i + path.len()..]))
    {
        if !before.ends_with(word) {
            let list = rest
                .strip_prefix('{')
                .and_then(|list| list.split('}').next());
            let first = list.or_else(|| rest.split(|c| !word(c)).next());
            names.extend(first.unwrap_or("").split(',').map(str::trim));
        }
    }
    names
}

fn word(c: char) -> bool {
    c.is_alphanumeric() || c == '_'
}

/// A law is a file and its entry in the list of `friction/mod.rs`: elsewhere in the sources only laws that build on another one name
/// it, and the paper, which is about some of them.
#[test]
fn a_law_is_one_file_and_one_entry() {
    let mut laws = Vec::new();
    let mut others = Vec::new();
    let mut list = String::new();
    for (room, file) in files() {
        let text = fs::read_to_string(&file).expect("readable");
        if file.ends_with("friction/mod.rs") {
            list = code(&text).collect::<Vec<_>>().join("\n");
        } else if let Some((_, rest)) = text.split_once("\nimpl Law for ") {
            assert_eq!(room, "friction");
            let stem = file.file_stem().and_then(|s| s.to_str()).expect("ASCII");
            if ["damped", "scaled"].contains(&stem) {
                // Any of the laws with one term more, or in other units.
                continue;
            }
            let name = rest.split(|c| !word(c)).next().expect("a type");
            laws.push((name.to_owned(), stem.to_owned()));
        } else if room != "paper" {
            others.push((file, code(&text).collect::<Vec<_>>().join("\n")));
        }
    }
    assert!(laws.len() >= 5, "{laws:?}");
    let times = |name: &str| list.split(|c| !word(c)).filter(|w| *w == name).count();
    for (law, stem) in &laws {
        assert_eq!(times(law), 1, "{law} in the list");
        assert_eq!(times(stem), 2, "{stem} as a module and in the list");
    }
    for (file, text) in &others {
        for path in ["friction::", "AnyLaw::", "super::"] {
            for name in named_after(path, text) {
                let known = laws.iter().any(|(law, _)| law == name);
                assert!(!known, "{} names {name}", file.display());
            }
        }
    }
}
