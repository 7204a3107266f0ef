//! The page on commands, from what the parser of the command line knows.

use super::{code, escaped};
use crate::{catalogue, program};
use clap::{Arg, Command};
use std::fmt::Write;

/// An option that at least so many commands have with the same words is described once.
const SHARED_BY: usize = 4;

const HEAD: &str = "# Commands

Each command with its examples and its own options in their groups. Options that several commands share are described once, under
[Shared options](#shared-options). `twinslip COMMAND -h` prints the main options of a command, `twinslip COMMAND --help` all of them.

Everything is dimensionless (stress in a σ, slip rate in V\\*, length in L, time in L/V\\*) unless `--si` is given. Data goes to
standard output or a file, messages to standard error.

| exit status | meaning |
|---|---|
| 0 | done |
| 1 | the computation failed; the rows computed so far are kept, and a message gives the reason |
| 2 | wrong usage or input |
| 3 | done, but a verdict is undecided |
| 130 | interrupted by Ctrl-C; the rows computed so far are kept |

";

pub fn page() -> String {
    let mut program = program();
    program.build();
    let mut commands: Vec<&Command> = program
        .get_subcommands()
        .filter(|command| !command.is_hide_set() && command.get_name() != "help")
        .collect();
    // Those that compute come first; the others keep their order.
    let computing = catalogue::commands();
    let rank = |command: &&Command| {
        let mut names = computing.iter();
        let place = names.position(|(name, _)| name == command.get_name());
        place.unwrap_or(computing.len())
    };
    commands.sort_by_key(rank);
    let shared = shared(&commands);
    let mut page = HEAD.to_owned();
    for command in &commands {
        let name = command.get_name();
        let _ = writeln!(page, "- [`{name}`](#{name}): {}", about(command));
    }
    for command in &commands {
        of_command(&mut page, command, &shared);
    }
    page.push_str("\n## Shared options\n");
    let all: Vec<&Arg> = shared.iter().map(|(arg, _)| *arg).collect();
    for heading in headings(&all) {
        let _ = write!(
            page,
            "\n### {heading}\n\n| option | meaning | commands |\n|---|---|---|\n"
        );
        let of_heading = shared.iter().filter(|(arg, _)| group(arg) == heading);
        for (arg, names) in of_heading {
            let names = names.join(", ");
            let _ = writeln!(page, "| {} | {} | {names} |", code(&form(arg)), help(arg));
        }
    }
    page
}

/// The options that several commands have with the same words, with the names of these commands.
fn shared<'a>(commands: &[&'a Command]) -> Vec<(&'a Arg, Vec<&'a str>)> {
    let mut known: Vec<(&Arg, Vec<&str>)> = Vec::new();
    for command in commands {
        for arg in options(command) {
            match known.iter_mut().find(|(one, _)| is_same(one, arg)) {
                Some((_, names)) => names.push(command.get_name()),
                None => known.push((arg, vec![command.get_name()])),
            }
        }
    }
    known.retain(|(_, names)| names.len() >= SHARED_BY);
    known
}

fn is_same(one: &Arg, other: &Arg) -> bool {
    form(one) == form(other) && help(one) == help(other) && group(one) == group(other)
}

fn of_command(page: &mut String, command: &Command, shared: &[(&Arg, Vec<&str>)]) {
    let _ = write!(page, "\n## {}\n\n{}.\n", command.get_name(), about(command));
    examples(page, command);
    let options = options(command);
    let (common, own): (Vec<&Arg>, Vec<&Arg>) = options
        .into_iter()
        .partition(|arg| shared.iter().any(|(one, _)| is_same(one, arg)));
    for heading in headings(&own) {
        let _ = write!(page, "\n**{heading}**\n\n| option | meaning |\n|---|---|\n");
        for arg in own.iter().filter(|arg| group(arg) == heading) {
            let _ = writeln!(page, "| {} | {} |", code(&form(arg)), help(arg));
        }
    }
    if !common.is_empty() {
        let _ = writeln!(page, "\n**[Shared options](#shared-options)**\n");
        for heading in headings(&common) {
            let of_heading = common.iter().filter(|arg| group(arg) == heading);
            let names: Vec<String> = of_heading
                .map(|arg| format!("`--{}`", arg.get_long().unwrap_or_default()))
                .collect();
            let _ = writeln!(page, "- {heading}: {}", names.join(", "));
        }
    }
}

/// What follows the options in the help: lines that are indented are commands, the others say what these do.
fn examples(page: &mut String, command: &Command) {
    let text = command.get_after_help().map(ToString::to_string);
    let mut inside = false;
    for line in text.unwrap_or_default().lines() {
        let is_code = line.starts_with("  ");
        match (inside, is_code) {
            (false, true) => page.push_str("\n```text\n"),
            (true, false) => page.push_str("```\n\n"),
            (false, false) => page.push('\n'),
            (true, true) => {}
        }
        inside = is_code;
        if is_code {
            let _ = writeln!(page, "{}", line.trim_start());
        } else {
            let _ = writeln!(page, "{}", escaped(line));
        }
    }
    if inside {
        page.push_str("```\n");
    }
}

/// The options and arguments of a command, but for those that every program has.
fn options(command: &Command) -> Vec<&Arg> {
    let is_own =
        |arg: &&Arg| !arg.is_hide_set() && !["help", "version"].contains(&arg.get_id().as_str());
    command.get_arguments().filter(is_own).collect()
}

/// The groups of these options, in the order in which they are first met.
fn headings(args: &[&Arg]) -> Vec<String> {
    let mut headings = Vec::new();
    for arg in args {
        let heading = group(arg);
        if !headings.contains(&heading) {
            headings.push(heading);
        }
    }
    headings
}

fn group(arg: &Arg) -> String {
    let other = if arg.is_positional() {
        "Arguments"
    } else {
        "Options"
    };
    arg.get_help_heading().unwrap_or(other).to_owned()
}

fn about(command: &Command) -> String {
    let about = command.get_about().map(ToString::to_string);
    escaped(&about.unwrap_or_default())
}

/// An option as it is written, with its value.
fn form(arg: &Arg) -> String {
    let values = arg.get_value_names().unwrap_or_default();
    let values: Vec<String> = values.iter().map(|value| format!("<{value}>")).collect();
    let values = values.join(" ");
    match arg.get_long() {
        None => values,
        Some(long) => {
            let short = arg
                .get_short()
                .map_or(String::new(), |short| format!("-{short}, "));
            let optional = arg
                .get_num_args()
                .is_some_and(|count| count.min_values() == 0);
            let value = match (arg.get_action().takes_values(), optional) {
                (false, _) => String::new(),
                (true, true) => format!(" [{values}]"),
                (true, false) => format!(" {values}"),
            };
            format!("{short}--{long}{value}")
        }
    }
}

/// The meaning of an option, with its default and its values where the help does not say them itself.
fn help(arg: &Arg) -> String {
    let mut text = escaped(&arg.get_help().map_or(String::new(), ToString::to_string));
    let list = |values: Vec<String>| values.join(", ");
    if arg.get_action().takes_values() {
        let defaults = arg.get_default_values().iter();
        let defaults: Vec<String> = defaults
            .map(|value| code(&value.to_string_lossy()))
            .collect();
        if !defaults.is_empty() && !arg.is_hide_default_value_set() {
            let _ = write!(text, " (default {})", list(defaults));
        }
        let values = arg.get_possible_values();
        let values: Vec<String> = values.iter().map(|value| code(value.get_name())).collect();
        if !values.is_empty() && !arg.is_hide_possible_values_set() {
            let _ = write!(text, " (one of {})", list(values));
        }
    }
    text
}
