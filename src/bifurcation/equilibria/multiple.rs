//! Branch points at which several eigenvalues are 0 together, as symmetry makes them, and the branches that begin there.
//!
//! With m left null vectors Psi, f(y; p) = 0 and Psi^T (f_y, f_p) = 0 are solved by Gauss and Newton: these are more equations than unknowns, and have a
//! solution where symmetry makes m eigenvalues vanish together. Branches that begin there come through a cylinder around it, whose radius is that of the part
//! of the state in the null space (Golubitsky & Schaeffer 1985, Singularities and Groups in Bifurcation Theory, chapter VII, for the reduction to m equations).

use super::generic::FieldEquilibria;
use super::generic_curve_problem::sign;
use crate::field::{Matrix, Vector};
use crate::integrate::AnyExact;
use crate::number::singular_values;
use std::f64::consts::TAU;

/// A branch point at which several eigenvalues are 0.
#[derive(Debug, Clone, PartialEq)]
#[non_exhaustive]
pub struct MultiplePoint {
    /// The equilibrium.
    pub state: Vector,
    /// The parameter.
    pub parameter: f64,
    /// Error bound of the parameter.
    pub uncertainty: f64,
    /// Orthonormal left null vectors of the Jacobian, in columns.
    left: Matrix,
    /// Orthonormal right null vectors.
    kernel: Matrix,
}

/// Most eigenvalues that are looked at.
const MOST: usize = 8;
/// Iterations; a correction that is the last, and one that may be left to rounding, both relative.
const ITERATIONS: usize = 30;
const DONE: f64 = 1e-14;
const ROUNDED: f64 = 1e-9;

impl MultiplePoint {
    /// The number of eigenvalues that are 0.
    pub fn multiplicity(&self) -> usize {
        self.kernel.ncols()
    }

    /// (state, parameter).
    pub fn place(&self) -> Vector {
        self.state.push(self.parameter)
    }

    /// The distance of a point (state, parameter) along the null space.
    pub fn radius(&self, place: &Vector) -> f64 {
        let away = place.rows(0, self.state.len()) - &self.state;
        (self.kernel.transpose() * away).norm()
    }

    /// The point near a place of a branch, where no singular values may vanish but those up to this size.
    pub(super) fn near(
        family: &FieldEquilibria<'_>,
        state: &Vector,
        parameter: f64,
        most: f64,
    ) -> Option<Self> {
        let rows = family.extended(state, parameter);
        let decomposed = singular_values(rows, [true, false])?;
        let (u, values) = (decomposed.u?, decomposed.singular_values);
        let mut order: Vec<usize> = (0..values.len()).collect();
        order.sort_by(|&a, &b| values[a].total_cmp(&values[b]));
        let small = order.iter().filter(|&&i| values[i] <= most);
        let small = small.count().min(MOST);
        (2..=small).rev().find_map(|m| {
            let columns: Vec<Vector> = order[..m]
                .iter()
                .map(|&i| u.column(i).into_owned())
                .collect();
            refined(family, state, parameter, &Matrix::from_columns(&columns))
        })
    }

    /// Where branches that begin here pass, (state, parameter), and the radius of the cylinder there; `None` where two cylinders do not agree on their number.
    /// The first radius should be small, and is halved until they do.
    pub(in crate::bifurcation) fn branches(
        &self,
        family: &FieldEquilibria<'_>,
        radius: f64,
    ) -> Option<(Vec<Vector>, f64)> {
        /// Times the radius may be halved.
        const HALVINGS: usize = 6;
        let reduced = Reduced::new(self, family)?;
        let mut radius = radius;
        let mut before = reduced.passing(radius);
        for _ in 0..HALVINGS {
            radius *= 0.5;
            let now = reduced.passing(radius);
            if now.len() == before.len() {
                return Some((now, radius));
            }
            before = now;
        }
        None
    }
}

/// The size of a correction relative to 1 + |u|; infinite where it is no number.
fn relative(step: &Vector, u: &Vector) -> f64 {
    let parts = step.iter().zip(u).map(|(d, x)| (d / (1.0 + x.abs())).abs());
    parts.fold(0.0, |most: f64, x| {
        if x.is_finite() {
            most.max(x)
        } else {
            f64::INFINITY
        }
    })
}

/// u = (y, p, the left null vectors one after the other), which stay normalised against the first ones.
struct Unknowns<'f, 'a> {
    family: &'f FieldEquilibria<'a>,
    first: &'f Matrix,
    n: usize,
}

impl Unknowns<'_, '_> {
    fn parts(&self, u: &Vector) -> (Vector, f64, Matrix) {
        let n = self.n;
        let left = Matrix::from_column_slice(n, self.first.ncols(), &u.as_slice()[n + 1..]);
        (u.rows(0, n).into_owned(), u[n], left)
    }

    /// Equations for f, then for each null vector its products with f_y, with f_p and with the first ones.
    fn stacked(&self, f: &Vector, of_left: impl Fn(usize) -> (Vector, f64, Vector)) -> Vector {
        let mut all = f.clone().as_slice().to_vec();
        for k in 0..self.first.ncols() {
            let (across, along, normal) = of_left(k);
            all.extend(across.iter());
            all.push(along);
            all.extend(normal.iter());
        }
        Vector::from_vec(all)
    }

    fn residual(&self, u: &Vector) -> Vector {
        let (y, p, left) = self.parts(u);
        let AnyExact { f, jacobian } = self.family.exact(&y, p);
        let in_parameter = self.family.in_parameter(&y, p);
        self.stacked(&f[0], |k| {
            let psi = left.column(k).into_owned();
            let mut normal = self.first.transpose() * &psi;
            normal[k] -= 1.0;
            (
                jacobian[0].transpose() * &psi,
                in_parameter.dot(&psi),
                normal,
            )
        })
    }

    /// Bounds on the rounding errors of the residual: of its evaluation, and those that the last digits of the unknowns make.
    fn noise(&self, u: &Vector) -> Vector {
        /// So many changes in the last digits.
        const TRIED: usize = 8;
        let (y, p, left) = self.parts(u);
        let AnyExact { f, jacobian } = self.family.exact(&y, p);
        let [jacobian, off] = jacobian.map(|matrix| matrix.abs());
        let entries = off + jacobian * f64::EPSILON;
        let in_parameter = self.family.in_parameter(&y, p).abs();
        let mut noise = self.stacked(&f[1], |k| {
            let psi = left.column(k).abs();
            let normal = self.first.abs().transpose() * &psi * f64::EPSILON;
            let along = f64::EPSILON * in_parameter.dot(&psi);
            (entries.transpose() * &psi, along, normal)
        });
        let here = self.residual(u);
        for time in 0..TRIED {
            let moved = Vector::from_fn(u.len(), |i, _| {
                u[i] + f64::EPSILON * (1.0 + u[i].abs()) * sign(i, time)
            });
            let change = self.residual(&moved) - &here;
            noise = noise.zip_map(&change, |most: f64, x: f64| most.max(x.abs()));
        }
        noise
    }

    /// The derivatives of the residual. Those of f_y and f_p in p are differences: the method needs them but to converge.
    fn derivatives(&self, u: &Vector) -> Matrix {
        /// Relative to 1 + |p|.
        const CHANGE: f64 = 1e-6;
        let (n, m) = (self.n, self.first.ncols());
        let (y, p, left) = self.parts(u);
        let extended = self.family.extended(&y, p);
        let h = CHANGE * (1.0 + p.abs());
        let in_parameter =
            (self.family.extended(&y, p + h) - self.family.extended(&y, p - h)) / (2.0 * h);
        let block = n + 1 + m;
        let mut all = Matrix::zeros(n + m * block, n + 1 + m * n);
        all.view_mut((0, 0), (n, n + 1)).copy_from(&extended);
        for second in self.family.field(p).second_derivatives(&y) {
            for (k, (i, j)) in (0..m).flat_map(|k| second.orders().map(move |pair| (k, pair))) {
                all[(n + k * block + i, j)] += left[(second.of, k)] * second.value;
            }
        }
        for k in 0..m {
            let (row, column) = (n + k * block, n + 1 + k * n);
            let by_parameter = in_parameter.transpose() * left.column(k);
            all.view_mut((row, n), (n + 1, 1)).copy_from(&by_parameter);
            for j in 0..n {
                all[(row + n, j)] = by_parameter[j];
            }
            all.view_mut((row, column), (n + 1, n))
                .copy_from(&extended.transpose());
            all.view_mut((row + n + 1, column), (m, n))
                .copy_from(&self.first.transpose());
        }
        all
    }
}

/// The point at which as many left null vectors vanish as are given roughly.
fn refined(
    family: &FieldEquilibria<'_>,
    state: &Vector,
    parameter: f64,
    first: &Matrix,
) -> Option<MultiplePoint> {
    let n = state.len();
    let unknowns = Unknowns { family, first, n };
    let mut u = Vector::from_iterator(
        n + 1 + first.len(),
        state
            .iter()
            .copied()
            .chain([parameter])
            .chain(first.iter().copied()),
    );
    let mut last = f64::INFINITY;
    for _ in 0..ITERATIONS {
        let made = unknowns.derivatives(&u).qr();
        let mut right = unknowns.residual(&u);
        made.q_tr_mul(&mut right);
        let right = right.rows(0, u.len()).into_owned();
        let step = made.unpack_r().solve_upper_triangular(&right)?;
        let size = relative(&step, &u);
        if !size.is_finite() {
            return None;
        }
        u -= step;
        if size < DONE || size >= 0.5 * last && size < ROUNDED {
            return certain(&unknowns, &u);
        }
        last = size;
    }
    None
}

/// The solution, if it satisfies all equations within rounding.
fn certain(unknowns: &Unknowns<'_, '_>, u: &Vector) -> Option<MultiplePoint> {
    /// What the largest residual of a few counts.
    const SAFETY: f64 = 4.0;
    let noise = unknowns.noise(u) * SAFETY;
    let residual = unknowns.residual(u);
    if !residual
        .iter()
        .zip(&noise)
        .all(|(r, noise)| r.abs() <= *noise)
    {
        return None;
    }
    let (state, mut parameter, left) = unknowns.parts(u);
    let made = unknowns.derivatives(u).qr();
    let inverse = made.r().try_inverse()? * made.q().transpose();
    let off = inverse.abs() * noise;
    let uncertainty = off[unknowns.n] + f64::EPSILON * parameter.abs();
    // What is left of zero.
    if parameter.abs() < f64::EPSILON * uncertainty {
        parameter = 0.0;
    }
    let m = left.ncols();
    let jacobian = unknowns.family.exact(&state, parameter).jacobian[0].clone();
    let decomposed = singular_values(jacobian, [false, true])?;
    let (rows, values) = (decomposed.v_t?, decomposed.singular_values);
    let mut order: Vec<usize> = (0..values.len()).collect();
    order.sort_by(|&a, &b| values[a].total_cmp(&values[b]));
    let kernel: Vec<Vector> = order[..m]
        .iter()
        .map(|&i| rows.row(i).transpose())
        .collect();
    uncertainty.is_finite().then(|| MultiplePoint {
        state,
        parameter,
        uncertainty,
        left: left.qr().q(),
        kernel: Matrix::from_columns(&kernel),
    })
}

/// The equations around a multiple branch point, of which in the end m are left for m unknowns v, the part of the state in the null space, and p.
struct Reduced<'f, 'a> {
    at: &'f MultiplePoint,
    family: &'f FieldEquilibria<'a>,
    /// How fast the null space's eigenvalues change with the parameter, as a matrix.
    speed: Matrix,
}

/// A point of the cylinder, relative to the multiple point: the state and the parameter, and what is left of the equations.
#[derive(Clone)]
struct OnCylinder {
    place: Vector,
    left: f64,
}

impl<'f, 'a> Reduced<'f, 'a> {
    fn new(at: &'f MultiplePoint, family: &'f FieldEquilibria<'a>) -> Option<Self> {
        /// Relative to 1 + |p|, for a difference.
        const CHANGE: f64 = 1e-4;
        let (y, p) = (&at.state, at.parameter);
        let (n, m) = (y.len(), at.multiplicity());
        let mut bordered = Matrix::zeros(n + m, n + m);
        let extended = family.extended(y, p);
        bordered
            .view_mut((0, 0), (n, n))
            .copy_from(&extended.columns(0, n));
        bordered.view_mut((0, n), (n, m)).copy_from(&at.left);
        bordered
            .view_mut((n, 0), (m, n))
            .copy_from(&at.kernel.transpose());
        let right = -extended
            .column(n)
            .into_owned()
            .resize_vertically(n + m, 0.0);
        let along = bordered.lu().solve(&right)?.rows(0, n).into_owned();
        let h = CHANGE * (1.0 + p.abs()) / (1.0 + along.norm());
        let ahead = family.extended(&(y + &along * h), p + h);
        let behind = family.extended(&(y - &along * h), p - h);
        let change = (ahead - behind).columns(0, n) / (2.0 * h);
        let speed = at.left.transpose() * change * &at.kernel;
        let regular = speed
            .clone()
            .try_inverse()
            .is_some_and(|x| x.iter().all(|x| x.is_finite()));
        regular.then_some(Reduced { at, family, speed })
    }

    /// The points (state, parameter) at which branches pass the cylinder of this radius.
    fn passing(&self, radius: f64) -> Vec<Vector> {
        let found = match self.at.multiplicity() {
            2 => self.around(radius),
            _ => self.tried(radius),
        };
        let here = self.at.place();
        found.into_iter().map(|place| place + &here).collect()
    }

    /// f, and its derivatives in state and parameter, at a place relative to the point.
    fn equations(&self, place: &Vector) -> (Vector, Matrix) {
        let n = self.at.state.len();
        let (y, p) = (
            &self.at.state + place.rows(0, n),
            self.at.parameter + place[n],
        );
        let extended = self.family.extended(&y, p);
        (self.family.exact(&y, p).f[0].clone(), extended)
    }

    /// Newton's method in so many unknowns, the first of which are a place.
    fn solved(
        &self,
        guess: Vector,
        radius: f64,
        equations: impl Fn(&Vector) -> (Vector, Matrix),
    ) -> Option<Vector> {
        /// Corrections that are the last, and that may be left to rounding, in radii.
        const LAST: f64 = 1e-13;
        const LEFT: f64 = 1e-7;
        let n = self.at.state.len();
        let (mut x, mut last) = (guess, f64::INFINITY);
        for _ in 0..ITERATIONS {
            let (left, matrix) = equations(&x);
            let step = matrix.lu().solve(&left)?;
            x -= &step;
            let size = step.rows(0, n + 1).norm() / radius;
            if !size.is_finite() {
                return None;
            }
            if size < LAST || size < LEFT && size >= 0.5 * last {
                return Some(x);
            }
            last = size;
        }
        None
    }

    /// The point in one of the directions of a plane, with what is left of the equations across B v: there their part along B v, with which the parameter enters, is solved.
    fn in_direction(&self, angle: f64, radius: f64) -> Option<OnCylinder> {
        let (n, m) = (self.at.state.len(), 2);
        let v = Vector::from_vec(vec![angle.cos(), angle.sin()]) * radius;
        let along = &self.speed * &v;
        let across = Vector::from_vec(vec![-along[1], along[0]]) / along.norm();
        let column = &self.at.left * across;
        let guess = (&self.at.kernel * &v).resize_vertically(n + 2, 0.0);
        let found = self.solved(guess, radius, |x| {
            let (f, extended) = self.equations(x);
            let mut matrix = Matrix::zeros(n + m, n + 2);
            matrix.view_mut((0, 0), (n, n + 1)).copy_from(&extended);
            matrix.view_mut((0, n + 1), (n, 1)).copy_from(&(-&column));
            matrix
                .view_mut((n, 0), (m, n))
                .copy_from(&self.at.kernel.transpose());
            let off = self.at.kernel.transpose() * x.rows(0, n) - &v;
            let left = f - &column * x[n + 1];
            let all = left.iter().chain(off.iter()).copied();
            (Vector::from_iterator(n + m, all), matrix)
        })?;
        Some(OnCylinder {
            place: found.rows(0, n + 1).into_owned(),
            left: found[n + 1],
        })
    }

    /// All round a circle, where two eigenvalues are 0.
    fn around(&self, radius: f64) -> Vec<Vector> {
        /// Directions, from one that is none of symmetry, and bisections.
        const DIRECTIONS: usize = 360;
        const FIRST: f64 = 0.123_456_789;
        const BISECTIONS: usize = 48;
        /// A change of sign that leaves more than this part of the largest value is a jump.
        const JUMP: f64 = 1e-6;
        let angle = |i: usize| FIRST + TAU * i as f64 / DIRECTIONS as f64;
        let all: Vec<_> = (0..=DIRECTIONS)
            .map(|i| self.in_direction(angle(i), radius))
            .collect();
        let most = all.iter().flatten().map(|one| one.left.abs());
        let most = most.fold(0.0, f64::max);
        let between = |i: usize| {
            let (mut from, mut to) = (angle(i), angle(i + 1));
            let [first, last] = [all[i].as_ref()?, all[i + 1].as_ref()?];
            if first.left * last.left > 0.0 || last.left == 0.0 {
                return None;
            }
            let mut best = first.clone();
            for _ in 0..BISECTIONS {
                if best.left == 0.0 {
                    break;
                }
                let middle = 0.5 * (from + to);
                best = self.in_direction(middle, radius)?;
                if best.left * first.left > 0.0 {
                    from = middle;
                } else {
                    to = middle;
                }
            }
            (best.left.abs() <= JUMP * most).then_some(best.place)
        };
        (0..DIRECTIONS).filter_map(between).collect()
    }

    /// From many directions, where more than two eigenvalues are 0.
    fn tried(&self, radius: f64) -> Vec<Vector> {
        /// Directions.
        const TRIED: usize = 2000;
        /// Points nearer to each other than this part of the radius are one; farther away than this many radii along the state they are no branch that begins here.
        const SAME: f64 = 1e-3;
        const FAR: f64 = 3.0;
        let (n, m) = (self.at.state.len(), self.at.multiplicity());
        let kernel = self.at.kernel.transpose();
        let mut found: Vec<Vector> = Vec::new();
        for time in 1..=TRIED {
            // Irrational multiples, which fill the sphere.
            let part = |k: usize| (time as f64 * (2.0 + k as f64).sqrt().exp()).sin();
            let v = Vector::from_fn(m, |k, _| part(k)).normalize() * radius;
            let mut guess = (&self.at.kernel * &v).push(0.0);
            let along = &self.speed * &v;
            let left = self.at.left.transpose() * self.equations(&guess).0;
            guess[n] = -along.dot(&left) / along.norm_squared();
            let solved = self.solved(guess, radius, |x| {
                let (f, extended) = self.equations(x);
                let v = &kernel * x.rows(0, n);
                let mut matrix = extended.insert_row(n, 0.0);
                let normal = (self.at.kernel.clone() * &v * 2.0).push(0.0);
                matrix.set_row(n, &normal.transpose());
                (f.push(v.norm_squared() - radius * radius), matrix)
            });
            if let Some(place) = solved
                && place.rows(0, n).norm() <= FAR * radius
                && found
                    .iter()
                    .all(|other| (other - &place).norm() > SAME * radius)
            {
                found.push(place);
            }
        }
        found
    }
}
