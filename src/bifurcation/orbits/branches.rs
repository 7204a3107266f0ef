//! Branches of periodic orbits along one parameter: from the Hopf points, through folds, onto the branches that part from symmetric ones and those of
//! doubled periods.

use super::chart::Chart;
use super::crossing::Crossing;
use super::ends::{End, backwards};
use super::hopf::{HopfBeginning, hopfs_on_equilibria, of_symmetry};
use super::orbit_branch::OrbitBranch;
use super::orbit_point::{orbit_point, sharper};
use crate::bifurcation::Label;
use crate::bifurcation::general::splits::with_splits;
use crate::bifurcation::general::{
    FREE, FoundOrbits, GeneralBranch, GeneralEvent, GeneralObserver, GeneralPoint, SAME, Teller,
    symmetry_of,
};
use crate::equilibrium::{Symmetry, Verdict};
use crate::error::Result;
use crate::orbit::{
    Condition, ContinuationPoint, Corrector, Goal, Palc, PalcSettings, ParametrisedField, Regular,
    Switch,
};
use std::ops::ControlFlow::Continue;

/// Tolerance of the continuation.
pub(in crate::bifurcation) const ROUGH: f64 = 1e-11;
/// The longest step.
pub(super) const LONGEST: f64 = 0.7;
/// Steps of the integrator along a branch, or both ways along a curve, and on an arc, at most.
pub(super) const WORK: usize = 20_000_000;
pub(super) const ARC: usize = 100_000;
/// The first step onto a branch that bifurcates.
pub(super) const ASIDE: f64 = 0.02;
/// What is said of an orbit that was found by a search.
const FOUND: &str = "begins here, at an orbit found by a search";
/// The same where branches begin at Hopf points as a rule.
const BEGUN: &str =
    "begins here, at an orbit found by a search: there is no Hopf point in the range";

/// Follows the branches of orbits over the range and hands on what is found: of two equal parts first those of symmetric orbits, then those of
/// asymmetric ones, from Hopf points and from the pitchforks of orbits that none of these has come to.
///
/// # Errors
/// Those of the equilibria and of the flow; [`crate::Error::TooManyPoints`]; that a branch ends early is none.
pub fn orbits(branch: &GeneralBranch<'_>, seen: GeneralObserver<'_>) -> Result<()> {
    with_splits(branch, seen, |seen| {
        let mut teller = Teller::new(seen, &branch.following);
        OrbitBranches::new(branch).all(&mut teller)?;
        teller.end()
    })
}

/// What makes the orbits of a family, its work bounded.
pub(super) fn new_corrector(family: &dyn ParametrisedField) -> Result<Corrector<'_>> {
    Corrector::within(family, ROUGH, (ARC, WORK))
}

/// A period doubling.
pub(super) struct Doubling {
    pub orbit: Regular,
    /// How often the period has doubled before it.
    pub before: usize,
    /// Whether a branch of doubled orbits has begun or ended there.
    pub visited: bool,
}

/// All branches, and what is known of them so far.
pub(super) struct OrbitBranches<'b, 'a> {
    pub branch: &'b GeneralBranch<'a>,
    pub count: usize,
    /// The Hopf points of the symmetry at hand, their coordinates, and whether a branch has come there.
    pub hopfs: Vec<HopfBeginning>,
    pub coordinates: Vec<f64>,
    pub reached: Vec<bool>,
    /// Pitchforks on symmetric branches, and where asymmetric branches have come to one.
    pub pitchforks: Vec<Regular>,
    pub merged: Vec<f64>,
    pub doublings: Vec<Doubling>,
    /// Where other branches cross those of a system without a known symmetry.
    pub crossings: Vec<Crossing>,
    /// Where branches begin or end at the ends of the range, or pass the value at which orbits were found.
    pub ends: Vec<End>,
    /// That value.
    pub begin: Option<f64>,
}

impl<'b, 'a> OrbitBranches<'b, 'a> {
    fn new(branch: &'b GeneralBranch<'a>) -> Self {
        OrbitBranches {
            branch,
            count: 0,
            hopfs: Vec::new(),
            coordinates: Vec::new(),
            reached: Vec::new(),
            pitchforks: Vec::new(),
            merged: Vec::new(),
            doublings: Vec::new(),
            crossings: Vec::new(),
            ends: Vec::new(),
            begin: None,
        }
    }

    fn all(&mut self, teller: &mut Teller<'_>) -> Result<()> {
        let system = self.branch.system;
        let found = match self.branch.hopfs {
            Some(_) => Vec::new(),
            None => hopfs_on_equilibria(self.branch)?,
        };
        if let Some(site) = &self.branch.orbit {
            self.along_orbit(site.clone(), None, teller)?;
        }
        if system.alike.is_none() {
            self.along_hopfs(found, Chart::whole(&system), teller)?;
        } else {
            for symmetry in [Symmetry::Symmetric, Symmetry::Asymmetric] {
                let wanted = self.branch.symmetry.is_none_or(|only| only == symmetry);
                if !wanted || !system.has(symmetry) || teller.told.is_break() {
                    continue;
                }
                let hopfs = match self.branch.hopfs {
                    Some(known) => known(symmetry)?,
                    None => of_symmetry(&system, &found, symmetry),
                };
                self.along_hopfs(hopfs, Chart::of(&system, symmetry), teller)?;
            }
            if system.has(Symmetry::Asymmetric) && self.branch.symmetry != Some(Symmetry::Symmetric)
            {
                self.along_parting(teller)?;
            }
        }
        if let Some(found) = self.branch.found.filter(|_| self.count == 0)
            && teller.told.is_continue()
        {
            self.along_found(found, teller)?;
        }
        self.along_crossings(teller)?;
        self.along_doubled(teller)?;
        self.along_crossings(teller)
    }

    fn settings(&self) -> PalcSettings {
        PalcSettings::branch(FREE, LONGEST * self.branch.following.step)
    }

    /// The branch of this number has a point in the range: the next branch has another number.
    pub fn begins(&mut self, number: usize) {
        self.count = self.count.max(number + 1);
    }

    /// Whether a branch has begun or ended with this orbit; if not, one does so now.
    pub fn is_known(&mut self, chart: Chart<'_>, site: &ContinuationPoint) -> bool {
        // An orbit whose extremes are not found is told of again rather than left out.
        let Ok(end) = End::of(&self.branch.system, chart, site) else {
            return false;
        };
        let known = self.ends.iter().any(|other| other.is(&end));
        if !known {
            self.ends.push(end);
        }
        known
    }

    /// Whether two orbits are one, as far as their extremes are found.
    pub fn are_same(
        &self,
        chart: Chart<'_>,
        (one, other): (&ContinuationPoint, &ContinuationPoint),
    ) -> bool {
        let end = |site| End::of(&self.branch.system, chart, site);
        match (end(one), end(other)) {
            (Ok(one), Ok(other)) => one.is(&other),
            _ => true,
        }
    }

    /// The branches through the orbits that are found at the ends of the range or, where there are none, at a value within.
    fn along_found(&mut self, found: FoundOrbits<'_>, teller: &mut Teller<'_>) -> Result<()> {
        let (from, to) = self.branch.range;
        let within = found.within.filter(|&x| self.inside(x));
        for x in [from, to].into_iter().chain(within) {
            let is_end = [from, to].contains(&x);
            if !is_end && self.count > 0 {
                break;
            }
            self.begin = Some(x);
            for orbit in (found.at)(x) {
                let at = [x, self.branch.held];
                let begin = ContinuationPoint { at, ..orbit };
                if teller.told.is_break() {
                    return Ok(());
                }
                // An orbit at which no branch can begin leaves the others.
                let forced = self.branch.system.family.field(at).phase().is_some();
                let note = if forced { FOUND } else { BEGUN };
                let _ = self.along_orbit(begin, Some(note), teller);
            }
        }
        Ok(())
    }

    /// The branch through an orbit, from an end of the range inwards; through one that lies within from end to end.
    fn along_orbit(
        &mut self,
        site: ContinuationPoint,
        note: Option<&str>,
        teller: &mut Teller<'_>,
    ) -> Result<()> {
        let system = self.branch.system;
        let symmetry = symmetry_of(&site.shooting);
        let chart = Chart::of(&system, symmetry);
        let site = chart.own(&site);
        let mut corrector = new_corrector(chart.family())?;
        let held = [Condition::Parameter(FREE, site.at[FREE])];
        let orbit = corrector.correct(site, &[FREE], &held, Goal::STEP)?;
        if self.is_known(chart, &orbit.site) {
            return Ok(());
        }
        let (from, to) = self.branch.range;
        let begin = orbit.site.at[FREE];
        let is_end = [from, to].contains(&begin);
        let number = self.count;
        self.begins(number);
        if !is_end {
            let mut back = Vec::new();
            let mut keep = |event| {
                back.push(event);
                Continue(())
            };
            let mut kept = Teller::new(&mut keep, &self.branch.following);
            self.one_way(number, chart, &orbit, from - begin, &mut kept)?;
            for event in backwards(back) {
                if teller.tell(event).is_break() {
                    return Ok(());
                }
            }
        }
        let label = match note {
            _ if is_end => Some(Label::Ep),
            // There a value was asked for: that of the model.
            Some(_) => Some(Label::Uz),
            None => None,
        };
        let mut first = self.row(number, chart, &orbit, label);
        first.note = note.map(str::to_owned);
        let first = first.placed(system.family, [0.0; 2]);
        if teller.point(first, label.is_some()).is_break() {
            return Ok(());
        }
        let onward = if begin == to { from - to } else { to - begin };
        self.one_way(number, chart, &orbit, onward, teller)
    }

    /// From an orbit on, to where the parameter grows or falls as this sign says.
    fn one_way(
        &mut self,
        number: usize,
        chart: Chart<'a>,
        orbit: &Regular,
        onward: f64,
        teller: &mut Teller<'_>,
    ) -> Result<()> {
        let along = orbit.along[0].clone();
        let ahead = along.parameters[FREE] * onward;
        let direction = along.scaled(if ahead < 0.0 { -1.0 } else { 1.0 });
        let site = orbit.site.clone();
        let begin = site.clone();
        let mut corrector = new_corrector(chart.family())?;
        let mut palc = Palc::from(&mut corrector, self.settings(), site, direction)?;
        let mut branch = OrbitBranch::new(self, number, chart, orbit.site.at[FREE]);
        branch.begin = Some(begin);
        branch.go(&mut palc, teller)
    }

    /// The branches of these Hopf points, each once.
    fn along_hopfs(
        &mut self,
        hopfs: Vec<HopfBeginning>,
        chart: Chart<'a>,
        teller: &mut Teller<'_>,
    ) -> Result<()> {
        self.coordinates = hopfs.iter().map(|(hopf, _)| hopf.at[FREE]).collect();
        self.reached = vec![false; hopfs.len()];
        self.hopfs = hopfs;
        for i in 0..self.hopfs.len() {
            if !std::mem::replace(&mut self.reached[i], true) && teller.told.is_continue() {
                self.along_hopf(i, chart, teller)?;
            }
        }
        Ok(())
    }

    fn along_hopf(&mut self, i: usize, chart: Chart<'a>, teller: &mut Teller<'_>) -> Result<()> {
        let number = self.count;
        let (hopf, point) = self.hopfs[i].clone();
        let point = GeneralPoint {
            number,
            symmetry: chart.symmetry(),
            ..point
        };
        let inside = self.inside(hopf.at[FREE]);
        if inside {
            self.begins(number);
        }
        if inside && teller.tell(GeneralEvent::Special(point.clone())).is_break() {
            return Ok(());
        }
        let mut corrector = new_corrector(chart.family())?;
        match Palc::from_hopf(&mut corrector, self.settings(), &hopf) {
            Ok(mut palc) => {
                let mut branch = OrbitBranch::new(self, number, chart, hopf.at[FREE]);
                branch.from_hopf = Some(i);
                branch.go(&mut palc, teller)
            }
            Err(_) if !inside => Ok(()),
            Err(error) => {
                let special = GeneralPoint {
                    label: Some(Label::Mx),
                    note: Some(format!("no orbit was found near the Hopf point: {error}")),
                    criticality: None,
                    coefficient: None,
                    coefficient_uncertainty: None,
                    ..point
                };
                let _ = teller.tell(GeneralEvent::Special(special));
                Ok(())
            }
        }
    }

    /// The asymmetric branches from the pitchforks that none has come to.
    fn along_parting(&mut self, teller: &mut Teller<'_>) -> Result<()> {
        for i in 0..self.pitchforks.len() {
            let here = self.pitchforks[i].site.at[FREE];
            if teller.told.is_break() || self.merged.iter().any(|at| (at - here).abs() < SAME) {
                continue;
            }
            self.merged.push(here);
            if let Some(switch) = self.pitchforks[i].asymmetric() {
                self.aside(switch, 0, teller)?;
            }
        }
        Ok(())
    }

    /// The branches that cross others. The list grows as it is gone through.
    fn along_crossings(&mut self, teller: &mut Teller<'_>) -> Result<()> {
        let mut i = 0;
        while i < self.crossings.len() && teller.told.is_continue() {
            let one = &mut self.crossings[i];
            i += 1;
            if std::mem::replace(&mut one.visited, true) {
                continue;
            }
            let (times, (site, direction)) = (one.times, one.switch.clone());
            // To both sides of a pitchfork there are the same orbits, seen in a symmetry.
            let sides: &[f64] = if one.is_pitchfork {
                &[1.0]
            } else {
                &[1.0, -1.0]
            };
            for &side in sides {
                let direction = direction.clone().scaled(side);
                self.aside((site.clone(), direction), times, teller)?;
            }
        }
        Ok(())
    }

    /// The branches of doubled orbits. The list grows as it is gone through.
    fn along_doubled(&mut self, teller: &mut Teller<'_>) -> Result<()> {
        let mut i = 0;
        while i < self.doublings.len() && teller.told.is_continue() {
            let one = &mut self.doublings[i];
            let times = one.before + 1;
            let new = !std::mem::replace(&mut one.visited, true);
            let switch = one.orbit.doubled();
            i += 1;
            if let Some(switch) = switch.filter(|_| new && times <= self.branch.doublings) {
                self.aside(switch, times, teller)?;
            }
        }
        Ok(())
    }

    /// Whether a branch of doubled orbits has come to this doubling.
    pub fn is_doubled(&self, site: &ContinuationPoint) -> bool {
        let place = |site: &ContinuationPoint| [site.at[FREE], site.shooting.period().ln()];
        let here = place(site);
        let mut known = self.doublings.iter().filter(|one| one.visited);
        known.any(|one| {
            let mut pairs = place(&one.orbit.site).into_iter().zip(here);
            pairs.all(|(a, b)| (a - b).abs() < SAME)
        })
    }

    /// Along a branch that bifurcates.
    fn aside(
        &mut self,
        (site, direction): Switch,
        times: usize,
        teller: &mut Teller<'_>,
    ) -> Result<()> {
        let chart = Chart::whole(&self.branch.system);
        let mut corrector = new_corrector(chart.family())?;
        let begin = site.at[FREE];
        let first = site.moved(&direction, ASIDE);
        let Ok(mut palc) = Palc::from(&mut corrector, self.settings(), first, direction) else {
            return Ok(());
        };
        let number = self.count;
        let mut branch = OrbitBranch::new(self, number, chart, begin);
        branch.times = times;
        branch.go(&mut palc, teller)
    }

    pub fn inside(&self, x: f64) -> bool {
        let (a, b) = self.branch.range;
        (a.min(b)..=a.max(b)).contains(&x)
    }

    /// Whether a branch that began at one coordinate and has not been in the range leads away from it at another.
    pub fn strays(&self, x: f64, begin: f64) -> bool {
        /// In units of how far from the range it began.
        const FAR: f64 = 2.0;
        let off = |x: f64, (a, b): (f64, f64)| (a.min(b) - x).max(x - a.max(b)).max(0.0);
        off(x, self.branch.beyond) > FAR * off(begin, self.branch.range)
    }

    pub fn row(
        &self,
        number: usize,
        chart: Chart<'_>,
        orbit: &Regular,
        label: Option<Label>,
    ) -> GeneralPoint {
        let mut point = orbit_point(chart, number, orbit, label);
        if label.is_none() && point.verdict() == Verdict::Undecided {
            point = sharper(chart, number, orbit).unwrap_or(point);
        }
        point.placed(self.branch.system.family, [f64::INFINITY, 0.0])
    }
}
