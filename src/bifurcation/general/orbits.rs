//! Branches of periodic orbits along one parameter: from the Hopf points, through folds, onto the branches of doubled periods.

use super::ends::{End, backwards};
use super::equilibria::EquilibriumBranches;
use super::orbit_branch::OrbitBranch;
use super::orbit_point::orbit_point;
use super::splits::with_splits;
use super::{
    FREE, FoundOrbits, GeneralBranch, GeneralEvent, GeneralObserver, GeneralPoint, GeneralSolution,
    SAME, Teller,
};
use crate::bifurcation::Label;
use crate::bifurcation::orbits::{ARC, LONGEST, ROUGH, WORK};
use crate::equilibrium::Verdict;
use crate::error::Result;
use crate::orbit::{
    Condition, ContinuationPoint, Corrector, Goal, Palc, PalcSettings, ParametrisedField, Regular,
    SmallOrbits, Switch, TestFunction,
};
use std::f64::consts::PI;
use std::ops::ControlFlow::Continue;

/// The first step onto a branch that bifurcates.
const ASIDE: f64 = 0.02;
/// What is said of an orbit that was found where no Hopf point is met.
const BEGUN: &str = "begins here, at an orbit that was found: no Hopf point is met";

/// Follows the branches of orbits over the range and hands on what is found.
///
/// # Errors
/// Those of the equilibria and of the flow; [`crate::Error::TooManyPoints`]; that a branch ends early is none.
pub fn orbits(branch: &GeneralBranch<'_>, seen: GeneralObserver<'_>) -> Result<()> {
    with_splits(branch, seen, |seen| {
        let mut teller = Teller::new(seen, &branch.following);
        let mut set = OrbitBranches::new(branch)?;
        set.all(&mut teller)?;
        teller.end()
    })
}

/// What makes the orbits of a family, its work bounded.
pub(super) fn new_corrector(family: &dyn ParametrisedField) -> Result<Corrector<'_>> {
    Corrector::within(family, ROUGH, (ARC, WORK))
}

/// The Hopf points on all equilibria, by their coordinate, each once; as they are told of.
pub(super) fn hopf_points(branch: &GeneralBranch<'_>) -> Result<Vec<(SmallOrbits, GeneralPoint)>> {
    let mut found: Vec<(SmallOrbits, GeneralPoint)> = Vec::new();
    EquilibriumBranches::new(branch).all(&mut |point, _| {
        if let (Some(Label::Hb), Some(period)) = (point.label, point.period)
            && let GeneralSolution::Equilibrium { state, .. } = &point.solution
        {
            let frequency = std::f64::consts::TAU / period.value;
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

/// All branches, and what is known of them so far.
pub(super) struct OrbitBranches<'b, 'a> {
    pub branch: &'b GeneralBranch<'a>,
    pub count: usize,
    pub hopfs: Vec<(SmallOrbits, GeneralPoint)>,
    /// The coordinates of the Hopf points, and whether a branch has come there.
    pub coordinates: Vec<f64>,
    pub reached: Vec<bool>,
    /// Period doublings with how often the period has doubled before, and whether a branch of doubled orbits was there.
    pub doublings: Vec<(Regular, usize, bool)>,
    /// Where branches begin or end at the ends of the range, or pass the value at which orbits were found.
    pub ends: Vec<End>,
    /// That value.
    pub begin: Option<f64>,
}

impl<'b, 'a> OrbitBranches<'b, 'a> {
    fn new(branch: &'b GeneralBranch<'a>) -> Result<Self> {
        let mut hopfs = hopf_points(branch)?;
        if hopfs.is_empty() && branch.orbit.is_none() {
            // What is not known there is no reason to fail: it was not asked for.
            hopfs = hopf_points(&GeneralBranch {
                range: branch.beyond,
                ..branch.clone()
            })
            .unwrap_or_default();
        }
        Ok(OrbitBranches {
            branch,
            count: 0,
            coordinates: hopfs.iter().map(|(hopf, _)| hopf.at[FREE]).collect(),
            reached: vec![false; hopfs.len()],
            hopfs,
            doublings: Vec::new(),
            ends: Vec::new(),
            begin: None,
        })
    }

    fn all(&mut self, teller: &mut Teller<'_>) -> Result<()> {
        if let Some(site) = &self.branch.orbit {
            self.along_orbit(site.clone(), None, teller)?;
        }
        for i in 0..self.hopfs.len() {
            if !std::mem::replace(&mut self.reached[i], true) && teller.told.is_continue() {
                self.along_hopf(i, teller)?;
            }
        }
        if let Some(found) = self.branch.found.filter(|_| self.count == 0)
            && teller.told.is_continue()
        {
            self.along_found(found, teller)?;
        }
        // The list grows as it is gone through.
        let mut i = 0;
        while i < self.doublings.len() && teller.told.is_continue() {
            let (orbit, before, visited) = &mut self.doublings[i];
            let times = *before + 1;
            let new = !std::mem::replace(visited, true);
            let switch = orbit.doubled();
            i += 1;
            if let Some(switch) = switch.filter(|_| new && times <= self.branch.doublings) {
                self.aside(switch, times, teller)?;
            }
        }
        Ok(())
    }

    fn settings(&self) -> PalcSettings {
        PalcSettings::branch(FREE, LONGEST * self.branch.following.step)
    }

    /// The branch of this number has a point in the range: the next branch has another number.
    pub fn begins(&mut self, number: usize) {
        self.count = self.count.max(number + 1);
    }

    /// Whether a branch has begun or ended with this orbit; if not, one does so now.
    pub fn is_known(&mut self, site: &ContinuationPoint) -> bool {
        // An orbit whose extremes are not found is told of again rather than left out.
        let Ok(end) = End::of(self.branch, site) else {
            return false;
        };
        let known = self.ends.iter().any(|other| other.is(&end));
        if !known {
            self.ends.push(end);
        }
        known
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
                let _ = self.along_orbit(begin, Some(BEGUN), teller);
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
        let mut corrector = new_corrector(self.branch.system.family)?;
        let held = [Condition::Parameter(FREE, site.at[FREE])];
        let orbit = corrector.correct(site, &[FREE], &held, Goal::STEP)?;
        if self.is_known(&orbit.site) {
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
            self.one_way(number, &orbit, from - begin, &mut kept)?;
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
        let mut first = self.row(number, &orbit, label);
        first.note = note.map(str::to_owned);
        let first = first.placed(self.branch.system.family, [0.0; 2]);
        if teller.point(first, label.is_some()).is_break() {
            return Ok(());
        }
        let onward = if begin == to { from - to } else { to - begin };
        self.one_way(number, &orbit, onward, teller)
    }

    /// From an orbit on, to where the parameter grows or falls as this sign says.
    fn one_way(
        &mut self,
        number: usize,
        orbit: &Regular,
        onward: f64,
        teller: &mut Teller<'_>,
    ) -> Result<()> {
        let along = orbit.along[0].clone();
        let ahead = along.parameters[FREE] * onward;
        let direction = along.scaled(if ahead < 0.0 { -1.0 } else { 1.0 });
        let site = orbit.site.clone();
        let mut corrector = new_corrector(self.branch.system.family)?;
        let mut palc = Palc::from(&mut corrector, self.settings(), site, direction)?;
        let mut branch = OrbitBranch::new(self, number, 0, true);
        branch.begin = Some(orbit.site.clone());
        branch.go(&mut palc, teller)
    }

    fn along_hopf(&mut self, i: usize, teller: &mut Teller<'_>) -> Result<()> {
        let number = self.count;
        let (hopf, point) = self.hopfs[i].clone();
        let point = GeneralPoint { number, ..point };
        let inside = self.inside(hopf.at[FREE]);
        if inside {
            self.begins(number);
        }
        if inside && teller.tell(GeneralEvent::Special(point.clone())).is_break() {
            return Ok(());
        }
        let mut corrector = new_corrector(self.branch.system.family)?;
        match Palc::from_hopf(&mut corrector, self.settings(), &hopf) {
            Ok(mut palc) => {
                let mut branch = OrbitBranch::new(self, number, 0, inside);
                branch.from_hopf = Some(i);
                branch.go(&mut palc, teller)
            }
            Err(_) if !inside => Ok(()),
            Err(error) => {
                let special = GeneralPoint {
                    label: Some(Label::Mx),
                    note: Some(format!("no orbit is found beside the Hopf point: {error}")),
                    criticality: None,
                    coefficient: None,
                    ..point
                };
                let _ = teller.tell(GeneralEvent::Special(special));
                Ok(())
            }
        }
    }

    /// Along a branch of doubled orbits.
    fn aside(
        &mut self,
        (site, direction): Switch,
        times: usize,
        teller: &mut Teller<'_>,
    ) -> Result<()> {
        let mut corrector = new_corrector(self.branch.system.family)?;
        let inside = self.inside(site.at[FREE]);
        let first = site.moved(&direction, ASIDE);
        let Ok(mut palc) = Palc::from(&mut corrector, self.settings(), first, direction) else {
            return Ok(());
        };
        let number = self.count;
        OrbitBranch::new(self, number, times, inside).go(&mut palc, teller)
    }

    pub fn inside(&self, x: f64) -> bool {
        let (a, b) = self.branch.range;
        (a.min(b)..=a.max(b)).contains(&x)
    }

    /// An orbit beside a bifurcation in its last digits, and what its largest multiplier is known to; `None` where that is not known.
    fn sharper(&self, number: usize, orbit: &Regular) -> Option<GeneralPoint> {
        /// What steps may err by, and standard deviations of what is noise.
        const FINE: f64 = 1e-15;
        const DEVIATIONS: f64 = 5.0;
        let mut fine = Corrector::new(self.branch.system.family, FINE).ok()?;
        // Across the branch: beside a Hopf point it may be all but vertical.
        let held = Condition::Plane(orbit.along.first()?, &orbit.site);
        let site = orbit.site.clone();
        let sharp = fine.correct(site, &[FREE], &[held], Goal::SHARP).ok()?;
        let largest = *sharp.multipliers()?.first()?;
        let condition = match largest.arg.abs() {
            0.0 => TestFunction::Fold,
            PI => TestFunction::Doubling,
            _ => TestFunction::Torus,
        };
        let noise = fine.noise_of(condition, &sharp, &[FREE], held)?;
        let part = DEVIATIONS * noise / condition.of(&sharp.spectrum).abs();
        let mut point = orbit_point(number, &sharp, None);
        if let GeneralSolution::Orbit { neutral, .. } = &mut point.solution {
            *neutral = part * largest.ln_abs.abs();
        }
        Some(point)
    }

    pub fn row(&self, number: usize, orbit: &Regular, label: Option<Label>) -> GeneralPoint {
        let mut point = orbit_point(number, orbit, label);
        if label.is_none() && point.verdict() == Verdict::Undecided {
            point = self.sharper(number, orbit).unwrap_or(point);
        }
        point.placed(self.branch.system.family, [f64::INFINITY, 0.0])
    }
}
