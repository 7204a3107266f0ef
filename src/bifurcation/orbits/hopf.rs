//! Hopf points, at which branches of orbits begin.

use super::chart::Chart;
use crate::bifurcation::Label;
use crate::bifurcation::general::equilibria::EquilibriumBranches;
use crate::bifurcation::general::{
    FREE, GeneralBranch, GeneralPoint, GeneralSolution, GeneralSystem, SAME,
};
use crate::equilibrium::Symmetry;
use crate::error::Result;
use crate::orbit::SmallOrbits;
use std::f64::consts::TAU;
use std::ops::ControlFlow::Continue;

/// A Hopf point with the small orbits beside it.
pub type HopfBeginning = (SmallOrbits, GeneralPoint);

/// The Hopf points on equilibria in the range or, where there are none and no orbit is given, beyond it.
pub(super) fn hopfs_on_equilibria(branch: &GeneralBranch<'_>) -> Result<Vec<HopfBeginning>> {
    // Those are functions of orbits.
    let branch = &GeneralBranch {
        watch: Vec::new(),
        ..branch.clone()
    };
    let hopfs = hopf_points(branch)?;
    if !hopfs.is_empty() || branch.orbit.is_some() {
        return Ok(hopfs);
    }
    // What is not known there is no reason to fail: it was not asked for.
    let beyond = hopf_points(&GeneralBranch {
        range: branch.beyond,
        ..branch.clone()
    });
    Ok(beyond.unwrap_or_default())
}

/// The Hopf points on all equilibria, by their coordinate, each once; as they are told of.
fn hopf_points(branch: &GeneralBranch<'_>) -> Result<Vec<HopfBeginning>> {
    let mut found: Vec<HopfBeginning> = Vec::new();
    EquilibriumBranches::new(branch).all(&mut |point, _| {
        if let (Some(Label::Hb), Some(period)) = (point.label, point.period)
            && let GeneralSolution::Equilibrium { state, .. } = &point.solution
        {
            let frequency = TAU / period.value;
            let field = branch.system.family.field(point.at);
            let hopf = SmallOrbits::of(&field, state.clone(), point.at, frequency);
            let place = |hopf: &SmallOrbits| branch.system.representative(&hopf.state);
            let here = place(&hopf);
            let same = |other: &SmallOrbits| {
                (other.frequency / hopf.frequency - 1.0).abs() < SAME
                    && (other.at[FREE] - hopf.at[FREE]).abs() < SAME
                    && (place(other) - &here).amax() < SAME * (1.0 + here.amax())
            };
            if !found.iter().any(|(other, _)| same(other)) {
                found.push((hopf, point));
            }
        }
        Continue(())
    })?;
    found.sort_by(|a, b| a.0.at[FREE].total_cmp(&b.0.at[FREE]));
    Ok(found)
}

/// The Hopf points at equilibria of this symmetry, with small orbits in its variables.
pub(super) fn of_symmetry(
    system: &GeneralSystem<'_>,
    all: &[HopfBeginning],
    symmetry: Symmetry,
) -> Vec<HopfBeginning> {
    let chart = Chart::of(system, symmetry);
    let own = all
        .iter()
        .filter(|(_, point)| point.solution.symmetry() == symmetry);
    let in_chart = |(hopf, point): &HopfBeginning| {
        let small = match symmetry {
            Symmetry::Symmetric => {
                let state = hopf.state.rows(0, chart.family().dimension()).into_owned();
                let field = chart.family().field(hopf.at);
                SmallOrbits::of(&field, state, hopf.at, hopf.frequency)
            }
            Symmetry::Asymmetric => hopf.clone(),
        };
        (small, point.clone())
    };
    own.map(in_chart).collect()
}
