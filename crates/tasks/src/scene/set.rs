//! `--set NAME=VALUE`: any parameter of the model by its name.

use super::options::{ModelOptions, SlabOptions};
use super::system::{HEALING_TIME, NORMAL_STRESS, REFERENCE_RATE, SLIP_LENGTH};
use super::text::{MASS, NORMAL_STRESS_COUPLING, SECOND_EVOLUTION_EFFECT, SECOND_SLIP_LENGTH};
use super::unequal::{is_of_one, of_one};
use twinslip::error::{Error, Result};
use twinslip::friction::{AnyLaw, Law, Parameters};

/// The names of the parameters that interfaces have, V_H and K first.
pub(super) const NAMES: [&str; 14] = [
    "driving",
    "stiffness",
    "damping",
    "healing_time",
    "residual_strength",
    "direct_effect",
    "evolution_effect",
    "reference_friction",
    "slip_length",
    "normal_stress",
    SECOND_EVOLUTION_EFFECT,
    SECOND_SLIP_LENGTH,
    MASS,
    NORMAL_STRESS_COUPLING,
];

/// The names and values.
///
/// # Errors
/// [`Error::Input`] for what is no NAME=VALUE with a finite number, and for a name that comes twice.
pub(super) fn assignments(set: &[String]) -> Result<Vec<(&str, f64)>> {
    let mut all: Vec<(&str, f64)> = Vec::with_capacity(set.len());
    for set in set {
        let pair = set.split_once('=');
        let (name, value) =
            pair.ok_or_else(|| Error::Input(format!("`set` {set:?} must be NAME=VALUE")))?;
        let number = value.trim().parse::<f64>().ok().filter(|x| x.is_finite());
        let value = number.ok_or_else(|| {
            Error::Input(format!("`set` {set:?}: {value:?} is not a finite number"))
        })?;
        let name = name.trim();
        if all.iter().any(|(other, _)| *other == name) {
            return Err(Error::Input(format!("`set` gives {name} twice")));
        }
        all.push((name, value));
    }
    Ok(all)
}

impl ModelOptions {
    /// The same with what `set` says in the options of these names.
    ///
    /// # Errors
    /// As [`assignments`]; [`Error::Parameter`] for a name that no parameter has.
    pub(super) fn resolved(&self) -> Result<ModelOptions> {
        let mut model = self.clone();
        for (name, value) in assignments(&self.slab.text.set)? {
            match name {
                "driving" => put_in(&mut model.driving, name, value)?,
                "stiffness" => put_in(&mut model.stiffness, name, value)?,
                _ => model.slab.put(name, value)?,
            }
        }
        Ok(model)
    }
}

impl ModelOptions {
    /// V_H and K as flags or `set` give them, in the user's units.
    ///
    /// # Errors
    /// As [`assignments`].
    pub(super) fn loading(&self) -> Result<[Option<f64>; 2]> {
        let set = assignments(&self.slab.text.set)?;
        let of = |name: &str| set.iter().find(|(set, _)| *set == name).map(|(_, x)| *x);
        Ok([
            self.driving.or(of("driving")),
            self.stiffness.or(of("stiffness")),
        ])
    }

    /// Whether a flag or `set` gives the parameter of this name.
    ///
    /// # Errors
    /// As [`assignments`].
    pub(super) fn gives(&self, name: &str) -> Result<bool> {
        let flag = match name {
            "driving" => self.driving.is_some(),
            "stiffness" => self.stiffness.is_some(),
            _ => self.slab.flag(name),
        };
        Ok(flag || self.slab.sets(name)?)
    }
}

impl SlabOptions {
    /// Whether a flag gives the parameter of this name.
    pub(super) fn flag(&self, name: &str) -> bool {
        match name {
            "damping" => self.damping.or(self.shear_modulus),
            "healing_time" => self.healing_time,
            "residual_strength" => self.residual_strength,
            "direct_effect" => self.direct_effect,
            "evolution_effect" => self.evolution_effect,
            "reference_friction" => self.reference_friction,
            "slip_length" => self.slip_length,
            "normal_stress" => self.normal_stress,
            SECOND_EVOLUTION_EFFECT => self.second_evolution_effect,
            SECOND_SLIP_LENGTH => self.second_slip_length,
            MASS => self.mass,
            NORMAL_STRESS_COUPLING => self.normal_stress_coupling,
            _ => None,
        }
        .is_some()
    }

    /// Whether `set` gives the parameter of this name.
    ///
    /// # Errors
    /// As [`assignments`].
    pub(super) fn sets(&self, name: &str) -> Result<bool> {
        let all = assignments(&self.text.set)?;
        Ok(all.iter().any(|(set, _)| *set == name))
    }

    /// The same for a command to which V_H and K are a grid.
    ///
    /// # Errors
    /// As [`ModelOptions::resolved`]; [`Error::Input`] for V_H and K.
    pub(super) fn resolved(&self) -> Result<SlabOptions> {
        let mut slab = self.clone();
        for (name, value) in assignments(&self.text.set)? {
            if ["driving", "stiffness"].contains(&name) {
                let what = format!("`set` {name}: the grid of this command sets it");
                return Err(Error::Input(what));
            }
            slab.put(name, value)?;
        }
        Ok(slab)
    }

    /// Whether `set` gives a value to one interface alone, of however many.
    pub(super) fn sets_one_interface(&self) -> Result<bool> {
        let set = assignments(&self.text.set)?;
        Ok(set.into_iter().any(|(name, _)| is_of_one(name)))
    }

    /// The value of a parameter that is neither V_H nor K. Those of one interface are seen to where there is a system.
    fn put(&mut self, name: &str, value: f64) -> Result<()> {
        let is_of_one_of_many = self.count() > 2 && is_of_one(name);
        if is_of_one_of_many || of_one("set", name)?.is_some() {
            return Ok(());
        }
        if ["slip_length", "normal_stress"].contains(&name) && !self.si {
            let what = format!("`set` {name}: without `si` it is the unit of other numbers, and 1");
            return Err(Error::Input(what));
        }
        match name {
            "damping" if self.shear_modulus.is_some() => Err(twice("damping", "shear-modulus")),
            "damping" => put_in(&mut self.damping, name, value),
            "healing_time" => put_in(&mut self.healing_time, name, value),
            "residual_strength" => put_in(&mut self.residual_strength, name, value),
            "direct_effect" => put_in(&mut self.direct_effect, name, value),
            "evolution_effect" => put_in(&mut self.evolution_effect, name, value),
            "reference_friction" => put_in(&mut self.reference_friction, name, value),
            "slip_length" => put_in(&mut self.slip_length, name, value),
            "normal_stress" => put_in(&mut self.normal_stress, name, value),
            SECOND_EVOLUTION_EFFECT => put_in(&mut self.second_evolution_effect, name, value),
            SECOND_SLIP_LENGTH => put_in(&mut self.second_slip_length, name, value),
            MASS => put_in(&mut self.mass, name, value),
            NORMAL_STRESS_COUPLING => put_in(&mut self.normal_stress_coupling, name, value),
            _ => Err(Error::no_parameter("set", name, &NAMES)),
        }
    }
}

/// The parameters in SI that set units, with their defaults.
const UNITS: [(&str, f64); 2] = [
    ("slip_length", SLIP_LENGTH),
    ("normal_stress", NORMAL_STRESS),
];

impl ModelOptions {
    /// These options with a value for each free parameter by which SI units are made: the geometric mean of the ends of its range. Units, and
    /// what has a default in these, then do not change with the parameter.
    ///
    /// # Errors
    /// As [`assignments`].
    pub(super) fn within(&self, free: &[(&str, Option<(f64, f64)>)]) -> Result<ModelOptions> {
        let mut model = self.clone();
        for &(name, ends) in free {
            let unit = UNITS
                .iter()
                .find(|(unit, _)| name.strip_suffix("_1").unwrap_or(name) == *unit);
            let Some((_, default)) = unit.filter(|_| self.slab.si) else {
                continue;
            };
            let middle = ends.map(|(from, to)| from.sqrt() * to.sqrt());
            let middle = middle.filter(|x| *x > 0.0 && x.is_finite());
            // A range that can't be is refused where it is read.
            let middle = middle.unwrap_or(*default);
            if !self.gives(name)? {
                model.slab.text.set.push(format!("{name}={middle:?}"));
            }
            model.slab.hold_healing_time(name)?;
        }
        Ok(model)
    }
}

impl SlabOptions {
    /// Gives the healing time the default that it has at the default slip length, where that is the free parameter of this name.
    ///
    /// # Errors
    /// As [`assignments`].
    pub(super) fn hold_healing_time(&mut self, free: &str) -> Result<()> {
        let heals = |law: AnyLaw| law.bounds_state();
        if ["slip_length", "slip_length_1"].contains(&free)
            && AnyLaw::named(&self.law, Parameters::heslot_1994()).is_ok_and(heals)
            && !self.flag("healing_time")
            && !self.sets("healing_time")?
        {
            let rate = self.reference_rate.unwrap_or(REFERENCE_RATE);
            let length = self.slip_length.unwrap_or(SLIP_LENGTH);
            self.healing_time = Some(HEALING_TIME * length / rate);
        }
        Ok(())
    }
}

/// The value of a parameter that has none.
pub(super) fn put_in(parameter: &mut Option<f64>, name: &str, value: f64) -> Result<()> {
    if parameter.replace(value).is_some() {
        return Err(twice(name, name));
    }
    Ok(())
}

pub(super) fn twice(name: &str, option: &str) -> Error {
    Error::Input(format!(
        "`set` {name} and `{}` say the same thing: give one of them",
        option.replace('_', "-")
    ))
}
