//! A special orbit once more, by an unlike method.
//!
//! Pitchforks of orbits are found in another formulation too. Tops and zeros of cubic coefficients have no condition of their
//! own, and no second method here.

use super::loadings::with_system;
use super::refine::SpecialOrbit;
use crate::bifurcation::general::GeneralSystem;
use crate::bifurcation::{Parameter, Special, UserFunction};
use crate::error::{Error, Result};
use crate::field::Vector;
use crate::integrate::{Choice, MAX_STEPS, Tolerances};
use crate::orbit::{
    Condition, ContinuationPoint, Corrector, Goal, InterfaceSystem, ParametrisedField, Regular,
    ShootingNodes, TangentVector, TestFunction, Tracer, WatchedFunction, of_digits,
};

/// Significant digits of the nodes that the second method begins with; more where it does not find its way from fewer.
const DIGITS: [i32; 3] = [4, 6, 8];
/// What the second method is asked for in a step.
const TOLERANCE: f64 = 1e-12;

/// Relative differences in V_H, K and the period between a special point of orbits and the same one by another method. That
/// begins from the first one's nodes, cut to a few digits, and shares nothing else with it. `None` for points that are no
/// orbit's, and for tops, which have no condition of their own. The functions are those of the request.
///
/// # Errors
/// As of [`GeneralSystem::crosscheck`].
pub fn crosscheck(
    (slab, watch): (&InterfaceSystem, &[UserFunction]),
    special: &Special,
    method: Choice,
) -> Result<Option<[f64; 3]>> {
    let Some(orbit) = &special.orbit else {
        return Ok(None);
    };
    let period = special.period.map_or(f64::NAN, |period| period.value);
    let first = [special.driving.value, special.stiffness.value, period];
    let second = with_system((slab, watch), Parameter::Driving, |system| {
        system.crosscheck(orbit, method)
    })?;
    Ok(Some([0, 1, 2].map(|i| second[i] / first[i] - 1.0)))
}

impl GeneralSystem<'_> {
    /// The parameters and the period of a special orbit once more, by an unlike method. That begins from the first one's nodes, cut
    /// to a few digits, and shares nothing else with it.
    ///
    /// # Errors
    /// [`Error::NotConverged`] where the second method does not find the orbit; those of the method.
    pub fn crosscheck(&self, orbit: &SpecialOrbit, method: Choice) -> Result<[f64; 3]> {
        let dimension = orbit.nodes.first().map_or(0, Vec::len);
        let across = WatchedFunction::TestFunction(TestFunction::Transverse);
        let alike = self.alike.filter(|alike| alike.dimension() == dimension);
        match self.difference {
            Some(difference) if orbit.meets.contains(&across) => {
                pitchfork(difference, orbit, method)
            }
            Some(difference) if orbit.in_difference_chart => second(difference, orbit, method),
            _ => second(alike.unwrap_or(self.family), orbit, method),
        }
    }
}

/// The parameters and the period of a special orbit of a family, by the second method.
fn second(
    family: &dyn ParametrisedField,
    orbit: &SpecialOrbit,
    method: Choice,
) -> Result<[f64; 3]> {
    let conditions: Vec<_> = orbit
        .meets
        .iter()
        .map(|exactly| exactly.condition())
        .collect();
    let tolerances = Tolerances::equal(TOLERANCE)?;
    let mut corrector = Corrector::by(family, Tracer::new(method, tolerances, MAX_STEPS)?);
    let found = DIGITS.iter().find_map(|&digits| {
        let site = cut(orbit, digits);
        corrector
            .correct(site, &orbit.free, &conditions, Goal::SHARP)
            .ok()
    });
    found_again(family, found)
}

/// The same at a pitchfork, in another formulation too: there an orbit closes on which the interfaces differ by next to nothing,
/// so that how much they do is free.
fn pitchfork(
    family: &dyn ParametrisedField,
    orbit: &SpecialOrbit,
    method: Choice,
) -> Result<[f64; 3]> {
    /// ln D at the first node: far below rounding, and far above the smallest number.
    const FAINT: f64 = -300.0;
    let tolerances = Tolerances::equal(TOLERANCE)?;
    let mut corrector = Corrector::by(family, Tracer::new(method, tolerances, MAX_STEPS)?);
    let others = orbit
        .meets
        .iter()
        .filter(|meets| **meets != WatchedFunction::TestFunction(TestFunction::Transverse));
    let others: Vec<Condition<'_>> = others.map(|exactly| exactly.condition()).collect();
    let mut found = |digits: i32| {
        let ContinuationPoint { shooting, at } = cut(orbit, digits);
        let field = family.field(at);
        let (mut nodes, mut faint) = (Vec::new(), FAINT);
        for (x, &duration) in shooting.nodes.iter().zip(&shooting.durations) {
            let node = Vector::from_column_slice(&[x[0], x[1], faint]);
            let end = corrector.tracer.flow(&field, &node, duration, None).ok()?;
            faint = end[2];
            nodes.push(node);
        }
        drop(field);
        let shift = TangentVector {
            nodes: vec![Vector::from_column_slice(&[0.0, 0.0, 1.0]); nodes.len()],
            durations: vec![0.0; nodes.len()],
            parameters: [0.0; 2],
        };
        let durations = shooting.durations;
        let shooting = ShootingNodes { nodes, durations };
        let site = ContinuationPoint { shooting, at };
        let mut conditions = vec![Condition::Plane(&shift, &site)];
        conditions.extend(&others);
        corrector
            .correct(site.clone(), &orbit.free, &conditions, Goal::SHARP)
            .ok()
    };
    let found = DIGITS.iter().find_map(|&digits| found(digits));
    found_again(family, found)
}

/// The parameters and the period of what was found.
fn found_again(family: &dyn ParametrisedField, found: Option<Regular>) -> Result<[f64; 3]> {
    let again = found.ok_or(Error::NotConverged {
        what: "the special orbit, by the second method",
        iterations: Goal::SHARP.iterations,
        residual: f64::INFINITY,
        tolerance: Goal::SHARP.done,
    })?;
    let [first, second] = family.parameters(again.site.at);
    Ok([first, second, again.site.shooting.period()])
}

/// The orbit with only so many digits left.
fn cut(orbit: &SpecialOrbit, digits: i32) -> ContinuationPoint {
    let mut at = orbit.at;
    // What is not free is given.
    for &i in &orbit.free {
        at[i] = of_digits(digits, at[i]);
    }
    ContinuationPoint {
        shooting: ShootingNodes::of_digits(digits, &orbit.nodes, &orbit.durations),
        at,
    }
}
