//! One two-parameter curve of bifurcations, followed in both directions from a point on it.

use super::branches::new_corrector;
use super::half_curve::{HalfCurve, Pass};
use super::locus::Locus;
use super::scan::core_to_spare;
use crate::bifurcation::{Event, EventObserver};
use crate::error::Result;
use crate::model::STIFFNESS;
use crate::orbit::{
    Condition, ContinuationPoint, Corrector, Goal, Palc, PalcSettings, Regular, TangentVector,
};
use std::ops::ControlFlow;
use std::sync::mpsc;

/// A curve that was followed.
pub(super) struct Curve {
    /// Where it passes values of K at which bifurcations are looked for.
    pub passes: Vec<Pass>,
    /// Whether more is wanted.
    pub told: ControlFlow<()>,
}

/// Follows the curve on which the seed lies, within the ranges that are asked for: one way, to tell of it from its end on, and
/// the other, beside it if there is a core to do so. `None` where the seed can't be corrected.
pub(super) fn through(
    locus: &Locus<'_>,
    number: usize,
    seed: ContinuationPoint,
    seen: EventObserver<'_>,
) -> Result<Option<Curve>> {
    let Some(begin) = Beginning::of(locus, number, seed)? else {
        return Ok(None);
    };
    std::thread::scope(|scope| {
        let beside = core_to_spare().then(|| {
            let (send, coming) = mpsc::channel();
            // Nobody listens any more where no more is wanted.
            let mut seen = move |event| match send.send(event) {
                Ok(()) => ControlFlow::Continue(()),
                Err(_) => ControlFlow::Break(()),
            };
            let begin = &begin;
            (scope.spawn(move || begin.forth(&mut seen)), coming)
        });
        let (mut passes, events) = begin.back()?;
        passes.push(Pass::of(&begin.here));
        // What has been followed is told of, also to those who then have had enough: nothing is lost.
        let mut told = ControlFlow::Continue(());
        for event in events.into_iter().rev() {
            if seen(event).is_break() {
                told = ControlFlow::Break(());
            }
        }
        if told.is_break() {
            return Ok(Some(Curve { passes, told }));
        }
        let rest = match beside {
            None => begin.forth(seen)?,
            Some((forth, coming)) => {
                let told = coming.into_iter().try_for_each(seen);
                let forth = forth.join();
                let forth = forth.unwrap_or_else(|panic| std::panic::resume_unwind(panic))?;
                Curve { told, ..forth }
            }
        };
        passes.extend(rest.passes);
        let told = rest.told;
        Ok(Some(Curve { passes, told }))
    })
}

/// Where both ways begin.
struct Beginning<'l, 'r> {
    locus: &'l Locus<'r>,
    number: usize,
    settings: PalcSettings,
    here: ContinuationPoint,
    direction: TangentVector,
}

impl<'l, 'r> Beginning<'l, 'r> {
    fn of(locus: &'l Locus<'r>, number: usize, seed: ContinuationPoint) -> Result<Option<Self>> {
        let settings = PalcSettings::locus(locus.test_function, locus.longest());
        let mut corrector = new_corrector(locus.chart.family())?;
        let begin = first(&mut corrector, &settings, seed);
        Ok(begin.map(|(here, direction)| Beginning {
            locus,
            number,
            settings,
            here,
            direction,
        }))
    }

    /// One way: where it passes, and all that is to be told of it.
    fn back(&self) -> Result<(Vec<Pass>, Vec<Event>)> {
        let mut corrector = new_corrector(self.locus.chart.family())?;
        let mut back = self.half(None);
        if let Ok(mut palc) = self.palc(&mut corrector, 1.0)
            && !back.leaves(&palc.now)
        {
            back.go(&mut palc)?;
        }
        Ok(back.kept())
    }

    /// The other way, from the beginning on.
    fn forth(&self, seen: EventObserver<'_>) -> Result<Curve> {
        let mut corrector = new_corrector(self.locus.chart.family())?;
        let mut forth = self.half(Some(seen));
        if let Ok(mut palc) = self.palc(&mut corrector, -1.0) {
            forth.begins(&mut palc);
            if forth.told.is_continue() && !forth.leaves(&palc.now) {
                forth.go(&mut palc)?;
            }
        }
        let told = forth.told;
        let passes = forth.kept().0;
        Ok(Curve { passes, told })
    }

    fn half<'s>(&self, seen: Option<EventObserver<'s>>) -> HalfCurve<'r, 's> {
        HalfCurve::new(self.locus, self.number, Pass::of(&self.here), seen)
    }

    fn palc<'c, 'f>(&self, corrector: &'c mut Corrector<'f>, way: f64) -> Result<Palc<'c, 'f>> {
        let (here, direction) = (self.here.clone(), self.direction.clone());
        Palc::from(
            corrector,
            self.settings.clone(),
            here,
            direction.scaled(way),
        )
    }
}

/// The bifurcation at the seed's K, and a direction along the curve there.
fn first(
    corrector: &mut Corrector<'_>,
    settings: &PalcSettings,
    seed: ContinuationPoint,
) -> Option<(ContinuationPoint, TangentVector)> {
    let fixed = settings.and(Condition::Parameter(STIFFNESS, seed.at[STIFFNESS]));
    let closed: Regular = corrector
        .correct(seed, &settings.free, &fixed, Goal::STEP)
        .ok()?;
    let here = corrector.look(closed.site, &settings.free, &settings.own());
    let here = here.ok()?;
    let direction = settings.direction(&here, &here.along[0])?;
    Some((here.site, direction))
}
