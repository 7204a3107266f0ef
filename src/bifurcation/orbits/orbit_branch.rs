//! One branch of periodic orbits, followed to its end.

use super::branch_end::grows_as_at;
use super::branches::{Doubling, OrbitBranches, new_corrector};
use super::chart::Chart;
use super::crossing::Crossing;
use super::growing_period::{Folds, Periods};
use super::multipliers_together::Outside;
use super::normal_form::Form;
use super::orbit_point::refined_point;
use super::refine::refined;
use super::vertical::Vertical;
use crate::bifurcation::Label;
use crate::bifurcation::general::{FREE, GeneralEvent, GeneralPoint, SAME, Teller};
use crate::continuation::{Met, Stop};
use crate::error::Result;
use crate::orbit::{
    ContinuationPoint, DirectedPoint, Palc, Regular, TestFunction, WatchedFunction,
};
use std::ops::ControlFlow::{self, Break, Continue};

/// The most steps on a branch.
const STEPS: usize = 5000;
/// How far from a bifurcation a branch turns that has come to it, in the coordinate and in the period, relatively.
const NEAR: (f64, f64) = (2e-3, 1e-3);

/// One branch.
pub(super) struct OrbitBranch<'s, 'b, 'a> {
    pub set: &'s mut OrbitBranches<'b, 'a>,
    pub number: usize,
    /// The variables that orbits are in at the moment.
    pub chart: Chart<'a>,
    /// How often the period has doubled.
    pub times: usize,
    /// Whether it has been in the range, and the coordinate where it began.
    pub inside: bool,
    began: f64,
    /// The orbit that it begins with, which it does not come to again.
    pub begin: Option<ContinuationPoint>,
    /// The place of the Hopf point at which it begins.
    pub from_hopf: Option<usize>,
    pub periods: Periods,
    pub folds: Folds,
    /// Whether a fold was met on the step that is looked at.
    pub turned: bool,
    /// A point at which the parameter turns, but at which no fold could be solved for.
    pub unsure: Option<(GeneralPoint, Regular)>,
    pub outside: Outside,
    /// The label and parameter of the last fold, period doubling or pitchfork, and whether further ones are listed.
    pub last: Option<(Label, f64)>,
    pub are_listed: bool,
    /// While the parameter does not vary.
    pub vertical: Option<Vertical>,
}

/// How a branch of doubled orbits ends at one of orbits that go round once.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Back {
    /// Through the period doubling in this place.
    Through(usize),
    /// Newton's method has left the branch.
    Jumped,
}

impl<'s, 'b, 'a> OrbitBranch<'s, 'b, 'a> {
    pub fn new(
        set: &'s mut OrbitBranches<'b, 'a>,
        number: usize,
        chart: Chart<'a>,
        began: f64,
    ) -> Self {
        let inside = set.inside(began);
        OrbitBranch {
            set,
            number,
            chart,
            times: 0,
            inside,
            began,
            begin: None,
            from_hopf: None,
            periods: Periods::default(),
            folds: Folds::default(),
            turned: false,
            unsure: None,
            outside: Outside::default(),
            last: None,
            are_listed: true,
            vertical: Some(Vertical::default()),
        }
    }

    fn watches(&self) -> Vec<WatchedFunction> {
        let branch = self.set.branch;
        let mut watches = self.chart.watches();
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
        watches.extend((0..branch.watch.len()).map(WatchedFunction::UserFunction));
        watches
    }

    /// To the end, in other variables where these lose digits.
    pub fn go(mut self, palc: &mut Palc<'_, '_>, teller: &mut Teller<'_>) -> Result<()> {
        let watches = self.watches();
        let mut loses = false;
        let end = palc.follow(&watches, STEPS, &mut |palc, before, met| {
            let back = self.comes_back(palc, before);
            match met {
                Met::Zero(watch, at) => self.zero((palc, before), (watch, at), back, teller),
                Met::Point(now) => {
                    self.orbit(palc, (before, now), back, teller)?;
                    // A branch that has ended does not go on in other variables.
                    loses = self.chart.loses(&now.here.site);
                    if loses { Break(()) } else { Continue(()) }
                }
            }
        })?;
        let _ = self.settle(teller);
        if end == Stop::Observer && !loses || teller.told.is_break() {
            return Ok(());
        }
        if !self.is_vertical()
            && let Some((chart, there)) = self.chart.keeping(&palc.now.here.site)
        {
            let mut corrector = new_corrector(chart.family())?;
            let longest = palc.curve.settings.longest;
            if let Some(mut palc) = Palc::resumed(&mut corrector, palc, there, longest) {
                self.chart = chart;
                return self.go(&mut palc, teller);
            }
        }
        if self.inside {
            let why = match loses {
                true => {
                    "both parts come so near each other that their difference is lost".to_owned()
                }
                false => end.to_string(),
            };
            let point = self.end(&palc.now.here, &why);
            let _ = self.tell(GeneralEvent::Special(point), teller);
        }
        Ok(())
    }

    pub fn row(&self, orbit: &Regular, label: Option<Label>) -> GeneralPoint {
        self.set.row(self.number, self.chart, orbit, label)
    }

    pub fn tell(&mut self, event: GeneralEvent, teller: &mut Teller<'_>) -> ControlFlow<()> {
        self.set.begins(self.number);
        teller.tell(match event {
            GeneralEvent::Row(point) => GeneralEvent::Row(self.on_branch(point)),
            GeneralEvent::Special(point) => GeneralEvent::Special(self.on_branch(point)),
        })
    }

    /// A special point and its row.
    pub fn special(&mut self, point: GeneralPoint, teller: &mut Teller<'_>) -> ControlFlow<()> {
        self.set.begins(self.number);
        teller.special(self.on_branch(point))
    }

    /// A point of this branch, of whose symmetry it is told.
    fn on_branch(&self, point: GeneralPoint) -> GeneralPoint {
        GeneralPoint {
            number: self.number,
            symmetry: self.chart.symmetry(),
            ..point
        }
    }

    /// Tells what seemed to be a fold. On a step on which the parameter turns once one fold is met: then it is a pitchfork beside it.
    pub fn settle(&mut self, teller: &mut Teller<'_>) -> ControlFlow<()> {
        match self.unsure.take() {
            Some((_, near)) if self.turned => {
                let pitchfork = self.row(&near, Some(Label::Pf));
                self.special(pitchfork, teller)
            }
            Some((fold, _)) => self.special(fold, teller),
            None => Continue(()),
        }
    }

    /// The next orbit: whether the branch goes on.
    fn orbit(
        &mut self,
        palc: &mut Palc<'_, '_>,
        (before, now): (&DirectedPoint, &DirectedPoint),
        back: Option<Back>,
        teller: &mut Teller<'_>,
    ) -> ControlFlow<()> {
        self.settle(teller)?;
        let has_folded = std::mem::replace(&mut self.turned, false);
        let here = &now.here;
        let site = &here.site;
        let last = &before.here.site;
        let ends_at = palc.ends_at_coordinate(last, &self.set.coordinates);
        if let Some(i) = ends_at.filter(|&i| grows_as_at(&self.set.hopfs[i].1, self.chart, here)) {
            self.shrinks(i, here, teller);
            return Break(());
        }
        if self.chart.merges(site, last) {
            self.merges(last, teller);
            return Break(());
        }
        let turns = now.direction.parameters[FREE] * before.direction.parameters[FREE] <= 0.0;
        if turns && !has_folded && self.meets_itself(palc, (before, now), teller) {
            return Break(());
        }
        match back {
            Some(Back::Through(i)) => {
                self.set.doublings[i].visited = true;
                return Break(());
            }
            Some(Back::Jumped) => {
                let why = "it has come onto the branch that it parted from";
                let point = self.end(here, why);
                let _ = self.tell(GeneralEvent::Special(point), teller);
                return Break(());
            }
            None => {}
        }
        if let Some(together) = self.outside.come_to(self.chart.family(), here)
            && self.set.inside(together.orbit.site.at[FREE])
        {
            let point = together.point(self.number, self.chart);
            self.special(point, teller)?;
        }
        if !self.set.inside(site.at[FREE]) {
            let strays = self.set.strays(site.at[FREE], self.began);
            return if self.inside || strays {
                Break(())
            } else {
                Continue(())
            };
        }
        self.inside = true;
        self.periods.push(site.at[FREE], site.shooting.period());
        let row = self.row(here, None);
        self.tell(GeneralEvent::Row(row), teller)?;
        let end = match self.periods.grow_in_place() {
            true => self.homoclinic_end(here),
            false => None,
        };
        match end.or_else(|| self.vertical_end(palc, now)) {
            Some(end) => {
                let _ = self.tell(GeneralEvent::Special(end), teller);
                Break(())
            }
            None => Continue(()),
        }
    }

    /// The branch shrinks to a Hopf point.
    fn shrinks(&mut self, i: usize, here: &Regular, teller: &mut Teller<'_>) {
        let point = if self.from_hopf == Some(i) {
            // One branch begins at a Hopf point: along a canard a step has turned round.
            let why = "the branch returns along itself to the Hopf point where it began";
            self.end(here, why)
        } else {
            self.set.reached[i] = true;
            let point = self.set.hopfs[i].1.clone();
            if !self.set.inside(point.at[FREE]) {
                return;
            }
            point
        };
        let _ = self.tell(GeneralEvent::Special(point), teller);
    }

    /// An asymmetric branch has met the symmetric one.
    fn merges(&mut self, last: &ContinuationPoint, teller: &mut Teller<'_>) {
        let (chart, site) = self.chart.symmetric(last);
        let across = [WatchedFunction::TestFunction(TestFunction::Transverse)];
        let Some(sharp) = refined(chart.family(), &site, &[FREE], &across) else {
            return;
        };
        let coordinate = sharp.orbit.site.at[FREE];
        self.set.merged.push(coordinate);
        if self.set.inside(coordinate) {
            let way = chart.normal_form(&sharp.orbit.site, Form::Pitchfork);
            let point = refined_point((chart, self.number), &sharp, Label::Pf);
            let _ = self.tell(GeneralEvent::Special(point.classified(way)), teller);
        }
    }

    /// The crossing that an orbit is next to.
    pub fn crossing_at(&self, site: &ContinuationPoint) -> Option<usize> {
        let near = |one: &Crossing| {
            let period = one.period.value;
            (one.at.value - site.at[FREE]).abs() < NEAR.0
                && (site.shooting.period() / period - 1.0).abs() < NEAR.1
                && one.times == self.times
        };
        self.set.crossings.iter().position(near)
    }

    /// Whether a branch of doubled orbits has come back, on the step from `before`, to one that goes round once only.
    fn comes_back(&self, palc: &mut Palc<'_, '_>, before: &DirectedPoint) -> Option<Back> {
        /// Below this, in parts of how far the orbit goes, both rounds are the same one.
        const ONE: f64 = 1e-7;
        if self.times == 0 {
            return None;
        }
        let DirectedPoint { here, direction } = &palc.now;
        let turned = direction.parameters[FREE] * before.direction.parameters[FREE] <= 0.0;
        if turned && let Some(i) = self.doubling_at(&here.site) {
            return Some(Back::Through(i));
        }
        let ContinuationPoint { shooting, at } = &here.site;
        let field = palc.curve.corrector.family.field(*at);
        let half = 0.5 * shooting.period();
        let tracer = &mut palc.curve.corrector.tracer;
        let first = &shooting.nodes[0];
        let after = tracer.flow(&field, first, half, None).ok()?;
        let off = (field.turned(after, first) - first).component_div(&shooting.sizes());
        (off.amax() < ONE).then_some(Back::Jumped)
    }

    /// The period doubling that a branch of doubled orbits, whose parameter turns, is back at.
    pub fn doubling_at(&self, site: &ContinuationPoint) -> Option<usize> {
        let near = |one: &Doubling| {
            let period = 2.0 * one.orbit.site.shooting.period();
            (one.orbit.site.at[FREE] - site.at[FREE]).abs() < NEAR.0
                && (site.shooting.period() / period - 1.0).abs() < NEAR.1
                && one.before + 1 == self.times
        };
        self.set.doublings.iter().position(near)
    }

    /// Whether this is the orbit that it begins with.
    pub fn is_begin(&self, site: &ContinuationPoint) -> bool {
        let apart = |begin: &ContinuationPoint| {
            let periods = site.shooting.period() / begin.shooting.period();
            (site.at[FREE] - begin.at[FREE])
                .abs()
                .max(periods.ln().abs())
        };
        self.begin.as_ref().is_some_and(|begin| {
            // Under a forcing other orbits have that period too.
            apart(begin) < SAME && self.set.are_same(self.chart, (site, begin))
        })
    }
}
