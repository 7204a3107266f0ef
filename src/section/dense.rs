//! Crossings of a section within steps that have no series, by root finding on the dense output.

use super::surface::Surface;
use crate::error::Result;
use crate::field::Vector;
use crate::integrate::{AnyField, AnyStep};
use crate::number::bracketed_root;
use crate::series::{Passage, Zeros};

/// Parts of a step. As the slope is looked at too, a crossing is missed only where the dense output turns three times in one
/// of them.
const PARTS: usize = 4;

/// Appends the crossings in the surface's direction within a step that has no series; `zeros` carries the sign of the height
/// over steps of either kind.
pub(crate) fn crossings(
    field: &AnyField<'_>,
    surface: &Surface,
    step: &AnyStep<'_>,
    zeros: &mut Zeros,
    found: &mut Vec<Passage>,
) -> Result<()> {
    let (begin, end) = step.room();
    let at = |t: f64| {
        if t == end {
            Vector::from_column_slice(step.y1)
        } else {
            step.at(t).0
        }
    };
    let knot = |t: f64| {
        let y = at(t);
        let slope = surface.rate(y.as_slice(), &field.f(&y));
        (t, surface.height(y.as_slice()), slope)
    };
    let mut left = knot(begin);
    if zeros.sign == 0.0 {
        zeros.sign = if left.1 == 0.0 { left.2 } else { left.1 }.signum();
    }
    for part in 1..=PARTS {
        let t = if part == PARTS {
            end
        } else {
            begin + (end - begin) * part as f64 / PARTS as f64
        };
        let right = knot(t);
        let mut turn = None;
        if left.2 * right.2 < 0.0 {
            let slope = |t: f64| (knot(t).2, f64::NAN);
            if let Ok(t) = bracketed_root("the extremum of a height", left.0, right.0, slope) {
                turn = Some(knot(t));
            }
        }
        for right in turn.into_iter().chain([right]) {
            // At 0 the next knot decides.
            if right.1 * zeros.sign < 0.0 {
                zeros.sign = -zeros.sign;
                // The sign may have been lost at the joint of two steps.
                let t = if left.1 * right.1 < 0.0 {
                    let height = |t: f64| {
                        let (_, height, slope) = knot(t);
                        (height, slope)
                    };
                    bracketed_root("the crossing of a section", left.0, right.0, height)?
                } else {
                    left.0
                };
                if zeros.sign == surface.sign_behind() {
                    found.push(Passage {
                        time: step.at(t).1,
                        crossing: surface.direction,
                        state: at(t).as_slice().to_vec(),
                    });
                }
            }
            left = right;
        }
    }
    Ok(())
}
