//! The page on files: what is written about them by hand, with the lists that the program knows.

use super::{code, escaped};
use crate::program;
use std::fmt::Write;
use twinslip_tasks::scene::{about, shipped, shipped_laws, shipped_names, shipped_systems};

/// The page, with a line `{{NAME}}` in the place of each list.
const TEXT: &str = include_str!("files.md");

pub fn page() -> String {
    let scenes = shipped_names().into_iter();
    let scenes = scenes.filter_map(|name| Some((name, shipped(name)?)));
    let lists = [
        ("options", options()),
        ("scenes", listed(scenes)),
        ("systems", listed(shipped_systems())),
        ("laws", listed(shipped_laws())),
    ];
    let filled = |page: String, (name, list): (&str, String)| {
        page.replace(&format!("{{{{{name}}}}}\n"), &list)
    };
    lists.into_iter().fold(TEXT.to_owned(), filled)
}

/// Names with the first sentence of the remark at the head of each file.
fn listed(files: impl IntoIterator<Item = (&'static str, &'static str)>) -> String {
    let mut list = "| name | |\n|---|---|\n".to_owned();
    for (name, text) in files {
        let _ = writeln!(list, "| {} | {} |", code(name), escaped(&about(text)));
    }
    list
}

/// The options that name a file, with the commands that have them.
fn options() -> String {
    let program = program();
    let mut options: Vec<(String, Vec<&str>)> = Vec::new();
    for command in program
        .get_subcommands()
        .filter(|command| !command.is_hide_set())
    {
        for arg in command.get_arguments() {
            let values = arg.get_value_names().unwrap_or_default();
            let names_file = values
                .iter()
                .any(|value| ["FILE", "DIR"].contains(&value.as_str()));
            let Some(long) = arg.get_long().filter(|_| names_file) else {
                continue;
            };
            let form = format!("--{long} {}", values.join(" "));
            match options.iter_mut().find(|(one, _)| *one == form) {
                Some((_, commands)) => commands.push(command.get_name()),
                None => options.push((form, vec![command.get_name()])),
            }
        }
    }
    let mut list = "| option | commands |\n|---|---|\n".to_owned();
    for (form, commands) in options {
        let _ = writeln!(list, "| {} | {} |", code(&form), commands.join(", "));
    }
    list
}
