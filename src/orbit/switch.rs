//! Branch switching: from an orbit onto those of twice the period, from a symmetric one onto asymmetric ones.

use super::continuation_point::{ContinuationPoint, TangentVector};
use super::correct::Regular;
use super::cyclic;
use super::shooting_nodes::ShootingNodes;
use crate::field::State;

/// A place to begin a branch, and its direction there.
pub type Switch<const N: usize> = (ContinuationPoint<N>, TangentVector<N>);

impl<const N: usize> Regular<N> {
    /// At a period doubling: the orbit traversed twice, and the tangent vector that makes both rounds differ. `None` where that is not
    /// finite.
    pub fn doubled(&self) -> Option<Switch<N>> {
        // What comes back after one round with the other sign.
        let mut maps = self.linear.maps.clone();
        let last = maps.last_mut()?;
        *last = -*last;
        let round = cyclic::kernel(&maps)?;
        let (nodes, durations) = self.linear.carried(&round);
        let shooting = &self.site.shooting;
        let twice = |x: &[State<N>], sign: f64| -> Vec<State<N>> {
            x.iter()
                .copied()
                .chain(x.iter().map(|x| x * sign))
                .collect()
        };
        let site = ContinuationPoint {
            shooting: ShootingNodes {
                nodes: twice(&shooting.nodes, 1.0),
                durations: shooting.durations.repeat(2),
            },
            at: self.site.at,
        };
        let tangent = TangentVector {
            nodes: twice(&nodes, -1.0),
            durations: durations
                .iter()
                .copied()
                .chain(durations.iter().map(|t| -t))
                .collect(),
            parameters: [0.0; 2],
        };
        Some((site, tangent.normalised()?))
    }
}

impl Regular<2> {
    /// At a pitchfork: the orbit among all states, and the tangent vector in which both interfaces part. `None` where the arcs do not
    /// say how they do.
    pub fn asymmetric(&self) -> Option<Switch<3>> {
        let ContinuationPoint { shooting, at } = &self.site;
        let mut apart = 1.0;
        let mut nodes = Vec::with_capacity(shooting.nodes.len());
        for arc in &self.linear.arcs {
            nodes.push(State::<3>::new(0.0, apart, -apart));
            apart *= arc.log_transverse?.exp();
        }
        let tangent = TangentVector {
            nodes,
            durations: vec![0.0; shooting.durations.len()],
            parameters: [0.0; 2],
        };
        let embedded = shooting
            .nodes
            .iter()
            .map(|x| State::<3>::new(x[0], x[1], x[1]));
        let site = ContinuationPoint {
            shooting: ShootingNodes {
                nodes: embedded.collect(),
                durations: shooting.durations.clone(),
            },
            at: *at,
        };
        Some((site, tangent.normalised()?))
    }
}
