//! A periodic orbit of any field, near a point or as what a run from there settles on.

use super::arc::Tracer;
use super::find::{FINE, FoundOrbit, Guesses, ROUGH, completed, search_steps};
use super::no_orbit;
use super::settle::passages;
use super::shooting_nodes::ShootingNodes;
use super::solve::{OrbitAccuracy, orbit};
use super::space::Alone;
use crate::equilibrium::Symmetry;
use crate::error::{Error, Result};
use crate::field::Vector;
use crate::integrate::{AnyField, Choice, Control};

/// The periodic orbit at or near a start; with its period, roughly, no shorter cycle is taken for it. Without it, where the returns
/// of the start lead to none, what a run from there settles on. Under a periodic forcing the period is as many of its periods as the orbit shall
/// last, one without it.
///
/// # Errors
/// [`Error::Input`] for a field of one variable; [`Error::NoOrbit`] says what was found instead; [`Error::NotConverged`]; those
/// of the flow.
pub fn find_from(
    field: &AnyField<'_>,
    start: &Vector,
    period: Option<f64>,
    accuracy: &OrbitAccuracy,
) -> Result<FoundOrbit> {
    if field.dimension() < 2 {
        return Err(Error::Input(
            "a system of one state has no periodic orbit".into(),
        ));
    }
    let found = find_by(field, start, period, accuracy);
    match found {
        // A run under a forcing that lasts to its end is not stiff.
        Err(error @ (Error::NoOrbit { .. } | Error::NotConverged { .. }))
            if field.phase().is_some() =>
        {
            Err(error)
        }
        // Where the explicit method gets nowhere the orbit may be that of a stiff system.
        Err(error) if accuracy.method == Choice::Auto => {
            let stiff = OrbitAccuracy {
                all_steps: accuracy
                    .all_steps
                    .min(search_steps(field.dimension()) / OVER_TAYLOR),
                ..accuracy.stiff()
            };
            match find_by(field, start, period, &stiff) {
                // What is known of the period to no digit is no answer.
                Ok(found) if found.orbit.period.uncertainty < found.orbit.period.value => Ok(found),
                _ => Err(error),
            }
        }
        found => found,
    }
}

fn find_by(
    field: &AnyField<'_>,
    start: &Vector,
    period: Option<f64>,
    accuracy: &OrbitAccuracy,
) -> Result<FoundOrbit> {
    let search = search_steps(field.dimension()).min(accuracy.all_steps);
    let mut tracer = Tracer::limited_by(accuracy.method, ROUGH, accuracy.max_steps, search)?;
    let space = Alone {
        field,
        symmetry: Symmetry::Symmetric,
    };
    let mut guesses = Guesses::new(&space, Symmetry::Symmetric);
    let period = period.or_else(|| field.forcing_period());
    match period {
        Some(period) if field.phase().is_some() => guesses.forced(period, &mut tracer, start)?,
        Some(period) => guesses.over(period, &mut tracer, start)?,
        None => {
            let rough = rough_period(&mut tracer, field, start)?;
            guesses.near(rough, &mut tracer, start)?;
        }
    }
    if guesses.closed.is_empty() {
        return Err(guesses.otherwise.unwrap_or_else(|| {
            no_orbit(
                "no periodic orbit was found".into(),
                "give a `start` near it and a `period_guess`, or other parameters",
            )
        }));
    }
    let found = completed(guesses, None, accuracy, period.is_some())?;
    if !found.orbit.in_family {
        return Ok(found);
    }
    // Of a family the one through the start, where that is on one.
    let period = found.orbit.period.value;
    let through = Tracer::taylor(FINE)
        .and_then(|mut fine| ShootingNodes::along(&mut fine, field, start, period))
        .and_then(|shooting| orbit(None, &space, accuracy, shooting));
    Ok(match through {
        Ok(orbit) if (orbit.period.value / period - 1.0).abs() < BESIDE => FoundOrbit {
            orbit,
            others: found.others,
        },
        _ => found,
    })
}

/// What an implicit step takes, in steps of Taylor's method.
const OVER_TAYLOR: usize = 50;
/// Periods that differ by less, relatively, are of neighbours in a family.
const BESIDE: f64 = 1e-6;

/// The time between passages of the middle of what the first variable does.
fn rough_period(tracer: &mut Tracer, field: &AnyField<'_>, start: &Vector) -> Result<f64> {
    /// Steps of a run that is watched, in its second half.
    const STEPS: usize = 2000;
    /// As long as a run may be, which ends by its steps.
    const FOREVER: f64 = 1e100;
    /// Parts of a run that has no passages.
    const PARTS: f64 = 10.0;
    let (mut steps, mut elapsed) = (0, 0.0);
    let mut range = (f64::INFINITY, f64::NEG_INFINITY);
    let end = tracer.flow(
        field,
        start,
        FOREVER,
        Some(&mut |step| {
            steps += 1;
            elapsed = step.t1;
            if 2 * steps > STEPS {
                range = (range.0.min(step.y1[0]), range.1.max(step.y1[0]));
            }
            Ok(if steps == STEPS {
                Control::Stop
            } else {
                Control::Continue
            })
        }),
    )?;
    let level = 0.5 * (range.0 + range.1);
    if !level.is_finite() || elapsed >= FOREVER {
        return Err(no_orbit(
            "the run converges to an equilibrium".into(),
            "give another `start`, or other parameters",
        ));
    }
    let found = passages(tracer, field, &end, elapsed, level, usize::MAX)?.found;
    Ok(match (found.first(), found.last()) {
        (Some((first, _)), Some((last, _))) if last > first => {
            (last - first) / (found.len() - 1) as f64
        }
        _ => elapsed / PARTS,
    })
}
