//! Curves of folds and of Hopf points of equilibria of any small system, in the plane of two of its parameters.
//!
//! Solved are f(y; p) = 0 and a determinant: of the Jacobian at a fold, of the bialternate product 2 J (.) 1 at a Hopf point
//! (Kuznetsov 2004, section 10.3); of many variables what takes their place (`critical`). All derivatives are the field's own.

use super::critical::{FollowedPair, Slope, pair_function, zero_function};
use super::generic_curve_observer::Observer;
use super::generic_curve_problem::{Extended, SMALL, relative};
use super::normal_form::NormalFormCoefficient;
use crate::bifurcation::Label;
use crate::continuation::{Branch, Settings, Start, follow};
use crate::error::{Error, Result};
use crate::field::{Matrix, Vector};
use crate::integrate::of_dimension;
use crate::number::Uncertain;
use crate::orbit::ParametrisedField;
use std::ops::ControlFlow;

/// What an equilibrium is along the curve.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum EquilibriumBifurcation {
    /// An eigenvalue is zero. A pitchfork is a fold of no such curve: there the equations are singular.
    Fold,
    /// Two eigenvalues have the sum zero.
    Hopf,
    /// Of three variables, of which the last two are those of equal parts that move alike: the eigenvalue across is zero.
    Pitchfork,
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

/// The eigenvalue across equal parts.
fn across(jacobian: &Matrix) -> f64 {
    jacobian[(1, 1)] - jacobian[(1, 2)]
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
    /// At a point of codimension two the coefficients of its normal form, where the field has series along curves.
    pub normal_form: Vec<NormalFormCoefficient>,
    /// `CP`, `BT`, `ZH`, `HH`, `GH`, `UZ`, `UF`, `EP`, where the point is one of these.
    pub label: Option<Label>,
    /// Where one of the user's functions is zero, its number.
    pub zero_of: Option<usize>,
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
    /// How many of the family's user functions are looked at for zeros.
    pub functions: usize,
}

impl Default for FirstCoordinate {
    /// All of it.
    fn default() -> Self {
        FirstCoordinate {
            range: (f64::NEG_INFINITY, f64::INFINITY),
            wanted: Vec::new(),
            functions: 0,
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
    /// What vanishes, as a function of the Jacobian; at a Hopf point by the pair that is followed, if one is.
    pub(super) fn function(&self, jacobian: &Matrix, pair: Option<FollowedPair>) -> f64 {
        match self.kind {
            EquilibriumBifurcation::Fold => zero_function(jacobian),
            EquilibriumBifurcation::Hopf => pair_function(jacobian, pair),
            EquilibriumBifurcation::Pitchfork => across(jacobian),
        }
    }

    /// How that depends on the Jacobian.
    ///
    /// # Errors
    /// Those of [`Slope`].
    pub(super) fn slope(&self, jacobian: &Matrix, pair: Option<FollowedPair>) -> Result<Slope> {
        Ok(match self.kind {
            EquilibriumBifurcation::Fold => Slope::of_zero_function(jacobian)?,
            EquilibriumBifurcation::Hopf => Slope::of_pair_function(jacobian, pair)?,
            EquilibriumBifurcation::Pitchfork => Slope::Whole(Box::new(across)),
        })
    }

    /// The number of unknowns of a state: where parts move alike, one for these.
    pub(super) fn unknowns(&self) -> usize {
        match self.kind {
            EquilibriumBifurcation::Pitchfork => 2,
            _ => self.family.dimension(),
        }
    }

    /// The directions in which the unknowns move a state, as columns.
    pub(super) fn directions(&self) -> Matrix {
        let (all, count) = (self.family.dimension(), self.unknowns());
        Matrix::from_fn(all, count, |i, k| {
            f64::from(u8::from(i.min(count - 1) == k))
        })
    }

    /// That there are such bifurcations of so many variables.
    ///
    /// # Errors
    /// [`Error::Dimension`] where there are none.
    fn checked(&self) -> Result<()> {
        let dimension = self.family.dimension();
        let holds = self.kind != EquilibriumBifurcation::Pitchfork || dimension == 3;
        Error::dimension_unless(holds, "the pitchfork of two equal parts", "3", dimension)
    }

    /// The point of the curve near another one where the coordinate of this number is what it is there, in the last digits.
    pub fn sharp(&self, state: &Vector, at: [f64; 2], held: usize) -> Option<SharpEquilibrium> {
        /// Iterations, and a correction that is the last.
        const ITERATIONS: usize = 40;
        const DONE: f64 = 1e-15;
        self.checked().ok()?;
        let (n, problem) = (self.unknowns(), Extended::new(self));
        let mut u = state.rows(0, n).into_owned().push(at[0]).push(at[1]);
        let mut last = f64::INFINITY;
        for _ in 0..ITERATIONS {
            let square = problem.square(&u, n + held)?;
            let step = square.lu().solve(&problem.exactly(&u))?;
            let size = relative(&step, &u.clone().remove_row(n + held));
            if !size.is_finite() {
                return None;
            }
            u -= step.insert_row(n + held, 0.0);
            // Rounding alone is left where corrections cease to shrink.
            if size < DONE || size >= 0.5 * last && size < SMALL {
                let uncertainty = problem.budget(&u, n + held)?;
                return Some(SharpEquilibrium {
                    state: problem.state(&u),
                    at: [u[n], u[n + 1]],
                    uncertainty: [uncertainty[n], uncertainty[n + 1]],
                    frequency: problem.frequency_within(&u, &uncertainty),
                });
            }
            last = size;
        }
        None
    }

    /// The curve from near a point of it, with the second coordinate growing or falling at first, or the first one where that stays,
    /// until the second leaves the range of the settings.
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
        self.checked()?;
        of_dimension(state.len(), self.family.dimension())?;
        let n = self.unknowns();
        let problem = Extended::new(self);
        problem.take_pair(&self.family.field(at).jacobian(state));
        let u = state.rows(0, n).into_owned().push(at[0]);
        let start = Start {
            direction: problem.direction(&u, at[1], growing)?,
            u,
            lambda: at[1],
            across: true,
        };
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
