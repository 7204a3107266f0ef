//! The maps from plane to plane around an orbit, with their derivatives up to the third.
//!
//! A map is sampled on a grid of Chebyshev points around the node; the interpolating polynomials have its derivatives. Along one
//! arc little grows, so the grid is as wide as the map is smooth: around the whole orbit a canard would leave no such width.

use super::arc::Tracer;
use super::family::Family;
use super::linear::{Linear, frame};
use super::motion::Site;
use super::polygon::{Mesh, Polygon};
use crate::error::Result;
use crate::field::{Jacobian, State, VectorField};
use nalgebra::{Complex, Matrix2, Vector2};

type C2 = Vector2<Complex<f64>>;

/// Points of the grid in each direction.
const POINTS: usize = 7;
/// Tolerance of the flow.
const FINE: f64 = 1e-16;
/// ln of what an arc may grow by.
const GROWTH: f64 = 1.0;
/// How often arcs are split for it.
const SPLITS: usize = 6;

/// The map from one plane across the flow to another, or to itself, in orthonormal coordinates there.
pub struct PlaneMap<'a> {
    field: &'a dyn VectorField<3>,
    tracer: Tracer<3>,
    from: (State<3>, Jacobian<3>),
    onto: (State<3>, Jacobian<3>),
    duration: f64,
}

impl<'a> PlaneMap<'a> {
    /// The return map at a node of an orbit.
    ///
    /// # Errors
    /// Those of [`Tracer::taylor`].
    pub fn around(
        field: &'a dyn VectorField<3>,
        polygon: &Polygon<3>,
        node: usize,
    ) -> Result<Self> {
        let origin = polygon.nodes[node];
        let plane = (origin, frame(&field.f(&origin)));
        Self::between(field, plane, plane, polygon.period())
    }

    /// From a point and the frame of its plane, whose first column is the normal, to another's, which is reached after about
    /// this duration.
    fn between(
        field: &'a dyn VectorField<3>,
        from: (State<3>, Jacobian<3>),
        onto: (State<3>, Jacobian<3>),
        duration: f64,
    ) -> Result<Self> {
        Ok(PlaneMap {
            field,
            tracer: Tracer::taylor(FINE)?,
            from,
            onto,
            duration,
        })
    }

    /// Where the trajectory of a point of the first plane meets the second; `None` where it does not after about that duration.
    pub fn at(&mut self, x: Vector2<f64>) -> Option<Vector2<f64>> {
        /// Newton iterations to the plane, whose last is below rounding.
        const LANDINGS: usize = 6;
        /// Part of the duration by which it may be met sooner or later.
        const FAR: f64 = 0.3;
        let (origin, frame) = &self.from;
        let start = origin + frame.column(1) * x[0] + frame.column(2) * x[1];
        let (target, onto) = &self.onto;
        let normal = onto.column(0);
        let mut y = self
            .tracer
            .flow(self.field, &start, self.duration, None)
            .ok()?;
        for _ in 0..LANDINGS {
            let dt = -normal.dot(&(y - target)) / normal.dot(&self.field.f(&y));
            if dt.is_nan() || dt.abs() > FAR * self.duration {
                return None;
            }
            if dt.abs() < 1e-15 * self.duration {
                break;
            }
            y = self.tracer.flow(self.field, &y, dt, None).ok()?;
        }
        let off = y - target;
        Some(Vector2::new(
            onto.column(1).dot(&off),
            onto.column(2).dot(&off),
        ))
    }
}

/// The derivatives of a map of planes at a node: `d[i][a][b]` is that of component i, a times in x and b times in y.
#[derive(Debug, Clone)]
pub struct Jet {
    d: [[[f64; 4]; 4]; 2],
}

/// The maps from node to node of an orbit whose arcs have been cut so that nothing grows by much along one; the grids are
/// `width` times as wide as what grows least allows. `None` where a map does not exist on its grid.
pub fn jets<F: Family<3>>(family: &F, site: &Site<3>, width: f64) -> Option<Vec<Jet>> {
    let field = family.field(site.at);
    let nodes = &site.polygon.nodes;
    let frames: Vec<_> = nodes
        .iter()
        .map(|x| frame(&family.normal(field.f(x))))
        .collect();
    let mut tracer = Tracer::taylor(FINE).ok()?;
    let linear = Linear::of(&mut tracer, family, &*field, &site.polygon).ok()?;
    let jet = |k: usize| {
        let next = (k + 1) % nodes.len();
        let (from, onto) = ((nodes[k], frames[k]), (nodes[next], frames[next]));
        let mut map = PlaneMap::between(&*field, from, onto, site.polygon.durations[k]).ok()?;
        Jet::of(&mut map, width / linear.maps[k].amax().max(1.0))
    };
    (0..nodes.len()).map(jet).collect()
}

/// The same orbit with so many nodes that along no arc anything grows by much; the nodes first moved along their arcs by this
/// part of them.
pub fn finely_cut<F: Family<3>>(family: &F, site: &Site<3>, part: f64) -> Option<Site<3>> {
    let field = family.field(site.at);
    let mut tracer = Tracer::taylor(FINE).ok()?;
    let mut polygon = site
        .polygon
        .shifted(&mut tracer, &*field, part)
        .ok()?
        .cut(&mut tracer, &*field, &Mesh::FINE)
        .ok()?;
    for _ in 0..SPLITS {
        let linear = Linear::of(&mut tracer, family, &*field, &polygon).ok()?;
        if linear.growth().all(|growth| growth < GROWTH) {
            break;
        }
        let growths: Vec<f64> = linear.growth().collect();
        polygon = polygon.split(&mut tracer, &*field, &growths, GROWTH).ok()?;
    }
    Some(Site {
        polygon,
        at: site.at,
    })
}

impl Jet {
    fn of(map: &mut PlaneMap<'_>, width: f64) -> Option<Self> {
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
        Some(Jet { d })
    }

    /// The first derivative.
    pub fn linear(&self) -> Matrix2<f64> {
        let [p, q] = &self.d;
        Matrix2::new(p[1][0], p[0][1], q[1][0], q[0][1])
    }

    /// B(u, v)
    pub fn second(&self, u: &C2, v: &C2) -> C2 {
        C2::from_fn(|i, _| {
            let d = &self.d[i];
            u[0] * v[0] * d[2][0] + (u[0] * v[1] + u[1] * v[0]) * d[1][1] + u[1] * v[1] * d[0][2]
        })
    }

    /// C(u, v, w)
    pub fn third(&self, u: &C2, v: &C2, w: &C2) -> C2 {
        C2::from_fn(|i, _| {
            let d = &self.d[i];
            u[0] * v[0] * w[0] * d[3][0]
                + (u[0] * v[0] * w[1] + u[0] * v[1] * w[0] + u[1] * v[0] * w[0]) * d[2][1]
                + (u[0] * v[1] * w[1] + u[1] * v[0] * w[1] + u[1] * v[1] * w[0]) * d[1][2]
                + u[1] * v[1] * w[1] * d[0][3]
        })
    }
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
