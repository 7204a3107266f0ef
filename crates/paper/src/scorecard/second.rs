//! Orbits once more, by an integrator that shares no step with Taylor's.

use super::{missing, slab};
use crate::Pieces;
use twinslip::bifurcation::{Special, orbits::crosscheck};
use twinslip::equilibrium::Symmetry;
use twinslip::error::Result;
use twinslip::integrate::Choice;
use twinslip::number::Uncertain;
use twinslip::orbit::{InitialGuess, Orbit, OrbitAccuracy, Query, find};
use twinslip_tasks::scene::SECOND_METHOD;

/// The words of a special orbit found again.
#[cfg(feature = "sundials")]
pub const BY_SECOND: &str = "CVODE's Adams method, from nodes cut to a few digits";
#[cfg(not(feature = "sundials"))]
pub const BY_SECOND: &str = "Rodas5P, from nodes cut to a few digits";

/// The words of the largest K of a curve found again.
#[cfg(feature = "sundials")]
pub const AT_THE_TOP: &str = "where |mu| = 1 at that V_H, by CVODE's Adams method";
#[cfg(not(feature = "sundials"))]
pub const AT_THE_TOP: &str = "where |mu| = 1 at that V_H, by Rodas5P";

/// The words of the multipliers of an orbit found again.
#[cfg(feature = "sundials")]
pub const MULTIPLIERS: &str = "multipliers by CVODE's Adams method";
#[cfg(not(feature = "sundials"))]
pub const MULTIPLIERS: &str = "multipliers by Rodas5P";

/// The second integrator.
pub fn second_method() -> Result<Choice> {
    Choice::named(SECOND_METHOD)
}

/// The orbit of a symmetry at V_H and K.
pub fn orbit_at(
    pieces: &Pieces<'_>,
    (driving, stiffness): (f64, f64),
    symmetry: Symmetry,
    begin: InitialGuess,
    method: Choice,
) -> Result<Orbit> {
    let slab = slab(pieces, driving, stiffness)?;
    let query = Query { symmetry, begin };
    Ok(find(&slab, &query, &OrbitAccuracy::of(method))?.orbit)
}

/// V_H and K of a special orbit, found again. Their uncertainty is how far they are from the first ones, with that of those.
pub fn again(pieces: &Pieces<'_>, special: &Special) -> Result<[Uncertain; 2]> {
    let (driving, stiffness) = (special.driving, special.stiffness);
    let slab = slab(pieces, driving.value, stiffness.value)?;
    let parts = crosscheck((&slab, &[]), special, second_method()?)?;
    let [in_driving, in_stiffness, _] =
        parts.ok_or_else(|| missing("a special point without its orbit"))?;
    let moved = |first: Uncertain, part: f64| {
        let value = first.value * (1.0 + part);
        Uncertain::new(value, (value - first.value).abs() + first.uncertainty)
    };
    Ok([moved(driving, in_driving), moved(stiffness, in_stiffness)])
}

/// K near a top where the larger multiplier is of modulus 1 at the top's V_H: there the modulus does not depend on V_H, so that
/// the K found is that of the top, to second order.
pub fn at_top(
    pieces: &Pieces<'_>,
    driving: f64,
    near: f64,
    symmetry: Symmetry,
    begin: InitialGuess,
) -> Result<Uncertain> {
    /// How far off the search begins, relative, and its steps.
    const OFF: f64 = 1e-4;
    const STEPS: usize = 3;
    let method = second_method()?;
    let logarithm = |stiffness: f64| -> Result<Uncertain> {
        let orbit = orbit_at(pieces, (driving, stiffness), symmetry, begin, method)?;
        let first = orbit.floquet.multipliers.first();
        Ok(first
            .ok_or_else(|| missing("an orbit without multipliers"))?
            .ln_abs)
    };
    let (mut k, mut next) = (near * (1.0 + 2.0 * OFF), near * (1.0 + OFF));
    let mut at = logarithm(k)?;
    let mut slope = f64::NAN;
    for _ in 0..STEPS {
        let there = logarithm(next)?;
        slope = (there.value - at.value) / (next - k);
        (k, at) = (next, there);
        next = k - at.value / slope;
    }
    let uncertainty = (at.uncertainty / slope).abs() + (next - k).abs();
    Ok(Uncertain::new(next, uncertainty))
}
