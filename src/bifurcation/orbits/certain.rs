//! Whether what is watched certainly changes its sign at an orbit of a branch: on both sides of it, by more than the noise.
//!
//! At a fold the parameter turns: on both sides of it, it is less, or it is greater, than at the fold. Where a branch is
//! vertical, as at a degenerate Hopf point, the parameter's slope is noise and changes its sign again and again.

use super::detect::{Watch, size};
use crate::orbit::{Condition, Corrector, Family, Goal, Pace, Path, Regular, Walk};

/// The distances to both sides that are tried, the nearest first, in units of the step.
const PARTS: [f64; 3] = [0.125, 0.5, 1.0];
/// Standard deviations of what is noise.
const DEVIATIONS: f64 = 5.0;
/// Tolerance with which the sides are looked at, as what steps may err by.
const FINE: f64 = 2e-15;

/// Whether the zero of what is watched, which was landed on at `orbit` on a step of the walk from `before` over `length`, is one.
pub(super) fn certain<F: Family<N>, const N: usize>(
    walk: &mut Walk<'_, '_, F, N>,
    watch: Watch,
    orbit: &Regular<N>,
    (before, length): (&Pace<N>, f64),
) -> bool {
    let path = walk.path.clone();
    let found = if walk.corrector.tracer.differentiates() {
        let fine = Corrector::new(walk.corrector.family, FINE);
        fine.ok()
            .and_then(|mut fine| beside(&mut fine, &path, watch, orbit, length))
    } else {
        beside(walk.corrector, &path, watch, orbit, length)
    };
    found.unwrap_or_else(|| {
        // By the ends of the step, then, as accurately as these are known.
        let ends = [before.here.clone(), walk.pace.here.clone()];
        let plane = before.direction.clone();
        let mut at = |orbit: &Regular<N>| measured(walk.corrector, &path, watch, orbit, &plane);
        let [Some(a), Some(b), Some(middle)] = [at(&ends[0]), at(&ends[1]), at(orbit)] else {
            return false;
        };
        changes(watch, a, middle, b) == Some(true)
    })
}

/// What is measured at an orbit, and its noise: the parameter for a turn, else the value that is watched.
type Measured = (f64, f64);

/// On the sides at the nearest distance that tells; `None` where no orbits are found there.
fn beside<F: Family<N>, const N: usize>(
    corrector: &mut Corrector<'_, F, N>,
    path: &Path,
    watch: Watch,
    orbit: &Regular<N>,
    length: f64,
) -> Option<bool> {
    let along = orbit.along.first()?.clone();
    let mut at = |s: f64| {
        let site = orbit.site.moved(&along, s);
        let plane = [Condition::Plane(&along, &site)];
        let found = corrector
            .correct(site.clone(), &path.free, &plane, Goal::SHARP)
            .ok()?;
        measured(corrector, path, watch, &found, &along)
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

fn measured<F: Family<N>, const N: usize>(
    corrector: &mut Corrector<'_, F, N>,
    path: &Path,
    watch: Watch,
    orbit: &Regular<N>,
    across: &crate::orbit::Motion<N>,
) -> Option<Measured> {
    let plane = [Condition::Plane(across, &orbit.site)];
    match watch {
        Watch::Turn(i) => {
            let noise = corrector.noise(orbit, &path.free, &plane)?;
            Some((orbit.site.at[i], noise.parameters[i]))
        }
        Watch::Indicator(indicator) => Some((
            indicator.of::<N>(&orbit.spectrum) / size::<N>(indicator, &orbit.spectrum),
            corrector.noise_of(indicator, orbit, &path.free, plane[0])?
                / size::<N>(indicator, &orbit.spectrum),
        )),
        Watch::Value(i, value) => Some((orbit.site.at[i] - value, 0.0)),
    }
}

/// Whether there is a change of sign, or a turn, between both sides; `None` where it is within the noise.
fn changes(watch: Watch, a: Measured, middle: Measured, b: Measured) -> Option<bool> {
    let (left, right) = match watch {
        Watch::Turn(_) => {
            let less = |side: Measured| (middle.0 - side.0, middle.1 + side.1);
            let (left, right) = (less(a), less(b));
            (left, (-right.0, right.1))
        }
        _ => (a, b),
    };
    let sure = |(value, noise): Measured| value.abs() > DEVIATIONS * noise;
    (sure(left) && sure(right)).then_some(left.0 * right.0 < 0.0)
}
