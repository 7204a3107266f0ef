//! Orbits in the units in which their system moves by about 1, and back in its own.

use super::{Crosscheck, Orbit, OrbitAccuracy};
use crate::integrate::MotionUnits;
use crate::number::Uncertain;

impl MotionUnits {
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
