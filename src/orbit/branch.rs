//! Branches of periodic orbits from Hopf points, and the orbits on them at a wanted V_H.

use super::arc::Tracer;
use super::continuation_point::ContinuationPoint;
use super::correct::Corrector;
use super::family::OverLoadings;
use super::find::SEARCH;
use super::hopf::{HopfPoint, hopf_points};
use super::interface_system::InterfaceSystem;
use super::orbit_curve::{Palc, PalcSettings, WatchedFunction};
use super::shooting::close;
use super::shooting_nodes::ShootingNodes;
use super::space::{Space, space_of};
use crate::continuation::Met;
use crate::equilibrium::Symmetry;
use crate::error::Result;
use crate::model::{DRIVING, Parameter};
use std::ops::ControlFlow::{Break, Continue};

/// Below this extent the square of the amplitude is taken to change in proportion with the parameter, and no smaller orbits
/// are asked for: their nodes' planes would miss them.
const SMALL: f64 = 0.2;
/// What is left of the square of the amplitude after a step towards a Hopf point, at most: nodes that have been moved along the orbit show its
/// extent but roughly.
const SHRINKS: f64 = 0.95;
/// The longest step and the number of steps on a branch.
const LONGEST: f64 = 0.5;
const STEPS: usize = 400;
/// How far beyond the wanted ln V_H a branch is followed, in its distance from the Hopf point and absolutely.
const BEYOND: f64 = 2.0;

impl<'c, 'f> Palc<'c, 'f> {
    /// Where the amplitude becomes zero by its last two values, in the coordinate of the free parameter, if the orbits shrink
    /// to an equilibrium.
    fn vanishes(&self, before: &ContinuationPoint) -> Option<f64> {
        let here = &self.now.here.site;
        let free = *self.curve.settings.free.first()?;
        let (old, new) = (before.shooting.extent(), here.shooting.extent());
        let (old, new) = (old * old, new * new);
        let shrinks = new < SMALL * SMALL && new < SHRINKS * old;
        let slope = (here.at[free] - before.at[free]) / (old - new);
        shrinks.then_some(here.at[free] + slope * new)
    }

    /// Which of these Hopf points the branch is about to end at. `before` is where the last step began, with the same nodes.
    pub fn ends_at(&self, before: &ContinuationPoint, hopfs: &[HopfPoint]) -> Option<usize> {
        let free = *self.curve.settings.free.first()?;
        let coordinates: Vec<f64> = hopfs.iter().map(|hopf| hopf.at()[free]).collect();
        self.ends_at_coordinate(before, &coordinates)
    }

    /// The same by the coordinates of the Hopf points.
    pub fn ends_at_coordinate(&self, before: &ContinuationPoint, hopfs: &[f64]) -> Option<usize> {
        /// What the prediction may err by: part of the way that is left, and rounding.
        const PART: f64 = 0.2;
        const ROUNDING: f64 = 1e-6;
        let end = self.vanishes(before)?;
        let here = self.now.here.site.at[*self.curve.settings.free.first()?];
        let near = |hopf: &f64| (end - hopf).abs() < PART * (here - hopf).abs() + ROUNDING;
        hopfs.iter().position(near)
    }
}

/// The closed orbits at the slab's V_H on the branches from the Hopf points of a symmetry, the nearest Hopf point first. The
/// search ends with the first branch that has one.
pub(super) fn from_hopf(
    slab: &InterfaceSystem,
    symmetry: Symmetry,
    space: &dyn Space,
    tracer: &mut Tracer,
) -> Result<Vec<ShootingNodes>> {
    let mut found = Vec::new();
    let hopfs = hopf_points(slab, symmetry, Parameter::Driving)?;
    let family = OverLoadings::new(*slab, symmetry);
    for hopf in &hopfs {
        follow(&family, space, tracer, (hopf, &hopfs), &mut found)?;
        if !found.is_empty() {
            break;
        }
    }
    Ok(found)
}

/// Follows one branch, and closes an orbit wherever it passes the slab's V_H.
fn follow(
    family: &OverLoadings,
    space: &dyn Space,
    tracer: &mut Tracer,
    (hopf, hopfs): (&HopfPoint, &[HopfPoint]),
    found: &mut Vec<ShootingNodes>,
) -> Result<()> {
    /// Tolerance of the continuation.
    const ROUGH: f64 = 1e-10;
    let wanted = family.slab.loading.driving.ln();
    let begin = hopf.at()[0];
    let reach = BEYOND + 2.0 * (wanted - begin).abs();
    let mut corrector = Corrector::by(family, Tracer::limited(ROUGH, SEARCH, SEARCH)?);
    let Ok(mut palc) = Palc::from_hopf(
        &mut corrector,
        PalcSettings::branch(DRIVING, LONGEST),
        &hopf.small_orbits(family),
    ) else {
        return Ok(());
    };
    let passing = [WatchedFunction::Value(DRIVING, wanted)];
    palc.follow(&passing, STEPS, &mut |palc, before, met| {
        if let Met::Zero(_, at) = met {
            let guess = at.here.site.shooting.clone();
            if let Ok(closed) = close(tracer, space.field(), guess) {
                found.push(closed.shooting);
            }
            return Continue(());
        }
        let (old, new) = (&before.here.site, &palc.now.here.site);
        let far = (new.at[DRIVING] - begin).abs() > reach;
        if far || palc.ends_at(old, hopfs).is_some() {
            Break(())
        } else {
            Continue(())
        }
    })?;
    Ok(())
}

/// The period of the first orbit found at the slab's V_H on branches from Hopf points.
pub fn period_from_hopf(slab: &InterfaceSystem, symmetry: Symmetry) -> Result<Option<f64>> {
    const TOLERANCE: f64 = 1e-10;
    let space = space_of(slab, symmetry);
    let orbits = from_hopf(slab, symmetry, &*space, &mut Tracer::taylor(TOLERANCE)?)?;
    Ok(orbits.first().map(|orbit| orbit.period()))
}
