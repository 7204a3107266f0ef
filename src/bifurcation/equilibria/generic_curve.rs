//! Curves of folds and of Hopf points of equilibria of any small system, in the plane of two of its parameters.
//!
//! Solved are f(y; p) = 0 and a determinant: of the Jacobian at a fold, of the bialternate product 2 J (.) 1 at a Hopf point
//! (Kuznetsov 2004, section 10.3). All derivatives are the field's own.

use super::bialternate::bialternate;
use crate::continuation::{
    Branch, CurveObserver, CurvePoint, PointKind, Settings, Start, ZeroProblem, follow,
};
use crate::error::{Error, Result};
use crate::field::{Matrix, Vector};
use crate::integrate::{AnyField, of_dimension};
use crate::orbit::ParametrisedField;
use std::ops::ControlFlow;

/// What an equilibrium is along the curve.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum EquilibriumBifurcation {
    /// An eigenvalue is zero. A pitchfork is a fold of no such curve: there the equations are singular.
    Fold,
    /// Two eigenvalues have the sum zero.
    Hopf,
}

/// The bifurcations of this kind in the plane of a family.
#[derive(Clone, Copy)]
pub struct EquilibriumCurve<'a> {
    /// The family, in whose coordinates the curve is followed.
    pub family: &'a dyn ParametrisedField,
    /// What bifurcates.
    pub kind: EquilibriumBifurcation,
}

impl std::fmt::Debug for EquilibriumCurve<'_> {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        f.debug_struct("EquilibriumCurve")
            .field("kind", &self.kind)
            .finish_non_exhaustive()
    }
}

/// A point of the curve.
#[derive(Debug, Clone, PartialEq)]
#[non_exhaustive]
pub struct EquilibriumCurvePoint {
    /// The equilibrium.
    pub state: Vector,
    /// The family's coordinates.
    pub at: [f64; 2],
    /// omega of the pair on the imaginary axis; `None` at folds, and at neutral saddles, into which a curve of Hopf points runs on.
    pub frequency: Option<f64>,
}

impl EquilibriumCurve<'_> {
    /// The matrix whose determinant vanishes, linear in the Jacobian.
    fn singular(&self, jacobian: &Matrix) -> Matrix {
        match self.kind {
            EquilibriumBifurcation::Fold => jacobian.clone(),
            EquilibriumBifurcation::Hopf => bialternate(jacobian),
        }
    }

    /// The curve from near a point of it, with the second coordinate growing or falling at first, until that leaves the range of
    /// the settings.
    ///
    /// # Errors
    /// Those of [`follow`]; [`Error::Parameter`] for fields without named parameters or a start of another dimension than theirs.
    pub fn follow(
        &self,
        (state, at): (&Vector, [f64; 2]),
        growing: bool,
        settings: &Settings,
        seen: &mut dyn FnMut(&EquilibriumCurvePoint) -> ControlFlow<()>,
    ) -> Result<Branch> {
        let n = self.family.dimension();
        of_dimension(state.len(), n)?;
        let mut direction = Vector::zeros(n + 2);
        direction[n + 1] = if growing { 1.0 } else { -1.0 };
        let start = Start {
            u: state.push(at[0]),
            lambda: at[1],
            direction,
            across: false,
        };
        let problem = Extended(self);
        follow(
            &problem,
            &start,
            settings,
            &mut Observer {
                problem: &problem,
                seen,
            },
        )
    }
}

/// f and the determinant as functions of the state and the first coordinate, and of the second.
struct Extended<'a>(&'a EquilibriumCurve<'a>);

impl Extended<'_> {
    fn at(&self, u: &Vector, lambda: f64) -> (Vector, [f64; 2]) {
        let n = self.0.family.dimension();
        (u.rows(0, n).into_owned(), [u[n], lambda])
    }
}

/// The derivative of det A along a change of A: the trace of the adjugate times it, which exists where A is singular.
fn determinant_slope(a: &Matrix) -> Result<impl Fn(&Matrix) -> f64 + use<>> {
    let decomposed = a.clone().svd(true, true);
    let (Some(u), Some(v_t)) = (decomposed.u, decomposed.v_t) else {
        return Err(Error::NotConverged {
            what: "the adjugate of a Jacobian",
            iterations: 0,
            residual: f64::INFINITY,
            tolerance: 0.0,
        });
    };
    let sign = u.determinant() * v_t.determinant();
    let sigma = decomposed.singular_values;
    Ok(move |change: &Matrix| {
        let turned = u.transpose() * change * v_t.transpose();
        let others = |i: usize| (0..sigma.len()).filter(move |&j| j != i);
        let term = |i: usize| turned[(i, i)] * others(i).map(|j| sigma[j]).product::<f64>();
        sign * (0..sigma.len()).map(term).sum::<f64>()
    })
}

/// That a field can be differentiated in parameters.
fn parametrised(field: &AnyField<'_>) -> Result<()> {
    if !field.parameter_names().is_empty() {
        return Ok(());
    }
    Err(Error::parameter(
        "the family",
        "fields without parameters",
        "fields with named ones",
    ))
}

impl ZeroProblem for Extended<'_> {
    fn dimension(&self) -> usize {
        self.0.family.dimension() + 1
    }

    fn residual(&self, u: &Vector, lambda: f64) -> Result<Vector> {
        let (y, at) = self.at(u, lambda);
        let field = self.0.family.field(at);
        let singular = self.0.singular(&field.jacobian(&y));
        Ok(field.f(&y).push(singular.determinant()))
    }

    fn jacobian(&self, u: &Vector, lambda: f64) -> Result<Matrix> {
        let (y, at) = self.at(u, lambda);
        let field = self.0.family.field(at);
        parametrised(&field)?;
        let n = y.len();
        let j = field.jacobian(&y);
        let slope = determinant_slope(&self.0.singular(&j))?;
        let units: Vec<_> = (0..n)
            .map(|i| Vector::from_fn(n, |k, _| f64::from(u8::from(i == k))))
            .collect();
        let mut all = Matrix::zeros(n + 1, n + 2);
        let mut put = |column: usize, f: &[f64], of_jacobian: &Matrix| {
            all.column_mut(column).rows_mut(0, n).copy_from_slice(f);
            all[(n, column)] = slope(&self.0.singular(of_jacobian));
        };
        for (i, unit) in units.iter().enumerate() {
            let columns = units.iter().map(|v| field.second_derivative(&y, unit, v));
            let columns = Matrix::from_columns(&columns.collect::<Vec<_>>());
            put(i, j.column(i).as_slice(), &columns);
        }
        let scale = self.0.family.scale(at);
        for (k, place) in self.0.family.plane().into_iter().enumerate() {
            let f = field.parameter_derivative(&y, place) * scale[k];
            let of_jacobian = field.parameter_jacobian(&y, place) * scale[k];
            put(n + k, f.as_slice(), &of_jacobian);
        }
        Ok(all)
    }
}

struct Observer<'a, 'b> {
    problem: &'a Extended<'b>,
    seen: &'a mut dyn FnMut(&EquilibriumCurvePoint) -> ControlFlow<()>,
}

impl CurveObserver for Observer<'_, '_> {
    fn seen(&mut self, point: &CurvePoint, _: PointKind) -> ControlFlow<()> {
        /// What is left of the real part, over the imaginary one.
        const AXIS: f64 = 1e-6;
        let (state, at) = self.problem.at(&point.u, point.lambda);
        let jacobian = self.problem.0.family.field(at).jacobian(&state);
        let all = jacobian.complex_eigenvalues();
        let pairs = all.iter().filter(|z| z.re.abs() < AXIS * z.im);
        let nearest = pairs.min_by(|a, b| a.re.abs().total_cmp(&b.re.abs()));
        let frequency = match self.problem.0.kind {
            EquilibriumBifurcation::Fold => None,
            EquilibriumBifurcation::Hopf => nearest.map(|z| z.im),
        };
        (self.seen)(&EquilibriumCurvePoint {
            state,
            at,
            frequency,
        })
    }
}
