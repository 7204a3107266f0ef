//! The posterior's density: the likelihood of records under autoregressive noise, and the priors.

use super::super::free::FreeParameter;
use super::super::noise::Autoregression;
use super::super::problem::Problem;
use super::compressed::Compressed;
use super::prior::{Prior, Unbounded};
use crate::error::Result;
use nalgebra::{DMatrix, DVector};
use std::ops::Range;

/// What steps may err by where friction is compared with that of a minimum: some ten thousandths of the noise of records.
const COARSE: f64 = 3e-8;

/// The density of the variables of a problem as numbers without bounds.
pub(super) struct Density<'a, const N: usize> {
    pub problem: &'a Problem<'a, N>,
    pub priors: &'a [Prior],
    /// Of each record, as its residuals count.
    pub noise: &'a [Autoregression],
    bounds: Vec<Unbounded>,
}

/// The records as few points, about a minimum.
pub(super) struct About {
    records: Vec<Compressed>,
    /// The times of the nodes.
    times: Vec<Vec<f64>>,
    /// The friction there, at the minimum, and the slope of each record.
    friction: Vec<Vec<f64>>,
    slopes: Vec<f64>,
}

impl<'a, const N: usize> Density<'a, N> {
    pub fn new(
        problem: &'a Problem<'a, N>,
        priors: &'a [Prior],
        noise: &'a [Autoregression],
    ) -> Self {
        let pairs = problem.free.iter().zip(priors);
        let bounds = pairs.map(|(free, prior)| Unbounded::new(bounds_of(free, *prior)));
        Density {
            bounds: bounds.collect(),
            problem,
            priors,
            noise,
        }
    }

    /// The variables of numbers without bounds.
    pub fn inward(&self, z: &DVector<f64>) -> Vec<f64> {
        let each = self.bounds.iter().zip(z.iter());
        each.map(|(bounds, z)| bounds.inward(*z).x).collect()
    }

    /// The numbers of variables.
    pub fn outward(&self, x: &[f64]) -> DVector<f64> {
        let each = self.bounds.iter().zip(x);
        DVector::from_iterator(x.len(), each.map(|(bounds, x)| bounds.outward(*x)))
    }

    /// dx/dz
    pub fn slopes(&self, z: &DVector<f64>) -> DVector<f64> {
        z.zip_map(&DVector::from_column_slice(&self.bounds), |z, bounds| {
            bounds.inward(z).slope
        })
    }

    /// How curved the priors are about numbers: minus the second derivatives of their logarithms, not below what a distribution as wide as the
    /// bounds has.
    pub fn prior_information(&self, z: &DVector<f64>) -> DVector<f64> {
        /// Of a number between bounds.
        const LEAST: f64 = 0.1;
        DVector::from_fn(z.len(), |i, _| {
            let inward = self.bounds[i].inward(z[i]);
            let scale = self.problem.free[i].scale;
            let own = match self.priors[i] {
                Prior::Normal { deviation, .. } => {
                    (scale.slope(scale.outward(inward.x)) * inward.slope / deviation).powi(2)
                }
                Prior::Uniform { .. } | Prior::LogUniform { .. } => LEAST,
            };
            own + 0.5 * (1.0 - inward.of_log_slope.powi(2))
        })
    }

    /// The logarithm of the density of the numbers z but for a constant, with its gradient; -infinity where there is no friction.
    pub fn at(&self, about: Option<&About>, z: &DVector<f64>, gradient: &mut DVector<f64>) -> f64 {
        gradient.fill(0.0);
        let x = self.inward(z);
        let likelihood = match about {
            Some(about) => self.near(about, &x, gradient),
            None => self.exact(&x, gradient),
        };
        let Ok(mut log) = likelihood else {
            return f64::NEG_INFINITY;
        };
        for (i, free) in self.problem.free.iter().enumerate() {
            let inward = self.bounds[i].inward(z[i]);
            let (prior, of_prior) = self.priors[i].log_density(free.scale, inward.x);
            log += prior + inward.log_slope;
            gradient[i] = (gradient[i] + of_prior) * inward.slope + inward.of_log_slope;
        }
        log
    }

    /// The likelihood of one record, with its variance integrated over 1/variance: S^(-n/2), S the sum of squares of its innovations.
    fn likelihood(samples: usize, squares: f64) -> (f64, f64) {
        let half = 0.5 * samples as f64;
        (-half * squares.ln(), -half / squares)
    }

    fn samples(&self, record: usize) -> usize {
        let all = self.problem.records[record].record.times.len();
        all - self.noise[record].coefficients.len()
    }

    /// The information of the records on the variables: minus the expected second derivatives of the likelihood's logarithm.
    pub fn information(&self, x: &[f64]) -> Result<DMatrix<f64>> {
        let (friction, slopes) = self.problem.response(x)?;
        let residuals = self.problem.residuals(&friction, slopes);
        let size = x.len();
        let mut information = DMatrix::zeros(size, size);
        for (i, rows) in self.problem.rows().into_iter().enumerate() {
            let noise = &self.noise[i];
            let known = noise.coefficients.len();
            let mut innovations = residuals.values.as_slice()[rows.clone()].to_vec();
            noise.innovations(&mut innovations);
            let squares: f64 = innovations[known..].iter().map(|e| e * e).sum();
            let mut jacobian = residuals.jacobian.rows(rows.start, rows.len()).into_owned();
            for mut column in jacobian.column_iter_mut() {
                noise.innovations(column.as_mut_slice());
                column.rows_mut(0, known).fill(0.0);
            }
            information += jacobian.tr_mul(&jacobian) * (self.samples(i) as f64 / squares);
        }
        Ok(information)
    }

    /// From all samples.
    pub fn exact(&self, x: &[f64], gradient: &mut DVector<f64>) -> Result<f64> {
        let (friction, slopes) = self.problem.response(x)?;
        let residuals = self.problem.residuals(&friction, slopes);
        let mut log = 0.0;
        for (i, rows) in self.problem.rows().into_iter().enumerate() {
            let mut innovations = residuals.values.as_slice()[rows.clone()].to_vec();
            let noise = &self.noise[i];
            noise.innovations(&mut innovations);
            let known = noise.coefficients.len();
            innovations[..known].fill(0.0);
            let squares: f64 = innovations.iter().map(|e| e * e).sum();
            let (own, by) = Self::likelihood(self.samples(i), squares);
            log += own;
            noise.transposed(&mut innovations);
            let jacobian = residuals.jacobian.rows(rows.start, rows.len());
            let innovations = DVector::from_vec(innovations);
            *gradient += jacobian.tr_mul(&innovations) * (2.0 * by);
        }
        Ok(log)
    }

    /// From the nodes alone.
    fn near(&self, about: &About, x: &[f64], gradient: &mut DVector<f64>) -> Result<f64> {
        let mut log = 0.0;
        for (i, compressed) in about.records.iter().enumerate() {
            let times = &about.times[i];
            let count = times.len();
            // The straight line is apart.
            let still = vec![0.0; count];
            let (friction, slopes) = self.problem.response_of(i, (times, &still), x, COARSE)?;
            let (_, drift) = self.problem.parameters_at(i, x);
            let differences = DVector::from_fn(count + 1, |k, _| match k < count {
                true => friction[k] - about.friction[i][k],
                false => drift - about.slopes[i],
            });
            let (squares, of_squares) = compressed.squares(&differences);
            let (own, by) = Self::likelihood(self.samples(i), squares);
            log += own;
            *gradient += slopes.tr_mul(&of_squares.rows(0, count)) * by;
            if let Some(column) = self.problem.drift_column(i) {
                gradient[column] += by * of_squares[count];
            }
        }
        Ok(log)
    }

    /// The records as few points about a minimum, exact to `tolerance` standard deviations of one innovation within what `shapes` (of
    /// all samples, in variables) says of differences; none where that spares little.
    pub fn about(&self, x: &[f64], shapes: &DMatrix<f64>, tolerance: f64) -> Result<Option<About>> {
        let (friction, slopes) = self.problem.response(x)?;
        let residuals = self.problem.residuals(&friction, slopes);
        let mut about = About {
            records: Vec::new(),
            times: Vec::new(),
            friction: Vec::new(),
            slopes: Vec::new(),
        };
        for (i, rows) in self.problem.rows().into_iter().enumerate() {
            let one = &self.problem.records[i];
            let noise = &self.noise[i];
            let weights: Vec<f64> = one.record.weights.iter().map(|w| w.sqrt()).collect();
            let deviation = noise.innovation.sqrt().max(f64::MIN_POSITIVE);
            let own = shapes.rows(rows.start, rows.len()) / deviation;
            let Some(compressed) = Compressed::new(
                (
                    noise,
                    &residuals.values.as_slice()[rows.clone()],
                    &weights,
                    &one.record.times,
                ),
                &one.record.displacement,
                &stretches(self.problem, i),
                (&own, tolerance),
            ) else {
                return Ok(None);
            };
            let (_, drift) = self.problem.parameters_at(i, x);
            let at = |all: &[f64]| compressed.nodes.iter().map(|&k| all[k]).collect::<Vec<_>>();
            // The straight line is apart.
            let moved = at(&one.record.displacement);
            let made = at(&friction[rows.clone()]).into_iter().zip(moved);
            about
                .friction
                .push(made.map(|(mu, x)| mu - drift * x).collect());
            about.times.push(at(&one.record.times));
            about.slopes.push(drift);
            about.records.push(compressed);
        }
        Ok(Some(about))
    }
}

/// The samples of a record between which the load point changes its velocity.
fn stretches<const N: usize>(problem: &Problem<'_, N>, record: usize) -> Vec<Range<usize>> {
    let one = &problem.records[record];
    let times = &one.record.times;
    let changes = one.motion.stretches.iter().skip(1);
    let places = changes.map(|stretch| times.partition_point(|&t| t < stretch.span.0));
    let mut ends: Vec<usize> = std::iter::once(0)
        .chain(places)
        .chain([times.len()])
        .collect();
    ends.dedup();
    ends.windows(2).map(|pair| pair[0]..pair[1]).collect()
}

/// Between what a variable lies: its bounds within what its prior supports. Limits that only keep numbers finite are none.
fn bounds_of(free: &FreeParameter, prior: Prior) -> (f64, f64) {
    /// In orders of magnitude.
    const WIDEST: f64 = 1e20;
    let (low, high) = prior.support();
    let (low, high) = (low.max(free.bounds.0), high.min(free.bounds.1));
    if high.abs() >= WIDEST {
        return (f64::NEG_INFINITY, f64::INFINITY);
    }
    (free.scale.inward(low), free.scale.inward(high))
}
