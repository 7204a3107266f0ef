//! One branch of periodic orbits, followed to its end.

use super::branch::{Branches, Doubling, ROUGH};
use super::chart::{Chart, embedded, middle};
use super::detect::Watch;
use super::follow::{End, Met, follow};
use super::normal_form::{Form, normal_form};
use super::rows::row;
use super::sharp::{Exactly, Sharp, rough, sharpened, special};
use crate::bifurcation::{BranchRow, Event, Label, Seen, Special};
use crate::error::Result;
use crate::orbit::{Corrector, Family, Indicator, OverParted, Regular, Site, Walk};
use std::any::Any;
use std::ops::ControlFlow::{self, Break, Continue};

/// The most steps on a branch.
const STEPS: usize = 5000;

/// How a branch goes on.
pub(super) struct Course<'b, 'r, const N: usize> {
    branches: &'b mut Branches<'r>,
    number: usize,
    /// The orbit before, and the change of the free parameter there.
    last: Site<N>,
    slope: f64,
    /// Whether it has been in the range.
    inside: bool,
    told: bool,
    /// How often the period has doubled.
    pub times: usize,
}

type Walker<'w, 'c, 'f, F, const N: usize> = &'w mut Walk<'c, 'f, F, N>;

impl<'b, 'r, const N: usize> Course<'b, 'r, N> {
    pub fn new<F: Family<N>>(
        branches: &'b mut Branches<'r>,
        number: usize,
        inside: bool,
        walk: &Walk<'_, '_, F, N>,
    ) -> Self {
        let free = branches.free;
        Course {
            branches,
            number,
            last: walk.pace.here.site.clone(),
            slope: walk.pace.direction.parameters[free],
            inside,
            told: false,
            times: 0,
        }
    }

    /// To the end, in other variables where these lose digits; breaks where whoever is told had enough.
    pub fn go<F: Chart<N>>(
        mut self,
        walk: Walker<'_, '_, '_, F, N>,
        seen: Seen<'_>,
    ) -> Result<ControlFlow<()>> {
        let end = self.along(walk, seen)?;
        if end == End::Told {
            return Ok(if self.told { Break(()) } else { Continue(()) });
        }
        let site = &walk.pace.here.site;
        let (family, path, length) = (*walk.corrector.family, walk.path.clone(), walk.length);
        let kept = family.keeping(site);
        if let Some((parted, there)) = kept {
            let afar = walk.afar();
            let mut corrector = Corrector::<_, 3>::new(&parted, ROUGH)?;
            if let Some(mut walk) = Walk::resumed(&mut corrector, path, there, afar, length) {
                let course = Course::<3> {
                    last: walk.pace.here.site.clone(),
                    branches: self.branches,
                    number: self.number,
                    slope: self.slope,
                    inside: self.inside,
                    told: false,
                    times: self.times,
                };
                return course.go::<OverParted>(&mut walk, seen);
            }
        }
        if self.inside {
            let mut special = rough(Label::Mx, &family.usual(site));
            special.note = Some(end.words().into());
            let _ = self.tell(Event::Special(special), seen);
        }
        Ok(if self.told { Break(()) } else { Continue(()) })
    }

    fn along<F: Chart<N>>(
        &mut self,
        walk: Walker<'_, '_, '_, F, N>,
        seen: Seen<'_>,
    ) -> Result<End> {
        let watches = self.watches();
        let mut failed = None;
        let mut lost = false;
        let end = follow(walk, &watches, STEPS, &mut |walk, met| {
            let met = match met {
                Met::Zero(watch, at) => self.zero(walk, watch, at, seen),
                Met::Orbit(pace) => {
                    let met = self.orbit(walk, &pace.here, seen);
                    self.last = pace.here.site.clone();
                    self.slope = pace.direction.parameters[self.branches.free];
                    match met {
                        // A branch that has ended does not go on in other variables.
                        Ok(Continue(())) if walk.corrector.family.loses(&self.last) => {
                            lost = true;
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
        });
        match failed {
            Some(error) => Err(error),
            None if lost && !self.told => Ok(End::Stuck),
            None => Ok(end),
        }
    }

    fn watches(&self) -> Vec<Watch> {
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

    fn tell(&mut self, event: Event, seen: Seen<'_>) -> ControlFlow<()> {
        let told = seen(event);
        self.told |= told.is_break();
        told
    }

    /// The next orbit: its row, and whether the branch goes on.
    fn orbit<F: Chart<N>>(
        &mut self,
        walk: &Walk<'_, '_, F, N>,
        here: &Regular<N>,
        seen: Seen<'_>,
    ) -> Result<ControlFlow<()>> {
        let site = &here.site;
        let coordinate = site.at[self.branches.free];
        if let Some(end) = walk.vanishes(&self.last)
            && let Some(i) = self.hopf_at(end, coordinate)
        {
            self.shrunk(i, seen);
            return Ok(Break(()));
        }
        let family = walk.corrector.family;
        if family.merges(site, &self.last) {
            self.merged(&family.usual(&self.last), seen);
            return Ok(Break(()));
        }
        if self.times > 0 && self.back(walk.pace.direction.parameters[self.branches.free], site) {
            return Ok(Break(()));
        }
        if !self.branches.in_range(coordinate) {
            return Ok(Continue(()));
        }
        self.inside = true;
        let mut row = row(family, self.number, here, None)?;
        self.held(&mut row);
        Ok(self.tell(Event::Branch(row), seen))
    }

    /// The Hopf point where the amplitude of the branch, which is at `here` now, is predicted to be zero.
    fn hopf_at(&self, end: f64, here: f64) -> Option<usize> {
        /// What the prediction may err by: part of the way that is left, and rounding.
        const PART: f64 = 0.2;
        const ROUNDING: f64 = 1e-6;
        let Branches { hopfs, free, .. } = &*self.branches;
        (0..hopfs.len()).find(|&i| {
            let hopf = hopfs[i].at()[*free];
            (end - hopf).abs() < PART * (here - hopf).abs() + ROUNDING
        })
    }

    /// At the other Hopf point of the branch.
    fn shrunk(&mut self, i: usize, seen: Seen<'_>) {
        self.branches.reached[i] = true;
        let coordinate = self.branches.hopfs[i].at()[self.branches.free];
        if self.branches.in_range(coordinate) {
            let special = self.branches.hopf(i);
            let _ = self.tell(Event::Special(special), seen);
        }
    }

    /// An asymmetric branch has met the symmetric one.
    fn merged(&mut self, last: &Site<N>, seen: Seen<'_>) {
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
            self.held_at(&mut special);
            self.criticality_of_pitchfork(&mut special, &sharp.orbit);
            let _ = self.tell(Event::Special(special), seen);
        }
    }

    /// Whether a branch of doubled orbits has come back to a period doubling: there the parameter turns.
    fn back(&mut self, slope: f64, site: &Site<N>) -> bool {
        /// Of the turn in the coordinate, and of the period from twice that at the doubling.
        const NEAR: (f64, f64) = (2e-3, 1e-3);
        if slope * self.slope > 0.0 {
            return false;
        }
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
    fn zero<F: Chart<N>>(
        &mut self,
        walk: Walker<'_, '_, '_, F, N>,
        watch: Watch,
        at: &Regular<N>,
        seen: Seen<'_>,
    ) -> Result<ControlFlow<()>> {
        let Some(label) = self.label(walk, watch, at) else {
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
        self.held(&mut row);
        self.held_at(&mut special);
        if let Watch::Value(_, value) = watch {
            let (exact, place) = self.exactly(value);
            if let Some(exact) = exact {
                let of_row = if place == 0 {
                    &mut row.driving
                } else {
                    &mut row.stiffness
                };
                *of_row = exact;
                let of_special = if place == 0 {
                    &mut special.driving
                } else {
                    &mut special.stiffness
                };
                (of_special.value, of_special.uncertainty) = (exact, 0.0);
            }
        }
        if let Some(sharp) = &sharp {
            self.remember(family, label, sharp, &mut special);
        }
        if self.tell(Event::Special(special), seen).is_break()
            || self.tell(Event::Branch(row), seen).is_break()
        {
            return Ok(Break(()));
        }
        Ok(if ends { Break(()) } else { Continue(()) })
    }

    /// The parameter that does not vary, as it was given: not the exponential of its logarithm.
    fn held(&self, row: &mut BranchRow) {
        let loading = self.branches.request.slab.loading;
        if self.branches.free == 0 {
            row.stiffness = loading.stiffness;
        } else {
            row.driving = loading.driving;
        }
    }

    fn held_at(&self, special: &mut Special) {
        let loading = self.branches.request.slab.loading;
        let (place, exact) = if self.branches.free == 0 {
            (&mut special.stiffness, loading.stiffness)
        } else {
            (&mut special.driving, loading.driving)
        };
        (place.value, place.uncertainty) = (exact, 0.0);
    }

    /// What a zero means here; nothing, or nothing new, for some.
    fn label<F: Chart<N>>(
        &self,
        walk: &Walk<'_, '_, F, N>,
        watch: Watch,
        at: &Regular<N>,
    ) -> Option<Label> {
        let Branches { range, .. } = *self.branches;
        let turn = matches!(watch, Watch::Turn(_));
        if turn
            && walk
                .corrector
                .family
                .merges(&walk.pace.here.site, &self.last)
        {
            // At the pitchfork, where the branch meets its mirror image.
            return None;
        }
        let label = match watch {
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

    /// What was asked for, not the exponential of its logarithm; and of which parameter it is.
    fn exactly(&self, value: f64) -> (Option<f64>, usize) {
        let request = self.branches.request;
        let asked = [request.range.0, request.range.1];
        let mut asked = asked.iter().chain(&request.at).copied();
        (asked.find(|x| x.ln() == value), self.branches.free)
    }

    /// Which way it goes, and that branches begin here.
    fn remember<F: Chart<N>>(
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
                    self.criticality_of_pitchfork(special, orbit);
                    self.branches.pitchforks.push(orbit.clone());
                }
                return;
            }
            _ => return,
        };
        let Some(orbit) = orbit.downcast_ref::<Regular<3>>() else {
            return;
        };
        let site: &dyn Any = &family.usual(&sharp.orbit.site);
        let Some(site) = site.downcast_ref::<Site<3>>() else {
            return;
        };
        self.criticality(special, site, form);
        if label == Label::Pd && !family.loses(&sharp.orbit.site) {
            self.branches.doublings.push(Doubling {
                orbit: orbit.clone(),
                before: self.times,
            });
            self.branches.visited.push(false);
        }
    }

    fn criticality_of_pitchfork(&self, special: &mut Special, orbit: &Regular<2>) {
        self.criticality(special, &embedded(&orbit.site), Form::Pitchfork);
    }

    fn criticality(&self, special: &mut Special, site: &Site<3>, form: Form) {
        let field = self.branches.family.slab(site.at).whole();
        let (coefficient, criticality) = normal_form(&*field, &site.polygon, form);
        special.criticality = Some(criticality);
        special.coefficient = coefficient
            .uncertainty
            .is_finite()
            .then_some(coefficient.value);
    }
}
