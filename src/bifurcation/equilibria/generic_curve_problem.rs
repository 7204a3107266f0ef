//! The equations of a curve of bifurcations of equilibria, and what rounding makes of their solutions.

use super::bialternate::rounding_of;
use super::critical::{FollowedPair, is_large, pair_frequency};
use super::generic_curve::{EquilibriumBifurcation, EquilibriumCurve};
use crate::continuation::ZeroProblem;
use crate::error::{Error, Result};
use crate::field::{Matrix, Vector};
use crate::integrate::{AnyExact, AnyField};
use crate::number::{Uncertain, eigenvalues, null_vector};
use std::cell::Cell;

/// f and the determinant as functions of the state and the first coordinate, and of the second.
pub(super) struct Extended<'a> {
    pub curve: &'a EquilibriumCurve<'a>,
    /// Of Hopf points that are followed, the pair on the imaginary axis where the curve stands: at a double Hopf point there are two.
    pair: Cell<Option<FollowedPair>>,
    /// Whether its sum is what vanishes, and not that of any two eigenvalues: where another sum is next to zero.
    alone: Cell<bool>,
}

/// A correction by Newton's method that may be left to rounding.
pub(super) const SMALL: f64 = 1e-9;

/// The largest component in units of 1 + |u|.
pub(super) fn relative(step: &Vector, u: &Vector) -> f64 {
    let parts = step.iter().zip(u).map(|(d, x)| (d / (1.0 + x.abs())).abs());
    parts.fold(
        0.0,
        |most: f64, part| if part.is_nan() { part } else { most.max(part) },
    )
}

impl<'a> Extended<'a> {
    /// Without a pair: bifurcations of any.
    pub fn new(curve: &'a EquilibriumCurve<'a>) -> Self {
        Extended {
            curve,
            pair: Cell::new(None),
            alone: Cell::new(false),
        }
    }

    /// Takes the pair that is followed from the Jacobian at the next point of the curve.
    pub fn take_pair(&self, jacobian: &Matrix) {
        if self.curve.kind == EquilibriumBifurcation::Hopf {
            let next = FollowedPair::of(jacobian, self.pair.get()).or(self.pair.get());
            self.pair.set(next);
            self.alone
                .set(next.is_some_and(|pair| pair.is_near_another(jacobian)));
        }
    }

    /// The pair whose sum is what vanishes.
    fn pair_alone(&self) -> Option<FollowedPair> {
        self.pair.get().filter(|_| self.alone.get())
    }

    /// The pair that is followed.
    pub fn pair(&self) -> Option<FollowedPair> {
        self.pair.get()
    }
    /// The derivatives in all of (state, coordinates) but one.
    pub fn square(&self, u: &Vector, held: usize) -> Option<Matrix> {
        let n = u.len() - 2;
        let all = self
            .jacobian(&u.rows(0, n + 1).into_owned(), u[n + 1])
            .ok()?;
        Some(all.remove_column(held))
    }

    /// The unit tangent of the curve at a point, along which the second coordinate grows or falls, or the first where that stays.
    ///
    /// # Errors
    /// Those of the derivatives.
    pub fn direction(&self, u: &Vector, lambda: f64, growing: bool) -> Result<Vector> {
        /// A smaller part of a unit tangent has no sign.
        const STAYS: f64 = 1e-8;
        let rows = self.jacobian(u, lambda)?;
        let n = rows.ncols();
        // One more row of zeros for the vector that all others are across.
        let tangent = null_vector(rows.insert_row(n - 1, 0.0));
        let unit = |i: usize| Vector::from_fn(n, |k, _| f64::from(u8::from(i == k)));
        let tangent = tangent.unwrap_or_else(|| unit(n - 1));
        let leading = match tangent[n - 1].abs() > STAYS {
            true => tangent[n - 1],
            false => tangent[n - 2],
        };
        Ok(if (leading > 0.0) == growing {
            tangent
        } else {
            -tangent
        })
    }

    /// The unit tangent of the curve, with a positive product with another one.
    pub fn tangent(&self, u: &Vector, along: &Vector) -> Option<Vector> {
        let n = u.len() - 2;
        let rows = self
            .jacobian(&u.rows(0, n + 1).into_owned(), u[n + 1])
            .ok()?;
        let last = along.transpose();
        let mut square = rows.insert_row(n + 1, 0.0);
        square.set_row(n + 1, &last);
        let mut right = Vector::zeros(n + 2);
        right[n + 1] = 1.0;
        let tangent = square.lu().solve(&right)?;
        Some(&tangent / tangent.norm())
    }

    /// The point of the curve near another one, across a direction.
    pub fn across(&self, near: &Vector, along: &Vector) -> Option<Vector> {
        /// Corrections, which end in the last digits.
        const ITERATIONS: usize = 6;
        let n = near.len() - 2;
        let mut u = near.clone();
        for _ in 0..ITERATIONS {
            let (inner, last) = (u.rows(0, n + 1).into_owned(), u[n + 1]);
            let mut square = self.jacobian(&inner, last).ok()?.insert_row(n + 1, 0.0);
            square.set_row(n + 1, &along.transpose());
            let left = self.exactly(&u).push(along.dot(&(&u - near)));
            let step = square.lu().solve(&left)?;
            let size = relative(&step, &u);
            u -= step;
            if size < f64::EPSILON {
                break;
            }
        }
        u.iter().all(|x| x.is_finite()).then_some(u)
    }

    /// omega at a Hopf point whose unknowns may be off by so much.
    pub fn frequency_within(&self, u: &Vector, off: &Vector) -> Option<Uncertain> {
        /// So many points are looked at, and what their largest distance counts.
        const TRIED: usize = 4;
        const SAFETY: f64 = 2.0;
        /// Units in the last place of the entries of a Jacobian of many variables, of which a frequency is the sum of many.
        const UNITS: f64 = 1.0;
        let large = is_large(self.curve.family.dimension());
        let jacobian = |u: &Vector| {
            let (state, at) = self.at(&u.rows(0, u.len() - 1).into_owned(), u[u.len() - 1]);
            self.curve.family.field(at).jacobian(&state)
        };
        let of_jacobian = |jacobian: &Matrix| match large {
            true => pair_frequency(jacobian, None),
            false => frequency(jacobian),
        };
        let of = |u: &Vector| of_jacobian(&jacobian(u));
        let here = of(u).filter(|_| self.curve.kind == EquilibriumBifurcation::Hopf)?;
        let mut far = match large {
            true => rounding_of(&jacobian(u), UNITS, |j| {
                of_jacobian(j).unwrap_or(f64::INFINITY)
            }),
            false => 0.0,
        };
        for time in 0..TRIED {
            let moved = Vector::from_fn(u.len(), |i, _| u[i] + sign(i, time) * off[i]);
            far = far.max((of(&moved)? - here).abs());
        }
        Some(Uncertain::new(
            here,
            SAFETY * far + 8.0 * f64::EPSILON * here,
        ))
    }

    /// What rounding makes of a solution of which one unknown is held.
    pub fn budget(&self, u: &Vector, held: usize) -> Option<Vector> {
        let off = self.carried(&self.square(u, held)?, &self.noise(u))?;
        let off = off.insert_row(held, 0.0);
        let budget = off.zip_map(u, |off, x| off + f64::EPSILON * x.abs());
        budget.iter().all(|x| x.is_finite()).then_some(budget)
    }

    /// The same across a direction.
    pub fn budget_across(&self, u: &Vector, along: &Vector) -> Option<Vector> {
        let n = u.len() - 2;
        let rows = self
            .jacobian(&u.rows(0, n + 1).into_owned(), u[n + 1])
            .ok()?;
        let mut square = rows.insert_row(n + 1, 0.0);
        square.set_row(n + 1, &along.transpose());
        let off = self.carried(&square, &self.noise(u).push(0.0))?;
        let budget = off.zip_map(u, |off, x| off + f64::EPSILON * x.abs());
        budget.iter().all(|x| x.is_finite()).then_some(budget)
    }

    /// The residuals as the equations carry them to the unknowns.
    fn carried(&self, square: &Matrix, residuals: &Vector) -> Option<Vector> {
        /// What the largest residual of a few counts.
        const SAFETY: f64 = 4.0;
        Some(square.clone().try_inverse()?.abs() * residuals * SAFETY)
    }

    /// The equations from 31 digits, where the field has these, at unknowns and both coordinates: what a formula loses in doubles is no error of
    /// the solution.
    pub fn exactly(&self, u: &Vector) -> Vector {
        self.of_exact(&self.exact(u))
    }

    fn exact(&self, u: &Vector) -> AnyExact {
        let n = u.len() - 2;
        self.curve
            .family
            .field([u[n], u[n + 1]])
            .exact(&self.state(u))
    }

    fn of_exact(&self, exact: &AnyExact) -> Vector {
        let rates = exact.f[0].rows(0, self.curve.unknowns()).into_owned();
        rates.push(self.determinant(&exact.jacobian[0]))
    }

    fn determinant(&self, jacobian: &Matrix) -> f64 {
        self.curve.function(jacobian, self.pair_alone())
    }

    /// The residuals that are met when the unknowns are changed in their last digit, with what rounding is left in the equations.
    fn noise(&self, u: &Vector) -> Vector {
        /// So many changes.
        const TRIED: usize = 8;
        /// Units in the last place of the entries of a Jacobian.
        const UNITS: f64 = 1.0;
        let (n, unknowns) = (u.len() - 2, self.curve.unknowns());
        let mut noise = Vector::zeros(n + 1);
        for time in 0..TRIED {
            let moved = Vector::from_fn(n + 2, |i, _| {
                u[i] + sign(i, time) * f64::EPSILON * u[i].abs()
            });
            let left = self.exactly(&moved);
            noise = noise.zip_map(&left, |most: f64, x: f64| most.max(x.abs()));
        }
        let AnyExact { f, jacobian } = self.exact(u);
        let [jacobian, off] = jacobian;
        let mut of_determinant = rounding_of(&jacobian, UNITS, |j| self.determinant(j));
        let here = self.determinant(&jacobian);
        for way in [1.0, -1.0] {
            of_determinant += (self.determinant(&(&jacobian + &off * way)) - here).abs();
        }
        let left = f[1].rows(0, unknowns).into_owned().push(of_determinant);
        noise + left
    }

    /// The state of some unknowns, which may be followed by coordinates.
    pub fn state(&self, u: &Vector) -> Vector {
        let last = self.curve.unknowns() - 1;
        Vector::from_fn(self.curve.family.dimension(), |i, _| u[i.min(last)])
    }

    pub fn at(&self, u: &Vector, lambda: f64) -> (Vector, [f64; 2]) {
        (self.state(u), [u[self.curve.unknowns()], lambda])
    }
}

/// That a field can be differentiated in parameters.
pub(super) fn parametrised(field: &AnyField<'_>) -> Result<()> {
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
        self.curve.unknowns() + 1
    }

    fn residual(&self, u: &Vector, lambda: f64) -> Result<Vector> {
        let (y, at) = self.at(u, lambda);
        let field = self.curve.family.field(at);
        let critical = self.determinant(&field.jacobian(&y));
        let rates = field.f(&y).rows(0, self.curve.unknowns()).into_owned();
        Ok(rates.push(critical))
    }

    fn jacobian(&self, u: &Vector, lambda: f64) -> Result<Matrix> {
        let (y, at) = self.at(u, lambda);
        let field = self.curve.family.field(at);
        parametrised(&field)?;
        let (all, n) = (y.len(), self.curve.unknowns());
        let j = field.jacobian(&y);
        let slope = self.curve.slope(&j, self.pair_alone())?;
        let mut matrix = Matrix::zeros(n + 1, n + 2);
        let mut put = |column: usize, f: &Vector, of_jacobian: &dyn Fn(&Vector) -> Vector| {
            let rates = f.rows(0, n);
            matrix.column_mut(column).rows_mut(0, n).copy_from(&rates);
            matrix[(n, column)] = slope.along(all, of_jacobian);
        };
        for (i, along) in self.curve.directions().column_iter().enumerate() {
            let along = along.into_owned();
            let change = |v: &Vector| field.second_derivative(&y, &along, v);
            put(i, &(&j * &along), &change);
        }
        let scale = self.curve.family.scale(at);
        for (k, place) in self.curve.family.plane().into_iter().enumerate() {
            let f = field.parameter_derivative(&y, place) * scale[k];
            let of_jacobian = field.parameter_jacobian(&y, place) * scale[k];
            put(n + k, &f, &|v| &of_jacobian * v);
        }
        Ok(matrix)
    }
}

/// Signs that differ from one time to the next.
pub(super) fn sign(i: usize, time: usize) -> f64 {
    if ((i + 2) * (2 * time + 3) / 2).is_multiple_of(2) {
        1.0
    } else {
        -1.0
    }
}

/// omega of the pair that is on the imaginary axis.
pub(super) fn frequency(jacobian: &Matrix) -> Option<f64> {
    /// What is left of the real part, over the imaginary one.
    const AXIS: f64 = 1e-6;
    let all = eigenvalues(jacobian)?;
    let pairs = all.iter().filter(|z| z.re.abs() < AXIS * z.im);
    let nearest = pairs.min_by(|a, b| a.re.abs().total_cmp(&b.re.abs()));
    nearest.map(|z| z.im)
}

/// What of a Jacobian acts on states whose last two variables are the same.
pub(super) fn alike(jacobian: &Matrix) -> Matrix {
    Matrix::from_fn(2, 2, |i, k| match k {
        0 => jacobian[(i, 0)],
        _ => jacobian[(i, 1)] + jacobian[(i, 2)],
    })
}
