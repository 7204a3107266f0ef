//! What `-h` says of a computing command: an example and the options that most runs need. All of them are in `--help`.

use crate::examples::EXAMPLES;
use clap::{Arg, Command};
use std::fmt::Write;

/// The options that most runs need, by the command's name.
const MOST_USED: [(&str, &str); 9] = [
    ("law", "law set from to ensemble si plot output"),
    (
        "integrate",
        "driving stiffness system set until program plot output",
    ),
    (
        "equilibria",
        "driving stiffness system set box ensemble si output",
    ),
    (
        "orbit",
        "driving stiffness system set symmetry start points plot",
    ),
    (
        "section",
        "driving stiffness system set surface lyapunov plot output",
    ),
    ("branch", "stiffness system set along from to plot output"),
    (
        "locus",
        "stiffness-range driving-range system in range plot output",
    ),
    (
        "sweep",
        "driving stiffness grid system basin resume plot output",
    ),
    ("fit", "look law free set from to plot report output"),
];
/// Options whose first clause says too little.
const IN_SHORT: [(&str, &str); 9] = [
    (
        "box",
        "Search box for the equilibria of a system: x=-5:5,y=0:1",
    ),
    ("lyapunov", "Compute Lyapunov exponents"),
    ("output", "Write the numbers to FILE: .csv or .json"),
    ("plot", "Draw a picture, FILE.svg or FILE.png"),
    ("range", "Range of one of them"),
    ("resume", "Resume the interrupted run in FILE"),
    ("start", "A state at or near the orbit"),
    (
        "symmetry",
        "Interfaces in phase or not: symmetric or asymmetric",
    ),
    (
        "system",
        "A user-defined system from a file, or a built-in one: lorenz",
    ),
];
/// Examples that are shown.
const SHOWN: usize = 2;

/// The short help that these words ask for: `-h` after the name of a computing command.
pub fn asked_for(program: &Command, words: &[impl AsRef<str>]) -> Option<String> {
    let words = || words.iter().skip(1).map(AsRef::as_ref);
    let before_values = words().take_while(|word| *word != "--");
    if !before_values.clone().any(|word| word == "-h")
        || before_values.clone().any(|word| word == "--help")
    {
        return None;
    }
    let name = words().next()?;
    let [options, examples] = [MOST_USED, EXAMPLES].map(|all| {
        let own = all.into_iter().find(|(known, _)| *known == name);
        own.map(|(_, words)| words)
    });
    let (options, examples) = options.zip(examples)?;
    short_help(program.find_subcommand(name)?, examples, options)
}

fn short_help(command: &Command, examples: &str, options: &str) -> Option<String> {
    let name = command.get_name();
    let mut text = format!("{}\n\n", command.get_about()?);
    let runs = examples
        .lines()
        .filter(|line| line.starts_with("  twinslip "));
    for run in runs.take(SHOWN) {
        let _ = writeln!(text, "{run}");
    }
    let all: Vec<&Arg> = command.get_arguments().collect();
    let known = |option: &str| {
        all.iter()
            .copied()
            .find(|arg| arg.get_long() == Some(option))
    };
    let known: Vec<&Arg> = options.split(' ').map(known).collect::<Option<_>>()?;
    let forms: Vec<String> = known.iter().map(|arg| form(arg)).collect();
    let width = forms.iter().map(String::len).max()?;
    text.push('\n');
    for (form, arg) in forms.iter().zip(&known) {
        let _ = writeln!(text, "  {form:width$}  {}", gist(arg));
    }
    let count = all.iter().filter(|arg| arg.get_long().is_some()).count();
    let _ = writeln!(text, "\n`twinslip {name} --help` has all {count} options.");
    Some(text)
}

/// An option with its value.
fn form(arg: &Arg) -> String {
    let name = arg.get_long().unwrap_or_default();
    let values = arg
        .get_value_names()
        .filter(|_| arg.get_action().takes_values());
    let values = values
        .unwrap_or_default()
        .iter()
        .map(|value| format!(" <{value}>"));
    format!("--{name}{}", values.collect::<String>())
}

/// The help of an option in short: as far as its first clause goes.
fn gist(arg: &Arg) -> String {
    let in_short = IN_SHORT
        .iter()
        .find(|(name, _)| arg.get_long() == Some(name));
    if let Some((_, words)) = in_short {
        return (*words).to_owned();
    }
    let help = arg.get_help().map_or(String::new(), ToString::to_string);
    let ends = [" [", " (", ", ", "; ", ": ", ". "];
    let end = ends.iter().filter_map(|end| help.find(end)).min();
    help[..end.unwrap_or(help.len())].to_owned()
}
