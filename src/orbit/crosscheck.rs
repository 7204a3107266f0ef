//! The same orbit once more, by an unlike method on trajectories of its own.

use super::interface_system::InterfaceSystem;
use super::shooting_nodes::ShootingNodes;
use super::solve::{Orbit, OrbitAccuracy, orbit};
use super::space::{Alone, Space, space_of};
use crate::error::Result;
use crate::integrate::AnyField;

/// What the second method found.
#[derive(Debug, Clone, PartialEq)]
#[non_exhaustive]
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
    let from = |digits: i32| {
        let shooting = ShootingNodes::of_digits(digits, &first.nodes, &first.durations);
        orbit(level, space, accuracy, shooting)
    };
    let [few, more, most] = DIGITS;
    let second = from(few).or_else(|_| from(more)).or_else(|_| from(most))?;
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
