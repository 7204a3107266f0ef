//! Whether a return map is q-periodic: not by how close its points come, but by the periodic point that they close in on.
//!
//! Returns that repeat to within a tolerance may belong to a torus that is nearly resonant, and ones that do not may be on a
//! long way to a periodic orbit. So a candidate is followed to a fixed point of the q-th iterate by Newton's method; that
//! point must attract, and the returns must have come closer to it.

use super::rest::equilibrium_near;
use super::returns::{Return, ReturnRecord};
use super::surface::{Landing, Surface, return_map};
use crate::error::Result;
use crate::field::{Jacobian, State, VectorField};
use crate::integrate::{MAX_STEPS, Taylor, Tolerances};
use crate::number::Uncertain;
use nalgebra::DMatrix;

/// The longest period that is looked for.
pub const LONGEST_PERIOD: usize = 64;

/// Returns that have come this close to each other after q make q a candidate.
const NEAR: f64 = 1e-2;
/// Returns this close to a periodic point are on it, but for the error of the run, which is so many times its tolerance.
const ARRIVED: f64 = 1e-6;
const PER_ACCURACY: f64 = 1e3;
/// What a distance must have shrunk to over the recording, where it is above that.
const SHRUNK: f64 = 0.7;
/// A periodic point that comes back as close as this sooner has the shorter period.
const SAME: f64 = 1e-6;
/// A multiplier within this of one in modulus leaves stability open.
const NEUTRAL: f64 = 1e-7;
/// Newton's method ends at this step, or fails.
const CONVERGED: f64 = 1e-11;
const ROUNDING: f64 = 1e-6;
const ITERATIONS: usize = 12;
/// The tolerance of the map.
const TOLERANCE: f64 = 1e-14;
/// Returns needed for each point of a period.
const REPEATS: usize = 3;

/// An attracting periodic point of a return map.
#[derive(Debug, Clone, PartialEq)]
#[non_exhaustive]
pub struct Periodic<const N: usize> {
    /// q: the map returns to the point after so many returns, and not earlier.
    pub returns: usize,
    /// The point, near the last return.
    pub point: State<N>,
    /// The time of q returns.
    pub period: Uncertain,
    /// The largest modulus of the multipliers; less than one where it attracts.
    pub multiplier: f64,
    /// How far, in the largest component, the last return was from the point.
    pub distance: f64,
    /// The last step of Newton's method to the point: from where the multiplier was taken.
    pub last_step: f64,
}

/// The smallest q for which the returns close in on an attracting q-periodic point; `None` if there is none up to
/// [`LONGEST_PERIOD`], or too few returns to tell.
///
/// # Errors
/// Those of an integrator with no room for its tolerances; a map that fails on the way means that there is no such point.
pub fn periodicity<const N: usize>(
    field: &dyn VectorField<N>,
    surface: &Surface<N>,
    record: &ReturnRecord<N>,
) -> Result<Option<Periodic<N>>> {
    let mut taylor = Taylor::new(Tolerances::equal(TOLERANCE)?, MAX_STEPS)?;
    let returns = &record.returns[..];
    let arrived = ARRIVED.max(PER_ACCURACY * record.accuracy);
    let n = returns.len();
    for q in 1..=LONGEST_PERIOD.min(n / REPEATS) {
        let apart = |i: usize| (returns[i].state - returns[i - q].state).amax();
        let near = (n - q..n).map(apart).fold(0.0, f64::max);
        let before = (n / 2..(n / 2 + q).min(n)).filter(|&i| i >= q).map(apart);
        // No need to ask where they neither are near nor come nearer; only the search takes time.
        let closing = near < arrived || near < SHRUNK.sqrt() * before.fold(0.0, f64::max);
        if near < NEAR && closing {
            let found =
                PeriodicSearch::new(field, surface, &mut taylor, returns, (record.accuracy, q))
                    .point()
                    .filter(Periodic::attracts);
            if found.is_some() {
                return Ok(found);
            }
        }
    }
    Ok(None)
}

impl<const N: usize> Periodic<N> {
    /// Whether the point attracts, beyond doubt.
    pub(crate) fn attracts(&self) -> bool {
        self.multiplier <= 1.0 - NEUTRAL
    }
}

/// The search for a q-periodic point, attracting or not, that returns have come closer to or arrived at.
pub(crate) struct PeriodicSearch<'a, const N: usize> {
    field: &'a dyn VectorField<N>,
    surface: &'a Surface<N>,
    taylor: &'a mut Taylor,
    returns: &'a [Return<N>],
    q: usize,
    arrived: f64,
    /// Newton's method begins here, goes no farther than `near`, and ends at a step of `converged`: the error is then about
    /// its square, and the integrator's tolerance.
    pub from: State<N>,
    pub near: f64,
    pub converged: f64,
    /// What distances must have shrunk to.
    pub shrunk: f64,
}

impl<'a, const N: usize> PeriodicSearch<'a, N> {
    /// Near the last of these returns, which are good to `accuracy` times a thousand; and q.
    pub fn new(
        field: &'a dyn VectorField<N>,
        surface: &'a Surface<N>,
        taylor: &'a mut Taylor,
        returns: &'a [Return<N>],
        (accuracy, q): (f64, usize),
    ) -> Self {
        PeriodicSearch {
            field,
            surface,
            taylor,
            returns,
            q,
            arrived: ARRIVED.max(PER_ACCURACY * accuracy),
            from: returns[returns.len() - 1].state,
            near: NEAR,
            converged: CONVERGED,
            shrunk: SHRUNK,
        }
    }

    /// The point, if there is one.
    pub fn point(&mut self) -> Option<Periodic<N>> {
        let mut point = self.surface.nearest(&self.from);
        let mut size = f64::INFINITY;
        for _ in 0..ITERATIONS {
            let along = self.iterate(&point)?;
            let Landing {
                state: to,
                derivative,
                ..
            } = *along.last()?;
            let inside = self.surface.directions(&point);
            let reduced = reduce(&derivative, &inside);
            let residual = inside.transpose() * matrix(&(to - point));
            let identity = DMatrix::identity(N - 1, N - 1);
            let step = (identity - &reduced).lu().solve(&residual)?;
            let before = size;
            size = step.amax();
            if !size.is_finite() {
                return None;
            }
            let step = inside * step;
            point = self
                .surface
                .nearest(&(point + State::from_fn(|i, _| step[i])));
            if (point - self.from).amax() > self.near {
                return None;
            }
            // Rounding ends the convergence too, where the map magnifies it.
            if size < self.converged || (size < ROUNDING && size > 0.5 * before) {
                return self.judged(point, &along, size);
            }
        }
        None
    }

    fn judged(&self, point: State<N>, along: &[Landing<N>], error: f64) -> Option<Periodic<N>> {
        // An equilibrium on the section is no orbit.
        if equilibrium_near(self.field, &point, self.arrived).is_some() {
            return None;
        }
        // A point may come back sooner, where its multipliers turn the returns around it by a part of a turn.
        let sooner = |d: &usize| {
            self.q.is_multiple_of(*d)
                && (along[d - 1].state - point).amax() < SAME.max(10.0 * error)
        };
        let q = (1..self.q).find(sooner).unwrap_or(self.q);
        let Landing {
            time, derivative, ..
        } = along[q - 1];
        let reduced = reduce(&derivative, &self.surface.directions(&point));
        let moduli = reduced.complex_eigenvalues().map(|z| z.norm());
        let multiplier = moduli.iter().copied().fold(0.0, f64::max);
        let n = self.returns.len();
        let phase = |i: &usize| (n - 1 - i).is_multiple_of(self.q);
        let distance = |i: usize| (self.returns[i].state - point).amax();
        let over =
            |range: std::ops::Range<usize>| range.filter(phase).map(distance).fold(0.0, f64::max);
        let (early, late) = (over(0..n / 2), over(n - n.div_ceil(4).max(self.q)..n));
        if late > self.arrived && late > self.shrunk * early {
            return None;
        }
        // The time of return is flat at the point to the order of the step, within the error of the integration.
        let rounding = time * (error + 1e3 * TOLERANCE);
        Some(Periodic {
            returns: q,
            point,
            period: Uncertain::new(time, rounding),
            multiplier,
            distance: distance(n - 1),
            last_step: error,
        })
    }

    /// q returns from a point, each with the time since and the derivative in the point.
    fn iterate(&mut self, from: &State<N>) -> Option<Vec<Landing<N>>> {
        // Twice what the run itself took, where it was near.
        let last = self.returns.len() - 1;
        let patience = 2.0 * (self.returns[last].time - self.returns[last - self.q].time);
        let mut here = Landing {
            time: 0.0,
            state: *from,
            derivative: Jacobian::<N>::identity(),
        };
        let mut along = Vec::with_capacity(self.q);
        for _ in 0..self.q {
            let taylor = &mut *self.taylor;
            let next = return_map(self.field, self.surface, taylor, &here.state, patience).ok()?;
            here = Landing {
                time: here.time + next.time,
                state: next.state,
                derivative: next.derivative * here.derivative,
            };
            along.push(here);
        }
        Some(along)
    }
}

/// The part of a derivative within the section.
pub(crate) fn reduce<const N: usize>(
    derivative: &Jacobian<N>,
    inside: &DMatrix<f64>,
) -> DMatrix<f64> {
    let full = DMatrix::from_iterator(N, N, derivative.iter().copied());
    inside.transpose() * full * inside
}

fn matrix<const N: usize>(y: &State<N>) -> DMatrix<f64> {
    DMatrix::from_iterator(N, 1, y.iter().copied())
}
