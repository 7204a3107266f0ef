//! A command with the parameters of a fit in it: at the estimate, and beside it.

use super::super::branch::BranchKind;
use super::super::command::Command;
use super::super::following::numbers;
use super::super::general::plane;
use super::prepare::place;
use super::{EnsembleFile, EnsembleOptions, FrictionFit};
use twinslip::error::{Error, Result};

/// Draws where their number is not given; those of a sweep cost a map each.
const DRAWS: usize = 200;
const DRAWS_OF_SWEEP: usize = 50;

/// A command that is asked for with the uncertainty of a fit, checked.
#[derive(Debug, Clone, PartialEq)]
pub struct EnsemblePlan {
    /// Where the fit is from.
    pub file: EnsembleFile,
    /// What it has found.
    pub fit: FrictionFit,
    /// How often its parameters are drawn.
    pub draws: usize,
    /// The command at the estimate.
    estimate: Command,
}

impl EnsemblePlan {
    /// Checks the options; `None` where no ensemble is asked for.
    ///
    /// # Errors
    /// [`Error::File`] and [`Error::Input`] of the fit; [`Error::Input`] for a parameter that is both fitted and given.
    pub fn new(command: &Command) -> Result<Option<Self>> {
        let Some(EnsembleOptions {
            ensemble: Some(text),
        }) = command.ensemble()
        else {
            return Ok(None);
        };
        let file = EnsembleFile::parse(text)?;
        if command
            .slab()
            .is_some_and(|slab| slab.text.system.is_some())
        {
            return Err(Error::Input(
                "`ensemble` has friction parameters, and `system` names a user-defined system"
                    .into(),
            ));
        }
        let fit = FrictionFit::read(&file.path)?;
        let sweeps = matches!(command, Command::Sweep(_));
        let usual = if sweeps { DRAWS_OF_SWEEP } else { DRAWS };
        let draws = file.draws.unwrap_or(usual);
        if sweeps && draws == 0 {
            return Err(Error::Input(format!(
                "`ensemble` {0}:0: a sweep has probabilities, which need draws; say how many, such as {0}:{DRAWS_OF_SWEEP}",
                file.told()
            )));
        }
        let mut estimate = command.clone();
        estimate.refuses(&fit, &file)?;
        estimate.prepare(&fit)?;
        Ok(Some(EnsemblePlan {
            file,
            draws,
            estimate,
            fit,
        }))
    }

    /// The command at the estimate, with its picture.
    pub fn estimate(&self) -> Command {
        self.estimate.clone()
    }

    /// The command at other values of the fitted parameters, for its numbers alone.
    pub fn member(&self, values: &[f64]) -> Command {
        let mut command = self.estimate.clone();
        for (one, &value) in self.fit.parameters.iter().zip(values) {
            let slab = command.slab_mut();
            if let Some(place) = slab.and_then(|slab| place(slab, one.name)) {
                *place = Some(value);
            }
        }
        match &mut command {
            Command::Law(options) => options.plot = None,
            Command::Equilibria(options) => options.plot = None,
            Command::Branch(options) => {
                options.plot = None;
                options.continuation.crosscheck = None;
            }
            Command::Locus(options) => {
                options.plot = None;
                options.continuation.crosscheck = None;
            }
            Command::Sweep(options) => options.plot = None,
            _ => {}
        }
        command
    }

    /// The parameter along which curves are compared, and what is then compared of a curve in a plane.
    pub fn abscissa(&self) -> Option<(&str, Option<&str>)> {
        match &self.estimate {
            Command::Branch(options) => Some((options.along.as_deref().unwrap_or("driving"), None)),
            Command::Locus(options) => {
                let [one, other] =
                    plane(options.plane.as_deref().unwrap_or("driving,stiffness")).ok()?;
                Some(match other {
                    "driving" => (other, Some(one)),
                    _ => (one, Some(other)),
                })
            }
            _ => None,
        }
    }

    /// Whether branches are of periodic orbits.
    pub fn of_orbits(&self) -> bool {
        matches!(&self.estimate, Command::Branch(options) if options.of.as_deref() == BranchKind::NAMES.get(1).copied())
    }

    /// The values of the abscissa on which the user wants curves to land.
    pub fn own_landings(&self) -> Vec<f64> {
        let Some((name, _)) = self.abscissa() else {
            return Vec::new();
        };
        let texts: Vec<String> = match &self.estimate {
            Command::Branch(options) => options.at.clone().into_iter().collect(),
            Command::Locus(options) => {
                let by_name = entries(&options.at);
                let by_name = by_name.filter(|entry| named(entry) == name);
                let by_name: Vec<String> = by_name
                    .map(|entry| entry[name.len() + 1..].into())
                    .collect();
                let flag = match name {
                    "driving" => options.at_driving.clone(),
                    "stiffness" => options.at_stiffness.clone(),
                    _ => None,
                };
                match by_name.is_empty() {
                    true => flag.into_iter().collect(),
                    false => by_name,
                }
            }
            _ => Vec::new(),
        };
        let read = |text: &String| numbers("at", text).unwrap_or_default();
        texts.iter().flat_map(read).collect()
    }

    /// The command of a member whose curves land on these values of the abscissa.
    pub fn landing(&self, command: Command, values: &[f64]) -> Command {
        let Some((name, _)) = self.abscissa() else {
            return command;
        };
        let texts: Vec<String> = values.iter().map(|x| format!("{x:e}")).collect();
        let text = Some(texts.join(",")).filter(|text| !text.is_empty());
        let mut command = command;
        match &mut command {
            Command::Branch(options) => options.at = text,
            Command::Locus(options) => {
                let others = entries(&options.at).filter(|entry| named(entry) != name);
                let mut all: Vec<String> = others.map(str::to_owned).collect();
                match name {
                    "driving" => options.at_driving = text,
                    "stiffness" => options.at_stiffness = text,
                    _ => all.extend(text.map(|text| format!("{name}={text}"))),
                }
                options.at = all;
            }
            _ => {}
        }
        command
    }
}

/// `NAME=V1,V2,...`, of which a scene joins several.
pub(super) fn entries(at: &[String]) -> impl Iterator<Item = &str> {
    at.iter().flat_map(|text| text.split(';')).map(str::trim)
}

pub(super) fn named(entry: &str) -> &str {
    entry.split('=').next().unwrap_or_default().trim()
}
