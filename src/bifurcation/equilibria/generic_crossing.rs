//! Branch points of equilibria of any small system, told from branches that only come near each other.
//!
//! Solved is the minimally extended system of a simple branch point with its imperfection beta (Govaerts 2000, Numerical Methods for
//! Bifurcations of Dynamical Equilibria, section 8.1): f(y; p) + beta psi = 0, psi . (f_y, f_p) = 0, |psi| = 1. It is regular where
//! two branches cross, and also near where they would cross but for a perturbation: that is beta, which then is not zero.

use super::generic::FieldEquilibria;
use super::generic_curve_problem::sign;
use crate::field::{Matrix, Vector};
use crate::integrate::AnyExact;
use crate::number::null_vector;

/// Where two branches cross.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct BranchPoint {
    /// The equilibrium.
    pub state: Vector,
    /// The parameter.
    pub parameter: f64,
    /// It may be off by this.
    pub uncertainty: f64,
    /// How they cross.
    pub crossing: BranchCrossing,
}

/// How two branches of equilibria cross.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum BranchCrossing {
    /// One of them turns there: the quadratic coefficient psi . D2f[phi, phi] of the null vectors is zero.
    Pitchfork,
    /// Neither does.
    Transcritical,
    /// It is undecided whether that coefficient is zero.
    Unknown,
}

impl BranchCrossing {
    /// All.
    pub const ALL: [BranchCrossing; 3] = [
        BranchCrossing::Pitchfork,
        BranchCrossing::Transcritical,
        BranchCrossing::Unknown,
    ];

    /// In words.
    pub fn name(self) -> &'static str {
        match self {
            BranchCrossing::Pitchfork => "pitchfork",
            BranchCrossing::Transcritical => "transcritical",
            BranchCrossing::Unknown => "branch point",
        }
    }
}

/// Iterations, and a correction that is the last.
const ITERATIONS: usize = 30;
const DONE: f64 = 1e-14;
/// Corrections that may be left to rounding.
const SMALL: f64 = 1e-9;

/// The branch point near a place; `None` where there is none, or where what crosses but for a perturbation is perturbed by more than
/// rounding.
pub(super) fn branch_point(
    family: &FieldEquilibria<'_>,
    state: &Vector,
    parameter: f64,
) -> Option<BranchPoint> {
    let n = state.len();
    let rows = family.extended(state, parameter).transpose();
    // The left null vector of (f_y, f_p).
    let psi = null_vector(rows)?;
    let mut u = Vector::zeros(2 * n + 2);
    u.rows_mut(0, n).copy_from(state);
    u[n] = parameter;
    u.rows_mut(n + 2, n).copy_from(&psi);
    let mut last = f64::INFINITY;
    for _ in 0..ITERATIONS {
        let step = derivatives(family, &u).lu().solve(&residual(family, &u))?;
        let parts = step
            .iter()
            .zip(&u)
            .map(|(d, x)| (d / (1.0 + x.abs())).abs());
        let size = parts.fold(0.0, |most: f64, x| if x.is_nan() { x } else { most.max(x) });
        if !size.is_finite() {
            return None;
        }
        u -= step;
        if size < DONE || size >= 0.5 * last && size < SMALL {
            return certain(family, &u);
        }
        last = size;
    }
    None
}

/// The solution, if beta is zero within what rounding makes of it.
fn certain(family: &FieldEquilibria<'_>, u: &Vector) -> Option<BranchPoint> {
    /// So many changes in the last digits, and what their largest residual counts.
    const TRIED: usize = 8;
    const SAFETY: f64 = 4.0;
    let n = (u.len() - 2) / 2;
    let mut noise = Vector::zeros(u.len());
    for time in 0..TRIED {
        let moved = Vector::from_fn(u.len(), |i, _| u[i] * (1.0 + f64::EPSILON * sign(i, time)));
        let left = residual(family, &moved);
        noise = noise.zip_map(&left, |most: f64, x: f64| most.max(x.abs()));
    }
    noise += rounding(family, u);
    let off = derivatives(family, u).try_inverse()?.abs() * noise * SAFETY;
    let zero = u[n + 1].abs() <= off[n + 1];
    let uncertainty = off[n] + f64::EPSILON * u[n].abs();
    (zero && uncertainty.is_finite()).then(|| BranchPoint {
        state: u.rows(0, n).into_owned(),
        parameter: u[n],
        uncertainty,
        crossing: crossing(family, u).unwrap_or(BranchCrossing::Unknown),
    })
}

fn crossing(family: &FieldEquilibria<'_>, u: &Vector) -> Option<BranchCrossing> {
    /// Of the curvatures whose part along psi the coefficient is, there and a unit of the motion aside: what is left of zero, and what is not zero.
    const ZERO: f64 = 1e-9;
    const NOT_ZERO: f64 = 1e-6;
    let n = (u.len() - 2) / 2;
    let (y, p, psi) = (
        u.rows(0, n).into_owned(),
        u[n],
        u.rows(n + 2, n).into_owned(),
    );
    let phi = null_vector(family.exact(&y, p).jacobian[0].clone())?;
    let at = |y: &Vector| {
        let (mut sum, mut squares) = (0.0_f64, Matrix::zeros(n, n));
        for second in family.field(p).second_derivatives(y) {
            for (i, j) in second.orders() {
                let part = phi[i] * phi[j] * second.value;
                sum += psi[second.of] * part;
                squares[(i, j)] += part * part;
            }
        }
        (sum, squares.map(f64::sqrt).sum())
    };
    // Of an odd function these are zero with the coefficient.
    let (sum, here) = at(&y);
    let aside = [at(&(&y + &phi)).1, at(&(&y - &phi)).1];
    let aside = aside.into_iter().filter(|size| size.is_finite());
    let size = aside.fold(here, f64::max);
    Some(match sum.abs() {
        x if x <= ZERO * size => BranchCrossing::Pitchfork,
        x if x > NOT_ZERO * size => BranchCrossing::Transcritical,
        _ => BranchCrossing::Unknown,
    })
}

/// In u = (y, p, beta, psi).
fn residual(family: &FieldEquilibria<'_>, u: &Vector) -> Vector {
    let n = (u.len() - 2) / 2;
    let (y, p, beta) = (u.rows(0, n).into_owned(), u[n], u[n + 1]);
    let psi = u.rows(n + 2, n).into_owned();
    let mut all = Vector::zeros(u.len());
    let AnyExact { f, jacobian } = family.exact(&y, p);
    let balance = &f[0] + &psi * beta;
    all.rows_mut(0, n).copy_from(&balance);
    let across = jacobian[0].transpose() * &psi;
    all.rows_mut(n, n).copy_from(&across);
    all[2 * n] = family.in_parameter(&y, p).dot(&psi);
    all[2 * n + 1] = psi.norm_squared() - 1.0;
    all
}

/// Returns bounds on the rounding errors of the residual that perturbing the unknowns does not show.
fn rounding(family: &FieldEquilibria<'_>, u: &Vector) -> Vector {
    let n = (u.len() - 2) / 2;
    let (y, p, psi) = (
        u.rows(0, n).into_owned(),
        u[n],
        u.rows(n + 2, n).into_owned(),
    );
    let AnyExact { f, jacobian } = family.exact(&y, p);
    let [jacobian, off] = jacobian.map(|matrix| matrix.abs());
    let entries = off + jacobian * f64::EPSILON;
    let mut all = Vector::zeros(u.len());
    all.rows_mut(0, n).copy_from(&f[1]);
    let across = entries.transpose() * psi.abs();
    all.rows_mut(n, n).copy_from(&across);
    all[2 * n] = f64::EPSILON * family.in_parameter(&y, p).abs().dot(&psi.abs());
    all[2 * n + 1] = f64::EPSILON;
    all
}

/// Its derivatives. That of f_p in p is a difference: Newton's method needs it but to converge.
fn derivatives(family: &FieldEquilibria<'_>, u: &Vector) -> Matrix {
    /// Relative to 1 + |p|.
    const CHANGE: f64 = 1e-6;
    let n = (u.len() - 2) / 2;
    let (y, p, beta) = (u.rows(0, n).into_owned(), u[n], u[n + 1]);
    let psi = u.rows(n + 2, n).into_owned();
    let mut all = Matrix::zeros(u.len(), u.len());
    let extended = family.extended(&y, p);
    all.view_mut((0, 0), (n, n + 1)).copy_from(&extended);
    all.view_mut((0, n + 1), (n, 1)).copy_from(&psi);
    for i in 0..n {
        all[(i, n + 2 + i)] = beta;
    }
    // psi . (f_y, f_p), in y, in p and in psi.
    for second in family.field(p).second_derivatives(&y) {
        for (i, j) in second.orders() {
            all[(n + i, j)] += psi[second.of] * second.value;
        }
    }
    let h = CHANGE * (1.0 + p.abs());
    let (ahead, behind) = (family.extended(&y, p + h), family.extended(&y, p - h));
    let in_parameter = (ahead - behind).transpose() * &psi / (2.0 * h);
    for j in 0..n {
        all[(n + j, n)] = in_parameter[j];
        all[(2 * n, j)] = in_parameter[j];
    }
    all[(2 * n, n)] = in_parameter[n];
    all.view_mut((n, n + 2), (n + 1, n))
        .copy_from(&extended.transpose());
    for i in 0..n {
        all[(2 * n + 1, n + 2 + i)] = 2.0 * psi[i];
    }
    all
}
