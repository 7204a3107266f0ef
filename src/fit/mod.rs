//! From measured friction to parameters with errors: sliders fitted to records of velocity steps by least squares.
//!
//! The friction of a slider and its derivatives in all parameters come from power series along its motion ([`Response`]), the least sum
//! of squares by Levenberg-Marquardt steps ([`minimise`]), standard errors with the noise as the residuals show it
//! ([`Autoregression`]), and 95 % intervals from profiles of the sum of squares ([`Profile`]).

mod compare;
mod free;
mod holds;
mod least_squares;
mod loss;
mod minima;
mod noise;
mod posterior;
mod problem;
mod profile;
mod record;
mod response;
mod sensitivities;
mod shared;
mod slider;
mod start;
mod verdict;

pub use compare::{Comparison, akaike, cross_validation};
pub use free::{DRIFT, FreeParameter, Scale};
pub use holds::{HELD, Hold, Levels, healing_rate, holds, holds_of};
pub use least_squares::{Evaluate, Minimum, Residuals, minimise};
pub use loss::Loss;
pub use minima::minima;
pub use noise::Autoregression;
pub use posterior::{Marginal, Posterior, Prior, QUANTILES, Sampling, posterior};
pub use problem::{FittedRecord, Problem};
use profile::FARTHEST;
pub use profile::{Profile, ProfilePoint};
pub use record::Record;
pub use response::{Response, steady_friction};
pub use sensitivities::by_sensitivities;
pub use shared::Agreement;
pub use slider::{Motion, Sliders, Stretch};
pub use start::{Guess, guesses, spread};
pub use verdict::{Verdict, undecided};

use crate::error::{Error, Result};
use crate::number::singular_values;
use nalgebra::{DMatrix, DVector};
use statrs::distribution::{ContinuousCDF, StudentsT};
use std::ops::Range;

/// Samples that starts are compared by.
const THIN: usize = 400;
/// Steps of a search, and of one that looks where to begin.
const MAX_ITERATIONS: usize = 100;
const FIRST_ITERATIONS: usize = 30;
/// Where the next step would lower the sum of squares by less than this part of the variance of one residual a search has ended: its standard
/// errors are then ten thousand times larger than what is left. Along what the data do not determine each step lowers it by ever less.
const NEGLIGIBLE: f64 = 1e-8;
/// So nearly are starts followed to their minima: which is the best is to be known, not where.
const COMPARED: f64 = 0.1;
/// Starts that are followed to their minima, of those that were compared.
const FOLLOWED: usize = 2;

/// A parameter as it was found.
#[derive(Debug, Clone, PartialEq)]
pub struct FittedParameter {
    /// Its name.
    pub name: String,
    /// Of which of several records it is, by its place among them; of all where none is named.
    pub of_record: Option<usize>,
    /// What it was varied by.
    pub scale: Scale,
    /// In SI.
    pub value: f64,
    /// Its standard error, with the noise as the residuals show it; infinite where the data do not determine it.
    pub uncertainty: f64,
    /// The 95 % interval by the profile of the sum of squares; infinite at an end that it does not have.
    pub interval: (f64, f64),
    /// The standard error over that of white noise of the same variance.
    pub widening: f64,
}

impl FittedParameter {
    /// Its name, and of which record it is where each has its own.
    pub fn label(&self) -> String {
        label(&self.name, self.of_record)
    }
}

fn label(name: &str, of_record: Option<usize>) -> String {
    of_record.map_or_else(
        || name.to_owned(),
        |at| format!("{name} of record {}", at + 1),
    )
}

/// A fit.
#[derive(Debug, Clone, PartialEq)]
pub struct Fit {
    /// The parameters, in the order in which they were asked for.
    pub parameters: Vec<FittedParameter>,
    /// Of the variables: logarithms, where these were varied.
    pub correlation: DMatrix<f64>,
    /// The friction that was fitted, at all times of all records.
    pub fitted: Vec<f64>,
    /// The root of the mean square of measured less fitted friction.
    pub rms: f64,
    /// Observations less parameters.
    pub degrees_of_freedom: usize,
    /// White samples that know as much of a mean as these.
    pub effective_samples: f64,
    /// The noise of each record, as its residuals count.
    pub noise: Vec<Autoregression>,
    /// How many times the friction was computed.
    pub evaluations: usize,
    /// How the sum of squares grows along each parameter; none where intervals are of the linear kind.
    pub profiles: Vec<Profile>,
    /// What is certain of it.
    pub verdict: Verdict,
    /// The variables of the minimum.
    pub variables: Vec<f64>,
}

impl Fit {
    /// The standard error of a quantity with these derivatives in the variables; infinite where it depends on what the data do not determine.
    pub fn propagated(&self, slopes: &[f64]) -> f64 {
        let pairs = slopes.iter().zip(self.standard_errors());
        let each = pairs.map(|(slope, error)| if *slope == 0.0 { 0.0 } else { slope * error });
        let each = DVector::from_iterator(slopes.len(), each);
        let variance = each.dot(&(&self.correlation * &each));
        match variance.is_finite() {
            true => variance.max(0.0).sqrt(),
            false => f64::INFINITY,
        }
    }

    /// The standard errors of the variables.
    pub fn standard_errors(&self) -> Vec<f64> {
        let each = self.parameters.iter();
        each.map(|one| one.uncertainty / one.scale.slope(one.value))
            .collect()
    }
}

/// How 95 % intervals are made.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Intervals {
    /// By profiles.
    Profile,
    /// From the standard errors.
    Linear,
}

/// Fits a problem from the best of some starts, lists of values of the free parameters.
///
/// # Errors
/// [`Error::Input`] where there are fewer observations than parameters, [`Error::NotConverged`] where no start has a friction.
pub fn fit<const N: usize>(
    problem: &Problem<'_, N>,
    starts: &[Vec<f64>],
    intervals: Intervals,
) -> Result<Fit> {
    let (count, free) = (problem.samples(), problem.free.len());
    if count <= free {
        return Err(Error::Input(format!(
            "{count} samples do not determine {free} parameters"
        )));
    }
    let bounds = problem.bounds();
    let (start, mut evaluations) = best_start(problem, starts, &bounds)?;
    let minimum = problem.minimum(&start, &bounds, (MAX_ITERATIONS, NEGLIGIBLE))?;
    evaluations += minimum.evaluations;
    let errors = Errors::of(problem, &minimum)?;
    let quantile = errors.quantile();
    let mut profiles = Vec::new();
    // Where the search has not ended at a minimum there is none that sums of squares could be measured from.
    if intervals == Intervals::Profile && minimum.converged {
        for at in 0..free {
            let profile = Profile::of(problem, (&minimum, &errors), at, quantile);
            evaluations += profile.evaluations;
            profiles.push(profile);
        }
    }
    let parameter = |(at, free): (usize, &FreeParameter)| {
        let x = minimum.variables[at];
        let error = errors.standard[at];
        let interval = match profiles.get(at) {
            Some(profile) => profile.interval,
            None => linear_interval(free.scale, x, quantile * error),
        };
        let value = free.scale.outward(x);
        let is_lost = !error.is_finite();
        FittedParameter {
            name: free.name.clone(),
            of_record: free.of_record,
            scale: free.scale,
            value,
            uncertainty: if is_lost {
                error
            } else {
                free.scale.slope(value) * error
            },
            interval: (
                free.scale.outward(interval.0),
                free.scale.outward(interval.1),
            ),
            widening: errors.widening[at],
        }
    };
    let parameters: Vec<_> = problem.free.iter().enumerate().map(parameter).collect();
    let verdict = undecided(problem, &minimum, &parameters, &errors.correlation);
    Ok(Fit {
        parameters,
        correlation: errors.correlation,
        fitted: errors.fitted,
        rms: errors.rms,
        degrees_of_freedom: count - free,
        effective_samples: errors.effective_samples,
        noise: errors.noise,
        evaluations,
        profiles,
        verdict,
        variables: minimum.variables,
    })
}

/// The ends of an interval on both sides of a variable; none where a profile would not look for one.
fn linear_interval(scale: Scale, x: f64, side: f64) -> (f64, f64) {
    let is_beyond = scale == Scale::Logarithmic && side > FARTHEST.ln();
    let side = if is_beyond { f64::INFINITY } else { side };
    (x - side, x + side)
}

/// The records, as far as starts are compared by them.
fn thinned<const N: usize>(problem: &Problem<'_, N>) -> Vec<Record> {
    let records = problem.records.iter();
    let thinned = records.map(|one| one.record.thinned_along(one.motion, THIN));
    thinned.collect()
}

/// Starts at which there is a friction, as variables with their sums of squares, the least first.
fn ranked<const N: usize>(problem: &Problem<'_, N>, starts: &[Vec<f64>]) -> Vec<(f64, Vec<f64>)> {
    let variables = starts.iter().map(|values| problem.variables(values));
    let mut ranked: Vec<(f64, Vec<f64>)> = variables.map(|x| (problem.cost(&x), x)).collect();
    ranked.retain(|(cost, _)| cost.is_finite());
    ranked.sort_by(|one, other| one.0.total_cmp(&other.0));
    ranked
}

/// The start from which the least sum of squares is reached on a thinned record: the starts with the least sums of squares are followed.
fn best_start<const N: usize>(
    problem: &Problem<'_, N>,
    starts: &[Vec<f64>],
    bounds: &[(f64, f64)],
) -> Result<(Vec<f64>, usize)> {
    let records = thinned(problem);
    let thin = problem.with(&records);
    let ranked = ranked(&thin, starts);
    if ranked.is_empty() {
        // What is in the way of the first says most.
        for start in starts {
            thin.friction(&thin.variables(start)).map_err(|error| {
                let advice = "the starting values that the steps of the record suggest are outside the law's range, as where the friction shows no response above its noise: give starting values, or another record";
                error.advising(advice)
            })?;
        }
    }
    let mut evaluations = starts.len();
    let mut best: Option<(f64, Vec<f64>)> = None;
    for (_, start) in ranked.iter().take(FOLLOWED) {
        // Where a friction has no derivatives another start may have.
        let Ok(minimum) = thin.minimum(start, bounds, (FIRST_ITERATIONS, COMPARED)) else {
            continue;
        };
        evaluations += minimum.evaluations;
        let cost = minimum.residuals.cost();
        if best.as_ref().is_none_or(|(least, _)| cost < *least) {
            best = Some((cost, minimum.variables));
        }
    }
    let (_, variables) = best.ok_or(Error::NotConverged {
        what: "the friction of the slider at any start",
        iterations: starts.len(),
        residual: f64::INFINITY,
        tolerance: 0.0,
    })?;
    Ok((variables, evaluations))
}

/// The errors of a minimum.
#[derive(Debug, Clone, PartialEq)]
pub(crate) struct Errors {
    /// Of each variable.
    pub standard: Vec<f64>,
    /// Over those of white noise.
    pub widening: Vec<f64>,
    pub correlation: DMatrix<f64>,
    /// The same of white noise: (J'J)^-1.
    pub inverse: DMatrix<f64>,
    /// The variance of a residual that counts once.
    pub variance: f64,
    pub effective_samples: f64,
    noise: Vec<Autoregression>,
    fitted: Vec<f64>,
    rms: f64,
}

impl Errors {
    fn of<const N: usize>(problem: &Problem<'_, N>, minimum: &Minimum) -> Result<Self> {
        let jacobian = &minimum.residuals.jacobian;
        let (count, free) = jacobian.shape();
        let fitted = problem.friction(&minimum.variables)?;
        let pairs = problem.measured().zip(&fitted);
        let squares: f64 = pairs.map(|(own, made)| (own - made).powi(2)).sum();
        let rows = problem.rows();
        let counted = |rows: &Range<usize>| &minimum.residuals.values.as_slice()[rows.clone()];
        let noise: Vec<Autoregression> = rows
            .iter()
            .map(|rows| Autoregression::of(counted(rows)))
            .collect();
        let variance = minimum.residuals.cost() / (count - free) as f64;
        // Columns of one length: parameters have units.
        let norms = jacobian.column_iter().map(|column| column.norm());
        let sizes: Vec<f64> = norms.map(|x| if x > 0.0 { x } else { 1.0 }).collect();
        let mut scaled = jacobian.clone();
        for (mut column, size) in scaled.column_iter_mut().zip(&sizes) {
            column /= *size;
        }
        let decomposition = singular_values(scaled.qr().unpack_r(), [false, true]);
        let parts = decomposition.and_then(|made| Some((made.singular_values, made.v_t?)));
        let (values, turned) = parts.ok_or(Error::NotConverged {
            what: "the singular values of the fit",
            iterations: 0,
            residual: f64::INFINITY,
            tolerance: 0.0,
        })?;
        // A direction in which nothing changes is not determined at all, and neither are the parameters that it turns.
        let least = values.max() * free as f64 * f64::EPSILON;
        let inverses = values.map(|s| if s > least { 1.0 / s } else { 0.0 });
        let is_lost = |i: usize| {
            let mut lost = (0..free).filter(|&k| inverses[k] == 0.0);
            lost.any(|k| turned[(k, i)].abs() > f64::EPSILON.sqrt())
        };
        let lost: Vec<bool> = (0..free).map(is_lost).collect();
        let root = turned.transpose() * DMatrix::from_diagonal(&inverses);
        let mut inverse = &root * root.transpose();
        for ((i, j), x) in (0..free)
            .flat_map(|j| (0..free).map(move |i| (i, j)))
            .zip(inverse.as_mut_slice())
        {
            *x /= sizes[i] * sizes[j];
        }
        let white = &inverse * variance;
        // Records know nothing of each other's noise.
        let within = noise.iter().zip(&rows).map(|(noise, rows)| {
            let own = jacobian.rows(rows.start, rows.len()).into_owned();
            noise.covariance_of(&own)
        });
        let within = within.fold(DMatrix::zeros(free, free), |all, one| all + one);
        let sandwich = &inverse * within * &inverse;
        // As variances of residuals go: what the parameters took from them.
        let sandwich = sandwich * (count as f64 / (count - free) as f64);
        let root = |x: f64| {
            if x.is_finite() {
                x.max(0.0).sqrt()
            } else {
                f64::INFINITY
            }
        };
        let of = |i: usize| {
            if lost[i] {
                f64::INFINITY
            } else {
                root(sandwich[(i, i)])
            }
        };
        let standard: Vec<f64> = (0..free).map(of).collect();
        let ratio = |i: usize| standard[i] / root(white[(i, i)]);
        let finite = |x: f64| if x.is_nan() { 1.0 } else { x };
        let widening = (0..free).map(|i| finite(ratio(i))).collect();
        let correlation = DMatrix::from_fn(free, free, |i, j| {
            if i == j {
                return 1.0;
            }
            let rho = sandwich[(i, j)] / (standard[i] * standard[j]);
            if rho.is_finite() {
                rho.clamp(-1.0, 1.0)
            } else {
                0.0
            }
        });
        let effective = noise.iter().zip(&rows).map(|(noise, rows)| {
            let squares: f64 = counted(rows).iter().map(|x| x * x).sum();
            (squares / noise.long_run_variance()).min(rows.len() as f64)
        });
        Ok(Errors {
            widening,
            correlation,
            inverse,
            variance,
            effective_samples: effective.sum(),
            noise,
            rms: (squares / count as f64).sqrt(),
            fitted,
            standard,
        })
    }

    /// How many standard errors a 95 % interval goes to each side.
    fn quantile(&self) -> f64 {
        let free = self.standard.len() as f64;
        let freedom = f64::max(self.effective_samples - free, 1.0);
        StudentsT::new(0.0, 1.0, freedom).map_or(1.96, |t| t.inverse_cdf(0.975))
    }
}
