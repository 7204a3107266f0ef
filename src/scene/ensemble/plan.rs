//! A command with the parameters of a fit in it: at the estimate, and beside it.

use super::super::command::Command;
use super::super::following::numbers;
use super::super::general::plane;
use super::super::options::{OutputOptions, SlabOptions};
use super::super::set::assignments;
use super::super::system::{HEALING_TIME, REFERENCE_RATE, SLIP_LENGTH};
use super::super::units::Quantity;
use super::super::{branch::BranchKind, following};
use super::{EnsembleFile, EnsembleOptions, FrictionFit};
use crate::error::{Error, Result};

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
                "`ensemble` is of friction, and `system` names a system of one's own".into(),
            ));
        }
        let fit = FrictionFit::read(&file.path)?;
        let sweeps = matches!(command, Command::Sweep(_));
        let usual = if sweeps { DRAWS_OF_SWEEP } else { DRAWS };
        let draws = file.draws.unwrap_or(usual);
        if sweeps && draws == 0 {
            return Err(Error::Input(format!(
                "`ensemble` {text}: a sweep has probabilities, which need draws; say how many, such as {}:{DRAWS_OF_SWEEP}",
                file.path.display()
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
fn entries(at: &[String]) -> impl Iterator<Item = &str> {
    at.iter().flat_map(|text| text.split(';')).map(str::trim)
}

fn named(entry: &str) -> &str {
    entry.split('=').next().unwrap_or_default().trim()
}

impl Command {
    /// What is said of an ensemble, of commands that take one.
    fn ensemble(&self) -> Option<&EnsembleOptions> {
        match self {
            Command::Law(options) => Some(&options.ensemble),
            Command::Equilibria(options) => Some(&options.ensemble),
            Command::Branch(options) => Some(&options.ensemble),
            Command::Locus(options) => Some(&options.ensemble),
            Command::Sweep(options) => Some(&options.ensemble),
            Command::Integrate(_) | Command::Orbit(_) | Command::Section(_) | Command::Fit(_) => {
                None
            }
        }
    }

    fn slab_mut(&mut self) -> Option<&mut SlabOptions> {
        Some(match self {
            Command::Law(options) => &mut options.model.slab,
            Command::Integrate(options) => &mut options.model.slab,
            Command::Equilibria(options) => &mut options.model.slab,
            Command::Orbit(options) => &mut options.model.slab,
            Command::Section(options) => &mut options.model.slab,
            Command::Branch(options) => &mut options.model.slab,
            Command::Locus(options) => &mut options.model.slab,
            Command::Sweep(options) => &mut options.slab,
            Command::Fit(_) => return None,
        })
    }

    /// Where its results go.
    pub fn output(&self) -> &OutputOptions {
        match self {
            Command::Law(options) => &options.output,
            Command::Integrate(options) => &options.output,
            Command::Equilibria(options) => &options.output,
            Command::Orbit(options) => &options.output,
            Command::Section(options) => &options.output,
            Command::Branch(options) => &options.output,
            Command::Locus(options) => &options.output,
            Command::Sweep(options) => &options.output,
            Command::Fit(options) => &options.output,
        }
    }

    /// The file of its picture, of commands that take an ensemble.
    pub fn plot(&self) -> Option<&std::path::Path> {
        match self {
            Command::Law(options) => options.plot.as_deref(),
            Command::Branch(options) => options.plot.as_deref(),
            Command::Locus(options) => options.plot.as_deref(),
            Command::Sweep(options) => options.plot.as_deref(),
            _ => None,
        }
    }

    /// What varies in the command itself.
    fn varies(&self) -> Vec<(&'static str, String)> {
        let of_grid = |text: &String| ("grid", named(text).to_owned());
        match self {
            Command::Branch(options) => options
                .along
                .iter()
                .map(|name| ("along", name.clone()))
                .collect(),
            Command::Locus(options) => {
                let names = options.plane.iter().flat_map(|names| names.split(','));
                names.map(|name| ("in", name.trim().to_owned())).collect()
            }
            Command::Sweep(options) => options.grid.iter().map(of_grid).collect(),
            _ => Vec::new(),
        }
    }

    /// What has no meaning beside a fit.
    fn refuses(&mut self, fit: &FrictionFit, file: &EnsembleFile) -> Result<()> {
        let of_file = file.path.display().to_string();
        let wrong = |what: String| Err(Error::Input(what));
        let (resumes, draws) = match self {
            Command::Branch(options) => (options.resume.is_some(), false),
            Command::Locus(options) => (options.resume.is_some(), false),
            Command::Sweep(options) => (
                options.resume.is_some() || options.shard.is_some(),
                options.basin,
            ),
            Command::Equilibria(options) => (false, !options.draw.is_empty()),
            _ => (false, false),
        };
        if resumes {
            return wrong(
                "`ensemble` keeps nothing to go on with: leave out `resume` and `shard`".into(),
            );
        }
        if draws {
            return wrong(
                "`ensemble` is of the parameters of a fit, and takes neither `draw` nor `basin`"
                    .into(),
            );
        }
        let varies = self.varies();
        let Some(slab) = self.slab_mut() else {
            return Ok(());
        };
        // The default can't be told from the same name given.
        if slab.law != SPINODAL && slab.law != fit.law {
            let law = &slab.law;
            return wrong(format!(
                "`law` {law}: `ensemble` {of_file} is a fit of the law {}",
                fit.law
            ));
        }
        for one in &fit.parameters {
            let name = one.name;
            if let Some((option, _)) = varies.iter().find(|(_, varied)| varied == name) {
                return wrong(format!(
                    "`{option}` {name}: `ensemble` {of_file} has it fitted, and it can't vary too"
                ));
            }
            if is_given(slab, name)? {
                return wrong(format!(
                    "`{name}` is given, and `ensemble` {of_file} has it fitted; leave it out"
                ));
            }
        }
        Ok(())
    }

    /// Puts the estimate in, and what a default would have to be in units that change with the parameters.
    fn prepare(&mut self, fit: &FrictionFit) -> Result<()> {
        let Some(slab) = self.slab_mut() else {
            return Ok(());
        };
        slab.si = true;
        slab.law = fit.law.clone();
        for &(name, value) in &fit.fixed {
            if fit.parameters.iter().all(|one| one.name != name)
                && !is_given(slab, name)?
                && let Some(place) = place(slab, name)
            {
                *place = Some(value);
            }
        }
        for one in &fit.parameters {
            if let Some(place) = place(slab, one.name) {
                *place = Some(one.value);
            }
        }
        if !is_given(slab, "healing_time")? {
            let length = slab.slip_length.unwrap_or(SLIP_LENGTH);
            let rate = slab.reference_rate.unwrap_or(REFERENCE_RATE);
            slab.healing_time = Some(HEALING_TIME * length / rate);
        }
        self.forget_ensemble();
        self.pin(fit);
        Ok(())
    }

    fn forget_ensemble(&mut self) {
        let nothing = EnsembleOptions::default;
        match self {
            Command::Law(options) => options.ensemble = nothing(),
            Command::Equilibria(options) => options.ensemble = nothing(),
            Command::Branch(options) => options.ensemble = nothing(),
            Command::Locus(options) => options.ensemble = nothing(),
            Command::Sweep(options) => options.ensemble = nothing(),
            Command::Integrate(_) | Command::Orbit(_) | Command::Section(_) | Command::Fit(_) => {}
        }
    }

    /// Ranges that are not given are those of the estimate, for all members.
    fn pin(&mut self, fit: &FrictionFit) {
        // What is wrong with the system, the command says itself.
        let Some(units) = self.units() else {
            return;
        };
        let moves = |name: &str| match name {
            "driving" => fit
                .parameters
                .iter()
                .any(|one| one.name == "reference_rate"),
            _ => true,
        };
        let ends = |name: &str| {
            let (quantity, (from, to)) = match name {
                "driving" => (Quantity::SlipRate, following::DRIVING),
                "stiffness" => (Quantity::Stiffness, following::STIFFNESS),
                _ => return None,
            };
            let out = |x| units.outward(quantity, x);
            moves(name).then(|| (out(from), out(to)))
        };
        match self {
            Command::Law(options) => {
                if let Some((from, to)) = ends("driving") {
                    options.from.get_or_insert(from);
                    options.to.get_or_insert(to);
                }
            }
            Command::Branch(options) => {
                if let Some((from, to)) = ends(options.along.as_deref().unwrap_or("driving")) {
                    options.from.get_or_insert(from);
                    options.to.get_or_insert(to);
                }
            }
            Command::Locus(options) => {
                let names = options.plane.as_deref().unwrap_or("driving,stiffness");
                for name in plane(names).unwrap_or_default() {
                    let has_own = entries(&options.range).any(|entry| named(entry) == name);
                    let place = match name {
                        "driving" => &mut options.driving_range,
                        _ => &mut options.stiffness_range,
                    };
                    if let (Some((from, to)), None, false) = (ends(name), &place, has_own) {
                        *place = Some(format!("{from:e}:{to:e}"));
                    }
                }
            }
            _ => {}
        }
    }
}

/// The law where none is given.
const SPINODAL: &str = "spinodal";

/// Where a parameter of friction stands among the options.
fn place<'a>(slab: &'a mut SlabOptions, name: &str) -> Option<&'a mut Option<f64>> {
    Some(match name {
        "direct_effect" => &mut slab.direct_effect,
        "evolution_effect" => &mut slab.evolution_effect,
        "reference_friction" => &mut slab.reference_friction,
        "slip_length" => &mut slab.slip_length,
        "reference_rate" => &mut slab.reference_rate,
        "normal_stress" => &mut slab.normal_stress,
        "healing_time" => &mut slab.healing_time,
        "residual_strength" => &mut slab.residual_strength,
        "damping" => &mut slab.damping,
        _ => return None,
    })
}

/// Whether a parameter of all interfaces is given.
fn is_given(slab: &mut SlabOptions, name: &str) -> Result<bool> {
    let by_set = assignments(&slab.text.set)?
        .iter()
        .any(|(own, _)| *own == name);
    let by_moduli = name == "damping" && slab.shear_modulus.is_some();
    Ok(by_set || by_moduli || place(slab, name).is_some_and(|place| place.is_some()))
}
