//! One two-parameter curve of bifurcations, followed in both directions from a point on it.

use super::branch::new_corrector;
use super::half_curve::{HalfCurve, Pass};
use super::locus::Locus;
use crate::bifurcation::EventObserver;
use crate::error::Result;
use crate::model::STIFFNESS;
use crate::orbit::{
    Condition, ContinuationPoint, Corrector, Goal, Palc, PalcSettings, Regular, TangentVector,
};
use std::ops::ControlFlow;

/// A curve that was followed.
pub(super) struct Curve {
    /// Where it passes values of K at which bifurcations are looked for.
    pub passes: Vec<Pass>,
    /// Whether more is wanted.
    pub told: ControlFlow<()>,
}

/// Follows the curve on which the seed lies, within the ranges that are asked for: first one way, to tell of it from its end
/// on, then the other. `None` where the seed can't be corrected.
pub(super) fn through(
    locus: &Locus<'_>,
    number: usize,
    seed: ContinuationPoint,
    seen: EventObserver<'_>,
) -> Result<Option<Curve>> {
    let settings = PalcSettings::locus(locus.test_function, locus.longest());
    let mut corrector = new_corrector(locus.chart.family())?;
    let Some((here, direction)) = first(&mut corrector, &settings, seed) else {
        return Ok(None);
    };
    let begin = Pass::of(&here);
    let mut back = HalfCurve::new(locus, number, begin, None);
    if let Ok(mut palc) = Palc::from(
        &mut corrector,
        settings.clone(),
        here.clone(),
        direction.clone(),
    ) && !back.leaves(&palc.now)
    {
        back.go(&mut palc)?;
    }
    let (mut passes, events) = back.kept();
    passes.push(begin);
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
    let mut forth = HalfCurve::new(locus, number, begin, Some(seen));
    if let Ok(mut palc) = Palc::from(&mut corrector, settings, here, direction.scaled(-1.0)) {
        forth.begins(&mut palc);
        if forth.told.is_continue() && !forth.leaves(&palc.now) {
            forth.go(&mut palc)?;
        }
    }
    let told = forth.told;
    passes.extend(forth.kept().0);
    Ok(Some(Curve { passes, told }))
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
