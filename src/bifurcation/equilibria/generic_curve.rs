//! Curves of folds and of Hopf points of equilibria of any small system, in the plane of two of its parameters.
//!
//! Solved are f(y; p) = 0 and a determinant: of the Jacobian at a fold, of the bialternate product 2 J (.) 1 at a Hopf point
//! (Kuznetsov 2004, section 10.3). All derivatives are the field's own.

use super::bialternate::{bialternate, lyapunov};
use crate::bifurcation::Label;
use crate::continuation::{
    Branch, CurveObserver, CurvePoint, PointKind, Settings, Start, ZeroProblem, follow,
};
use crate::error::{Error, Result};
use crate::field::{Matrix, Vector};
use crate::integrate::{AnyField, of_dimension};
use crate::number::Uncertain;
use crate::orbit::ParametrisedField;
use nalgebra::Complex;
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
    /// The first Lyapunov coefficient of a Hopf point, with <q, q> = 1: positive where the small orbits are unstable.
    pub coefficient: Option<f64>,
    /// `CP`, `BT`, `ZH`, `GH`, `UZ`, `EP`, where the point is one of these.
    pub label: Option<Label>,
    /// The coordinates may be off by this; known of special points.
    pub uncertainty: Option<[f64; 2]>,
}

/// How far a curve is followed in the first coordinate, and where it lands.
#[derive(Debug, Clone, PartialEq)]
pub struct FirstCoordinate {
    /// From, to.
    pub range: (f64, f64),
    /// Values to land on.
    pub wanted: Vec<f64>,
}

impl Default for FirstCoordinate {
    /// All of it.
    fn default() -> Self {
        FirstCoordinate {
            range: (f64::NEG_INFINITY, f64::INFINITY),
            wanted: Vec::new(),
        }
    }
}

/// A bifurcation that was solved for in the last digits.
#[derive(Debug, Clone, PartialEq)]
#[non_exhaustive]
pub struct SharpEquilibrium {
    /// The equilibrium.
    pub state: Vector,
    /// The family's coordinates.
    pub at: [f64; 2],
    /// They may be off by this.
    pub uncertainty: [f64; 2],
    /// omega of the pair on the imaginary axis, at a Hopf point.
    pub frequency: Option<Uncertain>,
}

impl EquilibriumCurve<'_> {
    /// The matrix whose determinant vanishes, linear in the Jacobian.
    fn singular(&self, jacobian: &Matrix) -> Matrix {
        match self.kind {
            EquilibriumBifurcation::Fold => jacobian.clone(),
            EquilibriumBifurcation::Hopf => bialternate(jacobian),
        }
    }

    /// The point of the curve near another one where the coordinate of this number is what it is there, in the last digits.
    pub fn sharp(&self, state: &Vector, at: [f64; 2], held: usize) -> Option<SharpEquilibrium> {
        /// Iterations, and a correction that is the last.
        const ITERATIONS: usize = 40;
        const DONE: f64 = 1e-15;
        let (n, problem) = (state.len(), Extended(self));
        let mut u = state.clone().push(at[0]).push(at[1]);
        let residual = |u: &Vector| problem.residual(&u.rows(0, n + 1).into_owned(), u[n + 1]);
        let mut last = f64::INFINITY;
        for _ in 0..ITERATIONS {
            let square = problem.square(&u, n + held)?;
            let step = square.lu().solve(&residual(&u).ok()?)?;
            let size = relative(&step, &u.clone().remove_row(n + held));
            if !size.is_finite() {
                return None;
            }
            u -= step.insert_row(n + held, 0.0);
            // Rounding alone is left where corrections cease to shrink.
            if size < DONE || size >= 0.5 * last && size < SMALL {
                let uncertainty = problem.budget(&u, n + held)?;
                return Some(SharpEquilibrium {
                    state: u.rows(0, n).into_owned(),
                    at: [u[n], u[n + 1]],
                    uncertainty: [uncertainty[n], uncertainty[n + 1]],
                    frequency: problem.frequency_within(&u, &uncertainty),
                });
            }
            last = size;
        }
        None
    }

    /// The curve from near a point of it, with the second coordinate growing or falling at first, until that leaves the range of
    /// the settings.
    ///
    /// # Errors
    /// Those of [`follow`]; [`Error::Parameter`] for fields without named parameters or a start of another dimension than theirs.
    pub fn follow(
        &self,
        start: (&Vector, [f64; 2]),
        growing: bool,
        settings: &Settings,
        seen: &mut dyn FnMut(&EquilibriumCurvePoint) -> ControlFlow<()>,
    ) -> Result<Branch> {
        self.follow_within(start, growing, settings, &FirstCoordinate::default(), seen)
    }

    /// The same as far as the first coordinate stays in a range, with values of it to land on.
    ///
    /// # Errors
    /// As of [`EquilibriumCurve::follow`].
    pub fn follow_within(
        &self,
        (state, at): (&Vector, [f64; 2]),
        growing: bool,
        settings: &Settings,
        first: &FirstCoordinate,
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
                first,
                seen,
            },
        )
    }
}

/// f and the determinant as functions of the state and the first coordinate, and of the second.
struct Extended<'a>(&'a EquilibriumCurve<'a>);

/// A correction by Newton's method that may be left to rounding.
const SMALL: f64 = 1e-9;

/// The largest component in units of 1 + |u|.
fn relative(step: &Vector, u: &Vector) -> f64 {
    let parts = step.iter().zip(u).map(|(d, x)| (d / (1.0 + x.abs())).abs());
    parts.fold(
        0.0,
        |most: f64, part| if part.is_nan() { part } else { most.max(part) },
    )
}

impl Extended<'_> {
    /// The derivatives in all of (state, coordinates) but one.
    fn square(&self, u: &Vector, held: usize) -> Option<Matrix> {
        let n = u.len() - 2;
        let all = self
            .jacobian(&u.rows(0, n + 1).into_owned(), u[n + 1])
            .ok()?;
        Some(all.remove_column(held))
    }

    /// omega at a Hopf point whose unknowns may be off by so much.
    fn frequency_within(&self, u: &Vector, off: &Vector) -> Option<Uncertain> {
        /// So many points are looked at, and what their largest distance counts.
        const TRIED: usize = 4;
        const SAFETY: f64 = 2.0;
        let of = |u: &Vector| {
            let (state, at) = self.at(&u.rows(0, u.len() - 1).into_owned(), u[u.len() - 1]);
            frequency(&self.0.family.field(at).jacobian(&state))
        };
        let here = of(u).filter(|_| self.0.kind == EquilibriumBifurcation::Hopf)?;
        let mut far = 0.0_f64;
        for time in 0..TRIED {
            let moved = Vector::from_fn(u.len(), |i, _| u[i] + sign(i, time) * off[i]);
            far = far.max((of(&moved)? - here).abs());
        }
        Some(Uncertain::new(
            here,
            SAFETY * far + 8.0 * f64::EPSILON * here,
        ))
    }

    /// What rounding makes of a solution: the residuals that are met when the unknowns are changed in their last digit, as the
    /// equations carry them to the unknowns.
    fn budget(&self, u: &Vector, held: usize) -> Option<Vector> {
        /// So many changes, and what their largest residual counts.
        const TRIED: usize = 8;
        const SAFETY: f64 = 4.0;
        let n = u.len() - 2;
        let mut noise = Vector::zeros(n + 1);
        for time in 0..TRIED {
            let moved = Vector::from_fn(n + 2, |i, _| {
                u[i] + sign(i, time) * f64::EPSILON * u[i].abs()
            });
            let left = self
                .residual(&moved.rows(0, n + 1).into_owned(), moved[n + 1])
                .ok()?;
            noise = noise.zip_map(&left, |most: f64, x: f64| most.max(x.abs()));
        }
        let inverse = self.square(u, held)?.try_inverse()?;
        let off = inverse.abs() * noise * SAFETY;
        let off = off.insert_row(held, 0.0);
        let budget = off.zip_map(u, |off, x| off + f64::EPSILON * x.abs());
        budget.iter().all(|x| x.is_finite()).then_some(budget)
    }

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
    first: &'a FirstCoordinate,
    seen: &'a mut dyn FnMut(&EquilibriumCurvePoint) -> ControlFlow<()>,
}

/// The vector that the matrix maps to nearly zero, with a positive product with another one.
fn kernel(matrix: &Matrix, along: &Vector) -> Option<Vector> {
    let decomposed = matrix.clone().svd(false, true);
    let smallest = decomposed.singular_values.imin();
    let kernel = decomposed.v_t?.row(smallest).transpose();
    Some(if kernel.dot(along) < 0.0 {
        -kernel
    } else {
        kernel
    })
}

/// Signs that differ from one time to the next.
fn sign(i: usize, time: usize) -> f64 {
    if ((i + 2) * (2 * time + 3) / 2).is_multiple_of(2) {
        1.0
    } else {
        -1.0
    }
}

/// omega of the pair that is on the imaginary axis.
fn frequency(jacobian: &Matrix) -> Option<f64> {
    /// What is left of the real part, over the imaginary one.
    const AXIS: f64 = 1e-6;
    let all = jacobian.complex_eigenvalues();
    let pairs = all.iter().filter(|z| z.re.abs() < AXIS * z.im);
    let nearest = pairs.min_by(|a, b| a.re.abs().total_cmp(&b.re.abs()));
    nearest.map(|z| z.im)
}

/// So many functions tell what is special on a curve.
const FUNCTIONS: usize = 2;

impl Observer<'_, '_> {
    /// Of folds: how the determinant changes along the kernel, zero at cusps, and the product of the sums of two eigenvalues. Of
    /// Hopf points: the first Lyapunov coefficient, and the determinant.
    fn functions(&self, u: &Vector, tangent: &Vector) -> Result<[f64; 2]> {
        /// The least part of a unit tangent that tells the sign of a vector.
        const ORIENTED: f64 = 1e-6;
        let n = u.len() - 2;
        let (state, at) = (u.rows(0, n).into_owned(), [u[n], u[n + 1]]);
        let field = self.problem.0.family.field(at);
        let jacobian = field.jacobian(&state);
        Ok(match self.problem.0.kind {
            EquilibriumBifurcation::Fold => {
                let along = tangent.rows(0, n).into_owned();
                let kernel = kernel(&jacobian, &along).unwrap_or_else(|| Vector::zeros(n));
                // Its sign is that of the way along the curve, which has one near cusps.
                let oriented = kernel.dot(&along).abs() > ORIENTED;
                let unknown = if oriented { 1.0 } else { f64::NAN };
                let unit = |i: usize| Vector::from_fn(n, |k, _| f64::from(u8::from(i == k)));
                let columns = (0..n).map(|i| field.second_derivative(&state, &kernel, &unit(i)));
                let change = Matrix::from_columns(&columns.collect::<Vec<_>>());
                [
                    determinant_slope(&jacobian)?(&change) * unknown,
                    bialternate(&jacobian).determinant(),
                ]
            }
            EquilibriumBifurcation::Hopf => {
                let omega = frequency(&jacobian);
                let coefficient = omega.and_then(|omega| lyapunov(&field, &state, omega));
                [coefficient.unwrap_or(f64::NAN), jacobian.determinant()]
            }
        })
    }

    /// What the i-th function's zero is; `None` where it is nothing.
    fn label(&self, i: usize, omega: Option<f64>, jacobian: &Matrix) -> Option<Label> {
        /// Against the matrix: of a pair that is a double zero, and so known to half of the digits.
        const DOUBLE: f64 = 1e-4;
        let all = jacobian.complex_eigenvalues();
        let zero = |z: &&Complex<f64>| z.norm() < DOUBLE * jacobian.amax();
        let near = all.iter().filter(zero).count();
        match (self.problem.0.kind, i) {
            (EquilibriumBifurcation::Fold, 0) => Some(Label::Cp),
            (EquilibriumBifurcation::Hopf, 0) => Some(Label::Gh),
            _ if near >= 2 => Some(Label::Bt),
            (EquilibriumBifurcation::Fold, _) => frequency(jacobian).map(|_| Label::Zh),
            // On a curve of neutral saddles an eigenvalue zero is nothing.
            (EquilibriumBifurcation::Hopf, _) => omega.map(|_| Label::Zh),
        }
    }

    /// How far the coordinates of a zero of the i-th function may be off: by the curve's own rounding, and along it by what is
    /// left of the function and its noise over its slope.
    fn off(&self, i: usize, point: &CurvePoint) -> Option<[f64; 2]> {
        const BESIDE: f64 = 1e-5;
        const TRIED: usize = 4;
        /// To which points of a curve are corrected.
        const TOLERANCE: f64 = 1e-13;
        let n = point.u.len() - 1;
        let u = point.u.push(point.lambda);
        let of = |u: &Vector| self.functions(u, &point.tangent).ok().map(|all| all[i]);
        let step = BESIDE * (1.0 + u.amax());
        let ahead = of(&(&u + &point.tangent * step))?;
        let slope = (ahead - of(&(&u - &point.tangent * step))?) / (2.0 * step);
        let here = of(&u)?;
        let mut noise = here.abs();
        for time in 0..TRIED {
            let moved = Vector::from_fn(u.len(), |k, _| {
                u[k] * (1.0 + sign(k, time) * 4.0 * f64::EPSILON)
            });
            noise += (of(&moved)? - here).abs();
        }
        let along = noise / slope.abs();
        let across = (0..2).filter_map(|k| self.problem.budget(&u, n + k));
        let across = across.min_by(|a, b| a.amax().total_cmp(&b.amax()))?;
        let off = [0, 1].map(|k| {
            let corrected = TOLERANCE * (1.0 + u[n + k].abs());
            across[n + k] + along * point.tangent[n + k].abs() + corrected
        });
        off.iter().all(|x| x.is_finite()).then_some(off)
    }
}

impl CurveObserver for Observer<'_, '_> {
    fn tests(&self, point: &CurvePoint) -> Result<Vec<f64>> {
        let mut all = self
            .functions(&point.u.push(point.lambda), &point.tangent)?
            .to_vec();
        let (first, FirstCoordinate { range, wanted }) = (point.u[point.u.len() - 1], self.first);
        let ends = [range.0, range.1].into_iter();
        let values = ends.chain(wanted.iter().copied());
        // An infinite end is never met.
        all.extend(values.map(|value| {
            if value.is_finite() {
                first - value
            } else {
                f64::NAN
            }
        }));
        Ok(all)
    }

    fn ends(&self, test: usize) -> bool {
        (FUNCTIONS..FUNCTIONS + 2).contains(&test)
    }

    fn seen(&mut self, point: &CurvePoint, mark: PointKind) -> ControlFlow<()> {
        /// Of the coordinates of a special point.
        const KNOWN: f64 = 1e-3;
        let (state, at) = self.problem.at(&point.u, point.lambda);
        let field = self.problem.0.family.field(at);
        let jacobian = field.jacobian(&state);
        let hopf = self.problem.0.kind == EquilibriumBifurcation::Hopf;
        let frequency = frequency(&jacobian).filter(|_| hopf);
        let label = match mark {
            PointKind::Step => None,
            PointKind::Zero(i) if self.ends(i) => Some(Label::Ep),
            PointKind::Zero(i) if i > FUNCTIONS => Some(Label::Uz),
            PointKind::Zero(i) => match self.label(i, frequency, &jacobian) {
                None => return ControlFlow::Continue(()),
                label => label,
            },
            PointKind::Wanted(_) => Some(Label::Uz),
            PointKind::Begin | PointKind::Lowest | PointKind::Highest => Some(Label::Ep),
        };
        let uncertainty = match mark {
            PointKind::Zero(i) if i < FUNCTIONS => match self.off(i, point) {
                // What is not known to some digits is no zero: of a function that jumps, or has a pole.
                Some(off) if off.iter().all(|&off| off < KNOWN) => Some(off),
                _ => return ControlFlow::Continue(()),
            },
            PointKind::Zero(_) => {
                let u = point.u.push(point.lambda);
                let budget = self.problem.budget(&u, state.len());
                budget.map(|budget| [0.0, budget[state.len() + 1]])
            }
            PointKind::Step => None,
            _ => {
                let u = point.u.push(point.lambda);
                let budget = self.problem.budget(&u, point.u.len());
                budget.map(|budget| [budget[state.len()], 0.0])
            }
        };
        let coefficient = frequency.and_then(|omega| lyapunov(&field, &state, omega));
        (self.seen)(&EquilibriumCurvePoint {
            state,
            at,
            frequency,
            coefficient,
            label,
            uncertainty,
        })
    }
}
