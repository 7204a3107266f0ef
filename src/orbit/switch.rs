//! Branch switching: from an orbit onto those of twice the period, from a symmetric one onto asymmetric ones.

use super::continuation_point::{ContinuationPoint, TangentVector};
use super::correct::Regular;
use super::cyclic;
use super::shooting_nodes::ShootingNodes;
use crate::field::Vector;

/// A place to begin a branch, and its direction there.
pub type Switch = (ContinuationPoint, TangentVector);

impl Regular {
    /// At a period doubling: the orbit traversed twice, and the tangent vector that makes both rounds differ. `None` where that is
    /// not finite.
    pub fn doubled(&self) -> Option<Switch> {
        // What comes back after one round with the other sign.
        let mut maps = self.linear.maps.clone();
        let last = maps.last_mut()?;
        last.neg_mut();
        let round = cyclic::kernel(&maps)?;
        let (nodes, durations) = self.linear.carried(&round);
        let shooting = &self.site.shooting;
        let twice = |x: &[Vector], sign: f64| -> Vec<Vector> {
            x.iter()
                .cloned()
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

    /// Where another branch crosses this one: the orbit, and the direction in which the orbits of the other one leave it, but for its part along this one.
    pub(crate) fn aside(&self, along: &TangentVector) -> Option<Switch> {
        let round = cyclic::kernel(&self.linear.maps)?;
        let (nodes, durations) = self.linear.carried(&round);
        let kernel = TangentVector {
            nodes,
            durations,
            parameters: [0.0; 2],
        };
        let kernel = kernel.normalised()?;
        let part = kernel.dot(along) / along.dot(along);
        Some((self.site.clone(), kernel.plus(-part, along).normalised()?))
    }

    /// At a pitchfork: the orbit among all states, and the tangent vector in which both interfaces part. `None` where the arcs do
    /// not say how they do, and for orbits in other than two variables, which are no symmetric ones.
    pub fn asymmetric(&self) -> Option<Switch> {
        let ContinuationPoint { shooting, at } = &self.site;
        if shooting.dimension() != 2 {
            return None;
        }
        let state = |x: [f64; 3]| Vector::from_column_slice(&x);
        let mut apart = 1.0;
        let mut nodes = Vec::with_capacity(shooting.nodes.len());
        for arc in self.linear.arcs.iter() {
            nodes.push(state([0.0, apart, -apart]));
            apart *= arc.log_transverse?.exp();
        }
        let tangent = TangentVector {
            nodes,
            durations: vec![0.0; shooting.durations.len()],
            parameters: [0.0; 2],
        };
        let embedded = shooting.nodes.iter().map(|x| state([x[0], x[1], x[1]]));
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
