//! An orbit as a point of a branch or a curve.

use super::chart::Chart;
use super::refine::{RefinedPoint, refined};
use crate::bifurcation::general::{FREE, GeneralPoint, GeneralSolution};
use crate::bifurcation::{Criticality, Label};
use crate::number::Uncertain;
use crate::orbit::{
    Condition, ContinuationPoint, Corrector, Goal, Regular, TestFunction, WatchedFunction,
};
use std::f64::consts::PI;

/// Error of a continuation in an ln |mu| that is zero.
const NEUTRAL: f64 = 1e-6;

/// An orbit as a point, without its parameters.
pub(in crate::bifurcation) fn orbit_point(
    chart: Chart<'_>,
    number: usize,
    orbit: &Regular,
    label: Option<Label>,
) -> GeneralPoint {
    let shooting = chart.usual(&orbit.site).shooting;
    GeneralPoint {
        label,
        symmetry: chart.symmetry(),
        period: Some(Uncertain::new(shooting.period(), f64::INFINITY)),
        ..GeneralPoint::new(
            number,
            orbit.site.at,
            GeneralSolution::Orbit {
                log_multipliers: chart.log_multipliers(orbit),
                neutral: NEUTRAL,
                shooting,
            },
        )
    }
}

/// A special orbit near a site in the last digits, or what is known of it.
pub(super) fn special_orbit(
    chart: Chart<'_>,
    (number, label): (usize, Label),
    near: &Regular,
    (free, meets): (&[usize], &[WatchedFunction]),
) -> (GeneralPoint, Option<Regular>) {
    /// A relative uncertainty of the first parameter with which no other variables are tried.
    const ENOUGH: f64 = 1e-11;
    let kept = || {
        let (chart, there) = chart.keeping(&near.site)?;
        Some((chart, refined(chart.family(), &there, free, meets)?))
    };
    let first = refined(chart.family(), &near.site, free, meets);
    let is_enough = first.as_ref().is_some_and(|sharp| {
        let [first, _] = sharp.at;
        first.uncertainty <= ENOUGH * first.value.abs()
    });
    let better = match is_enough {
        true => None,
        false => kept().filter(|(_, sharp)| {
            let known = |sharp: &RefinedPoint| sharp.at[0].uncertainty;
            first
                .as_ref()
                .is_none_or(|first| known(sharp) < known(first))
        }),
    };
    let point =
        |(chart, sharp): (Chart<'_>, &RefinedPoint)| refined_point((chart, number), sharp, label);
    match (better, first) {
        (Some((chart, sharp)), first) => (point((chart, &sharp)), first.map(|one| one.orbit)),
        (None, Some(first)) => (point((chart, &first)), Some(first.orbit)),
        (None, None) => {
            let rough = orbit_point(chart, number, near, Some(label));
            let unknown = [0, 1].map(|i| match free.contains(&i) {
                true => f64::INFINITY,
                false => 0.0,
            });
            (rough.placed(chart.family(), unknown), None)
        }
    }
}

/// A special orbit in the last digits as a point.
pub(super) fn refined_point(
    (chart, number): (Chart<'_>, usize),
    sharp: &RefinedPoint,
    label: Label,
) -> GeneralPoint {
    GeneralPoint {
        parameters: sharp.at,
        period: Some(sharp.period),
        orbit: Some(sharp.special_orbit(chart.keeps_difference())),
        ..orbit_point(chart, number, &sharp.orbit, Some(label))
    }
}

/// An orbit beside a bifurcation in its last digits, and what its largest multiplier is known to; `None` where that is not known.
pub(super) fn sharper(chart: Chart<'_>, number: usize, orbit: &Regular) -> Option<GeneralPoint> {
    /// Error allowed in a step, and the number of standard deviations of noise.
    const FINE: f64 = 1e-15;
    const DEVIATIONS: f64 = 5.0;
    let mut fine = Corrector::new(chart.family(), FINE).ok()?;
    // Across the branch: beside a Hopf point it may be all but vertical.
    let held = Condition::Plane(orbit.along.first()?, &orbit.site);
    let site = orbit.site.clone();
    let sharp = fine.correct(site, &[FREE], &[held], Goal::SHARP).ok()?;
    let largest = *sharp.multipliers()?.first()?;
    let condition = match largest.arg.abs() {
        _ if chart.grows_across(&sharp, largest.ln_abs) => TestFunction::Transverse,
        0.0 => TestFunction::Fold,
        PI => TestFunction::Doubling,
        _ => TestFunction::Torus,
    };
    let noise = fine.noise_of(condition, &sharp, &[FREE], held)?;
    let part = DEVIATIONS * noise / condition.of(&sharp.spectrum).abs();
    let mut point = orbit_point(chart, number, &sharp, None);
    if let GeneralSolution::Orbit {
        neutral,
        log_multipliers,
        ..
    } = &mut point.solution
    {
        *neutral = part * log_multipliers.first()?.abs();
    }
    Some(point)
}

impl GeneralPoint {
    /// With which way the bifurcation goes, where it has a form that says so.
    pub(super) fn classified(mut self, way: Option<(Uncertain, Criticality)>) -> Self {
        let sure = way.filter(|(coefficient, _)| coefficient.uncertainty.is_finite());
        self.criticality = way.map(|(_, criticality)| criticality);
        self.coefficient = sure.map(|(coefficient, _)| coefficient.value);
        self.coefficient_uncertainty = sure.map(|(coefficient, _)| coefficient.uncertainty);
        self
    }
}

/// The sum of the two multipliers whose product is nearest to 1.
pub(super) fn sum_of_pair(orbit: &Regular) -> f64 {
    TestFunction::Trace(0.0).of(&orbit.spectrum)
}

/// ln of the period and the coordinates, by which orbits of one curve are compared.
pub(super) fn pass(site: &ContinuationPoint) -> [f64; 3] {
    [site.at[0], site.at[1], site.shooting.period().ln()]
}
