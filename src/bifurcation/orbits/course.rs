//! One branch of periodic orbits, followed to its end.

use super::branch::{Branches, Doubling, walker};
use super::chart::{Chart, embedded, middle};
use super::detect::Watch;
use super::follow::{End, Met, follow};
use super::normal_form::Form;
use super::rows::{Given, asked, row};
use super::sharp::{Exactly, Sharp, rough, sharpened, special};
use super::vertical::Vertical;
use super::way::Way;
use crate::bifurcation::{Event, Label, Seen, Special};
use crate::equilibrium::Symmetry;
use crate::error::Result;
use crate::orbit::{Indicator, Pace, Regular, Site, Walk};
use std::any::Any;
use std::ops::ControlFlow::{self, Break, Continue};

/// The most steps on a branch.
const STEPS: usize = 5000;

/// How a branch goes on.
pub(super) struct Course<'b, 'r, 's> {
    pub branches: &'b mut Branches<'r>,
    pub number: usize,
    symmetry: Symmetry,
    /// Whether it has been in the range.
    pub inside: bool,
    /// The coordinate where it began.
    begin: f64,
    /// How often the period has doubled.
    pub times: usize,
    seen: Seen<'s>,
    told: bool,
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

type Walker<'w, 'c, 'f, F, const N: usize> = &'w mut Walk<'c, 'f, F, N>;

impl<'b, 'r, 's> Course<'b, 'r, 's> {
    pub fn new(
        branches: &'b mut Branches<'r>,
        (number, symmetry): (usize, Symmetry),
        begin: f64,
        seen: Seen<'s>,
    ) -> Self {
        let inside = branches.in_range(begin);
        Course {
            branches,
            number,
            symmetry,
            inside,
            begin,
            times: 0,
            seen,
            told: false,
            vertical: Some(Vertical::default()),
        }
    }

    /// To the end, in other variables where these lose digits; breaks where whoever is told had enough.
    pub fn go<F: Chart<N>, const N: usize>(
        mut self,
        walk: Walker<'_, '_, '_, F, N>,
    ) -> Result<ControlFlow<()>> {
        let end = self.along(walk)?;
        if end == Some(End::Told) {
            return Ok(if self.told { Break(()) } else { Continue(()) });
        }
        if let Some(vertical) = self.vertical.filter(Vertical::is_shown) {
            let special = vertical.end(walk, self.branches.free, self.given(None));
            let _ = self.tell(Event::Special(special));
            return Ok(if self.told { Break(()) } else { Continue(()) });
        }
        let site = &walk.pace.here.site;
        let (family, path) = (*walk.corrector.family, walk.path.clone());
        let length = (walk.length, walk.travelled());
        if let Some((parted, there)) = family.keeping(site) {
            let afar = walk.afar();
            let mut corrector = walker::<_, 3>(&parted)?;
            if let Some(mut walk) = Walk::resumed(&mut corrector, path, there, afar, length) {
                return self.go(&mut walk);
            }
        }
        if self.inside {
            let mut special = rough(Label::Mx, &family.usual(site));
            special.note = Some(end.map_or_else(
                || "the interfaces come so near each other that their difference is lost".into(),
                End::words,
            ));
            let _ = self.tell(Event::Special(special));
        }
        Ok(if self.told { Break(()) } else { Continue(()) })
    }

    /// In the same variables throughout; `None` where these lose digits, or where the branch is vertical.
    fn along<F: Chart<N>, const N: usize>(
        &mut self,
        walk: Walker<'_, '_, '_, F, N>,
    ) -> Result<Option<End>> {
        let (mut failed, mut lost, mut vertical) = (None, false, false);
        let end = follow(
            walk,
            &self.watches::<N>(),
            STEPS,
            &mut |walk, before, met| {
                let last = &before.here.site;
                let met = match met {
                    Met::Zero(watch, at) => {
                        let back = self.comes_back(walk, before);
                        self.zero(walk, watch, at, last, back)
                    }
                    Met::Orbit(pace) => {
                        let back = self.comes_back(walk, before);
                        match self.orbit(walk, pace, last, back) {
                            // A branch that has ended does not go on in other variables.
                            Ok(Continue(())) if walk.corrector.family.loses(&pace.here.site) => {
                                lost = true;
                                Ok(Break(()))
                            }
                            Ok(Continue(())) if self.is_vertical(walk, pace) => {
                                vertical = true;
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
            },
        )?;
        match failed {
            Some(error) => Err(error),
            None if lost || vertical => Ok(None),
            None => Ok(Some(end)),
        }
    }

    /// Whether so much of the branch has been vertical that it is followed no further.
    fn is_vertical<F: Chart<N>, const N: usize>(
        &mut self,
        walk: &mut Walk<'_, '_, F, N>,
        pace: &Pace<N>,
    ) -> bool {
        let free = self.branches.free;
        self.vertical = self
            .vertical
            .and_then(|vertical| vertical.and(walk, pace, free));
        self.vertical.is_some_and(|vertical| vertical.is_enough())
    }

    fn watches<const N: usize>(&self) -> Vec<Watch> {
        let Branches {
            free,
            range,
            request,
            ..
        } = *self.branches;
        let mut watches = vec![Watch::Turn(free)];
        if N == 3 {
            watches.push(Watch::Indicator(Indicator::Doubling));
            watches.push(Watch::Indicator(Indicator::Torus));
        } else if request.slab.interfaces == 2 {
            watches.push(Watch::Indicator(Indicator::Across));
        }
        let asked = request.at.iter().map(|x| x.ln());
        let values = [range.0, range.1].into_iter().chain(asked);
        watches.extend(values.map(|x| Watch::Value(free, x)));
        watches
    }

    fn tell(&mut self, event: Event) -> ControlFlow<()> {
        if !self.branches.tells(self.number) {
            return Continue(());
        }
        let event = event.on(self.number, self.symmetry);
        let told = (self.seen)(event.against(self.branches.request.tolerance));
        self.told |= told.is_break();
        told
    }

    /// The next orbit: its row, and whether the branch goes on.
    fn orbit<F: Chart<N>, const N: usize>(
        &mut self,
        walk: &Walk<'_, '_, F, N>,
        Pace { here, .. }: &Pace<N>,
        last: &Site<N>,
        back: Option<Back>,
    ) -> Result<ControlFlow<()>> {
        let site = &here.site;
        let free = self.branches.free;
        let coordinate = site.at[free];
        if let Some(i) = walk.ends_at(last, &self.branches.hopfs) {
            self.shrunk(i);
            return Ok(Break(()));
        }
        let family = walk.corrector.family;
        if family.merges(site, last) {
            self.merged(&family.usual(last));
            return Ok(Break(()));
        }
        if let Some(back) = back {
            if back == Back::Jumped {
                let mut special = rough(Label::Mx, &family.usual(site));
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
        let mut row = row(family, self.number, here, None)?;
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
    fn merged<const N: usize>(&mut self, last: &Site<N>) {
        let site = middle(last);
        let across = [Exactly::Indicator(Indicator::Across)];
        let free = self.branches.free;
        let family = self.branches.family;
        let Some(sharp) = sharpened::<_, 2>(&family, &site, &[free], &across) else {
            return;
        };
        let coordinate = sharp.orbit.site.at[free];
        self.branches.merged.push(coordinate);
        if self.branches.in_range(coordinate) {
            let mut special = sharp.special(Label::Pf);
            special.given(self.given(None));
            self.pitchfork(&mut special, &sharp.orbit);
            let _ = self.tell(Event::Special(special));
        }
    }

    /// Whether a branch of doubled orbits has come back, on the step from `before`, to one that goes round once only.
    fn comes_back<F: Chart<N>, const N: usize>(
        &mut self,
        walk: &mut Walk<'_, '_, F, N>,
        before: &Pace<N>,
    ) -> Option<Back> {
        /// Below this both rounds are the same one.
        const SAME: f64 = 1e-6;
        if self.times == 0 {
            return None;
        }
        let Pace { here, direction } = &walk.pace;
        let free = self.branches.free;
        let turned = direction.parameters[free] * before.direction.parameters[free] <= 0.0;
        if turned && self.back(&here.site) {
            return Some(Back::Through);
        }
        let Site { polygon, at } = &here.site;
        let field = walk.corrector.family.field(*at);
        let half = 0.5 * polygon.period();
        let tracer = &mut walk.corrector.tracer;
        let after = tracer.flow(&*field, &polygon.nodes[0], half, None).ok()?;
        ((after - polygon.nodes[0]).amax() < SAME).then_some(Back::Jumped)
    }

    /// Whether there is a period doubling, where the parameter turns.
    fn back<const N: usize>(&mut self, site: &Site<N>) -> bool {
        /// Of the turn in the coordinate, and of the period from twice that at the doubling.
        const NEAR: (f64, f64) = (2e-3, 1e-3);
        let free = self.branches.free;
        let near = |one: &Doubling| {
            let period = 2.0 * one.orbit.site.polygon.period();
            (one.orbit.site.at[free] - site.at[free]).abs() < NEAR.0
                && (site.polygon.period() / period - 1.0).abs() < NEAR.1
                && one.before + 1 == self.times
        };
        let found = self.branches.doublings.iter().position(near);
        if let Some(i) = found {
            self.branches.visited[i] = true;
        }
        found.is_some()
    }

    /// Something that is watched is zero here.
    fn zero<F: Chart<N>, const N: usize>(
        &mut self,
        walk: Walker<'_, '_, '_, F, N>,
        watch: Watch,
        at: &Regular<N>,
        last: &Site<N>,
        back: Option<Back>,
    ) -> Result<ControlFlow<()>> {
        // At the doubling that the branch has come back to the parameter turns, and that is no fold.
        let turns = matches!(watch, Watch::Turn(_));
        if back == Some(Back::Jumped) || back.is_some() && turns {
            return Ok(Continue(()));
        }
        let Some(label) = self.label(walk, watch, at, last) else {
            return Ok(Continue(()));
        };
        // Where the branch leaves the range it ends, where it enters it begins.
        let ends = label == Label::Ep && self.inside;
        self.inside |= label == Label::Ep;
        let meets = match watch {
            Watch::Value(i, value) => Exactly::Parameter(i, value),
            Watch::Turn(_) => Exactly::Indicator(Indicator::Fold),
            Watch::Indicator(indicator) => Exactly::Indicator(indicator),
        };
        let family = walk.corrector.family;
        let sharp = sharpened(family, &at.site, &walk.path.free, &[meets]);
        let orbit = sharp.as_ref().map_or(at, |sharp| &sharp.orbit);
        let mut row = row(family, self.number, orbit, Some(label))?;
        let mut special = special(
            family,
            label,
            sharp.as_ref(),
            &at.site,
            (&walk.path.free, &[meets]),
        );
        row.given(self.given(Some(watch)));
        special.given(self.given(Some(watch)));
        if let Some(sharp) = &sharp {
            self.remember(family, label, sharp, &mut special);
        }
        if self.tell(Event::Special(special)).is_break() || self.tell(Event::Branch(row)).is_break()
        {
            return Ok(Break(()));
        }
        Ok(if ends { Break(()) } else { Continue(()) })
    }

    /// The parameter that does not vary, and the other one where a value was asked for.
    fn given(&self, watch: Option<Watch>) -> Given {
        let Branches { free, request, .. } = *self.branches;
        let loading = request.slab.loading;
        let mut given = [Some(loading.driving), Some(loading.stiffness)];
        given[free] = match watch {
            Some(Watch::Value(_, value)) => asked(value, request.range, &request.at),
            _ => None,
        };
        given
    }

    /// What a zero means here; nothing, or nothing new, for some.
    fn label<F: Chart<N>, const N: usize>(
        &self,
        walk: &Walk<'_, '_, F, N>,
        watch: Watch,
        at: &Regular<N>,
        last: &Site<N>,
    ) -> Option<Label> {
        let Branches { range, .. } = *self.branches;
        let merges = || {
            let family = walk.corrector.family;
            family.merges(&walk.pace.here.site, last)
        };
        let label = match watch {
            // At the pitchfork, where the branch meets its mirror image.
            Watch::Turn(_) if merges() => return None,
            Watch::Value(_, value) if value == range.0 || value == range.1 => {
                return Some(Label::Ep);
            }
            Watch::Value(..) => Label::Uz,
            Watch::Turn(_) => Label::Sn,
            Watch::Indicator(Indicator::Doubling) => Label::Pd,
            Watch::Indicator(Indicator::Torus) if at.spectrum.trace.abs() < 2.0 => Label::Tr,
            Watch::Indicator(Indicator::Across) => Label::Pf,
            // A neutral saddle.
            Watch::Indicator(_) => return None,
        };
        let coordinate = at.site.at[self.branches.free];
        self.branches.in_range(coordinate).then_some(label)
    }

    /// Which way it goes, and that branches begin here.
    fn remember<F: Chart<N>, const N: usize>(
        &mut self,
        family: &F,
        label: Label,
        sharp: &Sharp<N>,
        special: &mut Special,
    ) {
        let orbit: &dyn Any = &sharp.orbit;
        let form = match label {
            Label::Pd => Form::Doubling,
            Label::Tr => Form::Torus,
            Label::Pf => {
                if let Some(orbit) = orbit.downcast_ref::<Regular<2>>() {
                    self.pitchfork(special, orbit);
                    self.branches.pitchforks.push(orbit.clone());
                }
                return;
            }
            _ => return,
        };
        let Some(orbit) = orbit.downcast_ref::<Regular<3>>() else {
            return;
        };
        special.goes(Some(Way::at(family, &sharp.orbit.site, form)));
        if label == Label::Pd && !family.loses(&sharp.orbit.site) {
            self.branches.doublings.push(Doubling {
                orbit: orbit.clone(),
                before: self.times,
            });
            self.branches.visited.push(false);
        }
    }

    fn pitchfork(&self, special: &mut Special, orbit: &Regular<2>) {
        let site = embedded(&orbit.site);
        special.goes(Some(Way::at(&self.branches.family, &site, Form::Pitchfork)));
    }
}
