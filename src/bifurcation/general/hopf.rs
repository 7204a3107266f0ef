//! Hopf points of any field, and the small orbits beside them.

use crate::error::{Error, Result};
use crate::field::{Matrix, Vector};
use crate::integrate::AnyField;
use crate::number::null_vector;
use crate::orbit::{
    Condition, ContinuationPoint, Corrector, Goal, Palc, PalcSettings, ShootingNodes, TangentVector,
};
use std::f64::consts::TAU;

/// A Hopf point.
#[derive(Debug, Clone)]
pub(super) struct GeneralHopf {
    /// The equilibrium.
    pub state: Vector,
    /// The coordinates of the parameters.
    pub at: [f64; 2],
    /// omega of the pair on the imaginary axis.
    pub frequency: f64,
}

/// Nodes of a small orbit, and its size where the branch begins; a part of that where the orbits are not yet ellipses, down to the least.
const NODES: usize = 12;
const FIRST: f64 = 0.02;
const SMALLER: f64 = 0.5;
const LEAST: f64 = 1e-6;

impl GeneralHopf {
    /// The ellipse of this size on which the linearised system turns: in the plane where J^2 = -omega^2.
    fn ellipse(&self, field: &AnyField<'_>, size: f64) -> Option<ShootingNodes> {
        let jacobian = field.jacobian(&self.state);
        let count = jacobian.nrows();
        let square = &jacobian * &jacobian
            + Matrix::identity(count, count) * (self.frequency * self.frequency);
        let along = null_vector(square)?;
        let across = jacobian * &along / self.frequency;
        let scale = size / along.amax().max(across.amax());
        let turn = TAU / NODES as f64;
        let nodes = (0..NODES).map(|k| {
            let (sin, cos) = (turn * k as f64).sin_cos();
            &self.state + (&along * cos + &across * sin) * scale
        });
        Some(ShootingNodes {
            nodes: nodes.collect(),
            durations: vec![turn / self.frequency; NODES],
        })
    }

    /// Along the branch of orbits, from a small one outwards.
    ///
    /// # Errors
    /// As of [`Palc::from`], for the smallest ones.
    pub fn palc<'c, 'f>(
        &self,
        corrector: &'c mut Corrector<'f>,
        settings: PalcSettings,
    ) -> Result<Palc<'c, 'f>> {
        let mut size = FIRST;
        loop {
            let (site, outwards) = self.beside(&corrector.family.field(self.at), size)?;
            let conditions = settings.and(Condition::Plane(&outwards, &site));
            let found = corrector.correct(site.clone(), &settings.free, &conditions, Goal::STEP);
            match found {
                Err(error) if size < LEAST => return Err(error),
                Err(_) => size *= SMALLER,
                Ok(found) => return Palc::at(corrector, settings, found, &outwards),
            }
        }
    }
    /// The ellipse of this size, which is the first prediction of an orbit, and the direction in which it grows.
    fn beside(
        &self,
        field: &AnyField<'_>,
        size: f64,
    ) -> Result<(ContinuationPoint, TangentVector)> {
        let shooting = self.ellipse(field, size).ok_or(Error::NotConverged {
            what: "the plane of the small orbits beside a Hopf point",
            iterations: 0,
            residual: f64::INFINITY,
            tolerance: 0.0,
        })?;
        let outwards = TangentVector {
            nodes: shooting.nodes.iter().map(|x| x - &self.state).collect(),
            durations: vec![0.0; shooting.nodes.len()],
            parameters: [0.0; 2],
        };
        let site = ContinuationPoint {
            shooting,
            at: self.at,
        };
        Ok((site, outwards))
    }
}
