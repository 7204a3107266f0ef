//! The units of laboratories, in SI.

use twinslip::error::{Error, Result};

/// What a column measures.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Measure {
    /// In s.
    Time,
    /// In m.
    Length,
    /// In Pa.
    Stress,
    /// No unit.
    Ratio,
}

/// Names of units, and how large they are in SI.
type Names = &'static [(&'static str, f64)];

const TIMES: Names = &[
    ("s", 1.0),
    ("sec", 1.0),
    ("seconds", 1.0),
    ("ms", 1e-3),
    ("min", 60.0),
    ("minutes", 60.0),
    ("h", 3600.0),
    ("hours", 3600.0),
];
const LENGTHS: Names = &[
    ("m", 1.0),
    ("cm", 1e-2),
    ("mm", 1e-3),
    ("um", 1e-6),
    ("µm", 1e-6),
    ("μm", 1e-6),
    ("micron", 1e-6),
    ("microns", 1e-6),
    ("micrometers", 1e-6),
    ("micrometres", 1e-6),
    ("nm", 1e-9),
];
const STRESSES: Names = &[
    ("Pa", 1.0),
    ("kPa", 1e3),
    ("MPa", 1e6),
    ("GPa", 1e9),
    ("bar", 1e5),
];
const RATIOS: Names = &[("1", 1.0), ("-", 1.0), ("none", 1.0), ("%", 1e-2)];

impl Measure {
    fn names(self) -> Names {
        match self {
            Measure::Time => TIMES,
            Measure::Length => LENGTHS,
            Measure::Stress => STRESSES,
            Measure::Ratio => RATIOS,
        }
    }

    /// Whether it is the unit of any measure but a ratio.
    pub fn is_unit(unit: &str) -> bool {
        let all = [Measure::Time, Measure::Length, Measure::Stress];
        all.iter().any(|one| one.factor(Some(unit), "").is_ok())
    }

    /// The size of a unit in SI; that of SI where a column says none.
    ///
    /// # Errors
    /// [`Error::Input`] for a unit that is not known, with those that are.
    pub fn factor(self, unit: Option<&str>, column: &str) -> Result<f64> {
        let Some(unit) = unit else { return Ok(1.0) };
        let unit = unit.trim();
        let exactly = self.names().iter().find(|(name, _)| *name == unit);
        let same = |(name, _): &&(&str, f64)| name.eq_ignore_ascii_case(unit);
        let found = exactly.or_else(|| self.names().iter().find(same));
        found.map(|(_, factor)| *factor).ok_or_else(|| {
            let known: Vec<&str> = self.names().iter().map(|(name, _)| *name).collect();
            Error::Input(format!(
                "the unit {unit:?} of the column {column} is none of {}",
                known.join(", ")
            ))
        })
    }
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
                let of = LENGTHS.iter().find(|(name, _)| *name == unit.trim());
                let (_, length) = of.ok_or_else(wrong)?;
                Ok(GivenStiffness::OfFriction(value(number)? / length))
            }
        }
    }
}
