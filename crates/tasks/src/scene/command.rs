//! What a scene file or a command line asks for.

use super::continuation::{BranchOptions, LocusOptions};
use super::file::SceneFile;
use super::fit::FitOptions;
use super::options::{
    EquilibriaOptions, IntegrateOptions, LawOptions, ModelOptions, OrbitOptions, SectionOptions,
    SlabOptions,
};
use super::sweep::SweepOptions;
use super::system::{System, damping};
use super::units::Units;
use super::words::{merged, plain};
use clap::{CommandFactory, Parser, Subcommand};
use std::collections::BTreeMap;
use std::sync::{Mutex, PoisonError};
use twinslip::error::{Error, Result};

/// A computation with its options.
#[derive(Debug, Clone, PartialEq, Subcommand)]
pub enum Command {
    /// The steady-state friction law of one interface: tau_ss(V), its extrema, the critical stiffness k_c(V)
    Law(Box<LawOptions>),
    /// A run in time: stress, states, slip rates, slips, stick-slip events
    Integrate(Box<IntegrateOptions>),
    /// All steady states at a driving velocity, with eigenvalues and stability
    Equilibria(Box<EquilibriaOptions>),
    /// A periodic orbit: period, extremes, Floquet multipliers and stability, each with its error budget
    Orbit(Box<OrbitOptions>),
    /// The return map of a run to a section of constant stress: periodic, a torus, or chaotic; Lyapunov exponents
    Section(Box<SectionOptions>),
    /// Equilibria or periodic orbits as V_H or K varies, with their bifurcations
    Branch(Box<BranchOptions>),
    /// A curve of bifurcations in the plane of V_H and K, with its special points
    Locus(Box<LocusOptions>),
    /// The regime at every point of a grid of V_H and K or any other parameters, or of every start: resumable, on many threads and machines
    Sweep(Box<SweepOptions>),
    /// Friction parameters from laboratory data: velocity steps fitted by least squares, with errors and 95 % intervals
    Fit(Box<FitOptions>),
}

#[derive(Debug, Parser)]
#[command(name = "twinslip")]
struct SceneLine {
    #[command(subcommand)]
    command: Command,
}

impl SlabOptions {
    /// Whether interfaces slide without radiation damping, which would bound their slip rates.
    pub fn is_undamped(&self) -> bool {
        let mut set = self.text.set.iter();
        self.text.system.is_none()
            && damping(self).is_ok_and(|damping| damping == 0.0)
            && !set.any(|set| set.trim_start().starts_with("damping"))
    }
}

impl Command {
    /// The units of its numbers; `None` where its options make no system.
    pub fn units(&self) -> Option<Units> {
        let system = System::of(self.slab()?, None, None);
        system.ok().map(|system| system.units)
    }

    /// What slides, but V_H and K; `None` where that is looked for.
    pub(super) fn slab(&self) -> Option<&SlabOptions> {
        Some(match self {
            Command::Law(options) => &options.model.slab,
            Command::Integrate(options) => &options.model.slab,
            Command::Equilibria(options) => &options.model.slab,
            Command::Orbit(options) => &options.model.slab,
            Command::Section(options) => &options.model.slab,
            Command::Branch(options) => &options.model.slab,
            Command::Locus(options) => &options.model.slab,
            Command::Sweep(options) => &options.slab,
            Command::Fit(_) => return None,
        })
    }

    /// As of [`SlabOptions::is_undamped`]; not so where the interfaces are looked for.
    pub fn is_undamped(&self) -> bool {
        self.slab().is_some_and(SlabOptions::is_undamped)
    }

    /// The command line that scene files are read against.
    pub fn program() -> clap::Command {
        SceneLine::command()
    }

    /// A scene's command line, parsed like one that was typed, with the options of its command that are given beside it.
    ///
    /// # Errors
    /// [`Error::Input`] with file and line.
    pub fn of_scene(scene: &SceneFile, given: &[String]) -> Result<Self> {
        let mut arguments = vec!["twinslip".to_owned()];
        arguments.extend(scene.arguments(&[]));
        let arguments = merged(&Command::program(), &arguments, given);
        let command = arguments.and_then(|arguments| Command::of_words(&arguments));
        command.map_err(|sentence| scene.locate(&Error::Input(sentence)))
    }

    /// A command line, the name of the program first; what is wrong with it as one sentence.
    ///
    /// Only the options of the command that it names are made, and those once: that takes longer than a short run.
    pub fn of_words(words: &[String]) -> Result<Self, String> {
        let words = &plain(words)?.applied(words)[..];
        let parsed = match words.get(1).map_or("", String::as_str) {
            "law" => options(words).map(Command::Law),
            "integrate" => options(words).map(Command::Integrate),
            "equilibria" => options(words).map(Command::Equilibria),
            "orbit" => options(words).map(Command::Orbit),
            "section" => options(words).map(Command::Section),
            "branch" => options(words).map(Command::Branch),
            "locus" => options(words).map(Command::Locus),
            "sweep" => options(words).map(Command::Sweep),
            "fit" => options(words).map(Command::Fit),
            _ => SceneLine::try_parse_from(words).map(|line| line.command),
        };
        parsed.map_err(|error| sentence(&error))
    }
}

/// The options of a model, from words of a command line without a command.
///
/// # Errors
/// What is wrong with them as one sentence.
pub(super) fn model_options(words: &[String]) -> Result<ModelOptions, String> {
    let line = |command: &str| {
        let begin = ["twinslip", command].map(str::to_owned);
        begin
            .into_iter()
            .chain(words.iter().cloned())
            .collect::<Vec<String>>()
    };
    // Every command reads those of its model alike.
    let words = line("orbit");
    let mut words = plain(&words)?.applied(&words);
    words[1] = "model".to_owned();
    let options = options(&words).map_err(|error| sentence(&error))?;
    Ok(*options)
}

/// The options of one command, from a command line whose second word is its name.
fn options<O: clap::Args>(words: &[String]) -> Result<Box<O>, clap::Error> {
    /// The parsers that nobody uses just now, by the names of their commands.
    static MADE: Mutex<BTreeMap<String, clap::Command>> = Mutex::new(BTreeMap::new());
    let made = || MADE.lock().unwrap_or_else(PoisonError::into_inner);
    let own = &words[1..];
    let at_hand = made().remove(&own[0]);
    let mut parser = at_hand.unwrap_or_else(|| O::augment_args(clap::Command::new("twinslip")));
    let matches = parser.try_get_matches_from_mut(own);
    made().insert(own[0].clone(), parser);
    O::from_arg_matches(&matches?).map(Box::new)
}

/// What is wrong with a command line. What stands before the first empty line is the sentence; advice on flags follows, which not everybody
/// has.
pub fn sentence(error: &clap::Error) -> String {
    let text = error.to_string();
    let lines = text.lines().take_while(|line| !line.is_empty());
    let sentence = lines.map(str::trim).collect::<Vec<_>>().join(" ");
    sentence.trim_start_matches("error: ").to_owned()
}
