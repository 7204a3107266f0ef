//! No option is accepted and ignored: each option of each command, changed for each kind of system, changes what comes out, or is refused.

mod runs;
mod values;

use crate::command::{Ended, folder, run};
use rayon::prelude::*;
use runs::{Kind, commands};
use serde_json::Value;
use std::collections::BTreeSet;
use std::path::PathBuf;
use values::{Change, change};

/// A quick run of a command for a kind of system.
struct Base {
    command: &'static str,
    kind: Kind,
    words: Vec<String>,
}

fn words(text: &str) -> Vec<String> {
    text.split_whitespace().map(str::to_owned).collect()
}

fn bases() -> Vec<Base> {
    let of = |(command, all): (&'static str, Vec<(Kind, String)>)| {
        let base = move |(kind, text): (Kind, String)| Base {
            command,
            kind,
            words: words(&format!("{command} {text}")),
        };
        all.into_iter().map(base).collect::<Vec<_>>()
    };
    commands().into_iter().flat_map(of).collect()
}

/// The options that a command's help lists, without the dashes.
fn options(command: &str) -> Vec<String> {
    let help = run(&[command, "--help"].join(" ").split(' ').collect::<Vec<_>>());
    let option = |line: &str| {
        let text = line.trim_start();
        // Lines on what an option does are further in.
        let begins = line.len() - text.len() <= 6 && text.starts_with('-');
        let name = text.split_once("--").filter(|_| begins)?.1;
        let end = name.find(|c: char| !(c.is_ascii_alphanumeric() || c == '-'));
        Some(name[..end.unwrap_or(name.len())].to_owned())
    };
    let all: Vec<String> = help.out.lines().filter_map(option).collect();
    assert!(all.len() > 20, "{command}: {all:?}");
    all
}

impl Base {
    /// The words with others, which take the place of those of the same names. These may be given again: they come to what is there.
    fn with(&self, more: &[String]) -> Vec<String> {
        const REPEATED: [&str; 4] = ["--set", "--range", "--draw", "--grid"];
        let replaced = |word: &str| more.iter().any(|one| one == word) && !REPEATED.contains(&word);
        let mut all = Vec::new();
        let mut kept = self.words.iter().peekable();
        while let Some(word) = kept.next() {
            if !(word.starts_with("--") && replaced(word)) {
                all.push(word.clone());
            } else if kept.peek().is_some_and(|value| !value.starts_with("--")) {
                kept.next();
            }
        }
        all.extend(more.iter().cloned());
        all
    }

    fn run(&self, more: &[String]) -> (Vec<String>, Ended) {
        let words = [self.with(more), self::words("--format json --quiet")].concat();
        let ended = run(&words.iter().map(String::as_str).collect::<Vec<_>>());
        (words, ended)
    }
}

/// What a run has come to, without what only repeats the options.
fn result(ended: &Ended) -> (i32, Value) {
    let mut object: Value = serde_json::from_str(&ended.out).unwrap_or_default();
    if let Some(object) = object.as_object_mut() {
        for echo in ["command", "model", "numerics"] {
            object.remove(echo);
        }
    }
    (ended.code, object)
}

/// What becomes of an option.
#[derive(Debug, Clone, Copy, PartialEq)]
enum Fate {
    Used,
    Refused,
    Exempt,
}

/// Changes an option; `Err` where nothing comes of it.
fn tried(base: &Base, plain: &Ended, option: &str) -> Result<Fate, String> {
    let Base { command, kind, .. } = base;
    let flag = format!("--{option}");
    let Some(change) = change(command, *kind, option) else {
        return Err(format!(
            "{command} has an option {flag} that tests/options_used/values.rs has no other value of"
        ));
    };
    let (needs, value, file) = match change {
        Change::To(value) => ("", value, None),
        Change::With(needs, value) => (needs, value, None),
        Change::File(needs) => (needs, "", Some(picture(base, option))),
        Change::Exempt => return Ok(Fate::Exempt),
    };
    let value = file
        .as_ref()
        .map_or(value.to_owned(), |file| file.display().to_string());
    let with = [self::words(needs), vec![flag.clone()], self::words(&value)].concat();
    let (said, changed) = base.run(&with_last(&with, &flag));
    let said = said.join(" ");
    if changed.code == 2 {
        // By its name or its value, or by what it does not go with: something that was said.
        let names = |word: &str| {
            (word.len() > 2 || word == "si") && changed.err.contains(word.trim_end_matches('s'))
        };
        let own = said
            .split(['-', ' ', ',', '='])
            .skip(1)
            .filter(|word| word.parse::<f64>().is_err());
        let told = own.map(|word| word.trim()).any(names);
        return match told && changed.err.starts_with("error: ") {
            true => Ok(Fate::Refused),
            false => Err(format!(
                "{said}: refused, but not by its name: {}",
                changed.err
            )),
        };
    }
    if let Some(file) = file {
        let drawn = file.exists();
        return drawn
            .then_some(Fate::Used)
            .ok_or(format!("{said}: no file is written"));
    }
    let before = match needs {
        "" => result(plain),
        _ => result(&base.run(&self::words(needs)).1),
    };
    match before == result(&changed) {
        true => Err(format!(
            "{said}: the option {flag} changes nothing ({kind:?})"
        )),
        false => Ok(Fate::Used),
    }
}

/// The words, without an earlier value of the flag that stands last.
fn with_last(words: &[String], flag: &str) -> Vec<String> {
    let last = words.iter().rposition(|word| word == flag);
    let mut kept = Vec::new();
    let mut all = words.iter().enumerate();
    while let Some((i, word)) = all.next() {
        if word == flag && Some(i) != last && flag != "--set" {
            all.next();
        } else {
            kept.push(word.clone());
        }
    }
    kept
}

/// A file for a picture of this run alone.
fn picture(base: &Base, option: &str) -> PathBuf {
    let Base { command, kind, .. } = base;
    let name = format!("options-used-{command}-{kind:?}-{option}").replace(' ', "-");
    folder(&name).join("picture.svg")
}

#[test]
fn every_option_is_used_or_refused_for_every_kind_of_system() {
    let bases = bases();
    let told: Vec<Result<(&str, String, Fate), String>> = bases
        .par_iter()
        .flat_map(|base| {
            let (said, plain) = base.run(&[]);
            assert_ne!(plain.code, 2, "{said:?}: {}", plain.err);
            let all = options(base.command).into_par_iter();
            let one = move |option: String| {
                let fate = tried(base, &plain, &option)?;
                Ok((base.command, option, fate))
            };
            all.map(one).collect::<Vec<_>>()
        })
        .collect();
    let wrong: BTreeSet<&str> = told
        .iter()
        .filter_map(|one| one.as_ref().err())
        .map(String::as_str)
        .collect();
    assert!(
        wrong.is_empty(),
        "{} options:\n{}",
        wrong.len(),
        Vec::from_iter(wrong).join("\n")
    );
    // What is refused for all kinds has a value in the table that is none, or should not be an option of the command.
    let of = |fates: &[Fate]| -> BTreeSet<(&str, &str)> {
        let all = told.iter().flatten();
        let all = all.filter(|(.., fate)| fates.contains(fate));
        all.map(|(command, option, _)| (*command, option.as_str()))
            .collect()
    };
    let never: Vec<_> = of(&[Fate::Refused])
        .difference(&of(&[Fate::Used, Fate::Exempt]))
        .copied()
        .collect();
    assert_eq!(
        never,
        values::NEVER,
        "options that are refused for every kind"
    );
}

#[test]
fn what_is_shown_and_where_follows_the_options() {
    let of_one = bases().into_iter().filter(|base| base.kind == Kind::One);
    of_one.collect::<Vec<_>>().into_par_iter().for_each(|base| {
        let shown = |more: &str| {
            let words = [&base.words[..], &words(more)].concat();
            run(&words.iter().map(String::as_str).collect::<Vec<_>>())
        };
        let command = base.command;
        let csv = shown("--format csv");
        assert!(csv.out.starts_with("# "), "{command}");
        // All steady states that there are need no word.
        assert_eq!(csv.err.is_empty(), command == "equilibria", "{command}");
        assert!(shown("--format json").out.starts_with('{'), "{command}");
        assert_eq!(shown("--format csv --quiet").err, "", "{command}");
        let explained = shown("--format csv --explain");
        assert!(explained.err.contains("plan of this"), "{command}");
        let file =
            folder(&format!("options-used-shown-{command}").replace(' ', "-")).join("rows.csv");
        let name = file.display().to_string();
        let read = || std::fs::read_to_string(&file).expect("a file");
        std::fs::write(&file, "of somebody else").expect("a file");
        assert_eq!(shown(&format!("-o {name}")).code, 2, "{command}");
        assert_eq!(read(), "of somebody else", "{command}");
        let written = shown(&format!("-o {name} --force"));
        assert_eq!(
            (written.code, written.out.as_str()),
            (csv.code, ""),
            "{command}: {}",
            written.err
        );
        let rows = |text: &str| crate::command::csv(text);
        assert_eq!(rows(&read()), rows(&csv.out), "{command}");
    });
}
