//! Normal forms of the bifurcations of orbits: which way they go.
//!
//! The return map to a plane across the flow, of two dimensions, is sampled on a grid of Chebyshev points around its fixed
//! point. The interpolating polynomials have its derivatives up to the third, and with them the cubic coefficients of
//!
//! Kuznetsov, Y. A. (2004). Elements of Applied Bifurcation Theory, 3rd edition, (5.40) period doubling, (5.45) torus;
//!
//! that of the pitchfork is (5.40) with the multiplier 1. Grids of two sizes show what a coefficient errs by; one that is zero
//! within that is undecided.

use crate::bifurcation::Criticality;
use crate::error::Result;
use crate::field::{Jacobian, State, VectorField};
use crate::number::Uncertain;
use crate::orbit::{Polygon, Tracer};
use nalgebra::{Complex, Matrix2, Vector2};

type C2 = Vector2<Complex<f64>>;

/// What bifurcates.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Form {
    /// A multiplier -1: b > 0 is supercritical.
    Doubling,
    /// A pair e^(+-i theta): d < 0 is supercritical.
    Torus,
    /// A multiplier 1 and a symmetry: c < 0 is supercritical.
    Pitchfork,
}

/// Points of the grid in each direction.
const POINTS: usize = 7;
/// Half widths of the grids, in the plane's coordinates, and the second width that each is held against, as a part of it.
const WIDTHS: [f64; 4] = [0.013, 0.004, 0.0013, 0.0004];
const NARROWER: f64 = 0.7;
/// Planes that are tried. Where the orbit is about to jump the map is far from its polynomials; where it has jumped it is
/// tame.
const PLANES: usize = 8;
/// A relative uncertainty with which nothing better is looked for, and one with which a plane has a say; how many must agree.
const ENOUGH: f64 = 0.02;
const DECIDED: f64 = 0.03;
const AGREE: i32 = 3;
/// Tolerance of the flow.
const FINE: f64 = 1e-16;

/// The cubic coefficient of an orbit in three dimensions that bifurcates, for eigenvectors of length 1 in one of its planes,
/// and which way that is.
pub fn normal_form(
    field: &dyn VectorField<3>,
    polygon: &Polygon<3>,
    form: Form,
) -> (Uncertain, Criticality) {
    let mut best = Uncertain::new(0.0, f64::INFINITY);
    let relative = |x: &Uncertain| x.uncertainty / x.value.abs();
    let count = polygon.nodes.len();
    // The sign must not depend on the plane.
    let (mut positive, mut negative) = (0, 0);
    for plane in 0..PLANES.min(count) {
        let node = plane * count / PLANES.min(count);
        // A map that can't be had somewhere on the grid says nothing.
        let all = WIDTHS
            .iter()
            .filter_map(|&width| coefficient(field, polygon, node, form, width));
        let finite = all.filter(|c| c.value.is_finite() && c.uncertainty.is_finite());
        let Some(here) = finite.min_by(|a, b| relative(a).total_cmp(&relative(b))) else {
            continue;
        };
        if relative(&here) < DECIDED {
            *(if here.value > 0.0 {
                &mut positive
            } else {
                &mut negative
            }) += 1;
        }
        if best.uncertainty.is_infinite() || relative(&here) < relative(&best) {
            best = here;
        }
        if relative(&best) < ENOUGH && positive + negative >= AGREE {
            break;
        }
    }
    if positive.min(negative) > 0 || positive + negative < AGREE {
        return (best, Criticality::Undecided);
    }
    let criticality = match form {
        _ if best.value.abs() <= best.uncertainty => Criticality::Undecided,
        Form::Doubling if best.value > 0.0 => Criticality::Supercritical,
        Form::Torus | Form::Pitchfork if best.value < 0.0 => Criticality::Supercritical,
        _ => Criticality::Subcritical,
    };
    (best, criticality)
}

fn coefficient(
    field: &dyn VectorField<3>,
    polygon: &Polygon<3>,
    node: usize,
    form: Form,
    width: f64,
) -> Option<Uncertain> {
    let mut map = ReturnMap::new(field, polygon, node).ok()?;
    let mut of = |width: f64| {
        let derivatives = Derivatives::of(&mut map, width)?;
        Some(match form {
            Form::Torus => derivatives.torus(),
            Form::Doubling => derivatives.real(-1.0),
            Form::Pitchfork => derivatives.real(1.0),
        })
    };
    let (wide, narrow) = (of(width)?, of(width * NARROWER)?);
    let uncertainty = 3.0 * (wide - narrow).abs() + 1e-6 * narrow.abs();
    Some(Uncertain::new(narrow, uncertainty))
}

/// The return map to the plane across the flow at a point of an orbit, in orthonormal coordinates there.
pub struct ReturnMap<'a> {
    field: &'a dyn VectorField<3>,
    tracer: Tracer<3>,
    origin: State<3>,
    frame: Jacobian<3>,
    period: f64,
}

impl<'a> ReturnMap<'a> {
    /// At a node of the orbit.
    ///
    /// # Errors
    /// Those of [`Tracer::new`].
    pub fn new(field: &'a dyn VectorField<3>, polygon: &Polygon<3>, node: usize) -> Result<Self> {
        let origin = polygon.nodes[node];
        let along = field.f(&origin).normalize();
        // The axis least along the flow, made orthogonal to it.
        let least = along.iamin();
        let axis = State::<3>::from_fn(|i, _| f64::from(i == least));
        let second = (axis - along * along.dot(&axis)).normalize();
        let third = along.cross(&second);
        Ok(ReturnMap {
            field,
            tracer: Tracer::taylor(FINE)?,
            origin,
            frame: Jacobian::<3>::from_columns(&[along, second, third]),
            period: polygon.period(),
        })
    }

    /// Where a point of the plane comes back to it; `None` where it does not after about a period.
    pub fn at(&mut self, x: Vector2<f64>) -> Option<Vector2<f64>> {
        /// Newton iterations to the plane, whose last is below rounding.
        const LANDINGS: usize = 6;
        /// Part of the period by which a return may come sooner or later.
        const FAR: f64 = 0.1;
        let normal = self.frame.column(0).into_owned();
        let start = self.origin + self.frame.column(1) * x[0] + self.frame.column(2) * x[1];
        let mut y = self
            .tracer
            .flow(self.field, &start, self.period, None)
            .ok()?;
        for _ in 0..LANDINGS {
            let off = normal.dot(&(y - self.origin));
            let dt = -off / normal.dot(&self.field.f(&y));
            if dt.is_nan() || dt.abs() > FAR * self.period {
                return None;
            }
            if dt.abs() < 1e-15 * self.period {
                break;
            }
            y = self.tracer.flow(self.field, &y, dt, None).ok()?;
        }
        let off = y - self.origin;
        Some(Vector2::new(
            self.frame.column(1).dot(&off),
            self.frame.column(2).dot(&off),
        ))
    }
}

/// The derivatives of a map of the plane at its fixed point: `d[i][a][b]` is that of component i, a times in x and b times in y.
struct Derivatives {
    d: [[[f64; 4]; 4]; 2],
}

impl Derivatives {
    fn of(map: &mut ReturnMap<'_>, width: f64) -> Option<Self> {
        let angle = |i: usize| (i as f64 + 0.5) * std::f64::consts::PI / POINTS as f64;
        let mut values = [[[0.0; POINTS]; POINTS]; 2];
        for at in 0..POINTS * POINTS {
            let (i, j) = (at / POINTS, at % POINTS);
            let x = Vector2::new(angle(i).cos(), angle(j).cos()) * width;
            let y = map.at(x)?;
            (values[0][i][j], values[1][i][j]) = (y[0], y[1]);
        }
        // The derivative of order a at 0 of the interpolating polynomial is this sum over the values.
        let weights = weights();
        let mut d = [[[0.0; 4]; 4]; 2];
        for (d, values) in d.iter_mut().zip(&values) {
            for a in 0..4 {
                for b in 0..4 - a {
                    let mut sum = 0.0;
                    for i in 0..POINTS {
                        for j in 0..POINTS {
                            sum += weights[a][i] * weights[b][j] * values[i][j];
                        }
                    }
                    d[a][b] = sum / width.powi((a + b) as i32);
                }
            }
        }
        Some(Derivatives { d })
    }

    fn linear(&self) -> Matrix2<f64> {
        let [p, q] = &self.d;
        Matrix2::new(p[1][0], p[0][1], q[1][0], q[0][1])
    }

    /// B(u, v)
    fn second(&self, u: &C2, v: &C2) -> C2 {
        C2::from_fn(|i, _| {
            let d = &self.d[i];
            u[0] * v[0] * d[2][0] + (u[0] * v[1] + u[1] * v[0]) * d[1][1] + u[1] * v[1] * d[0][2]
        })
    }

    /// C(u, v, w)
    fn third(&self, u: &C2, v: &C2, w: &C2) -> C2 {
        C2::from_fn(|i, _| {
            let d = &self.d[i];
            u[0] * v[0] * w[0] * d[3][0]
                + (u[0] * v[0] * w[1] + u[0] * v[1] * w[0] + u[1] * v[0] * w[0]) * d[2][1]
                + (u[0] * v[1] * w[1] + u[1] * v[0] * w[1] + u[1] * v[1] * w[0]) * d[1][2]
                + u[1] * v[1] * w[1] * d[0][3]
        })
    }

    /// b = <p, C(q,q,q) + 3 B(q, (1-A)^-1 B(q,q))> / 6 for the multiplier -1 or 1  (5.40)
    fn real(&self, multiplier: f64) -> f64 {
        let a = self.linear();
        let (q, p) = eigenvectors(&a, Complex::from(multiplier));
        let bilinear = self.second(&q, &q);
        // At a pitchfork 1 - A is singular along q, where B(q,q) has no part: there the shortest solution.
        let inner = solve(&(Matrix2::identity() - a), &bilinear, multiplier > 0.0);
        let sum = self.third(&q, &q, &q) + self.second(&q, &inner) * Complex::from(3.0);
        p.dotc(&sum).re / 6.0
    }

    /// d = Re e^(-i theta) <p, C(q,q,q*) + 2 B(q, (1-A)^-1 B(q,q*)) + B(q*, (e^(2 i theta)-A)^-1 B(q,q))> / 2  (5.45)
    fn torus(&self) -> f64 {
        let a = self.linear();
        let half = 0.5 * a.trace();
        let turn = Complex::new(half, (a.determinant() - half * half).max(0.0).sqrt());
        let turn = turn / turn.norm();
        let (q, p) = eigenvectors(&a, turn);
        let conjugate = q.map(|x| x.conj());
        let a = a.map(Complex::from);
        let one = Matrix2::<Complex<f64>>::identity();
        let invert = |m: Matrix2<Complex<f64>>, b: C2| {
            m.lu().solve(&b).unwrap_or(b * Complex::from(f64::NAN))
        };
        let first = invert(one - a, self.second(&q, &conjugate));
        let second = invert(one * turn * turn - a, self.second(&q, &q));
        let sum = self.third(&q, &q, &conjugate)
            + self.second(&q, &first) * Complex::from(2.0)
            + self.second(&conjugate, &second);
        (turn.conj() * p.dotc(&sum)).re / 2.0
    }
}

/// A q = mu q with |q| = 1, and p A = mu p with <p, q> = 1.
fn eigenvectors(a: &Matrix2<f64>, mu: Complex<f64>) -> (C2, C2) {
    let kernel = |m: Matrix2<Complex<f64>>| {
        // Orthogonal to the larger row.
        let rows = [m.row(0).transpose(), m.row(1).transpose()];
        let row = if rows[0].norm() > rows[1].norm() {
            rows[0]
        } else {
            rows[1]
        };
        C2::new(-row[1], row[0]).normalize()
    };
    let shifted = |m: Matrix2<f64>, mu: Complex<f64>| {
        m.map(Complex::from) - Matrix2::<Complex<f64>>::identity() * mu
    };
    let q = kernel(shifted(*a, mu));
    let p = kernel(shifted(a.transpose(), mu.conj()));
    let scale = p.dotc(&q).conj();
    (q, p / scale)
}

fn solve(m: &Matrix2<f64>, b: &C2, singular: bool) -> C2 {
    let svd = m.svd(true, true);
    let small = if singular {
        1e-4 * svd.singular_values.max()
    } else {
        0.0
    };
    let part = |b: Vector2<f64>| svd.solve(&b, small).unwrap_or(b * f64::NAN);
    let (re, im) = (part(b.map(|x| x.re)), part(b.map(|x| x.im)));
    C2::new(Complex::new(re[0], im[0]), Complex::new(re[1], im[1]))
}

/// By order of the derivative at 0 and by point: the weights of the interpolation in Chebyshev points on (-1, 1).
fn weights() -> [[f64; POINTS]; 4] {
    let mut weights = [[0.0; POINTS]; 4];
    // T_n and its first three derivatives at 0, by the recurrence T_n+1 = 2 x T_n - T_n-1.
    let mut before = [1.0, 0.0, 0.0, 0.0];
    let mut here = [0.0, 1.0, 0.0, 0.0];
    for n in 0..POINTS {
        let scale = if n == 0 { 1.0 } else { 2.0 } / POINTS as f64;
        for (a, weights) in weights.iter_mut().enumerate() {
            for (i, weight) in weights.iter_mut().enumerate() {
                let angle = (i as f64 + 0.5) * std::f64::consts::PI / POINTS as f64;
                *weight += scale * (n as f64 * angle).cos() * before[a];
            }
        }
        let mut next = [0.0; 4];
        for a in 0..4 {
            let slope = if a == 0 {
                0.0
            } else {
                2.0 * a as f64 * here[a - 1]
            };
            next[a] = slope - before[a];
        }
        (before, here) = (here, next);
    }
    weights
}
