//! Curves of folds and of Hopf points of equilibria of any small system, in the plane of two of its parameters.
//!
//! Solved are f(y; p) = 0 and a determinant: of the Jacobian at a fold, of the bialternate product 2 J (.) 1 at a Hopf point
//! (Kuznetsov 2004, section 10.3). All derivatives are the field's own.

use super::bialternate::bialternate;
use crate::continuation::{
    Branch, CurveObserver, CurvePoint, PointKind, Settings, Start, ZeroProblem, follow,
};
use crate::error::{Error, Result};
use crate::field::{Parametrised, State, VectorField};
use crate::orbit::ParametrisedField;
use nalgebra::{DMatrix, DVector};
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
#[derive(Debug, Clone, Copy)]
pub struct EquilibriumCurve<'a, F> {
    /// The family, in whose coordinates the curve is followed.
    pub family: &'a F,
    /// What bifurcates.
    pub kind: EquilibriumBifurcation,
}

/// A point of the curve.
#[derive(Debug, Clone, PartialEq)]
#[non_exhaustive]
pub struct EquilibriumCurvePoint<const N: usize> {
    /// The equilibrium.
    pub state: State<N>,
    /// The family's coordinates.
    pub at: [f64; 2],
    /// omega of the pair on the imaginary axis; `None` at folds, and at neutral saddles, into which a curve of Hopf points runs on.
    pub frequency: Option<f64>,
}

impl<F> EquilibriumCurve<'_, F> {
    /// The matrix whose determinant vanishes, linear in the Jacobian.
    fn singular(&self, jacobian: &DMatrix<f64>) -> DMatrix<f64> {
        match self.kind {
            EquilibriumBifurcation::Fold => jacobian.clone(),
            EquilibriumBifurcation::Hopf => bialternate(jacobian),
        }
    }

    /// The curve from near a point of it, with the second coordinate growing or falling at first, until that leaves the range of
    /// the settings.
    ///
    /// # Errors
    /// Those of [`follow`]; [`Error::Parameter`] for fields without named parameters.
    pub fn follow<const N: usize>(
        &self,
        (state, at): (State<N>, [f64; 2]),
        growing: bool,
        settings: &Settings,
        seen: &mut dyn FnMut(&EquilibriumCurvePoint<N>) -> ControlFlow<()>,
    ) -> Result<Branch>
    where
        F: ParametrisedField<N>,
    {
        let mut direction = DVector::zeros(N + 2);
        direction[N + 1] = if growing { 1.0 } else { -1.0 };
        let start = Start {
            u: DVector::from_fn(N + 1, |i, _| if i < N { state[i] } else { at[0] }),
            lambda: at[1],
            direction,
            across: false,
        };
        let problem = Extended::<F, N>(self);
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
struct Extended<'a, F, const N: usize>(&'a EquilibriumCurve<'a, F>);

fn dense<const N: usize>(matrix: &crate::field::Jacobian<N>) -> DMatrix<f64> {
    DMatrix::from_column_slice(N, N, matrix.as_slice())
}

impl<F: ParametrisedField<N>, const N: usize> Extended<'_, F, N> {
    fn at(&self, u: &DVector<f64>, lambda: f64) -> (State<N>, [f64; 2]) {
        (State::from_fn(|i, _| u[i]), [u[N], lambda])
    }
}

/// The derivative of det A along a change of A: the trace of the adjugate times it, which exists where A is singular.
fn determinant_slope(a: &DMatrix<f64>) -> Result<impl Fn(&DMatrix<f64>) -> f64 + use<>> {
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
    Ok(move |change: &DMatrix<f64>| {
        let turned = u.transpose() * change * v_t.transpose();
        let others = |i: usize| (0..sigma.len()).filter(move |&j| j != i);
        let term = |i: usize| turned[(i, i)] * others(i).map(|j| sigma[j]).product::<f64>();
        sign * (0..sigma.len()).map(term).sum::<f64>()
    })
}

fn parameters<const N: usize>(field: &dyn VectorField<N>) -> Result<&dyn Parametrised<N>> {
    field.parametrised().ok_or_else(|| {
        Error::parameter(
            "the family",
            "fields without parameters",
            "fields with named ones",
        )
    })
}

impl<F: ParametrisedField<N>, const N: usize> ZeroProblem for Extended<'_, F, N> {
    fn dimension(&self) -> usize {
        N + 1
    }

    fn residual(&self, u: &DVector<f64>, lambda: f64) -> Result<DVector<f64>> {
        let (y, at) = self.at(u, lambda);
        let field = self.0.family.field(at);
        let singular = self.0.singular(&dense(&field.jacobian(&y)));
        let f = field.f(&y);
        let test = singular.determinant();
        Ok(DVector::from_fn(
            N + 1,
            |i, _| if i < N { f[i] } else { test },
        ))
    }

    fn jacobian(&self, u: &DVector<f64>, lambda: f64) -> Result<DMatrix<f64>> {
        let (y, at) = self.at(u, lambda);
        let field = self.0.family.field(at);
        let named = parameters(&*field)?;
        let j = field.jacobian(&y);
        let slope = determinant_slope(&self.0.singular(&dense(&j)))?;
        let unit = |i: usize| State::<N>::from_fn(|k, _| f64::from(u8::from(i == k)));
        let mut all = DMatrix::zeros(N + 1, N + 2);
        let mut put = |column: usize, f: &[f64], of_jacobian: DMatrix<f64>| {
            all.column_mut(column).rows_mut(0, N).copy_from_slice(f);
            all[(N, column)] = slope(&self.0.singular(&of_jacobian));
        };
        for i in 0..N {
            let columns = DMatrix::from_fn(N, N, |row, k| {
                field.second_derivative(&y, &unit(i), &unit(k))[row]
            });
            put(i, j.column(i).as_slice(), columns);
        }
        let scale = self.0.family.scale(at);
        for (k, place) in self.0.family.plane().into_iter().enumerate() {
            let f = named.parameter_derivative(&y, place) * scale[k];
            let of_jacobian = named.parameter_jacobian(&y, place) * scale[k];
            put(N + k, f.as_slice(), dense(&of_jacobian));
        }
        Ok(all)
    }
}

struct Observer<'a, 'b, F, const N: usize> {
    problem: &'a Extended<'b, F, N>,
    seen: &'a mut dyn FnMut(&EquilibriumCurvePoint<N>) -> ControlFlow<()>,
}

impl<F: ParametrisedField<N>, const N: usize> CurveObserver for Observer<'_, '_, F, N> {
    fn seen(&mut self, point: &CurvePoint, _: PointKind) -> ControlFlow<()> {
        /// What is left of the real part, over the imaginary one.
        const AXIS: f64 = 1e-6;
        let (state, at) = self.problem.at(&point.u, point.lambda);
        let jacobian = self.problem.0.family.field(at).jacobian(&state);
        let all = dense(&jacobian).complex_eigenvalues();
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
