//! One branch of periodic orbits, followed to its end.

use super::branch::{BranchSet, Doubling, new_corrector};
use super::chart::{Chart, embedded, middle};
use super::cubic_coefficient::CubicCoefficient;
use super::normal_form::Form;
use super::refine::{refined, rough, special};
use super::rows::{GivenParameters, asked, row};
use super::vertical::Vertical;
use crate::bifurcation::{Event, EventObserver, Label, Special};
use crate::continuation::{Met, Stop};
use crate::equilibrium::Symmetry;
use crate::error::Result;
use crate::orbit::{
    ContinuationPoint, DirectedPoint, Palc, Regular, TestFunction, WatchedFunction,
};
use std::ops::ControlFlow::{self, Break, Continue};

/// The most steps on a branch.
const STEPS: usize = 5000;

/// How a branch goes on.
pub(super) struct OrbitBranch<'b, 'r, 's> {
    pub branches: &'b mut BranchSet<'r>,
    pub number: usize,
    /// The variables that orbits are in at the moment.
    chart: Chart,
    /// Whether it has been in the range.
    pub inside: bool,
    /// The coordinate where it began.
    begin: f64,
    /// How often the period has doubled.
    pub times: usize,
    seen: EventObserver<'s>,
    told: ControlFlow<()>,
    /// As long as the parameter has not varied.
    vertical: Option<Vertical>,
}

/// How a branch of doubled orbits ends at one of orbits that go round once.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
enum Back {
    /// Through the period doubling.
    Through,
    /// Newton's method has left the branch.
    Jumped,
}

impl<'b, 'r, 's> OrbitBranch<'b, 'r, 's> {
    pub fn new(
        branches: &'b mut BranchSet<'r>,
        number: usize,
        chart: Chart,
        begin: f64,
        seen: EventObserver<'s>,
    ) -> Self {
        let inside = branches.in_range(begin);
        OrbitBranch {
            branches,
            number,
            chart,
            inside,
            begin,
            times: 0,
            seen,
            told: Continue(()),
            vertical: Some(Vertical::default()),
        }
    }

    /// To the end, in other variables where these lose digits; breaks where whoever is told had enough.
    pub fn go(mut self, palc: &mut Palc<'_, '_>) -> Result<ControlFlow<()>> {
        let end = self.along(palc)?;
        if end == Some(Stop::Observer) {
            return Ok(self.told);
        }
        if let Some(vertical) = self.vertical.filter(Vertical::is_shown) {
            let special = vertical.end(palc, self.chart, self.branches.free, self.given(None));
            let _ = self.tell(Event::Special(special));
            return Ok(self.told);
        }
        let site = &palc.now.here.site;
        if let Some((chart, there)) = self.chart.keeping(site) {
            let mut corrector = new_corrector(chart.family())?;
            if let Some(mut palc) =
                Palc::resumed(&mut corrector, palc, there, palc.curve.settings.longest)
            {
                self.chart = chart;
                return self.go(&mut palc);
            }
        }
        if self.inside {
            let mut special = rough(Label::Mx, &self.chart.usual(site));
            special.note = Some(end.map_or_else(
                || "the interfaces come so near each other that their difference is lost".into(),
                |end| end.to_string(),
            ));
            let _ = self.tell(Event::Special(special));
        }
        Ok(self.told)
    }

    /// In the same variables throughout; `None` where these lose digits, or where the branch is vertical.
    fn along(&mut self, palc: &mut Palc<'_, '_>) -> Result<Option<Stop>> {
        let (mut failed, mut left) = (None, false);
        let end = palc.follow(&self.watches(), STEPS, &mut |palc, before, met| {
            let last = &before.here.site;
            let met = match met {
                Met::Zero(watch, at) => {
                    let back = self.comes_back(palc, before);
                    self.zero(palc, watch, &at.here, last, back)
                }
                Met::Point(now) => {
                    let back = self.comes_back(palc, before);
                    let loses = self.chart.loses(&now.here.site);
                    match self.orbit(palc, now, last, back) {
                        // A branch that has ended does not go on in other variables.
                        Ok(Continue(())) if loses || self.is_vertical(palc, now) => {
                            left = true;
                            Ok(Break(()))
                        }
                        met => met,
                    }
                }
            };
            met.unwrap_or_else(|error| {
                failed = Some(error);
                Break(())
            })
        })?;
        match failed {
            Some(error) => Err(error),
            None => Ok((!left).then_some(end)),
        }
    }

    /// Whether so much of the branch has been vertical that it is followed no further.
    fn is_vertical(&mut self, palc: &mut Palc<'_, '_>, now: &DirectedPoint) -> bool {
        let free = self.branches.free;
        self.vertical = self
            .vertical
            .and_then(|vertical| vertical.and(palc, now, free));
        self.vertical.is_some_and(|vertical| vertical.is_enough())
    }

    fn watches(&self) -> Vec<WatchedFunction> {
        let BranchSet {
            free,
            range,
            request,
            ..
        } = *self.branches;
        let mut watches = vec![WatchedFunction::Turn(free)];
        if self.chart.symmetry() == Symmetry::Asymmetric {
            watches.push(WatchedFunction::TestFunction(TestFunction::Doubling));
            watches.push(WatchedFunction::TestFunction(TestFunction::Torus));
        } else if request.slab.interfaces == 2 {
            watches.push(WatchedFunction::TestFunction(TestFunction::Transverse));
        }
        let asked = request.at.iter().map(|x| x.ln());
        let values = [range.0, range.1].into_iter().chain(asked);
        watches.extend(values.map(|x| WatchedFunction::Value(free, x)));
        watches
    }

    fn tell(&mut self, event: Event) -> ControlFlow<()> {
        self.branches.begins(self.number);
        if !self.branches.tells(self.number) {
            return Continue(());
        }
        let event = event.on(self.number, self.chart.symmetry());
        let told = (self.seen)(event.against(self.branches.request.tolerance));
        if told.is_break() {
            self.told = told;
        }
        told
    }

    /// The next orbit: its row, and whether the branch goes on.
    fn orbit(
        &mut self,
        palc: &Palc<'_, '_>,
        DirectedPoint { here, .. }: &DirectedPoint,
        last: &ContinuationPoint,
        back: Option<Back>,
    ) -> Result<ControlFlow<()>> {
        let site = &here.site;
        let free = self.branches.free;
        let coordinate = site.at[free];
        if let Some(i) = palc.ends_at(last, &self.branches.hopfs) {
            self.shrunk(i);
            return Ok(Break(()));
        }
        let chart = self.chart;
        if chart.merges(site, last) {
            self.merged(&chart.usual(last));
            return Ok(Break(()));
        }
        if let Some(back) = back {
            if back == Back::Jumped {
                let mut special = rough(Label::Mx, &chart.usual(site));
                special.note =
                    Some("the walk has come onto the branch that this one parted from".into());
                let _ = self.tell(Event::Special(special));
            }
            return Ok(Break(()));
        }
        if !self.branches.in_range(coordinate) {
            return Ok(if self.strays(coordinate) {
                Break(())
            } else {
                Continue(())
            });
        }
        self.inside = true;
        let mut row = row(chart, self.number, here, None)?;
        row.given(self.given(None));
        Ok(self.tell(Event::Branch(row)))
    }

    /// Whether a branch that has not been in the range leads away from it: farther than from where it began, by much.
    fn strays(&self, coordinate: f64) -> bool {
        /// In logarithms, and in units of where it began.
        const FAR: (f64, f64) = (2.0, 2.0);
        let (from, to) = self.branches.range;
        let off = |x: f64| (from - x).max(x - to).max(0.0);
        !self.inside && off(coordinate) > FAR.0 + FAR.1 * off(self.begin)
    }

    /// At the other Hopf point of the branch.
    fn shrunk(&mut self, i: usize) {
        self.branches.reached[i] = true;
        let coordinate = self.branches.hopfs[i].at()[self.branches.free];
        if self.branches.in_range(coordinate) {
            let special = self.branches.hopf(i);
            let _ = self.tell(Event::Special(special));
        }
    }

    /// An asymmetric branch has met the symmetric one.
    fn merged(&mut self, last: &ContinuationPoint) {
        let site = middle(last);
        let across = [WatchedFunction::TestFunction(TestFunction::Transverse)];
        let free = self.branches.free;
        let chart = self.branches.chart(Symmetry::Symmetric);
        let Some(refined_point) = refined(chart.family(), &site, &[free], &across) else {
            return;
        };
        let coordinate = refined_point.orbit.site.at[free];
        self.branches.merged.push(coordinate);
        if self.branches.in_range(coordinate) {
            let mut special = refined_point.special(Label::Pf);
            special.given(self.given(None));
            self.pitchfork(&mut special, &refined_point.orbit);
            let _ = self.tell(Event::Special(special));
        }
    }

    /// Whether a branch of doubled orbits has come back, on the step from `before`, to one that goes round once only.
    fn comes_back(&mut self, palc: &mut Palc<'_, '_>, before: &DirectedPoint) -> Option<Back> {
        /// Below this both rounds are the same one.
        const SAME: f64 = 1e-6;
        if self.times == 0 {
            return None;
        }
        let DirectedPoint { here, direction } = &palc.now;
        let free = self.branches.free;
        let turned = direction.parameters[free] * before.direction.parameters[free] <= 0.0;
        if turned && self.back(&here.site) {
            return Some(Back::Through);
        }
        let ContinuationPoint { shooting, at } = &here.site;
        let field = palc.curve.corrector.family.field(*at);
        let half = 0.5 * shooting.period();
        let tracer = &mut palc.curve.corrector.tracer;
        let after = tracer.flow(&field, &shooting.nodes[0], half, None).ok()?;
        ((after - &shooting.nodes[0]).amax() < SAME).then_some(Back::Jumped)
    }

    /// Whether there is a period doubling, where the parameter turns.
    fn back(&mut self, site: &ContinuationPoint) -> bool {
        /// Of the turn in the coordinate, and of the period from twice that at the doubling.
        const NEAR: (f64, f64) = (2e-3, 1e-3);
        let free = self.branches.free;
        let near = |one: &Doubling| {
            let period = 2.0 * one.orbit.site.shooting.period();
            (one.orbit.site.at[free] - site.at[free]).abs() < NEAR.0
                && (site.shooting.period() / period - 1.0).abs() < NEAR.1
                && one.before + 1 == self.times
        };
        let found = self.branches.doublings.iter().position(near);
        if let Some(i) = found {
            self.branches.visited[i] = true;
        }
        found.is_some()
    }

    /// Something that is watched is zero here.
    fn zero(
        &mut self,
        palc: &mut Palc<'_, '_>,
        watch: WatchedFunction,
        at: &Regular,
        last: &ContinuationPoint,
        back: Option<Back>,
    ) -> Result<ControlFlow<()>> {
        // At the doubling that the branch has come back to the parameter turns, and that is no fold.
        let turns = matches!(watch, WatchedFunction::Turn(_));
        if back == Some(Back::Jumped) || back.is_some() && turns {
            return Ok(Continue(()));
        }
        let Some(label) = self.label(palc, watch, at, last) else {
            return Ok(Continue(()));
        };
        // Where the branch leaves the range it ends, where it enters it begins.
        let ends = label == Label::Ep && self.inside;
        let meets = (&palc.curve.settings.free[..], &[watch][..]);
        let (mut special, orbit) = special(self.chart, label, &at.site, meets);
        let mut row = row(
            self.chart,
            self.number,
            orbit.as_ref().unwrap_or(at),
            Some(label),
        )?;
        row.given(self.given(Some(watch)));
        // Another branch has come this way from its other end.
        if label == Label::Ep && self.branches.is_known_end(row.clone()) && !self.inside {
            return Ok(Break(()));
        }
        self.inside |= label == Label::Ep;
        special.given(self.given(Some(watch)));
        if let Some(orbit) = &orbit {
            self.remember(label, orbit, &mut special);
        }
        if self.tell(Event::Special(special)).is_break() || self.tell(Event::Branch(row)).is_break()
        {
            return Ok(Break(()));
        }
        Ok(if ends { Break(()) } else { Continue(()) })
    }

    /// The parameter that does not vary, and the other one where a value was asked for.
    fn given(&self, watch: Option<WatchedFunction>) -> GivenParameters {
        let BranchSet { free, request, .. } = *self.branches;
        let loading = request.slab.loading;
        let mut given = [Some(loading.driving), Some(loading.stiffness)];
        given[free] = match watch {
            Some(WatchedFunction::Value(_, value)) => asked(value, request.range, &request.at),
            _ => None,
        };
        given
    }

    /// What a zero means here; nothing, or nothing new, for some.
    fn label(
        &self,
        palc: &Palc<'_, '_>,
        watch: WatchedFunction,
        at: &Regular,
        last: &ContinuationPoint,
    ) -> Option<Label> {
        let BranchSet { range, .. } = *self.branches;
        let merges = || self.chart.merges(&palc.now.here.site, last);
        let label = match watch {
            // At the pitchfork, where the branch meets its mirror image.
            WatchedFunction::Turn(_) if merges() => return None,
            WatchedFunction::Value(_, value) if value == range.0 || value == range.1 => {
                return Some(Label::Ep);
            }
            WatchedFunction::Value(..) => Label::Uz,
            WatchedFunction::Turn(_) => Label::Sn,
            WatchedFunction::TestFunction(TestFunction::Doubling) => Label::Pd,
            WatchedFunction::TestFunction(TestFunction::Torus) if at.spectrum.trace.abs() < 2.0 => {
                Label::Tr
            }
            WatchedFunction::TestFunction(TestFunction::Transverse) => Label::Pf,
            // A neutral saddle.
            WatchedFunction::TestFunction(_) => return None,
        };
        let coordinate = at.site.at[self.branches.free];
        self.branches.in_range(coordinate).then_some(label)
    }

    /// Which way it goes, and that branches begin here.
    fn remember(&mut self, label: Label, orbit: &Regular, special: &mut Special) {
        let chart = self.chart;
        let symmetric = chart.symmetry() == Symmetry::Symmetric;
        let form = match label {
            Label::Pd => Form::Doubling,
            Label::Tr => Form::Torus,
            Label::Pf if symmetric => {
                self.pitchfork(special, orbit);
                self.branches.pitchforks.push(orbit.clone());
                return;
            }
            _ => return,
        };
        if symmetric {
            return;
        }
        special.goes(Some(CubicCoefficient::at(chart, &orbit.site, form)));
        if label == Label::Pd && !chart.loses(&orbit.site) {
            self.branches.doublings.push(Doubling {
                orbit: orbit.clone(),
                before: self.times,
            });
            self.branches.visited.push(false);
        }
    }

    fn pitchfork(&self, special: &mut Special, orbit: &Regular) {
        let site = embedded(&orbit.site);
        let whole = self.branches.chart(Symmetry::Asymmetric);
        special.goes(Some(CubicCoefficient::at(whole, &site, Form::Pitchfork)));
    }
}
