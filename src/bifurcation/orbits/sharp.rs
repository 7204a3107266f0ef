//! A special orbit to the last digits, with its error budget.
//!
//! It is solved several times, with other nodes and other tolerances: what the solutions differ by, and what the last
//! corrections still were, bounds what rounding and the method do. What can't be solved more than once claims nothing.

use crate::number::Uncertain;
use crate::orbit::{Condition, Corrector, Family, Goal, Regular, Site};

/// A special orbit.
#[derive(Debug, Clone)]
pub struct Sharp<const N: usize> {
    /// The best solution.
    pub orbit: Regular<N>,
    /// The parameters (not their coordinates).
    pub at: [Uncertain; 2],
    /// The period.
    pub period: Uncertain,
}

/// Tolerances of the solutions, and the part of their arcs by which the nodes of all but the first are moved.
const SOLUTIONS: [(f64, f64); 3] = [(1e-16, 0.0), (1e-15, 0.37), (4e-15, 0.71)];
/// The solutions' largest difference, and the last corrections, times this.
const SAFETY: f64 = 4.0;
/// Rounding, in units of the value.
const ROUNDING: f64 = 8.0 * f64::EPSILON;

/// The orbit near a site that meets the conditions, in the last digits. Conditions of pace are of no use here: the nodes move.
pub fn sharpened<F: Family<N>, const N: usize>(
    family: &F,
    near: &Site<N>,
    free: &[usize],
    conditions: &[Condition<'_, N>],
) -> Option<Sharp<N>> {
    let mut solutions: Vec<Regular<N>> = Vec::new();
    for (tolerance, part) in SOLUTIONS {
        let mut corrector = Corrector::new(family, tolerance).ok()?;
        let begin = solutions.first().map_or(near, |first| &first.site);
        let field = family.field(begin.at);
        let mut polygon = begin.polygon.clone();
        if solutions.is_empty() {
            polygon = polygon.meshed(&mut corrector.tracer, &*field).ok()?;
        } else {
            polygon = polygon.shifted(&mut corrector.tracer, &*field, part).ok()?;
        }
        drop(field);
        let site = Site {
            polygon,
            at: begin.at,
        };
        match corrector.correct(site, free, conditions, Goal::SHARP) {
            Some(solution) => solutions.push(solution),
            None if solutions.is_empty() => return None,
            None => {}
        }
    }
    let all = |of: &dyn Fn(&Regular<N>) -> f64, fixed: bool| {
        let first = of(&solutions[0]);
        if fixed {
            return Uncertain::new(first, ROUNDING * first.abs());
        }
        let spread = solutions.iter().map(|s| (of(s) - first).abs());
        let spread = spread.fold(0.0, f64::max);
        let last = solutions.iter().map(|s| s.residual).fold(0.0, f64::max);
        let uncertainty = SAFETY * spread + (last + ROUNDING) * first.abs();
        let alone = solutions.len() < SOLUTIONS.len();
        Uncertain::new(first, if alone { f64::INFINITY } else { uncertainty })
    };
    let parameter = |i: usize| {
        let of = |s: &Regular<N>| family.parameters(s.site.at)[i];
        all(&of, !free.contains(&i))
    };
    Some(Sharp {
        at: [parameter(0), parameter(1)],
        period: all(&|s| s.site.polygon.period(), false),
        orbit: solutions.swap_remove(0),
    })
}
