//! Whether a test function certainly changes its sign at an orbit of a branch: on both sides of it, by more than the noise.
//!
//! At a fold the parameter turns: on both sides of it, it is less, or it is greater, than at the fold. Where a branch is
//! vertical, as at a degenerate Hopf point, the parameter's slope is noise and changes its sign again and again.

use super::conditions::Condition;
use super::continuation_point::TangentVector;
use super::correct::{Corrector, Regular};
use super::goal::Goal;
use super::orbit_curve::{DirectedPoint, OrbitCurve, PalcSettings, WatchedFunction};
use super::test_function::TestFunction;
use crate::continuation::CurveStep;

/// Values beyond this are no noise. Of turns nothing can be said by their values.
pub(super) const CLEAR: f64 = 1e-5;
/// On steps that are shorter than this part of the orbit's extent they may be noise: beside a homoclinic orbit multipliers change by powers of ten
/// within the last digits of the orbit.
const SHORT: f64 = 1e-6;

/// The distances to both sides that are tried, the nearest first, in units of the step.
const PARTS: [f64; 3] = [0.125, 0.5, 1.0];
/// Standard deviations of what is noise.
const DEVIATIONS: f64 = 5.0;
/// Tolerance with which the sides are looked at, as what steps may err by.
const FINE: f64 = 2e-15;

/// Whether the zero of what is watched, which was landed on at `orbit` on a step, is one.
pub(super) fn certain(
    OrbitCurve {
        corrector,
        settings,
    }: &mut OrbitCurve<'_, '_>,
    (watch, values): (WatchedFunction, [f64; 2]),
    orbit: &Regular,
    step: &CurveStep<DirectedPoint>,
) -> bool {
    match watch {
        WatchedFunction::TestFunction(_)
            if (watch == WatchedFunction::TestFunction(TestFunction::Fold)
                || step.length > SHORT * orbit.site.shooting.extent().min(1.0))
                && values.iter().all(|value| value.abs() > CLEAR) =>
        {
            return true;
        }
        WatchedFunction::Value(..) => return true,
        _ => {}
    }
    let found = if corrector.tracer.differentiates() {
        let fine = Corrector::new(corrector.family, FINE);
        fine.ok()
            .and_then(|mut fine| beside(&mut fine, settings, watch, orbit, step.length))
    } else {
        beside(corrector, settings, watch, orbit, step.length)
    };
    found.unwrap_or_else(|| {
        // By the ends of the step, then, as accurately as these are known.
        let plane = &step.from.direction;
        let mut at = |orbit: &Regular| measured(corrector, settings, watch, orbit, plane);
        let [Some(a), Some(b), Some(middle)] = [at(&step.from.here), at(&step.to.here), at(orbit)]
        else {
            return false;
        };
        changes(watch, a, middle, b) == Some(true)
    })
}

/// What is measured at an orbit, and its noise: the parameter for a turn, else the value that is watched.
type Measured = (f64, f64);

/// On the sides at the nearest distance that tells; `None` where no orbits are found there.
fn beside(
    corrector: &mut Corrector<'_>,
    settings: &PalcSettings,
    watch: WatchedFunction,
    orbit: &Regular,
    length: f64,
) -> Option<bool> {
    let along = orbit.along.first()?.clone();
    let mut at = |s: f64| {
        let site = orbit.site.moved(&along, s);
        let plane = [Condition::Plane(&along, &site)];
        let found = corrector
            .correct(site.clone(), &settings.free, &plane, Goal::SHARP)
            .ok()?;
        measured(corrector, settings, watch, &found, &along)
    };
    let middle = at(0.0)?;
    for part in PARTS {
        let (a, b) = (at(-part * length)?, at(part * length)?);
        let change = changes(watch, a, middle, b);
        if change.is_some() {
            return change;
        }
    }
    Some(false)
}

fn measured(
    corrector: &mut Corrector<'_>,
    settings: &PalcSettings,
    watch: WatchedFunction,
    orbit: &Regular,
    across: &TangentVector,
) -> Option<Measured> {
    let plane = [Condition::Plane(across, &orbit.site)];
    match watch {
        WatchedFunction::Turn(i) => {
            let noise = corrector.noise(orbit, &settings.free, &plane)?;
            Some((orbit.site.at[i], noise.parameters[i]))
        }
        WatchedFunction::TestFunction(test_function) => {
            let size = test_function.size(&orbit.spectrum);
            let noise = corrector.noise_of(test_function, orbit, &settings.free, plane[0])?;
            let value = test_function.of(&orbit.spectrum);
            Some((value / size, noise / size))
        }
        WatchedFunction::Value(i, value) => Some((orbit.site.at[i] - value, 0.0)),
        // Its sign on both sides tells.
        WatchedFunction::UserFunction(_) => None,
    }
}

/// Whether there is a change of sign, or a turn, between both sides; `None` where it is within the noise.
fn changes(watch: WatchedFunction, a: Measured, middle: Measured, b: Measured) -> Option<bool> {
    let (left, right) = match watch {
        WatchedFunction::Turn(_) => {
            let less = |side: Measured| (middle.0 - side.0, middle.1 + side.1);
            let (left, right) = (less(a), less(b));
            (left, (-right.0, right.1))
        }
        _ => (a, b),
    };
    let sure = |(value, noise): Measured| value.abs() > DEVIATIONS * noise;
    (sure(left) && sure(right)).then_some(left.0 * right.0 < 0.0)
}
