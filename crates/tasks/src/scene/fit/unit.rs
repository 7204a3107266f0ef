//! The units of laboratories, in SI.

use crate::scene::words::Kind;
use twinslip::error::{Error, Result};

/// Units of numbers without one.
const RATIOS: [(&str, f64); 5] = [
    ("1", 1.0),
    ("-", 1.0),
    (".", 1.0),
    ("none", 1.0),
    ("%", 1e-2),
];

/// Units that instruments write beside those of options.
const OF_INSTRUMENTS: [(&str, Kind, f64); 16] = [
    ("mic", Kind::Length, 1e-6),
    ("micrometer", Kind::Length, 1e-6),
    ("micrometre", Kind::Length, 1e-6),
    // The micro sign as other code pages have it, and where it was lost.
    ("\u{e6}m", Kind::Length, 1e-6),
    ("\u{fffd}m", Kind::Length, 1e-6),
    ("?m", Kind::Length, 1e-6),
    ("msec", Kind::Time, 1e-3),
    ("secs", Kind::Time, 1.0),
    ("second", Kind::Time, 1.0),
    ("sek", Kind::Time, 1.0),
    ("mins", Kind::Time, 60.0),
    ("hr", Kind::Time, 3600.0),
    ("N/mm2", Kind::Stress, 1e6),
    ("N/mm^2", Kind::Stress, 1e6),
    ("kbar", Kind::Stress, 1e8),
    ("psi", Kind::Stress, 6_894.757_293_168),
];

/// The size in SI of a unit of this kind.
fn size(kind: Kind, unit: &str) -> Option<f64> {
    let unit = unit.trim();
    let own = OF_INSTRUMENTS
        .iter()
        .find(|(name, of, _)| *of == kind && name.eq_ignore_ascii_case(unit));
    match own {
        Some((.., size)) => Some(*size),
        None if kind == Kind::Velocity => {
            let inverse = ["s-1", "s^-1", "s\u{207b}\u{b9}"];
            let per = inverse.iter().find_map(|end| unit.strip_suffix(end));
            let (length, time) = match per {
                Some(length) => (length.trim_end_matches([' ', '.', '\u{b7}']), "s"),
                None => unit.split_once('/')?,
            };
            Some(size(Kind::Length, length)? / size(Kind::Time, time)?)
        }
        None => kind.size(unit),
    }
}

/// Whether it is the unit of a time, a length, a stress or a velocity.
pub(super) fn is_unit(unit: &str) -> bool {
    let all = [Kind::Time, Kind::Length, Kind::Stress, Kind::Velocity];
    all.iter().any(|kind| size(*kind, unit).is_some())
}

/// The size in SI of the unit of a column that measures this; that of SI where the column says none.
///
/// # Errors
/// [`Error::Input`] for a unit that is not known, with those that are.
pub(super) fn factor(kind: Kind, unit: Option<&str>, column: &str) -> Result<f64> {
    let Some(unit) = unit else { return Ok(1.0) };
    let unit = unit.trim();
    let ratio = RATIOS.iter().find(|(name, _)| *name == unit);
    let found = match kind {
        Kind::Number => ratio.map(|(_, size)| *size),
        _ => size(kind, unit),
    };
    found.ok_or_else(|| {
        let known: Vec<&str> = match kind {
            Kind::Number => RATIOS.iter().map(|(name, _)| *name).collect(),
            Kind::Velocity => vec!["m/s", "mm/s", "um/s", "nm/s", "um/min"],
            _ => kind.names().collect(),
        };
        Error::Input(format!(
            "the unit {unit:?} of the column {column} is none of {}",
            known.join(", ")
        ))
    })
}

/// A stiffness: `1.2e9` in Pa/m, or friction per length, `0.003/um`.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) enum GivenStiffness {
    /// Of stress, in Pa/m.
    OfStress(f64),
    /// Of friction, in 1/m.
    OfFriction(f64),
}

impl GivenStiffness {
    /// As friction per metre.
    ///
    /// # Errors
    /// [`Error::Input`] for one in Pa/m where the normal stress is not known.
    pub fn of_friction(self, normal_stress: Option<f64>) -> Result<f64> {
        match (self, normal_stress) {
            (GivenStiffness::OfFriction(k), _) => Ok(k),
            (GivenStiffness::OfStress(k), Some(sigma)) => Ok(k / sigma),
            (GivenStiffness::OfStress(_), None) => Err(Error::Input(
                "`stiffness` in Pa/m needs the `normal_stress`; or give it as friction per length, such as 0.003/um".into(),
            )),
        }
    }

    /// Reads it.
    ///
    /// # Errors
    /// [`Error::Input`] for what is neither.
    pub fn read(text: &str) -> Result<Self> {
        let wrong = || {
            Error::Input(format!(
                "`stiffness` {text:?} must be a positive number in Pa/m, or friction per length such as 0.003/um"
            ))
        };
        let value = |text: &str| -> Result<f64> {
            let value: Option<f64> = text.trim().parse().ok();
            value
                .filter(|x| *x > 0.0 && x.is_finite())
                .ok_or_else(wrong)
        };
        match text.split_once('/') {
            None => Ok(GivenStiffness::OfStress(value(text)?)),
            Some((number, unit)) => {
                let length = Kind::Length.size(unit.trim()).ok_or_else(wrong)?;
                Ok(GivenStiffness::OfFriction(value(number)? / length))
            }
        }
    }
}
