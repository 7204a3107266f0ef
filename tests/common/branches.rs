//! Branches of periodic orbits.

use std::ops::ControlFlow::{Break, Continue};
use twinslip::continuation::{Met, WatchedFunction};
use twinslip::orbit::{
    Condition, ContinuationPoint, Corrector, Goal, Palc, PalcSettings, TestFunction,
};

/// Along a branch towards greater values of a parameter: the first zero of a test function below `end`.
pub fn first(
    corrector: &mut Corrector<'_>,
    site: ContinuationPoint,
    (free, end): (usize, f64),
    test_function: TestFunction,
) -> Option<ContinuationPoint> {
    let settings = PalcSettings::branch(free, 0.3);
    let here = corrector.look(site, &settings.free, &[]).expect("an orbit");
    let mut direction = here.along[0].clone();
    if direction.parameters[free] < 0.0 {
        direction = direction.scaled(-1.0);
    }
    let mut palc = Palc::from(corrector, settings, here.site, direction).expect("a continuation");
    let mut found = None;
    let watched = [WatchedFunction::TestFunction(test_function)];
    palc.follow(&watched, 400, &mut |_, _, met| match met {
        Met::Zero(_, at) => {
            found = Some(at.here.site.clone());
            Break(())
        }
        Met::Point(now) if now.here.site.at[free] > end => Break(()),
        Met::Point(_) => Continue(()),
    })
    .expect("a branch");
    let meets = [Condition::TestFunction(test_function)];
    let sharp = corrector.correct(found?, &[free], &meets, Goal::SHARP);
    Some(sharp.expect("the bifurcation").site)
}
