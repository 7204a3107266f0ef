//! One step: the stages by Newton's method, the error, and the derivatives of what the step makes.
//!
//! With Z_i = Y_i - y the stages solve Z_i = h sum_j a_ij f(y + Z_j). Newton's matrix has the Jacobian of each stage: it is exact
//! where it stands, and its factors serve as long as the corrections shrink. The derivatives are those of the step itself, by the same
//! equations: (I - h A J) dY = dy + h A f_p.

use super::coefficients::Coefficients;
use crate::error::Error;
use crate::field::{Matrix, Vector};
use crate::integrate::Work;
use crate::integrate::rosenbrock::drive::Steppable;
use nalgebra::{Dyn, LU};

/// A field of any dimension, as the steps need it.
pub(super) trait StageField {
    fn f(&self, y: &[f64], into: &mut [f64]);
    /// With differences in place of what is no number, unless it is for derivatives.
    fn jacobian(&self, y: &[f64], exact: bool, into: &mut Matrix);
    fn parameter_derivative(&self, y: &[f64], place: usize, into: &mut [f64]);
    fn underflow(&self, t: f64, h: f64, y: &[f64]) -> Error;
    /// As [`crate::field::VectorField::has_spikes`].
    fn has_spikes(&self) -> bool;
    /// As [`crate::field::VectorField::timed`].
    fn timed(&self, end: &mut [f64], begin: &[f64], h: f64);
}

/// What a step may err by.
#[derive(Debug, Clone)]
pub(super) struct MayErr {
    pub rtol: f64,
    /// Of each variable, and of the entries of tangents.
    pub atol: Vector,
    pub of_tangents: f64,
}

impl MayErr {
    /// The largest component of an error between two states; `None` if one is not finite.
    fn norm(&self, error: &[f64], y: &[f64], next: &[f64]) -> Option<f64> {
        let mut norm = 0.0_f64;
        for (i, &error) in error.iter().enumerate() {
            if !(error.is_finite() && next[i].is_finite()) {
                return None;
            }
            let may = self.atol[i] + self.rtol * y[i].abs().max(next[i].abs());
            norm = norm.max(error.abs() / may);
        }
        Some(norm)
    }

    fn norm_of_tangents(&self, errors: &Matrix, before: &Matrix, after: &Matrix) -> f64 {
        let entries = errors.iter().zip(before.iter().zip(after.iter()));
        let parts = entries
            .map(|(error, (a, b))| error.abs() / (self.of_tangents * (1.0 + a.abs().max(b.abs()))));
        // NaN wins, unlike in f64::max.
        parts.fold(0.0, |most, part| {
            if part > most || part.is_nan() {
                part
            } else {
                most
            }
        })
    }
}

/// The derivatives that are carried along: in the start, and in these parameters.
pub(super) struct Derivatives<'a> {
    pub places: &'a [usize],
    pub columns: Matrix,
    /// The integral of the trace of the Jacobian.
    pub volume: f64,
}

/// A step that was made.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct LastStep {
    /// How long it was, and how long one after it may be.
    length: f64,
    pub following: f64,
    /// Its Z, and where it ended.
    stages: Matrix,
    end: Vector,
}

impl LastStep {
    /// Whether a run of this signed duration from there goes on where this has ended, about.
    pub fn is_before(&self, start: &Vector, span: f64) -> bool {
        /// In parts of the state and of its change in the step.
        const NEARBY: f64 = 1e-2;
        let change = self.stages.column(self.stages.ncols() - 1);
        let mut all = start.iter().zip(self.end.iter().zip(change.iter()));
        self.length * span > 0.0
            && start.len() == self.end.len()
            && all.all(|(x, (y, dy))| (x - y).abs() <= NEARBY * (y.abs() + dy.abs()))
    }
}

/// A state on its way.
pub(super) struct Stages<'a> {
    field: &'a dyn StageField,
    method: &'static Coefficients,
    may_err: MayErr,
    max_step: f64,
    is_seen: bool,
    work: &'a mut Work,
    pub y: Vector,
    f: Vector,
    jacobian: Matrix,
    pub derivatives: Option<Derivatives<'a>>,
    /// Z of the tried step, a column for each stage, and f there.
    z: Matrix,
    slopes: Matrix,
    next: Vector,
    next_columns: Matrix,
    next_volume: f64,
    ahead: (Vector, Matrix),
    /// How long it is, and by how much the double next to the time grows.
    tried: f64,
    clock: f64,
    /// Whether a step from here was refused.
    refused: bool,
    /// The last step and its Z, from which the next one is predicted.
    pub last: Option<LastStep>,
}

/// A step whose equations are not solved is tried again as one that errs by so much.
const UNSOLVED: f64 = 100.0;
/// Iterations; the part of what a step may err by that is left of its equations; and what a correction may be of the one before.
const ITERATIONS: usize = 12;
const LEFT: f64 = 1e-3;
const SLOW: f64 = 0.1;
/// Corrections below this many roundings of the state are no longer made better.
const ROUNDING: f64 = 4.0 * f64::EPSILON;
/// The steps that are predicted from those before are no longer than this many times these.
const FAR: f64 = 2.0;

impl<'a> Stages<'a> {
    pub fn new(
        (field, method): (&'a dyn StageField, &'static Coefficients),
        (may_err, max_step, is_seen): (MayErr, f64, bool),
        work: &'a mut Work,
        y: Vector,
        (f, jacobian): (Vector, Matrix),
        (free, last): (Option<&'a [usize]>, Option<LastStep>),
    ) -> Self {
        let n = y.len();
        let derivatives = free.map(|places| Derivatives {
            places,
            columns: Matrix::identity(n, n + places.len()),
            volume: 0.0,
        });
        Stages {
            field,
            method,
            may_err,
            max_step,
            is_seen,
            work,
            z: Matrix::zeros(n, method.stages()),
            slopes: Matrix::zeros(n, method.stages()),
            next: y.clone(),
            next_columns: Matrix::zeros(0, 0),
            next_volume: 0.0,
            ahead: (f.clone(), jacobian.clone()),
            y,
            f,
            jacobian,
            derivatives,
            tried: 0.0,
            clock: 0.0,
            refused: false,
            last,
        }
    }

    /// The state so long after the beginning of the tried step.
    pub fn after(&self, time: f64) -> Vector {
        &self.y + &self.z * self.method.dense(time / self.tried)
    }

    /// The end of the tried step.
    pub fn end(&self) -> &Vector {
        &self.next
    }

    /// The polynomial of the last step, continued; nothing where there is none, or it is too far away.
    fn predict(&mut self, h: f64) {
        self.z.fill(0.0);
        let Some(LastStep { length, stages, .. }) = &self.last else {
            return;
        };
        let ratio = h / length;
        if !(ratio > 0.0 && ratio < FAR) {
            return;
        }
        let end = stages.column(stages.ncols() - 1);
        for (i, mut column) in self.z.column_iter_mut().enumerate() {
            let weights = self.method.dense(1.0 + ratio * self.method.c[i]);
            column.gemv(1.0, stages, &weights, 0.0);
            column -= &end;
        }
    }

    /// f at all stages; false if something is not finite.
    fn look(&mut self) -> bool {
        let count = self.method.stages();
        self.work.rhs += count;
        for i in 0..count {
            let at = &self.y + self.z.column(i);
            self.field
                .f(at.as_slice(), self.slopes.column_mut(i).as_mut_slice());
        }
        self.slopes.iter().all(|x| x.is_finite())
    }

    /// The factors of I - h A J with J at each stage, and these; `None` if something is not finite.
    fn factors(&mut self, h: f64, exact: bool) -> Option<(LU<f64, Dyn, Dyn>, Vec<Matrix>)> {
        let (n, count) = (self.y.len(), self.method.stages());
        let mut matrix = Matrix::identity(n * count, n * count);
        let mut all = Vec::with_capacity(count);
        self.work.jacobians += count;
        self.work.factorisations += 1;
        for j in 0..count {
            let at = &self.y + self.z.column(j);
            let mut jacobian = Matrix::zeros(n, n);
            self.field.jacobian(at.as_slice(), exact, &mut jacobian);
            if !jacobian.iter().all(|x| x.is_finite()) {
                return None;
            }
            for i in 0..count {
                let factor = -h * self.method.a[(i, j)];
                let mut block = matrix.view_mut((i * n, j * n), (n, n));
                block += &jacobian * factor;
            }
            all.push(jacobian);
        }
        Some((matrix.lu(), all))
    }

    /// The stages, from those predicted; false where they are not found.
    fn solve(&mut self, h: f64) -> bool {
        let count = self.method.stages();
        let mut factors = None;
        let mut last = f64::INFINITY;
        for _ in 0..ITERATIONS {
            if !self.look() {
                return false;
            }
            let mut right = &self.slopes * self.method.a.transpose() * h - &self.z;
            let lu = match factors.take() {
                Some(lu) => lu,
                None => match self.factors(h, false) {
                    Some((lu, _)) => lu,
                    None => return false,
                },
            };
            let mut correction = Vector::from_column_slice(right.as_slice());
            if !lu.solve_mut(&mut correction) {
                return false;
            }
            right.copy_from_slice(correction.as_slice());
            self.z += &right;
            let (mut size, mut is_rounding) = (0.0_f64, true);
            for i in 0..count {
                let at = &self.y + self.z.column(i);
                let part = right.column(i);
                let Some(norm) =
                    self.may_err
                        .norm(part.as_slice(), self.y.as_slice(), at.as_slice())
                else {
                    return false;
                };
                size = size.max(norm);
                let mut all = part.iter().zip(at.iter().zip(self.y.iter()));
                is_rounding &= all.all(|(dx, (a, b))| dx.abs() <= ROUNDING * a.abs().max(b.abs()));
            }
            let rate = size / last;
            // What a next correction would be; a first one says nothing of it but that Newton's method squares.
            let left = if last.is_finite() {
                size * rate
            } else {
                size * size
            };
            if is_rounding || size < LEFT || (rate < 1.0 && left < LEFT) {
                return true;
            }
            if rate > 2.0 {
                return false;
            }
            factors = (rate < SLOW || last.is_infinite() && size < 1.0).then_some(lu);
            last = size;
        }
        false
    }

    /// (I - h damping J)^-1 of an error in each column: what is stiff counts little.
    fn damped(&mut self, h: f64, mut errors: Matrix) -> Option<Matrix> {
        let n = self.y.len();
        let matrix = Matrix::identity(n, n) - &self.jacobian * (h * self.method.damping);
        matrix.lu().solve_mut(&mut errors).then_some(errors)
    }

    /// The norm of the error of the state: what its slope at the beginning differs by from that of the polynomial.
    fn error(&mut self, h: f64) -> Option<f64> {
        let count = self.method.stages();
        if !self.look() {
            return None;
        }
        self.next = &self.y + self.z.column(count - 1);
        let (next, y) = (self.next.as_mut_slice(), self.y.as_slice());
        self.field.timed(next, y, self.clock);
        let scale = h * self.method.damping;
        let of_slope = |f: &Vector, slopes: &Matrix, method: &Coefficients| {
            let off = f - slopes * &method.at_begin;
            Matrix::from_column_slice(off.len(), 1, (off * scale).as_slice())
        };
        let rough = of_slope(&self.f, &self.slopes, self.method);
        let error = self.damped(h, rough)?;
        let norm = self
            .may_err
            .norm(error.as_slice(), self.y.as_slice(), self.next.as_slice())?;
        if norm <= 1.0 || !(self.refused || self.last.is_none()) {
            self.refused |= norm > 1.0;
            return Some(norm);
        }
        // Beside a slow manifold this is the distance from it, which shorter steps do not change: once more with what it says taken off
        // (Hairer & Wanner II, (8.20)).
        let at = &self.y + error.column(0);
        let mut f = self.f.clone();
        self.field.f(at.as_slice(), f.as_mut_slice());
        let rough = of_slope(&f, &self.slopes, self.method);
        let error = self.damped(h, rough)?;
        self.may_err
            .norm(error.as_slice(), self.y.as_slice(), self.next.as_slice())
    }

    /// The norm of the error between the stages, where the step is seen: the stages may all be known far better than the polynomial through
    /// them, on a slow manifold. One of a degree less misses the beginning by about ten times that error.
    fn dense_error(&self) -> Option<f64> {
        const OVER: f64 = 0.1;
        if !self.is_seen {
            return Some(0.0);
        }
        let missed = &self.z * &self.method.at_begin * OVER;
        let (y, next) = (self.y.as_slice(), self.next.as_slice());
        self.may_err.norm(missed.as_slice(), y, next)
    }

    /// The derivatives at the end of the tried step, and the norm of their error.
    fn differentiate(&mut self, h: f64) -> Option<f64> {
        let Some(before) = self.derivatives.take() else {
            return Some(0.0);
        };
        let made = self.differentiated(h, &before);
        self.derivatives = Some(before);
        made
    }

    fn differentiated(&mut self, h: f64, before: &Derivatives<'_>) -> Option<f64> {
        let (n, count) = (self.y.len(), self.method.stages());
        let (lu, jacobians) = self.factors(h, true)?;
        let columns = before.columns.ncols();
        let mut right = Matrix::zeros(n * count, columns);
        for i in 0..count {
            right
                .view_mut((i * n, 0), (n, columns))
                .copy_from(&before.columns);
        }
        // f_p at the stages, and at the beginning.
        let of_parameters = |y: &[f64]| {
            let mut made = Matrix::zeros(n, before.places.len());
            for (mut column, &place) in made.column_iter_mut().zip(before.places) {
                self.field
                    .parameter_derivative(y, place, column.as_mut_slice());
            }
            made
        };
        let mut pulls = Vec::with_capacity(count);
        for j in 0..count {
            let at = &self.y + self.z.column(j);
            let pull = of_parameters(at.as_slice());
            for i in 0..count {
                let factor = h * self.method.a[(i, j)];
                let mut block = right.view_mut((i * n, n), (n, before.places.len()));
                block += &pull * factor;
            }
            pulls.push(pull);
        }
        if !lu.solve_mut(&mut right) {
            return None;
        }
        let weights = self.method.a.row(count - 1);
        let traces = jacobians.iter().zip(weights.iter());
        self.next_volume = before.volume + h * traces.map(|(j, b)| b * j.trace()).sum::<f64>();
        let stage = |i: usize| right.view((i * n, 0), (n, columns));
        self.next_columns = stage(count - 1).into_owned();
        // As of the state.
        let mut off = &self.jacobian * &before.columns;
        let mut at_begin = off.view_mut((0, n), (n, before.places.len()));
        at_begin += of_parameters(self.y.as_slice());
        for i in 0..count {
            let mut slope = &jacobians[i] * stage(i);
            let mut pulled = slope.view_mut((0, n), (n, before.places.len()));
            pulled += &pulls[i];
            off -= slope * self.method.at_begin[i];
        }
        let errors = self.damped(h, off * (h * self.method.damping))?;
        let [errors, old, new] = [&errors, &before.columns, &self.next_columns]
            .map(|all| all.columns(0, n).into_owned());
        let norm = self.may_err.norm_of_tangents(&errors, &old, &new);
        norm.is_finite().then_some(norm)
    }
}

impl Steppable for Stages<'_> {
    fn error_order(&self) -> u32 {
        self.method.stages() as u32 + 1
    }

    fn max_step(&self) -> f64 {
        self.max_step
    }

    fn work(&mut self) -> &mut Work {
        self.work
    }

    fn goes_through_spikes(&self) -> bool {
        self.field.has_spikes()
    }

    fn underflow(&self, t: f64, h: f64) -> Error {
        self.field.underflow(t, h, self.y.as_slice())
    }

    fn attempt(&mut self, h: f64, clock: f64) -> Option<f64> {
        (self.tried, self.clock) = (h, clock);
        self.predict(h);
        if !self.solve(h) {
            self.z.fill(0.0);
            if !self.solve(h) {
                self.refused = true;
                return Some(UNSOLVED);
            }
        }
        let of_state = self.error(h)?.max(self.dense_error()?);
        if of_state > 1.0 {
            return Some(of_state);
        }
        Some(of_state.max(self.differentiate(h)?))
    }

    fn fastest(&self) -> (f64, f64) {
        (self.jacobian.amax(), self.ahead.1.amax())
    }

    fn look_ahead(&mut self) -> bool {
        self.work.rhs += 1;
        self.work.jacobians += 1;
        let (f, jacobian) = &mut self.ahead;
        self.field.f(self.next.as_slice(), f.as_mut_slice());
        let exact = self.derivatives.is_some();
        self.field.jacobian(self.next.as_slice(), exact, jacobian);
        f.iter().chain(jacobian.iter()).all(|x| x.is_finite())
    }

    fn advance(&mut self) {
        self.y.copy_from(&self.next);
        self.f.copy_from(&self.ahead.0);
        self.jacobian.copy_from(&self.ahead.1);
        if let Some(derivatives) = &mut self.derivatives {
            derivatives.columns.copy_from(&self.next_columns);
            derivatives.volume = self.next_volume;
        }
        let before = self.last.take();
        // A step that is cut short by the end says little of how long the next one may be.
        let longer = before.map_or(0.0, |last| last.length.abs());
        self.last = Some(LastStep {
            length: self.tried,
            following: self.tried.abs().max(longer).copysign(self.tried),
            stages: self.z.clone(),
            end: self.next.clone(),
        });
        self.refused = false;
    }
}
