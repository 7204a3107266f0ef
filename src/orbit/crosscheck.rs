//! The same orbit once more, by an unlike method on trajectories of its own.

use super::find::{plane_of, whole_of};
use super::polygon::Polygon;
use super::slab::Slab;
use super::solve::{Accuracy, Orbit, orbit};
use crate::equilibrium::Symmetry;
use crate::error::Result;
use crate::field::State;

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

/// Computes the orbit by another method. It begins from the first one's nodes cut to a few digits, so that it has to find the
/// orbit by itself; and shares nothing else with it.
///
/// # Errors
/// As of [`super::find()`].
pub fn crosscheck(slab: &Slab, first: &Orbit, accuracy: &Accuracy) -> Result<Crosscheck> {
    let (plane, whole) = (slab.plane(), slab.whole());
    let from = |digits: i32| {
        if first.symmetry == Symmetry::Symmetric {
            let space = plane_of(slab, &*plane, &*whole);
            orbit(slab, &space, accuracy, cut::<2>(first, digits))
        } else {
            orbit(slab, &whole_of(&*whole), accuracy, cut::<3>(first, digits))
        }
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

/// The cycle with only so many digits left.
fn cut<const N: usize>(orbit: &Orbit, digits: i32) -> Polygon<N> {
    let cut = |x: f64| {
        if x == 0.0 {
            return 0.0;
        }
        let unit = 10.0_f64.powi(x.abs().log10().floor() as i32 + 1 - digits);
        (x / unit).round() * unit
    };
    Polygon {
        nodes: orbit
            .nodes
            .iter()
            .map(|x| State::from_fn(|i, _| cut(x[i])))
            .collect(),
        durations: orbit.durations.iter().map(|&t| cut(t)).collect(),
    }
}
