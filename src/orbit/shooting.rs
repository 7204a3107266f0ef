//! Periodic orbits by Newton's method on many nodes at once (multiple shooting).

use super::arc::{Arc, Tracer};
use super::linear::Linear;
use super::no_orbit;
use super::polygon::Polygon;
use crate::error::{Error, Result};
use crate::field::{Jacobian, State, VectorField};
use crate::number::Uncertain;

/// A closed polygon: a periodic orbit, with the derivatives along it.
#[derive(Debug, Clone)]
pub struct Closed<const N: usize> {
    /// The nodes and durations.
    pub polygon: Polygon<N>,
    /// Iterations made.
    pub iterations: usize,
    pub(super) linear: Linear<N>,
    /// The last correction, which was not made: of a node in units of 1 + |x|, or of the period, relative.
    residual: f64,
}

impl<const N: usize> Closed<N> {
    /// The arcs from every node to the next.
    pub fn arcs(&self) -> &[Arc<N>] {
        &self.linear.arcs
    }

    /// The maps from the plane across the flow at every node to the next, in orthonormal coordinates of which the first, along
    /// the flow, is zero.
    pub fn maps(&self) -> &[Jacobian<N>] {
        &self.linear.maps
    }

    /// The period and a bound on the error of a node in units of 1 + |x|: what the errors of all arcs may make of them, every
    /// arc's share added up.
    pub fn budget(&self) -> (Uncertain, f64) {
        let count = self.polygon.nodes.len();
        let mut gaps = vec![State::<N>::zeros(); count];
        let (mut of_period, mut of_nodes) = (0.0, vec![0.0; count]);
        let period = self.polygon.period();
        for k in 0..count {
            let at = self.polygon.nodes[(k + 1) % count];
            for i in 0..N {
                gaps[k][i] = self.linear.arcs[k].error * (1.0 + at[i].abs());
                let Some((nodes, durations)) = self.linear.correction(&gaps) else {
                    return (Uncertain::new(period, f64::INFINITY), f64::INFINITY);
                };
                of_period += durations.iter().sum::<f64>().abs();
                let moved = nodes.iter().zip(&self.polygon.nodes);
                for (sum, (dx, x)) in of_nodes.iter_mut().zip(moved) {
                    *sum += relative(dx, x);
                }
                gaps[k][i] = 0.0;
            }
        }
        let uncertainty = of_period + self.residual * period.abs();
        let of_nodes = of_nodes.into_iter().fold(0.0, f64::max) + self.residual;
        (Uncertain::new(period, uncertainty), of_nodes)
    }
}

/// An orbit of a smaller extent has shrunk to an equilibrium.
const SHRUNK: f64 = 1e-7;
/// Newton iterations, at most.
const ITERATIONS: usize = 30;
/// Relative size of a correction from which on the polygon is closed.
const CLOSED: f64 = 4e-15;
/// The same where corrections have ceased to shrink: the flow's own noise.
const NOISE: f64 = 1e-6;
/// The largest correction that is trusted whole.
const TRUSTED: f64 = 0.5;
/// Times that a correction is halved because the flow fails.
const HALVINGS: usize = 8;

/// The largest component of dx in units of 1 + |x|.
fn relative<const N: usize>(dx: &State<N>, x: &State<N>) -> f64 {
    (0..N)
        .map(|i| dx[i].abs() / (1.0 + x[i].abs()))
        .fold(0.0, f64::max)
}

/// One whole step of Newton's method.
///
/// # Errors
/// [`Error::NotConverged`] where the linear equations are singular; those of the flow.
pub fn newton_step<const N: usize>(
    tracer: &mut Tracer<N>,
    field: &dyn VectorField<N>,
    polygon: &Polygon<N>,
) -> Result<Polygon<N>> {
    let linear = Linear::new(tracer, field, polygon)?;
    let correction = linear.correction(&linear.gaps);
    let (nodes, durations) = correction.ok_or(Error::NotConverged {
        what: "the periodic orbit",
        iterations: 1,
        residual: f64::INFINITY,
        tolerance: CLOSED,
    })?;
    Ok(polygon.moved(&nodes, &durations, 1.0))
}

/// Closes a polygon.
///
/// # Errors
/// [`Error::NotConverged`] where Newton's method does not; those of the flow where no shorter step avoids them.
pub fn close<const N: usize>(
    tracer: &mut Tracer<N>,
    field: &dyn VectorField<N>,
    guess: Polygon<N>,
) -> Result<Closed<N>> {
    let mut polygon = guess;
    let mut linear = Linear::new(tracer, field, &polygon)?;
    let mut last = f64::INFINITY;
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
        if polygon.extent() < SHRUNK {
            return Err(no_orbit(
                format!(
                    "Newton's method shrank the orbit to an equilibrium, to {:e} of its size",
                    polygon.extent()
                ),
                "give a --start farther from the equilibrium, or a --period-guess",
            ));
        }
        let period = polygon.period();
        let moved = nodes.iter().zip(&polygon.nodes);
        let of_nodes = moved.map(|(dx, x)| relative(dx, x)).fold(0.0, f64::max);
        let of_durations = durations
            .iter()
            .zip(&polygon.durations)
            .map(|(dt, t)| (dt / t).abs());
        let stretch = of_durations.fold(0.0, f64::max);
        let size = of_nodes.max(durations.iter().sum::<f64>().abs() / period.abs());
        if size < CLOSED || (size < NOISE && size > 0.3 * last) {
            return Ok(Closed {
                polygon,
                iterations,
                linear,
                residual: size,
            });
        }
        last = size;
        let mut part = (TRUSTED / of_nodes.max(stretch)).min(1.0);
        let mut halvings = 0;
        linear = loop {
            let trial = polygon.moved(&nodes, &durations, part);
            match Linear::new(tracer, field, &trial) {
                Ok(next) => {
                    polygon = trial;
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
