//! Whether a return map is q-periodic: not by how close its points come, but by the periodic point that they close in on.
//!
//! Returns that repeat to within a tolerance may belong to a torus that is nearly resonant, and ones that do not may be on a
//! long way to a periodic orbit. So a candidate is followed to a fixed point of the q-th iterate by Newton's method; that
//! point must attract, and the returns must have come closer to it.

use super::rest::equilibrium_near;
use super::returns::{Return, ReturnRecord};
use super::surface::{Landing, SeriesVariables, Surface, return_map};
use crate::error::Result;
use crate::field::{Matrix, Vector};
use crate::integrate::{AnyField, AnyIntegrator, Choice, MAX_STEPS, Tolerances, of_dimension};
use crate::number::{Uncertain, eigenvalues};

/// The longest period that is looked for.
pub const LONGEST_PERIOD: usize = 64;

/// Returns that have come this close to each other after q make q a candidate.
const NEAR: f64 = 1e-2;
/// Returns this close to a periodic point are on it, but for the error of the run, which is so many times its tolerance.
const ARRIVED: f64 = 1e-6;
const PER_ACCURACY: f64 = 1e3;
/// What a distance must have shrunk to over the recording, where it is above that.
const SHRUNK: f64 = 0.7;
/// The same of a point that does not attract, which chaos passes by too.
const SHRUNK_TO_SADDLE: f64 = 0.1;
/// A periodic point that comes back as close as this sooner has the shorter period.
const SAME: f64 = 1e-6;
/// A multiplier within this of one in modulus leaves stability open.
const NEUTRAL: f64 = 1e-7;
/// Newton's method ends at this step, or fails.
const CONVERGED: f64 = 1e-11;
const ROUNDING: f64 = 1e-6;
const ITERATIONS: usize = 12;
/// The tolerances of the map, and of the one whose period shows how far that of the first may be off.
const TOLERANCES: [f64; 2] = [1e-14, 1e-12];
/// Absolute tolerances in these: what passes near 0 and grows again keeps its digits. Logarithms of states need no such care.
const NEXT_TO_NOTHING: f64 = 1e-30;
/// What rounding takes from a period, relatively.
const ROUNDING_OF_PERIOD: f64 = 64.0 * f64::EPSILON;
/// Returns needed for each point of a period.
const REPEATS: usize = 3;

/// An attracting periodic point of a return map.
#[derive(Debug, Clone, PartialEq)]
#[non_exhaustive]
pub struct Periodic {
    /// q: the map returns to the point after so many returns, and not earlier.
    pub returns: usize,
    /// The point, near the last return.
    pub point: Vector,
    /// The time of q returns. Of the points of [`periodicity`] it is within the uncertainty, which the same by coarser steps shows; of
    /// others only rounding and the last step are in that.
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
/// [`crate::Error::Parameter`] for a surface or returns of another dimension than the field, and those of an integrator with no
/// room for its tolerances; a map that fails on the way means that there is no such point.
pub fn periodicity(
    field: &AnyField<'_>,
    surface: &Surface,
    record: &ReturnRecord,
) -> Result<Option<Periodic>> {
    Ok(match closing_in(field, surface, record)? {
        Closing::Attracted(point) => Some(point),
        Closing::OnSaddle | Closing::Nowhere => None,
    })
}

/// What returns close in on.
pub enum Closing {
    /// A periodic point that attracts.
    Attracted(Periodic),
    /// One that does not: the run is in an invariant plane, say, from which only rounding could lead away.
    OnSaddle,
    /// No periodic point, or there are too few returns to tell.
    Nowhere,
}

/// What the returns close in on.
///
/// # Errors
/// As [`periodicity`].
pub fn closing_in(
    field: &AnyField<'_>,
    surface: &Surface,
    record: &ReturnRecord,
) -> Result<Closing> {
    let taylor = |rtol: f64| {
        let tolerances = match surface.chart {
            SeriesVariables::LogStates => Tolerances::equal(rtol)?,
            SeriesVariables::Plain => Tolerances::new(rtol, NEXT_TO_NOTHING * rtol)?,
        };
        AnyIntegrator::new(
            Choice::Taylor,
            tolerances.stepping(record.max_step),
            MAX_STEPS,
        )
    };
    let [fine, coarse] = TOLERANCES;
    let (mut fine, mut coarse) = (taylor(fine)?, taylor(coarse)?);
    let returns = &record.returns[..];
    of_dimension(surface.normal.len(), field.dimension())?;
    for point in returns {
        of_dimension(point.state.len(), field.dimension())?;
    }
    let arrived = ARRIVED.max(PER_ACCURACY * record.accuracy);
    let n = returns.len();
    let mut on_saddle = false;
    for q in 1..=LONGEST_PERIOD.min(n / REPEATS) {
        let apart = |i: usize| (&returns[i].state - &returns[i - q].state).amax();
        let near = (n - q..n).map(apart).fold(0.0, f64::max);
        let before = (n / 2..(n / 2 + q).min(n)).filter(|&i| i >= q).map(apart);
        // No need to ask where they neither are near nor come nearer; only the search takes time.
        let closing = near < arrived || near < SHRUNK.sqrt() * before.fold(0.0, f64::max);
        if near < NEAR && closing {
            let accuracy = (record.accuracy, q);
            let found = PeriodicSearch::new(field, surface, &mut fine, returns, accuracy).point();
            on_saddle |= found
                .as_ref()
                .is_some_and(|point| !point.attracts() && stays_near(point, returns, arrived));
            if let Some(mut found) = found.filter(Periodic::attracts) {
                let mut again = PeriodicSearch::new(field, surface, &mut coarse, returns, accuracy);
                again.from = found.point.clone();
                // To where it does not come nearer.
                again.converged = 0.0;
                let Some(other) = again.point() else { continue };
                let period = &mut found.period;
                period.uncertainty =
                    (other.period.value - period.value).abs() + ROUNDING_OF_PERIOD * period.value;
                return Ok(Closing::Attracted(found));
            }
        }
    }
    Ok(match on_saddle {
        true => Closing::OnSaddle,
        false => Closing::Nowhere,
    })
}

/// Whether returns have arrived at a point, or come much nearer to it over the recording.
fn stays_near(point: &Periodic, returns: &[Return], arrived: f64) -> bool {
    let n = returns.len();
    let phase = |i: &usize| (n - 1 - i).is_multiple_of(point.returns);
    let distance = |i: usize| (&returns[i].state - &point.point).amax();
    let over =
        |range: std::ops::Range<usize>| range.filter(phase).map(distance).fold(0.0, f64::max);
    let (early, late) = (
        over(0..n / 2),
        over(n - n.div_ceil(4).max(point.returns)..n),
    );
    late <= arrived || late <= SHRUNK_TO_SADDLE * early
}

impl Periodic {
    /// Whether the point attracts, beyond doubt.
    pub(crate) fn attracts(&self) -> bool {
        self.multiplier <= 1.0 - NEUTRAL
    }
}

/// The search for a q-periodic point, attracting or not, that returns have come closer to or arrived at.
pub(crate) struct PeriodicSearch<'a> {
    field: &'a AnyField<'a>,
    surface: &'a Surface,
    taylor: &'a mut AnyIntegrator,
    returns: &'a [Return],
    q: usize,
    arrived: f64,
    /// The same of the time that returns take, relatively.
    in_time: f64,
    unit: f64,
    /// Newton's method begins here, goes no farther than `near`, and ends at a step of `converged`: the error is then about
    /// its square, and the integrator's tolerance.
    pub from: Vector,
    pub near: f64,
    pub converged: f64,
    /// What distances must have shrunk to.
    pub shrunk: f64,
}

impl<'a> PeriodicSearch<'a> {
    /// Near the last of these returns, which are good to `accuracy` times a thousand; and q.
    pub fn new(
        field: &'a AnyField<'a>,
        surface: &'a Surface,
        taylor: &'a mut AnyIntegrator,
        returns: &'a [Return],
        (accuracy, q): (f64, usize),
    ) -> Self {
        PeriodicSearch {
            field,
            surface,
            taylor,
            returns,
            q,
            arrived: ARRIVED.max(PER_ACCURACY * accuracy),
            in_time: ARRIVED.max(PER_ACCURACY * accuracy),
            from: returns[returns.len() - 1].state.clone(),
            near: NEAR,
            converged: CONVERGED,
            shrunk: SHRUNK,
            unit: 1.0,
        }
    }

    /// The same where distances are measured in this unit.
    pub fn in_units(mut self, unit: f64) -> Self {
        self.unit = unit;
        self.arrived *= unit;
        self.near *= unit;
        self.converged *= unit;
        self
    }

    /// The point, if there is one.
    pub fn point(&mut self) -> Option<Periodic> {
        let mut point = self.surface.nearest(&self.from);
        let mut size = f64::INFINITY;
        for _ in 0..ITERATIONS {
            let along = self.iterate(&point)?;
            let Landing {
                state: to,
                derivative,
                ..
            } = along.last()?;
            let inside = self.surface.directions(point.as_slice());
            let reduced = reduce(derivative, &inside);
            let residual = inside.transpose() * (to - &point);
            let identity = Matrix::identity(reduced.nrows(), reduced.ncols());
            let step = (identity - &reduced).lu().solve(&residual)?;
            let before = size;
            size = step.amax();
            if !size.is_finite() {
                return None;
            }
            point = self.surface.nearest(&(point + inside * step));
            if (&point - &self.from).amax() > self.near {
                return None;
            }
            // Rounding ends the convergence too, where the map magnifies it.
            if size < self.converged || (size < ROUNDING * self.unit && size >= 0.5 * before) {
                return self.judged(point, &along, size);
            }
        }
        None
    }

    fn judged(&self, point: Vector, along: &[Landing], error: f64) -> Option<Periodic> {
        // An equilibrium on the section is no orbit.
        if equilibrium_near(self.field, point.as_slice(), self.arrived).is_some() {
            return None;
        }
        // A point may come back sooner, where its multipliers turn the returns around it by a part of a turn.
        let sooner = |d: &usize| {
            self.q.is_multiple_of(*d)
                && (&along[d - 1].state - &point).amax() < (SAME * self.unit).max(10.0 * error)
        };
        let q = (1..self.q).find(sooner).unwrap_or(self.q);
        let Landing {
            time, derivative, ..
        } = &along[q - 1];
        let reduced = reduce(derivative, &self.surface.directions(point.as_slice()));
        let moduli = eigenvalues(&reduced)?.into_iter().map(|z| z.norm());
        let multiplier = moduli.fold(0.0, f64::max);
        let n = self.returns.len();
        let phase = |i: &usize| (n - 1 - i).is_multiple_of(self.q);
        let distance = |i: usize| (&self.returns[i].state - &point).amax();
        let over =
            |range: std::ops::Range<usize>| range.filter(phase).map(distance).fold(0.0, f64::max);
        let (early, late) = (over(0..n / 2), over(n - n.div_ceil(4).max(self.q)..n));
        if late > self.arrived && late > self.shrunk * early {
            return None;
        }
        // They also take the time that it takes.
        let off = |i: usize| {
            let took = self.returns[i].time - self.returns[i - q].time;
            (took / time - 1.0).abs()
        };
        let over = |range: std::ops::Range<usize>| range.filter(phase).map(off).fold(0.0, f64::max);
        let (early, late) = (over(q..(n / 2).max(q)), off(n - 1));
        if late > self.in_time && late > self.shrunk * early {
            return None;
        }
        Some(Periodic {
            returns: q,
            period: Uncertain::new(*time, time * (error + ROUNDING_OF_PERIOD)),
            multiplier,
            distance: distance(n - 1),
            point,
            last_step: error,
        })
    }

    /// q returns from a point, each with the time since and the derivative in the point.
    fn iterate(&mut self, from: &Vector) -> Option<Vec<Landing>> {
        // Twice what the run itself took, where it was near.
        let last = self.returns.len() - 1;
        let patience = 2.0 * (self.returns[last].time - self.returns[last - self.q].time);
        let mut along: Vec<Landing> = Vec::with_capacity(self.q);
        for _ in 0..self.q {
            let taylor = &mut *self.taylor;
            let here = along.last();
            let begin = here.map_or(from, |here| &here.state);
            let mut next = return_map(self.field, self.surface, taylor, begin, patience).ok()?;
            if let Some(here) = here {
                next.time += here.time;
                next.derivative *= &here.derivative;
            }
            along.push(next);
        }
        Some(along)
    }
}

/// The part of a derivative within the section.
pub(crate) fn reduce(derivative: &Matrix, inside: &Matrix) -> Matrix {
    inside.transpose() * derivative * inside
}
