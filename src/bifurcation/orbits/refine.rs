//! Refining a special point: its defining condition solved to the last digits, with an error budget.
//!
//! It is solved several times, with other nodes and other tolerances. What the solutions differ by shows what the method does;
//! but few solutions may agree by chance, so the noise of the flow, as the equations carry it to the point, counts as well.
//! What can't be solved more than once claims nothing.

use crate::bifurcation::general::in_order;
use crate::integrate::Choice;
use crate::number::Uncertain;
use crate::orbit::{
    ContinuationPoint, Corrector, Goal, Noise, ParametrisedField, Regular, WatchedFunction,
};

/// The orbit of a special point.
#[derive(Debug, Clone, PartialEq)]
#[non_exhaustive]
pub struct SpecialOrbit {
    /// Whether its variables are those of the difference chart: (tau, ln psi_2, ln D).
    pub(super) in_difference_chart: bool,
    /// Its nodes, in (tau, ln psi) or (tau, ln psi_1, ln psi_2) otherwise.
    pub(super) nodes: Vec<Vec<f64>>,
    pub(super) durations: Vec<f64>,
    pub(super) at: [f64; 2],
    /// What is zero there, and the parameters that are free for it.
    pub(super) meets: Vec<WatchedFunction>,
    pub(super) free: Vec<usize>,
}

impl SpecialOrbit {
    /// Its nodes, in (tau, ln psi) or (tau, ln psi_1, ln psi_2), and the durations from each to the next. Where the interfaces
    /// come so near each other that these lose their difference, in (tau, ln psi_2, ln(psi_1 - psi_2)).
    pub fn nodes(&self) -> (&[Vec<f64>], &[f64]) {
        (&self.nodes, &self.durations)
    }

    /// A point over the plane of its parameters in the other order.
    pub(super) fn exchanged(self) -> Self {
        let meets = |watch: WatchedFunction| match watch {
            WatchedFunction::Turn(i) => WatchedFunction::Turn(1 - i),
            WatchedFunction::Value(i, value) => WatchedFunction::Value(1 - i, value),
            WatchedFunction::TestFunction(_) | WatchedFunction::UserFunction(_) => watch,
        };
        SpecialOrbit {
            at: in_order(1, self.at),
            meets: self.meets.into_iter().map(meets).collect(),
            free: self.free.into_iter().map(|i| 1 - i).collect(),
            ..self
        }
    }
}

/// A special orbit.
#[derive(Debug, Clone)]
pub struct RefinedPoint {
    /// The best solution.
    pub orbit: Regular,
    /// The parameters (not their coordinates).
    pub at: [Uncertain; 2],
    /// The period.
    pub period: Uncertain,
    meets: Vec<WatchedFunction>,
    free: Vec<usize>,
}

/// Tolerances of the solutions, by Taylor's method and by an implicit one, which rounds more; and the part of their arcs by which the nodes of all but
/// the first are moved.
const SOLUTIONS: [([f64; 2], f64); 3] = [
    ([1e-16, 1e-13], 0.0),
    ([1e-15, 2e-13], 0.37),
    ([4e-15, 4e-13], 0.71),
];
/// The solutions' largest difference, and standard deviations of the noise, count so many times.
const SPREAD: f64 = 2.0;
const DEVIATIONS: f64 = 3.0;
/// Rounding, in units of the value: of the sum of durations, and of a parameter beside that of its logarithm.
const ROUNDING: f64 = 4.0 * f64::EPSILON;

/// The orbit near a site where all these are zero, in the last digits.
pub fn refined(
    family: &dyn ParametrisedField,
    near: &ContinuationPoint,
    free: &[usize],
    meets: &[WatchedFunction],
) -> Option<RefinedPoint> {
    let conditions: Vec<_> = meets.iter().map(|exactly| exactly.condition()).collect();
    let mut solutions: Vec<Regular> = Vec::new();
    for (tolerances, part) in SOLUTIONS {
        let mut corrector = Corrector::with_tolerances(family, tolerances).ok()?;
        let begin = solutions.first().map_or(near, |first| &first.site);
        corrector.suit(begin).ok()?;
        let is_stiff = corrector.tracer.name() == Choice::Radau.name();
        let field = family.field(begin.at);
        let shooting = if solutions.is_empty() && is_stiff {
            // The nodes of a branch stand aside of its jumps.
            begin.shooting.clone()
        } else if solutions.is_empty() {
            // Few long arcs round least often.
            begin.shooting.meshed(&mut corrector.tracer, &field).ok()?
        } else {
            let shifted = begin.shooting.shifted(&mut corrector.tracer, &field, part);
            shifted.ok()?
        };
        drop(field);
        let site = ContinuationPoint {
            shooting,
            at: begin.at,
        };
        match corrector.correct(site, free, &conditions, Goal::SHARP) {
            Ok(solution) => solutions.push(solution),
            Err(_) if solutions.is_empty() => return None,
            Err(_) => {}
        }
    }
    let alone = solutions.len() < SOLUTIONS.len();
    let mut corrector = Corrector::with_tolerances(family, SOLUTIONS[0].0).ok()?;
    let noise = corrector.noise(&solutions[0], free, &conditions);
    let noise = noise.unwrap_or(Noise::UNKNOWN);
    let all = |of: &dyn Fn(&Regular) -> f64, noise: f64, rounding: f64| {
        let first = of(&solutions[0]);
        let spread = solutions.iter().map(|s| (of(s) - first).abs());
        let spread = spread.fold(0.0, f64::max);
        let uncertainty = SPREAD * spread + DEVIATIONS * noise + rounding * first.abs();
        Uncertain::new(first, if alone { f64::INFINITY } else { uncertainty })
    };
    let fixed = |i: usize| {
        let by_value = meets
            .iter()
            .any(|m| matches!(m, WatchedFunction::Value(j, _) if *j == i));
        by_value || !free.contains(&i)
    };
    let parameter = |i: usize| {
        let of = |s: &Regular| family.parameters(s.site.at)[i];
        let rounding = ROUNDING + f64::EPSILON * solutions[0].site.at[i].abs();
        if fixed(i) {
            let given = of(&solutions[0]);
            return Uncertain::new(given, rounding * given.abs());
        }
        let scale = family.scale(solutions[0].site.at)[i];
        all(&of, noise.parameters[i] * scale.abs(), rounding)
    };
    let period = solutions[0].site.shooting.period();
    Some(RefinedPoint {
        at: [parameter(0), parameter(1)],
        period: all(
            &|s| s.site.shooting.period(),
            noise.period * period,
            ROUNDING,
        ),
        meets: meets.to_vec(),
        free: free.to_vec(),
        orbit: solutions.swap_remove(0),
    })
}

impl RefinedPoint {
    /// What is needed to compute it once more.
    pub fn special_orbit(&self, in_difference_chart: bool) -> SpecialOrbit {
        let ContinuationPoint { shooting, at } = &self.orbit.site;
        let nodes = shooting.nodes.iter();
        SpecialOrbit {
            in_difference_chart,
            nodes: nodes.map(|x| x.as_slice().to_vec()).collect(),
            durations: shooting.durations.clone(),
            at: *at,
            meets: self.meets.clone(),
            free: self.free.clone(),
        }
    }
}
