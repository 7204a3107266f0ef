//! An orbit as a point of a branch or a curve.

use super::{GeneralPoint, GeneralSolution};
use crate::bifurcation::orbits::refined;
use crate::bifurcation::{Criticality, Label};
use crate::number::Uncertain;
use crate::orbit::{ParametrisedField, Regular, TestFunction, WatchedFunction};

/// What the accuracy of a continuation leaves of ln |mu| that is zero.
pub(super) const NEUTRAL: f64 = 1e-6;

/// An orbit as a point, without its parameters.
pub(super) fn orbit_point(number: usize, orbit: &Regular, label: Option<Label>) -> GeneralPoint {
    let shooting = orbit.site.shooting.clone();
    GeneralPoint {
        label,
        period: Some(Uncertain::new(shooting.period(), f64::INFINITY)),
        ..GeneralPoint::new(
            number,
            orbit.site.at,
            GeneralSolution::Orbit {
                log_multipliers: orbit.log_multipliers(),
                neutral: NEUTRAL,
                shooting,
            },
        )
    }
}

/// A special orbit near a site in the last digits, or what is known of it.
pub(super) fn special_orbit(
    family: &dyn ParametrisedField,
    (number, label): (usize, Label),
    near: &Regular,
    (free, meets): (&[usize], &[WatchedFunction]),
) -> (GeneralPoint, Option<Regular>) {
    let Some(sharp) = refined(family, &near.site, free, meets) else {
        let rough = orbit_point(number, near, Some(label));
        let unknown = [0, 1].map(|i| {
            if free.contains(&i) {
                f64::INFINITY
            } else {
                0.0
            }
        });
        return (rough.placed(family, unknown), None);
    };
    let point = GeneralPoint {
        parameters: sharp.at,
        period: Some(sharp.period),
        orbit: Some(sharp.special_orbit()),
        ..orbit_point(number, &sharp.orbit, Some(label))
    };
    (point, Some(sharp.orbit))
}

impl GeneralPoint {
    /// With which way the bifurcation goes.
    pub(super) fn classified(
        mut self,
        (coefficient, criticality): (Uncertain, Criticality),
    ) -> Self {
        let known = coefficient.uncertainty.is_finite();
        self.criticality = Some(criticality);
        self.coefficient = known.then_some(coefficient.value);
        self.coefficient_uncertainty = known.then_some(coefficient.uncertainty);
        self
    }
}

/// The sum of the two multipliers whose product is nearest to 1.
pub(super) fn sum_of_pair(orbit: &Regular) -> f64 {
    TestFunction::Trace(0.0).of(&orbit.spectrum)
}
