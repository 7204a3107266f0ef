//! Curves of zeros as a caller meets them: the equations, where to begin, what looks on, what comes of it.

use super::Stop;
use crate::error::Result;
use nalgebra::{DMatrix, DVector};
use std::ops::ControlFlow;

/// N equations for N unknowns u and a parameter lambda.
pub trait ZeroProblem {
    /// N.
    fn dimension(&self) -> usize;

    /// G(u, lambda), of length N. Where it is not finite, or an error, the step is shortened.
    ///
    /// # Errors
    /// The problem's own.
    fn residual(&self, u: &DVector<f64>, lambda: f64) -> Result<DVector<f64>>;

    /// dG/d(u, lambda): N rows, N + 1 columns, the last one the derivative in lambda.
    ///
    /// # Errors
    /// The problem's own.
    fn jacobian(&self, u: &DVector<f64>, lambda: f64) -> Result<DMatrix<f64>>;
}

/// A point of the curve.
#[derive(Debug, Clone, PartialEq)]
#[non_exhaustive]
pub struct CurvePoint {
    /// The unknowns.
    pub u: DVector<f64>,
    /// The parameter.
    pub lambda: f64,
    /// The unit tangent, N + 1 long, its last component d lambda/ds, in the direction in which the curve is followed.
    pub tangent: DVector<f64>,
    /// The sum of the steps so far.
    pub arclength: f64,
}

impl CurvePoint {
    /// d lambda / ds: it changes its sign at a fold.
    pub fn lambda_slope(&self) -> f64 {
        self.tangent[self.u.len()]
    }
}

/// Where a curve begins.
#[derive(Debug, Clone, PartialEq)]
pub struct Start {
    /// A guess of the unknowns.
    pub u: DVector<f64>,
    /// The parameter.
    pub lambda: f64,
    /// The tangent's scalar product with this, N + 1 long, is positive at first.
    pub direction: DVector<f64>,
    /// Whether the guess is corrected across the direction, as beside a branch point, and not at its lambda.
    pub across: bool,
}

/// Why a point is shown.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum PointKind {
    /// The first one, and the last one too where the curve is closed.
    Begin,
    /// A step's end.
    Step,
    /// The zero of the test function of this number.
    Zero(usize),
    /// The wanted value of lambda of this number; lambda is exactly that value.
    Wanted(usize),
    /// The lower end of the range; lambda is exactly that value.
    Lowest,
    /// The upper end.
    Highest,
}

/// What looks on while a curve is followed.
pub trait CurveObserver {
    /// The test functions at a point, always as many. NaN where one is undefined: no sign change then is seen.
    ///
    /// # Errors
    /// Like the problem's own: the step is shortened.
    fn tests(&self, point: &CurvePoint) -> Result<Vec<f64>> {
        let _ = point;
        Ok(Vec::new())
    }

    /// Whether this test function is the user's: in no unit that is known, and zero within its noise.
    fn is_users(&self, test: usize) -> bool {
        let _ = test;
        false
    }

    /// Whether the curve ends where this test function is zero.
    fn ends(&self, test: usize) -> bool {
        let _ = test;
        false
    }

    /// The part of the longest step below which no step is shortened because its points are too far apart.
    fn finest(&self) -> f64 {
        0.01
    }

    /// Whether two points are too far apart, for the eye or because something lies between them: the step is then shortened, but
    /// not below [`CurveObserver::finest`].
    fn too_far(&self, from: &CurvePoint, to: &CurvePoint) -> bool {
        let _ = (from, to);
        false
    }

    /// Every point in the order of the curve.
    fn seen(&mut self, point: &CurvePoint, mark: PointKind) -> ControlFlow<()>;
}

/// A curve as far as it was followed.
#[derive(Debug, Clone, PartialEq)]
#[non_exhaustive]
pub struct Branch {
    /// All points with what they are.
    pub points: Vec<(CurvePoint, PointKind)>,
    /// Why there are no more.
    pub stopped: Stop,
}
