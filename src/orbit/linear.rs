//! The linear equations of multiple shooting.
//!
//! Every node may move in a plane through it that stands across the flow, and the duration of every arc is eliminated by
//! the next plane. So no phase is to be fixed, the period is no unknown, and the multipliers are those of the planes' maps:
//! the trivial one is gone.

use super::arc::{Arc, Tracer};
use super::continuation_point::TangentVector;
use super::cyclic::{self, Rows};
use super::family::ParametrisedField;
use super::settle::axis;
use super::shooting_nodes::ShootingNodes;
use super::spread::extents;
use crate::error::Result;
use crate::field::{Matrix, Vector};
use crate::integrate::AnyField;
use nalgebra::DMatrixView;
use std::sync::Arc as Shared;

/// One linearisation around the circle.
#[derive(Debug, Clone)]
pub(super) struct Linear {
    /// From every node to the next.
    pub arcs: Shared<Vec<Arc>>,
    /// The parameters, of the two that span the plane, in which the arcs have derivatives.
    free: Vec<usize>,
    /// The method that has made the arcs.
    method: &'static str,
    /// What the arcs say of volumes.
    pub logs: Vec<ArcLogs>,
    /// At every node orthonormal columns, the first the plane's normal, the others the axes of coordinates in it.
    pub(super) frames: Shared<Vec<Matrix>>,
    /// The maps from plane to plane in these coordinates.
    pub maps: Vec<Matrix>,
    /// By arc: end minus next node; g / (n . g) and 1 / (n . g), with g the field at the end and n the next node's normal.
    pub gaps: Vec<Vector>,
    inflow: Shared<Vec<Vector>>,
    pub(super) slowness: Shared<Vec<f64>>,
}

/// The parameters in which arcs get derivatives.
#[derive(Debug, Clone, Copy)]
pub(super) struct Free<'a> {
    /// Which of the two that span the plane.
    pub of_plane: &'a [usize],
    /// The places of both among all of the field's.
    pub plane: [usize; 2],
}

impl Free<'_> {
    /// None.
    pub const NONE: Self = Free {
        of_plane: &[],
        plane: [0; 2],
    };
}

/// [`Arc::volume`] and [`Arc::log_transverse`].
#[derive(Debug, Clone, Copy)]
pub(super) struct ArcLogs {
    pub volume: f64,
    pub transverse: Option<f64>,
}

impl Linear {
    /// In the planes at right angles to the flow, or of one phase of a forcing.
    pub fn new(
        tracer: &mut Tracer,
        field: &AnyField<'_>,
        shooting: &ShootingNodes,
    ) -> Result<Self> {
        let normal = |x: &Vector| match field.phase() {
            None => field.f(x),
            Some((place, _)) => axis(x.len(), place),
        };
        let frames = shooting.nodes.iter().map(|x| frame(&normal(x))).collect();
        Self::in_frames(tracer, field, shooting, Free::NONE, Shared::new(frames))
    }

    /// In the family's planes, with the derivatives in these parameters, if any.
    pub fn of(
        tracer: &mut Tracer,
        family: &dyn ParametrisedField,
        field: &AnyField<'_>,
        shooting: &ShootingNodes,
        free: Free<'_>,
    ) -> Result<Self> {
        let frames = frames_of(family, field, shooting);
        Self::in_frames(tracer, field, shooting, free, Shared::new(frames))
    }

    /// The same in the planes of another linearisation nearby, with derivatives in these parameters, if any.
    pub fn beside(
        &self,
        tracer: &mut Tracer,
        field: &AnyField<'_>,
        shooting: &ShootingNodes,
        free: Free<'_>,
    ) -> Result<Self> {
        Self::in_frames(tracer, field, shooting, free, Shared::clone(&self.frames))
    }

    /// The same arcs in the family's planes at nodes that have come to lie at their ends.
    pub fn upright(
        &self,
        family: &dyn ParametrisedField,
        field: &AnyField<'_>,
        shooting: &ShootingNodes,
    ) -> Self {
        let frames = Shared::new(frames_of(family, field, shooting));
        let made = (Shared::clone(&self.arcs), &self.free[..], self.method);
        Self::assembled(field, shooting, made, frames)
    }

    /// A displacement of these nodes in other planes as one in these: moved along the flow, which changes no orbit. Their durations stay as they
    /// are.
    pub fn in_planes(
        &self,
        field: &AnyField<'_>,
        shooting: &ShootingNodes,
        displacement: &TangentVector,
    ) -> TangentVector {
        let mut moved = displacement.clone();
        for (k, (dx, x)) in moved.nodes.iter_mut().zip(&shooting.nodes).enumerate() {
            let (normal, flow) = (self.frames[k].column(0), field.f(x));
            let along = normal.dot(dx) / normal.dot(&flow);
            dx.axpy(-along, &flow, 1.0);
        }
        moved
    }

    /// In these planes, whose normals are the first columns.
    pub(super) fn in_frames(
        tracer: &mut Tracer,
        field: &AnyField<'_>,
        shooting: &ShootingNodes,
        free: Free<'_>,
        frames: Shared<Vec<Matrix>>,
    ) -> Result<Self> {
        let places: Vec<usize> = free.of_plane.iter().map(|&i| free.plane[i]).collect();
        let method = tracer.name();
        let mut arcs = tracer.arcs(field, &places)?;
        let along = shooting.nodes.iter().zip(&shooting.durations);
        let all = along.map(|(x, &duration)| arcs.arc(x, duration));
        let all = all.collect::<Result<Vec<_>>>()?;
        let made = (Shared::new(all), free.of_plane, method);
        Ok(Self::assembled(field, shooting, made, frames))
    }

    fn assembled(
        field: &AnyField<'_>,
        shooting: &ShootingNodes,
        (arcs, free, method): (Shared<Vec<Arc>>, &[usize], &'static str),
        frames: Shared<Vec<Matrix>>,
    ) -> Self {
        let count = arcs.len();
        let mut logs = Vec::with_capacity(count);
        let mut maps = Vec::with_capacity(count);
        let mut gaps = Vec::with_capacity(count);
        let mut all_inflow = Vec::with_capacity(count);
        let mut all_slowness = Vec::with_capacity(count);
        for (k, arc) in arcs.iter().enumerate() {
            let next = (k + 1) % count;
            let onto = &frames[next];
            let normal = onto.column(0);
            let mut inflow = field.f(&arc.end);
            let slowness = 1.0 / normal.dot(&inflow);
            inflow *= slowness;
            let mut across = &arc.tangent * axes(&frames[k]);
            for mut column in across.column_iter_mut() {
                let along = normal.dot(&column);
                column.axpy(-along, &inflow, 1.0);
            }
            maps.push(axes(onto).tr_mul(&across));
            let node = &shooting.nodes[next];
            gaps.push(field.turned(arc.end.clone(), node) - node);
            logs.push(ArcLogs {
                volume: arc.volume(),
                transverse: arc.log_transverse,
            });
            all_inflow.push(inflow);
            all_slowness.push(slowness);
        }
        Linear {
            arcs,
            free: free.to_vec(),
            method,
            logs,
            frames,
            maps,
            gaps,
            inflow: Shared::new(all_inflow),
            slowness: Shared::new(all_slowness),
        }
    }

    /// The same, whose gaps are not said.
    pub fn without_gaps(&self) -> Self {
        Linear {
            arcs: Shared::clone(&self.arcs),
            free: self.free.clone(),
            method: self.method,
            logs: self.logs.clone(),
            frames: Shared::clone(&self.frames),
            maps: self.maps.clone(),
            gaps: Vec::new(),
            inflow: Shared::clone(&self.inflow),
            slowness: Shared::clone(&self.slowness),
        }
    }

    /// The number of variables: one more than the planes have.
    pub fn dimension(&self) -> usize {
        self.frames[0].nrows()
    }

    /// How far such changes of the durations are at the ends of the arcs, in parts of how far each variable moves.
    pub fn ways(&self, shooting: &ShootingNodes, durations: &[f64]) -> Vec<f64> {
        let extents = extents(shooting.nodes.iter());
        let arcs = self.inflow.iter().zip(&*self.slowness).zip(durations);
        let way = |((inflow, slowness), change): ((&Vector, &f64), &f64)| {
            inflow.component_div(&extents).amax() * (change / slowness).abs()
        };
        arcs.map(way).collect()
    }

    /// The steps of the k-th arc, if they are those of this method.
    pub fn steps(&self, k: usize, method: &str) -> Option<usize> {
        (self.method == method).then(|| self.arcs[k].steps)
    }

    /// The normal of the plane at the k-th node, along the flow.
    pub fn normal(&self, k: usize) -> Vector {
        self.frames[k].column(0).into_owned()
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
        Shared::make_mut(&mut self.arcs).rotate_left(k);
        self.logs.rotate_left(k);
        Shared::make_mut(&mut self.frames).rotate_left(k);
        self.maps.rotate_left(k);
        self.gaps.rotate_left(k);
        Shared::make_mut(&mut self.inflow).rotate_left(k);
        Shared::make_mut(&mut self.slowness).rotate_left(k);
        self
    }

    /// The part of a gap before node k + 1 that the plane there sees, in its coordinates. What is across the flow is left of the
    /// gap.
    fn see<'a>(&self, k: usize, gap: &mut Vector, seen: impl Iterator<Item = &'a mut f64>) {
        let onto = &self.frames[(k + 1) % self.frames.len()];
        let along = onto.column(0).dot(gap);
        gap.axpy(-along, &self.inflow[k], 1.0);
        for (seen, axis) in seen.zip(onto.column_iter().skip(1)) {
            *seen = axis.dot(gap);
        }
    }

    /// The corrections of all nodes and durations that close these gaps.
    pub fn correction(&self, gaps: &[Vector]) -> Option<(Vec<Vector>, Vec<f64>)> {
        self.correction_by(gaps, cyclic::solve)
    }

    /// The minimum-norm corrections that close these gaps, for an orbit of a family; `None` for an isolated orbit.
    pub fn correction_in_family(&self, gaps: &[Vector]) -> Option<(Vec<Vector>, Vec<f64>)> {
        self.correction_by(gaps, cyclic::solve_singular)
    }

    fn correction_by(
        &self,
        gaps: &[Vector],
        solve: impl FnOnce(&[Matrix], &[Vector]) -> Option<Vec<Vector>>,
    ) -> Option<(Vec<Vector>, Vec<f64>)> {
        let planar = self.dimension() - 1;
        let mut across = Vector::zeros(planar + 1);
        let seen: Vec<_> = (0..self.frames.len())
            .map(|k| {
                let mut seen = Vector::zeros(planar);
                across.copy_from(&gaps[k]);
                self.see(k, &mut across, seen.iter_mut());
                seen
            })
            .collect();
        let u = solve(&self.maps, &seen)?;
        Some(self.displacement(&u, |k, arrival| *arrival += &gaps[k]))
    }

    /// Nodes and durations from displacements in the planes that the maps carry from one to the next.
    pub fn carried(&self, u: &[Vector]) -> (Vec<Vector>, Vec<f64>) {
        self.displacement(u, |_, _| ())
    }

    /// Nodes and durations from the displacements in the planes; `and_gap` adds an arc's gap to the displacement of its end.
    fn displacement(
        &self,
        u: &[Vector],
        and_gap: impl Fn(usize, &mut Vector),
    ) -> (Vec<Vector>, Vec<f64>) {
        let count = self.frames.len();
        let nodes: Vec<_> = (0..count).map(|k| axes(&self.frames[k]) * &u[k]).collect();
        let mut arrival = Vector::zeros(self.dimension());
        let durations = (0..count).map(|k| {
            arrival.gemv(1.0, &self.arcs[k].tangent, &nodes[k], 0.0);
            and_gap(k, &mut arrival);
            let normal = self.frames[(k + 1) % count].column(0);
            -normal.dot(&arrival) * self.slowness[k]
        });
        let durations = durations.collect();
        (nodes, durations)
    }

    /// The displacements that close the gaps where some parameters are free too, and the directions in which the orbit can
    /// then still move: as many as there are free parameters, orthonormal. Regular at folds; `None` where there are more
    /// directions than that, as at branch points, and where the arcs have no derivatives in one of these.
    ///
    /// `scale` are the derivatives of the parameters in their coordinates.
    pub fn solutions(
        &self,
        free: &[usize],
        scale: [f64; 2],
    ) -> Option<(TangentVector, Vec<TangentVector>)> {
        self.closing(&self.gaps, free, scale)
    }

    /// The same for other gaps.
    pub fn closing(
        &self,
        gaps: &[Vector],
        free: &[usize],
        scale: [f64; 2],
    ) -> Option<(TangentVector, Vec<TangentVector>)> {
        let planar = self.dimension() - 1;
        let column = |i: &usize| self.free.iter().position(|known| known == i);
        let columns: Vec<usize> = free.iter().map(column).collect::<Option<_>>()?;
        let mut across = Vector::zeros(planar + 1);
        // The gaps, and what each of the free parameters adds to them.
        let right: Vec<_> = (0..self.frames.len())
            .map(|k| {
                let mut right = Matrix::zeros(planar, 1 + free.len());
                across.copy_from(&gaps[k]);
                self.see(k, &mut across, right.column_mut(0).iter_mut());
                for (j, (&i, &column)) in free.iter().zip(&columns).enumerate() {
                    across.copy_from(&self.arcs[k].parameters.column(column));
                    across *= scale[i];
                    self.see(k, &mut across, right.column_mut(1 + j).iter_mut());
                }
                right
            })
            .collect();
        let reduced = cyclic::reduce(&self.maps, &right);
        let (particular, kernel) = underdetermined(&reduced.closing(), planar, free)?;
        let tangent = |(start, parameters): &Displacement, closing: f64| {
            let mut combination = Vector::zeros(1 + free.len());
            combination[0] = closing;
            for (j, &i) in free.iter().enumerate() {
                combination[1 + j] = parameters[i];
            }
            let u = reduced.extended(start, &combination)?;
            let (nodes, durations) = self.displacement(&u, |k, arrival| {
                arrival.axpy(closing, &gaps[k], 1.0);
                for (&i, &column) in free.iter().zip(&columns) {
                    let pull = self.arcs[k].parameters.column(column);
                    arrival.axpy(parameters[i] * scale[i], &pull, 1.0);
                }
            });
            Some(TangentVector {
                nodes,
                durations,
                parameters: *parameters,
            })
        };
        let mut closing = tangent(&particular, 1.0)?;
        let mut along: Vec<TangentVector> = Vec::with_capacity(kernel.len());
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

/// A displacement of the first node in its plane and of the parameters.
type Displacement = (Vector, [f64; 2]);

/// Of closing u = right_0 + the sum of p_i right_i over the free parameters in (u, p), in rows of these, with n unknowns in u: the
/// shortest solution, and the kernel.
fn underdetermined(
    rows: &Rows<f64>,
    n: usize,
    free: &[usize],
) -> Option<(Displacement, Vec<Displacement>)> {
    /// A pivot below this part of the largest, or of one, is zero.
    const SINGULAR: f64 = 1e-13;
    let unknowns = n + free.len();
    // The transpose, with columns of zeros: its orthogonal factor then is square and ends with the kernel.
    let mut transposed = Matrix::zeros(unknowns, unknowns);
    for i in 0..n {
        let row = rows.row(i);
        for j in 0..n {
            transposed[(j, i)] = row[j];
        }
        for j in 0..free.len() {
            transposed[(n + j, i)] = -row[n + 1 + j];
        }
    }
    let size = transposed.amax().max(1.0);
    let (q, r) = transposed.qr().unpack();
    let regular = (0..n).all(|i| r[(i, i)].abs() > SINGULAR * size);
    if !(regular && size.is_finite()) {
        return None;
    }
    let mut y = Vector::zeros(unknowns);
    for i in 0..n {
        let known: f64 = (0..i).map(|j| r[(j, i)] * y[j]).sum();
        y[i] = (rows.row(i)[n] - known) / r[(i, i)];
    }
    let start = |x: &Vector| {
        let mut parameters = [0.0; 2];
        for (j, &i) in free.iter().enumerate() {
            parameters[i] = x[n + j];
        }
        (x.rows(0, n).into_owned(), parameters)
    };
    let kernel = (n..unknowns).map(|j| start(&q.column(j).into_owned()));
    Some((start(&(&q * y)), kernel.collect()))
}

/// The family's planes at all nodes. Those that regard the extents of the orbit have normals between the flow and the flow as it is seen in the extents.
fn frames_of(
    family: &dyn ParametrisedField,
    field: &AnyField<'_>,
    shooting: &ShootingNodes,
) -> Vec<Matrix> {
    /// In parts of what the liveliest variable moves by: what moves by less beside it moves by rounding.
    const LEAST: f64 = 0.01;
    let extents = match family.is_any_system() {
        true => shooting.extents(),
        false => Vector::repeat(family.dimension(), 1.0),
    };
    let most = extents.amax();
    let extents = extents.map(|extent| (extent / most).max(LEAST));
    let normal = |x: &Vector| frame(&family.normal(x, field.f(x)).component_div(&extents));
    shooting.nodes.iter().map(normal).collect()
}

/// The columns of a frame that span the plane.
pub(super) fn axes(frame: &Matrix) -> DMatrixView<'_, f64> {
    frame.columns(1, frame.ncols() - 1)
}

/// Orthonormal columns, the first along f, which is not zero: the reflection that takes the first axis there.
pub(super) fn frame(f: &Vector) -> Matrix {
    let mut v = f / f.amax();
    v /= v.norm();
    // Away from cancellation; the columns' signs are free but for the first one's.
    let sign = if v[0] < 0.0 { -1.0 } else { 1.0 };
    v[0] += sign;
    let twice = 2.0 / v.norm_squared();
    Matrix::from_fn(v.len(), v.len(), |i, j| {
        let one = if i == j { 1.0 } else { 0.0 };
        let entry = one - v[i] * v[j] * twice;
        if j == 0 { -sign * entry } else { entry }
    })
}
