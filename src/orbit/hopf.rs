//! Hopf points of a slab along V_H, and the small orbits beside them.

use super::polygon::Polygon;
use super::slab::Slab;
use crate::equilibrium::{Equilibrium, Solver, Symmetry, stability, steady_states};
use crate::error::Result;
use crate::field::{State, VectorField};

/// A Hopf point.
#[derive(Debug, Clone)]
pub(super) struct HopfPoint {
    /// V_H.
    pub driving: f64,
    /// The equilibrium there.
    pub equilibrium: Equilibrium,
    /// The imaginary part of the pair that crosses.
    pub frequency: f64,
}

/// Velocities between which Hopf points are looked for, and how many are tried.
const SLOWEST: f64 = 1e-4;
const FASTEST: f64 = 1e7;
const TRIED: usize = 400;
/// Bisections of an interval: to the last digits of ln V_H.
const BISECTIONS: usize = 60;

/// The equilibrium of a symmetry with its oscillatory pair of eigenvalues, where it has one. Of several asymmetric ones that
/// of the largest stress.
fn oscillation(slab: &Slab, symmetry: Symmetry) -> Result<Option<(Equilibrium, f64, f64)>> {
    let states = steady_states(
        &slab.law,
        slab.loading.driving,
        slab.interfaces,
        Solver::Newton,
    )?;
    let wanted = states
        .equilibria
        .into_iter()
        .find(|e| e.symmetry == symmetry);
    let Some(equilibrium) = wanted else {
        return Ok(None);
    };
    let eigenvalues = stability(&slab.law, &equilibrium, slab.loading.stiffness)?.eigenvalues;
    let pair = eigenvalues.into_iter().find(|z| z.im > 0.0);
    Ok(pair.map(|z| (equilibrium, z.re, z.im)))
}

/// All Hopf points of equilibria of this symmetry along V_H at the slab's stiffness, the nearest to its V_H first.
pub(super) fn hopf_points(slab: &Slab, symmetry: Symmetry) -> Result<Vec<HopfPoint>> {
    let at = |log: f64| oscillation(&slab.driven_at(log.exp()), symmetry);
    let (from, to) = (SLOWEST.ln(), FASTEST.ln());
    let grid = (0..=TRIED).map(|i| from + (to - from) * i as f64 / TRIED as f64);
    let mut points = Vec::new();
    let mut last: Option<(f64, f64)> = None;
    for log in grid {
        let here = at(log)?.map(|(_, growth, _)| (log, growth));
        if let (Some((left, before)), Some((right, after))) = (last, here)
            && before * after < 0.0
        {
            let (mut left, mut right) = (left, right);
            for _ in 0..BISECTIONS {
                let middle = 0.5 * (left + right);
                match at(middle)? {
                    Some((_, growth, _)) if growth * before > 0.0 => left = middle,
                    _ => right = middle,
                }
            }
            if let Some((equilibrium, _, frequency)) = at(0.5 * (left + right))? {
                points.push(HopfPoint {
                    driving: (0.5 * (left + right)).exp(),
                    equilibrium,
                    frequency,
                });
            }
        }
        last = here;
    }
    let wanted = slab.loading.driving.ln();
    let far = |point: &HopfPoint| (point.driving.ln() - wanted).abs();
    points.sort_by(|a, b| far(a).total_cmp(&far(b)));
    Ok(points)
}

impl HopfPoint {
    /// The ellipse of this size around the equilibrium on which the linearised system turns.
    ///
    /// With the third eigenvalue l the vectors (J - l) v are of the pair's plane, and there J^2 = -omega^2.
    pub fn ellipse<const N: usize>(&self, field: &dyn VectorField<N>, size: f64) -> Polygon<N> {
        /// Nodes.
        const NODES: usize = 12;
        let y = State::<N>::from_fn(|i, _| match i {
            0 => self.equilibrium.stress.value,
            i => self.equilibrium.log_state[i - 1],
        });
        let jacobian = field.jacobian(&y);
        let mut along = State::<N>::from_fn(|i, _| if i == 0 { 1.0 } else { 0.0 });
        if N == 3 {
            // The pair's own trace is zero.
            along = jacobian * along - along * jacobian.trace();
        }
        let across = jacobian * along / self.frequency;
        let scale = size / along.amax().max(across.amax());
        let turn = std::f64::consts::TAU / NODES as f64;
        let nodes = (0..NODES).map(|k| {
            let (sin, cos) = (turn * k as f64).sin_cos();
            y + (along * cos + across * sin) * scale
        });
        Polygon {
            nodes: nodes.collect(),
            durations: vec![turn / self.frequency; NODES],
        }
    }
}
