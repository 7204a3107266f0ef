//! The Poincare maps from plane to plane around an orbit, with their derivatives up to the third.
//!
//! These are symmetric multilinear forms, which a normal form needs for a few vectors only: those of two vectors are mixed partial
//! derivatives along them, which a flow of third-order polynomials in two variations has. Planes of two dimensions are known whole
//! by one such flow.

use super::arc::Tracer;
use super::continuation_point::ContinuationPoint;
use super::family::ParametrisedField;
use super::linear::{Free, Linear, frame};
use super::shooting_nodes::ShootingNodes;
use crate::field::{Matrix, Vector};
use crate::integrate::{AnyField, AnyStep, Control, MAX_STEPS, Taylor, Tolerances};
use crate::series::Jet3;
use nalgebra::{Complex, DVector, Vector2, Vector3};
use std::f64::consts::FRAC_1_SQRT_2;
use std::sync::Arc as Shared;

type C = Complex<f64>;
/// Coordinates along two directions.
type C2 = Vector2<C>;
/// A displacement in a plane.
pub(crate) type CVector = DVector<C>;

/// ln of what an arc may grow by: its cube is a third derivative.
const GROWTH: f64 = 3.0;
/// How often arcs are split for it.
const SPLITS: usize = 6;
/// Tolerance of new nodes.
const FINE: f64 = 1e-16;

/// The coordinates in the planes.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Axes {
    /// Any.
    Any,
    /// Of an orbit in (tau, ln psi_1, ln psi_2) with psi_1 = psi_2: the first antisymmetric, the second symmetric.
    Symmetry,
}

/// The maps from plane to plane around an orbit. Displacements are in the coordinates of the planes: along the columns of the
/// nodes' frames but the first, the plane's normal.
pub struct PoincareMaps<'a> {
    field: AnyField<'a>,
    taylor: Taylor,
    shooting: ShootingNodes,
    frames: Vec<Matrix>,
    linear: Vec<Matrix>,
    /// Along both axes of planes of two dimensions.
    jets: Option<Vec<PoincareJet>>,
}

impl<'a> PoincareMaps<'a> {
    /// By arcs of this tolerance. `None` where one can't be had.
    pub fn new(
        family: &'a dyn ParametrisedField,
        site: &ContinuationPoint,
        axes: Axes,
        tolerance: f64,
    ) -> Option<Self> {
        let field = family.field(site.at);
        let frame = |x: &Vector| plane(family, x, field.f(x), axes);
        let frames: Vec<_> = site.shooting.nodes.iter().map(frame).collect();
        let mut maps = PoincareMaps {
            field,
            taylor: Taylor::new(Tolerances::equal(tolerance).ok()?, MAX_STEPS).ok()?,
            shooting: site.shooting.clone(),
            frames,
            linear: Vec::new(),
            jets: None,
        };
        if maps.field.dimension() == 3 {
            let axes = |k: usize| [1, 2].map(|j| maps.frames[k].column(j).into_owned());
            let axes: Vec<_> = (0..maps.frames.len()).map(axes).collect();
            let jets = axes.into_iter().enumerate();
            let jets: Option<Vec<_>> = jets.map(|(k, axes)| maps.jet(k, axes)).collect();
            maps.linear = jets.iter().flatten().map(PoincareJet::linear).collect();
            maps.jets = Some(jets?);
        } else {
            let mut tracer = Tracer::taylor(tolerance).ok()?;
            // In the planes of the jets.
            let frames = Shared::new(maps.frames.clone());
            let linear =
                Linear::in_frames(&mut tracer, &maps.field, &site.shooting, Free::NONE, frames);
            maps.linear = linear.ok()?.maps;
        }
        Some(maps)
    }

    /// The same with the k-th node as the first.
    pub fn beginning_at(mut self, k: usize) -> Self {
        self.shooting.nodes.rotate_left(k);
        self.shooting.durations.rotate_left(k);
        self.frames.rotate_left(k);
        self.linear.rotate_left(k);
        if let Some(jets) = &mut self.jets {
            jets.rotate_left(k);
        }
        self
    }

    /// The first derivatives.
    pub fn linear(&self) -> &[Matrix] {
        &self.linear
    }

    /// B(u, v), the second derivative of the k-th map.
    pub fn second(&mut self, k: usize, u: &CVector, v: &CVector) -> Option<CVector> {
        if let Some(jets) = &self.jets {
            return Some(jets[k].second(&in_plane(u), &in_plane(v)));
        }
        // Of the real and imaginary parts.
        const UNITS: [C; 2] = [C::ONE, C::I];
        let mut sum = CVector::zeros(u.len());
        let of_v = parts(v);
        for (one, (a, of_a)) in UNITS.iter().zip(&parts(u)) {
            for (other, (b, of_b)) in UNITS.iter().zip(&of_v) {
                if *of_a > 0.0 && *of_b > 0.0 {
                    let directions = [a, b].map(|u| self.direction(k, u));
                    let jet = self.jet(k, directions)?;
                    sum += jet.second(&C2::x(), &C2::y()) * (one * other * *of_a * *of_b);
                }
            }
        }
        Some(sum)
    }

    /// C(u, u, u*), the third derivative of the k-th map.
    pub fn third(&mut self, k: usize, u: &CVector) -> Option<CVector> {
        let u = Along::parts(u);
        self.along(k, &u.directions, [u.at, u.at, u.at.conjugate()])
    }

    /// C(u, u, u).
    pub fn cube(&mut self, k: usize, u: &CVector) -> Option<CVector> {
        let u = Along::parts(u);
        self.along(k, &u.directions, [u.at; 3])
    }

    /// C(u, u, v) of real displacements.
    pub fn third_of_two(&mut self, k: usize, u: &Vector, v: &Vector) -> Option<CVector> {
        let [(u, of_u), (v, of_v)] = [u, v].map(normed);
        let [u_at, v_at] = [[of_u, 0.0], [0.0, of_v]].map(|at| C2::from(at.map(C::from)));
        self.along(k, &[u, v], [u_at, u_at, v_at])
    }

    /// The third derivative of the k-th map of three displacements, in coordinates along two directions.
    fn along(&mut self, k: usize, directions: &[Vector; 2], at: [C2; 3]) -> Option<CVector> {
        let [a, b] = directions;
        if let Some(jets) = &self.jets {
            let axes = nalgebra::Matrix2::new(a[0], b[0], a[1], b[1]).map(C::from);
            let [u, v, w] = at.map(|at| axes * at);
            return Some(jets[k].third(&u, &v, &w));
        }
        let directions = [a, b].map(|u| self.direction(k, u));
        let jet = self.jet(k, directions)?;
        let [u, v, w] = at;
        Some(jet.third(&u, &v, &w))
    }

    /// The direction of the states that a displacement in the k-th plane is.
    fn direction(&self, k: usize, u: &Vector) -> Vector {
        self.frames[k].columns(1, u.len()) * u
    }

    /// The k-th map along these directions of the states.
    fn jet(&mut self, k: usize, [a, b]: [Vector; 2]) -> Option<PoincareJet> {
        let ShootingNodes { nodes, durations } = &self.shooting;
        let next = (k + 1) % nodes.len();
        let onto = &self.frames[next];
        let count = onto.ncols();
        let start = (0..count).map(|i| Jet3::linear(nodes[k][i], [a[i], b[i]]));
        let start: Vec<_> = start.collect();
        let span = (0.0, durations[k]);
        let landing = self.field.landing(&nodes[next], (&nodes[k], durations[k]));
        let target = (&onto.column(0).into_owned(), &landing);
        let landed = self
            .field
            .transport_onto(&mut self.taylor, span, &start, target);
        let (_, end) = landed.ok()?;
        let component = |j: usize| {
            let mut sum = Jet3::default();
            for i in 0..count {
                sum = sum + (end[i] - Jet3::constant(landing[i])).scaled(onto[(i, j)]);
            }
            sum
        };
        Some(PoincareJet {
            components: (1..count).map(component).collect(),
        })
    }
}

/// The coordinates in a plane of two dimensions.
fn in_plane(u: &CVector) -> C2 {
    C2::new(u[0], u[1])
}

/// The real and the imaginary part, each of order one and its size.
fn parts(u: &CVector) -> [(Vector, f64); 2] {
    [u.map(|x| x.re), u.map(|x| x.im)].map(|part| normed(&part))
}

/// A vector of order one, and its size.
fn normed(part: &Vector) -> (Vector, f64) {
    let size = part.amax();
    let one = if size > 0.0 {
        part / size
    } else {
        part.clone()
    };
    (one, size)
}

/// A displacement along two real directions.
struct Along {
    directions: [Vector; 2],
    at: C2,
}

impl Along {
    /// Along its real and its imaginary part.
    fn parts(u: &CVector) -> Self {
        let [(a, of_a), (b, of_b)] = parts(u);
        Along {
            directions: [a, b],
            at: C2::new(C::from(of_a), C::I * of_b),
        }
    }
}

/// How long a displacement is across the flow: the matrix that gives its part there, from the state and the rates at that point.
pub type Across<'a> = &'a dyn Fn(&Vector, &Vector) -> Matrix;

/// For each way of measuring lengths, and for each arc: the integral over the arc of the squared length of a displacement across the flow, as a quadratic form of
/// the displacement at the first node, in the coordinates of the plane there. By Gauss quadrature in every step of the flow.
pub fn squares(
    family: &dyn ParametrisedField,
    site: &ContinuationPoint,
    axes: Axes,
    measures: &[Across<'_>],
) -> Option<Vec<Vec<Matrix>>> {
    /// Points and weights of the Gauss quadrature on (0, 1). Steps are short where the motion is fast.
    const POINTS: [(f64, f64); 8] = [
        (0.019_855_071_751_231_912, 0.050_614_268_145_188_53),
        (0.101_666_761_293_186_64, 0.111_190_517_226_687_21),
        (0.237_233_795_041_835_5, 0.156_853_322_938_943_44),
        (0.408_282_678_752_175_1, 0.181_341_891_689_180_83),
        (0.591_717_321_247_824_8, 0.181_341_891_689_180_83),
        (0.762_766_204_958_164_5, 0.156_853_322_938_943_44),
        (0.898_333_238_706_813_4, 0.111_190_517_226_687_21),
        (0.980_144_928_248_768_1, 0.050_614_268_145_188_53),
    ];
    let field = family.field(site.at);
    let mut tracer = Tracer::taylor(FINE).ok()?;
    let mut steps_along = |(node, &duration): (&Vector, &f64)| {
        let mut steps = Vec::new();
        let mut see = |step: &AnyStep<'_>| {
            steps.push(step.length);
            Ok(Control::Continue)
        };
        tracer.flow(&field, node, duration, Some(&mut see)).ok()?;
        Some(steps)
    };
    let ShootingNodes { nodes, durations } = &site.shooting;
    let steps = nodes.iter().zip(durations).map(&mut steps_along);
    let steps: Vec<Vec<f64>> = steps.collect::<Option<_>>()?;
    let mut arcs = tracer.arcs(&field, &[]).ok()?;
    let mut all = vec![Vec::new(); measures.len()];
    for (node, steps) in nodes.iter().zip(steps) {
        let mut moved = plane(family, node, field.f(node), axes).remove_column(0);
        let nothing = Matrix::zeros(moved.ncols(), moved.ncols());
        let mut sums = vec![nothing; measures.len()];
        // The last point and its time, counted from the beginning of the step.
        let (mut x, mut before) = (node.clone(), 0.0);
        for length in steps {
            for (point, weight) in POINTS {
                let part = arcs.arc(&x, point * length - before).ok()?;
                (x, before, moved) = (part.end, point * length, part.tangent * moved);
                let flow = field.f(&x);
                for (sum, across) in sums.iter_mut().zip(measures) {
                    let across = across(&x, &flow) * &moved;
                    *sum += across.tr_mul(&across) * (weight * length);
                }
            }
            before -= length;
        }
        for (all, sum) in all.iter_mut().zip(sums) {
            all.push(sum);
        }
    }
    Some(all)
}

/// The plane's coordinates: its normal, and the directions in it.
fn plane(family: &dyn ParametrisedField, x: &Vector, flow: Vector, axes: Axes) -> Matrix {
    let normal = family.normal(x, flow);
    match axes {
        Axes::Any => frame(&normal),
        Axes::Symmetry => symmetric_frame(&normal),
    }
}

/// Orthonormal columns in three dimensions: a normal with equal components 1 and 2, the antisymmetric direction, and the one that
/// is left.
fn symmetric_frame(normal: &Vector) -> Matrix {
    let normal = Vector3::new(normal[0], normal[1], normal[2]).normalize();
    let across = Vector3::new(0.0, FRAC_1_SQRT_2, -FRAC_1_SQRT_2);
    let columns = [normal, across, normal.cross(&across)];
    Matrix::from_fn(3, 3, |i, j| columns[j][i])
}

/// The same orbit with so many nodes that along no arc anything grows by much.
pub fn finely_cut(
    family: &dyn ParametrisedField,
    site: &ContinuationPoint,
) -> Option<ContinuationPoint> {
    let field = family.field(site.at);
    let mut tracer = Tracer::taylor(FINE).ok()?;
    let mut shooting = site.shooting.clone();
    for _ in 0..SPLITS {
        let linear = Linear::of(&mut tracer, family, &field, &shooting, Free::NONE).ok()?;
        if linear.growth().all(|growth| growth < GROWTH) {
            break;
        }
        let parts = linear.parts(GROWTH);
        shooting = shooting.split(&mut tracer, &field, &parts).ok()?;
    }
    Some(ContinuationPoint {
        shooting,
        at: site.at,
    })
}

/// The same orbit with every arc cut into so many parts of equal duration.
pub fn cut_into(
    parts: usize,
    family: &dyn ParametrisedField,
    site: &ContinuationPoint,
) -> Option<ContinuationPoint> {
    let field = family.field(site.at);
    let mut tracer = Tracer::taylor(FINE).ok()?;
    let counts = vec![parts; site.shooting.nodes.len()];
    Some(ContinuationPoint {
        shooting: site.shooting.split(&mut tracer, &field, &counts).ok()?,
        at: site.at,
    })
}

/// A map from plane to plane, to third order along two directions in the first plane.
#[derive(Debug, Clone)]
struct PoincareJet {
    /// Of the displacement in the next plane.
    components: Vec<Jet3>,
}

impl PoincareJet {
    /// The first derivative of a map of two dimensions along its axes.
    fn linear(&self) -> Matrix {
        Matrix::from_fn(2, 2, |i, j| self.components[i].0[j + 1])
    }

    fn second(&self, u: &C2, v: &C2) -> CVector {
        CVector::from_fn(self.components.len(), |i, _| {
            let c = self.components[i].0;
            u[0] * v[0] * (2.0 * c[3])
                + (u[0] * v[1] + u[1] * v[0]) * c[4]
                + u[1] * v[1] * (2.0 * c[5])
        })
    }

    fn third(&self, u: &C2, v: &C2, w: &C2) -> CVector {
        CVector::from_fn(self.components.len(), |i, _| {
            let c = self.components[i].0;
            let [one, two, three, four] = [6.0 * c[6], 2.0 * c[7], 2.0 * c[8], 6.0 * c[9]];
            u[0] * v[0] * w[0] * one
                + (u[0] * v[0] * w[1] + u[0] * v[1] * w[0] + u[1] * v[0] * w[0]) * two
                + (u[0] * v[1] * w[1] + u[1] * v[0] * w[1] + u[1] * v[1] * w[0]) * three
                + u[1] * v[1] * w[1] * four
        })
    }
}
