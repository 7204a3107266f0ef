//! The command line: arguments, messages and exit codes. Data goes to standard output or a file, all talk to standard error.

mod branch;
mod call;
mod catalogue;
mod checkpoint;
mod continuation;
pub(crate) mod ensemble;
mod equilibria;
mod examples;
#[cfg(feature = "explore")]
pub mod explore;
mod failure;
mod fault;
mod fit;
mod general;
mod holds;
mod integrate;
mod interrupt;
mod law;
mod locus;
mod many;
mod many_equilibria;
mod merge;
mod orbit;
mod progress;
#[cfg_attr(not(feature = "mpi"), path = "no_ranks.rs")]
mod ranks;
mod reference;
mod report;
mod reproduce;
mod resume;
mod rows;
mod run;
mod section;
mod shell;
mod short_help;
mod slab;
mod special;
mod stream;
pub(crate) mod sweep;
mod text;
pub(crate) mod words;

pub use call::Outlet;
pub use catalogue::{OptionInfo, OptionKind, commands, options};
pub use failure::Failure;
pub use report::sundials;

/// What the tests of this repository reach for. Nothing here is kept as it is.
#[doc(hidden)]
pub mod internals {
    pub use crate::ensemble::bands::{Band, Banded, Check, DEVIATIONS, Ends, Sample, Sides, bands};
    pub use crate::ensemble::draws::normal;
    pub use crate::ensemble::item::{Item, Measured, matched};
    #[cfg(feature = "explore")]
    pub use crate::explore::{bundle::bundle as explore_bundle, request::words as explore_words};
    pub use crate::program;
    #[cfg(feature = "parquet")]
    pub use crate::sweep::parquet_file::{GROUP, from_csv};
    #[cfg(feature = "mpi")]
    pub use crate::sweep::wire::{pack, unpack};
    pub use crate::words::{count, flagged, several, time};
}

#[doc = include_str!("../../../docs/guide.md")]
pub mod guide {}

use call::Call;
use clap::{CommandFactory, FromArgMatches, Parser, Subcommand};
use std::ffi::OsString;
use std::io::Write;
use std::path::Path;
use std::process::ExitCode;
use std::sync::{Arc, OnceLock};
use twinslip::error::Error;
use twinslip::integrate::{
    COMPILE, VECTORS, allowed_compiling, allowed_vectors, used_compiling, used_vectors,
};
use twinslip_tasks::scene;

/// Sliding modes of interacting frictional interfaces: friction laws, runs in time, equilibria, periodic orbits, return
/// maps, branches and their bifurcations, maps of regimes.
///
/// Everything is dimensionless (stress in a sigma, slip rate in V*, length in L, time in L/V*) unless --si or a value with a unit is given.
/// Where standard error is no terminal, long runs report progress every ten seconds, or every TWINSLIP_PROGRESS seconds.
/// Data goes to standard output or a file, messages to standard error.
/// Exit status: 0 done; 1 the computation failed, rows so far are kept; 2 wrong usage or input; 3 a verdict is undecided.
#[derive(Debug, Parser)]
#[command(name = "twinslip", version, max_term_width = 110)]
struct CommandLine {
    #[command(subcommand)]
    command: CliCommand,
}

#[derive(Debug, Subcommand)]
enum CliCommand {
    #[command(flatten)]
    Compute(scene::Command),
    /// Run a scene: a built-in one, such as fig12, or a file
    #[command(after_help = run::EXAMPLE)]
    Run(run::RunOptions),
    /// Explore a system in the browser: click a diagram of two parameters and see runs, portraits, return maps and branches
    #[cfg(feature = "explore")]
    #[command(after_help = explore::EXAMPLE)]
    Explore(Box<explore::ExploreOptions>),
    /// Join the files of all parts of a sweep into the file that a single run would write
    #[command(after_help = merge::EXAMPLE)]
    Merge(merge::MergeOptions),
    /// Reproduce the paper: every figure, Table 1, a scorecard of its numbers, and a report
    #[command(after_help = reproduce::EXAMPLE)]
    Reproduce(reproduce::ReproduceOptions),
    /// Reproduce one figure of the paper, as CSV and SVG
    #[command(after_help = reproduce::FIGURE_EXAMPLE)]
    Figure(reproduce::FigureOptions),
    /// Write a script for shell completion of commands, options and names
    #[command(after_help = shell::COMPLETIONS_EXAMPLE)]
    Completions(shell::CompletionsOptions),
    /// Write manual pages, one for each command
    #[command(after_help = shell::MAN_EXAMPLE)]
    Man(shell::ManOptions),
    /// The pages of the documentation on commands, columns and files, as Markdown
    #[command(hide = true, after_help = reference::EXAMPLE)]
    Reference(reference::ReferenceOptions),
}

/// The whole command line, with all that `--version` tells.
#[doc(hidden)]
pub fn program() -> clap::Command {
    static VERSION: OnceLock<String> = OnceLock::new();
    let text = VERSION.get_or_init(|| {
        let sundials = report::sundials().unwrap_or_else(|| "not built in".into());
        let vectors = used_vectors().name();
        let features = [
            ("mpi", cfg!(feature = "mpi")),
            ("parquet", cfg!(feature = "parquet")),
        ];
        let mut text = format!(
            "{}\nSUNDIALS {sundials}\nvector instructions {vectors} ({VECTORS} holds it to fewer)\nformulas are {} ({COMPILE}=off, on or always)",
            env!("CARGO_PKG_VERSION"),
            used_compiling().in_words()
        );
        for (name, _) in features.iter().filter(|(_, on)| *on) {
            text += &format!("\nwith {name}");
        }
        text
    });
    let program = CommandLine::command().long_version(text.as_str());
    examples::EXAMPLES
        .into_iter()
        .fold(program, |program, (name, example)| {
            program.mut_subcommand(name, |command| command.after_help(example))
        })
}

/// How a command ended, if it ended well.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Ending {
    /// All is done, or the reader of our output has gone: there is nobody to tell.
    Done,
    /// All is done, but a verdict could not be reached.
    Undecided,
    /// A branch went no further than its method could; what was computed is kept, and the reason was told.
    Stuck,
    /// Ctrl-C; what was computed is kept.
    Interrupted,
}

/// A negative number with a negative exponent, without that: `-1e-5` is taken for an option.
fn plain_number(word: OsString) -> OsString {
    let number = word.to_str().filter(|word| word.starts_with('-'));
    match number.and_then(|word| word.parse::<f64>().ok()) {
        Some(number) if number.is_finite() => number.to_string().into(),
        _ => word,
    }
}

/// Messages on wrong usage that are longer lose what is in the midst of them.
const LONGEST: usize = 1200;
/// Exit status of a failed computation.
const FAILED: u8 = 1;
/// Exit status of wrong usage or input.
const WRONG_INPUT: u8 = 2;
/// Exit status where a verdict is undecided.
const UNDECIDED: u8 = 3;
/// Exit status after Ctrl-C, as shells have it.
const INTERRUPTED: u8 = 130;

/// Parses the arguments, runs, and says how it ended.
pub fn main(arguments: impl IntoIterator<Item = OsString>) -> ExitCode {
    let arguments: Vec<OsString> = arguments.into_iter().map(plain_number).collect();
    interrupt::listen();
    // A file that grows larger than is allowed is then an error of writing, and not the end of the process.
    #[cfg(unix)]
    let _ = signal_hook::flag::register(signal_hook::consts::SIGXFSZ, Default::default());
    let words: Vec<_> = arguments
        .iter()
        .map(|word| word.to_string_lossy())
        .collect();
    let program = program();
    if let Some(help) = short_help::asked_for(&program, &words) {
        // A closed standard output is nobody's.
        let _ = write!(std::io::stdout(), "{help}");
        return ExitCode::SUCCESS;
    }
    let plain = match scene::plain(&words) {
        Ok(plain) => {
            let quiet = words.iter().any(|word| word == "-q" || word == "--quiet");
            if let Some(warning) = plain.warning().filter(|_| !quiet) {
                say(format_args!("warning: {warning}"));
            }
            plain.applied(&arguments)
        }
        Err(sentence) => {
            say(format_args!("error: {}", shortened(sentence)));
            return ExitCode::from(WRONG_INPUT);
        }
    };
    let parsed = program
        .try_get_matches_from(plain)
        .and_then(|matches| CommandLine::from_arg_matches(&matches));
    let line = match parsed {
        Ok(line) => line,
        Err(error) => {
            // Help and version are no errors; a closed standard output is nobody's.
            if error.use_stderr() && error.to_string().len() > LONGEST {
                say(shortened(error.to_string()));
            } else {
                let _ = error.print();
            }
            return ExitCode::from(u8::try_from(error.exit_code()).unwrap_or(WRONG_INPUT));
        }
    };
    let words = arguments.iter().skip(1);
    let words = words.map(|word| word.to_string_lossy().into_owned());
    let call = Call {
        words: std::iter::once("twinslip".into()).chain(words).collect(),
        outlet: None,
    };
    let ended = run_line(&line.command, &call);
    match ended {
        Ok(Ending::Done) => ExitCode::SUCCESS,
        Ok(Ending::Stuck) => ExitCode::from(FAILED),
        Ok(Ending::Undecided) => ExitCode::from(UNDECIDED),
        Ok(Ending::Interrupted) => {
            say(interrupt::words());
            ExitCode::from(INTERRUPTED)
        }
        Err(error) => {
            say(format_args!("error: {}", shortened(error.to_string())));
            ExitCode::from(if error.is_input() {
                WRONG_INPUT
            } else {
                FAILED
            })
        }
    }
}

fn run_line(command: &CliCommand, call: &Call) -> Result<Ending, Error> {
    allowed_vectors()?;
    allowed_compiling()?;
    match command {
        CliCommand::Compute(command) => compute(command, call),
        CliCommand::Run(options) => run::run(options, call),
        #[cfg(feature = "explore")]
        CliCommand::Explore(options) => explore::run(options, call),
        CliCommand::Merge(options) => merge::run(options),
        CliCommand::Reproduce(options) => reproduce::run(options, call),
        CliCommand::Figure(options) => reproduce::run_figure(options, call),
        CliCommand::Completions(options) => shell::completions(options),
        CliCommand::Man(options) => shell::man(options),
        CliCommand::Reference(options) => reference::run(options),
    }
}

/// A command that computes, from the words that follow the name of the program.
///
/// # Errors
/// [`Error::Input`] for words that are no such command.
pub fn parsed(words: &[String]) -> Result<scene::Command, Error> {
    let words: Vec<String> = std::iter::once("twinslip".to_owned())
        .chain(words.iter().cloned())
        .collect();
    scene::Command::of_words(&words).map_err(Error::Input)
}

/// The words of a scene, one that is built in or a file, without what says where results go.
///
/// # Errors
/// [`Error::Input`] with file and line.
pub fn scene_words(scene: &Path) -> Result<Vec<String>, Error> {
    const PLACES: [&str; 8] = [
        "output",
        "format",
        "plot",
        "plot-events",
        "quiet",
        "force",
        "explain",
        "resume",
    ];
    Ok(run::read(scene)?.arguments(&PLACES))
}

/// Runs a command of another program: the words that follow the name of this one, without any output of its own. All that `outlet` does not
/// take is given back: how it ended, or why it did not.
///
/// # Errors
/// [`Error::Input`] for words that are no command, and those of the command.
pub fn run_into(words: &[String], outlet: Arc<dyn Outlet>) -> Result<Ending, Error> {
    let words: Vec<String> = std::iter::once("twinslip".to_owned())
        .chain(words.iter().cloned())
        .collect();
    let call = Call {
        words,
        outlet: Some(outlet),
    };
    // The paper is no scene.
    if ["reproduce", "figure"].contains(&call.words.get(1).map_or("", String::as_str)) {
        let line = CommandLine::try_parse_from(&call.words);
        let line = line.map_err(|error| Error::Input(scene::sentence(&error)))?;
        return run_line(&line.command, &call);
    }
    let command = parsed(&call.words[1..])?;
    allowed_vectors()?;
    allowed_compiling()?;
    compute(&command, &call)
}

/// A message on standard error, with flags for the options that it names. That nobody reads it, or that it can't be written, is
/// no error.
fn say(text: impl std::fmt::Display) {
    let text = words::flagged(&text.to_string());
    let _ = writeln!(std::io::stderr().lock(), "{text}");
}

/// A message may hold what was given, which may be long: its begin and its end say enough.
fn shortened(text: String) -> String {
    /// Letters that are shown of each.
    const SHOWN: usize = 400;
    let length = text.chars().count();
    if length <= 3 * SHOWN {
        return text;
    }
    let begin: String = text.chars().take(SHOWN).collect();
    let end: String = text.chars().skip(length - SHOWN).collect();
    format!("{begin} [{} letters left out] {end}", length - 2 * SHOWN)
}

/// What a scene file or the command line asks for.
fn compute(command: &scene::Command, call: &Call) -> Result<Ending, Error> {
    if let Some(plan) = scene::EnsemblePlan::new(command)? {
        return ensemble::run(&plan, command, call);
    }
    if let Some(warning) = command.warning() {
        call.say(format_args!("warning: {warning}"));
    }
    let ended = match command {
        scene::Command::Law(options) => law::run(options, call),
        scene::Command::Integrate(options) => integrate::run(options, call),
        scene::Command::Equilibria(options) => equilibria::run(options, call),
        scene::Command::Orbit(options) => orbit::run(options, call),
        scene::Command::Section(options) => section::run(options, call),
        scene::Command::Branch(options) => branch::run(options, call),
        scene::Command::Locus(options) => locus::run(options, call),
        scene::Command::Sweep(options) => sweep::run(options, call),
        scene::Command::Fit(options) => fit::run(options, call),
    };
    ended.map_err(|error| {
        let undamped = error.runs_away() && command.is_undamped();
        let error = command
            .units()
            .map_or(error.clone(), |units| units.told(error));
        match undamped {
            true => error.advising("radiation damping (`damping`) bounds the slip rates"),
            false => error,
        }
    })
}

/// A failed write: to a file it is an error, to a pipe that nobody reads the end.
fn written(result: std::io::Result<()>, place: &twinslip_output::Place) -> Result<Ending, Error> {
    match result {
        Ok(()) => Ok(Ending::Done),
        Err(error) if error.kind() == std::io::ErrorKind::BrokenPipe => Ok(Ending::Done),
        Err(error) => Err(Error::File {
            action: "write",
            path: place
                .path()
                .unwrap_or("standard output".as_ref())
                .to_owned(),
            reason: error.to_string(),
        }),
    }
}
