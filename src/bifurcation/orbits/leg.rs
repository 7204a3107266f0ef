//! One way along a curve of bifurcations.

use super::branch::ROUGH;
use super::chart::{Chart, middle};
use super::detect::Watch;
use super::follow::{End, Met, follow};
use super::locus::Locus;
use super::normal_form::{Form, normal_form};
use super::sharp::{Exactly, rough, sharpened, special};
use super::top::top;
use crate::bifurcation::{Criticality, Event, Label, LocusRequest, LocusRow, Seen, Special};
use crate::error::Result;
use crate::number::Uncertain;
use crate::orbit::{Condition, Corrector, Goal, Indicator, OverParted, Regular, Site, Walk};
use std::any::Any;
use std::ops::ControlFlow::{self, Break, Continue};

/// The most steps on a curve, each way.
const STEPS: usize = 3000;

/// R1 to R4 and the value of tr there.
const RESONANCES: [(Label, f64); 4] = [
    (Label::R1, 2.0),
    (Label::R2, -2.0),
    (Label::R3, -1.0),
    (Label::R4, 0.0),
];

/// An orbit and the logarithm of its multipliers' product.
type Decided<const N: usize> = (Site<N>, f64);

/// What is known of one way along a curve.
pub(super) struct Leg<'r, 's, const N: usize> {
    request: &'r LocusRequest,
    indicator: Indicator,
    number: usize,
    last: Option<Site<N>>,
    /// The last coefficient of the normal form.
    coefficient: Option<f64>,
    /// The last orbit at which it was decided which way the bifurcation goes, and which.
    decided: Option<(Decided<N>, Criticality)>,
    /// Who is told, or what is to be told later.
    seen: Option<Seen<'s>>,
    events: Vec<Event>,
    course: Vec<[f64; 3]>,
    /// Which way the bifurcation goes at the last orbit, where that was asked for.
    now: Option<Criticality>,
    pub told: bool,
}

impl<'r, 's, const N: usize> Leg<'r, 's, N> {
    pub fn new(locus: &Locus<'r, N>, number: usize, seen: Option<Seen<'s>>) -> Self {
        Leg {
            request: locus.request,
            indicator: locus.indicator,
            number,
            last: None,
            coefficient: None,
            decided: None,
            seen,
            events: Vec::new(),
            course: Vec::new(),
            now: None,
            told: false,
        }
    }

    /// (ln V_H, ln K, ln T) along it, and what nobody was told.
    pub fn kept(self) -> (Vec<[f64; 3]>, Vec<Event>) {
        (self.course, self.events)
    }

    fn tell(&mut self, event: Event) -> ControlFlow<()> {
        let Some(seen) = &mut self.seen else {
            self.events.push(event);
            return Continue(());
        };
        let told = seen(event);
        self.told |= told.is_break();
        told
    }

    fn watches(&self) -> Vec<Watch> {
        let request = self.request;
        let mut watches = vec![Watch::Turn(1)];
        match self.indicator {
            Indicator::Torus => {
                let resonances = RESONANCES.iter();
                watches.extend(resonances.map(|r| Watch::Indicator(Indicator::Trace(r.1))));
            }
            Indicator::Doubling | Indicator::Fold if N == 3 => {
                watches.push(Watch::Indicator(Indicator::Torus));
            }
            _ => {}
        }
        let (a, b) = request.driving;
        let drivings = [a, b].into_iter().chain(request.at_driving.iter().copied());
        watches.extend(drivings.map(|x| Watch::Value(0, x.ln())));
        let (a, b) = request.stiffness;
        let stiffnesses = [a, b]
            .into_iter()
            .chain(request.at_stiffness.iter().copied());
        watches.extend(stiffnesses.map(|x| Watch::Value(1, x.ln())));
        watches
    }

    /// To the end, in other variables where these lose digits.
    pub fn go<F: Chart<N>>(&mut self, walk: &mut Walk<'_, '_, F, N>) -> Result<()> {
        let watches = self.watches();
        let mut lost = false;
        let end = follow(walk, &watches, STEPS, &mut |walk, met| match met {
            Met::Zero(watch, at) => self.zero(walk, watch, at),
            Met::Orbit(pace) => {
                let here = &pace.here;
                let family = walk.corrector.family;
                let last = self.last.replace(here.site.clone());
                if last.is_some_and(|last| family.merges(&here.site, &last)) {
                    return self.merged(&family.usual(&here.site));
                }
                self.row(family, here, None)?;
                self.change(family, here)?;
                lost = family.loses(&here.site);
                if lost { Break(()) } else { Continue(()) }
            }
        });
        if end == End::Told && !lost || self.told {
            return Ok(());
        }
        let site = &walk.pace.here.site;
        let (family, path, length) = (*walk.corrector.family, walk.path.clone(), walk.length);
        if let Some((parted, there)) = family.keeping(site) {
            let afar = walk.afar();
            let mut corrector = Corrector::<_, 3>::new(&parted, ROUGH)?;
            if let Some(mut walk) = Walk::resumed(&mut corrector, path, there, afar, length) {
                return self.goes_on(&mut walk);
            }
        }
        let mut special = rough(Label::Mx, &family.usual(site));
        special.note = Some(end.words().into());
        let _ = self.tell(Event::Special(special));
        Ok(())
    }

    /// The same leg in three dimensions: as it is, if it has them.
    fn goes_on(&mut self, walk: &mut Walk<'_, '_, OverParted, 3>) -> Result<()> {
        let mut rest = Leg::<3> {
            request: self.request,
            indicator: self.indicator,
            number: self.number,
            last: None,
            coefficient: self.coefficient,
            decided: None,
            seen: self.seen.take(),
            events: std::mem::take(&mut self.events),
            course: std::mem::take(&mut self.course),
            now: None,
            told: false,
        };
        let gone = rest.go(walk);
        self.seen = rest.seen.take();
        (self.events, self.course, self.told) = (rest.events, rest.course, rest.told);
        gone
    }

    /// A point of the curve.
    fn row<F: Chart<N>>(
        &mut self,
        family: &F,
        here: &Regular<N>,
        label: Option<Label>,
    ) -> ControlFlow<()> {
        // The last correction was made; with old gradients a small part of it is left.
        const LEFT: f64 = 0.05;
        let uncertainty = LEFT * here.residual + 100.0 * ROUGH;
        let at = here
            .site
            .at
            .map(|x| Uncertain::new(x.exp(), uncertainty * x.exp()));
        let criticality = if self.request.criticality {
            self.criticality(family, here)
        } else {
            None
        };
        self.now = criticality;
        self.put(here, at, criticality, label)
    }

    /// Between the last decided orbit and this one the bifurcation may have changed the way that it goes: a Chenciner point, or
    /// a degenerate period doubling. By halves in K, for of the coefficient the sign alone does not depend on the plane; where
    /// neither way is decided the point is somewhere.
    fn change<F: Chart<N>>(&mut self, family: &F, here: &Regular<N>) -> ControlFlow<()> {
        let Some(now) = self.now.filter(|c| *c != Criticality::Undecided) else {
            return Continue(());
        };
        let end = (here.site.clone(), here.spectrum.volume);
        let before = self.decided.replace((end.clone(), now));
        let Some((begin, then)) = before.filter(|(_, then)| *then != now) else {
            return Continue(());
        };
        let from = self.last_of(family, (begin.clone(), then), end.clone());
        let to = self.last_of(family, (end, now), begin);
        // At the resonance 1:2 the coefficient of the doubling changes its sign through infinity.
        if self.indicator == Indicator::Doubling && from.1 * to.1 < 0.0 {
            return Continue(());
        }
        let label = if self.indicator == Indicator::Torus {
            Label::Ch
        } else {
            Label::Gpd
        };
        let (from, to) = (from.0, to.0);
        let between = |a: f64, b: f64| Uncertain::new(0.5 * (a + b), 0.5 * (a - b).abs());
        let [driving, stiffness] = [0, 1].map(|i| between(from.at[i].exp(), to.at[i].exp()));
        self.tell(Event::Special(Special {
            period: Some(between(from.polygon.period(), to.polygon.period())),
            ..Special::new(label, driving, stiffness)
        }))
    }

    /// The last orbit on the way to another that is decided as the first one is.
    fn last_of<F: Chart<N>>(
        &mut self,
        family: &F,
        ((mut from, mut volume), way): (Decided<N>, Criticality),
        (mut to, _): Decided<N>,
    ) -> Decided<N> {
        /// How near, in ln K.
        const NEAR: f64 = 1e-6;
        while (to.at[1] - from.at[1]).abs() > NEAR
            && let Ok(mut corrector) = Corrector::new(family, ROUGH)
        {
            let middle = Condition::Parameter(1, 0.5 * (from.at[1] + to.at[1]));
            let conditions = [Condition::Indicator(self.indicator), middle];
            let Some(half) = corrector.correct(from.clone(), &[0, 1], &conditions, Goal::STEP)
            else {
                break;
            };
            if self.criticality(family, &half) == Some(way) {
                (from, volume) = (half.site, half.spectrum.volume);
            } else {
                to = half.site;
            }
        }
        (from, volume)
    }

    fn put(
        &mut self,
        here: &Regular<N>,
        [driving, stiffness]: [Uncertain; 2],
        criticality: Option<Criticality>,
        label: Option<Label>,
    ) -> ControlFlow<()> {
        let [v, k] = here.site.at;
        let period = here.site.polygon.period();
        self.course.push([v, k, period.ln()]);
        let torus = self.indicator == Indicator::Torus;
        let angle = (0.5 * here.spectrum.trace).clamp(-1.0, 1.0).acos();
        let row = LocusRow {
            curve: self.number,
            driving,
            stiffness,
            period: Some(period),
            angle_over_pi: torus.then_some(angle / std::f64::consts::PI),
            criticality,
            label,
        };
        self.tell(Event::Locus(row))
    }

    /// Which way the bifurcation goes here, where that is decided by a cubic coefficient in the space of all states.
    fn criticality<F: Chart<N>>(&mut self, family: &F, here: &Regular<N>) -> Option<Criticality> {
        let form = match self.indicator {
            Indicator::Torus => Form::Torus,
            Indicator::Doubling => Form::Doubling,
            _ => return None,
        };
        let usual: &dyn Any = &family.usual(&here.site);
        let site = usual.downcast_ref::<Site<3>>()?;
        let field = family.slab().slab(site.at).whole();
        let (coefficient, criticality) = normal_form(&*field, &site.polygon, form);
        self.coefficient = Some(coefficient.value);
        Some(criticality)
    }

    fn zero<F: Chart<N>>(
        &mut self,
        walk: &mut Walk<'_, '_, F, N>,
        watch: Watch,
        at: &Regular<N>,
    ) -> ControlFlow<()> {
        let indicator = self.indicator;
        let trace = at.spectrum.trace;
        let (label, condition, ends) = match watch {
            Watch::Value(i, value) => {
                let range = [self.request.driving, self.request.stiffness][i];
                let end = value == range.0.ln() || value == range.1.ln();
                let label = if end { Label::Ep } else { Label::Uz };
                (label, Exactly::Parameter(i, value), end)
            }
            Watch::Turn(_) => return self.turn(walk, at),
            Watch::Indicator(other @ Indicator::Trace(value)) => {
                let Some((label, _)) = RESONANCES.iter().find(|r| r.1 == value) else {
                    return Continue(());
                };
                (*label, Exactly::Indicator(other), value.abs() == 2.0)
            }
            // Both multipliers are -1, or 1.
            Watch::Indicator(other) if indicator == Indicator::Doubling && trace < 0.0 => {
                (Label::R2, Exactly::Indicator(other), false)
            }
            Watch::Indicator(other) if indicator == Indicator::Fold && trace > 0.0 => {
                (Label::R1, Exactly::Indicator(other), false)
            }
            Watch::Indicator(_) => return Continue(()),
        };
        let meets = [Exactly::Indicator(indicator), condition];
        let family = walk.corrector.family;
        let sharp = sharpened(family, &at.site, &walk.path.free, &meets);
        let orbit = sharp.as_ref().map_or(at, |sharp| &sharp.orbit);
        let mut special = special(
            family,
            label,
            sharp.as_ref(),
            &at.site,
            (&walk.path.free, &meets),
        );
        if let Watch::Value(i, value) = watch {
            self.exactly(i, value, &mut special);
        }
        let criticality = if self.request.criticality {
            self.criticality(family, orbit)
        } else {
            None
        };
        special.criticality = criticality;
        special.coefficient = criticality.and(self.coefficient);
        let known = [special.driving, special.stiffness];
        self.put(orbit, known, criticality, Some(label))?;
        self.tell(Event::Special(special))?;
        if ends { Break(()) } else { Continue(()) }
    }

    /// What was asked for, not the exponential of its logarithm.
    fn exactly(&self, i: usize, value: f64, special: &mut Special) {
        let request = self.request;
        let (range, asked, place) = if i == 0 {
            (request.driving, &request.at_driving, &mut special.driving)
        } else {
            (
                request.stiffness,
                &request.at_stiffness,
                &mut special.stiffness,
            )
        };
        let mut values = [range.0, range.1].into_iter().chain(asked.iter().copied());
        if let Some(exact) = values.find(|x| x.ln() == value) {
            *place = Uncertain::new(exact, 0.0);
        }
    }

    /// K is stationary along the curve here: its largest value, if it is that.
    fn turn<F: Chart<N>>(
        &mut self,
        walk: &mut Walk<'_, '_, F, N>,
        at: &Regular<N>,
    ) -> ControlFlow<()> {
        let family = walk.corrector.family;
        if let Some(top) = top(family, &at.site, self.indicator)
            && top.largest
        {
            let [driving, stiffness] = top.at;
            self.put(&top.orbit, top.at, None, Some(Label::Top))?;
            self.tell(Event::Special(Special {
                period: Some(top.period),
                ..Special::new(Label::Top, driving, stiffness)
            }))?;
        }
        Continue(())
    }

    /// A curve of asymmetric orbits has come to symmetric ones: to the pitchfork at this K.
    fn merged(&mut self, last: &Site<N>) -> ControlFlow<()> {
        let mut special = rough(Label::Cp, &middle(last));
        special.note = Some("the curve ends on that of the pitchforks of orbits".into());
        let _ = self.tell(Event::Special(special));
        Break(())
    }
}
