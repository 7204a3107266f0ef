//! Equilibria of any small system with a parameter: f(y; p) = 0 followed in p, with folds, branch points and Hopf points.
//!
//! A family of fields is a function of one parameter. Test functions: the tangent's component along p (fold); the determinant
//! of the extended Jacobian over the tangent (branch point); the determinant of the bialternate product 2 J (.) 1, the product of
//! all sums of two eigenvalues (Hopf; Kuznetsov 2004, section 10.2.2). The derivative in p is that of the field, or where
//! the field has no parameter of this name a difference of fourth order, with some 11 digits of special points; third derivatives, for the first Lyapunov coefficient, are differences too.
//!
//! Limits: two sums of eigenvalues that vanish together, and several branches through one point, are not untangled.

use super::bialternate::{bialternate, lyapunov};
use crate::bifurcation::Label;
use crate::continuation::{
    Branch, CurveObserver, CurvePoint, PointKind, Settings, Start, ZeroProblem, follow,
};
use crate::error::{Error, Result};
use crate::field::{State, VectorField, place};
use nalgebra::{Complex, DMatrix, DVector};
use std::f64::consts::TAU;
use std::ops::ControlFlow;

/// The field at a value of the parameter.
pub type Fields<'a, const N: usize> = &'a dyn Fn(f64) -> Box<dyn VectorField<N>>;

/// The equilibria of a family of fields along one parameter.
#[derive(Clone, Copy)]
pub struct FieldEquilibria<'a, const N: usize> {
    /// The fields.
    pub fields: Fields<'a, N>,
    /// The parameter's name, by which the fields know its derivatives.
    pub along: &'a str,
}

impl<const N: usize> std::fmt::Debug for FieldEquilibria<'_, N> {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        f.debug_struct("Family")
            .field("along", &self.along)
            .finish_non_exhaustive()
    }
}

/// A point of a branch of equilibria.
#[derive(Debug, Clone, PartialEq)]
#[non_exhaustive]
pub struct FoundEquilibrium<const N: usize> {
    /// The state.
    pub state: State<N>,
    /// The varied parameter.
    pub parameter: f64,
    /// By real part, the largest first.
    pub eigenvalues: Vec<Complex<f64>>,
    /// `LP`, `BP`, `HB`, `UZ`, `EP`, where the point is one of these.
    pub label: Option<Label>,
    /// Of the oscillation at a Hopf point.
    pub period: Option<f64>,
    /// The first Lyapunov coefficient of a Hopf point, with <q, q> = 1: positive where the small orbits are unstable.
    pub coefficient: Option<f64>,
    /// The unit tangent of the branch in (state, parameter).
    pub tangent: DVector<f64>,
}

/// Where a branch begins, and which way it goes.
#[derive(Debug, Clone, PartialEq)]
pub struct Onward<const N: usize> {
    /// Nearly an equilibrium.
    pub state: State<N>,
    /// The varied parameter there.
    pub parameter: f64,
    /// N + 1 long, in (state, parameter).
    pub direction: DVector<f64>,
    /// Whether the first point may have another parameter, and lies across the direction.
    pub across: bool,
}

impl<const N: usize> Onward<N> {
    /// With the parameter growing, or falling.
    pub fn along(state: State<N>, parameter: f64, growing: bool) -> Self {
        let mut direction = DVector::zeros(N + 1);
        direction[N] = if growing { 1.0 } else { -1.0 };
        Onward {
            state,
            parameter,
            direction,
            across: false,
        }
    }
}

/// Part of 1 + |p| by which the parameter is changed for a derivative.
const CHANGE: f64 = 1e-3;

impl<const N: usize> FieldEquilibria<'_, N> {
    fn field(&self, parameter: f64) -> Box<dyn VectorField<N>> {
        (self.fields)(parameter)
    }

    /// df/dp.
    fn in_parameter(&self, y: &State<N>, p: f64) -> State<N> {
        let here = self.field(p);
        if let Some(field) = here.parametrised()
            && let Ok(place) = place(field.names(), self.along)
        {
            return field.parameter_derivative(y, place);
        }
        let h = CHANGE * (1.0 + p.abs());
        let f = |p: f64| self.field(p).f(y);
        ((f(p + h) - f(p - h)) * 8.0 - (f(p + 2.0 * h) - f(p - 2.0 * h))) / (12.0 * h)
    }

    fn dense(&self, y: &State<N>, p: f64) -> DMatrix<f64> {
        let j = self.field(p).jacobian(y);
        DMatrix::from_fn(N, N, |i, l| j[(i, l)])
    }

    fn eigenvalues(&self, y: &State<N>, p: f64) -> Vec<Complex<f64>> {
        let all = self.dense(y, p).complex_eigenvalues();
        let mut all: Vec<_> = all.iter().copied().collect();
        all.sort_by(|a, b| b.re.total_cmp(&a.re).then(b.im.total_cmp(&a.im)));
        all
    }

    /// omega of the pair whose real part is nearest to zero, if it is a pair: the test function vanishes for two real
    /// eigenvalues of opposite sign too.
    fn frequency(&self, y: &State<N>, p: f64) -> Option<f64> {
        let all = self.eigenvalues(y, p);
        let pair = all.into_iter().filter(|z| z.im > 0.0);
        let nearest = pair.min_by(|a, b| a.re.abs().total_cmp(&b.re.abs()))?;
        (nearest.re.abs() < 1e-6 * nearest.im).then_some(nearest.im)
    }

    /// The equilibria from a start until the range ends.
    ///
    /// # Errors
    /// Those of [`follow`].
    pub fn follow(
        &self,
        onward: &Onward<N>,
        settings: &Settings,
        seen: &mut dyn FnMut(&FoundEquilibrium<N>) -> ControlFlow<()>,
    ) -> Result<Branch> {
        let start = Start {
            u: DVector::from_column_slice(onward.state.as_slice()),
            lambda: onward.parameter,
            direction: onward.direction.clone(),
            across: onward.across,
        };
        let mut look = EquilibriumObserver { family: self, seen };
        follow(self, &start, settings, &mut look)
    }

    /// The two ways that leave a branch point, on the branch that crosses the one it was found on.
    ///
    /// The first point lies at `distance`, which should be small: at right angles to the first branch the second one is met
    /// where it is a pitchfork, and nearly so elsewhere.
    ///
    /// # Errors
    /// [`Error::NotConverged`] if the singular value decomposition fails.
    pub fn switch(&self, point: &FoundEquilibrium<N>, distance: f64) -> Result<[Onward<N>; 2]> {
        let y = point.state;
        let mut matrix = DMatrix::zeros(N + 1, N + 1);
        let j = self.dense(&y, point.parameter);
        matrix.view_mut((0, 0), (N, N)).copy_from(&j);
        let in_p = self.in_parameter(&y, point.parameter);
        matrix
            .view_mut((0, N), (N, 1))
            .copy_from_slice(in_p.as_slice());
        matrix.row_mut(N).copy_from(&point.tangent.transpose());
        let decomposed = matrix.svd(false, true);
        let smallest = decomposed.singular_values.imin();
        let Some(null) = decomposed.v_t.map(|v_t| v_t.row(smallest).transpose()) else {
            return Err(Error::NotConverged {
                what: "the direction of the second branch",
                iterations: 0,
                residual: f64::INFINITY,
                tolerance: 0.0,
            });
        };
        Ok([1.0, -1.0].map(|sign| {
            let direction: DVector<f64> = &null * sign;
            Onward {
                state: y + State::<N>::from_fn(|i, _| direction[i] * distance),
                parameter: point.parameter + direction[N] * distance,
                direction,
                across: true,
            }
        }))
    }
}

fn state<const N: usize>(u: &DVector<f64>) -> State<N> {
    State::<N>::from_column_slice(u.as_slice())
}

impl<const N: usize> ZeroProblem for FieldEquilibria<'_, N> {
    fn dimension(&self) -> usize {
        N
    }

    fn residual(&self, u: &DVector<f64>, lambda: f64) -> Result<DVector<f64>> {
        let f = self.field(lambda).f(&state(u));
        Ok(DVector::from_column_slice(f.as_slice()))
    }

    fn jacobian(&self, u: &DVector<f64>, lambda: f64) -> Result<DMatrix<f64>> {
        let y = state(u);
        let in_parameter = self.in_parameter(&y, lambda);
        let mut all = self.dense(&y, lambda).insert_column(N, 0.0);
        all.column_mut(N).copy_from_slice(in_parameter.as_slice());
        Ok(all)
    }
}

/// Zero where nothing but rounding is left: of a function that is zero throughout, as the sums of eigenvalues of a conservative
/// system or the slope of a branch at one parameter, rounding has signs that mean nothing.
fn certain(x: f64, rounding: f64) -> f64 {
    if x.abs() < rounding { 0.0 } else { x }
}

/// The product of all sums of two eigenvalues.
fn sums(jacobian: &DMatrix<f64>) -> f64 {
    /// Of the entries, relative, with which the product is computed again to see what rounding makes of it.
    const ROUNDING: f64 = 32.0 * f64::EPSILON;
    /// So often, with other signs.
    const TIMES: usize = 4;
    let product = bialternate(jacobian).determinant();
    let moved = |time: usize| {
        let sign = |i: usize, j: usize| ((i + 1) * (j + 1) * (7 + 2 * time) / 2) % 2;
        let entry = |i, j, x: f64| x * (1.0 + ROUNDING * (1.0 - 2.0 * sign(i, j) as f64));
        let other = jacobian.map_with_location(entry);
        (bialternate(&other).determinant() - product).abs()
    };
    certain(product, (0..TIMES).map(moved).sum())
}

/// The test functions' order.
const LABELS: [Label; 3] = [Label::Lp, Label::Bp, Label::Hb];

struct EquilibriumObserver<'a, 'b, const N: usize> {
    family: &'a FieldEquilibria<'b, N>,
    seen: &'a mut dyn FnMut(&FoundEquilibrium<N>) -> ControlFlow<()>,
}

impl<const N: usize> CurveObserver for EquilibriumObserver<'_, '_, N> {
    fn tests(&self, point: &CurvePoint) -> Result<Vec<f64>> {
        let y = state(&point.u);
        let extended = self.family.jacobian(&point.u, point.lambda)?;
        let mut square = extended.insert_row(N, 0.0);
        square.row_mut(N).copy_from(&point.tangent.transpose());
        /// Below this a component of the unit tangent is rounding: that of the difference in p.
        const SLOPE: f64 = 1e-12;
        Ok(vec![
            certain(point.lambda_slope(), SLOPE),
            square.determinant(),
            sums(&self.family.dense(&y, point.lambda)),
        ])
    }

    fn seen(&mut self, point: &CurvePoint, mark: PointKind) -> ControlFlow<()> {
        let (y, p) = (state(&point.u), point.lambda);
        let label = match mark {
            PointKind::Step => None,
            PointKind::Zero(i) => Some(LABELS[i]),
            PointKind::Wanted(_) => Some(Label::Uz),
            PointKind::Begin | PointKind::Lowest | PointKind::Highest => Some(Label::Ep),
        };
        let mut found = FoundEquilibrium {
            state: y,
            parameter: p,
            eigenvalues: self.family.eigenvalues(&y, p),
            label,
            period: None,
            coefficient: None,
            tangent: point.tangent.clone(),
        };
        if label == Some(Label::Hb) {
            let Some(omega) = self.family.frequency(&y, p) else {
                return ControlFlow::Continue(());
            };
            found.period = Some(TAU / omega);
            found.coefficient = lyapunov(&*self.family.field(p), &y, omega);
        }
        (self.seen)(&found)
    }
}
