//! Newton's method on the extended system: the N equations, and one that fixes the place on the curve.

use super::{CurvePoint, ZeroProblem};
use crate::error::{Error, Result};
use nalgebra::{DMatrix, DVector};

/// Newton steps before a try counts as failed.
const MOST: usize = 12;
/// Where corrections no longer shrink they are rounding, if they are below this many times the tolerance.
const ROUNDING: f64 = 1e4;

/// (u, lambda) as one vector.
pub(super) fn joined(u: &DVector<f64>, lambda: f64) -> DVector<f64> {
    u.push(lambda)
}

/// The equation that fixes the place: `normal` times (u, lambda) is `offset`.
#[derive(Debug)]
pub(super) struct Hyperplane {
    pub normal: DVector<f64>,
    pub offset: f64,
}

impl Hyperplane {
    /// All points at this distance along the tangent.
    pub fn ahead(point: &CurvePoint, distance: f64) -> Self {
        let here = joined(&point.u, point.lambda);
        Hyperplane {
            offset: point.tangent.dot(&here) + distance,
            normal: point.tangent.clone(),
        }
    }

    /// All points of this lambda.
    pub fn lambda(dimension: usize, value: f64) -> Self {
        let mut normal = DVector::zeros(dimension + 1);
        normal[dimension] = 1.0;
        Hyperplane {
            normal,
            offset: value,
        }
    }
}

/// dG/d(u, lambda), and the plane's normal below.
fn bordered(
    problem: &dyn ZeroProblem,
    x: &DVector<f64>,
    last: &DVector<f64>,
) -> Result<DMatrix<f64>> {
    let n = problem.dimension();
    let upper = problem.jacobian(&x.rows(0, n).into_owned(), x[n])?;
    let mut matrix = DMatrix::zeros(n + 1, n + 1);
    matrix.view_mut((0, 0), (n, n + 1)).copy_from(&upper);
    matrix.row_mut(n).copy_from(&last.transpose());
    Ok(matrix)
}

pub(super) fn failed(iterations: usize, residual: f64, tolerance: f64) -> Error {
    Error::NotConverged {
        what: "a point of the curve",
        iterations,
        // a NaN would say nothing
        residual: if residual.is_nan() {
            f64::INFINITY
        } else {
            residual
        },
        tolerance,
    }
}

/// Whether what is left of every equation is what rounding of x alone makes.
fn satisfied(matrix: &DMatrix<f64>, x: &DVector<f64>, left: &DVector<f64>) -> bool {
    let sizes = matrix.abs() * x.abs();
    let mut both = left.iter().zip(sizes.iter());
    both.all(|(g, size)| g.abs() <= f64::EPSILON * size)
}

/// The point of the curve in the plane, near `guess`.
pub(super) fn onto(
    problem: &dyn ZeroProblem,
    guess: &DVector<f64>,
    plane: &Hyperplane,
    tolerance: f64,
) -> Result<DVector<f64>> {
    let n = problem.dimension();
    let mut x = guess.clone();
    let mut last = f64::INFINITY;
    for iteration in 1..=MOST {
        let g = problem.residual(&x.rows(0, n).into_owned(), x[n])?;
        let right = joined(&-g, plane.offset - plane.normal.dot(&x));
        let matrix = bordered(problem, &x, &plane.normal)?;
        // Next to a branch point the matrix is singular, and a correction of rounding would lead anywhere.
        if satisfied(&matrix, &x, &right) {
            return Ok(x);
        }
        let Some(change) = matrix.lu().solve(&right) else {
            return Err(failed(iteration, last, tolerance));
        };
        let size = change.amax() / (1.0 + x.amax());
        if !size.is_finite() {
            return Err(failed(iteration, last, tolerance));
        }
        x += change;
        if size <= tolerance {
            return Ok(x);
        }
        if size > 0.5 * last {
            return if size <= ROUNDING * tolerance {
                Ok(x)
            } else {
                Err(failed(iteration, size, tolerance))
            };
        }
        last = size;
    }
    if last <= ROUNDING * tolerance {
        return Ok(x);
    }
    Err(failed(MOST, last, tolerance))
}

/// The same from a rough guess: the step is damped as long as the next correction, by the same matrix, would not be shorter (the
/// natural monotonicity test of Deuflhard 2004, Newton Methods for Nonlinear Problems, section 3.3).
pub(super) fn from_afar(
    problem: &dyn ZeroProblem,
    guess: &DVector<f64>,
    plane: &Hyperplane,
    tolerance: f64,
) -> Result<DVector<f64>> {
    /// Damped steps, and the least part of a correction that is taken.
    const STEPS: usize = 200;
    const LEAST: f64 = 1e-6;
    let n = problem.dimension();
    let right = |x: &DVector<f64>| {
        let g = problem.residual(&x.rows(0, n).into_owned(), x[n])?;
        Ok::<_, Error>(joined(&-g, plane.offset - plane.normal.dot(x)))
    };
    let (mut x, mut part) = (guess.clone(), 1.0_f64);
    let mut size = f64::INFINITY;
    for iteration in 1..=STEPS {
        let left = right(&x)?;
        let matrix = bordered(problem, &x, &plane.normal)?.lu();
        let change = matrix
            .solve(&left)
            .filter(|change| change.norm().is_finite());
        let Some(change) = change else {
            return Err(failed(iteration, size, tolerance));
        };
        size = change.amax() / (1.0 + x.amax());
        part = (2.0 * part).min(1.0);
        x = loop {
            let next = &x + &change * part;
            // outside its domain the residual is an error or no number: a shorter step stays inside
            let after = right(&next).ok().and_then(|right| matrix.solve(&right));
            let shorter =
                |after: &DVector<f64>| after.norm() <= (1.0 - 0.25 * part) * change.norm();
            if after.as_ref().is_some_and(shorter) {
                break next;
            }
            part *= 0.5;
            if part < LEAST {
                return Err(failed(iteration, size, tolerance));
            }
        };
        if part == 1.0
            && let Ok(x) = onto(problem, &x, plane, tolerance)
        {
            return Ok(x);
        }
    }
    Err(failed(STEPS, size, tolerance))
}

/// The unit tangent at x whose product with `along` is positive.
pub(super) fn tangent(
    problem: &dyn ZeroProblem,
    x: &DVector<f64>,
    along: &DVector<f64>,
) -> Result<DVector<f64>> {
    let n = problem.dimension();
    let matrix = bordered(problem, x, along)?;
    let mut right = DVector::zeros(n + 1);
    right[n] = 1.0;
    let direction = matrix
        .lu()
        .solve(&right)
        .ok_or_else(|| failed(0, f64::INFINITY, 0.0))?;
    let length = direction.norm();
    if !(length.is_finite() && length > 0.0) {
        return Err(failed(0, length, 0.0));
    }
    Ok(direction / length)
}
