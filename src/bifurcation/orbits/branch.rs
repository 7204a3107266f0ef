//! Branches of periodic orbits along V_H or K: from every Hopf point, through folds, and where asked for onto the branches of
//! doubled periods.

use super::chart::Chart;
use super::orbit_branch::OrbitBranch;
use crate::bifurcation::{
    BranchRequest, BranchRow, Event, EventObserver, Label, Special, equilibria, within,
};
use crate::equilibrium::Symmetry;
use crate::error::Result;
use crate::number::Uncertain;
use crate::orbit::{
    Corrector, HopfPoint, Palc, PalcSettings, ParametrisedField, Regular, Switch, Tracer,
    hopf_points,
};
use std::ops::ControlFlow::{self, Break, Continue};

/// Tolerance of the continuation.
pub(in crate::bifurcation) const ROUGH: f64 = 1e-11;
/// The longest step.
pub(in crate::bifurcation) const LONGEST: f64 = 0.7;
/// Steps of the integrator along a branch, or both ways along a curve, and on an arc, at most.
pub(in crate::bifurcation) const WORK: usize = 20_000_000;
pub(in crate::bifurcation) const ARC: usize = 100_000;
/// The first step onto a branch that bifurcates.
const ASIDE: f64 = 0.02;
/// Coordinates of bifurcations that differ by less are of the same one.
const SAME: f64 = 1e-6;

/// What makes the orbits of a branch or a curve, its work bounded.
///
/// # Errors
/// Those of [`Tracer::limited`].
pub(super) fn new_corrector(family: &dyn ParametrisedField) -> Result<Corrector<'_>> {
    Ok(Corrector::by(family, Tracer::limited(ROUGH, ARC, WORK)?))
}

/// Follows the branches that are asked for and hands on what is found: from the Hopf points of symmetric equilibria, of
/// asymmetric ones, from pitchforks of orbits that none of these has come to, and from period doublings.
///
/// # Errors
/// Those of [`BranchRequest::checked`], of the equilibria and of the flow; [`Error::TooManyPoints`](crate::Error::TooManyPoints);
/// that a branch ends early is none.
pub fn branch(request: &BranchRequest, seen: EventObserver<'_>) -> Result<()> {
    request.checked()?;
    let wants = |symmetry| request.symmetry.is_none_or(|only| only == symmetry);
    within(request.max_points, seen, |seen| {
        let mut branches = BranchSet::new(request);
        if wants(Symmetry::Symmetric) && branches.symmetric(seen)?.is_break() {
            return Ok(());
        }
        if request.slab.interfaces == 2 && wants(Symmetry::Asymmetric) {
            let _ = branches.asymmetric(seen)?;
        }
        Ok(())
    })
}

/// A period doubling, and how often the period has doubled before it.
pub(super) struct Doubling {
    pub orbit: Regular,
    pub before: usize,
}

/// All branches, and what is known of them so far.
pub(super) struct BranchSet<'r> {
    pub request: &'r BranchRequest,
    /// The free parameter's place and the range of its coordinate.
    pub free: usize,
    pub range: (f64, f64),
    count: usize,
    /// The Hopf points of the symmetry at hand, and whether a branch has come there.
    pub hopfs: Vec<HopfPoint>,
    pub reached: Vec<bool>,
    /// Pitchforks on symmetric branches, and where asymmetric branches have come to one.
    pub pitchforks: Vec<Regular>,
    pub merged: Vec<f64>,
    /// Period doublings, and which of them a branch of doubled orbits has begun or ended at.
    pub doublings: Vec<Doubling>,
    pub visited: Vec<bool>,
    /// The orbits with which branches begin or end at the ends of the range.
    ends: Vec<BranchRow>,
}

impl<'r> BranchSet<'r> {
    fn new(request: &'r BranchRequest) -> Self {
        let (a, b) = (request.range.0.ln(), request.range.1.ln());
        BranchSet {
            request,
            free: request.along.place(),
            range: (a.min(b), a.max(b)),
            count: 0,
            hopfs: Vec::new(),
            reached: Vec::new(),
            pitchforks: Vec::new(),
            merged: Vec::new(),
            doublings: Vec::new(),
            visited: Vec::new(),
            ends: Vec::new(),
        }
    }

    /// Orbits of this symmetry in the usual variables.
    pub fn chart(&self, symmetry: Symmetry) -> Chart {
        Chart::new(self.request.slab, symmetry)
    }

    /// Whether a branch is told of. One that is not is followed all the same: its other end and the branches that begin on it
    /// would be taken for others.
    pub fn tells(&self, branch: usize) -> bool {
        !self.request.skip.contains(&branch)
    }

    pub fn in_range(&self, coordinate: f64) -> bool {
        (self.range.0..=self.range.1).contains(&coordinate)
    }

    /// The branch of this number has a point in the range: the next branch has another number.
    pub fn begins(&mut self, number: usize) {
        self.count = self.count.max(number + 1);
    }

    /// Whether a branch has begun or ended with this orbit at an end of the range; if not, one does so now.
    pub fn is_known_end(&mut self, orbit: BranchRow) -> bool {
        /// Relative difference of the extremes, the mean and the period of one orbit: the run that finds the extremes has this tolerance.
        const ONE: f64 = 1e-6;
        let near = |a: f64, b: f64| (a - b).abs() <= ONE * a.abs().max(b.abs());
        let same = |known: &BranchRow| {
            (known.symmetry, known.driving, known.stiffness)
                == (orbit.symmetry, orbit.driving, orbit.stiffness)
                && near(known.stress, orbit.stress)
                && near(known.stress_range.0, orbit.stress_range.0)
                && near(known.stress_range.1, orbit.stress_range.1)
                && known
                    .period
                    .zip(orbit.period)
                    .is_some_and(|(a, b)| near(a, b))
        };
        let known = self.ends.iter().any(same);
        if !known {
            self.ends.push(orbit);
        }
        known
    }

    fn symmetric(&mut self, seen: EventObserver<'_>) -> Result<ControlFlow<()>> {
        self.all_of(Symmetry::Symmetric, seen)
    }

    fn asymmetric(&mut self, seen: EventObserver<'_>) -> Result<ControlFlow<()>> {
        if self.all_of(Symmetry::Asymmetric, seen)?.is_break() {
            return Ok(Break(()));
        }
        for i in 0..self.pitchforks.len() {
            let here = self.pitchforks[i].site.at[self.free];
            if self.merged.iter().any(|at| (at - here).abs() < SAME) {
                continue;
            }
            self.merged.push(here);
            let Some(switch) = self.pitchforks[i].asymmetric() else {
                continue;
            };
            if self.aside(switch, 0, seen)?.is_break() {
                return Ok(Break(()));
            }
        }
        // The list grows as it is gone through.
        let mut i = 0;
        while i < self.doublings.len() {
            let Doubling { orbit, before } = &self.doublings[i];
            let (switch, times) = (orbit.doubled(), before + 1);
            let new = !self.visited[i];
            self.visited[i] = true;
            i += 1;
            let Some(switch) = switch.filter(|_| new && times <= self.request.doublings) else {
                continue;
            };
            if self.aside(switch, times, seen)?.is_break() {
                return Ok(Break(()));
            }
        }
        Ok(Continue(()))
    }

    fn all_of(&mut self, symmetry: Symmetry, seen: EventObserver<'_>) -> Result<ControlFlow<()>> {
        let free = self.free;
        self.hopfs = hopf_points(&self.request.slab, symmetry, self.request.along)?;
        self.hopfs
            .sort_by(|a, b| a.at()[free].total_cmp(&b.at()[free]));
        self.reached = vec![false; self.hopfs.len()];
        for i in 0..self.hopfs.len() {
            if self.reached[i] {
                continue;
            }
            self.reached[i] = true;
            if self.one_of(i, symmetry, seen)?.is_break() {
                return Ok(Break(()));
            }
        }
        Ok(Continue(()))
    }

    fn settings(&self) -> PalcSettings {
        PalcSettings::branch(self.free, LONGEST * self.request.step)
    }

    fn one_of(
        &mut self,
        i: usize,
        symmetry: Symmetry,
        seen: EventObserver<'_>,
    ) -> Result<ControlFlow<()>> {
        let number = self.count;
        let hopf = self.hopfs[i].clone();
        let chart = self.chart(symmetry);
        let mut corrector = new_corrector(chart.family())?;
        let begin = hopf.at()[self.free];
        let inside = self.in_range(begin);
        let special = Event::Special(self.hopf(i)).on(number, symmetry);
        let special = special.against(self.request.tolerance);
        if inside {
            self.begins(number);
        }
        if inside && self.tells(number) && seen(special).is_break() {
            return Ok(Break(()));
        }
        let beside = hopf.small_orbits(chart.family());
        match Palc::from_hopf(&mut corrector, self.settings(), &beside) {
            Ok(mut palc) => OrbitBranch::new(self, number, chart, begin, seen).go(&mut palc),
            Err(error) if inside && self.tells(number) => {
                let special = Special {
                    note: Some(format!("no orbit is found beside the Hopf point: {error}")),
                    label: Label::Mx,
                    coefficient: None,
                    coefficient_uncertainty: None,
                    criticality: None,
                    ..self.hopf(i)
                };
                Ok(seen(Event::Special(special).on(number, symmetry)))
            }
            Err(_) => Ok(Continue(())),
        }
    }

    /// Along a branch that bifurcates.
    fn aside(
        &mut self,
        (site, direction): Switch,
        times: usize,
        seen: EventObserver<'_>,
    ) -> Result<ControlFlow<()>> {
        let number = self.count;
        let chart = self.chart(Symmetry::Asymmetric);
        let mut corrector = new_corrector(chart.family())?;
        let begin = site.at[self.free];
        let first = site.moved(&direction, ASIDE);
        match Palc::from(&mut corrector, self.settings(), first, direction) {
            Ok(mut palc) => {
                let mut branch = OrbitBranch::new(self, number, chart, begin, seen);
                branch.times = times;
                branch.go(&mut palc)
            }
            Err(_) => Ok(Continue(())),
        }
    }

    /// A Hopf point as a special point: the same as that of the equilibria.
    pub fn hopf(&self, i: usize) -> Special {
        let (hopf, request) = (&self.hopfs[i], self.request);
        let known = equilibria::hopf(&request.slab.law, request.along, hopf);
        let unknown = |x: f64| Uncertain::new(x, f64::INFINITY);
        known.unwrap_or_else(|| Special {
            period: Some(unknown(std::f64::consts::TAU / hopf.frequency)),
            ..Special::new(Label::Hb, unknown(hopf.driving), unknown(hopf.stiffness))
        })
    }
}
