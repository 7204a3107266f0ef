//! Whether chains have come to their distribution: R-hat and effective sample sizes.
//!
//! Vehtari, A., Gelman, A., Simpson, D., Carpenter, B. and Bürkner, P.-C. (2021). Rank-normalization, folding, and localization: an improved R-hat
//! for assessing convergence of MCMC. Bayesian Analysis 16, 667-718.

use crate::number::quantile;
use statrs::distribution::{ContinuousCDF, Normal};

/// R-hat of one quantity: the larger one of that of rank-normalised draws and that of folded ones, each chain split in two.
pub(super) fn r_hat(chains: &[Vec<f64>]) -> f64 {
    let halves = split(chains);
    let all: Vec<f64> = halves.concat();
    let middle = quantile(&sorted(&all), 0.5);
    let folded: Vec<Vec<f64>> = halves
        .iter()
        .map(|one| one.iter().map(|x| (x - middle).abs()).collect())
        .collect();
    f64::max(plain_r_hat(&ranked(&halves)), plain_r_hat(&ranked(&folded)))
}

/// How many independent draws know as much of the middle, and of the ends, of the distribution: the first of rank-normalised draws, the second the
/// smaller one of the two quantiles 5 and 95 %.
pub(super) fn effective_sizes(chains: &[Vec<f64>]) -> (f64, f64) {
    let halves = split(chains);
    let all = sorted(&halves.concat());
    let beyond = |part: f64| {
        let limit = quantile(&all, part);
        let is_below = halves.iter().map(|one| {
            let each = one.iter().map(|&x| f64::from(u8::from(x <= limit)));
            each.collect::<Vec<f64>>()
        });
        effective_size(&is_below.collect::<Vec<_>>())
    };
    (
        effective_size(&ranked(&halves)),
        f64::min(beyond(0.05), beyond(0.95)),
    )
}

/// Ascending.
fn sorted(values: &[f64]) -> Vec<f64> {
    let mut sorted = values.to_vec();
    sorted.sort_by(f64::total_cmp);
    sorted
}

/// Each chain as two.
fn split(chains: &[Vec<f64>]) -> Vec<Vec<f64>> {
    let halves = chains.iter().flat_map(|chain| {
        let half = chain.len() / 2;
        [chain[..half].to_vec(), chain[chain.len() - half..].to_vec()]
    });
    halves.collect()
}

/// Normal numbers of the same ranks; equal values have the mean of theirs.
fn ranked(chains: &[Vec<f64>]) -> Vec<Vec<f64>> {
    let mut places: Vec<(f64, usize, usize)> = Vec::new();
    for (c, chain) in chains.iter().enumerate() {
        places.extend(chain.iter().enumerate().map(|(i, &x)| (x, c, i)));
    }
    places.sort_by(|one, other| one.0.total_cmp(&other.0));
    let normal = Normal::standard();
    let count = places.len() as f64;
    let mut ranked: Vec<Vec<f64>> = chains.to_vec();
    for same in places.chunk_by(|one, other| one.0 == other.0) {
        // Their place among all is that of their addresses.
        let first = places.partition_point(|one| one.0.total_cmp(&same[0].0).is_lt());
        let rank = first as f64 + 0.5 * (same.len() + 1) as f64;
        let z = normal.inverse_cdf((rank - 0.375) / (count + 0.25));
        for &(_, c, i) in same {
            ranked[c][i] = z;
        }
    }
    ranked
}

fn mean(values: &[f64]) -> f64 {
    values.iter().sum::<f64>() / values.len() as f64
}

/// The mean of the variances within chains, and the variance of all as it follows from within and between.
fn variances(chains: &[Vec<f64>]) -> (f64, f64) {
    let n = chains[0].len() as f64;
    let means: Vec<f64> = chains.iter().map(|chain| mean(chain)).collect();
    let within = chains.iter().zip(&means).map(|(chain, mean)| {
        let squares: f64 = chain.iter().map(|x| (x - mean).powi(2)).sum();
        squares / (n - 1.0)
    });
    let within = within.sum::<f64>() / chains.len() as f64;
    let middle = mean(&means);
    let between: f64 = means.iter().map(|own| (own - middle).powi(2)).sum();
    let between = between / (chains.len() as f64 - 1.0);
    (within, (n - 1.0) / n * within + between)
}

fn plain_r_hat(chains: &[Vec<f64>]) -> f64 {
    let (within, all) = variances(chains);
    if within == 0.0 {
        1.0
    } else {
        (all / within).sqrt()
    }
}

/// Geyer's initial monotone sequence of autocorrelations over all chains.
fn effective_size(chains: &[Vec<f64>]) -> f64 {
    let n = chains[0].len();
    let total = (n * chains.len()) as f64;
    let (within, all) = variances(chains);
    if all == 0.0 || n < 4 {
        return total;
    }
    let centred: Vec<Vec<f64>> = chains
        .iter()
        .map(|chain| {
            let mean = mean(chain);
            chain.iter().map(|x| x - mean).collect()
        })
        .collect();
    let correlation = |lag: usize| {
        let of = |chain: &Vec<f64>| {
            let pairs = chain.iter().zip(&chain[lag..]);
            pairs.map(|(one, other)| one * other).sum::<f64>() / n as f64
        };
        let covariance = centred.iter().map(of).sum::<f64>() / centred.len() as f64;
        1.0 - (within - covariance * n as f64 / (n as f64 - 1.0)) / all
    };
    let (mut sum, mut before, mut lag) = (0.0, f64::INFINITY, 0);
    while lag + 1 < n {
        let pair = correlation(lag) + correlation(lag + 1);
        if pair <= 0.0 {
            break;
        }
        before = pair.min(before);
        sum += before;
        lag += 2;
    }
    // Antithetic chains know more than independent draws, but not without end.
    let time = f64::max(2.0 * sum - 1.0, 1.0 / total.log10());
    total / time
}
