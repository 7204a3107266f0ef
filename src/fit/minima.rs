//! Whether the sum of squares has several minima that the data do not tell apart.

use super::problem::Problem;
use super::{FIRST_ITERATIONS, Fit, MAX_ITERATIONS, NEGLIGIBLE, ranked, thinned};
use crate::error::Result;

/// Starts that are followed.
const FOLLOWED: usize = 12;
/// Minima that differ by less, in standard errors of every parameter, are one.
const APART: f64 = 3.0;
/// A minimum that is less likely than e^-12 of the best is not drawn from.
const UNLIKELY: f64 = 12.0;

/// The minima that are found from some starts, lists of values of the free parameters, and that the data do not exclude; that of the fit first.
///
/// # Errors
/// Those of the friction at the minimum of the fit.
pub fn minima<const N: usize>(
    problem: &Problem<'_, N>,
    fit: &Fit,
    starts: &[Vec<f64>],
) -> Result<Vec<Vec<f64>>> {
    let errors = fit.standard_errors();
    let mut found = vec![fit.variables.clone()];
    let is_known = |found: &[Vec<f64>], x: &[f64]| {
        found.iter().any(|known| {
            let pairs = known.iter().zip(x).zip(&errors);
            // What has no error is no measure.
            pairs
                .filter(|(_, error)| error.is_finite())
                .all(|((one, other), error)| (one - other).abs() <= APART * error)
        })
    };
    let records = thinned(problem);
    let thin = problem.with(&records);
    let bounds = problem.bounds();
    let least = problem.cost(&fit.variables);
    for (_, start) in ranked(&thin, starts).iter().take(FOLLOWED) {
        let effort = (FIRST_ITERATIONS, NEGLIGIBLE);
        let Ok(near) = thin.minimum(start, &bounds, effort) else {
            continue;
        };
        if !near.converged || is_known(&found, &near.variables) {
            continue;
        }
        let Ok(other) = problem.minimum(&near.variables, &bounds, (MAX_ITERATIONS, NEGLIGIBLE))
        else {
            continue;
        };
        let ratio = other.residuals.cost() / least;
        let is_unlikely = 0.5 * fit.effective_samples * ratio.ln() > UNLIKELY;
        if other.converged && !is_unlikely && !is_known(&found, &other.variables) {
            found.push(other.variables);
        }
    }
    Ok(found)
}
