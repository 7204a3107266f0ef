//! One two-parameter curve of bifurcations, followed in both directions from a point on it, or in one from where it begins.

use super::branches::new_corrector;
use super::ends::backwards;
use super::half_curve::{CurvesOfKind, HalfCurve};
use crate::bifurcation::general::{GeneralEvent, GeneralObserver, GeneralPoint, Teller};
use crate::error::Result;
use crate::orbit::{
    Condition, ContinuationPoint, Goal, Palc, PalcSettings, Regular, Switch, TangentVector,
};
use std::ops::ControlFlow::{Break, Continue};
use std::sync::mpsc;

/// Follows the curve on which the seed lies, within the ranges that are asked for: one way, to tell of it from its end on, and
/// the other, beside it if there is a core to do so. Where it passes the values at which bifurcations are looked for; `None` where the seed can't be
/// corrected.
pub(super) fn through(
    kind: &CurvesOfKind<'_, '_>,
    number: usize,
    seed: ContinuationPoint,
    teller: &mut Teller<'_>,
) -> Result<Option<Vec<[f64; 3]>>> {
    let held = Condition::Parameter(kind.held, seed.at[kind.held]);
    let begin = Beginning::of(kind, number, (seed, held))?;
    begin.map(|begin| begin.both_ways(teller)).transpose()
}
/// Follows the curve through an orbit of codimension two, both ways, from a point beside it at which the orbit bifurcates. Returns whether there is one.
pub(super) fn passing(
    kind: &CurvesOfKind<'_, '_>,
    number: usize,
    site: &ContinuationPoint,
    teller: &mut Teller<'_>,
) -> Result<bool> {
    /// Along the curve.
    const BESIDE: f64 = 0.02;
    let Some(at) = Beginning::at(kind, number, site)? else {
        return Ok(false);
    };
    for way in [BESIDE, -BESIDE] {
        let moved = at.here.site.moved(&at.direction, way);
        let across = Condition::Plane(&at.direction, &moved);
        let begin = Beginning::of(kind, number, (moved.clone(), across))?;
        if let Some(begin) = begin.filter(|begin| kind.bifurcates(&begin.here)) {
            begin.both_ways(teller)?;
            return Ok(true);
        }
    }
    Ok(false)
}

/// Follows the curve that leaves `end`, one way, from the orbit near `site` that lies in the plane through it across `direction`. Returns whether there is one that
/// bifurcates.
pub(super) fn outwards(
    kind: &CurvesOfKind<'_, '_>,
    (number, end): (usize, &GeneralPoint),
    (site, direction): Switch,
    teller: &mut Teller<'_>,
) -> Result<bool> {
    let held = Condition::Plane(&direction, &site);
    let begin = Beginning::of(kind, number, (site.clone(), held))?;
    let Some(begin) = begin.filter(|begin| kind.bifurcates(&begin.here)) else {
        return Ok(false);
    };
    let sense = begin.outwards(&direction)?;
    let end = GeneralPoint {
        number,
        symmetry: kind.chart.symmetry(),
        ..end.clone()
    };
    let end = [GeneralEvent::Special(end.clone()), GeneralEvent::Row(end)];
    // A curve is told of with the second coordinate growing.
    if sense > 0.0 {
        let mut told = Vec::new();
        begin.way(sense, &mut |event| {
            told.push(event);
            Continue(())
        })?;
        let last = begin.first().into_iter().chain(end);
        let mut all = backwards(told).into_iter().chain(last);
        let _ = all.try_for_each(|event| teller.tell(event));
        return Ok(true);
    }
    let mut all = end.into_iter().chain(begin.first());
    if all.try_for_each(|event| teller.tell(event)).is_continue() {
        begin.way(sense, &mut |event| teller.tell(event))?;
    }
    Ok(true)
}

/// Whether there is a core for work beside this. In a pool of threads there is not: it has work for all of them.
pub(super) fn core_to_spare() -> bool {
    let several = || std::thread::available_parallelism().is_ok_and(|cores| cores.get() > 1);
    rayon::current_thread_index().is_none() && several()
}

/// Where both ways begin.
pub(super) struct Beginning<'k, 'c, 'a> {
    kind: &'k CurvesOfKind<'c, 'a>,
    number: usize,
    settings: PalcSettings,
    pub here: Regular,
    direction: TangentVector,
}

impl<'k, 'c, 'a> Beginning<'k, 'c, 'a> {
    /// The bifurcation near a seed that meets a condition, and the direction along the curve there in which the second coordinate falls: a curve
    /// is told of with that growing.
    fn of(
        kind: &'k CurvesOfKind<'c, 'a>,
        number: usize,
        (seed, condition): (ContinuationPoint, Condition<'_>),
    ) -> Result<Option<Self>> {
        let settings = kind.settings();
        let mut corrector = new_corrector(kind.chart.family())?;
        let fixed = settings.and(condition);
        let closed = corrector.correct(seed, &settings.free, &fixed, Goal::STEP);
        let Ok(closed) = closed else {
            return Ok(None);
        };
        let here = corrector.look(closed.site, &settings.free, &settings.own());
        let Ok(here) = here else {
            return Ok(None);
        };
        let Some(direction) = settings.direction(&here, &here.along[0]) else {
            return Ok(None);
        };
        let falls = -direction.parameters[1].signum();
        Ok(Some(Beginning {
            kind,
            number,
            settings: settings.with_pair(&here),
            here,
            direction: direction.scaled(falls),
        }))
    }

    /// At an orbit that is known but for some digits.
    pub fn at(
        kind: &'k CurvesOfKind<'c, 'a>,
        number: usize,
        site: &ContinuationPoint,
    ) -> Result<Option<Self>> {
        /// How far from where it is thought to be it may be found, as a part of both ranges.
        const NEAR: f64 = 1e-3;
        let ranges = kind.curve.ranges;
        for i in [0, 1] {
            let held = Condition::Parameter(i, site.at[i]);
            let found = Beginning::of(kind, number, (site.clone(), held))?;
            let off = |at: [f64; 2]| {
                ((at[1 - i] - site.at[1 - i]) / (ranges[1 - i].1 - ranges[1 - i].0)).abs()
            };
            if let Some(found) = found.filter(|found| off(found.here.site.at) < NEAR) {
                return Ok(Some(found));
            }
        }
        Ok(None)
    }

    /// The sense of the way in which orbits move along this direction.
    fn outwards(&self, direction: &TangentVector) -> Result<f64> {
        let corrector = new_corrector(self.kind.chart.family())?;
        let direction = corrector.in_planes(&self.here, direction);
        Ok(self.direction.dot(&direction).signum())
    }

    /// Reports the orbit at which both directions begin, which neither meets again.
    fn first(&self) -> Vec<GeneralEvent> {
        self.half(&mut |_| Continue(())).first(&self.here)
    }

    /// Both ways, told from the end of one to that of the other. Where they pass the values at which bifurcations are looked for.
    fn both_ways(&self, teller: &mut Teller<'_>) -> Result<Vec<[f64; 3]>> {
        std::thread::scope(|scope| {
            let beside = core_to_spare().then(|| {
                let (send, coming) = mpsc::channel();
                // Nobody listens any more where no more is wanted.
                let mut seen = move |event| match send.send(event) {
                    Ok(()) => Continue(()),
                    Err(_) => Break(()),
                };
                (scope.spawn(move || self.way(-1.0, &mut seen)), coming)
            });
            let mut back = Vec::new();
            let mut passes = self.way(1.0, &mut |event| {
                back.push(event);
                Continue(())
            })?;
            for event in backwards(back).into_iter().chain(self.first()) {
                if teller.tell(event).is_break() {
                    return Ok(passes);
                }
            }
            let more = match beside {
                None => self.way(-1.0, &mut |event| teller.tell(event))?,
                Some((forth, coming)) => {
                    // Dropped where no more is wanted.
                    let _ = coming.into_iter().try_for_each(|event| teller.tell(event));
                    let forth = forth.join();
                    forth.unwrap_or_else(|panic| std::panic::resume_unwind(panic))?
                }
            };
            passes.extend(more);
            Ok(passes)
        })
    }

    /// One way: where it passes the values at which bifurcations are looked for.
    fn way(&self, sense: f64, seen: GeneralObserver<'_>) -> Result<Vec<[f64; 3]>> {
        let mut corrector = new_corrector(self.kind.chart.family())?;
        let mut half = self.half(seen);
        let (here, direction) = (self.here.site.clone(), self.direction.clone());
        let settings = self.settings.clone();
        let palc = Palc::from(&mut corrector, settings, here, direction.scaled(sense));
        if let Ok(mut palc) = palc
            && !half.leaves(&palc.now)
        {
            half.go(&mut palc)?;
        }
        Ok(half.passes)
    }

    fn half<'s>(&'s self, seen: GeneralObserver<'s>) -> HalfCurve<'s, 'c, 'a> {
        HalfCurve::new(
            self.kind,
            self.number,
            (&self.settings, &self.here.site),
            seen,
        )
    }
}
