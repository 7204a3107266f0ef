//! One curve of bifurcations, followed both ways from a point on it.

use super::branch::walker;
use super::chart::Chart;
use super::leg::{Leg, Pass};
use super::locus::Locus;
use crate::bifurcation::Seen;
use crate::error::Result;
use crate::orbit::{Condition, Corrector, Goal, Motion, OverLoadings, Path, Regular, Site, Walk};
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
pub(super) fn through<const N: usize>(
    locus: &Locus<'_, N>,
    number: usize,
    seed: Site<N>,
    seen: Seen<'_>,
) -> Result<Option<Curve>>
where
    OverLoadings: Chart<N>,
{
    let path = Path::locus(locus.indicator, locus.longest());
    let mut corrector = walker::<_, N>(&locus.family)?;
    let Some((here, direction)) = first(&mut corrector, &path, seed) else {
        return Ok(None);
    };
    let begin = Pass::of(&here);
    let mut back = Leg::new(locus, number, begin, None);
    if let Ok(mut walk) = Walk::from(
        &mut corrector,
        path.clone(),
        here.clone(),
        direction.clone(),
    ) && !back.leaves(&walk.pace)
    {
        back.go(&mut walk)?;
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
    let mut forth = Leg::new(locus, number, begin, Some(seen));
    if let Ok(mut walk) = Walk::from(&mut corrector, path, here, direction.scaled(-1.0)) {
        forth.begins(&mut walk);
        if !forth.told && !forth.leaves(&walk.pace) {
            forth.go(&mut walk)?;
        }
    }
    let told = if forth.told {
        ControlFlow::Break(())
    } else {
        ControlFlow::Continue(())
    };
    passes.extend(forth.kept().0);
    Ok(Some(Curve { passes, told }))
}

/// The bifurcation at the seed's K, and a direction along the curve there.
fn first<const N: usize>(
    corrector: &mut Corrector<'_, OverLoadings, N>,
    path: &Path,
    seed: Site<N>,
) -> Option<(Site<N>, Motion<N>)>
where
    OverLoadings: Chart<N>,
{
    let fixed = path.and(Condition::Parameter(1, seed.at[1]));
    let closed: Regular<N> = corrector
        .correct(seed, &path.free, &fixed, Goal::STEP)
        .ok()?;
    let own: Vec<_> = path
        .indicator
        .map(Condition::Indicator)
        .into_iter()
        .collect();
    let here = corrector.look(closed.site, &path.free, &own).ok()?;
    let direction = path.direction(&here, &here.along[0])?;
    Some((here.site, direction))
}
