//! Follows a curve of orbits of any family and hands on what it meets.

use super::detect::{Values, Watch, landed, zeros};
use crate::orbit::{Family, Goal, Pace, Regular, Walk};
use std::ops::ControlFlow;

/// Something that is met on the way.
pub enum Met<'a, const N: usize> {
    /// The next orbit.
    Orbit(&'a Pace<N>),
    /// An orbit where something that is watched is zero, to the accuracy of the walk.
    Zero(Watch, &'a Regular<N>),
}

/// Why a walk ended.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum End {
    /// Whoever is told had enough.
    Told,
    /// Steps shrank to nothing.
    Stuck,
    /// As many orbits as were allowed.
    Count,
}

impl End {
    /// In words.
    pub fn words(self) -> &'static str {
        match self {
            End::Told => "no more was asked for",
            End::Stuck => "Newton's method finds no next orbit however short the step",
            End::Count => "as many orbits as are allowed",
        }
    }
}

/// Who is told of what is met: with the walk, where its step began, and what that is.
type Told<'t, F, const N: usize> =
    &'t mut dyn FnMut(&mut Walk<'_, '_, F, N>, &Pace<N>, Met<'_, N>) -> ControlFlow<()>;

/// Follows the walk, past all that is watched. Whoever is told of what is met is given where the step began too: with the same
/// nodes as where it ended.
pub fn follow<F: Family<N>, const N: usize>(
    walk: &mut Walk<'_, '_, F, N>,
    watches: &[Watch],
    most: usize,
    met: Told<'_, F, N>,
) -> End {
    let mut last: Option<(usize, Values)> = None;
    for _ in 0..most {
        let Some((before, length)) = walk.step() else {
            return End::Stuck;
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
            if met(walk, &before, Met::Zero(zero.watch, &at)).is_break() {
                return End::Told;
            }
        }
        let pace = walk.pace.clone();
        if met(walk, &before, Met::Orbit(&pace)).is_break() {
            return End::Told;
        }
        if walk.mesh().is_none() {
            return End::Stuck;
        }
    }
    End::Count
}
