//! What a scene file or a command line asks for.

use super::continuation::{BranchOptions, LocusOptions};
use super::file::SceneFile;
use super::options::{
    EquilibriaOptions, IntegrateOptions, LawOptions, OrbitOptions, SectionOptions,
};
use super::sweep::SweepOptions;
use super::system::System;
use super::units::Units;
use crate::error::{Error, Result};
use clap::{CommandFactory, Parser, Subcommand};

/// A computation with its options.
#[derive(Debug, Clone, PartialEq, Subcommand)]
pub enum Command {
    /// The steady-state friction law of one interface: tau_ss(V), its extrema, the critical stiffness k_c(V)
    #[command(after_help = LAW)]
    Law(Box<LawOptions>),
    /// A run in time: stress, states, slip rates, slips, stick-slip events
    #[command(after_help = INTEGRATE)]
    Integrate(Box<IntegrateOptions>),
    /// All steady states at a driving velocity, with eigenvalues and stability
    #[command(after_help = EQUILIBRIA)]
    Equilibria(Box<EquilibriaOptions>),
    /// A periodic orbit: period, extremes, Floquet multipliers and stability, each with its error budget
    #[command(after_help = ORBIT)]
    Orbit(Box<OrbitOptions>),
    /// The return map of a run to a section of constant stress: periodic, a torus, or chaotic; Lyapunov exponents
    #[command(after_help = SECTION)]
    Section(Box<SectionOptions>),
    /// Equilibria or periodic orbits as V_H or K varies, with their bifurcations
    #[command(after_help = BRANCH)]
    Branch(Box<BranchOptions>),
    /// A curve of bifurcations in the plane of V_H and K, with its special points
    #[command(after_help = LOCUS)]
    Locus(Box<LocusOptions>),
    /// The regime at every point of a grid of V_H and K, or of every start: resumable, on many threads and machines
    #[command(after_help = SWEEP)]
    Sweep(Box<SweepOptions>),
}

#[derive(Debug, Parser)]
#[command(name = "twinslip")]
struct SceneLine {
    #[command(subcommand)]
    command: Command,
}

impl Command {
    /// The units of its numbers; `None` where its options make no system.
    pub fn units(&self) -> Option<Units> {
        let slab = match self {
            Command::Law(options) => &options.model.slab,
            Command::Integrate(options) => &options.model.slab,
            Command::Equilibria(options) => &options.model.slab,
            Command::Orbit(options) => &options.model.slab,
            Command::Section(options) => &options.model.slab,
            Command::Branch(options) => &options.model.slab,
            Command::Locus(options) => &options.model.slab,
            Command::Sweep(options) => &options.slab,
        };
        System::of(slab, None, None).ok().map(|system| system.units)
    }

    /// The command line that scene files are read against.
    pub fn program() -> clap::Command {
        SceneLine::command()
    }

    /// A scene's command line, parsed like one that was typed; flags in `replaced` are left out, and those in `added` are put in.
    ///
    /// # Errors
    /// [`Error::Input`] with file and line.
    pub fn of_scene(scene: &SceneFile, replaced: &[&str], added: &[String]) -> Result<Self> {
        let mut arguments = vec!["twinslip".to_owned()];
        arguments.extend(scene.arguments(replaced));
        arguments.extend(added.iter().cloned());
        let line = SceneLine::try_parse_from(arguments).map_err(|error| {
            // The first line is the sentence; what follows is advice on flags, which a scene does not have.
            let text = error.to_string();
            let sentence = text.lines().next().unwrap_or_default();
            let sentence = sentence.trim_start_matches("error: ").to_owned();
            scene.locate(&Error::Input(sentence))
        })?;
        Ok(line.command)
    }
}

const LAW: &str = "Example, the paper's law and its extrema:
  twinslip law --format json
  twinslip law --from 1e-3 --to 1e5 --points 400 -o law.csv --plot law.svg";

const INTEGRATE: &str =
    "Example, two interfaces that part from their symmetric steady state and end in stick-slip:
  twinslip integrate --driving 10 --stiffness 0.14 --until 20 -o run.csv --plot run.svg";

const EQUILIBRIA: &str = "Example, the three steady states between the pitchforks of the paper's Fig. 5, and which is stable:
  twinslip equilibria --driving 1000 --stiffness 0.45

CSV and JSON say how far each number may be off: stress_uncertainty (in JSON stress.uncertainty), state_uncertainty,
log_state_uncertainty, slip_rate_uncertainty, and eigenvalue_uncertainty, a distance in the complex plane.";

const ORBIT: &str = "Example, the three orbits that coexist at K = 0.05 and V_H = 0.2, the last one unstable:
  twinslip orbit --driving 0.2 --stiffness 0.05
  twinslip orbit --driving 0.2 --stiffness 0.05 --symmetry asymmetric
  twinslip orbit --driving 0.2 --stiffness 0.05 --symmetry asymmetric --start 11.377,1.53e-6,1.83e-4 --period-guess 480";

const SECTION: &str =
    "Example, the torus of the paper's Fig. 13, with its rotation number and exponents:
  twinslip section --driving 0.102 --stiffness 0.2 --lyapunov -o torus.csv --plot torus.svg";

const BRANCH: &str =
    "Example, all equilibria and their Hopf points at K = 0.14, and the orbits that begin there:
  twinslip branch equilibria --stiffness 0.14 -o equilibria.csv --plot equilibria.svg
  twinslip branch orbits --stiffness 0.14 --from 0.05 --to 300 -o orbits.csv --plot orbits.svg";

const LOCUS: &str =
    "Example, the torus bifurcations of the paper's Figs 12 and 14, with their resonances:
  twinslip locus torus --stiffness-range 0.02,0.3 -o torus.csv --plot torus.svg";

const SWEEP: &str = "Example, the regimes on 40 x 40 points and their map; then on with it after it was interrupted:
  twinslip sweep --driving 0.04:0.2:40 --stiffness 0.02:0.25:40 -o map.csv --plot map.svg
  twinslip sweep --driving 0.04:0.2:40 --stiffness 0.02:0.25:40 --resume map.csv --plot map.svg
Which starts go to which attractor, where a symmetric and an asymmetric orbit coexist:
  twinslip sweep --basin --driving 0.08 --stiffness 0.1 --state-1 1e-6:1:40log --state-2 1e-6:1:40log -o basin.csv";
