//! Slide-hold-slide: how far friction falls in a hold, to which peak it rises as sliding goes on, and how that heals with the time of the hold.

use super::Fit;
use super::noise::Autoregression;
use super::problem::Problem;
use super::response::Response;
use super::slider::{Motion, Stretch};
use crate::error::Result;
use nalgebra::{DMatrix, DVector};
use std::ops::Range;

/// A load point that is slower than this part of its velocity before is held.
pub(super) const HELD: f64 = 1e-2;

/// A number and its standard error.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Estimate {
    /// The number.
    pub value: f64,
    /// Its standard error.
    pub uncertainty: f64,
}

/// Friction in a hold and after it.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Levels<T> {
    /// At the end of the hold, where it is least.
    pub minimum: T,
    /// The largest one as sliding goes on.
    pub peak: T,
    /// The peak less the friction before the hold.
    pub healing: T,
}

/// A hold that a record shows.
#[derive(Debug, Clone, PartialEq)]
pub struct Hold {
    /// Of which record, by its place among them.
    pub record: usize,
    /// When it begins, in s.
    pub start: f64,
    /// How long it lasts, in s.
    pub duration: f64,
    /// As it was measured; none where samples are missing before it, at its end or after it.
    pub measured: Option<Levels<Estimate>>,
    /// As the fit has it.
    pub fitted: Levels<Estimate>,
}

/// The holds of a motion: when they begin and end, and when sliding after them does, in s.
pub fn holds_of(motion: &Motion) -> Vec<(f64, f64, f64)> {
    let all = &motion.stretches;
    let mut holds = Vec::new();
    let mut i = 0;
    while i < all.len() {
        let slides = all[..i].iter().rev().map(|one| one.velocity.1);
        let before = slides.chain([motion.before]).find(|v| *v > 0.0);
        let is_held = |one: &Stretch| {
            let most = HELD * before.unwrap_or(0.0);
            one.velocity.0 <= most && one.velocity.1 <= most
        };
        let length = all[i..].iter().take_while(|one| is_held(one)).count();
        let after = all.get(i + length);
        if let (true, Some(_)) = (length > 0, after) {
            // Until the velocity falls again.
            let rest = &all[i + length..];
            let ends = rest.windows(2).find(|pair| {
                pair[1].velocity.0 < pair[0].velocity.1 || pair[1].velocity.1 < pair[1].velocity.0
            });
            let end = ends.map_or(rest[rest.len() - 1].span.1, |pair| pair[0].span.1);
            holds.push((all[i].span.0, all[i + length - 1].span.1, end));
        }
        i += length.max(1);
    }
    holds
}

/// All holds of the records that a fit is of. What was measured is the mean of samples where the fit changes by less than the noise, each less
/// what the fit has changed.
///
/// # Errors
/// Those of the friction.
pub fn holds<const N: usize>(problem: &Problem<'_, N>, fit: &Fit) -> Result<Vec<Hold>> {
    let mut found = Vec::new();
    let covariance = covariance(fit);
    for (record, rows) in problem.rows().into_iter().enumerate() {
        let one = &problem.records[record];
        let spans = holds_of(one.motion);
        if spans.is_empty() {
            continue;
        }
        let residuals = one.record.friction.iter().zip(&fit.fitted[rows]);
        let residuals: Vec<f64> = residuals.map(|(own, made)| own - made).collect();
        let shown = Shown {
            noise: Autoregression::of(&residuals),
            times: &one.record.times,
            residuals,
        };
        for (start, end, after) in spans {
            let model = Model {
                problem,
                fit,
                covariance: &covariance,
                record,
            };
            let (fitted, at) = model.levels(start, end, after)?;
            found.push(Hold {
                record,
                start,
                duration: end - start,
                measured: shown.levels(&model, (start, end, after), &at)?,
                fitted,
            });
        }
    }
    Ok(found)
}

/// Of the variables.
fn covariance(fit: &Fit) -> DMatrix<f64> {
    let errors = fit.standard_errors();
    DMatrix::from_fn(errors.len(), errors.len(), |i, j| {
        fit.correlation[(i, j)] * errors[i] * errors[j]
    })
}

/// The friction of the fit at the end of the hold, at the peak and before the hold, and when the peak is.
struct At {
    peak: f64,
    friction: [f64; 3],
}

struct Model<'a, const N: usize> {
    problem: &'a Problem<'a, N>,
    fit: &'a Fit,
    covariance: &'a DMatrix<f64>,
    record: usize,
}

impl<const N: usize> Model<'_, N> {
    /// The friction at ascending times and its derivatives in the variables.
    fn response(&self, times: &[f64]) -> Result<(Vec<f64>, DMatrix<f64>)> {
        let (problem, record) = (self.problem, self.record);
        let one = &problem.records[record];
        let (places, columns) = problem.places(record);
        let (parameters, drift) = problem.parameters_at(record, &self.fit.variables);
        let given = (&parameters[..], &places[..]);
        let response = Response::of(problem.sliders, one.motion, times, given)?;
        let mut slopes = DMatrix::zeros(times.len(), problem.free.len());
        for (j, &column) in columns.iter().enumerate() {
            let by = problem.free[column].scale.slope(parameters[places[j]]);
            slopes.set_column(column, &(response.derivatives.column(j) * by));
        }
        let moved = one.motion.displacement(times);
        if let Some(column) = problem.drift_column(record) {
            slopes.column_mut(column).copy_from_slice(&moved);
        }
        let with_drift = response.friction.iter().zip(&moved);
        Ok((with_drift.map(|(mu, x)| mu + drift * x).collect(), slopes))
    }

    /// When friction is largest between two times.
    fn peak(&self, from: f64, to: f64) -> Result<f64> {
        /// Times that are looked at, twice; at first ever more sparsely.
        const LOOKED_AT: usize = 200;
        let look = |times: &[f64]| -> Result<usize> {
            let (friction, _) = self.response(times)?;
            let all = friction.iter().enumerate();
            let most = all.max_by(|one, other| one.1.total_cmp(other.1));
            Ok(most.map_or(0, |(i, _)| i))
        };
        let part = |i: usize| i as f64 / (LOOKED_AT - 1) as f64;
        let sparse: Vec<f64> = (0..LOOKED_AT)
            .map(|i| from + (to - from) * part(i).powi(4))
            .collect();
        let i = look(&sparse)?;
        let (low, high) = (
            sparse[i.saturating_sub(1)],
            sparse[(i + 1).min(LOOKED_AT - 1)],
        );
        let dense: Vec<f64> = (0..LOOKED_AT)
            .map(|i| low + (high - low) * part(i))
            .collect();
        Ok(dense[look(&dense)?])
    }

    /// What the fit has, with errors of its parameters. At the peak friction does not change with time, so that its derivatives are those at
    /// a fixed time.
    fn levels(&self, start: f64, end: f64, after: f64) -> Result<(Levels<Estimate>, At)> {
        let peak = self.peak(end, after)?;
        let (friction, slopes) = self.response(&[start, end, peak])?;
        let estimate = |value: f64, slope: &DVector<f64>| Estimate {
            value,
            uncertainty: (self.covariance * slope).dot(slope).max(0.0).sqrt(),
        };
        let [before, least, most] = [0, 1, 2].map(|i| slopes.row(i).transpose());
        let levels = Levels {
            minimum: estimate(friction[1], &least),
            peak: estimate(friction[2], &most),
            healing: estimate(friction[2] - friction[0], &(most - before)),
        };
        let friction = [friction[0], friction[1], friction[2]];
        Ok((levels, At { peak, friction }))
    }
}

/// A record beside its fit.
struct Shown<'a> {
    noise: Autoregression,
    times: &'a [f64],
    residuals: Vec<f64>,
}

impl Shown<'_> {
    /// What was measured of a hold.
    fn levels<const N: usize>(
        &self,
        model: &Model<'_, N>,
        (start, end, after): (f64, f64, f64),
        at: &At,
    ) -> Result<Option<Levels<Estimate>>> {
        let rows = |from: f64, to: f64| {
            let first = self.times.partition_point(|&t| t < from);
            first..self.times.partition_point(|&t| t <= to)
        };
        let fitted = &model.fit.fitted[model.problem.rows()[model.record].clone()];
        let flat = |rows: Range<usize>, near: f64, level: f64| self.flat(fitted, rows, near, level);
        let begun = self.times[0];
        let [before, least, most] = at.friction;
        let windows = (
            flat(rows(begun, start), start, before),
            flat(rows(start, end), end, least),
            flat(rows(end, after), at.peak, most),
        );
        let (Some(before_rows), Some(least_rows), Some(most_rows)) = windows else {
            return Ok(None);
        };
        let minimum = self.estimate(least, &[(&least_rows, 1.0)]);
        let peak = self.estimate(most, &[(&most_rows, 1.0)]);
        let both = [(&most_rows, 1.0), (&before_rows, -1.0)];
        let healing = self.estimate(most - before, &both);
        Ok(Some(Levels {
            minimum,
            peak,
            healing,
        }))
    }

    /// The rows around a time at which the fit is within the noise of a level; none where there is no sample among them.
    fn flat(
        &self,
        fitted: &[f64],
        rows: Range<usize>,
        near: f64,
        level: f64,
    ) -> Option<Range<usize>> {
        let deviation = self.deviation();
        let is_flat = |i: &usize| (fitted[*i] - level).abs() <= deviation;
        let at = rows.clone().min_by(|&i, &j| {
            let off = |i: usize| (self.times[i] - near).abs();
            off(i).total_cmp(&off(j))
        })?;
        if !is_flat(&at) {
            return None;
        }
        let first = (rows.start..=at).rev().take_while(is_flat).last()?;
        let last = (at..rows.end).take_while(is_flat).last()?;
        Some(first..last + 1)
    }

    /// Of the noise.
    fn deviation(&self) -> f64 {
        let squares: f64 = self.residuals.iter().map(|x| x * x).sum();
        (squares / self.residuals.len() as f64).sqrt()
    }

    /// A value of the fit with the mean residuals of some rows, and the standard error of these.
    fn estimate(&self, fitted: f64, windows: &[(&Range<usize>, f64)]) -> Estimate {
        let mut weights = DMatrix::zeros(self.residuals.len(), 1);
        for (rows, sign) in windows {
            let by = sign / rows.len() as f64;
            let mut column = weights.view_mut((rows.start, 0), (rows.len(), 1));
            column.add_scalar_mut(by);
        }
        let pairs = self.residuals.iter().zip(weights.iter());
        let off: f64 = pairs.map(|(residual, weight)| residual * weight).sum();
        let variance = self.noise.covariance_of(&weights)[(0, 0)];
        Estimate {
            value: fitted + off,
            uncertainty: variance.max(0.0).sqrt(),
        }
    }
}

/// How healing grows per decade of the hold's duration: the slope of a straight line against its logarithm to base 10, by weights of inverse
/// variances, or of equal weights where nothing has an error; its error counts how far the holds are from a line. None where there are no two
/// durations.
pub fn healing_rate(holds: impl IntoIterator<Item = (f64, Estimate)>) -> Option<Estimate> {
    /// Durations that are the same but for rounding, in decades.
    const SAME: f64 = 1e-6;
    let all: Vec<(f64, Estimate)> = holds.into_iter().collect();
    let is_exact = all.iter().all(|(_, one)| one.uncertainty == 0.0);
    let weighted = |(duration, one): &(f64, Estimate)| {
        let weight = if is_exact {
            1.0
        } else {
            one.uncertainty.powi(-2)
        };
        (duration.log10(), one.value, weight)
    };
    let points: Vec<(f64, f64, f64)> = all.iter().map(weighted).collect();
    let apart = points
        .iter()
        .any(|(own, _, _)| (own - points[0].0).abs() >= SAME);
    if !apart || points.iter().any(|(_, _, w)| !w.is_finite() || *w == 0.0) {
        return None;
    }
    let sum = |of: &dyn Fn(&(f64, f64, f64)) -> f64| points.iter().map(of).sum::<f64>();
    let weight = sum(&|(_, _, w)| *w);
    let (x, y) = (
        sum(&|(x, _, w)| w * x) / weight,
        sum(&|(_, y, w)| w * y) / weight,
    );
    let spread = sum(&|(own, _, w)| w * (own - x).powi(2));
    let slope = sum(&|(own, value, w)| w * (own - x) * (value - y)) / spread;
    let off = sum(&|(own, value, w)| w * (value - y - slope * (own - x)).powi(2));
    let scatter = off / (points.len() - 2).max(1) as f64;
    let scatter = if is_exact { scatter } else { scatter.max(1.0) };
    Some(Estimate {
        value: slope,
        uncertainty: (scatter / spread).sqrt(),
    })
}
