//! Hopf points of a slab along V_H, and the small orbits beside them.

use super::polygon::Polygon;
use super::slab::Slab;
use crate::equilibrium::{Equilibrium, Solver, Symmetry, stability, steady_states};
use crate::error::Result;
use crate::field::{State, VectorField};
use crate::model::{Loading, Parameter};

/// A Hopf point.
#[derive(Debug, Clone)]
pub struct HopfPoint {
    /// V_H.
    pub driving: f64,
    /// K.
    pub stiffness: f64,
    /// The equilibrium there.
    pub equilibrium: Equilibrium,
    /// The imaginary part of the pair that crosses.
    pub frequency: f64,
}

/// Between which values of a parameter Hopf points are looked for, and how many are tried.
const DRIVINGS: (f64, f64) = (1e-4, 1e7);
const STIFFNESSES: (f64, f64) = (1e-6, 1e3);
const TRIED: usize = 400;
/// Bisections of an interval: to the last digits of the logarithm.
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

/// All Hopf points of equilibria of this symmetry along a parameter, the other one that of the slab; the nearest to the slab's
/// own first.
///
/// # Errors
/// Those of [`steady_states`] and [`stability`].
pub fn hopf_points(slab: &Slab, symmetry: Symmetry, along: Parameter) -> Result<Vec<HopfPoint>> {
    let there = |log: f64| match along {
        Parameter::Driving => slab.driven_at(log.exp()),
        Parameter::Stiffness => slab.of_stiffness(log.exp()),
    };
    let at = |log: f64| oscillation(&there(log), symmetry);
    let ((from, to), own) = match along {
        Parameter::Driving => (DRIVINGS, slab.loading.driving),
        Parameter::Stiffness => (STIFFNESSES, slab.loading.stiffness),
    };
    let (from, to) = (from.ln(), to.ln());
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
            let middle = 0.5 * (left + right);
            if let Some((equilibrium, _, frequency)) = at(middle)? {
                let Loading { driving, stiffness } = there(middle).loading;
                points.push((
                    middle,
                    HopfPoint {
                        driving,
                        stiffness,
                        equilibrium,
                        frequency,
                    },
                ));
            }
        }
        last = here;
    }
    let far = |log: f64| (log - own.ln()).abs();
    points.sort_by(|a, b| far(a.0).total_cmp(&far(b.0)));
    Ok(points.into_iter().map(|(_, point)| point).collect())
}

impl HopfPoint {
    /// The coordinates (ln V_H, ln K).
    pub fn at(&self) -> [f64; 2] {
        [self.driving.ln(), self.stiffness.ln()]
    }

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
