//! Curves of bifurcations of periodic orbits in the plane of two parameters: folds, period doublings, torus bifurcations and pitchforks.
//!
//! Curves of orbits that have in common a value of a function of the user's, as the period, are followed in the same way.
//!
//! They begin at the bifurcations on branches along one parameter at a few values of the other, and are followed both ways with both free: past their
//! tops, through resonances, to where the bifurcation ceases to be one.

use super::branches::orbits;
use super::chart::Chart;
use super::curve::through;
use super::half_curve::CurvesOfKind;
use super::orbit_point::pass;
use crate::bifurcation::Label;
use crate::bifurcation::general::curves::{in_order, looked_along, scanned};
use crate::bifurcation::general::{
    GeneralBranch, GeneralCurve, GeneralEvent, GeneralObserver, GeneralSolution, SAME, Teller,
};
use crate::equilibrium::Symmetry;
use crate::error::Result;
use crate::orbit::{ContinuationPoint, TestFunction};
use std::ops::ControlFlow::Continue;

/// Bifurcations of orbits on branches along the first parameter that are found otherwise than by following all branches there are.
pub trait OrbitSeeds: Sync {
    /// The coordinates of the second parameter at which there are such branches.
    fn values(&self) -> &[f64];

    /// The bifurcations of orbits of a symmetry at one of them.
    ///
    /// # Errors
    /// Those of the branches.
    fn at(
        &self,
        held: f64,
        symmetry: Symmetry,
        test_function: TestFunction,
    ) -> Result<Vec<ContinuationPoint>>;

    /// Does some work, while what it is going to ask for of orbits of a symmetry may be looked for beside it.
    fn beside(&self, symmetry: Symmetry, work: &mut dyn FnMut());
}

/// Follows all curves of this bifurcation of orbits, or of those at which the first of the user's functions vanishes, through the ranges and hands on what is found: of two equal parts first those of symmetric orbits.
///
/// Where there are several cores both halves of a curve are followed side by side; from a thread of a rayon pool all is done on that thread. What is
/// found, and its order, do not depend on this.
///
/// # Errors
/// Those of the orbits; [`crate::Error::TooManyPoints`]; [`crate::Error::Dimension`] where orbits of the system do not have the bifurcation. That a curve
/// ends early is none: it is told as `MX`.
pub fn orbit_curves(
    curve: &GeneralCurve<'_>,
    test_function: Option<TestFunction>,
    seen: GeneralObserver<'_>,
) -> Result<()> {
    let mut teller = Teller::new(seen, &curve.following);
    let mut curves = OrbitCurves {
        curve,
        test_function,
        count: 0,
        known: Vec::new(),
    };
    for chart in charts(curve, test_function) {
        if let Some(test_function) = test_function {
            test_function.checked(chart.family().dimension())?;
        }
        curves.of_chart(chart, &mut teller)?;
    }
    teller.end()
}

/// The variables of the orbits that have a bifurcation.
pub(super) fn charts<'a>(
    curve: &GeneralCurve<'a>,
    test_function: Option<TestFunction>,
) -> Vec<Chart<'a>> {
    let system = &curve.system;
    if system.alike.is_none() {
        return vec![Chart::whole(system)];
    }
    let all: &[Symmetry] = match test_function {
        Some(TestFunction::Transverse) => &[Symmetry::Symmetric],
        Some(TestFunction::Fold) | None => &[Symmetry::Symmetric, Symmetry::Asymmetric],
        _ => &[Symmetry::Asymmetric],
    };
    let wanted = |one: &&Symmetry| curve.symmetry.is_none_or(|only| only == **one);
    let has = all.iter().filter(|one| system.has(**one)).filter(wanted);
    has.map(|one| Chart::of(system, *one)).collect()
}

/// A bifurcation on a branch, and whether its orbit is symmetric.
type Seed = (Symmetry, ContinuationPoint);

/// All curves of a bifurcation, and the bifurcations on branches.
struct OrbitCurves<'c, 'a> {
    curve: &'c GeneralCurve<'a>,
    test_function: Option<TestFunction>,
    count: usize,
    /// The bifurcations along one of the coordinates at a value of the other one.
    known: Vec<((usize, f64), Vec<Seed>)>,
}

impl<'a> OrbitCurves<'_, 'a> {
    fn of_chart(&mut self, chart: Chart<'a>, teller: &mut Teller<'_>) -> Result<()> {
        let curve = self.curve;
        if let Some(seeds) = curve.seeds {
            let symmetry = chart.symmetry().unwrap_or(Symmetry::Asymmetric);
            let mut followed = Ok(());
            seeds.beside(symmetry, &mut || {
                let kind = CurvesOfKind::new(curve, self.test_function, chart, 1, seeds.values());
                followed = self.all(&kind, teller);
            });
            return followed;
        }
        for along in [0, 1] {
            let held = 1 - along;
            let given = curve.orbit.iter().map(|orbit| orbit.at[held]);
            let scan: Vec<f64> = given.chain(scanned(curve, held)).collect();
            let kind = CurvesOfKind::new(curve, self.test_function, chart, held, &scan);
            self.all(&kind, teller)?;
            // Branches of orbits take seconds: they are followed along the second coordinate only where a curve may lie along it.
            if self.count > 0 {
                break;
            }
        }
        Ok(())
    }

    /// The curves that pass the values of a coordinate, each once.
    fn all(&mut self, kind: &CurvesOfKind<'_, 'a>, teller: &mut Teller<'_>) -> Result<()> {
        let mut passes: Vec<[f64; 3]> = Vec::new();
        for &held in &kind.scan {
            for seed in self.seeds(kind, held)? {
                let here = pass(&seed);
                let near = |pass: &[f64; 3]| (0..3).all(|i| (pass[i] - here[i]).abs() < SAME);
                if passes.iter().any(near) {
                    continue;
                }
                passes.push(here);
                if let Some(more) = through(kind, self.count, seed, teller)? {
                    self.count += 1;
                    passes.extend(more);
                }
                if teller.told.is_break() {
                    return Ok(());
                }
            }
        }
        Ok(())
    }

    /// The bifurcations at a value of the coordinate that is held, in the variables of the curves.
    fn seeds(&mut self, kind: &CurvesOfKind<'_, 'a>, held: f64) -> Result<Vec<ContinuationPoint>> {
        let symmetry = kind.chart.symmetry();
        if let (Some(seeds), Some(test_function)) = (self.curve.seeds, self.test_function) {
            let symmetry = symmetry.unwrap_or(Symmetry::Asymmetric);
            return seeds.at(held, symmetry, test_function);
        }
        let place = (1 - kind.held, held);
        if !self.known.iter().any(|(there, _)| *there == place) {
            let seeds = self.look_along(place)?;
            self.known.push((place, seeds));
        }
        let there = self.known.iter().filter(|(there, _)| *there == place);
        let all = there.flat_map(|(_, seeds)| seeds);
        let own = all.filter(|(own, _)| symmetry.is_none_or(|wanted| wanted == *own));
        Ok(own.map(|(_, site)| kind.chart.own(site)).collect())
    }

    /// The bifurcations along a coordinate at a value of the other one.
    fn look_along(&self, (along, held): (usize, f64)) -> Result<Vec<Seed>> {
        let wanted = match self.test_function {
            Some(TestFunction::Fold) => Label::Sn,
            Some(TestFunction::Doubling) => Label::Pd,
            Some(TestFunction::Transverse) => Label::Pf,
            Some(_) => Label::Tr,
            None => Label::Uf,
        };
        let mut found = Vec::new();
        looked_along(self.curve, along, held, |branch| {
            let given = self.curve.orbit.clone();
            let given = given.filter(|orbit| orbit.at[1 - along] == held);
            let branch = GeneralBranch {
                orbit: given.map(|orbit| ContinuationPoint {
                    at: in_order(along, orbit.at),
                    ..orbit
                }),
                watch: match self.test_function {
                    None => self.curve.watch.iter().take(1).cloned().collect(),
                    Some(_) => Vec::new(),
                },
                ..branch.clone()
            };
            orbits(&branch, &mut |event| {
                if let GeneralEvent::Row(point) = event
                    && point.label == Some(wanted)
                {
                    let symmetry = point.symmetry.unwrap_or_else(|| point.solution.symmetry());
                    if let GeneralSolution::Orbit { shooting, .. } = point.solution {
                        let at = in_order(along, point.at);
                        found.push((symmetry, ContinuationPoint { shooting, at }));
                    }
                }
                Continue(())
            })
        })?;
        Ok(found)
    }
}
