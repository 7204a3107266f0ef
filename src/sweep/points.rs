//! What there is at the points of a grid.

use super::watch::across;
use crate::equilibrium::Enclosed;
use crate::error::Result;
use crate::field::Vector;
use crate::friction::AnyLaw;
use crate::integrate::{AnyField, MotionUnits};
use crate::model::Loading;
use crate::random::Random;
use crate::section::Surface;
use std::fmt::Debug;

/// Systems by the values of the parameters that vary.
pub trait SystemPoints: Debug + Send + Sync {
    /// The parameters that rows have, dimensionless.
    fn parameters(&self, values: &[f64]) -> Vec<f64>;

    /// The system there, with the start of this number, from 0; random ones are made by the stream.
    ///
    /// # Errors
    /// [`crate::Error::Parameter`] for values outside their domain, and what keeps the start from being found.
    fn at(&self, values: &[f64], start: usize, random: Random) -> Result<SystemPoint>;
}

/// A system at a point of a grid, in the units in which it moves by about 1.
#[derive(Debug)]
pub struct SystemPoint {
    /// These units.
    pub units: MotionUnits,
    /// The vector field.
    pub field: AnyField<'static>,
    /// Where its run starts.
    pub start: Vector,
    /// Which of its returns are recorded.
    pub section: SectionPlace,
    /// Whether the last two variables are of equal parts.
    pub equal_parts: bool,
    /// Two equal interfaces with a law that is built in: many of their runs can be computed at once.
    pub lane: Option<(AnyLaw, Loading)>,
    /// The equations over boxes, where they are known: they certify that a run has come to a stable equilibrium.
    pub enclosed: Option<Enclosure>,
}

/// Equations over boxes.
pub struct Enclosure(pub Box<dyn Enclosed + Send + Sync>);

impl Debug for Enclosure {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        f.write_str("Enclosure")
    }
}

/// Where the section of a run is.
#[derive(Debug, Clone, PartialEq)]
pub enum SectionPlace {
    /// At a place that is known, as is the longest time to wait for a return.
    Known(Surface, f64),
    /// At a place that is known, without a time to wait.
    Untimed(Surface),
    /// In the middle of what this variable swings through.
    Middle(usize),
}

impl SectionPlace {
    /// The place of the section in these units; the system has no time of its own to wait.
    pub fn inward(self, units: &MotionUnits) -> Self {
        match self {
            SectionPlace::Untimed(mut surface) => {
                let size = units.sizes[surface.normal.iamax()];
                surface.offset /= size;
                surface.turn = surface.turn.map(|turn| turn / size);
                SectionPlace::Untimed(surface)
            }
            place => place,
        }
    }

    /// Where a variable, of so many, has a value and falls.
    pub fn at(variable: usize, dimension: usize, value: f64) -> Self {
        SectionPlace::Untimed(across(variable, dimension, value))
    }
}
