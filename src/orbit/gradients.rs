//! How test functions, and the user's, change as an orbit is moved, which Newton's method needs where one is among its conditions.

use super::conditions::{Condition, is_function};
use super::continuation_point::{ContinuationPoint, TangentVector};
use super::correct::{Corrector, Regular};
use super::linear::{Free, Linear};
use super::test_function::{Spectrum, TestFunction};
use super::user_function::{self, of_orbit};

/// The step by which test functions are differentiated.
const STEP: f64 = 1e-6;

impl Corrector<'_> {
    /// The gradients of all functions among the conditions, in the directions in which the orbit can move.
    pub(super) fn gradients(
        &mut self,
        site: &ContinuationPoint,
        linear: &Linear,
        along: &[TangentVector],
        spectrum: &Spectrum,
        conditions: &[Condition<'_>],
    ) -> Option<Vec<TangentVector>> {
        let functions: Vec<_> = conditions.iter().filter(|one| is_function(one)).collect();
        let tested = functions.iter().any(|one| test_function(one).is_some());
        let mut sums: Vec<Option<TangentVector>> = vec![None; functions.len()];
        for direction in along {
            let change = match tested {
                true => Some(self.change(site, linear, direction, spectrum)?),
                false => None,
            };
            for (sum, function) in sums.iter_mut().zip(&functions) {
                let slope = match function {
                    Condition::UserFunction(which) => {
                        user_function::slope(self.family, *which, site, direction)
                    }
                    _ => test_function(function)?.change_along(spectrum, change.as_ref()?),
                };
                let part = direction.clone().scaled(slope);
                *sum = Some(match sum.take() {
                    None => part,
                    Some(sum) => sum.plus(1.0, &part),
                });
            }
        }
        sums.into_iter().collect()
    }

    /// What closing the orbit will add to the functions among the conditions. Where the gaps are small that is for the next
    /// iteration to see.
    pub(super) fn by_closing(
        &mut self,
        site: &ContinuationPoint,
        linear: &Linear,
        closing: &TangentVector,
        spectrum: &Spectrum,
        conditions: &[Condition<'_>],
    ) -> Option<Vec<f64>> {
        /// Smaller closings are not looked at where that takes a flow along the orbit's neighbours: what the user's functions hold is held in every row.
        const SMALL: f64 = 1e-7;
        let functions: Vec<_> = conditions.iter().filter(|one| is_function(one)).collect();
        let length = closing.dot(closing).sqrt();
        let (size, stretch) = site.size(closing);
        let tested = functions.iter().any(|one| test_function(one).is_some());
        let users = functions.iter().any(|one| test_function(one).is_none());
        let is_small = size.max(stretch) < SMALL && !users;
        if functions.is_empty() || is_small || length == 0.0 {
            return Some(vec![0.0; functions.len()]);
        }
        let direction = closing.clone().scaled(1.0 / length);
        let change = match tested {
            true => Some(self.change(site, linear, &direction, spectrum)?),
            false => None,
        };
        let family = self.family;
        let of = |function: &&Condition<'_>| match function {
            Condition::UserFunction(which) => {
                let closed = of_orbit(family, *which, &site.moved(closing, 1.0));
                Some(closed - of_orbit(family, *which, site))
            }
            _ => Some(length * test_function(function)?.change_along(spectrum, change.as_ref()?)),
        };
        functions.iter().map(of).collect()
    }

    /// What a small tangent vector of an orbit changes its spectrum by.
    pub(super) fn by_tangent(
        &mut self,
        orbit: &Regular,
        tangent: &TangentVector,
    ) -> Option<Spectrum> {
        let length = tangent.dot(tangent).sqrt();
        let direction = tangent.clone().normalised()?;
        let slope = self.slope(orbit, &direction)?;
        Some(Spectrum {
            trace: length * slope.trace,
            volume: length * slope.volume,
            across: length * slope.across,
            products: slope.products.map(|products| products.scaled(length)),
            ..slope
        })
    }

    /// How the spectrum of an orbit changes in a direction.
    pub fn slope(&mut self, orbit: &Regular, direction: &TangentVector) -> Option<Spectrum> {
        self.change(&orbit.site, &orbit.linear, direction, &orbit.spectrum)
    }

    /// How the spectrum changes in this direction.
    fn change(
        &mut self,
        site: &ContinuationPoint,
        linear: &Linear,
        direction: &TangentVector,
        spectrum: &Spectrum,
    ) -> Option<Spectrum> {
        let beside = site.moved(direction, STEP);
        let field = self.family.field(beside.at);
        let moved = linear
            .beside(&mut self.tracer, &field, &beside.shooting, Free::NONE)
            .ok()?;
        Some(Spectrum::change(linear, spectrum, &moved, STEP))
    }
}

/// The test function of a condition that is one.
pub(super) fn test_function(condition: &Condition<'_>) -> Option<TestFunction> {
    match condition {
        Condition::TestFunction(test_function) => Some(*test_function),
        _ => None,
    }
}

/// A gradient in other planes: its product with each of the directions there, which `before` are the same in the planes of the gradient and of
/// these directions `along`.
pub(super) fn carried(
    gradient: &TangentVector,
    (along, before): (&[TangentVector], &[TangentVector]),
    turned: &[TangentVector],
) -> Option<TangentVector> {
    let slope = |direction: &TangentVector| -> f64 {
        let parts = along.iter();
        parts.map(|a| gradient.dot(a) * a.dot(direction)).sum()
    };
    let parts = turned.iter().zip(before);
    let parts = parts.map(|(direction, before)| direction.clone().scaled(slope(before)));
    parts.reduce(|sum, part| sum.plus(1.0, &part))
}
