//! Nonlinear least squares: Levenberg-Marquardt steps within bounds.
//!
//! Our own, as what there is on crates.io knows no bounds and gives up where the residuals cannot be computed; here such a step is
//! one that went too far. Each linear problem is solved by QR factors, not by normal equations, whose condition is squared.
//!
//! Marquardt, D. W. (1963). An algorithm for least-squares estimation of nonlinear parameters. J. SIAM 11, 431-441. The damping by
//! Nielsen, H. B. (1999). Damping parameter in Marquardt's method. Report IMM-REP-1999-05, Technical University of Denmark.

use nalgebra::{DMatrix, DVector};

/// A minimum is reached where a step that is not damped is as small as this; a damped one that is as small leads nowhere.
const LEAST_STEP: f64 = 1e-10;
/// A damping that holds back what the residuals do not determine at all.
const LEAST_DAMPING: f64 = 1e-12;
/// What such a step may still promise, in parts of the sum of squares, where no step leads down: what the residuals are off by themselves.
const NOTHING: f64 = 1e-6;
/// The damping at first, relative to the curvature.
const FIRST_DAMPING: f64 = 1e-3;
/// Beyond this damping no step leads down.
const MOST_DAMPING: f64 = 1e12;

/// Residuals, and their derivatives: a row for each residual, a column for each variable.
#[derive(Debug, Clone, PartialEq)]
pub struct Residuals {
    /// Of each observation.
    pub values: DVector<f64>,
    /// In each variable.
    pub jacobian: DMatrix<f64>,
}

impl Residuals {
    /// The sum of squares.
    pub fn cost(&self) -> f64 {
        self.values.norm_squared()
    }
}

/// Where a search has ended.
#[derive(Debug, Clone, PartialEq)]
pub struct Minimum {
    /// The variables.
    pub variables: Vec<f64>,
    /// The residuals there.
    pub residuals: Residuals,
    /// How many times residuals were computed.
    pub evaluations: usize,
    /// Whether it is a minimum within the bounds, and not where the search was given up.
    pub converged: bool,
}

/// Residuals at given variables; `None` where there are none.
pub type Evaluate<'a> = &'a mut dyn FnMut(&[f64]) -> Option<Residuals>;

/// Looks for the least sum of squares within bounds, from `start`, in `most` steps at most, until the next step would lower it by less than
/// `negligible` variances of one residual; `None` where there are no residuals at the start.
///
/// # Panics
/// Where the lists differ in length.
pub fn minimise(
    start: &[f64],
    bounds: &[(f64, f64)],
    (most, negligible): (usize, f64),
    evaluate: Evaluate<'_>,
) -> Option<Minimum> {
    let clamped = |x: &f64, (low, high): &(f64, f64)| x.clamp(*low, *high);
    let mut x: Vec<f64> = start
        .iter()
        .zip(bounds)
        .map(|(x, b)| clamped(x, b))
        .collect();
    let mut here = evaluate(&x)?;
    let mut evaluations = 1;
    let (mut damping, mut growth) = (FIRST_DAMPING, 2.0);
    let mut scale = DVector::zeros(x.len());
    let mut linear = Linear::of(&here, &mut scale);
    let mut converged = false;
    for _ in 0..most {
        let held = linear.held(&x, bounds);
        let step = linear.step(damping, &scale, &held);
        let next: Vec<f64> = x
            .iter()
            .zip(step.iter())
            .zip(bounds)
            .map(|((x, d), bound)| clamped(&(x + d), bound))
            .collect();
        let taken = DVector::from_iterator(x.len(), next.iter().zip(&x).map(|(n, x)| n - x));
        let expected = linear.reduction(&taken);
        let variance = here.cost() / here.values.len() as f64;
        // A damped step is short and promises little anywhere.
        let full = linear.step(LEAST_DAMPING, &scale, &held);
        let promised = linear.reduction(&full);
        if full.amax() <= LEAST_STEP || promised <= negligible * variance {
            converged = true;
            break;
        }
        if taken.amax() <= LEAST_STEP || damping > MOST_DAMPING {
            converged = promised <= NOTHING * here.cost();
            break;
        }
        evaluations += 1;
        let there = evaluate(&next).filter(|there| there.cost().is_finite());
        let gained = there
            .as_ref()
            .map_or(-1.0, |there| here.cost() - there.cost());
        match there {
            Some(there) if gained > 0.0 => {
                let ratio = (gained / expected).clamp(0.0, 2.0);
                damping *= f64::max(1.0 / 3.0, 1.0 - (2.0 * ratio - 1.0).powi(3));
                growth = 2.0;
                x = next;
                here = there;
                linear = Linear::of(&here, &mut scale);
            }
            _ => {
                damping *= growth;
                growth *= 2.0;
            }
        }
    }
    Some(Minimum {
        variables: x,
        residuals: here,
        evaluations,
        converged,
    })
}

/// The residuals made linear: z + J d, by the triangle R of J and Q' z.
struct Linear {
    triangle: DMatrix<f64>,
    projected: DVector<f64>,
    /// J' z
    gradient: DVector<f64>,
}

impl Linear {
    /// At these residuals; `scale` is the largest size yet of each column.
    fn of(residuals: &Residuals, scale: &mut DVector<f64>) -> Self {
        let Residuals { values, jacobian } = residuals;
        for (scale, column) in scale.iter_mut().zip(jacobian.column_iter()) {
            *scale = scale.max(column.norm());
        }
        let factors = jacobian.clone().qr();
        let mut projected = values.clone();
        factors.q_tr_mul(&mut projected);
        let count = jacobian.ncols();
        Linear {
            triangle: factors.unpack_r(),
            projected: projected.rows(0, count.min(values.len())).into_owned(),
            gradient: jacobian.tr_mul(values),
        }
    }

    /// Which variables stand at a bound, beyond which the sum of squares would fall.
    fn held(&self, x: &[f64], bounds: &[(f64, f64)]) -> Vec<bool> {
        let each = x.iter().zip(bounds).zip(self.gradient.iter());
        each.map(|((x, (low, high)), slope)| {
            (x <= low && *slope >= 0.0) || (x >= high && *slope <= 0.0)
        })
        .collect()
    }

    /// The step that lowers the linear sum of squares and `damping` times its own size, of the variables that are not held.
    fn step(&self, damping: f64, scale: &DVector<f64>, held: &[bool]) -> DVector<f64> {
        let (rows, count) = self.triangle.shape();
        let mut matrix = DMatrix::zeros(rows + count, count);
        matrix.rows_mut(0, rows).copy_from(&self.triangle);
        for j in 0..count {
            if held[j] {
                matrix.column_mut(j).fill(0.0);
            }
            let size = if held[j] || scale[j] == 0.0 {
                1.0
            } else {
                scale[j]
            };
            matrix[(rows + j, j)] = damping.sqrt() * size;
        }
        let mut right = DVector::zeros(rows + count);
        right.rows_mut(0, rows).copy_from(&(-&self.projected));
        let factors = matrix.qr();
        factors.q_tr_mul(&mut right);
        let right = right.rows(0, count).into_owned();
        let step = factors.unpack_r().solve_upper_triangular(&right);
        step.unwrap_or_else(|| DVector::zeros(count))
    }

    /// By how much a step lowers the linear sum of squares.
    fn reduction(&self, step: &DVector<f64>) -> f64 {
        let change = &self.triangle * step;
        -2.0 * change.dot(&self.projected) - change.norm_squared()
    }
}
