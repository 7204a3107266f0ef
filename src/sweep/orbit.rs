//! The orbit through a periodic point: its period and what is seen along it, and how fast runs come nearer.

use super::watch::{see, turn};
use crate::error::Error;
use crate::field::{Matrix, Vector};
use crate::integrate::{AnyField, AnyIntegrator, AnyStep, Control};
use crate::number::{DoubleDouble, Uncertain, eigenvalues};
use crate::section::{Periodic, STEPS_OF_PIECE, Surface, derivative_along, reduce};

/// The tolerance with which an orbit is gone round once, for its period and what is seen.
pub(super) const TOLERANCE: f64 = 1e-11;
/// The relative error of the derivative once around, in tolerances; and what the change of a multiplier from one point to the next,
/// which tells how it changes from there, is taken times. An orbit is gone round until these changes are below that error, and so
/// often: the first point is off by the tolerance of the runs, which may matter more than all else.
const DERIVATIVE_PER_RTOL: f64 = 30.0;
const ROUNDS: usize = 3;
const CHANGE: f64 = 3.0;
/// Newton's method has not come nearer if a step is longer than this part of the one before.
const NEARER: f64 = 0.1;

/// What is known of an orbit.
pub(super) struct Around {
    /// The point that the period and the multiplier are of.
    pub point: Vector,
    pub period: f64,
    /// The least and the greatest value of the variable that is watched.
    pub range: (f64, f64),
    /// The largest difference between the last two variables.
    pub unlike: f64,
    /// The largest exponent across the flow, where it can be told from rounding.
    pub exponent: Option<Uncertain>,
}

/// Goes round the orbit through a point, by an integrator of the tolerance [`TOLERANCE`] or below, and watches a variable on the way.
pub(super) fn around(
    field: &AnyField<'_>,
    surface: &Surface,
    fine: &mut AnyIntegrator,
    found: &Periodic,
    watched: usize,
) -> Option<Around> {
    let mut range = (found.point[watched], found.point[watched]);
    let mut unlike = 0.0_f64;
    let (mut point, mut period) = (found.point.clone(), found.period.value);
    let (mut before, mut step) = (found.multiplier, found.last_step);
    let mut largest: Option<Uncertain> = None;
    let mut told: Option<(Vector, f64)> = None;
    // What the period that is told may be off by, and the period of the point before.
    let (mut period_off, mut period_before) = (found.period.uncertainty, period);
    for round in 0..ROUNDS {
        let mut points = vec![(DoubleDouble::ZERO, point.clone())];
        let mut steps = 0;
        let mut observer = |step: &AnyStep<'_>| {
            see(&mut range, step.y1[watched]);
            let series = step.series().ok_or(Error::NotAnalytic)?;
            if let Some(turn) = turn(series, watched) {
                see(&mut range, turn);
            }
            let last = step.y1.len() - 1;
            unlike = unlike.max((step.y1[last - 1] - step.y1[last]).abs());
            steps += 1;
            if steps % STEPS_OF_PIECE == 0 {
                let end = series.begin() + series.length();
                points.push((end, Vector::from_column_slice(step.y1)));
            }
            Ok(Control::Continue)
        };
        let flown = fine.flow(field, (0.0, period), &point, Some(&mut observer));
        let end = flown.ok()?;
        // The point is known better than the time: to the first order it ends on the section.
        let rate = surface.rate(end.as_slice(), &field.f(&end));
        period -= surface.height(end.as_slice()) / rate;
        if told.is_none() {
            told = Some((point.clone(), period));
        }
        let period_change = (period - period_before).abs();
        points.retain(|(begin, _)| begin.hi() < period);
        let now = DoubleDouble::from(period);
        let along = derivative_along(field, surface, fine, &points, now);
        let along = largest_multiplier(surface, &point, &along.ok()?);
        let Some(Revolution { mu, error, left }) = along.filter(|_| before > 0.0) else {
            break;
        };
        let part = left.amax() / step;
        // The change of mu that is left is extrapolated from its change over the last step. The step to the first point was made with a coarser map, and
        // may be much shorter than the step that is left.
        let changes = |part: f64| CHANGE * (mu / before).ln().abs() * part;
        let here = Uncertain::new(mu.ln(), changes(part.min(1.0)) + error);
        let is_no_better = match round {
            0 => false,
            // If Newton's method has come no nearer, the step was noise, as on a stiff orbit, and the first point is as good.
            1 => part > NEARER,
            _ => largest.is_some_and(|best| best.uncertainty <= here.uncertainty),
        };
        if is_no_better {
            break;
        }
        largest = Some(here);
        told = Some((point.clone(), period));
        if round > 0 {
            let rounding = DERIVATIVE_PER_RTOL * TOLERANCE * period;
            period_off = CHANGE * period_change * part.min(1.0) + rounding;
        }
        let by_period = here.value.abs() * period_off / period;
        if changes(part) <= error && by_period <= error {
            break;
        }
        period_before = period;
        point = surface.nearest(&(point + &left));
        (before, step) = (mu, left.amax());
    }
    let (point, period) = told?;
    let exponent = largest.map(|ln| {
        // The period is that of a point a little beside the orbit.
        let by_period = ln.value.abs() * period_off / period;
        Uncertain::new(ln.value / period, (ln.uncertainty + by_period) / period)
    });
    Some(Around {
        point,
        period,
        range,
        unlike,
        exponent,
    })
}

/// Once around from a point.
struct Revolution {
    /// The largest multiplier, its modulus.
    mu: f64,
    /// What its logarithm errs by.
    error: f64,
    /// What Newton's method would move the point by.
    left: Vector,
}

/// The largest multiplier by where the way around ends and its derivative; `None` where mu is too small to be told from rounding.
fn largest_multiplier(
    surface: &Surface,
    point: &Vector,
    (end, derivative): &(Vector, Matrix),
) -> Option<Revolution> {
    const LEAST: f64 = 1e-6;
    let inside = surface.directions(point.as_slice());
    let reduced = reduce(derivative, &inside);
    let values = eigenvalues(&reduced)?;
    let norms = values.iter().map(|z| z.norm());
    let (place, mu) = norms.enumerate().max_by(|a, b| a.1.total_cmp(&b.1))?;
    if !(mu > LEAST && mu.is_finite()) {
        return None;
    }
    let identity = Matrix::identity(reduced.nrows(), reduced.ncols());
    let left = (identity - &reduced)
        .lu()
        .solve(&(inside.transpose() * (end - point)))?;
    // A double multiplier errs by the root of what the derivative does.
    let error = DERIVATIVE_PER_RTOL * TOLERANCE;
    let others = values.iter().enumerate().filter(|(i, _)| *i != place);
    let apart = others.map(|(_, z)| (values[place] - z).norm());
    let (size, apart) = (reduced.norm(), apart.fold(f64::INFINITY, f64::min));
    let double = size / apart.max(error.sqrt() * size);
    Some(Revolution {
        mu,
        error: error * size / mu * double.max(1.0),
        left: inside * left,
    })
}
