//! Continuation points and tangent vectors: an orbit with both parameters, and how its nodes, durations and parameters change.

use super::shooting_nodes::ShootingNodes;
use super::solve::Orbit;
use crate::field::Vector;

/// A displacement of an orbit, or a direction in which it can be displaced.
#[derive(Debug, Clone, PartialEq)]
pub struct TangentVector {
    /// Of every node.
    pub nodes: Vec<Vector>,
    /// Of every duration.
    pub durations: Vec<f64>,
    /// Of the coordinates of both parameters.
    pub parameters: [f64; 2],
}

/// An orbit, or a guess of one, at a place in the plane of parameters.
#[derive(Debug, Clone, PartialEq)]
pub struct ContinuationPoint {
    /// Its nodes and durations.
    pub shooting: ShootingNodes,
    /// The coordinates of the parameters.
    pub at: [f64; 2],
}

impl TangentVector {
    /// The mean over the nodes of the products of their displacements, and those of the parameters. The durations and with
    /// them the period stay out of it: near homoclinic orbits and canards they would drown everything else.
    pub fn dot(&self, other: &Self) -> f64 {
        let nodes = self.nodes.iter().zip(&other.nodes).map(|(a, b)| a.dot(b));
        let parameters =
            self.parameters[0] * other.parameters[0] + self.parameters[1] * other.parameters[1];
        nodes.sum::<f64>() / self.nodes.len() as f64 + parameters
    }

    /// Times x.
    pub fn scaled(mut self, x: f64) -> Self {
        self.nodes.iter_mut().for_each(|dx| *dx *= x);
        self.durations.iter_mut().for_each(|dt| *dt *= x);
        self.parameters = self.parameters.map(|p| p * x);
        self
    }

    /// Plus x times another.
    pub(crate) fn plus(mut self, x: f64, other: &Self) -> Self {
        let nodes = self.nodes.iter_mut().zip(&other.nodes);
        nodes.for_each(|(a, b)| a.axpy(x, b, 1.0));
        let durations = self.durations.iter_mut().zip(&other.durations);
        durations.for_each(|(a, b)| *a += b * x);
        for (a, b) in self.parameters.iter_mut().zip(&other.parameters) {
            *a += b * x;
        }
        self
    }

    /// What of a tangent vector of this orbit does not depend on its nodes: the change of the parameters and of ln T.
    pub(super) fn seen_from_afar(&self, shooting: &ShootingNodes) -> [f64; 3] {
        let of_period = self.durations.iter().sum::<f64>() / shooting.period();
        [self.parameters[0], self.parameters[1], of_period]
    }

    /// Of length 1; `None` where it has none.
    pub(crate) fn normalised(self) -> Option<Self> {
        let length = self.dot(&self).sqrt();
        (length.is_finite() && length > 0.0).then(|| self.scaled(1.0 / length))
    }
}

impl Orbit {
    /// Where a continuation of this orbit begins; the coordinates of the parameters are yet to be set.
    pub fn beginning(self) -> ContinuationPoint {
        ContinuationPoint {
            shooting: ShootingNodes {
                nodes: self.nodes.into_iter().map(Vector::from_vec).collect(),
                durations: self.durations,
            },
            at: [0.0; 2],
        }
    }
}

impl ContinuationPoint {
    /// The same with other nodes: in other variables.
    pub(crate) fn with_nodes(&self, nodes: Vec<Vector>) -> Self {
        ContinuationPoint {
            shooting: ShootingNodes {
                nodes,
                durations: self.shooting.durations.clone(),
            },
            at: self.at,
        }
    }

    /// Displaced by x times this.
    pub fn moved(&self, tangent: &TangentVector, x: f64) -> Self {
        ContinuationPoint {
            shooting: self.shooting.moved(&tangent.nodes, &tangent.durations, x),
            at: [0, 1].map(|i| self.at[i] + x * tangent.parameters[i]),
        }
    }

    /// From another site with as many nodes to this one.
    pub fn from(&self, other: &Self) -> TangentVector {
        let pairs = self.shooting.nodes.iter().zip(&other.shooting.nodes);
        let durations = self
            .shooting
            .durations
            .iter()
            .zip(&other.shooting.durations);
        TangentVector {
            nodes: pairs.map(|(a, b)| a - b).collect(),
            durations: durations.map(|(a, b)| a - b).collect(),
            parameters: [0, 1].map(|i| self.at[i] - other.at[i]),
        }
    }

    /// How large a displacement is: the largest of a node's in units of 1 + |x|, of a duration's relative, of a parameter's
    /// coordinate.
    pub fn size(&self, tangent: &TangentVector) -> (f64, f64) {
        let mut nodes = 0_f64;
        for (dx, x) in tangent.nodes.iter().zip(&self.shooting.nodes) {
            for (dx, x) in dx.iter().zip(x) {
                nodes = nodes.max(dx.abs() / (1.0 + x.abs()));
            }
        }
        let pairs = tangent.durations.iter().zip(&self.shooting.durations);
        let stretch = pairs.map(|(dt, t)| (dt / t).abs()).fold(0.0, f64::max);
        let parameters = tangent
            .parameters
            .iter()
            .fold(0.0, |a: f64, p| a.max(p.abs()));
        (nodes.max(parameters), stretch)
    }
}
