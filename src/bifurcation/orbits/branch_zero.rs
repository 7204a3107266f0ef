//! Bifurcations on a branch of periodic orbits, and the branches that begin there.

use super::branches::Doubling;
use super::crossing::{Crossing, crossing};
use super::multipliers_together::is_real;
use super::normal_form::Form;
use super::orbit_branch::{Back, OrbitBranch};
use super::orbit_point::{special_orbit, sum_of_pair};
use super::turning::{goes_on, turns, turns_without_fold};
use crate::bifurcation::Label;
use crate::bifurcation::general::{FREE, GeneralPoint, Teller};
use crate::orbit::{DirectedPoint, Palc, Regular, TestFunction, WatchedFunction};
use std::ops::ControlFlow::{self, Break, Continue};

/// Two special points of one turn coincide if their parameters differ by less than this part of the parameter. It is some orders above rounding, so
/// that rounding does not decide which points are listed.
const COINCIDE: f64 = 1e-12;

/// The step on which something is zero: the continuation at its end, and where it began.
type Step<'p, 'c, 'f> = (&'p Palc<'c, 'f>, &'p DirectedPoint);

impl OrbitBranch<'_, '_, '_> {
    /// Something that is watched is zero here.
    pub fn zero(
        &mut self,
        (palc, before): Step<'_, '_, '_>,
        (watch, at): (WatchedFunction, &DirectedPoint),
        back: Option<Back>,
        teller: &mut Teller<'_>,
    ) -> ControlFlow<()> {
        let near = &at.here;
        let Some(label) = self.label((palc, before), (watch, at), back) else {
            return Continue(());
        };
        let is_of_turn = [Label::Sn, Label::Pd, Label::Pf].contains(&label);
        if is_of_turn && !self.are_listed {
            return Continue(());
        }
        let ends = label == Label::Ep && self.inside;
        // Another branch has come this way from its other end.
        if label == Label::Ep && self.set.is_known(self.chart, &near.site) && !ends {
            return Break(());
        }
        self.inside |= label == Label::Ep;
        let meets = (&palc.curve.settings.free[..], &[watch][..]);
        let is_unfound =
            label == Label::Pf && watch == WatchedFunction::TestFunction(TestFunction::Fold);
        let (mut point, orbit) = match is_unfound {
            // The branch's own condition has no simple zero there.
            true => (self.crosses(near, before), None),
            false => special_orbit(self.chart, (self.number, label), near, meets),
        };
        match watch {
            WatchedFunction::Value(_, x) => point.at[FREE] = x,
            WatchedFunction::UserFunction(which) => {
                point = point.at_zero_of(&self.set.branch.watch, which);
            }
            _ => {}
        }
        // At a pitchfork two branches cross, and a direction between them may make the parameter seem to turn. But no fold is found there.
        if label == Label::Sn && orbit.is_none() {
            if goes_on(before, &palc.now) {
                point = self.crosses(near, before);
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
            Label::Pf => Some(Form::Pitchfork),
            _ => None,
        };
        if let (Some(form), Some(orbit)) = (form, &orbit) {
            point = point.classified(self.chart.normal_form(&orbit.site, form));
        }
        let end = orbit.and_then(|orbit| self.remember(label, orbit, goes_on(before, &palc.now)));
        self.settle(teller)?;
        self.special(point, teller)?;
        if let Some(end) = end {
            self.special(end, teller)?;
            return Break(());
        }
        if ends { Break(()) } else { Continue(()) }
    }

    /// The point near an orbit at which another branch crosses this one, on a step that begins `before`.
    fn crosses(&mut self, near: &Regular, before: &DirectedPoint) -> GeneralPoint {
        let rough = self.row(near, Some(Label::Pf));
        // Of two equal parts the branches that cross are known otherwise.
        if self.chart.symmetry().is_some() {
            return rough;
        }
        let of = (self.number, self.times);
        let found = crossing(self.chart, near, before, of);
        let Some(crossing) = found.or_else(|| Crossing::rough(self.chart, near, before, of)) else {
            return rough;
        };
        let mut point = rough;
        let off = crossing.at.uncertainty;
        if off.is_finite() {
            point.at[FREE] = crossing.at.value;
            point.period = Some(crossing.period);
            let other = !crossing.is_pitchfork;
            point.note = other.then(|| "another branch crosses this one".to_owned());
        }
        match self.crossing_at(&near.site) {
            None => self.set.crossings.push(crossing),
            // Both branches are known.
            Some(i) => self.set.crossings[i].visited |= self.set.crossings[i].of != self.number,
        }
        point.placed(self.set.branch.system.family, [off, 0.0])
    }

    /// The label of a zero; `None` where it is no bifurcation, or one that is known.
    fn label(
        &mut self,
        (palc, before): Step<'_, '_, '_>,
        (watch, at): (WatchedFunction, &DirectedPoint),
        back: Option<Back>,
    ) -> Option<Label> {
        let branch = self.set.branch;
        let (from, to) = branch.range;
        let near = &at.here;
        if let WatchedFunction::TestFunction(test_function) = watch {
            if test_function == TestFunction::Torus && is_real(near) {
                return None;
            }
            self.outside.passes(test_function);
        }
        if back == Some(Back::Jumped) {
            return None;
        }
        Some(match watch {
            // It begins at this value but for rounding.
            WatchedFunction::Value(..) if self.is_begin(&near.site) => return None,
            WatchedFunction::Value(_, x) if x == from || x == to => Label::Ep,
            _ if !self.set.inside(near.site.at[FREE]) => return None,
            WatchedFunction::Value(_, x) if self.set.begin == Some(x) => {
                self.set.is_known(self.chart, &near.site);
                if !branch.at.contains(&x) {
                    return None;
                }
                Label::Uz
            }
            WatchedFunction::Value(..) => Label::Uz,
            WatchedFunction::UserFunction(_) => Label::Uf,
            WatchedFunction::TestFunction(TestFunction::Doubling) => Label::Pd,
            WatchedFunction::TestFunction(TestFunction::Torus) if sum_of_pair(near).abs() < 2.0 => {
                Label::Tr
            }
            WatchedFunction::TestFunction(TestFunction::Transverse) => Label::Pf,
            // Where the parameter does not vary what looks like a fold is noise.
            WatchedFunction::Turn(_) | WatchedFunction::TestFunction(TestFunction::Fold)
                if self.is_vertical() =>
            {
                return None;
            }
            // At the doubling that a branch of doubled orbits has come back to the parameter turns, and that is no fold.
            WatchedFunction::Turn(_) | WatchedFunction::TestFunction(TestFunction::Fold)
                if back.is_some() || self.times > 0 && self.doubling_at(&near.site).is_some() =>
            {
                return None;
            }
            // At the pitchfork, where the branch meets its mirror image.
            WatchedFunction::Turn(_)
                if self.chart.merges(&palc.now.here.site, &before.here.site) =>
            {
                return None;
            }
            // Likewise, where the symmetry is not known.
            WatchedFunction::Turn(_)
                if self.chart.symmetry().is_none() && turns_without_fold(before, &palc.now) =>
            {
                return None;
            }
            WatchedFunction::Turn(_) => Label::Sn,
            WatchedFunction::TestFunction(TestFunction::Fold) => {
                match turns(before, at, &palc.now) {
                    true => Label::Sn,
                    false => Label::Pf,
                }
            }
            // A neutral saddle.
            WatchedFunction::TestFunction(_) => return None,
        })
    }

    /// That branches begin at a bifurcation; where the branch ends there, its end.
    fn remember(&mut self, label: Label, orbit: Regular, goes_on: bool) -> Option<GeneralPoint> {
        match label {
            Label::Pd if !self.chart.loses(&orbit.site) => {
                let visited = self.set.is_doubled(&orbit.site);
                self.set.doublings.push(Doubling {
                    orbit,
                    before: self.times,
                    visited,
                });
            }
            Label::Pf => self.set.pitchforks.push(orbit),
            Label::Sn => {
                self.turned |= !goes_on;
                let site = &orbit.site;
                self.folds.push(site.at[FREE], site.shooting.period());
                return self.winding_end(&orbit);
            }
            _ => {}
        }
        None
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
}
