//! What is special on a curve of bifurcations of equilibria: cusps, degenerate Hopf points, double and triple eigenvalues.

use super::bialternate::{CHANGE, lyapunov, lyapunov_by};
use super::critical::{
    Slope, other_sums, pair_frequency, second_frequency, sum_function, zero_function,
};
use super::generic::moved_by;
use super::generic_curve::{
    EquilibriumBifurcation, EquilibriumCurve, EquilibriumCurvePoint, FirstCoordinate,
};
use super::generic_curve_problem::{Extended, alike, frequency, sign};
use super::normal_form::CodimensionTwo;
use crate::bifurcation::Label;
use crate::continuation::{CurveObserver, CurvePoint, PointKind};
use crate::error::Result;
use crate::field::{Matrix, Vector};
use crate::number::{eigenvalues, null_vector};
use crate::orbit::{Solution, beyond_noise};
use nalgebra::Complex;
use std::f64::consts::TAU;
use std::ops::ControlFlow;

pub(super) struct Observer<'a, 'b> {
    pub problem: &'a Extended<'b>,
    pub first: &'a FirstCoordinate,
    pub seen: &'a mut dyn FnMut(&EquilibriumCurvePoint) -> ControlFlow<()>,
}

/// The vector that the matrix maps to nearly zero, with a positive product with another one.
fn kernel(matrix: &Matrix, along: &Vector) -> Option<Vector> {
    let kernel = null_vector(matrix.clone())?;
    Some(if kernel.dot(along) < 0.0 {
        -kernel
    } else {
        kernel
    })
}

/// So many functions tell what is special on a curve.
const FUNCTIONS: usize = 3;
/// That of a second pair of Hopf points.
const SECOND: usize = 2;

impl Observer<'_, '_> {
    /// Of folds: how the determinant changes along the kernel, zero at cusps, and the product of the sums of two eigenvalues. Of
    /// Hopf points: the first Lyapunov coefficient, the determinant, and the sums of two other eigenvalues.
    fn functions(&self, u: &Vector, tangent: &Vector) -> Result<[f64; FUNCTIONS]> {
        /// The least part of a unit tangent that tells the sign of a vector.
        const ORIENTED: f64 = 1e-6;
        let n = u.len() - 2;
        let (state, at) = (self.problem.state(u), [u[n], u[n + 1]]);
        let field = self.problem.curve.family.field(at);
        let jacobian = field.jacobian(&state);
        Ok(match self.problem.curve.kind {
            EquilibriumBifurcation::Fold => {
                let along = tangent.rows(0, n).into_owned();
                let kernel = kernel(&jacobian, &along).unwrap_or_else(|| Vector::zeros(n));
                // Its sign is that of the way along the curve, which has one near cusps.
                let oriented = kernel.dot(&along).abs() > ORIENTED;
                let unknown = if oriented { 1.0 } else { f64::NAN };
                let change = |v: &Vector| field.second_derivative(&state, &kernel, v);
                let bends = Slope::of_zero_function(&jacobian)?.along(n, change);
                [bends * unknown, sum_function(&jacobian), f64::NAN]
            }
            EquilibriumBifurcation::Hopf => {
                let (omega, determinant) = (self.frequency(&jacobian), zero_function(&jacobian));
                let coefficient = omega.and_then(|omega| lyapunov(&field, &state, omega));
                // The coefficient has a pole where the determinant is zero, and another sign behind it.
                let without_pole = coefficient.map_or(f64::NAN, |l_1| l_1 * determinant);
                let pair = self.problem.pair();
                let second = pair.map_or(f64::NAN, |pair| other_sums(&jacobian, pair));
                [without_pole, determinant, second]
            }
            // The sum and the product of both eigenvalues of what moves alike.
            EquilibriumBifurcation::Pitchfork => {
                let alike = alike(&jacobian);
                [alike.trace(), alike.determinant(), f64::NAN]
            }
        })
    }

    /// omega of the pair that bifurcates.
    fn frequency(&self, jacobian: &Matrix) -> Option<f64> {
        pair_frequency(jacobian, self.problem.pair())
    }

    /// omega of a second pair that is on the imaginary axis with it.
    fn second_frequency(&self, jacobian: &Matrix) -> Option<f64> {
        second_frequency(jacobian, self.problem.pair()?)
    }

    /// omega of all pairs that are on the imaginary axis at a point of codimension two.
    fn frequencies(&self, label: Label, jacobian: &Matrix) -> Vec<f64> {
        let own = match self.problem.curve.kind {
            EquilibriumBifurcation::Hopf => self.frequency(jacobian),
            _ => frequency(jacobian),
        };
        match label {
            // The same order on both curves that meet there.
            Label::Hh => {
                let both = own.into_iter().chain(self.second_frequency(jacobian));
                let mut both: Vec<f64> = both.collect();
                both.sort_by(f64::total_cmp);
                both
            }
            Label::Gh | Label::Zh => own.into_iter().collect(),
            _ => Vec::new(),
        }
    }

    /// A user function at unknowns of the curve.
    fn user_function(&self, which: usize, u: &Vector) -> f64 {
        let n = u.len() - 2;
        let (state, at) = (self.problem.state(u), [u[n], u[n + 1]]);
        let EquilibriumCurve { family, kind } = *self.problem.curve;
        let omega = match kind {
            EquilibriumBifurcation::Hopf => self.frequency(&family.field(at).jacobian(&state)),
            _ => None,
        };
        let equilibrium = Solution::Equilibrium {
            state: &state,
            period: omega.map(|omega| TAU / omega),
        };
        family.user_function(which, equilibrium, at)
    }

    /// The number of the user function that a test function is.
    fn users(&self, test: usize) -> Option<usize> {
        let which = test.checked_sub(FUNCTIONS + self.values().count())?;
        (which < self.first.functions).then_some(which)
    }

    /// What the differences of the first Lyapunov coefficient are off, by twice their distance.
    fn difference_error(&self, i: usize, u: &Vector) -> f64 {
        if (self.problem.curve.kind, i) != (EquilibriumBifurcation::Hopf, 0) {
            return 0.0;
        }
        let n = u.len() - 2;
        let (state, at) = (self.problem.state(u), [u[n], u[n + 1]]);
        let field = self.problem.curve.family.field(at);
        let jacobian = field.jacobian(&state);
        let Some(omega) = self.frequency(&jacobian) else {
            return f64::INFINITY;
        };
        let by = |change: f64| lyapunov_by(&field, &state, omega, change);
        match (by(CHANGE), by(2.0 * CHANGE)) {
            (Some(near), Some(far)) => (far - near).abs() * zero_function(&jacobian).abs(),
            _ => f64::INFINITY,
        }
    }

    /// The values of the first coordinate that are landed on: the ends of its range, and those that are wanted.
    fn values(&self) -> impl Iterator<Item = f64> {
        let FirstCoordinate { range, wanted, .. } = self.first;
        [range.0, range.1].into_iter().chain(wanted.iter().copied())
    }

    /// The unknowns of a point; where it is one of these values, with that in the place of what a continuation along the other coordinate came to.
    fn landed(&self, mark: PointKind, point: &CurvePoint) -> Vector {
        let u = point.u.push(point.lambda);
        let first = u.len() - 2;
        let PointKind::Zero(i) = mark else {
            return u;
        };
        let value = i.checked_sub(FUNCTIONS).and_then(|i| self.values().nth(i));
        let on_value = value.and_then(|value| {
            let mut near = u.clone();
            near[first] = value;
            let held = Vector::from_fn(u.len(), |k, _| f64::from(u8::from(k == first)));
            let mut there = self.problem.across(&near, &held)?;
            there[first] = value;
            Some(there)
        });
        on_value.unwrap_or(u)
    }

    /// Whether a zero of the i-th function is one: at a cusp the curve goes along the kernel. Where the kernel is across the curve the sign of that
    /// function is changed.
    fn is_zero(&self, i: usize, u: &Vector, along: &Vector) -> Option<bool> {
        /// Of the tangent, which at a cusp is the kernel.
        const ALONG: f64 = 0.5;
        if (self.problem.curve.kind, i) != (EquilibriumBifurcation::Fold, 0) {
            return Some(true);
        }
        let tangent = self.problem.tangent(u, along)?;
        let n = u.len() - 2;
        let field = self.problem.curve.family.field([u[n], u[n + 1]]);
        let tangent = tangent.rows(0, n).into_owned();
        let kernel = kernel(&field.jacobian(&self.problem.state(u)), &tangent)?;
        Some(kernel.dot(&tangent) > ALONG)
    }

    /// The function that is zero at a point, if there is one. The first of those of Hopf points is zero with the second.
    fn zero_at(&self, point: &CurvePoint) -> Option<usize> {
        const ZERO: f64 = 1e-14;
        let all = self.functions(&point.u.push(point.lambda), &point.tangent);
        let found = all.ok()?.iter().rposition(|value| value.abs() < ZERO)?;
        self.sharp(found, point).map(|_| found)
    }

    /// What the i-th function's zero is; `None` where it is nothing.
    fn label(&self, i: usize, omega: Option<f64>, jacobian: &Matrix) -> Option<Label> {
        /// Against the matrix: of a pair that is a double zero, and so known to half of the digits.
        const DOUBLE: f64 = 1e-4;
        let all = eigenvalues(jacobian)?;
        let zero = |z: &&Complex<f64>| z.norm() < DOUBLE * jacobian.amax();
        let near = all.iter().filter(zero).count();
        match (self.problem.curve.kind, i) {
            (EquilibriumBifurcation::Pitchfork, 0) => frequency(jacobian).map(|_| Label::Zh),
            (EquilibriumBifurcation::Pitchfork, _) => Some(Label::Bt),
            (EquilibriumBifurcation::Fold, 0) => Some(Label::Cp),
            (EquilibriumBifurcation::Hopf, 0) => Some(Label::Gh),
            // A neutral saddle beside the pair is nothing.
            (EquilibriumBifurcation::Hopf, SECOND) => omega
                .and(self.second_frequency(jacobian))
                .map(|_| Label::Hh),
            _ if near >= 2 => Some(Label::Bt),
            (EquilibriumBifurcation::Fold, _) => frequency(jacobian).map(|_| Label::Zh),
            // On a curve of neutral saddles an eigenvalue zero is nothing.
            (EquilibriumBifurcation::Hopf, _) => omega.map(|_| Label::Zh),
        }
    }

    /// The zero of the i-th function near a point of the curve, in the last digits, and how far all that may be off: by the
    /// curve's own rounding, and along it by what is left of the function and its noise over its slope.
    fn sharp(&self, i: usize, point: &CurvePoint) -> Option<(Vector, Vector)> {
        const ITERATIONS: usize = 8;
        const BESIDE: f64 = 1e-5;
        const DONE: f64 = 1e-13;
        const TRIED: usize = 4;
        let along = &point.tangent;
        let start = point.u.push(point.lambda);
        let function = |u: &Vector, tangent: &Vector| match self.users(i) {
            Some(which) => Some(self.user_function(which, u)),
            None => Some(self.functions(u, tangent).ok()?[i]),
        };
        // The point of the curve at a distance along the tangent, and the function there.
        let at = |s: f64| {
            let u = self.problem.across(&(&start + along * s), along)?;
            let value = function(&u, &self.problem.tangent(&u, along)?)?;
            value.is_finite().then_some((u, value))
        };
        let beside = BESIDE * (1.0 + start.amax());
        let ((_, mut last), mut s_last) = (at(-beside)?, -beside);
        let ((mut u, mut here), mut s) = (at(beside)?, beside);
        for _ in 0..ITERATIONS {
            let slope = (here - last) / (s - s_last);
            let step = -here / slope;
            // Within rounding the slope is noise.
            if !step.is_finite() || step.abs() > 10.0 * beside {
                break;
            }
            (s_last, last) = (s, here);
            s += step;
            (u, here) = at(s)?;
            if step.abs() < DONE * (1.0 + start.amax()) {
                break;
            }
        }
        let ((_, ahead), (_, behind)) = (at(s + beside)?, at(s - beside)?);
        let slope = (ahead - behind) / (2.0 * beside);
        let tangent = self.problem.tangent(&u, along)?;
        let mut noise = here.abs();
        for time in 0..TRIED {
            let moved = Vector::from_fn(u.len(), |k, _| {
                u[k] * (1.0 + sign(k, time) * 4.0 * f64::EPSILON)
            });
            noise += (function(&moved, &tangent)? - here).abs();
        }
        noise += self.difference_error(i, &u);
        let off_along = noise / slope.abs();
        let bend = (self.problem.tangent(&at(s + beside)?.0, along)? - &tangent) / beside;
        let across = self.problem.budget_across(&u, &tangent)?;
        // At the origin rounding is nothing, and what is left are the steps that did not change a number of the size of the others.
        let least = f64::EPSILON * f64::EPSILON * (1.0 + start.amax());
        let off = Vector::from_fn(u.len(), |k, _| {
            let by_bend = bend[k].abs() * off_along * off_along;
            across[k] + off_along * tangent[k].abs() + by_bend + least
        });
        let known = off.iter().all(|x| x.is_finite()) && self.is_zero(i, &u, &tangent)?;
        known.then_some((u, off))
    }
}

impl CurveObserver for Observer<'_, '_> {
    fn tests(&self, point: &CurvePoint) -> Result<Vec<f64>> {
        /// What a point of the curve may be off, in units of 1 + |x|.
        const OFF: f64 = 1e-12;
        let here = point.u.push(point.lambda);
        let n = here.len() - 2;
        let field = self.problem.curve.family.field([here[n], here[n + 1]]);
        let state = self.problem.state(&here);
        self.problem.take_pair(&field.jacobian(&state));
        let mut all = self.functions(&here, &point.tangent)?.to_vec();
        let first = point.u[point.u.len() - 1];
        // An infinite end is never met.
        all.extend(self.values().map(|value| {
            if value.is_finite() {
                first - value
            } else {
                f64::NAN
            }
        }));
        all.extend((0..self.first.functions).map(|which| {
            beyond_noise(self.user_function(which, &here), |time| {
                self.user_function(which, &moved_by(&here, OFF, time))
            })
        }));
        Ok(all)
    }

    fn is_users(&self, test: usize) -> bool {
        self.users(test).is_some()
    }

    fn ends(&self, test: usize) -> bool {
        (FUNCTIONS..FUNCTIONS + 2).contains(&test)
    }

    fn seen(&mut self, point: &CurvePoint, mark: PointKind) -> ControlFlow<()> {
        /// Of the coordinates of a special point.
        const KNOWN: f64 = 1e-3;
        let n = point.u.len() - 1;
        // No sign changes where a curve begins at a special point.
        let mark = match mark {
            PointKind::Begin => self.zero_at(point).map_or(mark, PointKind::Zero),
            mark => mark,
        };
        let mut special = None;
        let is_sharp = |i: usize| i < FUNCTIONS || self.users(i).is_some();
        let mut zero_of = None;
        if let PointKind::Zero(i) = mark
            && is_sharp(i)
        {
            zero_of = self.users(i);
            match self.sharp(i, point) {
                // What is not known to some digits is no zero: of a function that jumps, or has a pole.
                Some((u, off)) if off[n] < KNOWN && off[n + 1] < KNOWN => special = Some((u, off)),
                _ => return ControlFlow::Continue(()),
            }
        }
        let u = match &special {
            Some((u, _)) => u.clone(),
            None => self.landed(mark, point),
        };
        let (state, at) = self.problem.at(&u, u[n + 1]);
        let field = self.problem.curve.family.field(at);
        let jacobian = field.jacobian(&state);
        let hopf = self.problem.curve.kind == EquilibriumBifurcation::Hopf;
        let frequency = hopf.then(|| self.frequency(&jacobian)).flatten();
        let label = match mark {
            PointKind::Step => None,
            PointKind::Zero(i) if self.ends(i) => Some(Label::Ep),
            PointKind::Zero(_) if zero_of.is_some() => Some(Label::Uf),
            PointKind::Zero(i) if i > FUNCTIONS => Some(Label::Uz),
            PointKind::Zero(i) => match self.label(i, frequency, &jacobian) {
                None => return ControlFlow::Continue(()),
                label => label,
            },
            PointKind::Wanted(_) => Some(Label::Uz),
            PointKind::Begin | PointKind::Lowest | PointKind::Highest => Some(Label::Ep),
        };
        let uncertainty = match mark {
            PointKind::Step => None,
            PointKind::Zero(i) if is_sharp(i) => {
                special.as_ref().map(|(_, off)| [off[n], off[n + 1]])
            }
            PointKind::Zero(_) => {
                let budget = self.problem.budget(&u, n);
                budget.map(|budget| [0.0, budget[n + 1]])
            }
            _ => {
                let budget = self.problem.budget(&u, n + 1);
                budget.map(|budget| [budget[n], 0.0])
            }
        };
        // Where it is zero what is left of it is rounding.
        let frequency = frequency.filter(|_| label != Some(Label::Bt));
        let coefficient = frequency.and_then(|omega| lyapunov(&field, &state, omega));
        let normal_form = match (label, &special) {
            (Some(label), Some((unknowns, off))) => CodimensionTwo {
                family: self.problem.curve.family,
                label,
                unknowns,
                off,
                frequencies: &self.frequencies(label, &jacobian),
            }
            .coefficients(),
            _ => Vec::new(),
        };
        (self.seen)(&EquilibriumCurvePoint {
            state,
            at,
            frequency,
            coefficient,
            normal_form,
            label,
            zero_of,
            uncertainty,
        })
    }
}
