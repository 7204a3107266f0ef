//! Sweeps from options: which grid of points, what is computed of each, and which part of it here.

mod grain;
mod options;
mod shard;
mod words;

pub use options::SweepOptions;
pub use shard::Shard;

use super::continuation::LocusOptions;
use super::locus::LocusPlan;
use super::system::System;
use super::units::Quantity;
use crate::error::{Error, Result, count, option_name};
use crate::model::Loading;
use crate::sweep::{Grid, SweepSettings, threads_checked};
use clap::Parser;
use grain::Grain;
use options::SweepLine;
use serde_json::Value;
use words::{canonical, numerics};

/// A sweep that is asked for, checked.
#[derive(Debug, Clone, PartialEq)]
pub struct SweepPlan {
    /// What slides.
    pub system: System,
    /// What is computed.
    pub settings: SweepSettings,
    /// Which part of it.
    pub shard: Option<Shard>,
    /// By how many threads.
    pub threads: Option<usize>,
    /// Bifurcations to draw over the map.
    pub curves: Vec<LocusPlan>,
    /// The settings for the output.
    pub numerics: Value,
    /// The command line of the whole sweep in one order, without what changes no row: equal sweeps have equal ones.
    pub canonical: Vec<String>,
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
        threads_checked(options.threads)?;
        let needed = |name: &str, text: &Option<String>| {
            let missing = || {
                Error::Input(format!(
                    "{} A:B:N is missing, and has no default",
                    option_name(name)
                ))
            };
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
        let system = System::of(
            &options.slab.resolved()?,
            fixed(&driving),
            fixed(&stiffness),
        )?
        .alike("sweep")?;
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
        let settings = SweepSettings {
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
        let curves = match options.plot {
            Some(_) => curves(options, &system, &settings.grid)?,
            None => Vec::new(),
        };
        Ok(SweepPlan {
            curves,
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
        let line = SweepLine::try_parse_from(words)
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
            Some(shard) => format!("part {shard}, {} rows", count(self.rows())),
        };
        let follow = match settings.follow {
            true => {
                "on: each point starts on the attractor of its neighbour; a line of V_H at one K is computed in one go"
            }
            false => "off: `follow` is not given; points are computed on their own",
        };
        let lyapunov = match settings.lyapunov {
            true => "of every point",
            false => "only where the regime needs them: `lyapunov` is not given",
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
            count(settings.points()),
            settings.rtol,
            count(settings.max_returns),
            count(settings.max_steps)
        )
    }
}

/// V_H and K of a basin, which are single values.
fn loading(system: &System, driving: &Grain, stiffness: &Grain) -> Result<Loading> {
    for grain in [driving, stiffness] {
        if !grain.single {
            return Err(Error::Input(format!(
                "with `basin` `{}` must be a single value, not {grain}",
                grain.name
            )));
        }
    }
    system.loading()
}

#[derive(Parser)]
struct LocusLine {
    #[command(flatten)]
    options: LocusOptions,
}

/// The bifurcations of these interfaces within a grid, if it is a plane that has an area.
fn curves(options: &SweepOptions, system: &System, grid: &Grid) -> Result<Vec<LocusPlan>> {
    let Grid::Plane { driving, stiffness } = grid else {
        return Ok(Vec::new());
    };
    if options.curves == "none" || driving.count == 1 || stiffness.count == 1 {
        return Ok(Vec::new());
    }
    let ends = |quantity, range: &crate::sweep::Range| {
        let [from, to] = [range.from, range.to].map(|x| system.units.outward(quantity, x));
        Some(format!("{from:?}:{to:?}"))
    };
    let mut asked = LocusLine::parse_from(["locus"]).options;
    asked.model.slab = options.slab.clone();
    asked.driving_range = ends(Quantity::SlipRate, driving);
    asked.stiffness_range = ends(Quantity::Stiffness, stiffness);
    let names = options.curves.split(',');
    names
        .map(|name| {
            LocusPlan::new(&LocusOptions {
                of: Some(name.trim().to_owned()),
                ..asked.clone()
            })
        })
        .collect()
}
