//! One two-parameter curve of bifurcations, followed in both directions from a point on it.

use super::branches::new_corrector;
use super::ends::backwards;
use super::half_curve::{CurvesOfKind, HalfCurve};
use crate::bifurcation::general::{GeneralEvent, GeneralObserver, Teller};
use crate::error::Result;
use crate::orbit::{
    Condition, ContinuationPoint, Corrector, Goal, Palc, PalcSettings, Regular, TangentVector,
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
    let Some(begin) = Beginning::of(kind, number, seed)? else {
        return Ok(None);
    };
    std::thread::scope(|scope| {
        let beside = core_to_spare().then(|| {
            let (send, coming) = mpsc::channel();
            // Nobody listens any more where no more is wanted.
            let mut seen = move |event| match send.send(event) {
                Ok(()) => Continue(()),
                Err(_) => Break(()),
            };
            let begin = &begin;
            (scope.spawn(move || begin.way(-1.0, &mut seen)), coming)
        });
        let mut back = Vec::new();
        let mut passes = begin.way(1.0, &mut |event| {
            back.push(event);
            Continue(())
        })?;
        for event in backwards(back).into_iter().chain(begin.first()) {
            if teller.tell(event).is_break() {
                return Ok(Some(passes));
            }
        }
        let more = match beside {
            None => begin.way(-1.0, &mut |event| teller.tell(event))?,
            Some((forth, coming)) => {
                // Dropped where no more is wanted.
                let _ = coming.into_iter().try_for_each(|event| teller.tell(event));
                let forth = forth.join();
                forth.unwrap_or_else(|panic| std::panic::resume_unwind(panic))?
            }
        };
        passes.extend(more);
        Ok(Some(passes))
    })
}

/// Whether there is a core for work beside this. In a pool of threads there is not: it has work for all of them.
pub(super) fn core_to_spare() -> bool {
    let several = || std::thread::available_parallelism().is_ok_and(|cores| cores.get() > 1);
    rayon::current_thread_index().is_none() && several()
}

/// Where both ways begin.
struct Beginning<'k, 'c, 'a> {
    kind: &'k CurvesOfKind<'c, 'a>,
    number: usize,
    settings: PalcSettings,
    here: Regular,
    direction: TangentVector,
}

impl<'k, 'c, 'a> Beginning<'k, 'c, 'a> {
    /// The bifurcation at the seed's value of the coordinate that is held, and the direction along the curve there in which the second one falls: a curve
    /// is told of with that growing.
    fn of(
        kind: &'k CurvesOfKind<'c, 'a>,
        number: usize,
        seed: ContinuationPoint,
    ) -> Result<Option<Self>> {
        let settings = kind.settings();
        let mut corrector = new_corrector(kind.chart.family())?;
        let Some(here) = first(&mut corrector, &settings, kind.held, seed) else {
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

    /// Reports the orbit at which both directions begin, which neither meets again.
    fn first(&self) -> Vec<GeneralEvent> {
        self.half(&mut |_| Continue(())).first(&self.here)
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

fn first(
    corrector: &mut Corrector<'_>,
    settings: &PalcSettings,
    held: usize,
    seed: ContinuationPoint,
) -> Option<Regular> {
    let fixed = settings.and(Condition::Parameter(held, seed.at[held]));
    let closed = corrector.correct(seed, &settings.free, &fixed, Goal::STEP);
    let here = corrector.look(closed.ok()?.site, &settings.free, &settings.own());
    here.ok()
}
