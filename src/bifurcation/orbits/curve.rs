//! One curve of bifurcations, followed both ways from a point on it.

use super::branch::ROUGH;
use super::course::crosses;
use super::detect::Watch;
use super::follow::{End, Met, follow};
use super::locus::{Locus, tell};
use super::sharp::{Exactly, rough, sharpened};
use super::top::top;
use crate::bifurcation::{Event, Label, LocusRow, Seen, Special};
use crate::error::Result;
use crate::number::Uncertain;
use crate::orbit::{
    Condition, Corrector, Family, Goal, Indicator, Motion, OverLoadings, Path, Regular, Site, Walk,
};
use std::ops::ControlFlow::{self, Break, Continue};

/// The most steps on a curve, each way.
const STEPS: usize = 3000;

/// What was found on a curve, from one end to the other.
pub(super) struct Curve {
    events: Vec<Event>,
}

/// One way along a curve.
struct Leg<'l, 'r, const N: usize> {
    locus: &'l Locus<'r, N>,
    number: usize,
    last: Site<N>,
    events: Vec<Event>,
    /// Whether it came back to where it began.
    closed: bool,
}

impl Curve {
    /// The curve on which the seed lies, within the ranges that are asked for; `None` where the seed can't be corrected.
    pub fn through<const N: usize>(
        locus: &mut Locus<'_, N>,
        number: usize,
        seed: Site<N>,
    ) -> Result<Option<Self>>
    where
        OverLoadings: Family<N>,
    {
        let family = locus.family;
        let path = Path::locus(locus.indicator, locus.longest());
        let own = [Condition::Indicator(locus.indicator)];
        let mut legs = Vec::new();
        let mut ahead: Option<Motion<N>> = None;
        for _ in 0..2 {
            let mut corrector = Corrector::<_, N>::new(&family, ROUGH)?;
            let fixed = path.and(Condition::Parameter(1, seed.at[1]));
            let Some(here) = corrector.correct(seed.clone(), &path.free, &fixed, Goal::STEP)
            else {
                return Ok(None);
            };
            let Some(here) = corrector.look(here.site, &path.free, &own) else {
                return Ok(None);
            };
            let any = ahead.take().unwrap_or_else(|| here.along[0].clone());
            let Some(direction) = path.direction(&here, &any) else {
                return Ok(None);
            };
            ahead = Some(direction.clone().scaled(-1.0));
            let mut leg = Leg {
                locus: &*locus,
                number,
                last: here.site.clone(),
                events: Vec::new(),
                closed: false,
            };
            let walk = Walk::from(&mut corrector, path.clone(), here.site, direction);
            if let Some(mut walk) = walk {
                leg.go(&mut walk);
            }
            let closed = leg.closed;
            legs.push(leg.events);
            if closed {
                break;
            }
        }
        let mut legs = legs.into_iter();
        let mut events: Vec<Event> = legs.next().unwrap_or_default();
        events.reverse();
        events.extend(legs.flatten());
        Ok(Some(Curve { events }))
    }

    /// Hands on what was found.
    pub fn told(&self, seen: Seen<'_>) -> ControlFlow<()> {
        tell(self.events.iter().cloned(), seen)
    }

    /// (ln V_H, ln K, ln T) along it.
    pub fn course(&self) -> Vec<[f64; 3]> {
        let rows = self.events.iter().filter_map(|event| match event {
            Event::Locus(row) => Some([
                row.driving.value.ln(),
                row.stiffness.value.ln(),
                row.period.unwrap_or(1.0).ln(),
            ]),
            _ => None,
        });
        rows.collect()
    }
}

/// R1 to R4 and the value of tr there.
const RESONANCES: [(Label, f64); 4] = [
    (Label::R1, 2.0),
    (Label::R2, -2.0),
    (Label::R3, -1.0),
    (Label::R4, 0.0),
];

impl<const N: usize> Leg<'_, '_, N>
where
    OverLoadings: Family<N>,
{
    fn watches(&self) -> Vec<Watch> {
        let request = self.locus.request;
        let mut watches = vec![Watch::Turn(1)];
        match self.locus.indicator {
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
        let stiffnesses = [a, b].into_iter().chain(request.at_stiffness.iter().copied());
        watches.extend(stiffnesses.map(|x| Watch::Value(1, x.ln())));
        watches
    }

    fn go(&mut self, walk: &mut Walk<'_, '_, OverLoadings, N>) {
        let watches = self.watches();
        let end = follow(walk, &watches, STEPS, &mut |walk, met| match met {
            Met::Zero(watch, at) => self.zero(walk, watch, at),
            Met::Orbit(pace) => {
                if N == 3 && crosses(&pace.here.site, &self.last) {
                    return self.merged();
                }
                let away = self.row(&pace.here, None);
                self.last = pace.here.site.clone();
                away
            }
        });
        if end != End::Told {
            let mut special = rough(Label::Mx, &walk.pace.here.site);
            special.note = Some(end.words().into());
            self.events.push(Event::Special(special));
        }
    }

    /// A row, and whether the curve goes on: not where it comes back.
    fn row(&mut self, here: &Regular<N>, label: Option<Label>) -> ControlFlow<()> {
        let [driving, stiffness] = here.site.at.map(f64::exp);
        // The last correction was made; with old gradients a small part of it is left.
        const LEFT: f64 = 0.05;
        let uncertainty = LEFT * here.residual + 100.0 * ROUGH;
        let row = LocusRow {
            curve: self.number,
            driving: Uncertain::new(driving, uncertainty * driving),
            stiffness: Uncertain::new(stiffness, uncertainty * stiffness),
            period: Some(here.site.polygon.period()),
            angle_over_pi: self.angle(here),
            criticality: None,
            label,
        };
        self.events.push(Event::Locus(row));
        Continue(())
    }

    fn angle(&self, here: &Regular<N>) -> Option<f64> {
        let torus = self.locus.indicator == Indicator::Torus;
        torus.then(|| (0.5 * here.spectrum.trace).clamp(-1.0, 1.0).acos() / std::f64::consts::PI)
    }

    fn zero(
        &mut self,
        walk: &mut Walk<'_, '_, OverLoadings, N>,
        watch: Watch,
        at: &Regular<N>,
    ) -> ControlFlow<()> {
        let indicator = self.locus.indicator;
        let torus = indicator == Indicator::Torus;
        let trace = at.spectrum.trace;
        let (label, condition, ends) = match watch {
            Watch::Value(i, value) => {
                let range = [self.locus.request.driving, self.locus.request.stiffness][i];
                let end = value == range.0.ln() || value == range.1.ln();
                let label = if end { Label::Ep } else { Label::Uz };
                (label, Exactly::Parameter(i, value), end)
            }
            Watch::Turn(_) => return self.turn(walk, at),
            Watch::Indicator(other @ Indicator::Trace(value)) => {
                let (label, _) = RESONANCES[RESONANCES.iter().position(|r| r.1 == value).unwrap_or(0)];
                (label, Exactly::Indicator(other), value.abs() == 2.0)
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
        let _ = torus;
        let meets = [Exactly::Indicator(indicator), condition];
        let sharp = sharpened(walk.corrector.family, &at.site, &walk.path.free, &meets);
        let orbit = sharp.as_ref().map_or(at, |sharp| &sharp.orbit);
        let mut special = match &sharp {
            Some(sharp) => sharp.special(label),
            None => rough(label, &at.site),
        };
        let _ = self.row(orbit, Some(label));
        if let Watch::Value(i, value) = watch {
            self.exactly(i, value, &mut special);
        }
        self.events.push(Event::Special(special));
        if ends { Break(()) } else { Continue(()) }
    }

    /// What was asked for, not the exponential of its logarithm.
    fn exactly(&mut self, i: usize, value: f64, special: &mut Special) {
        let request = self.locus.request;
        let (range, asked) = if i == 0 {
            (request.driving, &request.at_driving)
        } else {
            (request.stiffness, &request.at_stiffness)
        };
        let values = [range.0, range.1].into_iter().chain(asked.iter().copied());
        let Some(exact) = values.into_iter().find(|x| x.ln() == value) else {
            return;
        };
        let exact = Uncertain::new(exact, 0.0);
        let Some(Event::Locus(row)) = self.events.last_mut() else {
            return;
        };
        if i == 0 {
            (row.driving, special.driving) = (exact, exact);
        } else {
            (row.stiffness, special.stiffness) = (exact, exact);
        }
        let free = if i == 0 { &mut row.stiffness } else { &mut row.driving };
        *free = if i == 0 { special.stiffness } else { special.driving };
    }

    /// K is stationary along the curve here: its largest value, if it is that.
    fn turn(
        &mut self,
        walk: &mut Walk<'_, '_, OverLoadings, N>,
        at: &Regular<N>,
    ) -> ControlFlow<()> {
        let family = walk.corrector.family;
        match top(family, &at.site, self.locus.indicator) {
            Some(top) if top.largest => {
                let _ = self.row(&top.orbit, Some(Label::Top));
                let [driving, stiffness] = top.at;
                self.events.push(Event::Special(Special {
                    period: Some(top.period),
                    ..Special::new(Label::Top, driving, stiffness)
                }));
            }
            _ => {}
        }
        Continue(())
    }

    /// A curve of asymmetric orbits has come to symmetric ones.
    fn merged(&mut self) -> ControlFlow<()> {
        let mut special = rough(Label::Cp, &self.last);
        special.note = Some("the curve ends on that of the pitchforks of orbits".into());
        self.events.push(Event::Special(special));
        Break(())
    }
}
