//! Equilibria of any small system with a parameter: f(y; p) = 0 followed in p, with folds, branch points and Hopf points.
//!
//! A family of fields is a function of one parameter. Test functions: the tangent's component along p (fold); the determinant
//! of the extended Jacobian over the tangent (branch point); the determinant of the bialternate product 2 J (.) 1, the product of
//! all sums of two eigenvalues (Hopf; Kuznetsov 2004, section 10.2.2); of many variables what takes the place of determinants (`critical`). The derivative in p is that of the field, or where
//! the field has no parameter of this name a difference of fourth order, with some 11 digits of special points; third derivatives,
//! for the first Lyapunov coefficient, are differences too.
//!
//! Where symmetry makes several eigenvalues vanish together, that is found ahead, and the branches that begin there (`multiple`).

use super::generic_crossing::BranchCrossing;
use super::generic_curve_problem::sign;
use super::generic_observer::EquilibriumObserver;
use super::multiple::MultiplePoint;
use crate::bifurcation::Label;
use crate::continuation::{Branch, Settings, Start, Stop, ZeroProblem, follow};
use crate::error::{Error, Result};
use crate::field::{Matrix, Vector, place};
use crate::integrate::{AnyExact, AnyField, of_dimension};
use crate::number::{self, null_vector};
use crate::orbit::beyond_noise;
use nalgebra::Complex;
use std::ops::ControlFlow;

/// The field at a value of the parameter.
pub type Fields<'a> = &'a dyn Fn(f64) -> AnyField<'a>;

/// The equilibria of a family of fields along one parameter.
#[derive(Clone, Copy)]
pub struct FieldEquilibria<'a> {
    /// The fields.
    pub fields: Fields<'a>,
    /// The parameter's name, by which the fields know its derivatives.
    pub along: &'a str,
    /// The derivative of the parameter in what the fields are a function of, where that is another coordinate of it.
    pub scale: Option<&'a dyn Fn(f64) -> f64>,
    /// The range of each variable, at whose ends branches end; empty where nothing bounds them.
    pub bounds: &'a [(f64, f64)],
}

impl std::fmt::Debug for FieldEquilibria<'_> {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        f.debug_struct("Family")
            .field("along", &self.along)
            .finish_non_exhaustive()
    }
}

/// A point of a branch of equilibria.
#[derive(Debug, Clone, PartialEq)]
#[non_exhaustive]
pub struct FoundEquilibrium {
    /// The state.
    pub state: Vector,
    /// The varied parameter.
    pub parameter: f64,
    /// It may be off by this; known of branch points.
    pub uncertainty: Option<f64>,
    /// How branches cross at a branch point.
    pub crossing: Option<BranchCrossing>,
    /// By real part, the largest first.
    pub eigenvalues: Vec<Complex<f64>>,
    /// `LP`, `BP`, `HB`, `UZ`, `UF`, `EP`, where the point is one of these.
    pub label: Option<Label>,
    /// Of eigenvalues that cross the imaginary axis together, more than one or one pair, how many there are; else 0.
    pub together: usize,
    /// Where several eigenvalues are 0, that point as far as branches that begin there need it.
    pub multiple: Option<MultiplePoint>,
    /// Where one of the user's functions is zero, its number.
    pub zero_of: Option<usize>,
    /// At a bound of a variable, where the branch leaves the box: which variable, and whether the bound is the upper one.
    pub leaves: Option<(usize, bool)>,
    /// Of the oscillation at a Hopf point.
    pub period: Option<f64>,
    /// The first Lyapunov coefficient of a Hopf point, with <q, q> = 1: positive where the small orbits are unstable.
    pub coefficient: Option<f64>,
    /// The unit tangent of the branch in (state, parameter).
    pub tangent: Vector,
}

/// Where a branch begins, and which way it goes.
#[derive(Debug, Clone, PartialEq)]
pub struct Onward {
    /// Nearly an equilibrium.
    pub state: Vector,
    /// The varied parameter there.
    pub parameter: f64,
    /// One longer than the state, in (state, parameter).
    pub direction: Vector,
    /// Whether the first point may have another parameter, and lies across the direction.
    pub across: bool,
}

impl Onward {
    /// With the parameter growing, or falling.
    pub fn along(state: Vector, parameter: f64, growing: bool) -> Self {
        let n = state.len();
        let mut direction = Vector::zeros(n + 1);
        direction[n] = if growing { 1.0 } else { -1.0 };
        Onward {
            state,
            parameter,
            direction,
            across: false,
        }
    }
}

/// The user's functions of (state, parameter) whose zeros are looked for along a branch.
#[derive(Clone, Copy)]
pub struct Watch<'a> {
    /// How many there are.
    pub count: usize,
    /// The value of one of them.
    pub of: &'a dyn Fn(usize, &Vector, f64) -> f64,
}

impl Watch<'_> {
    /// No functions.
    pub const NOTHING: Watch<'static> = Watch {
        count: 0,
        of: &|_, _, _| f64::NAN,
    };

    /// A value, or 0 within its noise.
    pub(super) fn value(&self, which: usize, y: &Vector, p: f64) -> f64 {
        /// What a point of a continuation may be off, in units of 1 + |x|.
        const OFF: f64 = 1e-12;
        let place = y.push(p);
        beyond_noise((self.of)(which, y, p), |time| {
            self.at(which, &moved_by(&place, OFF, time))
        })
    }

    /// A value at a point of (state, parameter).
    fn at(&self, which: usize, place: &Vector) -> f64 {
        let n = place.len() - 1;
        (self.of)(which, &place.rows(0, n).into_owned(), place[n])
    }
}

/// Numbers with errors of this size, in units of 1 + |x|.
pub(super) fn moved_by(place: &Vector, off: f64, time: usize) -> Vector {
    Vector::from_fn(place.len(), |i, _| {
        place[i] + sign(i, time) * off * (1.0 + place[i].abs())
    })
}

/// How a function changes with each of the numbers that it is of.
pub(super) fn gradient(of: &dyn Fn(&Vector) -> f64, at: &Vector) -> Vector {
    /// In units of 1 + |x|.
    const STEP: f64 = 1e-5;
    Vector::from_fn(at.len(), |i, _| {
        let step = STEP * (1.0 + at[i].abs());
        let beside = |step: f64| {
            let mut x = at.clone();
            x[i] += step;
            of(&x)
        };
        (beside(step) - beside(-step)) / (2.0 * step)
    })
}

/// Part of 1 + |p| by which the parameter is changed for a derivative.
const CHANGE: f64 = 1e-3;

impl<'a> FieldEquilibria<'a> {
    pub(super) fn field(&self, parameter: f64) -> AnyField<'a> {
        (self.fields)(parameter)
    }

    /// df/dp.
    pub(super) fn in_parameter(&self, y: &Vector, p: f64) -> Vector {
        let here = self.field(p);
        if let Ok(place) = place(here.parameter_names(), self.along) {
            let scale = self.scale.map_or(1.0, |scale| scale(p));
            return here.parameter_derivative(y, place) * scale;
        }
        let h = CHANGE * (1.0 + p.abs());
        let f = |p: f64| self.field(p).f(y);
        ((f(p + h) - f(p - h)) * 8.0 - (f(p + 2.0 * h) - f(p - 2.0 * h))) / (12.0 * h)
    }

    pub(super) fn jacobian(&self, y: &Vector, p: f64) -> Matrix {
        self.field(p).jacobian(y)
    }

    /// f and J, from 31 digits where the fields have these.
    pub(super) fn exact(&self, y: &Vector, p: f64) -> AnyExact {
        self.field(p).exact(y)
    }

    /// The equilibrium near a state; `None` where Newton's method does not find it.
    pub(in crate::bifurcation) fn corrected(&self, near: &Vector, p: f64) -> Option<Vector> {
        /// Iterations, and a correction that is the last, in units of 1 + |y|.
        const ITERATIONS: usize = 20;
        const DONE: f64 = 1e-13;
        let mut y = near.clone();
        for _ in 0..ITERATIONS {
            let step = self.jacobian(&y, p).lu().solve(&self.field(p).f(&y))?;
            let size = step
                .zip_map(&y, |d: f64, x: f64| (d / (1.0 + x.abs())).abs())
                .max();
            y -= step;
            if size < DONE {
                return Some(y);
            }
        }
        None
    }

    pub(super) fn eigenvalues(&self, y: &Vector, p: f64) -> Option<Vec<Complex<f64>>> {
        let mut all = number::eigenvalues(&self.jacobian(y, p))?;
        all.sort_by(|a, b| b.re.total_cmp(&a.re).then(b.im.total_cmp(&a.im)));
        Some(all)
    }

    /// omega of the pair whose real part is nearest to zero, if it is a pair: the test function vanishes for two real
    /// eigenvalues of opposite sign too.
    pub(super) fn frequency(&self, y: &Vector, p: f64) -> Option<f64> {
        let all = self.eigenvalues(y, p)?;
        let pair = all.into_iter().filter(|z| z.im > 0.0);
        let nearest = pair.min_by(|a, b| a.re.abs().total_cmp(&b.re.abs()))?;
        (nearest.re.abs() < 1e-6 * nearest.im).then_some(nearest.im)
    }

    /// The equilibria from a start until the range ends.
    ///
    /// # Errors
    /// [`Error::Parameter`] for a start of another dimension than the fields'; those of [`follow`].
    pub fn follow(
        &self,
        onward: &Onward,
        settings: &Settings,
        seen: &mut dyn FnMut(&FoundEquilibrium) -> ControlFlow<()>,
    ) -> Result<Branch> {
        self.follow_watching(onward, settings, Watch::NOTHING, seen)
    }

    /// The same with the zeros of functions on the way.
    ///
    /// # Errors
    /// As of [`Self::follow`].
    pub fn follow_watching(
        &self,
        onward: &Onward,
        settings: &Settings,
        watch: Watch<'_>,
        seen: &mut dyn FnMut(&FoundEquilibrium) -> ControlFlow<()>,
    ) -> Result<Branch> {
        let dimension = self.field(onward.parameter).dimension();
        of_dimension(onward.state.len(), dimension)?;
        let start = Start {
            u: onward.state.clone(),
            lambda: onward.parameter,
            direction: onward.direction.clone(),
            across: onward.across,
        };
        let problem = Equations {
            family: self,
            dimension,
        };
        let mut look = EquilibriumObserver::new(self, watch, settings.longest_step, seen);
        let mut branch = follow(&problem, &start, settings, &mut look)?;
        if look.jumped {
            branch.stopped = Stop::Failed("another branch is too close to stay on this one".into());
        }
        Ok(branch)
    }

    /// The two ways that leave a branch point, on the branch that crosses the one it was found on.
    ///
    /// The first point lies at `distance`, which should be small: at right angles to the first branch the second one is met
    /// where it is a pitchfork, and nearly so elsewhere.
    ///
    /// # Errors
    /// [`Error::Parameter`] for a point of another dimension than the fields'; [`Error::NotConverged`] if the singular value
    /// decomposition fails.
    pub fn switch(&self, point: &FoundEquilibrium, distance: f64) -> Result<[Onward; 2]> {
        let (y, p) = (&point.state, point.parameter);
        let n = y.len();
        of_dimension(n, self.field(p).dimension())?;
        let matrix = self.bordered(y, p, &point.tangent);
        let Some(null) = null_vector(matrix) else {
            return Err(Error::NotConverged {
                what: "the direction of the second branch",
                iterations: 0,
                residual: f64::INFINITY,
                tolerance: 0.0,
            });
        };
        Ok([1.0, -1.0].map(|sign| {
            let direction: Vector = &null * sign;
            Onward {
                state: y + direction.rows(0, n) * distance,
                parameter: p + direction[n] * distance,
                direction,
                across: true,
            }
        }))
    }

    /// The equilibrium near another one at which this variable is the same, and the error bound of the parameter.
    pub(super) fn landed(
        &self,
        (state, parameter): (&Vector, f64),
        held: usize,
    ) -> Option<(Vector, f64, f64)> {
        /// Corrections, which end in the last digits; so many changes in the last digits, and what their largest residual counts.
        const ITERATIONS: usize = 4;
        const TRIED: usize = 8;
        const SAFETY: f64 = 4.0;
        let n = state.len();
        let exact = |x: &Vector| self.exact(&x.rows(0, n).into_owned(), x[n]);
        let square = |x: &Vector| {
            let rows = self.extended(&x.rows(0, n).into_owned(), x[n]);
            rows.remove_column(held)
        };
        let mut x = state.push(parameter);
        for _ in 0..ITERATIONS {
            let step = square(&x).lu().solve(&exact(&x).f[0])?;
            x -= step.insert_row(held, 0.0);
        }
        let mut noise = exact(&x).f[1].abs();
        for time in 0..TRIED {
            let moved = Vector::from_fn(n + 1, |i, _| x[i] * (1.0 + f64::EPSILON * sign(i, time)));
            let left = &exact(&moved).f[0];
            noise = noise.zip_map(left, |most: f64, x: f64| most.max(x.abs()));
        }
        let off = square(&x).try_inverse()?.abs() * noise * SAFETY;
        let off = off[n - 1] + f64::EPSILON * x[n].abs();
        let finite = off.is_finite() && x.iter().all(|x| x.is_finite());
        finite.then(|| (x.rows(0, n).into_owned(), x[n], off))
    }

    /// The equilibrium near another one at which a function is zero, and the error bound of the parameter.
    pub(super) fn zero_of(
        &self,
        (watch, which): (&Watch<'_>, usize),
        (state, parameter): (&Vector, f64),
    ) -> Option<(Vector, f64, f64)> {
        /// Corrections, which end in the last digits; so many changes in the last digits, and what their largest residual counts.
        const ITERATIONS: usize = 8;
        const TRIED: usize = 8;
        const SAFETY: f64 = 4.0;
        let n = state.len();
        let residuals = |x: &Vector, digits: usize| {
            let exact = self.exact(&x.rows(0, n).into_owned(), x[n]);
            let last = match digits {
                0 => watch.at(which, x),
                _ => 0.0,
            };
            exact.f[digits].push(last)
        };
        let square = |x: &Vector| {
            let mut rows = self.extended(&x.rows(0, n).into_owned(), x[n]);
            rows = rows.insert_row(n, 0.0);
            let slope = gradient(&|x| watch.at(which, x), x);
            rows.set_row(n, &slope.transpose());
            rows
        };
        let mut x = state.push(parameter);
        for _ in 0..ITERATIONS {
            x -= square(&x).lu().solve(&residuals(&x, 0))?;
        }
        let mut noise = residuals(&x, 1).abs();
        for time in 0..TRIED {
            let moved = Vector::from_fn(n + 1, |i, _| x[i] * (1.0 + f64::EPSILON * sign(i, time)));
            let left = residuals(&moved, 0);
            noise = noise.zip_map(&left, |most: f64, x: f64| most.max(x.abs()));
        }
        let off = square(&x).try_inverse()?.abs() * noise * SAFETY;
        let off = off[n] + f64::EPSILON * x[n].abs();
        let finite = off.is_finite() && x.iter().all(|x| x.is_finite());
        finite.then(|| (x.rows(0, n).into_owned(), x[n], off))
    }

    /// The derivatives of f in (state, parameter).
    pub(super) fn extended(&self, y: &Vector, p: f64) -> Matrix {
        let n = y.len();
        let mut all = self.jacobian(y, p).insert_column(n, 0.0);
        all.set_column(n, &self.in_parameter(y, p));
        all
    }

    /// The same, and the tangent below.
    pub(super) fn bordered(&self, y: &Vector, p: f64, tangent: &Vector) -> Matrix {
        let n = y.len();
        let mut square = self.extended(y, p).insert_row(n, 0.0);
        square.set_row(n, &tangent.transpose());
        square
    }
}

/// f(y; p) = 0 in so many variables.
struct Equations<'a, 'b> {
    family: &'a FieldEquilibria<'b>,
    dimension: usize,
}

impl ZeroProblem for Equations<'_, '_> {
    fn dimension(&self) -> usize {
        self.dimension
    }

    fn residual(&self, u: &Vector, lambda: f64) -> Result<Vector> {
        Ok(self.family.field(lambda).f(u))
    }

    fn jacobian(&self, u: &Vector, lambda: f64) -> Result<Matrix> {
        Ok(self.family.extended(u, lambda))
    }
}
