//! How well one law does beside others: by information and by prediction.

use super::problem::Problem;
use super::record::Record;
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
pub fn akaike<'a>(records: impl IntoIterator<Item = &'a Record>, fit: &Fit) -> f64 {
    let mut fitted = fit.fitted.iter();
    let (mut all, mut likelihood, mut count) = (0.0, 0.0, fit.parameters.len());
    for record in records {
        let pairs = record.friction.iter().zip(&mut fitted);
        let residuals: Vec<f64> = pairs.map(|(measured, made)| measured - made).collect();
        let noise = Autoregression::of(&residuals);
        let n = residuals.len() as f64;
        likelihood += n * noise.innovation.ln();
        all += n;
        count += noise.coefficients.len() + 1;
    }
    let k = count as f64;
    likelihood + 2.0 * k * all / (all - k - 1.0)
}

/// The root of the mean square of prediction over parts left out in turn, each of many short blocks; `None` where one cannot be fitted without.
///
/// # Errors
/// Those of the fit at the minimum.
pub fn cross_validation<const N: usize>(
    problem: &Problem<'_, N>,
    fit: &Fit,
) -> Result<Option<f64>> {
    let rows = problem.rows();
    let mut squares = 0.0;
    let is_held = |part: usize, count: usize, i: usize| {
        i / count.div_ceil(PARTS * BLOCKS_EACH) % PARTS == part
    };
    for part in 0..PARTS {
        let mut records: Vec<Record> = Vec::with_capacity(rows.len());
        for one in &problem.records {
            let mut record = one.record.clone();
            let count = record.weights.len();
            let all = record.weights.iter_mut().enumerate();
            all.filter(|(i, _)| is_held(part, count, *i))
                .for_each(|(_, weight)| *weight = 0.0);
            records.push(record);
        }
        let without = problem.with(&records);
        let effort = (MAX_ITERATIONS, NEGLIGIBLE);
        let minimum = without.minimum(&fit.variables, &without.bounds(), effort)?;
        let Ok(friction) = without.friction(&minimum.variables) else {
            return Ok(None);
        };
        for (one, rows) in problem.records.iter().zip(&rows) {
            let pairs = one.record.friction.iter().zip(&friction[rows.clone()]);
            let held = pairs
                .enumerate()
                .filter(|(i, _)| is_held(part, rows.len(), *i));
            squares += held
                .map(|(_, (own, made))| (own - made).powi(2))
                .sum::<f64>();
        }
    }
    Ok(Some((squares / problem.samples() as f64).sqrt()))
}
