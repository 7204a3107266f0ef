//! Branch switching: from an orbit onto those of twice the period, from a symmetric one onto asymmetric ones.

use super::continuation_point::{ContinuationPoint, TangentVector};
use super::correct::Regular;
use super::shooting_nodes::ShootingNodes;
use crate::field::State;

/// A place to begin a branch, and its direction there.
pub type Switch<const N: usize> = (ContinuationPoint<N>, TangentVector<N>);

impl Regular<3> {
    /// At a period doubling: the orbit traversed twice, and the tangent vector that makes both rounds differ. `None` where no
    /// multiplier is near -1.
    pub fn doubled(&self) -> Option<Switch<3>> {
        let maps = &self.linear.maps;
        // The eigenvector in the plane of the first node: the return map has nothing along the flow.
        let product = maps.iter().fold(None, |product, map| match product {
            None => Some(*map),
            Some(product) => Some(map * product),
        })?;
        let shifted = [
            [product[(1, 1)] + 1.0, product[(1, 2)]],
            [product[(2, 1)], product[(2, 2)] + 1.0],
        ];
        let larger = |a: [f64; 2], b: [f64; 2]| {
            if a[0].hypot(a[1]) > b[0].hypot(b[1]) {
                a
            } else {
                b
            }
        };
        let row = larger(shifted[0], shifted[1]);
        let mut u = State::<3>::new(0.0, -row[1], row[0]).normalize();
        let mut round = Vec::with_capacity(maps.len());
        for map in maps {
            round.push(u);
            u = map * u;
        }
        let (nodes, durations) = self.linear.carried(&round);
        let shooting = &self.site.shooting;
        let twice = |x: &[State<3>], sign: f64| -> Vec<State<3>> {
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
