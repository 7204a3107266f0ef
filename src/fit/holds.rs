//! Slide-hold-slide: how far friction falls in a hold, to which peak it rises as sliding goes on, and how that heals with the time of the hold.

use super::Fit;
use super::noise::Autoregression;
use super::problem::Problem;
use super::response::TOLERANCE;
use super::slider::{Motion, Stretch};
use crate::error::Result;
use crate::number::Uncertain;
use nalgebra::{DMatrix, DVector};
use std::ops::Range;

/// A load point that is slower than this part of its velocity before is held.
pub const HELD: f64 = 1e-2;

/// Friction in a hold and after it.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Levels {
    /// At the end of the hold, where it is least.
    pub minimum: Option<Uncertain>,
    /// The largest one as sliding goes on; none where it still rises at the end.
    pub peak: Option<Uncertain>,
    /// The peak less the friction before the hold.
    pub healing: Option<Uncertain>,
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
    /// As it was measured, with standard errors; none where samples are missing.
    pub measured: Levels,
    /// As the fit has it, with the standard errors of its parameters.
    pub fitted: Levels,
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
                record,
            };
            let (fitted, at) = model.levels(start, end, after)?;
            found.push(Hold {
                record,
                start,
                duration: end - start,
                measured: shown.levels(&model, (start, end, after), &at),
                fitted,
            });
        }
    }
    Ok(found)
}

/// The friction of the fit before the hold, at its end and at the peak, and when that is.
struct At {
    before: f64,
    minimum: f64,
    peak: Option<(f64, f64)>,
}

struct Model<'a, const N: usize> {
    problem: &'a Problem<'a, N>,
    fit: &'a Fit,
    record: usize,
}

impl<const N: usize> Model<'_, N> {
    /// The friction at ascending times and its derivatives in the variables.
    fn response(&self, times: &[f64]) -> Result<(Vec<f64>, DMatrix<f64>)> {
        let moved = self.problem.records[self.record].motion.displacement(times);
        let at = (times, &moved[..]);
        let variables = &self.fit.variables;
        self.problem
            .response_of(self.record, at, variables, TOLERANCE)
    }

    /// When friction is largest between two times; none where it rises to the end.
    fn peak(&self, from: f64, to: f64) -> Result<Option<f64>> {
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
        let at = dense[look(&dense)?];
        Ok((at < to).then_some(at))
    }

    /// What the fit has, with errors of its parameters. At the peak friction does not change with time, so that its derivatives are those at
    /// a fixed time.
    fn levels(&self, start: f64, end: f64, after: f64) -> Result<(Levels, At)> {
        let peak = self.peak(end, after)?;
        let times: Vec<f64> = [start, end].into_iter().chain(peak).collect();
        let (friction, slopes) = self.response(&times)?;
        let row = |i: usize| slopes.row(i).transpose();
        let known = |value: f64, slopes: &DVector<f64>| {
            Uncertain::new(value, self.fit.propagated(slopes.as_slice()))
        };
        let levels = Levels {
            minimum: Some(known(friction[1], &row(1))),
            peak: peak.map(|_| known(friction[2], &row(2))),
            healing: peak.map(|_| known(friction[2] - friction[0], &(row(2) - row(0)))),
        };
        let at = At {
            before: friction[0],
            minimum: friction[1],
            peak: peak.map(|peak| (peak, friction[2])),
        };
        Ok((levels, at))
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
    ) -> Levels {
        let rows = |from: f64, to: f64| {
            let first = self.times.partition_point(|&t| t < from);
            first..self.times.partition_point(|&t| t <= to)
        };
        let fitted = &model.fit.fitted[model.problem.rows()[model.record].clone()];
        let flat = |span: (f64, f64), near: f64, level: f64| {
            self.flat(fitted, rows(span.0, span.1), near, level)
        };
        let before = flat((self.times[0], start), start, at.before);
        let least = flat((start, end), end, at.minimum);
        let most = at
            .peak
            .and_then(|(time, level)| Some((flat((end, after), time, level)?, level)));
        Levels {
            minimum: least.map(|rows| self.mean(at.minimum, &[(&rows, 1.0)])),
            peak: most
                .as_ref()
                .map(|(rows, level)| self.mean(*level, &[(rows, 1.0)])),
            healing: most.zip(before).map(|((most, level), before)| {
                self.mean(level - at.before, &[(&most, 1.0), (&before, -1.0)])
            }),
        }
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
    fn mean(&self, fitted: f64, windows: &[(&Range<usize>, f64)]) -> Uncertain {
        let mut weights = DMatrix::zeros(self.residuals.len(), 1);
        for (rows, sign) in windows {
            let by = sign / rows.len() as f64;
            let mut column = weights.view_mut((rows.start, 0), (rows.len(), 1));
            column.add_scalar_mut(by);
        }
        let pairs = self.residuals.iter().zip(weights.iter());
        let off: f64 = pairs.map(|(residual, weight)| residual * weight).sum();
        let variance = self.noise.covariance_of(&weights)[(0, 0)];
        Uncertain::new(fitted + off, variance.sqrt())
    }
}

/// How healing grows per decade of the hold's duration: the slope of a straight line against its logarithm to base 10, by weights of inverse
/// variances, or of equal weights where nothing has an error; its error counts how far the holds are from a line. None where there are no two
/// durations.
pub fn healing_rate(holds: impl IntoIterator<Item = (f64, Uncertain)>) -> Option<Uncertain> {
    /// Durations that are the same but for rounding, in decades.
    const SAME: f64 = 1e-6;
    let known = |(_, one): &(f64, Uncertain)| one.uncertainty.is_finite();
    let all: Vec<(f64, Uncertain)> = holds.into_iter().filter(known).collect();
    let is_exact = all.iter().all(|(_, one)| one.uncertainty == 0.0);
    let weighted = |(duration, one): &(f64, Uncertain)| {
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
    if !apart || points.iter().any(|(_, _, w)| !w.is_finite()) {
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
    Some(Uncertain::new(slope, (scatter / spread).sqrt()))
}
