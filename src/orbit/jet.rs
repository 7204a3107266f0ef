//! Jets of the Poincare maps from plane to plane around an orbit: their derivatives up to the third.

use super::arc::Tracer;
use super::continuation_point::ContinuationPoint;
use super::family::ParametrisedField;
use super::linear::{Linear, frame};
use crate::field::{Jacobian, State};
use crate::integrate::{MAX_STEPS, Taylor, Tolerances};
use crate::series::Jet3;
use nalgebra::{Complex, Matrix2, Vector2};
use std::f64::consts::FRAC_1_SQRT_2;

type C2 = Vector2<Complex<f64>>;

/// ln of what an arc may grow by: its cube is a third derivative.
const GROWTH: f64 = 3.0;
/// How often arcs are split for it.
const SPLITS: usize = 6;
/// Tolerance of new nodes.
const FINE: f64 = 1e-16;

/// A map from plane to plane at a node, to third order in orthonormal coordinates of the planes.
#[derive(Debug, Clone)]
pub struct PoincareJet {
    components: [Jet3; 2],
}

/// The coordinates in the planes.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Axes {
    /// Any.
    Any,
    /// Of an orbit in (tau, ln psi_1, ln psi_2) with psi_1 = psi_2: the first antisymmetric, the second symmetric.
    Symmetry,
}

/// The maps from node to node of an orbit, by arcs of this tolerance. `None` where one can't be had.
pub fn jets<F: ParametrisedField<3>>(
    family: &F,
    site: &ContinuationPoint<3>,
    axes: Axes,
    tolerance: f64,
) -> Option<Vec<PoincareJet>> {
    let field = family.field(site.at);
    let mut taylor = Taylor::new(Tolerances::equal(tolerance).ok()?, MAX_STEPS).ok()?;
    let nodes = &site.shooting.nodes;
    let frames: Vec<Jacobian<3>> = nodes
        .iter()
        .map(|x| plane(family, &field.f(x), axes))
        .collect();
    let mut jet = |k: usize| {
        let next = (k + 1) % nodes.len();
        let (from, onto) = (&frames[k], &frames[next]);
        let start =
            std::array::from_fn(|i| Jet3::linear(nodes[k][i], [from[(i, 1)], from[(i, 2)]]));
        let span = (0.0, site.shooting.durations[k]);
        let target = (&onto.column(0).into_owned(), &nodes[next]);
        let (_, end) = taylor.transport_onto(&*field, span, start, target).ok()?;
        let component = |j: usize| {
            let mut sum = Jet3::default();
            for i in 0..3 {
                sum = sum + (end[i] - Jet3::constant(nodes[next][i])).scaled(onto[(i, j)]);
            }
            sum
        };
        Some(PoincareJet {
            components: [component(1), component(2)],
        })
    };
    (0..nodes.len()).map(&mut jet).collect()
}

/// Of the arcs from node to node, what the displacements in the planes become along them: the integral over the arc of the square
/// of a displacement's part across the flow, as a quadratic form of what it is in the first node's plane.
pub fn squares<F: ParametrisedField<3>>(
    family: &F,
    site: &ContinuationPoint<3>,
    axes: Axes,
) -> Option<Vec<Matrix2<f64>>> {
    /// Points and weights of Gauss on (0, 1).
    const POINTS: [(f64, f64); 6] = [
        (0.033_765_242_898_423_99, 0.085_662_246_189_585_17),
        (0.169_395_306_766_867_76, 0.180_380_786_524_069_3),
        (0.380_690_406_958_401_55, 0.233_956_967_286_345_52),
        (0.619_309_593_041_598_5, 0.233_956_967_286_345_52),
        (0.830_604_693_233_132_2, 0.180_380_786_524_069_3),
        (0.966_234_757_101_576, 0.085_662_246_189_585_17),
    ];
    /// Into so many parts every arc is cut.
    const PARTS: usize = 4;
    let field = family.field(site.at);
    let mut tracer = Tracer::taylor(FINE).ok()?;
    let points: Vec<(f64, f64)> = (0..PARTS)
        .flat_map(|i| POINTS.map(|(at, weight)| (i as f64 + at, weight)))
        .map(|(at, weight)| (at / PARTS as f64, weight / PARTS as f64))
        .collect();
    let mut arc = |(node, &duration): (&State<3>, &f64)| {
        let mut moved = plane(family, &field.f(node), axes)
            .fixed_columns::<2>(1)
            .into_owned();
        let (mut x, mut at) = (*node, 0.0);
        let mut sum = Matrix2::zeros();
        for &(point, weight) in &points {
            let part = tracer.arc(&*field, &x, (point - at) * duration, &[]).ok()?;
            (x, at) = (part.end, point);
            moved = part.tangent * moved;
            let across = family.across(&x, &field.f(&x)) * moved;
            sum += across.transpose() * across * (weight * duration);
        }
        Some(sum)
    };
    let shooting = &site.shooting;
    shooting
        .nodes
        .iter()
        .zip(&shooting.durations)
        .map(&mut arc)
        .collect()
}

/// The plane's coordinates: its normal, and the two directions in it.
fn plane<F: ParametrisedField<3>>(family: &F, flow: &State<3>, axes: Axes) -> Jacobian<3> {
    let normal = family.normal(*flow);
    match axes {
        Axes::Any => frame(&normal),
        Axes::Symmetry => symmetric_frame(&normal),
    }
}

/// Orthonormal columns: a normal with equal components 1 and 2, the antisymmetric direction, and the one that is left.
fn symmetric_frame(normal: &State<3>) -> Jacobian<3> {
    let normal = normal.normalize();
    let across = State::<3>::new(0.0, FRAC_1_SQRT_2, -FRAC_1_SQRT_2);
    Jacobian::<3>::from_columns(&[normal, across, normal.cross(&across)])
}

/// The same orbit with so many nodes that along no arc anything grows by much.
pub fn finely_cut<F: ParametrisedField<3>>(
    family: &F,
    site: &ContinuationPoint<3>,
) -> Option<ContinuationPoint<3>> {
    let field = family.field(site.at);
    let mut tracer = Tracer::taylor(FINE).ok()?;
    let mut shooting = site.shooting.clone();
    for _ in 0..SPLITS {
        let linear = Linear::of(&mut tracer, family, &*field, &shooting).ok()?;
        if linear.growth().all(|growth| growth < GROWTH) {
            break;
        }
        let parts = linear.parts(GROWTH);
        shooting = shooting.split(&mut tracer, &*field, &parts).ok()?;
    }
    Some(ContinuationPoint {
        shooting,
        at: site.at,
    })
}

/// The same orbit with every arc cut into so many parts of equal duration.
pub fn cut_into<F: ParametrisedField<3>>(
    parts: usize,
    family: &F,
    site: &ContinuationPoint<3>,
) -> Option<ContinuationPoint<3>> {
    let field = family.field(site.at);
    let mut tracer = Tracer::taylor(FINE).ok()?;
    let counts = vec![parts; site.shooting.nodes.len()];
    Some(ContinuationPoint {
        shooting: site.shooting.split(&mut tracer, &*field, &counts).ok()?,
        at: site.at,
    })
}

impl PoincareJet {
    /// The first derivative.
    pub fn linear(&self) -> Matrix2<f64> {
        let [p, q] = self.components.map(|c| c.0);
        Matrix2::new(p[1], p[2], q[1], q[2])
    }

    /// B(u, v), the second derivative.
    pub fn second(&self, u: &C2, v: &C2) -> C2 {
        C2::from_fn(|i, _| {
            let c = self.components[i].0;
            u[0] * v[0] * (2.0 * c[3])
                + (u[0] * v[1] + u[1] * v[0]) * c[4]
                + u[1] * v[1] * (2.0 * c[5])
        })
    }

    /// C(u, v, w), the third derivative.
    pub fn third(&self, u: &C2, v: &C2, w: &C2) -> C2 {
        C2::from_fn(|i, _| {
            let c = self.components[i].0;
            let [one, two, three, four] = [6.0 * c[6], 2.0 * c[7], 2.0 * c[8], 6.0 * c[9]];
            u[0] * v[0] * w[0] * one
                + (u[0] * v[0] * w[1] + u[0] * v[1] * w[0] + u[1] * v[0] * w[0]) * two
                + (u[0] * v[1] * w[1] + u[1] * v[0] * w[1] + u[1] * v[1] * w[0]) * three
                + u[1] * v[1] * w[1] * four
        })
    }
}
