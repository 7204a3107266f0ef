//! Curves of bifurcations of orbits that leave a point of codimension two, of equilibria or of orbits.

use super::chart::Chart;
use super::curve::{Beginning, outwards, passing};
use super::half_curve::CurvesOfKind;
use super::multipliers_together::is_real;
use super::orbit_curves::charts;
use super::orbit_point::sum_of_pair;
use crate::bifurcation::Label;
use crate::bifurcation::general::{
    GeneralCurve, GeneralObserver, GeneralPoint, GeneralSolution, Teller,
};
use crate::error::Result;
use crate::number::{Uncertain, eigenvalues};
use crate::orbit::{
    ContinuationPoint, Regular, ShootingNodes, SmallOrbits, Switch, TestFunction, Tracer,
};
use std::f64::consts::TAU;

/// Sizes of the first orbit, in units of 1 + |x|: where the largest is too large for the normal form smaller ones are tried.
const LARGEST: f64 = 0.02;
const SMALLER: f64 = 0.5;
const LEAST: f64 = 3e-4;
/// The frequency of a pair on the axis, relatively.
const SAME_PAIR: f64 = 1e-4;

/// Follows the curves that leave a Hopf point and returns whether there are any. The point is given as the orbits that have shrunk to it, one for each of its pairs.
///
/// # Errors
/// Those of the orbits; [`crate::Error::TooManyPoints`].
pub(in crate::bifurcation) fn orbit_curves_leaving(
    curve: &GeneralCurve<'_>,
    test_function: TestFunction,
    ends: &[GeneralPoint],
    seen: GeneralObserver<'_>,
) -> Result<bool> {
    let mut teller = Teller::new(seen, &curve.following);
    let mut count = 0;
    for end in ends {
        for chart in charts(curve, Some(test_function)) {
            if test_function.checked(chart.family().dimension()).is_err() {
                continue;
            }
            let Some(small) = small_orbits(chart, end) else {
                continue;
            };
            let kind = CurvesOfKind::new(curve, Some(test_function), chart, 0, &[]);
            let field = chart.family().field(end.at);
            let begin = |size| small.ellipse(&field, size);
            if from_small(&kind, (count, end), &begin, &mut teller)? {
                count += 1;
                break;
            }
        }
    }
    teller.end().map(|()| count > 0)
}

/// The small orbits beside a Hopf point in these variables, where its pair is one of theirs.
fn small_orbits(chart: Chart<'_>, end: &GeneralPoint) -> Option<SmallOrbits> {
    let GeneralSolution::Orbit { shooting, .. } = &end.solution else {
        return None;
    };
    let site = ContinuationPoint {
        shooting: shooting.clone(),
        at: end.at,
    };
    let state = chart.own(&site).shooting.nodes.swap_remove(0);
    let field = chart.family().field(end.at);
    let frequency = TAU / shooting.period();
    let all = eigenvalues(&field.jacobian(&state))?;
    let near = |im: f64| (im / frequency - 1.0).abs() < SAME_PAIR;
    all.iter()
        .any(|z| near(z.im))
        .then(|| SmallOrbits::of(&field, state, end.at, frequency))
}

/// Follows the curve that leaves `end`, from the largest of several small orbits from which Newton's method converges. Returns whether there is one.
fn from_small(
    kind: &CurvesOfKind<'_, '_>,
    (number, end): (usize, &GeneralPoint),
    begin: &dyn Fn(f64) -> Switch,
    teller: &mut Teller<'_>,
) -> Result<bool> {
    let mut size = LARGEST;
    while size > LEAST {
        if outwards(kind, (number, end), begin(size), teller)? {
            return Ok(true);
        }
        size *= SMALLER;
    }
    Ok(false)
}

impl CurvesOfKind<'_, '_> {
    /// Whether an orbit at which the condition of a curve holds has the bifurcation: a pair with the product 1 may be real.
    pub fn bifurcates(&self, orbit: &Regular) -> bool {
        self.test_function != Some(TestFunction::Torus)
            || !is_real(orbit) && sum_of_pair(orbit).abs() < 2.0
    }
}

/// Follows the curves through an orbit of codimension two, and those of orbits of twice its period that leave it. Returns whether there are any. Of the orbit a point
/// and the period are known, to some digits.
///
/// # Errors
/// As of [`orbit_curves_leaving`].
pub(in crate::bifurcation) fn orbit_curves_beside(
    curve: &GeneralCurve<'_>,
    test_function: TestFunction,
    end: &GeneralPoint,
    seen: GeneralObserver<'_>,
) -> Result<bool> {
    let mut teller = Teller::new(seen, &curve.following);
    let mut count = 0;
    // At a degenerate period doubling the folds are of orbits of twice the period.
    let passes = end.label != Some(Label::Gpd) || test_function == TestFunction::Doubling;
    let doubles = [Label::Gpd, Label::R2].map(Some).contains(&end.label)
        && test_function != TestFunction::Doubling;
    for chart in charts(curve, Some(test_function)) {
        let Some(site) = meshed(chart, end) else {
            continue;
        };
        let kind = |of| CurvesOfKind::new(curve, Some(of), chart, 0, &[]);
        if passes {
            let kind = kind(test_function);
            count += usize::from(passing(&kind, count, &site, &mut teller)?);
        }
        if !doubles {
            continue;
        }
        let Some((orbit, direction)) = doubled(&kind(TestFunction::Doubling), &site)? else {
            continue;
        };
        let begin = |size| (orbit.moved(&direction, size), direction.clone());
        let told = (count, &twice(end));
        count += usize::from(from_small(&kind(test_function), told, &begin, &mut teller)?);
    }
    teller.end().map(|()| count > 0)
}

/// An orbit that is told by one of its points, in these variables and with nodes along it.
fn meshed(chart: Chart<'_>, end: &GeneralPoint) -> Option<ContinuationPoint> {
    /// Tolerance of the flow.
    const FINE: f64 = 1e-13;
    let GeneralSolution::Orbit { shooting, .. } = &end.solution else {
        return None;
    };
    let site = ContinuationPoint {
        shooting: shooting.clone(),
        at: end.at,
    };
    let ShootingNodes { nodes, durations } = chart.own(&site).shooting;
    let field = chart.family().field(end.at);
    let mut tracer = Tracer::taylor(FINE).ok()?;
    let shooting = ShootingNodes::along(&mut tracer, &field, nodes.first()?, durations[0]);
    Some(ContinuationPoint {
        shooting: shooting.ok()?,
        at: end.at,
    })
}

/// The same orbit traversed twice.
fn twice(end: &GeneralPoint) -> GeneralPoint {
    let mut end = end.clone();
    if let GeneralSolution::Orbit { shooting, .. } = &mut end.solution {
        shooting.nodes.extend(shooting.nodes.clone());
        shooting.durations = shooting.durations.repeat(2);
    }
    end.period = end
        .period
        .map(|period| Uncertain::new(2.0 * period.value, 2.0 * period.uncertainty));
    end
}

/// At a period doubling: the orbit traversed twice, and the direction in which orbits of twice the period leave it.
fn doubled(kind: &CurvesOfKind<'_, '_>, site: &ContinuationPoint) -> Result<Option<Switch>> {
    let here = Beginning::at(kind, 0, site)?;
    Ok(here.and_then(|begin| begin.here.doubled()))
}
