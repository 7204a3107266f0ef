//! One branch of periodic orbits: what is on it, and where it ends.

use super::growing_period::{Folds, Limit, Periods, Saddle};
use super::multipliers_together::{Outside, is_real};
use super::orbit_point::{special_orbit, sum_of_pair};
use super::orbits::OrbitBranches;
use super::turning::{goes_on, turns};
use super::{FREE, GeneralEvent, GeneralPoint, GeneralSolution, SAME, Teller};
use crate::bifurcation::Label;
use crate::bifurcation::orbits::normal_form::{Form, normal_form};
use crate::bifurcation::orbits::{Vertical, embedded, middle, refined};
use crate::continuation::{Met, Stop};
use crate::error::Result;
use crate::field::Vector;
use crate::number::Uncertain;
use crate::orbit::{
    ContinuationPoint, DirectedPoint, Palc, Regular, TestFunction, WatchedFunction,
};
use std::cell::OnceCell;
use std::ops::ControlFlow::{self, Break, Continue};

/// The most steps on a branch.
const STEPS: usize = 5000;

/// How many of the last orbits of a branch may say nothing of its limit.
const LEFT_OUT: usize = 4;

/// Two special points of one turn coincide if their parameters differ by less than this part of the parameter. It is some orders above rounding, so
/// that rounding does not decide which points are listed.
const COINCIDE: f64 = 1e-12;

/// One branch.
pub(super) struct OrbitBranch<'s, 'b, 'a> {
    set: &'s mut OrbitBranches<'b, 'a>,
    number: usize,
    times: usize,
    inside: bool,
    /// The orbit that it begins with, which it does not come to again.
    pub begin: Option<ContinuationPoint>,
    /// The place of the Hopf point at which it begins.
    pub from_hopf: Option<usize>,
    periods: Periods,
    folds: Folds,
    /// Whether a fold was met on the step that is looked at.
    turned: bool,
    /// What seems to be a fold there, as the parameter turns, but could not be found as one.
    unsure: Option<(GeneralPoint, Regular)>,
    outside: Outside,
    /// The label and parameter of the last fold, period doubling or pitchfork, and whether further ones are listed.
    last: Option<(Label, f64)>,
    are_listed: bool,
    /// While the parameter does not vary.
    vertical: Option<Vertical>,
}

impl<'s, 'b, 'a> OrbitBranch<'s, 'b, 'a> {
    pub fn new(
        set: &'s mut OrbitBranches<'b, 'a>,
        number: usize,
        times: usize,
        inside: bool,
    ) -> Self {
        OrbitBranch {
            set,
            number,
            times,
            inside,
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

    pub fn go(mut self, palc: &mut Palc<'_, '_>, teller: &mut Teller<'_>) -> Result<()> {
        let watches = self.watches();
        let end = palc.follow(&watches, STEPS, &mut |palc, before, met| match met {
            Met::Zero(watch, at) => self.zero((palc, before), watch, at, teller),
            Met::Point(now) => self.orbit(palc, now, before, teller),
        })?;
        let _ = self.settle(teller);
        if end != Stop::Observer && self.inside {
            let point = self.end(&palc.now.here, &end.to_string());
            let _ = self.tell(GeneralEvent::Special(point), teller);
        }
        Ok(())
    }

    /// Where the branch goes no further, or tends to.
    fn end(&self, last: &Regular, why: &str) -> GeneralPoint {
        self.homoclinic_end(last).unwrap_or_else(|| GeneralPoint {
            note: Some(why.to_owned()),
            ..self.set.row(self.number, last, Some(Label::Mx))
        })
    }

    /// Where the branch tends to as its period grows without bound, if it does.
    fn homoclinic_end(&self, last: &Regular) -> Option<GeneralPoint> {
        // What is left of the way may be less than the last orbits are off by.
        let mut periods = self.periods.clone();
        let mut left_out = 0;
        let branch = self.set.branch;
        let passed = OnceCell::new();
        let saddle = || passed.get_or_init(|| Saddle::passed(branch, last)).as_ref();
        let limit = loop {
            let limit = periods.limit(branch, &saddle);
            if limit.is_some() || (left_out >= LEFT_OUT && !periods.stay()) {
                break limit?;
            }
            periods.pop();
            left_out += 1;
        };
        let point = self.set.row(self.number, last, None);
        let unlisted = match self.are_listed {
            true => "",
            false => "; folds and period doublings of its last turns coincide, and are not listed",
        };
        let why = format!("the period grows without bound{unlisted}");
        Some(self.longest(point, limit, why))
    }

    /// The end of a branch whose period grows without bound; all but that as at its last orbit.
    fn longest(&self, last: GeneralPoint, limit: Limit, why: String) -> GeneralPoint {
        let Limit { at, is_saddle_node } = limit;
        let end = GeneralPoint {
            label: Some(Label::Hom),
            at: [at.value, last.at[1]],
            saddle_node: is_saddle_node,
            period: None,
            note: Some(why),
            ..last
        };
        end.placed(self.set.branch.system.family, [at.uncertainty, 0.0])
    }

    /// The end of a branch that winds without end.
    fn winding_end(&self, last: &Regular) -> Option<GeneralPoint> {
        let [a, b] = self.folds.winding()?;
        let limit = Limit {
            at: Uncertain::new(0.5 * (a + b), 0.5 * (b - a).abs()),
            is_saddle_node: false,
        };
        let why = "the period grows without bound: the branch goes to and fro between two folds, its period longer by the same time after every turn, as \
                   beside orbits that are homoclinic to another periodic orbit";
        let point = self.set.row(self.number, last, None);
        let mut end = self.longest(point, limit, why.to_owned());
        // The middle of two coordinates need not be that of the parameters.
        let family = self.set.branch.system.family;
        let [a, b] = [a, b].map(|at| family.parameters([at, end.at[1]])[FREE]);
        let off = 0.5 * (b - a).abs() + 2.0 * f64::EPSILON * a.abs();
        end.parameters[FREE] = Uncertain::new(0.5 * (a + b), off);
        Some(end)
    }

    fn tell(&mut self, event: GeneralEvent, teller: &mut Teller<'_>) -> ControlFlow<()> {
        self.set.begins(self.number);
        teller.tell(event)
    }

    /// Where so many orbits have the same parameter that the branch is followed no further.
    fn vertical_end(
        &mut self,
        palc: &mut Palc<'_, '_>,
        now: &DirectedPoint,
    ) -> Option<GeneralPoint> {
        self.vertical = self
            .vertical
            .and_then(|vertical| vertical.and(palc, now, FREE));
        let vertical = self.vertical.filter(Vertical::is_plain)?;
        let point = GeneralPoint {
            note: Some(format!(
                "vertical branch: on {} orbits the parameter varies by no more than its error; all orbits exist at this value at once, as in \
                 a conservative system; not followed further",
                vertical.orbits()
            )),
            ..self.set.row(self.number, &now.here, Some(Label::Ep))
        };
        Some(point.placed(self.set.branch.system.family, [vertical.uncertainty(), 0.0]))
    }

    /// Tells what seemed to be a fold. On a step on which the parameter turns once one fold is met: then it is a pitchfork beside it.
    fn settle(&mut self, teller: &mut Teller<'_>) -> ControlFlow<()> {
        match self.unsure.take() {
            Some((_, near)) if self.turned => teller.special(self.pitchfork(&near)),
            Some((fold, _)) => teller.special(fold),
            None => Continue(()),
        }
    }

    /// The next orbit: whether the branch goes on.
    fn orbit(
        &mut self,
        palc: &mut Palc<'_, '_>,
        now: &DirectedPoint,
        before: &DirectedPoint,
        teller: &mut Teller<'_>,
    ) -> ControlFlow<()> {
        self.settle(teller)?;
        self.turned = false;
        let here = &now.here;
        let last = &before.here.site;
        let ends_at = palc.ends_at_coordinate(last, &self.set.coordinates);
        if let Some(i) = ends_at.filter(|&i| grows_as_at(&self.set.hopfs[i].1, here)) {
            if self.from_hopf == Some(i) {
                // One branch begins at a Hopf point: along a canard a step has turned round.
                let why =
                    "it comes back to the Hopf point that it begins at, the way that it has gone";
                let point = self.end(here, why);
                let _ = self.tell(GeneralEvent::Special(point), teller);
                return Break(());
            }
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
            teller.special(together.point(self.number, family))?;
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

    /// Whether this special point and the previous one are of different kinds and have the same parameter, on a branch that oscillates about a known
    /// limit. Near such a limit every turn has both points, ever closer together.
    fn turns_coincide(&mut self, now: (Label, f64), near: &Regular) -> bool {
        let before = self.last.replace(now);
        let coincides = |(label, at): (Label, f64)| {
            label != now.0 && (at - now.1).abs() <= COINCIDE * at.abs().max(now.1.abs())
        };
        before.is_some_and(coincides)
            && self.folds.close_in()
            && self.homoclinic_end(near).is_some()
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
        (palc, before): (&Palc<'_, '_>, &DirectedPoint),
        watch: WatchedFunction,
        at: &DirectedPoint,
        teller: &mut Teller<'_>,
    ) -> ControlFlow<()> {
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
                match turns(before, at, &palc.now) {
                    true => Label::Sn,
                    false => Label::Pf,
                }
            }
            _ => return Continue(()),
        };
        let is_of_turn = [Label::Sn, Label::Pd, Label::Pf].contains(&label);
        if is_of_turn && !self.are_listed {
            return Continue(());
        }
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
        // At a pitchfork two branches cross, and a direction between them may make the parameter seem to turn. But no fold is found there.
        if label == Label::Sn && orbit.is_none() {
            if goes_on(before, &palc.now) {
                point = self.pitchfork(near);
            } else {
                self.settle(teller)?;
                self.set.begins(self.number);
                self.unsure = Some((point, near.clone()));
                return Continue(());
            }
        }
        if is_of_turn {
            self.are_listed = !self.turns_coincide((label, point.parameters[FREE].value), near);
        }
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
        let end = match (label, orbit) {
            (Label::Pd, Some(orbit)) => {
                self.set.doublings.push((orbit, self.times, false));
                None
            }
            (Label::Sn, Some(orbit)) => {
                let site = &orbit.site;
                self.turned |= !goes_on(before, &palc.now);
                self.folds.push(site.at[FREE], site.shooting.period());
                self.winding_end(&orbit)
            }
            _ => None,
        };
        self.settle(teller)?;
        self.set.begins(self.number);
        teller.special(point)?;
        if let Some(end) = end {
            teller.special(end)?;
            return Break(());
        }
        if ends { Break(()) } else { Continue(()) }
    }
}

/// Whether all multipliers of an orbit are about those at a Hopf point. Else the branch has yet to pass what makes them so.
fn grows_as_at(hopf: &GeneralPoint, orbit: &Regular) -> bool {
    /// What a logarithm may be off, of itself and beside that; and below which all are as good as none.
    const OFF: f64 = 0.3;
    const NONE: f64 = -20.0;
    let (GeneralSolution::Equilibrium { eigenvalues, .. }, Some(period)) =
        (&hopf.solution, hopf.period)
    else {
        return true;
    };
    // One of the critical pair is the trivial multiplier.
    let mut all: Vec<f64> = eigenvalues.iter().map(|z| z.re * period.value).collect();
    let critical = (0..all.len()).min_by(|&i, &j| all[i].abs().total_cmp(&all[j].abs()));
    if let Some(critical) = critical {
        all.remove(critical);
    }
    all.sort_by(|a, b| b.total_cmp(a));
    let near = |(at_hopf, here): (&f64, &f64)| {
        let (a, b) = (at_hopf.max(NONE), here.max(NONE));
        here.is_nan() || (a - b).abs() <= OFF * (1.0 + a.abs())
    };
    all.iter().zip(&orbit.log_multipliers()).all(near)
}
