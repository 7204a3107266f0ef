//! Distinguishes folds from pitchforks on a step along a branch of orbits: at a fold the parameter turns, at a pitchfork it does not.

use crate::bifurcation::general::FREE;
use crate::orbit::{DirectedPoint, TestFunction};

/// Slopes of the parameter along the branch below this are rounding. Along a canard the parameter turns with such slopes.
const ROUNDING: f64 = 1e-8;

/// Whether the parameter has the same sense at both ends of a step.
pub(super) fn goes_on(from: &DirectedPoint, to: &DirectedPoint) -> bool {
    let [from, to] = [from, to].map(|one| one.direction.parameters[FREE]);
    from * to > 0.0 && from.abs().min(to.abs()) > ROUNDING
}

/// Whether the parameter turns at an orbit with a multiplier 1, on the step from one point to another.
pub(super) fn turns(from: &DirectedPoint, at: &DirectedPoint, to: &DirectedPoint) -> bool {
    /// The slope at a fold, in parts of those at the ends of the step, where it changes its sign on the step, and where it is seen to turn twice.
    const ONCE: f64 = 0.02;
    const TWICE: f64 = 1e-3;
    let [from, at, to] = [from, at, to].map(|one| one.direction.parameters[FREE]);
    let [least, most] = [from.abs().min(to.abs()), from.abs().max(to.abs())];
    // Just behind a fold the slope is small and grows.
    let goes_on = from * to > 0.0 && from * at > 0.0 && 2.0 * at.abs() >= least;
    let part = if from * to < 0.0 { ONCE } else { TWICE };
    most < ROUNDING || (!goes_on && at.abs() < part * most)
}

/// Whether the parameter turns on a step along which a multiplier is near 1, and none passes it: so it is where orbits meet their mirror images.
pub(super) fn turns_without_fold(from: &DirectedPoint, to: &DirectedPoint) -> bool {
    /// Of the test function of folds: below this its sign is rounding.
    const SMALL: f64 = 1e-6;
    let slopes = [from, to].map(|one| one.direction.parameters[FREE]);
    let folds = [from, to].map(|one| {
        let spectrum = &one.here.spectrum;
        TestFunction::Fold.of(spectrum) / TestFunction::Fold.size(spectrum)
    });
    slopes[0] * slopes[1] < 0.0
        && slopes.iter().all(|slope| slope.abs() > ROUNDING)
        && folds[0] * folds[1] > 0.0
        && folds.iter().all(|fold| fold.abs() > SMALL)
        && [from, to].iter().all(|one| one.here.branches_nearby())
}
