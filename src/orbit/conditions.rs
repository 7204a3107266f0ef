//! Conditions on a periodic orbit of a family, and how far the orbit has to move to meet them.

use super::continuation_point::{ContinuationPoint, TangentVector};
use super::family::ParametrisedField;
use super::gradients::test_function;
use super::test_function::{Spectrum, TestFunction};
use super::user_function::of_orbit;
use crate::error::Result;
use nalgebra::{Matrix2, Vector2};

/// A condition on a periodic orbit.
#[derive(Debug, Clone, Copy)]
pub enum Condition<'a> {
    /// It lies in the plane through another orbit with as many nodes, normal to a direction.
    Plane(&'a TangentVector, &'a ContinuationPoint),
    /// The coordinate of this parameter has this value.
    Parameter(usize, f64),
    /// A test function vanishes.
    TestFunction(TestFunction),
    /// The user's function of this number vanishes.
    UserFunction(usize),
}

/// Whether all test functions among the conditions are test functions here.
pub(super) fn checked(conditions: &[Condition<'_>], dimension: usize) -> Result<()> {
    let mut test_functions = conditions.iter().filter_map(test_function);
    test_functions.try_for_each(|one| one.checked(dimension))
}

/// Whether a condition is that a function vanishes, whose gradient is to be found.
pub(super) fn is_function(condition: &Condition<'_>) -> bool {
    matches!(
        condition,
        Condition::TestFunction(_) | Condition::UserFunction(_)
    )
}

/// What is known of the functions among the conditions, in the order of these.
pub(super) struct KnownSpectrum<'a> {
    pub spectrum: Option<&'a Spectrum>,
    pub gradients: &'a [TangentVector],
    pub by_closing: &'a [f64],
}

/// How far to go in every direction for the conditions to hold, to first order.
pub(super) fn weights(
    site: &ContinuationPoint,
    closing: &TangentVector,
    along: &[TangentVector],
    conditions: &[Condition<'_>],
    known: &KnownSpectrum<'_>,
    family: &dyn ParametrisedField,
) -> Option<Vec<f64>> {
    let mut functions = known.gradients.iter().zip(known.by_closing);
    let mut rows = Vec::with_capacity(conditions.len());
    for condition in conditions {
        let (slopes, missing): (Vec<f64>, f64) = match condition {
            Condition::Plane(across, origin) => (
                along.iter().map(|t| across.dot(t)).collect(),
                -across.dot(&site.from(origin)) - across.dot(closing),
            ),
            Condition::Parameter(i, value) => (
                along.iter().map(|t| t.parameters[*i]).collect(),
                value - site.at[*i] - closing.parameters[*i],
            ),
            Condition::TestFunction(_) | Condition::UserFunction(_) => {
                let (gradient, by_closing) = functions.next()?;
                let value = match condition {
                    Condition::UserFunction(which) => of_orbit(family, *which, site),
                    Condition::TestFunction(test_function) => test_function.of(known.spectrum?),
                    _ => return None,
                };
                (
                    along.iter().map(|t| gradient.dot(t)).collect(),
                    -value - by_closing,
                )
            }
        };
        rows.push((slopes, missing));
    }
    combination(&rows)
}

/// The weights of one or two directions: of every condition, what they change it by and what is missing to it.
pub(super) fn combination(rows: &[(Vec<f64>, f64)]) -> Option<Vec<f64>> {
    match rows {
        [(a, b)] if a.len() == 1 => Some(vec![b / a[0]]),
        [(a, b), (c, d)] if a.len() == 2 => {
            let m = Matrix2::new(a[0], a[1], c[0], c[1]);
            let w = m.lu().solve(&Vector2::new(*b, *d))?;
            Some(vec![w[0], w[1]])
        }
        _ => None,
    }
    .filter(|w: &Vec<f64>| w.iter().all(|w| w.is_finite()))
}
