//! Systems from files in the units in which they move by about 1.

use super::model::TextModel;
use crate::error::Result;
use crate::field::Vector;
use crate::integrate::{MotionUnits, Tolerances};
use crate::number::{Interval, Uncertain};
use crate::orbit::{Crosscheck, Orbit, OrbitAccuracy};
use serde_json::{Value, json};

impl MotionUnits {
    /// Of a model's run from here; interfaces keep theirs, in which all are of order 1.
    ///
    /// # Errors
    /// Those of the field.
    pub fn of(model: &TextModel, start: &Vector) -> Result<Self> {
        match model.slab {
            Some(_) => Ok(Self::given(start.len())),
            None => Self::measured(&model.system, start),
        }
    }

    /// Of a box in which equilibria are looked for, where no start is known: a part of its widths, and the fastest rate in its middle.
    ///
    /// # Errors
    /// Those of the field.
    pub fn within(model: &TextModel, ranges: &[Interval]) -> Result<Self> {
        if model.slab.is_some() {
            return Ok(Self::given(ranges.len()));
        }
        let middle = ranges.iter().map(|range| 0.5 * (range.lo() + range.hi()));
        let middle = Vector::from_iterator(ranges.len(), middle);
        let widths: Vec<f64> = ranges.iter().map(|range| range.hi() - range.lo()).collect();
        Self::in_box(&model.system, &middle, &widths)
    }

    /// Tolerances in these units: an absolute one in the system's own holds for the state with the largest unit.
    pub fn inward_tolerances(&self, tolerances: Tolerances, atol_is_given: bool) -> Tolerances {
        let mut inward = tolerances.stepping(tolerances.max_step / self.time);
        if atol_is_given {
            inward.atol /= self.sizes.iter().copied().fold(0.0, f64::max);
        }
        inward
    }

    /// The absolute tolerance as it is told: one number that is given, or of interfaces; else what each state may err by in its own unit.
    pub fn told_atol(&self, model: &TextModel, atol: f64, atol_is_given: bool) -> Value {
        match atol_is_given || model.slab.is_some() {
            true => json!(atol),
            false => json!(
                self.sizes
                    .iter()
                    .map(|size| size * atol)
                    .collect::<Vec<_>>()
            ),
        }
    }

    /// The accuracy of an orbit in these units.
    pub fn inward_accuracy(&self, accuracy: OrbitAccuracy, atol_is_given: bool) -> OrbitAccuracy {
        OrbitAccuracy {
            tolerances: self.inward_tolerances(accuracy.tolerances, atol_is_given),
            ..accuracy
        }
    }

    /// An orbit in the system's own units.
    pub fn outward_orbit(&self, mut orbit: Orbit) -> Orbit {
        let time = self.time;
        let uncertain =
            |x: Uncertain, unit: f64| Uncertain::new(x.value * unit, x.uncertainty * unit);
        let parts = orbit.point.iter().zip(&self.sizes);
        // In units of 1 + |y| here and there.
        let wider = parts.map(|(x, size)| (size + (x * size).abs()) / (1.0 + (x * size).abs()));
        orbit.point_uncertainty *= wider.fold(0.0, f64::max);
        orbit.period = uncertain(orbit.period, time);
        orbit.point_time *= time;
        orbit.durations.iter_mut().for_each(|t| *t *= time);
        for state in std::iter::once(&mut orbit.point).chain(&mut orbit.nodes) {
            state
                .iter_mut()
                .zip(&self.sizes)
                .for_each(|(x, size)| *x *= size);
        }
        for (extremes, size) in orbit.extremes.iter_mut().zip(&self.sizes) {
            *extremes = extremes.map(|x| uncertain(x, *size));
        }
        orbit.stress_min = uncertain(orbit.stress_min, self.sizes[0]);
        orbit.stress_max = uncertain(orbit.stress_max, self.sizes[0]);
        orbit
    }

    /// An orbit in these units, for what does not look at its bounds.
    pub fn inward_orbit(&self, orbit: &Orbit) -> Orbit {
        let inverse = MotionUnits {
            sizes: self.sizes.iter().map(|size| 1.0 / size).collect(),
            time: 1.0 / self.time,
        };
        inverse.outward_orbit(orbit.clone())
    }

    /// The same orbit by a second method.
    pub fn outward_crosscheck(&self, crosscheck: Crosscheck) -> Crosscheck {
        Crosscheck {
            orbit: self.outward_orbit(crosscheck.orbit),
            period_difference: crosscheck.period_difference * self.time,
            ..crosscheck
        }
    }
}
