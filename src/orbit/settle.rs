//! Initial guesses by simulation: from a start to a guess of the periodic orbit that a run settles on.

use super::arc::Tracer;
use super::no_orbit;
use super::shooting_nodes::ShootingNodes;
use crate::error::Result;
use crate::field::Vector;
use crate::integrate::{AnyField, Control};
use crate::number::polynomial::Crossing;
use crate::section::{SeriesVariables, Surface, crossings};
use crate::series::Zeros;

/// A run's passages of a plane tau = level, downwards.
#[derive(Debug, Clone)]
pub(super) struct Passages {
    /// Time and state of each.
    pub found: Vec<(f64, Vector)>,
    /// Least and greatest stress at the steps.
    pub range: (f64, f64),
    /// The state at the end.
    pub end: Vector,
}

/// Follows a run over `duration`, or until `most` passages.
pub(super) fn passages(
    tracer: &mut Tracer,
    field: &AnyField<'_>,
    start: &Vector,
    duration: f64,
    level: f64,
    most: usize,
) -> Result<Passages> {
    let surface = Surface {
        normal: axis(start.len(), 0),
        offset: level,
        direction: Crossing::Downwards,
        chart: SeriesVariables::Plain,
        turn: None,
    };
    let (mut zeros, mut here) = (Zeros::default(), Vec::new());
    let mut found = Vec::new();
    let mut range = (start[0], start[0]);
    let end = tracer.flow(
        field,
        start,
        duration,
        Some(&mut |step| {
            range = (range.0.min(step.y1[0]), range.1.max(step.y1[0]));
            match step.series() {
                Some(series) => {
                    let direction = Some(surface.direction);
                    series.crossings(surface.section(), direction, &mut zeros, &mut here);
                }
                None => crossings(field, &surface, step, &mut zeros, &mut here)?,
            }
            for passage in here.drain(..) {
                let time = (step.begin + passage.time).hi();
                found.push((time, Vector::from_vec(passage.state)));
            }
            Ok(if found.len() >= most {
                Control::Stop
            } else {
                Control::Continue
            })
        }),
    )?;
    Ok(Passages { found, range, end })
}

/// The direction of the i-th of so many variables.
pub(super) fn axis(count: usize, i: usize) -> Vector {
    let mut axis = Vector::zeros(count);
    axis[i] = 1.0;
    axis
}

/// Largest difference in a component.
fn apart(a: &Vector, b: &Vector) -> f64 {
    (a - b).amax()
}

/// Most passages in one cycle of an orbit that is recognised.
const MOST_PASSAGES: usize = 12;
/// A return this near is worth a try with Newton's method.
const NEAR: f64 = 0.3;
/// A run whose stress varies by less, against what it did before, is at an equilibrium.
const AT_REST: f64 = 1e-6;
/// Lengths of the stretches of a run, in rough periods; each doubles the run.
const FIRST_STRETCH: f64 = 16.0;
/// How often the run is prolonged.
const STRETCHES: u32 = 7;

/// The closed curves that a run seems to approach, the likeliest first, as the run gets longer: `accept` says of each whether
/// to go on.
///
/// # Errors
/// [`crate::Error::NoOrbit`] where the run comes to rest or comes back nowhere; those of the flow.
pub(super) fn settle(
    tracer: &mut Tracer,
    field: &AnyField<'_>,
    start: &Vector,
    rough_period: f64,
    accept: &mut dyn FnMut(&mut Tracer, ShootingNodes) -> bool,
) -> Result<()> {
    let mut y = start.clone();
    let mut extent = 0.0_f64;
    for stretch in 0..STRETCHES {
        let length = FIRST_STRETCH * rough_period * f64::from(1u32 << stretch);
        // Some of it unseen; then how far the stress goes; then where it passes the middle of that.
        let unseen = passages(tracer, field, &y, 0.5 * length, y[0], usize::MAX)?;
        let seen = passages(tracer, field, &unseen.end, 0.5 * length, y[0], usize::MAX)?;
        let (low, high) = seen.range;
        extent = extent.max(unseen.range.1 - unseen.range.0);
        y = seen.end;
        if high - low <= AT_REST * extent {
            if stretch + 1 < STRETCHES && field.f(&y).amax() * rough_period > 1e-12 {
                continue;
            }
            return Err(no_orbit(
                "the run converges to an equilibrium".into(),
                "give another `start`, or other parameters",
            ));
        }
        let level = 0.5 * (low + high);
        let most = 2 * MOST_PASSAGES + 1;
        let Passages { found, .. } = passages(tracer, field, &y, length, level, most)?;
        let Some((last_time, last)) = found.last() else {
            continue;
        };
        let mut returns: Vec<_> = found[..found.len() - 1]
            .iter()
            .rev()
            .take(MOST_PASSAGES)
            .map(|(time, state)| (apart(state, last), last_time - time))
            .filter(|(apart, _)| *apart < NEAR)
            .collect();
        // A cycle traversed twice comes as near as once: the shorter one first.
        returns.sort_by(|a, b| {
            (a.0.max(1e-4))
                .total_cmp(&b.0.max(1e-4))
                .then(a.1.total_cmp(&b.1))
        });
        for (_, period) in returns.into_iter().take(3) {
            if let Ok(shooting) = ShootingNodes::along(tracer, field, last, period)
                && accept(tracer, shooting)
            {
                return Ok(());
            }
        }
    }
    Err(no_orbit(
        "the run does not converge to a periodic orbit".into(),
        "use `section` to see what it does, or give a `start` near the orbit",
    ))
}
