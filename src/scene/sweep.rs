//! Sweeps from options: which grid of points, what is computed of each, and which part of it here.

use super::options::{OutputOptions, SlabOptions, number};
use super::system::System;
use super::units::{Quantity, Units};
use crate::error::{Error, Result};
use crate::friction::positive;
use crate::integrate::MAX_STEPS;
use crate::model::Loading;
use crate::sweep::{Grid, Range, Settings};
use clap::Parser;
use serde_json::{Value, json};
use std::path::PathBuf;

/// `sweep`: the regime at every point of a grid.
#[derive(Debug, Clone, PartialEq, clap::Args)]
pub struct SweepOptions {
    /// What slides.
    #[command(flatten)]
    pub slab: SlabOptions,
    /// N values of V_H from A to B, both included; with log equally spaced in ln V_H. One value may stand alone
    #[arg(
        long,
        value_name = "A:B:N[log]",
        allow_hyphen_values = true,
        help_heading = "Grid"
    )]
    pub driving: Option<String>,
    /// M values of K from A to B, both included; with log equally spaced in ln K. One value may stand alone
    #[arg(
        long,
        value_name = "A:B:M[log]",
        allow_hyphen_values = true,
        help_heading = "Grid"
    )]
    pub stiffness: Option<String>,
    /// Starts of runs instead of V_H and K: to which attractor each leads at the one V_H and K given
    #[arg(long, requires_all = ["state_1", "state_2"], conflicts_with_all = ["follow", "starts"], help_heading = "Grid")]
    pub basin: bool,
    /// With --basin: the values of psi1 to start from
    #[arg(
        long = "state-1",
        value_name = "A:B:N[log]",
        requires = "basin",
        allow_hyphen_values = true,
        help_heading = "Grid"
    )]
    pub state_1: Option<String>,
    /// With --basin: the values of psi2 to start from
    #[arg(
        long = "state-2",
        value_name = "A:B:M[log]",
        requires = "basin",
        allow_hyphen_values = true,
        help_heading = "Grid"
    )]
    pub state_2: Option<String>,
    /// Starts at each point, a row for each: the first beside the symmetric steady state, the second far from it, the others
    /// drawn by the seed
    #[arg(long, value_name = "S", default_value_t = 1, help_heading = "Grid")]
    pub starts: usize,
    /// Seed of the starts: the same seed, the same rows
    #[arg(long, value_name = "SEED", default_value_t = 1, help_heading = "Grid")]
    pub seed: u64,
    /// Start each point on the attractor of its neighbour at the V_H before: fewer transients, and hysteresis is seen
    #[arg(long, help_heading = "Grid")]
    pub follow: bool,
    /// The largest Lyapunov exponent of every point, not only of those whose regime needs it
    #[arg(long, help_heading = "Numerics")]
    pub lyapunov: bool,
    /// Relative local error tolerance
    #[arg(long, value_name = "X", default_value = "1e-8", value_parser = number, allow_negative_numbers = true, help_heading = "Numerics")]
    pub rtol: f64,
    /// A point is undecided after so many returns to its section
    #[arg(
        long,
        value_name = "N",
        default_value_t = 2000,
        help_heading = "Numerics"
    )]
    pub max_returns: usize,
    /// A point is undecided after so many steps
    #[arg(long, value_name = "N", default_value_t = MAX_STEPS, help_heading = "Numerics")]
    pub max_steps: usize,
    /// Threads [default: one a processor]; rows do not depend on them
    #[arg(long, value_name = "N", help_heading = "Running")]
    pub threads: Option<usize>,
    /// Compute only the I-th of N parts of the grid, I from 1; twinslip merge puts the files of all parts together
    #[arg(
        long,
        value_name = "I/N",
        allow_hyphen_values = true,
        help_heading = "Running"
    )]
    pub shard: Option<String>,
    /// Go on with FILE, the CSV of an interrupted run of the same sweep: rows that are complete in it are kept
    #[arg(long, value_name = "FILE", help_heading = "Output")]
    pub resume: Option<PathBuf>,
    /// Draw the map of regimes as FILE.svg or FILE.png
    #[arg(long, value_name = "FILE", help_heading = "Output")]
    pub plot: Option<PathBuf>,
    /// Where results go.
    #[command(flatten)]
    pub output: OutputOptions,
}

/// A part of a grid: of its units those whose numbers leave the remainder `index` - 1 after division by `of`.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Shard {
    /// Which part, from 1.
    pub index: usize,
    /// How many parts there are.
    pub of: usize,
}

impl Shard {
    /// The one part that is all.
    pub const WHOLE: Shard = Shard { index: 1, of: 1 };

    /// From `I/N`.
    ///
    /// # Errors
    /// [`Error::Input`] for anything else.
    pub fn parse(text: &str) -> Result<Self> {
        let numbers = text
            .split_once('/')
            .and_then(|(index, of)| Some((index.parse().ok()?, of.parse().ok()?)));
        match numbers {
            Some((index, of)) if (1..=of).contains(&index) => Ok(Shard { index, of }),
            _ => Err(Error::Input(format!(
                "shard is {text}, but must be I/N with I from 1 to N"
            ))),
        }
    }

    /// How many of so many units it has.
    pub fn units(self, all: usize) -> usize {
        (all + self.of - self.index) / self.of
    }

    /// The number of its unit at a place, both from 0.
    pub fn unit(self, place: usize) -> usize {
        self.index - 1 + place * self.of
    }
}

impl std::fmt::Display for Shard {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        write!(f, "{}/{}", self.index, self.of)
    }
}

/// A sweep that is asked for, checked.
#[derive(Debug, Clone, PartialEq)]
pub struct SweepPlan {
    /// What slides.
    pub system: System,
    /// What is computed.
    pub settings: Settings,
    /// Which part of it.
    pub shard: Option<Shard>,
    /// By how many threads.
    pub threads: Option<usize>,
    /// The settings for the output.
    pub numerics: Value,
    /// The command line of the whole sweep in one order, without what changes no row: equal sweeps have equal ones.
    pub canonical: Vec<String>,
}

#[derive(Parser)]
struct Line {
    #[command(flatten)]
    options: SweepOptions,
}

impl SweepPlan {
    /// Checks the options.
    ///
    /// # Errors
    /// [`Error::Parameter`] and [`Error::Input`], in the user's own names.
    pub fn new(options: &SweepOptions) -> Result<Self> {
        if options.slab.interfaces != 2 {
            return Err(Error::Input(
                "sweep needs two interfaces: a single one has no regimes but rest and one cycle"
                    .into(),
            ));
        }
        if options.threads == Some(0) {
            return Err(Error::parameter("threads", 0, "at least 1"));
        }
        let needed = |name: &str, text: &Option<String>| {
            let missing = || Error::Input(format!("--{name} A:B:N is missing, and has no default"));
            Grain::parse(name, text.as_deref().ok_or_else(missing)?)
        };
        let driving = needed("driving", &options.driving)?;
        let stiffness = needed("stiffness", &options.stiffness)?;
        let states = match options.basin {
            true => Some((
                needed("state-1", &options.state_1)?,
                needed("state-2", &options.state_2)?,
            )),
            false => None,
        };
        let fixed = |grain: &Grain| options.basin.then_some(grain.range.from);
        let system = System::of(&options.slab, fixed(&driving), fixed(&stiffness))?;
        let units = &system.units;
        let grid = match &states {
            None => Grid::Plane {
                driving: driving.inward(Quantity::SlipRate, units)?,
                stiffness: stiffness.inward(Quantity::Stiffness, units)?,
            },
            Some((state_1, state_2)) => Grid::Basin {
                loading: loading(&system, &driving, &stiffness)?,
                state_1: state_1.inward(Quantity::State, units)?,
                state_2: state_2.inward(Quantity::State, units)?,
            },
        };
        let settings = Settings {
            law: system.law,
            grid,
            starts: options.starts,
            seed: options.seed,
            follow: options.follow,
            rtol: options.rtol,
            lyapunov: options.lyapunov,
            max_returns: options.max_returns,
            max_steps: options.max_steps,
        };
        settings.checked()?;
        let shard = options.shard.as_deref().map(Shard::parse).transpose()?;
        let grains = [Some(&driving), Some(&stiffness)]
            .into_iter()
            .chain([states.as_ref().map(|s| &s.0), states.as_ref().map(|s| &s.1)])
            .flatten();
        let grid: Vec<(&str, String)> = grains
            .map(|grain| (grain.name.as_str(), grain.to_string()))
            .collect();
        Ok(SweepPlan {
            numerics: numerics(options, &grid),
            canonical: canonical(options, &grid),
            system,
            settings,
            shard,
            threads: options.threads,
        })
    }

    /// From the command line that another sweep tells in its file.
    ///
    /// # Errors
    /// [`Error::Input`] if it is none of a sweep.
    pub fn of_command(command: &str) -> Result<Self> {
        let words = command.strip_prefix("twinslip sweep").unwrap_or_default();
        let words = std::iter::once("sweep").chain(words.split_whitespace());
        let line = Line::try_parse_from(words)
            .map_err(|_| Error::Input(format!("{command:?} is not the command of a sweep")))?;
        SweepPlan::new(&line.options)
    }

    /// The part that is computed here.
    pub fn part(&self) -> Shard {
        self.shard.unwrap_or(Shard::WHOLE)
    }

    /// Rows of each unit: what is computed in one go gives so many.
    pub fn rows_per_unit(&self) -> usize {
        self.settings.points_per_unit()
    }

    /// The number of rows of the part that is computed here.
    pub fn rows(&self) -> usize {
        self.part().units(self.settings.units()) * self.rows_per_unit()
    }

    /// V_H and K of a row of the whole sweep, dimensionless.
    pub fn loading(&self, number: usize) -> (f64, f64) {
        match &self.settings.grid {
            Grid::Basin { loading, .. } => (loading.driving, loading.stiffness),
            Grid::Plane { driving, stiffness } => {
                let point = number / self.settings.starts;
                let (i, j) = (point % driving.count, point / driving.count);
                (driving.value(i), stiffness.value(j))
            }
        }
    }

    /// The plan, one subject a line.
    pub fn explain(&self) -> String {
        let settings = &self.settings;
        let grid = match (&settings.grid, settings.starts) {
            (Grid::Basin { .. }, _) => "starts (psi1, psi2) at one V_H and K".to_owned(),
            (_, 1) => "the plane of V_H and K, one start each".to_owned(),
            (_, starts) => format!("the plane of V_H and K, {starts} starts each"),
        };
        let part = match self.shard {
            None => "all".to_owned(),
            Some(shard) => format!("part {shard}, {} rows", self.rows()),
        };
        let follow = match settings.follow {
            true => {
                "on: each point starts on the attractor of its neighbour; a line of V_H at one K is computed in one go"
            }
            false => "off: --follow is not given; points are computed on their own",
        };
        let lyapunov = match settings.lyapunov {
            true => "of every point",
            false => "only where the regime needs them: --lyapunov is not given",
        };
        format!(
            "plan of this command
  grid              {grid}: {} rows
  part              {part}
  dimension         3
  method            taylor, several points side by side in the lanes of a core
  rtol              {:e}
  following         {follow}
  exponents         {lyapunov}
  bound on work     {} returns, {} steps a point
  rows              written in the order of the grid as soon as all before them are done",
            settings.points(),
            settings.rtol,
            settings.max_returns,
            settings.max_steps
        )
    }
}

/// The values of an option, in the user's units.
#[derive(Debug, Clone, PartialEq)]
struct Grain {
    name: String,
    range: Range,
    /// One value stood alone.
    single: bool,
}

impl Grain {
    fn parse(name: &str, text: &str) -> Result<Self> {
        let alone = text.trim().parse::<f64>().ok();
        let range = match alone {
            Some(x) => Range {
                from: positive(name, x)?,
                to: x,
                count: 1,
                log: false,
            },
            None => Range::parse(name, text)?,
        };
        Ok(Grain {
            name: name.to_owned(),
            range,
            single: alone.is_some(),
        })
    }

    fn inward(&self, quantity: Quantity, units: &Units) -> Result<Range> {
        let end = |x| {
            positive(
                &*self.name,
                units.inward(quantity, positive(&*self.name, x)?),
            )
        };
        Ok(Range {
            from: end(self.range.from)?,
            to: end(self.range.to)?,
            ..self.range
        })
    }
}

impl std::fmt::Display for Grain {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        let Range {
            from,
            to,
            count,
            log,
        } = self.range;
        match self.single {
            true => write!(f, "{from:?}"),
            false => write!(f, "{from:?}:{to:?}:{count}{}", if log { "log" } else { "" }),
        }
    }
}

/// V_H and K of a basin, which are single values.
fn loading(system: &System, driving: &Grain, stiffness: &Grain) -> Result<Loading> {
    for grain in [driving, stiffness] {
        if !grain.single {
            return Err(Error::Input(format!(
                "with --basin --{} must be a single value, not {grain}",
                grain.name
            )));
        }
    }
    system.loading()
}

fn numerics(options: &SweepOptions, grid: &[(&str, String)]) -> Value {
    let mut pairs: serde_json::Map<String, Value> = grid
        .iter()
        .map(|(name, text)| (name.replace('-', "_"), json!(text)))
        .collect();
    let others = [
        ("basin", json!(options.basin)),
        ("starts", json!(options.starts)),
        ("seed", json!(options.seed)),
        ("follow", json!(options.follow)),
        ("lyapunov", json!(options.lyapunov)),
        ("rtol", json!(options.rtol)),
        ("max_returns", json!(options.max_returns)),
        ("max_steps", json!(options.max_steps)),
    ];
    pairs.extend(others.map(|(name, value)| (name.to_owned(), value)));
    Value::Object(pairs)
}

/// The words in a fixed order, each setting with its value unless that is the default.
fn canonical(options: &SweepOptions, grid: &[(&str, String)]) -> Vec<String> {
    let default = Line::parse_from(["sweep"]).options;
    let mut words = vec!["twinslip".to_owned(), "sweep".to_owned()];
    for (name, text) in grid {
        words.extend([format!("--{name}"), text.clone()]);
    }
    let texts = |options: &SweepOptions| {
        let slab = &options.slab;
        let maybe = |x: Option<f64>| x.map(|x| format!("{x:?}"));
        let plain = |x: f64| Some(format!("{x:?}"));
        let count = |n: usize| Some(n.to_string());
        [
            ("law", Some(slab.law.clone())),
            ("healing-time", maybe(slab.healing_time)),
            ("residual-strength", plain(slab.residual_strength)),
            ("direct-effect", plain(slab.direct_effect)),
            ("evolution-effect", plain(slab.evolution_effect)),
            ("reference-friction", plain(slab.reference_friction)),
            ("slip-length", maybe(slab.slip_length)),
            ("reference-rate", maybe(slab.reference_rate)),
            ("normal-stress", maybe(slab.normal_stress)),
            ("starts", count(options.starts)),
            ("seed", Some(options.seed.to_string())),
            ("rtol", plain(options.rtol)),
            ("max-returns", count(options.max_returns)),
            ("max-steps", count(options.max_steps)),
        ]
    };
    for ((name, text), (_, usual)) in texts(options).into_iter().zip(texts(&default)) {
        if let Some(text) = text.filter(|text| Some(text) != usual.as_ref()) {
            words.extend([format!("--{name}"), text]);
        }
    }
    let switches = [
        ("si", options.slab.si),
        ("basin", options.basin),
        ("follow", options.follow),
        ("lyapunov", options.lyapunov),
    ];
    let on = switches.into_iter().filter(|(_, on)| *on);
    words.extend(on.map(|(name, _)| format!("--{name}")));
    words
}
