//! Multiple shooting: periodic orbits by Newton's method on many nodes at once.

use super::arc::{Arc, Tracer};
use super::linear::Linear;
use super::no_orbit;
use super::noise::{PROBES, Signs};
use super::shooting_nodes::ShootingNodes;
use crate::error::{Error, Result};
use crate::field::{Matrix, Vector};
use crate::integrate::AnyField;
use crate::number::Uncertain;

/// A closed shooting: a periodic orbit, with the derivatives along it.
#[derive(Debug, Clone)]
#[non_exhaustive]
pub struct Closed {
    /// The nodes and durations.
    pub shooting: ShootingNodes,
    /// Iterations made.
    pub iterations: usize,
    pub(super) linear: Linear,
    /// The last correction, which was not made: of a node in units of 1 + |x|, and of the period, relative.
    residual: (f64, f64),
    /// Whether it is one of a family of orbits of the same parameters, as those of a conservative system.
    pub in_family: bool,
}

impl Closed {
    /// The arcs from every node to the next.
    pub(crate) fn arcs(&self) -> &[Arc] {
        &self.linear.arcs
    }

    /// The maps from the plane across the flow at every node to the next, in orthonormal coordinates of these planes: one fewer
    /// than there are variables.
    pub fn maps(&self) -> &[Matrix] {
        &self.linear.maps
    }

    /// The period and a bound on the error of a node in units of 1 + |x|: what the noise of all arcs makes of them. The
    /// truncation error is not in it, unless it is asked for that the steps' errors may all have one sign.
    pub fn budget(&self, one_sign: bool) -> (Uncertain, f64) {
        /// Standard deviations that are claimed.
        const DEVIATIONS: f64 = 3.0;
        const ROUNDING: f64 = 4.0 * f64::EPSILON;
        let (mut of_period, mut of_nodes) = (0.0, vec![0.0; self.shooting.nodes.len()]);
        let period = self.shooting.period();
        let mut signs = Signs::new();
        for _ in 0..PROBES {
            let noisy = self.linear.noisy(&self.shooting, &mut signs);
            let correction = if self.in_family {
                self.linear.correction_in_family(&noisy.gaps)
            } else {
                self.linear.correction(&noisy.gaps)
            };
            let Some((nodes, durations)) = correction else {
                return (Uncertain::new(period, f64::INFINITY), f64::INFINITY);
            };
            of_period += durations.iter().sum::<f64>().powi(2);
            let moved = nodes.iter().zip(&self.shooting.nodes);
            for (sum, (dx, x)) in of_nodes.iter_mut().zip(moved) {
                *sum += relative(dx, x).powi(2);
            }
        }
        let steps: usize = self.arcs().iter().map(|arc| arc.steps).sum();
        // The durations are rounded too.
        let rounding = ROUNDING + 0.5 * f64::EPSILON * (steps as f64).sqrt();
        let factor = if one_sign {
            (steps as f64).sqrt()
        } else {
            DEVIATIONS
        };
        let claimed = |sum: f64| factor * (sum / PROBES as f64).sqrt();
        let of_nodes = of_nodes.into_iter().fold(0.0, f64::max);
        (
            Uncertain::new(
                period,
                claimed(of_period) + (rounding + self.residual.1) * period.abs(),
            ),
            claimed(of_nodes) + ROUNDING + self.residual.0,
        )
    }
}

/// An orbit of a smaller extent has shrunk to an equilibrium.
const SHRUNK: f64 = 1e-7;
/// Newton iterations, at most.
const ITERATIONS: usize = 30;
/// Relative size of a correction from which on the shooting is closed.
const CLOSED: f64 = 4e-15;
/// The same where corrections have ceased to shrink: the flow's own noise.
const NOISE: f64 = 1e-6;
/// The largest correction that is trusted whole.
const TRUSTED: f64 = 0.5;
/// The largest correction, of minimum norm, with which a shooting is near an orbit of a family.
const NEAR_FAMILY: f64 = 1e-4;
/// Times that a correction is halved because the flow fails.
const HALVINGS: usize = 8;

/// The largest component of dx in units of 1 + |x|.
pub(super) fn relative(dx: &Vector, x: &Vector) -> f64 {
    dx.iter()
        .zip(x)
        .map(|(dx, x)| dx.abs() / (1.0 + x.abs()))
        .fold(0.0, f64::max)
}

/// One whole step of Newton's method.
///
/// # Errors
/// [`Error::NotConverged`] where the linear equations are singular; those of [`ShootingNodes::checked`]; those of the flow.
pub fn newton_step(
    tracer: &mut Tracer,
    field: &AnyField<'_>,
    shooting: &ShootingNodes,
) -> Result<ShootingNodes> {
    shooting.checked(field.dimension())?;
    let linear = Linear::new(tracer, field, shooting)?;
    let correction = linear.correction(&linear.gaps);
    let (nodes, durations) = correction.ok_or(Error::NotConverged {
        what: "the periodic orbit",
        iterations: 1,
        residual: f64::INFINITY,
        tolerance: CLOSED,
    })?;
    Ok(shooting.moved(&nodes, &durations, 1.0))
}

/// Closes a shooting.
///
/// # Errors
/// [`Error::NotConverged`] where Newton's method does not; those of [`ShootingNodes::checked`]; those of the flow where no shorter
/// step avoids them.
pub fn close(tracer: &mut Tracer, field: &AnyField<'_>, guess: ShootingNodes) -> Result<Closed> {
    guess.checked(field.dimension())?;
    let alone = close_alone(tracer, field, guess.clone());
    match alone {
        Err(Error::NotConverged { .. } | Error::NoOrbit { .. }) => {
            close_in_family(tracer, field, &guess).map_or(alone, Ok)
        }
        _ => alone,
    }
}

fn close_alone(tracer: &mut Tracer, field: &AnyField<'_>, guess: ShootingNodes) -> Result<Closed> {
    let mut shooting = guess;
    let mut linear = Linear::new(tracer, field, &shooting)?;
    let (mut last, mut part) = (f64::INFINITY, 1.0_f64);
    for iterations in 1..=ITERATIONS {
        let failed = |residual: f64| Error::NotConverged {
            what: "the periodic orbit",
            iterations,
            residual,
            tolerance: CLOSED,
        };
        let Some((nodes, durations)) = linear.correction(&linear.gaps) else {
            return Err(failed(last));
        };
        if shooting.extent() < SHRUNK {
            return Err(no_orbit(
                format!(
                    "Newton's method converged to an equilibrium: the orbit shrank to {:e} of its size",
                    shooting.extent()
                ),
                "give a `start` farther from the equilibrium, or a `period_guess`",
            ));
        }
        let (of_nodes, of_period) = sizes(&shooting, &nodes, &durations);
        let of_durations = durations
            .iter()
            .zip(&shooting.durations)
            .map(|(dt, t)| (dt / t).abs());
        let stretch = of_durations.fold(0.0, f64::max);
        let size = of_nodes.max(of_period);
        // After a part of a correction the rest of it is no noise.
        if size < CLOSED || (size < NOISE && size > 0.3 * last && part == 1.0) {
            return Ok(Closed {
                shooting,
                iterations,
                linear,
                residual: (of_nodes, of_period),
                in_family: false,
            });
        }
        // In a family of orbits the equations are singular, and rounding errors move the iterates along the family.
        if size > last && part == 1.0 && is_near_family(&linear, &shooting) {
            return Err(failed(size));
        }
        last = size;
        part = (TRUSTED / of_nodes.max(stretch)).min(1.0);
        let mut halvings = 0;
        linear = loop {
            let trial = shooting.moved(&nodes, &durations, part);
            match Linear::new(tracer, field, &trial) {
                Ok(next) => {
                    shooting = trial;
                    break next;
                }
                Err(error) if halvings == HALVINGS => return Err(error),
                Err(_) => part *= 0.5,
            }
            halvings += 1;
        };
    }
    Err(Error::NotConverged {
        what: "the periodic orbit",
        iterations: ITERATIONS,
        residual: last,
        tolerance: CLOSED,
    })
}

/// A correction of a node in units of 1 + |x|, and of the period, relative.
fn sizes(shooting: &ShootingNodes, nodes: &[Vector], durations: &[f64]) -> (f64, f64) {
    let moved = nodes.iter().zip(&shooting.nodes);
    let of_nodes = moved.map(|(dx, x)| relative(dx, x)).fold(0.0, f64::max);
    let of_period = durations.iter().sum::<f64>().abs() / shooting.period().abs();
    (of_nodes, of_period)
}

/// Whether a correction of minimum norm exists, as in a family, and is small.
fn is_near_family(linear: &Linear, shooting: &ShootingNodes) -> bool {
    let correction = linear.correction_in_family(&linear.gaps);
    correction.is_some_and(|(nodes, durations)| {
        let (of_nodes, of_period) = sizes(shooting, &nodes, &durations);
        of_nodes.max(of_period) < NEAR_FAMILY
    })
}

/// Closes a nearly closed shooting on an orbit of a family, where Newton's equations are singular, by minimum-norm corrections. `None` for an
/// isolated orbit, or if it does not converge.
pub(super) fn close_in_family(
    tracer: &mut Tracer,
    field: &AnyField<'_>,
    guess: &ShootingNodes,
) -> Option<Closed> {
    /// What is left of the corrections.
    const LEFT: f64 = 1e-11;
    let mut shooting = guess.clone();
    let mut last = NEAR_FAMILY;
    for iterations in 1..=ITERATIONS {
        let linear = Linear::new(tracer, field, &shooting).ok()?;
        let (nodes, durations) = linear.correction_in_family(&linear.gaps)?;
        let (of_nodes, of_period) = sizes(&shooting, &nodes, &durations);
        let size = of_nodes.max(of_period);
        if size < CLOSED || (size < LEFT && size > 0.3 * last) {
            return Some(Closed {
                shooting,
                iterations,
                linear,
                residual: (of_nodes, of_period),
                in_family: true,
            });
        }
        if size > last {
            return None;
        }
        last = size;
        shooting = shooting.moved(&nodes, &durations, 1.0);
    }
    None
}
