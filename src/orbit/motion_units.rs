//! Orbits in the units in which their system moves by about 1, and back in its own.

use super::{Crosscheck, Orbit, OrbitAccuracy, PhaseResponse, Sensitivity};
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
        let uncertain = |x: Uncertain, state: usize| {
            let error = self.outward_error_of(state, x.value, x.uncertainty);
            Uncertain::new(self.outward_value(state, x.value), error)
        };
        // In units of 1 + |y| here and there.
        let wider = orbit.point.iter().enumerate().map(|(i, &x)| {
            let error = orbit.point_uncertainty * (1.0 + x.abs());
            self.outward_error_of(i, x, error) / (1.0 + self.outward_value(i, x).abs())
        });
        orbit.point_uncertainty = wider.fold(0.0, f64::max);
        orbit.period = self.outward_time(orbit.period);
        orbit.point_time *= time;
        orbit.durations.iter_mut().for_each(|t| *t *= time);
        for state in std::iter::once(&mut orbit.point).chain(&mut orbit.nodes) {
            let each = state.iter_mut().enumerate();
            each.for_each(|(i, x)| *x = self.outward_value(i, *x));
        }
        for (i, extremes) in orbit.extremes.iter_mut().enumerate() {
            *extremes = extremes.map(|x| uncertain(x, i));
            if self.direction(i) < 0.0 {
                extremes.reverse();
            }
        }
        let [stress_min, stress_max] = [orbit.stress_min, orbit.stress_max];
        (orbit.stress_min, orbit.stress_max) = (uncertain(stress_min, 0), uncertain(stress_max, 0));
        if self.direction(0) < 0.0 {
            std::mem::swap(&mut orbit.stress_min, &mut orbit.stress_max);
        }
        orbit
    }

    /// An orbit in these units, for what does not look at its bounds.
    pub fn inward_orbit(&self, orbit: &Orbit) -> Orbit {
        let mut orbit = orbit.clone();
        orbit.period = Uncertain::new(orbit.period.value / self.time, orbit.period.uncertainty);
        orbit.point_time /= self.time;
        orbit.durations.iter_mut().for_each(|t| *t /= self.time);
        for state in std::iter::once(&mut orbit.point).chain(&mut orbit.nodes) {
            let each = state.iter_mut().enumerate();
            each.for_each(|(i, x)| *x = self.inward_value(i, *x));
        }
        orbit
    }

    /// The derivatives of an orbit, with these extremes in these units, in the system's own.
    pub fn outward_sensitivity(
        &self,
        mut found: Sensitivity,
        extremes: &[[Uncertain; 2]],
    ) -> Sensitivity {
        found.period = self.outward_time(found.period);
        for (i, both) in found.extremes.iter_mut().enumerate() {
            for (slope, x) in both.iter_mut().zip(extremes[i]) {
                let unit = match self.signs[i] {
                    0.0 => self.sizes[i],
                    _ => self.outward_value(i, x.value),
                };
                *slope = Uncertain::new(slope.value * unit, slope.uncertainty * unit.abs());
            }
            if self.direction(i) < 0.0 {
                both.reverse();
            }
        }
        found
    }

    /// A phase response in the system's own units.
    pub fn outward_response(&self, mut row: PhaseResponse) -> PhaseResponse {
        row.time *= self.time;
        let each = row.state.iter_mut().zip(&mut row.response).enumerate();
        for (i, (x, z)) in each {
            let outward = self.outward_value(i, *x);
            // Of what is followed by its logarithm a kick is relative to the value.
            let unit = match self.signs[i] {
                0.0 => self.sizes[i],
                _ => outward,
            };
            let factor = self.time / unit;
            *z = Uncertain::new(z.value * factor, z.uncertainty * factor.abs());
            *x = outward;
        }
        row
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
