//! Profiles: how the least sum of squares grows as one parameter is held beside its best value, and the interval that follows.
//!
//! The interval holds the values at which the sum of squares, all other parameters being fitted, is at most t^2 times the variance of a
//! residual above its least: where the slider is not linear in the parameter it is not symmetric, and it may have no end. Noise that is
//! not white lets sums of squares grow more than they tell: they are measured in the variance that the standard error has.

use super::least_squares::Minimum;
use super::problem::Problem;
use super::{Errors, FIRST_ITERATIONS, Scale};

/// Points on a side, at most.
const MOST_POINTS: usize = 12;
/// How near to the end of an interval a point must be, in the distance that it has from there.
const NEAR: f64 = 0.01;
/// The sums of squares along a profile, in variances of a residual: those at the end of an interval are then known ten times better than
/// [`NEAR`] asks for.
const ENOUGH: f64 = 1e-3;
/// A factor by which a parameter may differ from its best value: further it is not looked for.
pub(super) const FARTHEST: f64 = 1e3;
/// The same of a parameter that is varied itself, in standard errors.
const FARTHEST_LINEAR: f64 = 100.0;

/// A point of a profile.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct ProfilePoint {
    /// The variable that is held.
    pub variable: f64,
    /// The root of what the sum of squares has grown by, in standard deviations: t, negative below the best value. Of a linear problem
    /// it is the distance in standard errors.
    pub deviation: f64,
}

/// The profile of a parameter.
#[derive(Debug, Clone, PartialEq)]
pub struct Profile {
    /// Ascending.
    pub points: Vec<ProfilePoint>,
    /// Of the variable, infinite at an end that was not found.
    pub interval: (f64, f64),
    /// How many times the friction was computed.
    pub evaluations: usize,
}

impl Profile {
    /// That of the parameter `at`, up to `quantile` standard deviations.
    pub(super) fn of<const N: usize>(
        problem: &Problem<'_, N>,
        (minimum, errors): (&Minimum, &Errors),
        at: usize,
        quantile: f64,
    ) -> Self {
        let best = minimum.variables[at];
        let mut profile = Profile {
            points: vec![ProfilePoint {
                variable: best,
                deviation: 0.0,
            }],
            interval: (best, best),
            evaluations: 0,
        };
        let side = Side {
            problem,
            minimum,
            errors,
            at,
        };
        for sign in [-1.0, 1.0] {
            let end = side.end(sign, quantile, &mut profile);
            if sign < 0.0 {
                profile.interval.0 = end;
            } else {
                profile.interval.1 = end;
            }
        }
        profile
            .points
            .sort_by(|one, other| one.variable.total_cmp(&other.variable));
        profile
    }
}

struct Side<'a, const N: usize> {
    problem: &'a Problem<'a, N>,
    minimum: &'a Minimum,
    errors: &'a Errors,
    at: usize,
}

impl<const N: usize> Side<'_, N> {
    /// Where the profile reaches the quantile, below the best value or above it.
    fn end(&self, sign: f64, quantile: f64, profile: &mut Profile) -> f64 {
        let (at, best) = (self.at, self.minimum.variables[self.at]);
        let error = self.errors.standard[at];
        let limit = match self.problem.free[at].scale {
            Scale::Logarithmic => FARTHEST.ln(),
            Scale::Linear => FARTHEST_LINEAR * error,
        };
        let (low, high) = self.problem.bounds()[at];
        let bound = if sign < 0.0 { best - low } else { high - best };
        let limit = limit.min(bound);
        if !(error.is_finite() && limit > 0.0) {
            return sign * f64::INFINITY;
        }
        // The distance is sought at which the deviation is the quantile: of a linear problem the first guess.
        let (mut below, mut above) = ((0.0, 0.0), None::<(f64, f64)>);
        let mut distance = f64::min(quantile * error, limit);
        let mut others = self.minimum.variables.clone();
        for _ in 0..MOST_POINTS {
            let Some(deviation) = self.deviation(sign * distance, &mut others, profile) else {
                // The end is not nearer than where it may be.
                return above.map_or(sign * f64::INFINITY, |(far, _)| best + sign * far);
            };
            if (deviation - quantile).abs() <= NEAR * quantile {
                // The rest along the secant.
                return best + sign * distance * quantile / deviation;
            }
            if deviation < quantile {
                if distance >= limit {
                    return sign * f64::INFINITY;
                }
                below = (distance, deviation);
            } else {
                above = Some((distance, deviation));
            }
            distance = match above {
                Some((far, more)) if more.is_finite() => {
                    let part = (quantile - below.1) / (more - below.1);
                    // Not nearer to either end than a tenth: the profile is not straight.
                    below.0 + (far - below.0) * part.clamp(0.1, 0.9)
                }
                Some((far, _)) => 0.5 * (below.0 + far),
                None => {
                    let grown = below.0 * (quantile / below.1.max(1e-3)).clamp(1.2, 3.0);
                    grown.min(limit)
                }
            };
        }
        best + sign * distance
    }

    /// The deviation where the variable is held at a distance, the others being fitted from where they were before; `None` where their search
    /// does not end, along what the data do not determine, or cannot begin: the sum of squares that it has come to is not the least one.
    fn deviation(&self, moved: f64, others: &mut Vec<f64>, profile: &mut Profile) -> Option<f64> {
        let at = self.at;
        let variable = self.minimum.variables[at] + moved;
        let mut bounds = self.problem.bounds();
        // The others where they were or at the minimum, still or moved as those of a linear problem are: what the data do not determine may then
        // go far astray.
        let inverse = &self.errors.inverse;
        let moved_from = |from: &[f64], part: f64| {
            let shift = part * (variable - from[at]) / inverse[(at, at)];
            let each = from.iter().zip(&bounds).enumerate();
            let mut start: Vec<f64> = each
                .map(|(j, (x, (low, high)))| (x + shift * inverse[(j, at)]).clamp(*low, *high))
                .collect();
            start[at] = variable;
            (self.problem.cost(&start), start)
        };
        let mut from = vec![others.as_slice()];
        if *others != self.minimum.variables {
            from.push(&self.minimum.variables);
        }
        let starts = from
            .iter()
            .map(|from| [0.0, 1.0].map(|part| moved_from(from, part)));
        let starts: Vec<_> = starts.collect();
        profile.evaluations += 2 * starts.len();
        let lowest = starts
            .into_iter()
            .flatten()
            .min_by(|a, b| a.0.total_cmp(&b.0));
        let (_, start) = lowest?;
        bounds[at] = (variable, variable);
        let searched = self
            .problem
            .minimum(&start, &bounds, (FIRST_ITERATIONS, ENOUGH));
        profile.evaluations += searched.as_ref().map_or(1, |found| found.evaluations);
        let found = searched.ok()?;
        if !found.converged {
            return None;
        }
        let grown = found.residuals.cost() - self.minimum.residuals.cost();
        let widening = self.errors.widening[at];
        let deviation = (grown.max(0.0) / self.errors.variance).sqrt() / widening;
        *others = found.variables;
        profile.points.push(ProfilePoint {
            variable,
            deviation: deviation.copysign(moved),
        });
        Some(deviation)
    }
}
