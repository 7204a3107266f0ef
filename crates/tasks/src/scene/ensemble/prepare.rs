//! A command made ready for a fit: what is refused beside it, and where its parameters stand.

use super::super::command::Command;
use super::super::following;
use super::super::general::plane;
use super::super::options::{OutputOptions, SlabOptions};
use super::super::set::assignments;
use super::super::system::{HEALING_TIME, REFERENCE_RATE, SLIP_LENGTH};
use super::super::units::Quantity;
use super::plan::{entries, named};
use super::{EnsembleFile, EnsembleOptions, FrictionFit};
use twinslip::error::{Error, Result};

/// The law where none is given.
const SPINODAL: &str = "spinodal";

impl Command {
    /// What is said of an ensemble, of commands that take one.
    pub(super) fn ensemble(&self) -> Option<&EnsembleOptions> {
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

    pub(super) fn slab_mut(&mut self) -> Option<&mut SlabOptions> {
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
            Command::Equilibria(options) => options.plot.as_deref(),
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
    pub(super) fn refuses(&mut self, fit: &FrictionFit, file: &EnsembleFile) -> Result<()> {
        let of_file = file.told();
        let wrong = |what: String| Err(Error::Input(what));
        let (resumes, draws) = match self {
            Command::Branch(options) => (options.resume.is_some(), false),
            Command::Locus(options) => (options.resume.is_some(), false),
            Command::Sweep(options) => (
                options.resume.is_some() || options.shard.is_some(),
                options.basin,
            ),
            Command::Equilibria(options) => (false, !options.draws.draw.is_empty()),
            _ => (false, false),
        };
        if resumes {
            return wrong(
                "`ensemble` cannot be resumed or split: leave out `resume` and `shard`".into(),
            );
        }
        if draws {
            return wrong(
                "`ensemble` draws the parameters of a fit, and cannot be combined with `draw` or `basin`"
                    .into(),
            );
        }
        let varies = self.varies();
        let Some(slab) = self.slab_mut() else {
            return Ok(());
        };
        // The default can't be told from the same name given.
        if slab.law != SPINODAL && slab.law != fit.law {
            let law = slab.law_told();
            return wrong(format!(
                "`law` {law}: `ensemble` {of_file} is a fit of the law {}",
                fit.law
            ));
        }
        for one in &fit.parameters {
            let name = one.name;
            if let Some((option, _)) = varies.iter().find(|(_, varied)| varied == name) {
                return wrong(format!(
                    "`{option}` {name}: it is fitted in `ensemble` {of_file}, and a fitted parameter cannot also vary"
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
    pub(super) fn prepare(&mut self, fit: &FrictionFit) -> Result<()> {
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

/// Where a parameter of friction stands among the options.
pub(super) fn place<'a>(slab: &'a mut SlabOptions, name: &str) -> Option<&'a mut Option<f64>> {
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
