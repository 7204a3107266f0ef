//! The steady-state friction of a law from a file: the curve, its extrema and the largest critical stiffness, by zeros of the formulas.

use super::friction::{Friction, Steady};
use super::model::TextModel;
use crate::scene::law::{LawCurve, LawLandmarks, LawPoint};
use twinslip::error::{Error, Result};
use twinslip::friction::{Extremum, ExtremumKind, StiffnessMaximum};
use twinslip::number::{Interval, Jet, Real, Uncertain, bracketed_root, enclosing_radius};

/// The law at a slip rate, with tau_ss and ln psi_ss there.
type At = (Steady, LawPoint);

/// The law of an interface at these rates up to one at which it has no steady state, and why that is; and at V_H/N.
///
/// # Errors
/// [`Error::NotConverged`] where the law has no steady state between two points that have.
pub(in crate::scene) fn curve_of_formulas(
    model: &TextModel,
    place: usize,
    (rates, together): (&[f64], Option<f64>),
) -> Result<(LawCurve, Option<Error>)> {
    let (slab, interface) = (model.slab.as_ref().expect("a law from a file"), place + 1);
    let friction = slab.friction(&model.system, place);
    let mut points = Vec::with_capacity(rates.len());
    let mut failure = None;
    for &v in rates {
        match point(&friction, interface, v) {
            Ok(point) => points.push(point),
            Err(error) => {
                failure = Some(error);
                break;
            }
        }
    }
    let together = together.map(|v| point(&friction, interface, v));
    let curve = LawCurve {
        interface,
        together: together.transpose()?.map(|(_, point)| point),
        landmarks: landmarks(&friction, &points)?,
        points: points.into_iter().map(|(_, point)| point).collect(),
        coefficient: friction.parameter("direct_effect"),
    };
    Ok((curve, failure))
}

/// The extrema of the steady stress, and the largest critical stiffness, between the points.
fn landmarks(friction: &Friction<'_>, points: &[At]) -> Result<LawLandmarks> {
    let slopes: Vec<Slopes> = points
        .iter()
        .map(|(steady, at)| slopes_at(friction, at.slip_rate, steady))
        .collect();
    let mut extrema = Vec::new();
    for (pair, ends) in slopes.windows(2).zip(points.windows(2)) {
        let [left, right] = [0, 1].map(|i| pair[i].relative.value);
        if left * right.signum() >= 0.0 {
            continue;
        }
        let kind = if left > 0.0 {
            ExtremumKind::Maximum
        } else {
            ExtremumKind::Minimum
        };
        let of = |slopes: Slopes<Interval>| slopes.relative.value;
        // Where the signs are rounding's, and others at the ends of the search, the stress is flat too.
        let v = match zero_of(friction, ends, |slopes| slopes.relative) {
            Err(Error::NotConverged { iterations: 0, .. }) => continue,
            found => found?,
        };
        let (around, radius) = enclosure(friction, v, of);
        // Where no sign is certain the stress is flat, or nearly so.
        if !radius.is_finite() {
            continue;
        }
        let steady = friction.steady(v)?;
        let (stress, _) = friction.enclosed(around, &steady);
        extrema.push(Extremum::new(kind, Uncertain::new(v, radius), stress));
    }
    Ok(LawLandmarks {
        extrema,
        critical_stiffness_maximum: largest_stiffness(friction, points, &slopes)?,
        transition_rate: None,
    })
}

fn point(friction: &Friction<'_>, interface: usize, v: f64) -> Result<At> {
    let steady = friction.steady(v)?;
    let (stress, log_states) = friction.enclosed(Interval::constant(v), &steady);
    let all = exponentials(&steady);
    let (critical_stiffness, _) = friction.steady_slopes(v, steady.stress, &all);
    let (psi, log_state) = (all[0], log_states[0]);
    let rounding = f64::EPSILON * psi;
    let coefficient = friction.parameter("direct_effect");
    let point = LawPoint {
        interface,
        slip_rate: v,
        stress,
        friction: coefficient.map(|a| a * steady.stress),
        state: Uncertain::new(psi, psi * log_state.uncertainty.exp_m1() + rounding),
        critical_stiffness,
    };
    Ok((steady, point))
}

/// k_c, and what has the sign of d tau_ss/dV, with their derivatives in V.
#[derive(Debug, Clone, Copy)]
struct Slopes<T = f64> {
    critical: Jet<T, 1>,
    relative: Jet<T, 1>,
}

/// psi of all state variables.
fn exponentials(steady: &Steady) -> Vec<f64> {
    steady.log_states.iter().map(|w| w.exp()).collect()
}

fn slopes_at(friction: &Friction<'_>, v: f64, steady: &Steady) -> Slopes {
    let psi = exponentials(steady);
    let (critical, relative) = friction.along_steady(v, steady.stress, &psi);
    Slopes { critical, relative }
}

/// The same with bounds at a rate, or over a range of rates.
fn slopes_within(friction: &Friction<'_>, v: Interval) -> Option<Slopes<Interval>> {
    let steady = friction.steady(0.5 * v.lo() + 0.5 * v.hi()).ok()?;
    let (stress, log_states) = friction.enclosed(v, &steady);
    let known = stress.uncertainty.is_finite();
    let around = |x: Uncertain| Interval::around(x.value, x.uncertainty);
    let psi = log_states.into_iter().map(|w| Real::exp(around(w)));
    let psi: Vec<Interval> = psi.collect();
    let (critical, relative) = friction.along_steady(v, around(stress), &psi);
    known.then_some(Slopes { critical, relative })
}

/// Where a quantity is zero between two points, on either side of which it has opposite signs.
fn zero_of(
    friction: &Friction<'_>,
    ends: &[At],
    of: impl Fn(Slopes) -> Jet<f64, 1>,
) -> Result<f64> {
    let [low, high] = [0, 1].map(|i| ends[i].1.slip_rate.ln());
    let root = bracketed_root("an extremum of the law", low, high, |x| {
        let v = x.exp();
        let quantity = friction.steady(v).map_or(
            Jet {
                value: f64::NAN,
                gradient: [f64::NAN],
            },
            |steady| of(slopes_at(friction, v, &steady)),
        );
        (quantity.value, quantity.gradient[0] * v)
    });
    Ok(root?.exp())
}

/// The rates around v between which a quantity certainly changes its sign, and how far they go.
fn enclosure(
    friction: &Friction<'_>,
    v: f64,
    of: impl Fn(Slopes<Interval>) -> Interval,
) -> (Interval, f64) {
    let unknown = Interval::new(f64::NEG_INFINITY, f64::INFINITY);
    let radius = enclosing_radius(v, |x| slopes_within(friction, x).map_or(unknown, &of));
    (Interval::around(v, radius), radius)
}

/// The largest maximum of k_c between the points, where it has any.
fn largest_stiffness(
    friction: &Friction<'_>,
    points: &[At],
    slopes: &[Slopes],
) -> Result<Option<StiffnessMaximum>> {
    let mut largest: Option<StiffnessMaximum> = None;
    for (pair, ends) in slopes.windows(2).zip(points.windows(2)) {
        let [left, right] = [0, 1].map(|i| pair[i].critical.gradient[0]);
        if !(left > 0.0 && right < 0.0) {
            continue;
        }
        let v = match maximum_of_stiffness(friction, ends) {
            Err(Error::NotConverged { iterations: 0, .. }) => continue,
            found => found?,
        };
        let of = |slopes: Slopes<Interval>| slopes.critical.gradient[0];
        let (around, radius) = enclosure(friction, v, of);
        if !radius.is_finite() {
            continue;
        }
        let stiffness = slopes_at(friction, v, &friction.steady(v)?).critical.value;
        let error = slopes_within(friction, around).map_or(f64::INFINITY, |all| {
            all.critical.value.distance_from(stiffness)
        });
        if largest.is_none_or(|known| known.stiffness.value < stiffness) {
            largest = Some(StiffnessMaximum::new(
                Uncertain::new(v, radius),
                Uncertain::new(stiffness, error),
            ));
        }
    }
    Ok(largest.filter(|known| known.stiffness.value > 0.0))
}

fn maximum_of_stiffness(friction: &Friction<'_>, ends: &[At]) -> Result<f64> {
    // By halves: the slope of the derivative is not known.
    zero_of(friction, ends, |slopes| Jet {
        value: slopes.critical.gradient[0],
        gradient: [f64::NAN],
    })
}
