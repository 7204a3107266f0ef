//! `--set NAME=VALUE`: any parameter of the model by its name.

use super::options::{ModelOptions, SlabOptions};
use super::unequal::of_one;
use crate::error::{Error, Result};

/// The names of the parameters that interfaces have, V_H and K first.
pub(super) const NAMES: [&str; 10] = [
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
];

/// The names and values.
///
/// # Errors
/// [`Error::Input`] for what is no NAME=VALUE with a finite number.
pub(super) fn assignments(set: &[String]) -> Result<Vec<(&str, f64)>> {
    let mut all = Vec::with_capacity(set.len());
    for set in set {
        let pair = set.split_once('=');
        let (name, value) =
            pair.ok_or_else(|| Error::Input(format!("`set` {set:?} must be NAME=VALUE")))?;
        let number = value.trim().parse::<f64>().ok().filter(|x| x.is_finite());
        let value = number.ok_or_else(|| {
            Error::Input(format!("`set` {set:?}: {value:?} is not a finite number"))
        })?;
        all.push((name.trim(), value));
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
                "driving" => model.driving = Some(value),
                "stiffness" => model.stiffness = Some(value),
                _ => model.slab.put(name, value)?,
            }
        }
        Ok(model)
    }
}

impl SlabOptions {
    /// The same for a command to which V_H and K are a grid.
    ///
    /// # Errors
    /// As [`ModelOptions::resolved`]; [`Error::Input`] for V_H and K.
    pub(super) fn resolved(&self) -> Result<SlabOptions> {
        let mut slab = self.clone();
        for (name, value) in assignments(&self.text.set)? {
            if ["driving", "stiffness"].contains(&name) {
                let what = format!("`set` {name}: the grid of this command has it");
                return Err(Error::Input(what));
            }
            slab.put(name, value)?;
        }
        Ok(slab)
    }

    /// Another value of a parameter that is neither V_H nor K. Those of one interface are seen to where there is a system.
    fn put(&mut self, name: &str, value: f64) -> Result<()> {
        if of_one("set", name)?.is_some() {
            return Ok(());
        }
        if ["slip_length", "normal_stress"].contains(&name) && !self.si {
            let what = format!("`set` {name}: without `si` it is a unit, and 1");
            return Err(Error::Input(what));
        }
        match name {
            "damping" => {
                (self.shear_modulus, self.shear_wave_speed) = (None, None);
                self.damping = Some(value);
            }
            "healing_time" => self.healing_time = Some(value),
            "residual_strength" => self.residual_strength = Some(value),
            "direct_effect" => self.direct_effect = Some(value),
            "evolution_effect" => self.evolution_effect = Some(value),
            "reference_friction" => self.reference_friction = Some(value),
            "slip_length" => self.slip_length = Some(value),
            "normal_stress" => self.normal_stress = Some(value),
            _ => return Err(Error::unknown("set", name, &NAMES)),
        }
        Ok(())
    }
}
