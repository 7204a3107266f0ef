//! What is given of a fit's parameters: values, and ranges.

use super::law::own_name;
use super::options::FitOptions;
use super::plan::Recording;
use super::unit::GivenStiffness;
use crate::scene::set::assignments;
use twinslip::error::{Error, Result};
use twinslip::fit::{FreeParameter, Scale};
use twinslip::friction::positive;

/// Values of parameters stay between these, and those of others between minus and plus the larger.
const DOMAIN: (f64, f64) = (1e-30, 1e30);
/// A slip length that is longer, in what the load point moves, does not show in the record.
const LONGEST: f64 = 100.0;

/// The values that were given, by the names of parameters; the stiffness as friction per metre.
pub(super) struct Given {
    values: Vec<(String, f64)>,
    /// Slip lengths are looked for between these, in m.
    lengths: (f64, f64),
    /// Whether the stiffness was given in Pa/m.
    is_of_stress: bool,
    normal_stress: Option<f64>,
}

impl Given {
    /// Of these records; the stiffness as that of the first.
    pub fn new(options: &FitOptions, recordings: &[Recording]) -> Result<Self> {
        // How far the load point moves in all, and on average between two samples, in m.
        let lengths = recordings.iter().map(|Recording { record, .. }| {
            let moved = record.displacement.iter();
            let moved = moved.fold(0.0, |most: f64, x| most.max(x.abs()));
            (moved, moved / record.times.len() as f64)
        });
        let none = (0.0_f64, f64::INFINITY);
        let (moved, spacing) = lengths.fold(none, |all, one| (all.0.max(one.0), all.1.min(one.1)));
        let normal_stress = recordings[0].measured.normal_stress;
        let mut is_of_stress = false;
        let stiffness = match &options.stiffness {
            None => None,
            Some(text) => {
                let stiffness = GivenStiffness::read(text)?;
                is_of_stress = matches!(stiffness, GivenStiffness::OfStress(_));
                Some(stiffness.of_friction(normal_stress)?)
            }
        };
        let mut given = Vec::new();
        for (name, value) in [
            ("direct_effect", options.direct_effect),
            ("slip_length", options.slip_length),
            ("slip_length_2", options.slip_length_2),
            ("reference_friction", options.reference_friction),
            ("healing_time", options.healing_time),
            ("stiffness", stiffness),
        ] {
            let checked = value.map(|x| positive(&name.replace('_', "-"), x));
            given.extend(checked.transpose()?.map(|x| (name.to_owned(), x)));
        }
        for (name, value) in [
            ("evolution_effect", options.evolution_effect),
            ("evolution_effect_2", options.evolution_effect_2),
            ("residual_strength", options.residual_strength),
        ] {
            given.extend(value.map(|x| (name.to_owned(), x)));
        }
        for (name, value) in assignments(&options.set)? {
            let name = own_name(&name.replace('-', "_")).to_owned();
            let value = match name.as_str() {
                "stiffness" => {
                    is_of_stress = true;
                    GivenStiffness::OfStress(value).of_friction(normal_stress)?
                }
                _ => value,
            };
            given.push((name, value));
        }
        Ok(Given {
            values: given,
            normal_stress,
            // Over a shorter length friction decays between two samples.
            lengths: (spacing, LONGEST * moved),
            is_of_stress,
        })
    }

    /// By what the stiffness that was given is multiplied for each record.
    pub fn softer(&self, recordings: &[Recording]) -> Vec<f64> {
        let first = recordings[0].measured.normal_stress;
        let each = recordings.iter().map(|own| {
            let pair = first.zip(own.measured.normal_stress);
            pair.filter(|_| self.is_of_stress)
                .map_or(1.0, |(first, own)| first / own)
        });
        each.collect()
    }

    /// Those of a law's parameters.
    pub fn of(
        &self,
        has: &[&'static str],
        law: &str,
        alone: bool,
    ) -> Result<Vec<(&'static str, Option<f64>)>> {
        // Of several laws one has what another has not.
        let strange = self
            .values
            .iter()
            .find(|(name, _)| !has.contains(&name.as_str()));
        if let Some((name, _)) = strange.filter(|_| alone) {
            return Err(Error::Input(format!(
                "`{name}` is no parameter of the law {law}, which has {}",
                has.join(", ")
            )));
        }
        let value = |name: &str| {
            self.values
                .iter()
                .rev()
                .find(|(own, _)| own == name)
                .map(|(_, x)| *x)
        };
        Ok(has.iter().map(|name| (*name, value(name))).collect())
    }
}

/// Between what a parameter is looked for.
pub(super) fn bounds(
    (options, given): (&FitOptions, &Given),
    name: &str,
    scale: Scale,
) -> Result<(f64, f64)> {
    let is_length = name.starts_with("slip_length");
    let (least, most) = match scale {
        Scale::Logarithmic => DOMAIN,
        Scale::Linear => (-DOMAIN.1, DOMAIN.1),
    };
    let Some((text, own)) = options.bounds.iter().find_map(|text| {
        let (own, range) = text.split_once('=')?;
        (own_name(&own.trim().replace('-', "_")) == name).then_some((text, range))
    }) else {
        return Ok(match is_length {
            true => (least.max(given.lengths.0), most.min(given.lengths.1)),
            false => (least, most),
        });
    };
    let wrong = || Error::Input(format!("`bounds` {text:?} must be NAME=A:B with A below B"));
    let (low, high) = own.split_once(':').ok_or_else(wrong)?;
    let read = |text: &str| {
        let text = text.trim();
        let number = text.parse::<f64>().ok();
        match (number, given.normal_stress) {
            // As results are: in Pa/m where the normal stress is known, else in friction per metre.
            (Some(k), Some(sigma)) if name == "stiffness" => Ok(k / sigma),
            (Some(x), _) => Ok(x),
            (None, sigma) if name == "stiffness" => GivenStiffness::read(text)
                .and_then(|k| k.of_friction(sigma))
                .map_err(|_| wrong()),
            (None, _) => Err(wrong()),
        }
    };
    let (low, high) = (read(low)?, read(high)?);
    if low >= high {
        return Err(wrong());
    }
    if low < least {
        return Err(Error::Input(format!(
            "`bounds` {text:?}: {name} is positive, and so must its lower bound be"
        )));
    }
    Ok((low, high.min(most)))
}

/// Whether b may be negative, as it is of clays: where its bounds, or the value that is given, say so.
pub(super) fn is_negative(options: &FitOptions, name: &str) -> bool {
    let below = |text: &String| {
        let (own, range) = text.split_once('=')?;
        let low = range.split(':').next()?.trim().parse::<f64>().ok()?;
        Some(own.trim().replace('-', "_") == name && low < 0.0)
    };
    name == "evolution_effect"
        && (options.evolution_effect.is_some_and(|b| b < 0.0)
            || options.bounds.iter().any(|text| below(text) == Some(true)))
}

/// # Errors
/// [`Error::Input`] for bounds of what is not free.
pub(super) fn unknown_bounds(options: &FitOptions, free: &[FreeParameter]) -> Result<()> {
    for text in &options.bounds {
        let name = text
            .split('=')
            .next()
            .unwrap_or(text)
            .trim()
            .replace('-', "_");
        let name = own_name(&name);
        if !free.iter().any(|free| free.name == name) {
            return Err(Error::Input(format!(
                "`bounds` {text:?}: {name} is not fitted"
            )));
        }
    }
    Ok(())
}
