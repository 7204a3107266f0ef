//! The user's functions of equilibria and of periodic orbits, whose zeros are looked for along branches and curves.

use super::continuation_point::{ContinuationPoint, TangentVector};
use super::family::ParametrisedField;
use super::noise::Signs;
use super::shooting_nodes::ShootingNodes;
use crate::field::{Matrix, Vector};
use crate::integrate::AnyField;

/// A solution of a family of vector fields, in the family's variables.
#[derive(Debug, Clone, Copy)]
pub enum Solution<'a> {
    /// An equilibrium.
    Equilibrium {
        /// Its state.
        state: &'a Vector,
        /// The period of the oscillation, where it is a Hopf point that is known as one.
        period: Option<f64>,
    },
    /// A periodic orbit.
    Orbit(&'a ShootingNodes),
}

/// The values of the user's functions, by their number, of a solution at coordinates of the parameters. NaN where one is undefined.
pub type UserFunctions<'a> = &'a (dyn Fn(usize, Solution<'_>, [f64; 2]) -> f64 + Sync);

/// A family with functions of its solutions.
pub struct WithFunctions<'a> {
    /// The family.
    pub family: &'a dyn ParametrisedField,
    /// The functions.
    pub functions: UserFunctions<'a>,
}

impl ParametrisedField for WithFunctions<'_> {
    fn dimension(&self) -> usize {
        self.family.dimension()
    }

    fn plane(&self) -> [usize; 2] {
        self.family.plane()
    }

    fn field(&self, at: [f64; 2]) -> AnyField<'_> {
        self.family.field(at)
    }

    fn parameters(&self, at: [f64; 2]) -> [f64; 2] {
        self.family.parameters(at)
    }

    fn scale(&self, at: [f64; 2]) -> [f64; 2] {
        self.family.scale(at)
    }

    fn normal(&self, x: &Vector, flow: Vector) -> Vector {
        self.family.normal(x, flow)
    }

    fn is_any_system(&self) -> bool {
        self.family.is_any_system()
    }

    fn across(&self, x: &Vector, flow: &Vector) -> Matrix {
        self.family.across(x, flow)
    }

    fn units(&self) -> Option<&[f64]> {
        self.family.units()
    }

    fn user_function(&self, which: usize, of: Solution<'_>, at: [f64; 2]) -> f64 {
        (self.functions)(which, of, at)
    }
}

/// A value, or 0 where it is not beyond what it is changed by when the solution errs: of a function that is zero throughout, as the sum of the extremes of
/// a symmetric orbit, errors have signs that mean nothing. `beside` is the value of the solution with its n-th error.
pub(crate) fn beyond_noise(value: f64, beside: impl Fn(usize) -> f64) -> f64 {
    /// Errors that are tried, and what the largest change counts.
    const TRIED: usize = 2;
    const SAFETY: f64 = 4.0;
    let changes = (0..TRIED).map(|time| (beside(time) - value).abs());
    let noise = SAFETY * changes.fold(0.0, f64::max);
    if value.abs() <= noise { 0.0 } else { value }
}

/// The value of a function at an orbit.
pub(super) fn of_orbit(
    family: &dyn ParametrisedField,
    which: usize,
    site: &ContinuationPoint,
) -> f64 {
    family.user_function(which, Solution::Orbit(&site.shooting), site.at)
}

/// The same, or 0 within the noise of an orbit of a continuation.
pub(super) fn of_orbit_beyond_noise(
    family: &dyn ParametrisedField,
    which: usize,
    site: &ContinuationPoint,
) -> f64 {
    /// What nodes, in units of 1 + |x|, durations and coordinates may be off.
    const OFF: f64 = 1e-11;
    let value = of_orbit(family, which, site);
    beyond_noise(value, |time| {
        of_orbit(family, which, &site.off_by(OFF, time))
    })
}

/// How much rounding makes of a function at an orbit.
pub(super) fn rounding_at(
    family: &dyn ParametrisedField,
    which: usize,
    site: &ContinuationPoint,
) -> f64 {
    const OFF: f64 = 4.0 * f64::EPSILON;
    let value = of_orbit(family, which, site);
    let off = |time| (of_orbit(family, which, &site.off_by(OFF, time)) - value).abs();
    off(0).max(off(1))
}

/// How a function changes along a displacement of an orbit.
pub(super) fn slope(
    family: &dyn ParametrisedField,
    which: usize,
    site: &ContinuationPoint,
    along: &TangentVector,
) -> f64 {
    const STEP: f64 = 1e-6;
    let length = along.dot(along).sqrt();
    if length == 0.0 {
        return 0.0;
    }
    let at = |step: f64| of_orbit(family, which, &site.moved(along, step / length));
    (at(STEP) - at(0.0)) / STEP * length
}

impl ContinuationPoint {
    /// With errors of this size and of random signs, the same ones for the same number.
    fn off_by(&self, size: f64, number: usize) -> Self {
        let mut signs = Signs::new();
        let count = self.shooting.nodes.iter().map(Vector::len).sum::<usize>();
        for _ in 0..number * (count + self.shooting.durations.len() + 2) {
            signs.next();
        }
        let mut off = |size: f64| size * signs.next();
        let node = |x: &Vector, off: &mut dyn FnMut(f64) -> f64| {
            Vector::from_fn(x.len(), |i, _| x[i] + off(size * (1.0 + x[i].abs())))
        };
        let nodes = self.shooting.nodes.iter();
        let nodes = nodes.map(|x| node(x, &mut off)).collect();
        let durations = self.shooting.durations.iter();
        let durations = durations.map(|t| t * (1.0 + off(size))).collect();
        ContinuationPoint {
            shooting: ShootingNodes { nodes, durations },
            at: self.at.map(|x| x + off(size * (1.0 + x.abs()))),
        }
    }
}
