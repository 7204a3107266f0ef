//! A system whose equations were read, over one or two of its parameters.

use super::family::{ParametrisedField, across_in_units};
use super::settle::axis;
use crate::error::{Error, Result};
use crate::field::{Matrix, Vector, place};
use crate::integrate::AnyField;
use crate::model::TextSystem;
use std::borrow::Cow;

/// How a parameter is measured along a continuation.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Coordinate {
    /// By its logarithm: of what is positive.
    Logarithm,
    /// In this unit.
    Linear(f64),
}

impl Coordinate {
    /// That suits these values: the logarithm where all are positive, else the unit in which they span some steps.
    pub fn of(values: &[f64]) -> Self {
        /// Steps of length 1 across the values.
        const STEPS: f64 = 5.0;
        if values.iter().all(|&x| x > 0.0) {
            return Coordinate::Logarithm;
        }
        let ends = values
            .iter()
            .fold((0.0, 0.0), |(least, most): (f64, f64), &x| {
                (least.min(x), most.max(x))
            });
        let width = ends.1 - ends.0;
        Coordinate::Linear(if width > 0.0 { width / STEPS } else { 1.0 })
    }

    /// The coordinate of a parameter.
    pub fn inward(self, parameter: f64) -> f64 {
        match self {
            Coordinate::Logarithm => parameter.ln(),
            Coordinate::Linear(unit) => parameter / unit,
        }
    }

    /// The parameter with this coordinate.
    pub fn outward(self, coordinate: f64) -> f64 {
        match self {
            Coordinate::Logarithm => coordinate.exp(),
            Coordinate::Linear(unit) => coordinate * unit,
        }
    }

    /// The derivative of the parameter in its coordinate.
    pub fn scale(self, coordinate: f64) -> f64 {
        match self {
            Coordinate::Logarithm => coordinate.exp(),
            Coordinate::Linear(unit) => unit,
        }
    }
}

/// A [`TextSystem`] over one or two of its parameters, the others being held.
#[derive(Debug, Clone, Copy)]
pub struct OverText<'s> {
    system: &'s TextSystem,
    plane: [usize; 2],
    coordinates: [Coordinate; 2],
}

impl<'s> OverText<'s> {
    /// Over one parameter: the second coordinate changes nothing.
    ///
    /// # Errors
    /// [`Error::Parameter`] for a name that is none, and for a system of more variables than fields may have.
    pub fn one(system: &'s TextSystem, name: &str, coordinate: Coordinate) -> Result<Self> {
        AnyField::of_text(Cow::Borrowed(system))?;
        let place = place(system.parameter_names(), name)?;
        Ok(OverText {
            system,
            plane: [place; 2],
            coordinates: [coordinate; 2],
        })
    }

    /// Over two different ones.
    ///
    /// # Errors
    /// As of [`OverText::one`].
    pub fn two(
        system: &'s TextSystem,
        names: [&str; 2],
        coordinates: [Coordinate; 2],
    ) -> Result<Self> {
        let [first, second] = names.map(|name| Self::one(system, name, Coordinate::Logarithm));
        let plane = [first?.plane[0], second?.plane[0]];
        if plane[0] == plane[1] {
            let must = "two different parameters";
            return Err(Error::parameter("the plane of parameters", names[0], must));
        }
        Ok(OverText {
            system,
            plane,
            coordinates,
        })
    }
}

impl ParametrisedField for OverText<'_> {
    fn dimension(&self) -> usize {
        self.system.states().len()
    }

    fn plane(&self) -> [usize; 2] {
        self.plane
    }

    fn field(&self, at: [f64; 2]) -> AnyField<'_> {
        let mut there = self.system.clone();
        let [first, second] = self.parameters(at);
        there.put(self.plane[1], second);
        there.put(self.plane[0], first);
        AnyField::of_text(Cow::Owned(there)).expect("as many variables as fields may have")
    }

    fn parameters(&self, at: [f64; 2]) -> [f64; 2] {
        [0, 1].map(|i| self.coordinates[i].outward(at[i]))
    }

    fn scale(&self, at: [f64; 2]) -> [f64; 2] {
        let [first, second] = [0, 1].map(|i| self.coordinates[i].scale(at[i]));
        let same = self.plane[0] == self.plane[1];
        [first, if same { 0.0 } else { second }]
    }

    fn is_any_system(&self) -> bool {
        true
    }

    fn across(&self, _x: &Vector, flow: &Vector) -> Matrix {
        across_in_units(&vec![1.0; flow.len()], flow, self.system.phase().is_some())
    }

    fn normal(&self, _x: &Vector, flow: Vector) -> Vector {
        // Under a forcing planes of one phase: the nodes keep theirs, and the time between them is what the phases say.
        match self.system.phase() {
            None => flow,
            Some((place, _)) => axis(flow.len(), place),
        }
    }

    fn units(&self) -> Option<&[f64]> {
        let sizes = self.system.sizes();
        sizes.iter().any(|size| *size != 1.0).then_some(sizes)
    }
}
