//! Systems from files in the units in which they move by about 1.

use super::model::TextModel;
use serde_json::{Value, json};
use twinslip::error::Result;
use twinslip::field::Vector;
use twinslip::integrate::MotionUnits;
use twinslip::number::Interval;

impl TextModel {
    /// Those of a run from here, rounded; interfaces keep theirs, in which all are of order 1.
    ///
    /// # Errors
    /// Those of the field.
    pub fn motion_units(&self, start: &Vector) -> Result<MotionUnits> {
        Ok(self.motion_units_of_branch(start)?.rounded())
    }

    /// The same as they are: steps along a branch are as long whatever the units of the file.
    ///
    /// # Errors
    /// Those of the field.
    pub fn motion_units_of_branch(&self, start: &Vector) -> Result<MotionUnits> {
        match self.slab {
            Some(_) => Ok(MotionUnits::given(start.len())),
            None => MotionUnits::measured(&self.system, start),
        }
    }

    /// The units of a run from here, in which states may be followed by their logarithms ([`MotionUnits::measured_or_logarithmic`]).
    ///
    /// # Errors
    /// Those of the field.
    pub fn motion_units_of_run(&self, start: &Vector) -> Result<MotionUnits> {
        match self.slab {
            Some(_) => Ok(MotionUnits::given(start.len())),
            None => MotionUnits::measured_or_logarithmic(&self.system, start),
        }
    }

    /// The units of a run in which a state fell below what doubles hold: those of the run, with the logarithms of all states that are factors
    /// of their own rates. `None` where there are no more of these.
    pub fn units_below_doubles(&self, units: &MotionUnits, start: &Vector) -> Option<MotionUnits> {
        if self.slab.is_some() {
            return None;
        }
        let have_logarithms = self.system.have_logarithms();
        units.in_logarithms(start.as_slice(), |i| have_logarithms[i])
    }

    /// Those of a box in which equilibria are looked for, where no start is known: a part of its widths, and the fastest rate in its middle.
    ///
    /// # Errors
    /// Those of the field.
    pub fn motion_units_within(&self, ranges: &[Interval]) -> Result<MotionUnits> {
        if self.slab.is_some() {
            return Ok(MotionUnits::given(ranges.len()));
        }
        let middle = ranges.iter().map(|range| 0.5 * (range.lo() + range.hi()));
        let middle = Vector::from_iterator(ranges.len(), middle);
        let widths: Vec<f64> = ranges.iter().map(|range| range.hi() - range.lo()).collect();
        MotionUnits::in_box(&self.system, &middle, &widths)
    }

    /// The absolute tolerance in words: one number that is given, or of interfaces; else what each state may err by in its own unit.
    pub fn absolute_tolerance(&self, units: &MotionUnits, atol: f64, is_given: bool) -> Value {
        match is_given || self.slab.is_some() {
            true => json!(atol),
            false => json!(
                units
                    .sizes
                    .iter()
                    .map(|size| size * atol)
                    .collect::<Vec<_>>()
            ),
        }
    }
}
