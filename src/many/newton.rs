//! Newton's method for a state in which all rates are zero, with the arrow matrix.

use super::block::larger;
use super::field::{Arrow, ManyField};
use crate::error::{Error, Result};

/// What does not converge.
const WHAT: &str = "Newton's method for the equilibrium of many interfaces";
/// Iterations, at most.
const ITERATIONS: usize = 300;
/// No step changes ln psi or tau by more at once.
const LONGEST: f64 = 4.0;
/// A smaller part of a step than this leads nowhere.
const LEAST: f64 = 1e-9;
/// Corrections from which on full steps converge quadratically, unless a fold is very close.
const NEAR: f64 = 1e-6;

/// The step of Newton's method from y, for the matrix of another y or of this one: J step = -f(y).
pub(super) fn correction(field: &ManyField<'_>, arrow: &Arrow, y: &[f64], step: &mut [f64]) -> f64 {
    field.rates(y, step);
    // (0 I - J) step = f
    field.solve(arrow, step);
    step.iter().map(|x| x.abs()).fold(0.0, larger)
}

/// J at y, with its factors.
///
/// # Errors
/// [`Error::NotConverged`] where it is singular.
pub(super) fn linearised(
    field: &ManyField<'_>,
    y: &[f64],
    arrow: &mut Arrow,
    iterations: usize,
) -> Result<()> {
    field.linearise(y, arrow);
    match field.factorise(0.0, arrow) {
        true => Ok(()),
        // the matrix is singular, or no matrix
        false => Err(not_converged(iterations, f64::INFINITY)),
    }
}

fn not_converged(iterations: usize, correction: f64) -> Error {
    let correction = if correction.is_nan() {
        f64::INFINITY
    } else {
        correction
    };
    Error::NotConverged {
        what: WHAT,
        iterations,
        residual: correction,
        tolerance: NEAR,
    }
}

/// y near a zero of f, from y on, and the iterations that it took. A part of a step is good if it makes the next correction, with the same
/// matrix, smaller: that is what Deuflhard calls the natural test, and depends on no scale of the equations (Newton Methods for Nonlinear
/// Problems, 2004, 3.3).
///
/// # Errors
/// [`Error::NotConverged`].
pub(super) fn near(field: &ManyField<'_>, y: &mut Vec<f64>) -> Result<usize> {
    let mut arrow = Arrow::default();
    let (mut step, mut next) = (vec![0.0; y.len()], vec![0.0; y.len()]);
    let mut trial = y.clone();
    let mut part = 1.0;
    let mut size = f64::INFINITY;
    for iteration in 0..ITERATIONS {
        linearised(field, y, &mut arrow, iteration)?;
        size = correction(field, &arrow, y, &mut step);
        if !size.is_finite() {
            return Err(not_converged(iteration, size.abs()));
        }
        if size <= NEAR {
            return Ok(iteration);
        }
        part = f64::min(2.0 * part, 1.0).min(LONGEST / size);
        loop {
            for (trial, (y, step)) in trial.iter_mut().zip(y.iter().zip(&step)) {
                *trial = y + part * step;
            }
            let left = correction(field, &arrow, &trial, &mut next);
            // False where it is not a number.
            if left <= (1.0 - 0.25 * part) * size {
                break;
            }
            part *= 0.5;
            if part < LEAST {
                return Err(not_converged(iteration, size));
            }
        }
        std::mem::swap(y, &mut trial);
    }
    Err(not_converged(ITERATIONS, size))
}

/// Full steps until they no longer shrink.
///
/// # Errors
/// [`Error::NotConverged`].
pub(super) fn settled(field: &ManyField<'_>, y: &mut [f64], iterations: usize) -> Result<usize> {
    /// Few reach rounding, but at a fold each step only halves the error.
    const ROUNDS: usize = 60;
    let mut arrow = Arrow::default();
    let mut step = vec![0.0; y.len()];
    let mut last = f64::INFINITY;
    for round in 0..ROUNDS {
        linearised(field, y, &mut arrow, iterations + round)?;
        let size = correction(field, &arrow, y, &mut step);
        if !size.is_finite() {
            return Err(not_converged(iterations + round, size));
        }
        if size > 0.5 * last || size <= f64::EPSILON {
            return if last.min(size) <= NEAR {
                Ok(iterations + round)
            } else {
                Err(not_converged(iterations + round, size))
            };
        }
        for (y, step) in y.iter_mut().zip(&step) {
            *y += step;
        }
        last = size;
    }
    Ok(iterations + ROUNDS)
}
