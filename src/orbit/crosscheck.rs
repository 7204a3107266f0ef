//! The same orbit once more, by an unlike method on trajectories of its own.

use super::interface_system::InterfaceSystem;
use super::shooting_nodes::ShootingNodes;
use super::solve::{Orbit, OrbitAccuracy, orbit};
use super::space::{Alone, Space, space_of};
use crate::error::{Error, Result};
use crate::integrate::AnyField;

/// What the second method found.
#[derive(Debug, Clone, PartialEq)]
pub struct Crosscheck {
    /// The second method's orbit.
    pub orbit: Orbit,
    /// Its period minus the first method's.
    pub period_difference: f64,
    /// The same of ln |mu|, for each multiplier.
    pub ln_abs_difference: Vec<f64>,
}

/// Significant digits of the nodes that the second method begins with; more where it does not find its way from fewer.
const DIGITS: [i32; 3] = [3, 5, 7];
/// The same where the orbit is one of a family, to be found again among its neighbours.
const OF_A_FAMILY: [i32; 1] = [9];
/// Steps on an arc that are always allowed.
const LEAST_STEPS: usize = 100_000;

/// Computes the orbit by another method. It begins from the first one's nodes cut to a few digits, so that it has to find the
/// orbit by itself; and shares nothing else with it.
///
/// # Errors
/// As of [`super::find()`].
pub fn crosscheck(
    slab: &InterfaceSystem,
    first: &Orbit,
    accuracy: &OrbitAccuracy,
) -> Result<Crosscheck> {
    let space = space_of(slab, first.symmetry);
    again(Some(slab.steady_stress()), &*space, first, accuracy)
}

/// The same of an orbit of any field.
///
/// # Errors
/// As of [`super::find_from()`].
pub fn crosscheck_of(
    field: &AnyField<'_>,
    first: &Orbit,
    accuracy: &OrbitAccuracy,
) -> Result<Crosscheck> {
    let symmetry = first.symmetry;
    again(None, &Alone { field, symmetry }, first, accuracy)
}

fn again(
    level: Option<f64>,
    space: &dyn Space,
    first: &Orbit,
    accuracy: &OrbitAccuracy,
) -> Result<Crosscheck> {
    // On one arc no more than all that the orbit took: a method that needs more is not meant for it.
    let accuracy = &OrbitAccuracy {
        max_steps: accuracy.max_steps.min(first.work.steps.max(LEAST_STEPS)),
        ..*accuracy
    };
    let from = |digits: i32| {
        let shooting = ShootingNodes::of_digits(digits, &first.nodes, &first.durations);
        orbit(level, space, accuracy, shooting)
    };
    let digits: &[i32] = if first.in_family {
        &OF_A_FAMILY
    } else {
        &DIGITS
    };
    let mut second = from(digits[0]);
    for &more in &digits[1..] {
        if let Ok(_) | Err(Error::TooManySteps { .. }) = second {
            break;
        }
        second = from(more);
    }
    let second = second?;
    let pairs = second
        .floquet
        .multipliers
        .iter()
        .zip(&first.floquet.multipliers);
    Ok(Crosscheck {
        period_difference: second.period.value - first.period.value,
        ln_abs_difference: pairs
            .map(|(second, first)| second.ln_abs.value - first.ln_abs.value)
            .collect(),
        orbit: second,
    })
}
