//! Hopf points of a slab along V_H, and the small orbits beside them.

use super::interface_system::InterfaceSystem;
use super::settle::axis;
use super::shooting_nodes::ShootingNodes;
use crate::equilibrium::{Equilibrium, Solver, Symmetry, eigenvalues, steady_states};
use crate::error::Result;
use crate::field::Vector;
use crate::integrate::AnyField;
use crate::model::{Loading, Parameter};
use nalgebra::Complex;

type C = Complex<f64>;

/// A Hopf point.
#[derive(Debug, Clone)]
#[non_exhaustive]
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

/// The equilibrium of a symmetry with its eigenvalues. Of several asymmetric ones that of the largest stress.
fn spectrum(slab: &InterfaceSystem, symmetry: Symmetry) -> Result<Option<(Equilibrium, Vec<C>)>> {
    let InterfaceSystem {
        law, interfaces, ..
    } = slab;
    let driving = slab.loading.driving;
    let wanted = match symmetry {
        // The others take most of the time.
        Symmetry::Symmetric => Some(Equilibrium::symmetric(law, driving, *interfaces)),
        Symmetry::Asymmetric => {
            let states = steady_states(law, driving, *interfaces, Solver::Newton)?;
            let mut all = states.equilibria.into_iter();
            all.find(|e| e.symmetry == symmetry)
        }
    };
    let Some(equilibrium) = wanted else {
        return Ok(None);
    };
    let eigenvalues = eigenvalues(&slab.law, &equilibrium, slab.loading.stiffness)?;
    Ok(Some((equilibrium, eigenvalues)))
}

/// The product of the sums of all pairs of eigenvalues: it changes its sign at Hopf points also where the pair is soon real
/// again, as it is at small stiffness; and at neutral saddles.
fn sums(eigenvalues: &[C]) -> f64 {
    let mut product = C::from(1.0);
    for (i, a) in eigenvalues.iter().enumerate() {
        for b in &eigenvalues[i + 1..] {
            product *= a + b;
        }
    }
    product.re
}

/// The frequency of the pair on the imaginary axis, if there is one.
fn frequency(eigenvalues: &[C]) -> Option<f64> {
    /// What is left of the real part, over the imaginary one.
    const AXIS: f64 = 1e-5;
    let pair = eigenvalues.iter().find(|z| z.im > 0.0)?;
    (pair.re.abs() < AXIS * pair.im).then_some(pair.im)
}

/// All Hopf points of equilibria of this symmetry along a parameter, the other one that of the slab; the nearest to the slab's
/// own first.
///
/// # Errors
/// Those of [`steady_states`] and [`eigenvalues`].
pub fn hopf_points(
    slab: &InterfaceSystem,
    symmetry: Symmetry,
    along: Parameter,
) -> Result<Vec<HopfPoint>> {
    let there = |log: f64| match along {
        Parameter::Driving => slab.driven_at(log.exp()),
        Parameter::Stiffness => slab.of_stiffness(log.exp()),
    };
    let at = |log: f64| spectrum(&there(log), symmetry);
    let ((from, to), own) = match along {
        Parameter::Driving => (DRIVINGS, slab.loading.driving),
        Parameter::Stiffness => (STIFFNESSES, slab.loading.stiffness),
    };
    let (from, to) = (from.ln(), to.ln());
    let grid = (0..=TRIED).map(|i| from + (to - from) * i as f64 / TRIED as f64);
    let sums_at = |log: f64| -> Result<Option<f64>> {
        Ok(at(log)?.map(|(_, eigenvalues)| sums(&eigenvalues)))
    };
    let mut tried: Vec<(f64, Option<f64>)> = Vec::new();
    for log in grid {
        let here = (log, sums_at(log)?);
        // An equilibrium may have its Hopf point soon after it appears.
        if let Some(&last) = tried.last()
            && last.1.is_some() != here.1.is_some()
        {
            let (mut none, mut some) = if here.1.is_some() {
                (last, here)
            } else {
                (here, last)
            };
            for _ in 0..BISECTIONS {
                let middle = 0.5 * (none.0 + some.0);
                match sums_at(middle)? {
                    None => none.0 = middle,
                    known => some = (middle, known),
                }
            }
            tried.push(some);
        }
        tried.push(here);
    }
    let mut points = Vec::new();
    for pair in tried.windows(2) {
        let [(mut left, Some(before)), (mut right, Some(after))] = [pair[0], pair[1]] else {
            continue;
        };
        if before * after >= 0.0 {
            continue;
        }
        for _ in 0..BISECTIONS {
            let middle = 0.5 * (left + right);
            match sums_at(middle)? {
                Some(sums) if sums * before > 0.0 => left = middle,
                _ => right = middle,
            }
        }
        let middle = 0.5 * (left + right);
        if let Some((equilibrium, eigenvalues)) = at(middle)?
            && let Some(frequency) = frequency(&eigenvalues)
        {
            let Loading { driving, stiffness } = there(middle).loading;
            let point = HopfPoint {
                driving,
                stiffness,
                equilibrium,
                frequency,
            };
            points.push((middle, point));
        }
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
    pub(crate) fn ellipse(&self, field: &AnyField<'_>, size: f64) -> ShootingNodes {
        /// Nodes.
        const NODES: usize = 12;
        let dimension = field.dimension();
        let y = Vector::from_fn(dimension, |i, _| match i {
            0 => self.equilibrium.stress.value,
            i => self.equilibrium.log_state[i - 1],
        });
        let jacobian = field.jacobian(&y);
        let mut along = axis(dimension, 0);
        if dimension == 3 {
            // The pair's own trace is zero.
            along = &jacobian * &along - &along * jacobian.trace();
        }
        let across = jacobian * &along / self.frequency;
        let scale = size / along.amax().max(across.amax());
        let turn = std::f64::consts::TAU / NODES as f64;
        let nodes = (0..NODES).map(|k| {
            let (sin, cos) = (turn * k as f64).sin_cos();
            &y + (&along * cos + &across * sin) * scale
        });
        ShootingNodes {
            nodes: nodes.collect(),
            durations: vec![turn / self.frequency; NODES],
        }
    }
}
