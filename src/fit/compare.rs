//! How well one law does beside others: by information and by prediction.

use super::problem::{Problem, Record};
use super::{Autoregression, Fit, MAX_ITERATIONS, NEGLIGIBLE};
use crate::error::Result;

/// Parts of a record that are predicted from the others.
const PARTS: usize = 5;
/// Blocks that a part has, spread over the record: a part that is one stretch of it would hold a whole step, of which the others know
/// nothing.
const BLOCKS_EACH: usize = 40;

/// What a fit is compared by.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Comparison {
    /// AICc: less is better, by 10 decidedly.
    pub akaike: f64,
    /// The root of the mean square by which blocks of the record are missed that took no part in the fit; `None` where a block could not
    /// be predicted.
    pub cross_validation: Option<f64>,
}

/// AICc of a fit (Hurvich and Tsai 1989): -2 ln L + 2 k n/(n - k - 1), with the likelihood of residuals that are an autoregression; its
/// coefficients and the variance count as parameters.
pub fn akaike(record: &Record, fit: &Fit) -> f64 {
    let pairs = record.friction.iter().zip(&fit.fitted);
    let residuals: Vec<f64> = pairs.map(|(measured, made)| measured - made).collect();
    let noise = Autoregression::of(&residuals);
    let n = residuals.len() as f64;
    let k = (fit.parameters.len() + noise.coefficients.len() + 1) as f64;
    n * noise.innovation.ln() + 2.0 * k * n / (n - k - 1.0)
}

/// The root of the mean square of prediction over parts left out in turn, each of many short blocks; `None` where one cannot be fitted without.
///
/// # Errors
/// Those of the fit at the minimum.
pub fn cross_validation<const N: usize>(
    problem: &Problem<'_, N>,
    fit: &Fit,
) -> Result<Option<f64>> {
    let count = problem.record.times.len();
    let mut squares = 0.0;
    let length = count.div_ceil(PARTS * BLOCKS_EACH);
    for part in 0..PARTS {
        let held = || (0..count).filter(|i| i / length % PARTS == part);
        let mut record = problem.record.clone();
        held().for_each(|i| record.weights[i] = 0.0);
        let without = Problem {
            record: &record,
            parameters: problem.parameters.clone(),
            free: problem.free.clone(),
            ..*problem
        };
        let effort = (MAX_ITERATIONS, NEGLIGIBLE);
        let minimum = without.minimum(&fit.variables, &without.bounds(), effort)?;
        let Ok(friction) = without.friction(&minimum.variables) else {
            return Ok(None);
        };
        squares += held()
            .map(|i| (problem.record.friction[i] - friction[i]).powi(2))
            .sum::<f64>();
    }
    Ok(Some((squares / count as f64).sqrt()))
}
