//! The posterior of a fit: draws of its parameters by the No-U-Turn sampler on exact derivatives.

mod compressed;
mod density;
mod diagnostics;
mod nuts;
mod prior;

pub use prior::Prior;

use super::problem::Problem;
use super::{Fit, label};
use crate::error::{Error, Result};
use crate::number::quantile;
use density::{About, Density};
use nalgebra::{DMatrix, DVector};
use nuts::{Chain, Sampler};
use rayon::prelude::*;

/// Chains, which show by their agreement whether they have come to the posterior.
const CHAINS: usize = 4;
/// Draws that a chain takes to find its metric and its step, at least, and in parts of those that are kept.
const WARM_UP: usize = 200;
/// How far differences of friction go for which a record is made few points, in standard errors.
const FAR: f64 = 4.0;
/// The first tolerance of that, and how often it is made ten times smaller.
const TOLERANCE: f64 = 1e-2;
const TRIES: usize = 3;
/// Draws of each chain at which the density from few points is compared with the exact one, and by how much its logarithm may be off.
const COMPARED: usize = 25;
const OFF: f64 = 0.02;
/// Beyond this R-hat chains do not agree (Vehtari et al. 2021).
const AGREE: f64 = 1.01;
/// Effective draws of a chain, below which quantiles say little (the same).
const ENOUGH: f64 = 100.0;

/// What is asked of a posterior.
#[derive(Debug, Clone, PartialEq)]
pub struct Sampling {
    /// Draws of all chains together.
    pub draws: usize,
    /// From which random numbers follow.
    pub seed: u64,
    /// One for each free parameter.
    pub priors: Vec<Prior>,
}

/// What is known of one parameter.
#[derive(Debug, Clone, PartialEq)]
pub struct Marginal {
    /// Its name, and of which record it is where each has its own.
    pub label: String,
    /// The mean of the draws.
    pub mean: f64,
    /// Their standard deviation.
    pub deviation: f64,
    /// The values below which 2.5, 16, 50, 84 and 97.5 % lie.
    pub quantiles: [f64; 5],
    /// Of the middle, and of the ends.
    pub effective_sizes: (f64, f64),
    /// R-hat.
    pub r_hat: f64,
}

/// The parts below which [`Marginal::quantiles`] lie.
pub const QUANTILES: [f64; 5] = [0.025, 0.16, 0.5, 0.84, 0.975];

/// Draws from the posterior.
#[derive(Debug, Clone, PartialEq)]
pub struct Posterior {
    /// One for each free parameter.
    pub marginals: Vec<Marginal>,
    /// The values of all free parameters, a row for each draw, chain after chain.
    pub draws: DMatrix<f64>,
    /// How many chains.
    pub chains: usize,
    /// Trajectories that went astray.
    pub divergences: usize,
    /// How many times the friction was computed.
    pub evaluations: usize,
    /// Of which minimum each chain began at.
    pub begun_at: Vec<usize>,
    /// Sentences on what is wrong with it; none where the chains agree.
    pub undecided: Vec<String>,
}

/// Draws from the posterior of a problem whose residuals count by their squares: the noise of each record is the autoregression of the fit's
/// residuals with an unknown variance. Chains begin near the minima that are given, the first of them that of the fit.
///
/// # Errors
/// [`Error::Input`] for too few draws; those of the friction at the minimum; [`Error::Interrupted`] as soon as `go_on` says no.
pub fn posterior<const N: usize>(
    problem: &Problem<'_, N>,
    fit: &Fit,
    minima: &[Vec<f64>],
    sampling: &Sampling,
    go_on: &(dyn Fn() -> bool + Sync),
) -> Result<Posterior> {
    let density = Density::new(problem, &sampling.priors, &fit.noise);
    let roots = minima.iter().map(|x| Laplace::of(&density, x));
    let laplace: Vec<Laplace> = roots.collect::<Result<_>>()?;
    let mut tolerance = TOLERANCE;
    let mut evaluations = 0;
    for attempt in 0..=TRIES {
        let about = match attempt {
            TRIES => None,
            _ => about(&density, &laplace, tolerance)?,
        };
        let run = |chain: usize| {
            let laplace = &laplace[chain % laplace.len()];
            let begin = (laplace, about.as_ref());
            one_chain(&density, begin, sampling, chain, go_on)
        };
        let chains: Vec<Option<Chain>> = (0..CHAINS).into_par_iter().map(run).collect();
        let chains: Vec<Chain> = chains.into_iter().flatten().collect();
        if chains.len() < CHAINS {
            return Err(match go_on() {
                false => Error::Interrupted,
                true => Error::NonFinite {
                    what: "the density of the posterior",
                    t: 0.0,
                },
            });
        }
        evaluations += chains.iter().map(|one| one.evaluations).sum::<usize>();
        let is_near = about
            .as_ref()
            .is_none_or(|about| is_exact(&density, about, &chains));
        if is_near {
            let begun_at = (0..CHAINS).map(|chain| chain % laplace.len()).collect();
            return Ok(gather(&density, &chains, begun_at, evaluations));
        }
        tolerance *= 0.1;
    }
    unreachable!("the last attempt is exact")
}

/// A normal approximation about a minimum, in numbers without bounds.
struct Laplace {
    x: Vec<f64>,
    centre: DVector<f64>,
    root: DMatrix<f64>,
}

impl Laplace {
    /// About the maximum of the density that is found from a minimum of the sum of squares on.
    fn of<const N: usize>(density: &Density<'_, N>, x: &[f64]) -> Result<Self> {
        /// Steps of Newton's method with the expected curvature.
        const STEPS: usize = 20;
        /// A step that promises so little of the logarithm is the last.
        const NEGLIGIBLE: f64 = 1e-4;
        let mut centre = density.outward(x);
        let mut gradient = DVector::zeros(x.len());
        let mut here = density.at(None, &centre, &mut gradient);
        let mut root = Self::root(density, &centre)?;
        for _ in 0..STEPS {
            let step = &root * root.tr_mul(&gradient);
            if step.dot(&gradient) <= NEGLIGIBLE {
                break;
            }
            let mut there = DVector::zeros(x.len());
            let mut try_part = |part: f64| {
                let next = &centre + &step * part;
                let log = density.at(None, &next, &mut there);
                (log > here).then(|| (next, log, there.clone()))
            };
            let Some((next, log, slopes)) = [1.0, 0.3, 0.1].into_iter().find_map(&mut try_part)
            else {
                break;
            };
            (centre, here, gradient) = (next, log, slopes);
            root = Self::root(density, &centre)?;
        }
        let x = density.inward(&centre);
        Ok(Laplace { x, centre, root })
    }

    /// The root of the covariance at some numbers.
    fn root<const N: usize>(density: &Density<'_, N>, z: &DVector<f64>) -> Result<DMatrix<f64>> {
        let slopes = density.slopes(z);
        let mut curvature = density.information(&density.inward(z))?;
        let size = z.len();
        for (i, j) in (0..size).flat_map(|i| (0..size).map(move |j| (i, j))) {
            curvature[(i, j)] *= slopes[i] * slopes[j];
        }
        curvature += DMatrix::from_diagonal(&density.prior_information(z));
        let covariance = curvature.cholesky().map(|one| one.inverse());
        let root = covariance.and_then(|one| one.cholesky());
        let root = root.ok_or(Error::NonFinite {
            what: "the curvature of the posterior",
            t: 0.0,
        })?;
        Ok(root.unpack())
    }
}

/// The records as few points, exact as far as the friction goes within some standard errors of the minimum of the fit.
fn about<const N: usize>(
    density: &Density<'_, N>,
    laplace: &[Laplace],
    tolerance: f64,
) -> Result<Option<About>> {
    // One quadratic form is about one minimum.
    let [Laplace { x, centre, root }] = laplace else {
        return Ok(None);
    };
    let here = density.problem.friction(x)?;
    let mut shapes = Vec::new();
    for column in root.column_iter() {
        for far in [-FAR, FAR] {
            let there = density.inward(&(centre + column * far));
            // Friction that is not there is not drawn either.
            if let Ok(friction) = density.problem.friction(&there) {
                shapes.extend(friction.iter().zip(&here).map(|(own, here)| own - here));
            }
        }
    }
    let count = here.len();
    let shapes = DMatrix::from_vec(count, shapes.len() / count, shapes);
    density.about(x, &shapes, tolerance)
}

fn one_chain<const N: usize>(
    density: &Density<'_, N>,
    (laplace, about): (&Laplace, Option<&About>),
    sampling: &Sampling,
    chain: usize,
    go_on: &(dyn Fn() -> bool + Sync),
) -> Option<Chain> {
    /// Places to begin at that are tried before the minimum itself.
    const PLACES: i32 = 10;
    let Laplace { centre, root, .. } = laplace;
    let mut sampler = Sampler::new(sampling.seed, chain, centre.clone(), root.clone());
    let mut at = |z: &DVector<f64>, gradient: &mut DVector<f64>| density.at(about, z, gradient);
    // Chains begin farther apart than draws are, so that agreeing says something.
    let mut gradient = DVector::zeros(centre.len());
    let mut start = centre.clone();
    for nearer in 0..PLACES {
        let away = sampler.normal(centre.len()) * (2.0 * 0.7_f64.powi(nearer));
        let there = centre + root * away;
        if at(&there, &mut gradient).is_finite() {
            start = there;
            break;
        }
    }
    let draws = sampling.draws.div_ceil(CHAINS);
    let lengths = (WARM_UP.max(draws / 4), draws);
    sampler.run(&mut at, &start, lengths, go_on)
}

/// Whether the density from few points is the exact one at some draws, but for a constant.
fn is_exact<const N: usize>(density: &Density<'_, N>, about: &About, chains: &[Chain]) -> bool {
    let mut gradient = DVector::zeros(density.priors.len());
    let mut differences = Vec::new();
    for chain in chains {
        let stride = chain.draws.len().div_ceil(COMPARED).max(1);
        for z in chain.draws.iter().step_by(stride) {
            let exact = density.at(None, z, &mut gradient);
            differences.push(exact - density.at(Some(about), z, &mut gradient));
        }
    }
    let count = differences.len() as f64;
    let mean = differences.iter().sum::<f64>() / count;
    differences.iter().all(|own| (own - mean).abs() <= OFF)
}

fn gather<const N: usize>(
    density: &Density<'_, N>,
    chains: &[Chain],
    begun_at: Vec<usize>,
    evaluations: usize,
) -> Posterior {
    let free = &density.problem.free;
    let each = chains.iter().flat_map(|chain| &chain.draws);
    let rows: Vec<Vec<f64>> = each.map(|z| density.inward(z)).collect();
    let draws = DMatrix::from_fn(rows.len(), free.len(), |i, j| {
        free[j].scale.outward(rows[i][j])
    });
    let length = chains[0].draws.len();
    let marginals = free.iter().enumerate().map(|(j, free)| {
        let column: Vec<f64> = draws.column(j).iter().copied().collect();
        let by_chain: Vec<Vec<f64>> = column.chunks(length).map(<[f64]>::to_vec).collect();
        let count = column.len() as f64;
        let mean = column.iter().sum::<f64>() / count;
        let squares: f64 = column.iter().map(|x| (x - mean).powi(2)).sum();
        let mut sorted = column;
        sorted.sort_by(f64::total_cmp);
        Marginal {
            label: label(&free.name, free.of_record),
            mean,
            deviation: (squares / (count - 1.0)).sqrt(),
            quantiles: QUANTILES.map(|part| quantile(&sorted, part)),
            effective_sizes: diagnostics::effective_sizes(&by_chain),
            r_hat: diagnostics::r_hat(&by_chain),
        }
    });
    let marginals: Vec<Marginal> = marginals.collect();
    let divergences = chains.iter().map(|one| one.divergences).sum();
    Posterior {
        undecided: doubts(&marginals, divergences, chains.len()),
        marginals,
        draws,
        chains: chains.len(),
        divergences,
        evaluations,
        begun_at,
    }
}

/// What speaks against the draws, a sentence each.
fn doubts(marginals: &[Marginal], divergences: usize, chains: usize) -> Vec<String> {
    let mut doubts = Vec::new();
    let named = |is_bad: &dyn Fn(&Marginal) -> bool| {
        let bad = marginals.iter().filter(|one| is_bad(one));
        bad.map(|one| one.label.as_str()).collect::<Vec<_>>()
    };
    let apart = named(&|one| one.r_hat.is_nan() || one.r_hat > AGREE);
    if !apart.is_empty() {
        doubts.push(format!(
            "the chains do not agree on {} (R-hat above {AGREE}): take more draws, or a narrower prior",
            apart.join(", ")
        ));
    }
    let enough = ENOUGH * chains as f64;
    let few = named(&|one| {
        let (middle, ends) = one.effective_sizes;
        middle.is_nan() || ends.is_nan() || f64::min(middle, ends) < enough
    });
    if !few.is_empty() {
        doubts.push(format!(
            "there are fewer than {enough} effective draws of {}: take more",
            few.join(", ")
        ));
    }
    if divergences > 0 {
        doubts.push(format!(
            "{divergences} trajectories went astray: the posterior has a corner that draws may miss"
        ));
    }
    doubts
}
