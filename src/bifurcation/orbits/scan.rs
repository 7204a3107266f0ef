//! Where curves of bifurcations begin: the bifurcations along branches at a few values of K, found once for all kinds of curves
//! that are wanted.

use super::chart::Chart;
use crate::continuation::Met;
use crate::equilibrium::Symmetry;
use crate::error::Result;
use crate::model::{DRIVING, Parameter};
use crate::orbit::{
    ContinuationPoint, Corrector, DirectedPoint, EquilibriaAlong, HopfPoint, InterfaceSystem, Palc,
    PalcSettings, TestFunction, Tracer, WatchedFunction,
};
use std::ops::ControlFlow::{Break, Continue};

/// The longest step along a branch.
const LONGEST: f64 = 0.7;
/// Steps on it.
const STEPS: usize = 2000;
/// Steps of the integrator along it, at most.
const WORK: usize = 5_000_000;
/// Its tolerance: what is found is corrected with that of the curves.
const TOLERANCE: f64 = 1e-8;

/// The bifurcations of orbits of one symmetry.
pub(super) struct Scan {
    slab: InterfaceSystem,
    driving: (f64, f64),
    pub symmetry: Symmetry,
    /// Where Hopf points are looked for.
    equilibria: Option<EquilibriaAlong>,
    /// What is looked for.
    watches: Vec<WatchedFunction>,
    /// What has been found, at these K.
    found: Vec<(f64, Vec<(WatchedFunction, ContinuationPoint)>)>,
}

impl Scan {
    pub fn new(slab: InterfaceSystem, driving: (f64, f64), symmetry: Symmetry) -> Self {
        Scan {
            slab,
            driving,
            symmetry,
            equilibria: None,
            watches: Vec::new(),
            found: Vec::new(),
        }
    }

    /// Looks for this too.
    pub fn also(&mut self, test_function: TestFunction) {
        let watch = watch(test_function);
        if !self.watches.contains(&watch) {
            self.watches.push(watch);
        }
    }

    /// The bifurcations of one kind at this K.
    pub fn at(
        &mut self,
        stiffness: f64,
        test_function: TestFunction,
    ) -> Result<Vec<ContinuationPoint>> {
        if !self.found.iter().any(|found| found.0 == stiffness) {
            let here = self.all_at(stiffness)?;
            self.found.push((stiffness, here));
        }
        let here = self.found.iter().filter(|found| found.0 == stiffness);
        let of_kind = here
            .flat_map(|found| &found.1)
            .filter(|one| one.0 == watch(test_function));
        Ok(of_kind.map(|one| one.1.clone()).collect())
    }

    fn all_at(&mut self, stiffness: f64) -> Result<Vec<(WatchedFunction, ContinuationPoint)>> {
        let slab = self.slab.of_stiffness(stiffness);
        let (mut found, mut reached) = (Vec::new(), Vec::new());
        let equilibria = match self.equilibria.take() {
            Some(known) => known,
            None => EquilibriaAlong::new(&slab, self.symmetry, Parameter::Driving)?,
        };
        let hopfs = self.equilibria.insert(equilibria).hopf_points(&slab)?;
        for i in 0..hopfs.len() {
            if !reached.contains(&i) {
                self.branch(&slab, (i, &hopfs), &mut reached, &mut found)?;
            }
        }
        Ok(found)
    }

    /// What is found along the branch of a Hopf point, and which other one it reaches.
    fn branch(
        &self,
        slab: &InterfaceSystem,
        (i, hopfs): (usize, &[HopfPoint]),
        reached: &mut Vec<usize>,
        found: &mut Vec<(WatchedFunction, ContinuationPoint)>,
    ) -> Result<()> {
        let chart = Chart::new(*slab, self.symmetry);
        let (from, to) = (self.driving.0.ln(), self.driving.1.ln());
        let inside = |site: &ContinuationPoint| (from..=to).contains(&site.at[DRIVING]);
        // On to the other Hopf point of the branch, or the whole branch would be followed from there too.
        let last_one = i + 1 == hopfs.len();
        let tracer = Tracer::limited(TOLERANCE, WORK, WORK)?;
        let mut corrector = Corrector::by(chart.family(), tracer);
        let settings = PalcSettings::branch(DRIVING, LONGEST);
        let Ok(mut palc) = Palc::from_hopf(&mut corrector, settings, &hopfs[i]) else {
            return Ok(());
        };
        let mut been = (from..=to).contains(&hopfs[i].at()[0]);
        palc.follow(&self.watches, STEPS, &mut |palc, before, met| match met {
            Met::Zero(watch, DirectedPoint { here: at, .. }) => {
                let pitchfork = chart.merges(&palc.now.here.site, &before.here.site);
                let is_one = match watch {
                    WatchedFunction::TestFunction(TestFunction::Torus) => {
                        at.spectrum.trace.abs() < 2.0
                    }
                    WatchedFunction::Turn(_) => !pitchfork,
                    _ => true,
                };
                if is_one && inside(&at.site) {
                    found.push((watch, at.site.clone()));
                }
                Continue(())
            }
            Met::Point(now) => {
                let here = &now.here.site;
                let left = been && !inside(here);
                been |= inside(here);
                let end = palc.ends_at(&before.here.site, hopfs);
                reached.extend(end);
                let merged = chart.merges(here, &before.here.site);
                if left && last_one || end.is_some() || merged {
                    Break(())
                } else {
                    Continue(())
                }
            }
        })?;
        Ok(())
    }
}

/// Along a branch a fold is a turn of V_H.
fn watch(test_function: TestFunction) -> WatchedFunction {
    match test_function {
        TestFunction::Fold => WatchedFunction::Turn(DRIVING),
        other => WatchedFunction::TestFunction(other),
    }
}
