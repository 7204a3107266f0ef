//! Where curves of bifurcations begin: the bifurcations along branches at a few values of K, found once for all kinds of curves
//! that are wanted.

use super::chart::Chart;
use super::curve::core_to_spare;
use super::loadings::with_system;
use crate::continuation::Met;
use crate::equilibrium::Symmetry;
use crate::error::{Error, Result};
use crate::model::{DRIVING, Parameter};
use crate::orbit::{
    ContinuationPoint, Corrector, DirectedPoint, EquilibriaAlong, HopfPoint, InterfaceSystem, Palc,
    PalcSettings, TestFunction, Tracer, WatchedFunction,
};
use std::ops::ControlFlow::{Break, Continue};
use std::sync::OnceLock;
use std::sync::atomic::{AtomicBool, Ordering};

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
    equilibria: OnceLock<Result<EquilibriaAlong>>,
    /// What is looked for.
    watches: Vec<WatchedFunction>,
    /// What is found, at these K.
    found: Vec<AtStiffness>,
}

/// What is found at one K.
struct AtStiffness {
    stiffness: f64,
    /// Whether a thread is at it, or was.
    begun: AtomicBool,
    found: OnceLock<Result<Vec<Bifurcation>>>,
}

/// What is zero at a point of a branch, and the point.
type Bifurcation = (WatchedFunction, ContinuationPoint);

impl Scan {
    pub fn new(slab: InterfaceSystem, driving: (f64, f64), symmetry: Symmetry) -> Self {
        Scan {
            slab,
            driving,
            symmetry,
            equilibria: OnceLock::new(),
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

    /// Looks at these K too, in this order.
    pub fn along(&mut self, stiffnesses: &[f64]) {
        for &stiffness in stiffnesses {
            if !self.found.iter().any(|there| there.stiffness == stiffness) {
                self.found.push(AtStiffness {
                    stiffness,
                    begun: AtomicBool::new(false),
                    found: OnceLock::new(),
                });
            }
        }
    }

    /// Does `work` while the branches that it is going to ask for are followed beside it, if there is a core to do so.
    pub fn beside<R>(&self, work: impl FnOnce() -> R) -> R {
        let ended = AtomicBool::new(false);
        std::thread::scope(|scope| {
            if core_to_spare() {
                scope.spawn(|| {
                    let mut more = true;
                    while more && !ended.load(Ordering::Relaxed) {
                        more = self.one_more();
                    }
                });
            }
            let done = work();
            ended.store(true, Ordering::Relaxed);
            done
        })
    }

    /// The bifurcations of one kind at one of the K.
    ///
    /// # Panics
    /// At another one.
    pub fn at(
        &self,
        stiffness: f64,
        test_function: TestFunction,
    ) -> Result<Vec<ContinuationPoint>> {
        let is_it = |there: &&AtStiffness| there.stiffness == stiffness;
        let there = self.found.iter().find(is_it).expect("one of the K");
        // Where another thread is at this one, this thread does not wait for it idly.
        if there.begun.swap(true, Ordering::Relaxed) {
            while there.found.get().is_none() && self.one_more() {}
        }
        let found = self.all_at(there).as_ref().map_err(Error::clone)?;
        let of_kind = found.iter().filter(|one| one.0 == watch(test_function));
        Ok(of_kind.map(|one| one.1.clone()).collect())
    }

    /// Looks at the first K at which no thread has; whether there was one.
    fn one_more(&self) -> bool {
        let new = |there: &&AtStiffness| !there.begun.swap(true, Ordering::Relaxed);
        let next = self.found.iter().find(new);
        next.is_some_and(|there| {
            self.all_at(there);
            true
        })
    }

    fn all_at<'s>(&self, there: &'s AtStiffness) -> &'s Result<Vec<Bifurcation>> {
        there.found.get_or_init(|| self.look_at(there.stiffness))
    }

    fn look_at(&self, stiffness: f64) -> Result<Vec<Bifurcation>> {
        let slab = self.slab.of_stiffness(stiffness);
        let (mut found, mut reached) = (Vec::new(), Vec::new());
        let equilibria = self
            .equilibria
            .get_or_init(|| EquilibriaAlong::new(&slab, self.symmetry, Parameter::Driving));
        let equilibria = equilibria.as_ref().map_err(Error::clone)?;
        let hopfs = equilibria.hopf_points(&slab)?;
        with_system((&slab, &[]), Parameter::Driving, |system| {
            let chart = Chart::of(system, self.symmetry);
            for i in 0..hopfs.len() {
                if !reached.contains(&i) {
                    self.branch(chart, (i, &hopfs), &mut reached, &mut found)?;
                }
            }
            Ok(found)
        })
    }

    /// What is found along the branch of a Hopf point, and which other one it reaches.
    fn branch(
        &self,
        chart: Chart<'_>,
        (i, hopfs): (usize, &[HopfPoint]),
        reached: &mut Vec<usize>,
        found: &mut Vec<Bifurcation>,
    ) -> Result<()> {
        let (from, to) = (self.driving.0.ln(), self.driving.1.ln());
        let inside = |site: &ContinuationPoint| (from..=to).contains(&site.at[DRIVING]);
        // On to the other Hopf point of the branch, or the whole branch would be followed from there too.
        let last_one = i + 1 == hopfs.len();
        let tracer = Tracer::limited(TOLERANCE, WORK, WORK)?;
        let mut corrector = Corrector::by(chart.family(), tracer);
        let settings = PalcSettings::branch(DRIVING, LONGEST);
        let beside = hopfs[i].small_orbits(chart.family());
        let Ok(mut palc) = Palc::from_hopf(&mut corrector, settings, &beside) else {
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
