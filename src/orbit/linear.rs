//! The linear equations of multiple shooting.
//!
//! Every node may move in a plane through it that stands across the flow, and the duration of every arc is eliminated by
//! the next plane. So no phase is to be fixed, the period is no unknown, and the multipliers are those of the planes' maps:
//! the trivial one is gone.

use super::arc::{Arc, Tracer};
use super::continuation_point::TangentVector;
use super::cyclic;
use super::family::ParametrisedField;
use super::shooting_nodes::ShootingNodes;
use crate::error::Result;
use crate::field::{Jacobian, State, VectorField};
use nalgebra::{DMatrix, DVector, SMatrix, SVector};

/// One linearisation around the circle.
#[derive(Debug, Clone)]
pub(super) struct Linear<const N: usize> {
    /// From every node to the next.
    pub arcs: Vec<Arc<N>>,
    /// At every node orthonormal columns, the first the plane's normal.
    frames: Vec<Jacobian<N>>,
    /// The maps from plane to plane in these frames; the first row and column, of the flow's direction, are zero.
    pub maps: Vec<Jacobian<N>>,
    /// By arc: end minus next node; g / (n . g) and 1 / (n . g), with g the field at the end and n the next node's normal.
    pub gaps: Vec<State<N>>,
    inflow: Vec<State<N>>,
    slowness: Vec<f64>,
}

impl<const N: usize> Linear<N> {
    /// In the planes at right angles to the flow.
    pub fn new(
        tracer: &mut Tracer<N>,
        field: &dyn VectorField<N>,
        shooting: &ShootingNodes<N>,
    ) -> Result<Self> {
        let frames = shooting.nodes.iter().map(|x| frame(&field.f(x))).collect();
        Self::in_frames(tracer, field, shooting, &[], frames)
    }

    /// In the family's planes, with the derivatives in the parameters.
    pub fn of<F: ParametrisedField<N>>(
        tracer: &mut Tracer<N>,
        family: &F,
        field: &dyn VectorField<N>,
        shooting: &ShootingNodes<N>,
    ) -> Result<Self> {
        let normal = |x: &State<N>| frame(&family.normal(field.f(x)));
        let frames = shooting.nodes.iter().map(normal).collect();
        Self::in_frames(tracer, field, shooting, &family.plane(), frames)
    }

    /// The same in the planes of another linearisation nearby, so that the maps can be compared.
    pub fn beside(
        &self,
        tracer: &mut Tracer<N>,
        field: &dyn VectorField<N>,
        shooting: &ShootingNodes<N>,
    ) -> Result<Self> {
        Self::in_frames(tracer, field, shooting, &[], self.frames.clone())
    }

    fn in_frames(
        tracer: &mut Tracer<N>,
        field: &dyn VectorField<N>,
        shooting: &ShootingNodes<N>,
        free: &[usize],
        frames: Vec<Jacobian<N>>,
    ) -> Result<Self> {
        let count = shooting.nodes.len();
        let mut linear = Linear {
            arcs: Vec::with_capacity(count),
            frames,
            maps: Vec::with_capacity(count),
            gaps: Vec::with_capacity(count),
            inflow: Vec::with_capacity(count),
            slowness: Vec::with_capacity(count),
        };
        for (k, (x, &duration)) in shooting.nodes.iter().zip(&shooting.durations).enumerate() {
            let arc = tracer.arc(field, x, duration, free)?;
            let next = (k + 1) % count;
            let onto = linear.frames[next];
            let normal = onto.column(0);
            let g = field.f(&arc.end);
            let slowness = 1.0 / normal.dot(&g);
            let inflow = g * slowness;
            let moved = arc.tangent * linear.frames[k];
            let across = moved - inflow * (normal.transpose() * moved);
            let mut map = onto.tr_mul(&across);
            map.column_mut(0).fill(0.0);
            map.row_mut(0).fill(0.0);
            linear.maps.push(map);
            linear.gaps.push(arc.end - shooting.nodes[next]);
            linear.inflow.push(inflow);
            linear.slowness.push(slowness);
            linear.arcs.push(arc);
        }
        Ok(linear)
    }

    /// ln of the largest growth along every arc.
    pub fn growth(&self) -> impl Iterator<Item = f64> {
        self.maps.iter().map(|map| map.amax().ln())
    }

    /// Into how many parts to cut each arc for nothing to grow by more than e^growth along one.
    pub fn parts(&self, growth: f64) -> Vec<usize> {
        /// At most, at once: the growth along a part is not known.
        const PARTS: f64 = 8.0;
        let parts = |of_arc: f64| (of_arc / growth).ceil().clamp(1.0, PARTS) as usize;
        self.growth().map(parts).collect()
    }

    /// The same with the k-th node as the first.
    pub fn beginning_at(mut self, k: usize) -> Self {
        self.arcs.rotate_left(k);
        self.frames.rotate_left(k);
        self.maps.rotate_left(k);
        self.gaps.rotate_left(k);
        self.inflow.rotate_left(k);
        self.slowness.rotate_left(k);
        self
    }

    /// The part of a gap before node k + 1 that the planes see, in the frame there.
    fn seen(&self, k: usize, gap: &State<N>) -> State<N> {
        let onto = &self.frames[(k + 1) % self.frames.len()];
        let across = gap - self.inflow[k] * onto.column(0).dot(gap);
        let mut seen = onto.tr_mul(&across);
        seen[0] = 0.0;
        seen
    }

    /// The corrections of all nodes and durations that close these gaps.
    pub fn correction(&self, gaps: &[State<N>]) -> Option<(Vec<State<N>>, Vec<f64>)> {
        let count = self.frames.len();
        let seen: Vec<_> = (0..count).map(|k| self.seen(k, &gaps[k])).collect();
        let u = cyclic::solve(&self.maps, &seen)?;
        Some(self.displacement(&u, |k| gaps[k]))
    }

    /// Nodes and durations from displacements in the planes that the maps carry from one to the next.
    pub fn carried(&self, u: &[State<N>]) -> (Vec<State<N>>, Vec<f64>) {
        self.displacement(u, |_| State::zeros())
    }

    /// Nodes and durations from the displacements in the planes.
    fn displacement(
        &self,
        u: &[State<N>],
        gap: impl Fn(usize) -> State<N>,
    ) -> (Vec<State<N>>, Vec<f64>) {
        let count = self.frames.len();
        let nodes: Vec<State<N>> = (0..count).map(|k| self.frames[k] * u[k]).collect();
        let durations = (0..count).map(|k| {
            let normal = self.frames[(k + 1) % count].column(0).into_owned();
            let arrival = self.arcs[k].tangent * nodes[k] + gap(k);
            -normal.dot(&arrival) * self.slowness[k]
        });
        let durations = durations.collect();
        (nodes, durations)
    }

    /// The displacements that close the gaps where some parameters are free too, and the directions in which the orbit can
    /// then still move: as many as there are free parameters, orthonormal. Regular at folds; `None` where there are more
    /// directions than that, as at branch points.
    ///
    /// `scale` are the derivatives of the parameters in their coordinates.
    pub fn solutions(
        &self,
        free: &[usize],
        scale: [f64; 2],
    ) -> Option<(TangentVector<N>, Vec<TangentVector<N>>)> {
        let count = self.frames.len();
        // What the parameters add to the gaps.
        let pulls = |k: usize| {
            let mut pulls = [State::<N>::zeros(); 2];
            for &i in free {
                pulls[i] = self.arcs[k].parameters[i] * scale[i];
            }
            pulls
        };
        let right: Vec<SMatrix<f64, N, 3>> = (0..count)
            .map(|k| {
                let [first, second] = pulls(k).map(|pull| self.seen(k, &pull));
                SMatrix::from_columns(&[self.seen(k, &self.gaps[k]), first, second])
            })
            .collect();
        let reduced = cyclic::reduce(&self.maps, &right);
        let (particular, kernel) = underdetermined(&reduced.closing, &reduced.right, free)?;
        let tangent = |(start, parameters): &(State<N>, [f64; 2]), closing: f64| {
            let combination = SVector::<f64, 3>::new(closing, parameters[0], parameters[1]);
            let u = reduced.extended(start, &combination)?;
            let (nodes, durations) = self.displacement(&u, |k| {
                let [first, second] = pulls(k);
                self.gaps[k] * closing + first * parameters[0] + second * parameters[1]
            });
            Some(TangentVector {
                nodes,
                durations,
                parameters: *parameters,
            })
        };
        let mut closing = tangent(&particular, 1.0)?;
        let mut along: Vec<TangentVector<N>> = Vec::with_capacity(kernel.len());
        for direction in &kernel {
            let mut direction = tangent(direction, 0.0)?.normalised()?;
            // Twice is enough.
            for _ in 0..2 {
                for other in &along {
                    let part = direction.dot(other);
                    direction = direction.plus(-part, other);
                }
                direction = direction.normalised()?;
            }
            along.push(direction);
        }
        // The shortest start can belong to a long motion, where something grows on the way. Only what is across the directions
        // closes the orbit.
        for _ in 0..2 {
            for direction in &along {
                let part = closing.dot(direction);
                closing = closing.plus(-part, direction);
            }
        }
        Some((closing, along))
    }
}

/// A displacement of the first node and of the parameters.
type Displacement<const N: usize> = (State<N>, [f64; 2]);

/// Of closing u = right_0 + p_0 right_1 + p_1 right_2 in (u, p) with these p free: the shortest solution, and the kernel.
fn underdetermined<const N: usize>(
    closing: &Jacobian<N>,
    right: &SMatrix<f64, N, 3>,
    free: &[usize],
) -> Option<(Displacement<N>, Vec<Displacement<N>>)> {
    /// A pivot below this part of the largest is zero.
    const SINGULAR: f64 = 1e-13;
    let unknowns = N + free.len();
    // The transpose, with columns of zeros: its orthogonal factor then is square and ends with the kernel.
    let mut transposed = DMatrix::<f64>::zeros(unknowns, unknowns);
    for row in 0..N {
        for j in 0..N {
            transposed[(j, row)] = closing[(row, j)];
        }
        for (j, &i) in free.iter().enumerate() {
            transposed[(N + j, row)] = -right[(row, 1 + i)];
        }
    }
    let size = transposed.amax();
    let (q, r) = transposed.qr().unpack();
    let regular = (0..N).all(|i| r[(i, i)].abs() > SINGULAR * size);
    if !(regular && size.is_finite()) {
        return None;
    }
    let mut y = DVector::<f64>::zeros(unknowns);
    for i in 0..N {
        let known: f64 = (0..i).map(|j| r[(j, i)] * y[j]).sum();
        y[i] = (right[(i, 0)] - known) / r[(i, i)];
    }
    let start = |x: &DVector<f64>| {
        let mut parameters = [0.0; 2];
        for (j, &i) in free.iter().enumerate() {
            parameters[i] = x[N + j];
        }
        (State::<N>::from_fn(|i, _| x[i]), parameters)
    };
    let kernel = (N..unknowns).map(|j| start(&q.column(j).into_owned()));
    Some((start(&(&q * y)), kernel.collect()))
}

/// Orthonormal columns, the first along f, which is not zero: the reflection that takes the first axis there.
pub(super) fn frame<const N: usize>(f: &State<N>) -> Jacobian<N> {
    let along = f / f.amax();
    let along = along / along.norm();
    let mut v = along;
    // Away from cancellation; the columns' signs are free but for the first one's.
    let sign = if v[0] < 0.0 { -1.0 } else { 1.0 };
    v[0] += sign;
    let mut frame = Jacobian::<N>::identity() - v * v.transpose() * (2.0 / v.norm_squared());
    for mut row in frame.row_iter_mut() {
        row[0] *= -sign;
    }
    frame
}
