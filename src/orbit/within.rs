//! Multipliers across a cluster: how a small split of interfaces that move alike grows along an orbit.
//!
//! While the stress, which all share, feels nothing of it, the difference of two states of a cluster obeys d(delta)/dt =
//! (d psi-rate / d psi) delta: one multiplier, exp of the integral of that rate over the period, as many times as there are interfaces
//! in the cluster but one.

use super::arc::Tracer;
use super::floquet::WithinCluster;
use super::shooting_nodes::ShootingNodes;
use crate::error::Result;
use crate::integrate::{AnyField, Choice, Control, MAX_STEPS, Tolerances};
use crate::number::{Jet, Uncertain};
use std::f64::consts::PI;

/// The rate at which a small difference in ln psi within a cluster grows, as a function of its number and (tau, ln psi), with the first
/// derivatives of that rate.
pub type SplitRate<'a> = &'a dyn Fn(usize, [f64; 2]) -> Jet<f64, 2>;

/// By what an orbit's arcs are gone along, and how well its nodes are known, in units of 1 + |x|.
#[derive(Debug, Clone, Copy)]
pub struct AlongArcs {
    /// The method.
    pub method: Choice,
    /// Its tolerances.
    pub tolerances: Tolerances,
    /// What a node may be off.
    pub uncertainty: f64,
}

/// The multipliers within those clusters that have more than one interface, of a field in (tau, ln psi of each cluster).
///
/// The uncertainty is what the rounding of the sums and the uncertainty of the nodes, of one sign all along, make of the integral, and
/// what a quadrature with fewer points differs by.
///
/// # Errors
/// Those of the flow.
pub fn within_clusters(
    field: &AnyField<'_>,
    shooting: &ShootingNodes,
    counts: &[usize],
    rate: SplitRate<'_>,
    along: AlongArcs,
) -> Result<Vec<WithinCluster>> {
    /// Points of the quadrature of a step: the steps of a Taylor series end well within its circle of convergence.
    const POINTS: usize = 10;
    const FEWER: usize = 8;
    let split = |(cluster, &count): (usize, &usize)| (count > 1).then_some((cluster, count));
    let split: Vec<_> = counts.iter().enumerate().filter_map(split).collect();
    if split.is_empty() {
        return Ok(Vec::new());
    }
    let (points, fewer) = (gauss(POINTS), gauss(FEWER));
    let mut sums = vec![Sum::default(); split.len()];
    let mut tracer = Tracer::new(along.method, along.tolerances, MAX_STEPS)?;
    let error = along.uncertainty;
    for (node, &duration) in shooting.nodes.iter().zip(&shooting.durations) {
        tracer.flow(
            field,
            node,
            duration,
            Some(&mut |step| {
                let length = step.length;
                for &(at, weight) in &points {
                    let y = step.after(at * length);
                    for (sum, &(cluster, _)) in sums.iter_mut().zip(&split) {
                        let here = [y[0], y[cluster + 1]];
                        sum.add(rate(cluster, here), here, weight * length, error);
                    }
                }
                for &(at, weight) in &fewer {
                    let y = step.after(at * length);
                    for (sum, &(cluster, _)) in sums.iter_mut().zip(&split) {
                        let rate = rate(cluster, [y[0], y[cluster + 1]]).value;
                        sum.by_fewer += weight * length * rate;
                    }
                }
                Ok(Control::Continue)
            }),
        )?;
    }
    let within = split.iter().zip(sums);
    let within = within.map(|(&(cluster, count), sum)| WithinCluster {
        cluster: cluster + 1,
        multiplicity: count - 1,
        ln_abs: sum.uncertain(),
    });
    Ok(within.collect())
}

/// An integral on its way.
#[derive(Debug, Clone, Copy, Default)]
struct Sum {
    value: f64,
    by_fewer: f64,
    /// Of the absolute values.
    size: f64,
    /// What the uncertainty of the states makes.
    moved: f64,
}

impl Sum {
    fn add(&mut self, rate: Jet<f64, 2>, [tau, w]: [f64; 2], weight: f64, error: f64) {
        self.value += weight * rate.value;
        self.size += (weight * rate.value).abs();
        let [of_tau, of_state] = rate.gradient.map(f64::abs);
        let change = of_tau * (1.0 + tau.abs()) + of_state * (1.0 + w.abs());
        self.moved += weight.abs() * change * error;
    }

    fn uncertain(self) -> Uncertain {
        let differs = (self.value - self.by_fewer).abs();
        let rounding = 2.0 * f64::EPSILON * self.size;
        Uncertain::new(self.value, differs + rounding + self.moved)
    }
}

/// Nodes and weights of the Gauss-Legendre quadrature on (0, 1), from the zeros of the Legendre polynomial by Newton's method.
fn gauss(points: usize) -> Vec<(f64, f64)> {
    const ITERATIONS: usize = 8;
    let n = points as f64;
    // P_n and its derivative.
    let legendre = |x: f64| {
        let (mut last, mut here) = (1.0, x);
        for k in 2..=points {
            let k = k as f64;
            let next = ((2.0 * k - 1.0) * x * here - (k - 1.0) * last) / k;
            (last, here) = (here, next);
        }
        (here, n * (x * here - last) / (x * x - 1.0))
    };
    let node = |i: usize| {
        let mut x = (PI * (i as f64 + 0.75) / (n + 0.5)).cos();
        for _ in 0..ITERATIONS {
            let (value, slope) = legendre(x);
            x -= value / slope;
        }
        let (_, slope) = legendre(x);
        let weight = 1.0 / ((1.0 - x * x) * slope * slope);
        (0.5 * (1.0 - x), weight)
    };
    (0..points).map(node).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_quadrature_is_exact_to_its_degree() {
        for points in [8, 10] {
            for degree in 0..2 * points as i32 {
                let terms = gauss(points).into_iter();
                let sum: f64 = terms.map(|(x, weight)| weight * x.powi(degree)).sum();
                let exact = 1.0 / f64::from(degree + 1);
                assert!((sum - exact).abs() < 1e-15, "{degree}: {sum} for {exact}");
            }
        }
    }
}
