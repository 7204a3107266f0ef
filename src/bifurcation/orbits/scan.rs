//! Where curves of bifurcations begin: the bifurcations along branches at a few values of K, found once for all kinds of curves
//! that are wanted.

use super::chart::Chart;
use super::detect::Watch;
use super::follow::{Met, follow};
use crate::equilibrium::Symmetry;
use crate::error::Result;
use crate::model::Parameter;
use crate::orbit::{
    Corrector, HopfPoint, Indicator, OverLoadings, Path, Site, Slab, Tracer, Walk, hopf_points,
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
pub(super) struct Scan<const N: usize> {
    slab: Slab,
    driving: (f64, f64),
    symmetry: Symmetry,
    /// What is looked for.
    indicators: Vec<Indicator>,
    /// What has been found, at these K.
    found: Vec<(f64, Vec<(Indicator, Site<N>)>)>,
}

impl<const N: usize> Scan<N>
where
    OverLoadings: Chart<N>,
{
    pub fn new(slab: Slab, driving: (f64, f64), symmetry: Symmetry) -> Self {
        Scan {
            slab,
            driving,
            symmetry,
            indicators: Vec::new(),
            found: Vec::new(),
        }
    }

    /// Looks for this too.
    pub fn also(&mut self, indicator: Indicator) {
        if !self.indicators.contains(&indicator) {
            self.indicators.push(indicator);
        }
    }

    /// The bifurcations of one kind at this K.
    pub fn at(&mut self, stiffness: f64, indicator: Indicator) -> Result<Vec<Site<N>>> {
        if !self.found.iter().any(|found| found.0 == stiffness) {
            let here = self.all_at(stiffness)?;
            self.found.push((stiffness, here));
        }
        let here = self.found.iter().filter(|found| found.0 == stiffness);
        let of_kind = here
            .flat_map(|found| &found.1)
            .filter(|one| one.0 == indicator);
        Ok(of_kind.map(|one| one.1.clone()).collect())
    }

    fn all_at(&self, stiffness: f64) -> Result<Vec<(Indicator, Site<N>)>> {
        let slab = self.slab.of_stiffness(stiffness);
        let (mut found, mut reached) = (Vec::new(), Vec::new());
        let hopfs = hopf_points(&slab, self.symmetry, Parameter::Driving)?;
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
        slab: &Slab,
        (i, hopfs): (usize, &[HopfPoint]),
        reached: &mut Vec<usize>,
        found: &mut Vec<(Indicator, Site<N>)>,
    ) -> Result<()> {
        let family = OverLoadings(*slab);
        let (from, to) = (self.driving.0.ln(), self.driving.1.ln());
        let inside = |site: &Site<N>| (from..=to).contains(&site.at[0]);
        // On to the other Hopf point of the branch, or the whole branch would be followed from there too.
        let last_one = i + 1 == hopfs.len();
        let tracer = Tracer::limited(TOLERANCE, WORK, WORK)?;
        let mut corrector = Corrector::<_, N>::by(&family, tracer);
        let path = Path::branch(0, LONGEST);
        let Ok(mut walk) = Walk::from_hopf(&mut corrector, path, &hopfs[i]) else {
            return Ok(());
        };
        let mut been = (from..=to).contains(&hopfs[i].at()[0]);
        let watches: Vec<Watch> = self.indicators.iter().map(|&i| watch(i)).collect();
        follow(
            &mut walk,
            &watches,
            STEPS,
            &mut |walk, before, met| match met {
                Met::Zero(met, at) => {
                    let pitchfork = family.merges(&walk.pace.here.site, &before.here.site);
                    let indicator = indicator(met);
                    let is_one = match indicator {
                        Indicator::Torus => at.spectrum.trace.abs() < 2.0,
                        Indicator::Fold => !pitchfork,
                        _ => true,
                    };
                    if is_one && inside(&at.site) {
                        found.push((indicator, at.site.clone()));
                    }
                    Continue(())
                }
                Met::Orbit(pace) => {
                    let here = &pace.here.site;
                    let left = been && !inside(here);
                    been |= inside(here);
                    let end = walk.ends_at(&before.here.site, hopfs);
                    reached.extend(end);
                    let merged = family.merges(here, &before.here.site);
                    if left && last_one || end.is_some() || merged {
                        Break(())
                    } else {
                        Continue(())
                    }
                }
            },
        )?;
        Ok(())
    }
}

/// Along a branch a fold is a turn of V_H.
fn watch(indicator: Indicator) -> Watch {
    match indicator {
        Indicator::Fold => Watch::Turn(0),
        other => Watch::Indicator(other),
    }
}

fn indicator(watch: Watch) -> Indicator {
    match watch {
        Watch::Indicator(indicator) => indicator,
        _ => Indicator::Fold,
    }
}
