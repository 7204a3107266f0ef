//! Branches of periodic orbits along one parameter: from the Hopf points, through folds, onto the branches of doubled periods.

use super::ends::{End, backwards};
use super::equilibria::EquilibriumBranches;
use super::growing_period::{Limit, Periods};
use super::hopf::GeneralHopf;
use super::multipliers_together::{Outside, Together, is_real};
use super::splits::with_splits;
use super::{
    FoundOrbits, GeneralBranch, GeneralEvent, GeneralObserver, GeneralPoint, GeneralSolution, SAME,
    Teller,
};
use crate::bifurcation::orbits::normal_form::{Form, normal_form};
use crate::bifurcation::orbits::{ARC, LONGEST, ROUGH, WORK, embedded, middle, refined};
use crate::bifurcation::{Criticality, Label};
use crate::continuation::Met;
use crate::error::Result;
use crate::field::Vector;
use crate::number::Uncertain;
use crate::orbit::{
    Condition, ContinuationPoint, Corrector, DirectedPoint, Goal, Palc, PalcSettings,
    ParametrisedField, Regular, Switch, TestFunction, Tracer, WatchedFunction,
};
use std::ops::ControlFlow::{self, Break, Continue};

/// The most steps on a branch.
const STEPS: usize = 5000;
/// The first step onto a branch that bifurcates.
const ASIDE: f64 = 0.02;
/// What is said of an orbit that was found where no Hopf point is met.
const BEGUN: &str = "begins here, at an orbit that was found: no Hopf point is met";
/// The free parameter.
const FREE: usize = 0;

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
    Ok(Corrector::by(family, Tracer::limited(ROUGH, ARC, WORK)?))
}

/// The Hopf points on all equilibria, by their coordinate, each once; as they are told of.
pub(super) fn hopf_points(branch: &GeneralBranch<'_>) -> Result<Vec<(GeneralHopf, GeneralPoint)>> {
    let mut found: Vec<(GeneralHopf, GeneralPoint)> = Vec::new();
    EquilibriumBranches::new(branch).all(&mut |point, _| {
        if let (Some(Label::Hb), Some(period)) = (point.label, point.period)
            && let GeneralSolution::Equilibrium { state, .. } = &point.solution
        {
            let hopf = GeneralHopf {
                state: state.clone(),
                at: point.at,
                frequency: std::f64::consts::TAU / period.value,
            };
            let place = |hopf: &GeneralHopf| branch.system.representative(&hopf.state);
            let here = place(&hopf);
            let same = |other: &GeneralHopf| {
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
struct OrbitBranches<'b, 'a> {
    branch: &'b GeneralBranch<'a>,
    count: usize,
    hopfs: Vec<(GeneralHopf, GeneralPoint)>,
    /// The coordinates of the Hopf points, and whether a branch has come there.
    coordinates: Vec<f64>,
    reached: Vec<bool>,
    /// Period doublings with how often the period has doubled before, and whether a branch of doubled orbits was there.
    doublings: Vec<(Regular, usize, bool)>,
    /// Where branches begin or end at the ends of the range, or pass the value at which orbits were found.
    ends: Vec<End>,
    /// That value.
    begin: Option<f64>,
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
    fn begins(&mut self, number: usize) {
        self.count = self.count.max(number + 1);
    }

    /// Whether a branch has begun or ended with this orbit; if not, one does so now.
    fn is_known(&mut self, site: &ContinuationPoint) -> bool {
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
        match hopf.palc(&mut corrector, self.settings()) {
            Ok(mut palc) => OrbitBranch::new(self, number, 0, inside).go(&mut palc, teller),
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

    fn inside(&self, x: f64) -> bool {
        let (a, b) = self.branch.range;
        (a.min(b)..=a.max(b)).contains(&x)
    }

    fn row(&self, number: usize, orbit: &Regular, label: Option<Label>) -> GeneralPoint {
        let point = orbit_point(number, orbit, label);
        point.placed(self.branch.system.family, [f64::INFINITY, 0.0])
    }
}

/// An orbit as a point, without its parameters.
pub(super) fn orbit_point(number: usize, orbit: &Regular, label: Option<Label>) -> GeneralPoint {
    let shooting = orbit.site.shooting.clone();
    GeneralPoint {
        label,
        period: Some(Uncertain::new(shooting.period(), f64::INFINITY)),
        ..GeneralPoint::new(
            number,
            orbit.site.at,
            GeneralSolution::Orbit {
                log_multipliers: orbit.log_multipliers(),
                shooting,
            },
        )
    }
}

/// A special orbit near a site in the last digits, or what is known of it.
pub(super) fn special_orbit(
    family: &dyn ParametrisedField,
    (number, label): (usize, Label),
    near: &Regular,
    (free, meets): (&[usize], &[WatchedFunction]),
) -> (GeneralPoint, Option<Regular>) {
    let Some(sharp) = refined(family, &near.site, free, meets) else {
        let rough = orbit_point(number, near, Some(label));
        let unknown = [0, 1].map(|i| {
            if free.contains(&i) {
                f64::INFINITY
            } else {
                0.0
            }
        });
        return (rough.placed(family, unknown), None);
    };
    let point = GeneralPoint {
        parameters: sharp.at,
        period: Some(sharp.period),
        orbit: Some(sharp.special_orbit()),
        ..orbit_point(number, &sharp.orbit, Some(label))
    };
    (point, Some(sharp.orbit))
}

impl GeneralPoint {
    /// With which way the bifurcation goes.
    pub(super) fn classified(
        mut self,
        (coefficient, criticality): (Uncertain, Criticality),
    ) -> Self {
        let known = coefficient.uncertainty.is_finite();
        self.criticality = Some(criticality);
        self.coefficient = known.then_some(coefficient.value);
        self.coefficient_uncertainty = known.then_some(coefficient.uncertainty);
        self
    }
}

/// One branch.
struct OrbitBranch<'s, 'b, 'a> {
    set: &'s mut OrbitBranches<'b, 'a>,
    number: usize,
    times: usize,
    inside: bool,
    /// The orbit that it begins with, which it does not come to again.
    begin: Option<ContinuationPoint>,
    periods: Periods,
    outside: Outside,
}

impl<'s, 'b, 'a> OrbitBranch<'s, 'b, 'a> {
    fn new(set: &'s mut OrbitBranches<'b, 'a>, number: usize, times: usize, inside: bool) -> Self {
        OrbitBranch {
            set,
            number,
            times,
            inside,
            begin: None,
            periods: Periods::default(),
            outside: Outside::default(),
        }
    }

    /// Whether this is the orbit that it begins with.
    fn is_begin(&self, site: &ContinuationPoint) -> bool {
        let apart = |begin: &ContinuationPoint| {
            let periods = site.shooting.period() / begin.shooting.period();
            (site.at[FREE] - begin.at[FREE])
                .abs()
                .max(periods.ln().abs())
        };
        self.begin.as_ref().is_some_and(|begin| apart(begin) < SAME)
    }

    fn watches(&self) -> Vec<WatchedFunction> {
        let branch = self.set.branch;
        let dimension = branch.system.family.dimension();
        // Folds by their multiplier: along a canard the parameter turns within its rounding.
        let all = [
            TestFunction::Fold,
            TestFunction::Doubling,
            TestFunction::Torus,
        ];
        let known = all.into_iter().filter(|one| one.checked(dimension).is_ok());
        let mut watches: Vec<_> = known.map(WatchedFunction::TestFunction).collect();
        let (a, b) = branch.range;
        let begin = self
            .set
            .begin
            .filter(|x| ![a, b].contains(x) && !branch.at.contains(x));
        let values = [a, b]
            .into_iter()
            .chain(branch.at.iter().copied())
            .chain(begin);
        watches.extend(values.map(|x| WatchedFunction::Value(FREE, x)));
        watches
    }

    fn go(mut self, palc: &mut Palc<'_, '_>, teller: &mut Teller<'_>) -> Result<()> {
        let watches = self.watches();
        let end = palc.follow(&watches, STEPS, &mut |palc, before, met| match met {
            Met::Zero(watch, at) => self.zero(palc, watch, at, teller),
            Met::Point(now) => self.orbit(palc, now, before, teller),
        })?;
        if end != crate::continuation::Stop::Observer && self.inside {
            let point = self.end(&palc.now.here, &end.to_string());
            let _ = self.tell(GeneralEvent::Special(point), teller);
        }
        Ok(())
    }

    /// An orbit of which several multipliers are of modulus 1.
    fn together(&self, together: Together) -> GeneralPoint {
        let point = orbit_point(self.number, &together.orbit, Some(together.label));
        let count = together.count;
        let note = match together.label {
            Label::Bp => format!("multipliers that are 1: {count}"),
            Label::Pd => format!("multipliers that are -1: {count}"),
            _ => format!("multipliers of modulus 1: {count}"),
        };
        let point = GeneralPoint {
            at: [together.at.value, point.at[1]],
            note: Some(format!("{note}; what branches off is not followed")),
            ..point
        };
        point.placed(
            self.set.branch.system.family,
            [together.at.uncertainty, 0.0],
        )
    }

    /// Where the branch goes no further, or tends to.
    fn end(&self, last: &Regular, why: &str) -> GeneralPoint {
        let point = self.set.row(self.number, last, Some(Label::Mx));
        let branch = self.set.branch;
        let Some(Limit { at, is_saddle_node }) = self.periods.limit(branch, last) else {
            return GeneralPoint {
                note: Some(why.to_owned()),
                ..point
            };
        };
        let limit = GeneralPoint {
            label: Some(Label::Hom),
            at: [at.value, point.at[1]],
            saddle_node: is_saddle_node,
            period: None,
            note: Some("the period grows without bound".to_owned()),
            ..point
        };
        limit.placed(branch.system.family, [at.uncertainty, 0.0])
    }

    fn tell(&mut self, event: GeneralEvent, teller: &mut Teller<'_>) -> ControlFlow<()> {
        self.set.begins(self.number);
        teller.tell(event)
    }

    /// The next orbit: whether the branch goes on.
    fn orbit(
        &mut self,
        palc: &Palc<'_, '_>,
        now: &DirectedPoint,
        before: &DirectedPoint,
        teller: &mut Teller<'_>,
    ) -> ControlFlow<()> {
        let here = &now.here;
        let last = &before.here.site;
        if let Some(i) = palc.ends_at_coordinate(last, &self.set.coordinates) {
            self.set.reached[i] = true;
            let point = GeneralPoint {
                number: self.number,
                ..self.set.hopfs[i].1.clone()
            };
            if self.set.inside(point.at[FREE]) {
                let _ = self.tell(GeneralEvent::Special(point), teller);
            }
            return Break(());
        }
        let turned = now.direction.parameters[FREE] * before.direction.parameters[FREE] <= 0.0;
        if self.times > 0 && turned && self.is_doubling(&here.site) {
            return Break(());
        }
        let family = self.set.branch.system.family;
        if let Some(together) = self.outside.come_to(family, here)
            && self.set.inside(together.orbit.site.at[FREE])
        {
            self.set.begins(self.number);
            teller.special(self.together(together))?;
        }
        if !self.set.inside(here.site.at[FREE]) {
            let (a, b) = self.set.branch.beyond;
            let far = !(a.min(b)..=a.max(b)).contains(&here.site.at[FREE]);
            return if self.inside || far {
                Break(())
            } else {
                Continue(())
            };
        }
        self.inside = true;
        let site = &here.site;
        self.periods.push(site.at[FREE], site.shooting.period());
        let row = self.set.row(self.number, here, None);
        self.tell(GeneralEvent::Row(row), teller)
    }

    /// Whether a branch of doubled orbits, whose parameter turns, is back at a period doubling.
    fn is_doubling(&mut self, site: &ContinuationPoint) -> bool {
        /// Of the turn in the coordinate, and of the period from twice that at the doubling.
        const NEAR: (f64, f64) = (2e-3, 1e-3);
        let times = self.times;
        let near = |(orbit, before, _): &(Regular, usize, bool)| {
            let period = 2.0 * orbit.site.shooting.period();
            (orbit.site.at[FREE] - site.at[FREE]).abs() < NEAR.0
                && (site.shooting.period() / period - 1.0).abs() < NEAR.1
                && before + 1 == times
        };
        let found = self.set.doublings.iter().position(near);
        if let Some(i) = found {
            self.set.doublings[i].2 = true;
        }
        found.is_some()
    }

    /// A pitchfork, where the branch's own condition has no simple zero: in the states in which two equal parts move alike, where
    /// there are such.
    fn pitchfork(&self, near: &Regular) -> GeneralPoint {
        /// Parts of an orbit that differ by less move alike.
        const ALIKE: f64 = 1e-6;
        let rough = self.set.row(self.number, near, Some(Label::Pf));
        let system = self.set.branch.system;
        let apart = |x: &Vector| (x[x.len() - 2] - x[x.len() - 1]).abs();
        let nodes = near.site.shooting.nodes.iter();
        let Some(family) = system.alike.filter(|_| nodes.map(apart).all(|x| x < ALIKE)) else {
            return rough;
        };
        let across = [WatchedFunction::TestFunction(TestFunction::Transverse)];
        let Some(sharp) = refined(family, &middle(&near.site), &[FREE], &across) else {
            return rough;
        };
        let site = embedded(&sharp.orbit.site);
        let point = GeneralPoint {
            at: site.at,
            parameters: sharp.at,
            period: Some(sharp.period),
            orbit: Some(sharp.special_orbit()),
            ..rough
        };
        match normal_form(system.family, &site, Form::Pitchfork) {
            Ok(way) => point.classified(way),
            Err(_) => point,
        }
    }

    /// Something that is watched is zero here.
    fn zero(
        &mut self,
        palc: &Palc<'_, '_>,
        watch: WatchedFunction,
        at: &DirectedPoint,
        teller: &mut Teller<'_>,
    ) -> ControlFlow<()> {
        /// A slope of the parameter along the branch that is zero: at folds, where the multiplier 1 is no pitchfork's.
        const FLAT: f64 = 1e-3;
        let branch = self.set.branch;
        let (from, to) = branch.range;
        let near = &at.here;
        if let WatchedFunction::TestFunction(test_function) = watch {
            if test_function == TestFunction::Torus && is_real(near) {
                return Continue(());
            }
            self.outside.passes(test_function);
        }
        let label = match watch {
            // It begins at this value but for rounding.
            WatchedFunction::Value(..) if self.is_begin(&near.site) => return Continue(()),
            WatchedFunction::Value(_, x) if x == from || x == to => Label::Ep,
            _ if !self.set.inside(near.site.at[FREE]) => return Continue(()),
            WatchedFunction::Value(_, x) if self.set.begin == Some(x) => {
                self.set.is_known(&near.site);
                if !branch.at.contains(&x) {
                    return Continue(());
                }
                Label::Uz
            }
            WatchedFunction::Value(..) => Label::Uz,
            WatchedFunction::TestFunction(TestFunction::Doubling) => Label::Pd,
            WatchedFunction::TestFunction(TestFunction::Torus) if sum_of_pair(near).abs() < 2.0 => {
                Label::Tr
            }
            WatchedFunction::TestFunction(TestFunction::Fold)
                if self.times > 0 && self.is_doubling(&near.site) =>
            {
                return Continue(());
            }
            WatchedFunction::TestFunction(TestFunction::Fold) => {
                let turns = at.direction.parameters[FREE].abs() < FLAT;
                if turns { Label::Sn } else { Label::Pf }
            }
            _ => return Continue(()),
        };
        let ends = label == Label::Ep && self.inside;
        // Another branch has come this way from its other end.
        if label == Label::Ep && self.set.is_known(&near.site) && !ends {
            return Break(());
        }
        self.inside |= label == Label::Ep;
        let family = branch.system.family;
        let meets = (&palc.curve.settings.free[..], &[watch][..]);
        let (mut point, orbit) = match label {
            Label::Pf => (self.pitchfork(near), None),
            _ => special_orbit(family, (self.number, label), near, meets),
        };
        let form = match label {
            Label::Pd => Some(Form::Doubling),
            Label::Tr => Some(Form::Torus),
            _ => None,
        };
        if let (Some(form), Some(orbit)) = (form, &orbit)
            && let Ok(way) = normal_form(family, &orbit.site, form)
        {
            point = point.classified(way);
        }
        if let (Label::Pd, Some(orbit)) = (label, orbit) {
            self.set.doublings.push((orbit, self.times, false));
        }
        self.set.begins(self.number);
        teller.special(point)?;
        if ends { Break(()) } else { Continue(()) }
    }
}

/// The sum of the two multipliers whose product is nearest to 1.
pub(super) fn sum_of_pair(orbit: &Regular) -> f64 {
    TestFunction::Trace(0.0).of(&orbit.spectrum)
}
