//! The values along one side of a grid, as they are given.

use super::super::units::{Quantity, Units};
use twinslip::error::Result;
use twinslip::friction::positive;
use twinslip::sweep::Range;

/// The values of an option, in the user's units.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct Grain {
    pub name: String,
    pub range: Range,
    /// One value stood alone.
    pub single: bool,
}

impl Grain {
    pub fn parse(name: &str, text: &str) -> Result<Self> {
        let alone = text.trim().parse::<f64>().ok();
        let range = match alone {
            Some(x) => Range {
                from: positive(name, x)?,
                to: x,
                count: 1,
                log: false,
            },
            None => Range::parse(name, text)?,
        };
        Ok(Grain {
            name: name.to_owned(),
            range,
            single: alone.is_some(),
        })
    }

    /// Of values that were read.
    pub fn of(name: &str, range: Range) -> Self {
        Grain {
            name: name.to_owned(),
            range,
            single: false,
        }
    }

    /// The same, dimensionless.
    pub fn inward(&self, quantity: Quantity, units: &Units) -> Result<Range> {
        let end = |x| positive(&self.name, units.inward(quantity, positive(&self.name, x)?));
        Ok(Range {
            from: end(self.range.from)?,
            to: end(self.range.to)?,
            ..self.range
        })
    }
}

impl std::fmt::Display for Grain {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        let Range {
            from,
            to,
            count,
            log,
        } = self.range;
        match self.single {
            true => write!(f, "{from:?}"),
            false => write!(f, "{from:?}:{to:?}:{count}{}", if log { "log" } else { "" }),
        }
    }
}
