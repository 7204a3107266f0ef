//! The units of laboratories, in SI.

use crate::scene::words::Kind;
use twinslip::error::{Error, Result};

/// Units of numbers without one.
const RATIOS: [(&str, f64); 4] = [("1", 1.0), ("-", 1.0), ("none", 1.0), ("%", 1e-2)];

/// Whether it is the unit of a time, a length or a stress.
pub(super) fn is_unit(unit: &str) -> bool {
    let all = [Kind::Time, Kind::Length, Kind::Stress];
    all.iter().any(|kind| kind.size(unit.trim()).is_some())
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
        _ => kind.size(unit),
    };
    found.ok_or_else(|| {
        let known: Vec<&str> = match kind {
            Kind::Number => RATIOS.iter().map(|(name, _)| *name).collect(),
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
