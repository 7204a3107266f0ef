//! Every command of the guide and of the README runs as it stands, and what documents point to is there.

use crate::command;
use crate::common::ROOT;
use command::folder;
use std::path::Path;

/// The commands in the blocks for the shell.
fn commands(text: &str) -> Vec<&str> {
    let mut inside = false;
    let mut found = Vec::new();
    for line in text.lines() {
        if line.starts_with("```") {
            inside = line == "```sh";
        } else if inside {
            found.push(line);
        }
    }
    found
}

/// The same command over less, where that is as good a test of it: grids have a few points, a staircase its first steps. All figures go one
/// way, and `./reproduce` makes the sixth.
fn shortened(line: &str) -> String {
    let few = |word: &str| {
        let mut parts: Vec<String> = word.split(':').map(str::to_owned).collect();
        let count = parts.get(2).filter(|_| parts.len() == 3);
        let count = count.map(|count| {
            (
                count.trim_end_matches("log").parse::<u32>(),
                count.ends_with("log"),
            )
        });
        if let Some((Ok(7..), log)) = count {
            parts[2] = format!("6{}", if log { "log" } else { "" });
        }
        parts.join(":")
    };
    let words: Vec<String> = line.split_whitespace().map(few).collect();
    let line = words.join(" ");
    let line = line.replace("figure 6", "figure 5");
    line.replace("--to 1e6 -o staircase-20", "--to 20 -o staircase-20")
}

/// Runs each in a folder of its own name; all must succeed and write what they name.
fn run_all(lines: &[&str], place: &Path) {
    let root = root();
    for line in lines {
        let line = &shortened(line);
        let words: Vec<&str> = line.split_whitespace().collect();
        assert_eq!(words[0], "twinslip", "{line}");
        let scenes = root.join("scenes");
        let words = words[1..]
            .iter()
            .map(|word| match word.strip_prefix("scenes/") {
                Some(scene) => scenes.join(scene).display().to_string(),
                None if word.starts_with("tests/data/") => root.join(word).display().to_string(),
                None => (*word).to_owned(),
            });
        let ended = crate::command::program()
            .args(words)
            .current_dir(place)
            .output()
            .expect("the program starts");
        let err = String::from_utf8_lossy(&ended.stderr);
        assert!(ended.status.success(), "{line}: {err}");
        // What it says it writes is there.
        let named = line
            .split_whitespace()
            .skip_while(|word| !word.starts_with('-'));
        // Those in TOML it reads.
        let file =
            |word: &&str| word.contains('.') && !word.contains('=') && !word.ends_with(".toml");
        for file in named
            .filter(file)
            .filter(|word| !word.starts_with(|c: char| c.is_ascii_digit()))
            .filter(|word| !word.starts_with("tests/data/"))
        {
            assert!(
                place.join(file).metadata().is_ok_and(|data| data.len() > 0),
                "{line}: {file}"
            );
        }
    }
}

fn root() -> &'static Path {
    Path::new(ROOT)
}

fn text_of(name: &str) -> String {
    std::fs::read_to_string(root().join(name)).expect(name)
}

#[test]
fn every_command_of_the_guide_runs() {
    let place = folder("guide");
    let text = text_of("docs/guide.md");
    let lines = commands(&text);
    assert!(lines.len() >= 12, "{lines:?}");
    run_all(&lines, &place);
    assert!(place.join("fig05.svg").exists());
}

/// Runs the commands of a page, of which there are so many at least, and gives its text.
fn page_runs(name: &str, least: usize) -> String {
    let text = text_of(&format!("docs/{name}.md"));
    let lines = commands(&text);
    assert!(lines.len() >= least, "{lines:?}");
    run_all(&lines, &folder(name));
    text
}

#[test]
fn every_command_of_the_page_on_many_interfaces_runs() {
    page_runs("many-interfaces", 7);
}

#[test]
fn every_command_of_the_page_on_systems_runs() {
    let text = page_runs("system-file", 4);
    // The file that it shows is one.
    let (_, rest) = text.split_once("```toml\n").expect("a file");
    let (file, _) = rest.split_once("```").expect("an end");
    let place = folder("system-file-shown");
    std::fs::write(place.join("shown.toml"), file).expect("a file");
    run_all(
        &["twinslip integrate --system shown.toml --until 10 -o run.csv"],
        &place,
    );
}

#[test]
fn every_command_of_the_page_on_uncertainty_runs() {
    page_runs("uncertainty", 4);
}

#[test]
fn every_command_of_the_page_on_fits_runs() {
    page_runs("fit", 2);
}

#[test]
fn every_command_of_the_readme_runs() {
    let text = text_of("README.md");
    let lines = commands(&text);
    let ours = |line: &&str| line.starts_with("twinslip ");
    let ours: Vec<&str> = lines.into_iter().filter(ours).collect();
    assert!(!ours.is_empty());
    run_all(&ours, &folder("readme"));
}

/// Relative links and pictures of all documents.
#[test]
fn what_documents_point_to_is_there() {
    let mut checked = 0;
    let mut names: Vec<String> = ["README.md", "CONTRIBUTING.md", "CHANGELOG.md"]
        .map(str::to_owned)
        .to_vec();
    for entry in std::fs::read_dir(root().join("docs")).expect("docs/") {
        let name = entry.expect("an entry").file_name();
        let name = name.to_string_lossy();
        if name.ends_with(".md") {
            names.push(format!("docs/{name}"));
        }
    }
    for name in names {
        let folder = root().join(&name);
        let folder = folder.parent().expect("a folder");
        for link in text_of(&name).split("](").skip(1) {
            let (link, _) = link.split_once(')').expect("an end");
            if !link.starts_with("http") {
                assert!(folder.join(link).exists(), "{name}: {link}");
                checked += 1;
            }
        }
    }
    assert!(checked > 15, "{checked}");
}
