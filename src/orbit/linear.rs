//! The linear equations of multiple shooting.
//!
//! Every node may move in the plane through it that stands across the flow, and the duration of every arc is eliminated by
//! the next plane. So no phase is to be fixed, the period is no unknown, and the multipliers are those of the planes' maps:
//! the trivial one is gone.

use super::arc::{Arc, Tracer};
use super::cyclic;
use super::polygon::Polygon;
use crate::error::Result;
use crate::field::{Jacobian, State, VectorField};

/// One linearisation around the circle.
#[derive(Debug, Clone)]
pub(super) struct Linear<const N: usize> {
    /// From every node to the next.
    pub arcs: Vec<Arc<N>>,
    /// At every node orthonormal columns, the first along the flow.
    frames: Vec<Jacobian<N>>,
    /// The maps from plane to plane in these frames; the first row and column, of the flow's direction, are zero.
    pub maps: Vec<Jacobian<N>>,
    /// By arc: end minus next node; g / (n . g) and 1 / (n . g), with g the field at the end and n the next node's normal.
    pub gaps: Vec<State<N>>,
    inflow: Vec<State<N>>,
    slowness: Vec<f64>,
}

impl<const N: usize> Linear<N> {
    /// With the derivatives in the parameters where asked for.
    pub fn new(
        tracer: &mut Tracer<N>,
        field: &dyn VectorField<N>,
        polygon: &Polygon<N>,
        parameters: bool,
    ) -> Result<Self> {
        let count = polygon.nodes.len();
        let frames: Vec<_> = polygon.nodes.iter().map(|x| frame(&field.f(x))).collect();
        let mut linear = Linear {
            arcs: Vec::with_capacity(count),
            frames,
            maps: Vec::with_capacity(count),
            gaps: Vec::with_capacity(count),
            inflow: Vec::with_capacity(count),
            slowness: Vec::with_capacity(count),
        };
        for (k, (x, &duration)) in polygon.nodes.iter().zip(&polygon.durations).enumerate() {
            let arc = tracer.arc(field, x, duration, parameters)?;
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
            linear.gaps.push(arc.end - polygon.nodes[next]);
            linear.inflow.push(inflow);
            linear.slowness.push(slowness);
            linear.arcs.push(arc);
        }
        Ok(linear)
    }

    /// The part of a gap before node k + 1 that the planes see, in the frame there.
    fn seen(&self, k: usize, gap: &State<N>) -> State<N> {
        let onto = &self.frames[(k + 1) % self.frames.len()];
        let across = gap - self.inflow[k] * onto.column(0).dot(gap);
        let mut seen = onto.tr_mul(&across);
        seen[0] = 0.0;
        seen
    }

    /// What a unit of ln V_H adds to the gaps.
    pub fn in_log_driving(&self, log_driving: f64) -> Vec<State<N>> {
        let driving = log_driving.exp();
        self.arcs
            .iter()
            .map(|arc| arc.parameters[0] * driving)
            .collect()
    }

    /// The corrections of all nodes and durations that close these gaps.
    pub fn correction(&self, gaps: &[State<N>]) -> Option<(Vec<State<N>>, Vec<f64>)> {
        let count = self.frames.len();
        let seen: Vec<_> = (0..count).map(|k| self.seen(k, &gaps[k])).collect();
        let u = cyclic::solve(&self.maps, &seen)?;
        let nodes: Vec<State<N>> = (0..count).map(|k| self.frames[k] * u[k]).collect();
        let durations = (0..count).map(|k| {
            let normal = self.frames[(k + 1) % count].column(0).into_owned();
            let arrival = self.arcs[k].tangent * nodes[k] + gaps[k];
            -normal.dot(&arrival) * self.slowness[k]
        });
        let durations = durations.collect();
        Some((nodes, durations))
    }
}

/// Orthonormal columns, the first along f: the reflection that takes the first axis there.
fn frame<const N: usize>(f: &State<N>) -> Jacobian<N> {
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
