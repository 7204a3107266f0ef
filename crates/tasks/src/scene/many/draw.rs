//! Constants of interfaces drawn at random between two values.

use crate::scene::options::{ModelOptions, SlabOptions};
use twinslip::error::{Error, Result, did_you_mean};
use twinslip::random::Random;

/// What may be drawn.
const NAMES: [&str; 7] = [
    "healing_time",
    "residual_strength",
    "direct_effect",
    "evolution_effect",
    "reference_friction",
    "slip_length",
    "normal_stress",
];

/// What an interface has in units of the nominal ones.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct InUnits {
    pub slip_length: f64,
    pub normal_stress: f64,
}

impl Default for InUnits {
    fn default() -> Self {
        InUnits {
            slip_length: 1.0,
            normal_stress: 1.0,
        }
    }
}

/// A constant that each interface has of its own, equally likely anywhere between two values or, by logarithm, in any part of their
/// ratio.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct Draw {
    name: &'static str,
    from: f64,
    to: f64,
    by_logarithm: bool,
}

/// The values of a constant, of each interface one.
#[derive(Debug, Clone, PartialEq)]
pub struct Drawn {
    /// Its name.
    pub name: &'static str,
    /// Its values.
    pub values: Vec<f64>,
}

impl Draw {
    /// # Errors
    /// [`Error::Input`] where the model gives the constant one value, too. A direct effect stays: it sets the unit of stress.
    pub fn is_not_given(&self, model: &ModelOptions) -> Result<()> {
        let name = self.name;
        if name != "direct_effect" && model.gives(name)? {
            return Err(Error::Input(format!(
                "`{name}` can't be given where each interface has its own by `draw`; leave out one of them"
            )));
        }
        Ok(())
    }

    /// From `NAME=A:B` or `NAME=A:Blog`.
    ///
    /// # Errors
    /// [`Error::Input`] for what is none.
    pub fn read(text: &str) -> Result<Self> {
        let wrong = |what: String| Error::Input(format!("`draw` {text:?}: {what}"));
        let shape = || wrong("must be NAME=A:B or NAME=A:Blog with 0 < A <= B".into());
        let (name, range) = text.split_once('=').ok_or_else(shape)?;
        let name = name.trim();
        let known = NAMES.into_iter().find(|known| *known == name);
        let name = known.ok_or_else(|| {
            let hint = did_you_mean(name, NAMES.into_iter());
            wrong(format!("{name:?} is none of {}{hint}", NAMES.join(", ")))
        })?;
        let (range, by_logarithm) = match range.strip_suffix("log") {
            Some(range) => (range, true),
            None => (range, false),
        };
        let (from, to) = range.split_once(':').ok_or_else(shape)?;
        let number = |part: &str| part.trim().parse::<f64>().ok().filter(|x| x.is_finite());
        let (Some(from), Some(to)) = (number(from), number(to)) else {
            return Err(shape());
        };
        if !(from > 0.0 && from <= to) {
            return Err(shape());
        }
        Ok(Draw {
            name,
            from,
            to,
            by_logarithm,
        })
    }

    /// Room for the values that are drawn.
    pub fn none_drawn(&self) -> Drawn {
        Drawn {
            name: self.name,
            values: Vec::new(),
        }
    }

    /// As it was asked for.
    pub fn told(&self) -> String {
        let log = if self.by_logarithm { "log" } else { "" };
        format!("{}={:?}:{:?}{log}", self.name, self.from, self.to)
    }

    /// Gives the options of an interface its next value, and tells it.
    pub fn put(&self, random: &mut Random, slab: &mut SlabOptions, own: &mut InUnits) -> f64 {
        let value = if self.by_logarithm {
            let value = random.between((self.from.ln(), self.to.ln())).exp();
            value.clamp(self.from, self.to)
        } else {
            random.between((self.from, self.to))
        };
        match self.name {
            "healing_time" => slab.healing_time = Some(value),
            "residual_strength" => slab.residual_strength = Some(value),
            "evolution_effect" => slab.evolution_effect = Some(value),
            "reference_friction" => slab.reference_friction = Some(value),
            "direct_effect" => slab.direct_effect = Some(value),
            "slip_length" => own.slip_length = value,
            _ => own.normal_stress = value,
        }
        value
    }
}
