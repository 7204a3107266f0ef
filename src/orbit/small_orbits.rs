//! The small orbits beside a Hopf point, with which a branch of orbits begins.

use super::conditions::Condition;
use super::continuation_point::{ContinuationPoint, TangentVector};
use super::correct::Corrector;
use super::goal::Goal;
use super::orbit_curve::{Palc, PalcSettings};
use super::shooting_nodes::ShootingNodes;
use super::switch::Switch;
use crate::error::Result;
use crate::field::Vector;
use crate::integrate::AnyField;
use crate::number::eigenvector;
use nalgebra::Complex;
use std::f64::consts::TAU;

/// An equilibrium with a pair of eigenvalues on the imaginary axis.
#[derive(Debug, Clone)]
pub struct SmallOrbits {
    /// The equilibrium.
    pub state: Vector,
    /// The coordinates of the parameters.
    pub at: [f64; 2],
    /// omega of the pair.
    pub frequency: f64,
    /// A vector of the plane in which the linearised system turns.
    pub along: Vector,
}

/// Nodes of a small orbit, and its size where the branch begins; a part of that where the orbits are not yet ellipses, down to the least.
const NODES: usize = 12;
const FIRST: f64 = 0.02;
const SMALLER: f64 = 0.5;
const LEAST: f64 = 1e-6;

impl SmallOrbits {
    /// Of an equilibrium with this pair. Where the plane is not found, no orbit will be.
    pub fn of(field: &AnyField<'_>, state: Vector, at: [f64; 2], frequency: f64) -> Self {
        let q = eigenvector(&field.jacobian(&state), Complex::new(0.0, frequency));
        let along = q.map_or_else(
            || Vector::zeros(state.len()),
            |q| {
                // From where the variable that moves most is largest.
                let largest = q[q.map(|z| z.norm()).imax()];
                let turned = largest.conj() / largest.norm();
                q.map(|z| (z * turned).re)
            },
        );
        SmallOrbits {
            along,
            state,
            at,
            frequency,
        }
    }

    /// The ellipse of this size on which the linearised system turns, which is the first prediction of an orbit, and the direction in which
    /// it grows.
    pub(crate) fn ellipse(&self, field: &AnyField<'_>, size: f64) -> Switch {
        let along = &self.along;
        let across = field.jacobian(&self.state) * along / self.frequency;
        let scale = size / along.amax().max(across.amax());
        let turn = TAU / NODES as f64;
        let moved = |k: usize| {
            let (sin, cos) = (turn * k as f64).sin_cos();
            (along * cos + &across * sin) * scale
        };
        let outwards = TangentVector {
            nodes: (0..NODES).map(moved).collect(),
            durations: vec![0.0; NODES],
            parameters: [0.0; 2],
        };
        let shooting = ShootingNodes {
            nodes: outwards.nodes.iter().map(|x| &self.state + x).collect(),
            durations: vec![turn / self.frequency; NODES],
        };
        let site = ContinuationPoint {
            shooting,
            at: self.at,
        };
        (site, outwards)
    }
}

impl<'c, 'f> Palc<'c, 'f> {
    /// Along the branch of a Hopf point, from a small orbit outwards.
    ///
    /// # Errors
    /// [`crate::Error::NotConverged`] where even the smallest orbit is not found.
    pub fn from_hopf(
        corrector: &'c mut Corrector<'f>,
        settings: PalcSettings,
        hopf: &SmallOrbits,
    ) -> Result<Self> {
        let mut size = FIRST;
        loop {
            let (site, outwards) = hopf.ellipse(&corrector.family.field(hopf.at), size);
            let conditions = settings.and(Condition::Plane(&outwards, &site));
            let found = corrector.correct(site.clone(), &settings.free, &conditions, Goal::STEP);
            match found {
                Err(error) if size < LEAST => return Err(error),
                Err(_) => size *= SMALLER,
                Ok(found) => {
                    // Of a thin ellipse planes are cut at any angle.
                    let outwards = corrector.in_planes(&found, &outwards);
                    return Palc::at(corrector, settings, found, &outwards);
                }
            }
        }
    }
}
