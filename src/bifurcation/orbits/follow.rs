//! Follows a curve of orbits of any family and hands on what it meets.

use super::certain::certain;
use super::detect::{Values, Watch, landed, zeros};
use crate::error::Result;
use crate::orbit::{Family, Goal, Pace, Regular, Stop, Walk};
use std::ops::ControlFlow;

/// Something that is met on the way.
pub enum Met<'a, const N: usize> {
    /// The next orbit.
    Orbit(&'a Pace<N>),
    /// An orbit where something that is watched is zero, to the accuracy of the walk.
    Zero(Watch, &'a Regular<N>),
}

/// Why a walk ended.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum End {
    /// Whoever is told had enough.
    Told,
    /// There is no next orbit.
    Stuck(Stop),
    /// As many orbits as were allowed.
    Count(usize),
}

impl End {
    /// In words.
    pub fn words(self) -> String {
        match self {
            End::Told => "no more was asked for".into(),
            End::Stuck(stop) => stop.to_string(),
            End::Count(most) => format!("the bound of {most} orbits is used up"),
        }
    }
}

/// Who is told of what is met: with the walk, where its step began, and what that is.
type Told<'t, F, const N: usize> =
    &'t mut dyn FnMut(&mut Walk<'_, '_, F, N>, &Pace<N>, Met<'_, N>) -> ControlFlow<()>;

/// Follows the walk, past all that is watched. Whoever is told of what is met is given where the step began too: with the same
/// nodes as where it ended.
///
/// # Errors
/// [`crate::Error::Dimension`] where an indicator that is watched is no test function in so many dimensions.
pub fn follow<F: Family<N>, const N: usize>(
    walk: &mut Walk<'_, '_, F, N>,
    watches: &[Watch],
    most: usize,
    met: Told<'_, F, N>,
) -> Result<End> {
    for watch in watches {
        if let Watch::Indicator(indicator) = watch {
            indicator.checked::<N>()?;
        }
    }
    let mut last: Option<(usize, Values)> = None;
    for _ in 0..most {
        let (before, length) = match walk.step() {
            Ok(step) => step,
            Err(stop) => return Ok(End::Stuck(stop)),
        };
        // Other nodes are another measure of length, and make other slopes.
        let known = last.take().filter(|(cuts, _)| *cuts == walk.cuts());
        let (zeros, values) = zeros(walk, (&before, known.map(|k| k.1)), length, watches);
        last = Some((walk.cuts(), values));
        for zero in zeros {
            // What can't be landed on is none: a sign that changes by noise, or through a pole.
            let Some(at) = landed(walk, &before, length, &zero, Goal::STEP) else {
                continue;
            };
            // Of a curve of bifurcations K alone is watched for turns, and each is looked at by who is told.
            if walk.path.indicator.is_none()
                && !zero.clear
                && !certain(walk, zero.watch, &at, (&before, length))
            {
                continue;
            }
            if met(walk, &before, Met::Zero(zero.watch, &at)).is_break() {
                return Ok(End::Told);
            }
        }
        let pace = walk.pace.clone();
        if met(walk, &before, Met::Orbit(&pace)).is_break() {
            return Ok(End::Told);
        }
        if let Err(stop) = walk.mesh() {
            return Ok(End::Stuck(stop));
        }
    }
    Ok(End::Count(most))
}
