//! Every command of the guide runs as it stands.
#![allow(missing_docs)]

mod command;

use command::folder;
use std::process::Command;

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

#[test]
fn every_command_of_the_guide_runs() {
    let root = std::path::Path::new(env!("CARGO_MANIFEST_DIR"));
    let place = folder("guide");
    let text = std::fs::read_to_string(root.join("docs/guide.md")).expect("the guide");
    let commands = commands(&text);
    assert!(commands.len() >= 12, "{commands:?}");
    for line in commands {
        let words: Vec<&str> = line.split_whitespace().collect();
        assert_eq!(words[0], "twinslip", "{line}");
        let scenes = root.join("scenes");
        let words = words[1..]
            .iter()
            .map(|word| match word.strip_prefix("scenes/") {
                Some(scene) => scenes.join(scene).display().to_string(),
                None => (*word).to_owned(),
            });
        let ended = Command::new(env!("CARGO_BIN_EXE_twinslip"))
            .args(words)
            .current_dir(&place)
            .output()
            .expect("the program starts");
        let err = String::from_utf8_lossy(&ended.stderr);
        assert!(ended.status.success(), "{line}: {err}");
        // What it says it writes is there.
        let named = line
            .split_whitespace()
            .skip_while(|word| !word.starts_with('-'));
        for file in named
            .filter(|word| word.contains('.') && !word.starts_with(|c: char| c.is_ascii_digit()))
        {
            assert!(
                place.join(file).metadata().is_ok_and(|data| data.len() > 0),
                "{line}: {file}"
            );
        }
    }
    assert!(place.join("fig06.svg").exists());
}
