//! Orbits at which several multipliers reach modulus 1 together, as in networks of equal parts.
//!
//! The test functions are products, and keep their sign where an even number of factors vanishes at once. So the numbers of multipliers
//! outside the unit circle are compared from orbit to orbit; where no test function tells why they differ, the multiplier that is the next to leave
//! it is followed to modulus 1.

use super::branches::new_corrector;
use super::chart::Chart;
use super::orbit_point::orbit_point;
use super::refine::refined;
use crate::bifurcation::Label;
use crate::bifurcation::general::{FREE, GeneralPoint};
use crate::number::Uncertain;
use crate::orbit::{
    Condition, ContinuationPoint, Goal, ParametrisedField, Regular, TestFunction, WatchedFunction,
};
use std::f64::consts::PI;

/// ln |mu| nearer to 0 has no certain sign on the way, and in the last digits.
const CERTAIN: f64 = 1e-6;
const SHARP: f64 = 1e-10;
/// ln |mu| of the multipliers that are there together, where the first of them is 0.
const TOGETHER: f64 = 1e-4;
/// Angles that differ by less are the same: two real multipliers that are equal but for rounding look like a pair.
const SAME_ANGLE: f64 = 1e-3;
/// Bisections, to this part of the step.
const BISECTIONS: usize = 40;
const ENDED: f64 = 1e-9;

/// The multipliers of an orbit, from one to the next.
#[derive(Debug, Default)]
pub(super) struct Outside {
    /// The last orbit at which all had a certain side, and how many were outside.
    last: Option<(ContinuationPoint, usize)>,
    /// By how many the zeros since then may have changed that.
    explained: usize,
}

/// Where several are of modulus 1.
pub(super) struct Together {
    /// The orbit there, but for its last digits.
    pub orbit: Regular,
    /// The coordinate.
    at: Uncertain,
    label: Label,
    /// How many.
    count: usize,
}

impl Together {
    /// As a special point of a branch.
    pub fn point(self, number: usize, chart: Chart<'_>) -> GeneralPoint {
        let Together {
            orbit,
            at,
            label,
            count,
        } = self;
        let which = match label {
            Label::Bp => "that are 1",
            Label::Pd => "that are -1",
            _ => "of modulus 1",
        };
        let point = orbit_point(chart, number, &orbit, Some(label));
        let point = GeneralPoint {
            at: [at.value, point.at[1]],
            note: Some(format!(
                "multipliers {which}: {count}; what branches off is not followed"
            )),
            ..point
        };
        point.placed(chart.family(), [at.uncertainty, 0.0])
    }
}

/// How many are outside the unit circle; `None` where one has no certain side.
fn outside(log_multipliers: &[f64]) -> Option<usize> {
    let certain = log_multipliers.iter().all(|x| x.abs() > CERTAIN);
    certain.then(|| log_multipliers.iter().filter(|x| **x > 0.0).count())
}

impl Outside {
    /// A test function is zero.
    pub fn passes(&mut self, test_function: TestFunction) {
        self.explained += match test_function {
            TestFunction::Torus => 2,
            _ => 1,
        };
    }

    /// The next orbit: where on the way to it several multipliers were of modulus 1, if that is not explained.
    pub fn come_to(&mut self, family: &dyn ParametrisedField, next: &Regular) -> Option<Together> {
        let now = outside(&next.log_multipliers())?;
        let explained = std::mem::take(&mut self.explained);
        let (from, before) = self.last.replace((next.site.clone(), now))?;
        let differ = now.abs_diff(before);
        if differ < 2 || differ <= explained {
            return None;
        }
        located(family, (&from, before), (&next.site, now))
    }
}

/// The orbit at a coordinate, near another one.
fn orbit_at(
    family: &dyn ParametrisedField,
    near: &ContinuationPoint,
    coordinate: f64,
) -> Option<Regular> {
    let mut corrector = new_corrector(family).ok()?;
    let held = [Condition::Parameter(FREE, coordinate)];
    let site = ContinuationPoint {
        at: [coordinate, near.at[1]],
        ..near.clone()
    };
    corrector.correct(site, &[FREE], &held, Goal::STEP).ok()
}

fn located(
    family: &dyn ParametrisedField,
    (from, before): (&ContinuationPoint, usize),
    (to, now): (&ContinuationPoint, usize),
) -> Option<Together> {
    let k = before.min(now);
    let outside_at = |orbit: &Regular| orbit.log_multipliers().get(k).map(|x| *x > 0.0);
    let begins_outside = before > now;
    let (mut a, mut b) = (from.at[FREE], to.at[FREE]);
    let step = (b - a).abs();
    let mut orbit = orbit_at(family, from, 0.5 * (a + b))?;
    for _ in 0..BISECTIONS {
        if outside_at(&orbit)? == begins_outside {
            a = orbit.site.at[FREE];
        } else {
            b = orbit.site.at[FREE];
        }
        if (b - a).abs() <= ENDED * step {
            break;
        }
        orbit = orbit_at(family, &orbit.site, 0.5 * (a + b))?;
    }
    let middle = 0.5 * (a + b);
    let off = bounded(family, &orbit.site, (k, middle), (ENDED * step, step))?;
    let (label, count) = together(&orbit)?;
    Some(Together {
        orbit,
        at: Uncertain::new(middle, off),
        label,
        count,
    })
}

/// What happens to an orbit of which several multipliers are of modulus 1, and how many they are.
fn together(orbit: &Regular) -> Option<(Label, usize)> {
    let multipliers = orbit.multipliers()?;
    let there = multipliers.iter().filter(|one| one.ln_abs.abs() < TOGETHER);
    let angles: Vec<f64> = there.map(|one| one.arg.abs()).collect();
    let all_at = |angle: f64| angles.iter().all(|arg| (arg - angle).abs() < SAME_ANGLE);
    let label = if all_at(0.0) {
        Label::Bp
    } else if all_at(PI) {
        Label::Pd
    } else {
        Label::Tr
    };
    Some((label, angles.len()))
}

/// Whether two real multipliers or more are 1, or -1, together: their product is 1 then, as that of a pair at a torus bifurcation.
pub(super) fn is_real(orbit: &Regular) -> bool {
    together(orbit).is_some_and(|(label, count)| label != Label::Tr && count > 1)
}

/// How far from a coordinate on both sides the k-th multiplier is certainly on different sides of the unit circle, by orbits in their last
/// digits.
fn bounded(
    family: &dyn ParametrisedField,
    near: &ContinuationPoint,
    (k, middle): (usize, f64),
    (least, most): (f64, f64),
) -> Option<f64> {
    let side = |coordinate: f64| {
        let held = [WatchedFunction::Value(FREE, coordinate)];
        let orbit = refined(family, near, &[FREE], &held)?.orbit;
        let log = *orbit.log_multipliers().get(k)?;
        (log.abs() > SHARP).then_some(log > 0.0)
    };
    let mut off = least;
    while off < most {
        if let (Some(before), Some(behind)) = (side(middle - off), side(middle + off))
            && before != behind
        {
            return Some(off);
        }
        off *= 10.0;
    }
    None
}
