//! Pseudo-arclength continuation of orbits past their bifurcations, each of which is handed on.

use super::certain::certain;
use super::detect::{Values, WatchedFunction, landed, zeros};
use crate::error::Result;
use crate::orbit::{DirectedPoint, Goal, Palc, PalcEnd, ParametrisedField, Regular};
use std::ops::ControlFlow;

/// Something that is met on the way.
pub enum Met<'a, const N: usize> {
    /// The next orbit.
    Orbit(&'a DirectedPoint<N>),
    /// An orbit where something that is watched is zero, to the accuracy of the continuation.
    Zero(WatchedFunction, &'a Regular<N>),
}

/// Why a continuation ended.
#[derive(Debug, Clone, Copy, PartialEq)]
#[non_exhaustive]
pub enum End {
    /// By the observer.
    Interrupted,
    /// There is no next orbit.
    Stuck(PalcEnd),
    /// As many orbits as were allowed.
    Count(usize),
}

impl End {
    /// In words.
    pub fn words(self) -> String {
        match self {
            End::Interrupted => "no more was asked for".into(),
            End::Stuck(stop) => stop.to_string(),
            End::Count(most) => format!("the bound of {most} orbits is used up"),
        }
    }
}

/// Who is told of what is met: with the continuation, where its step began, and what that is.
type MetObserver<'t, F, const N: usize> =
    &'t mut dyn FnMut(&mut Palc<'_, '_, F, N>, &DirectedPoint<N>, Met<'_, N>) -> ControlFlow<()>;

/// Follows the continuation, past all that is watched. Whoever is told of what is met is given where the step began too: with the same
/// nodes as where it ended.
///
/// # Errors
/// [`crate::Error::Dimension`] where a test function that is watched is no test function in so many dimensions.
pub fn follow<F: ParametrisedField<N>, const N: usize>(
    palc: &mut Palc<'_, '_, F, N>,
    watches: &[WatchedFunction],
    most: usize,
    met: MetObserver<'_, F, N>,
) -> Result<End> {
    for watch in watches {
        if let WatchedFunction::TestFunction(test_function) = watch {
            test_function.checked::<N>()?;
        }
    }
    let mut last: Option<(usize, Values)> = None;
    for _ in 0..most {
        let (before, length) = match palc.step() {
            Ok(step) => step,
            Err(stop) => return Ok(End::Stuck(stop)),
        };
        // Other nodes are another measure of length, and make other slopes.
        let known = last.take().filter(|(cuts, _)| *cuts == palc.cuts());
        let (zeros, values) = zeros(palc, (&before, known.map(|k| k.1)), length, watches);
        last = Some((palc.cuts(), values));
        for zero in zeros {
            // What can't be landed on is none: a sign that changes by noise, or through a pole.
            let Some(at) = landed(palc, &before, length, &zero, Goal::STEP) else {
                continue;
            };
            // Of a curve of bifurcations K alone is watched for turns, and each is looked at by who is told.
            if palc.settings.test_function.is_none()
                && !zero.clear
                && !certain(palc, zero.watch, &at, (&before, length))
            {
                continue;
            }
            if met(palc, &before, Met::Zero(zero.watch, &at)).is_break() {
                return Ok(End::Interrupted);
            }
        }
        let now = palc.now.clone();
        if met(palc, &before, Met::Orbit(&now)).is_break() {
            return Ok(End::Interrupted);
        }
        if let Err(stop) = palc.mesh() {
            return Ok(End::Stuck(stop));
        }
    }
    Ok(End::Count(most))
}
