//! An orbit from near an equilibrium back to near it, with the equilibrium and both parameters, and the equations that these meet.
//!
//! The orbit begins in the unstable subspace of the linearisation at the equilibrium and ends in the stable one, at small distances (Beyn 1990, IMA J. Numer. Anal. 10,
//! 379). Between them it is shot over many nodes, which move across the flow. What the subspaces differ by from the invariant manifolds is estimated from
//! the curvature of the flow and the eigenvalues, and is part of the bound.

use super::saddle::{Kind, Singular, Splitting};
use crate::field::{Matrix, Vector};
use crate::integrate::AnyField;

/// An orbit that leaves an equilibrium and returns to it.
#[derive(Debug, Clone)]
pub(super) struct Connection {
    /// The equilibrium.
    pub saddle: Vector,
    /// Points along the orbit.
    pub nodes: Vec<Vector>,
    /// The times from each to the next, one fewer.
    pub durations: Vec<f64>,
    /// The coordinates of both parameters.
    pub at: [f64; 2],
}

/// What points go through in each variable. One that does not move has no size of its own, but that in which the errors of integrators are measured.
pub(super) fn extents<'p>(points: impl Iterator<Item = &'p Vector>) -> Vector {
    const STILL: f64 = 1e-9;
    let both = points.fold(None, |both: Option<[Vector; 2]>, x| match both {
        None => Some([x.clone(), x.clone()]),
        Some([least, most]) => Some([least.inf(x), most.sup(x)]),
    });
    let Some([least, most]) = both else {
        return Vector::zeros(0);
    };
    let extent = |a: f64, b: f64| {
        let unit = 1.0 + a.abs().max(b.abs());
        if b - a > STILL * unit { b - a } else { unit }
    };
    least.zip_map(&most, extent)
}

/// In what units a connection is measured.
#[derive(Debug, Clone)]
pub(super) struct Frame {
    /// Of the variables: what the orbit goes through.
    pub sizes: Vector,
    /// What these were at first.
    pub first: Vector,
    /// Of the parameters: the widths of their ranges.
    pub widths: [f64; 2],
    /// How far from the equilibrium it begins and ends, in these units.
    pub radii: [f64; 2],
    pub kind: Kind,
}

/// Where a node may move, relative to the equilibrium: nodes near it move with it.
#[derive(Debug, Clone)]
pub(super) enum Place {
    /// Across a direction, in units of the frame, through a point.
    Across { normal: Vector, through: Vector },
    /// At this distance, of what leaves the equilibrium or of what comes to it. Near the equilibrium the orbit may turn from one of its directions to
    /// another.
    Distance { leaves: bool, distance: f64 },
}

/// The places of the unknowns: the equilibrium, the nodes, ln of the durations, the parameters.
#[derive(Debug, Clone, Copy)]
pub(super) struct Layout {
    pub dimension: usize,
    pub arcs: usize,
}

impl Layout {
    pub fn node(self, k: usize) -> usize {
        self.dimension * (1 + k)
    }

    pub fn duration(self, k: usize) -> usize {
        self.dimension * (self.arcs + 2) + k
    }

    pub fn parameter(self, i: usize) -> usize {
        self.duration(self.arcs) + i
    }

    /// Unknowns.
    pub fn count(self) -> usize {
        self.parameter(2)
    }

    /// The first of the equations of an arc, behind those of the equilibrium.
    pub fn arc(self, k: usize) -> usize {
        self.dimension * (1 + k)
    }

    /// The first of those at the ends, behind those of the arcs.
    pub fn ends(self) -> usize {
        self.dimension * (1 + self.arcs)
    }

    /// The scalar product of two displacements: the mean over the equilibrium and all nodes, and the parameters. The times stay out of it: they grow without
    /// bound where an eigenvalue comes to the axis.
    pub fn dot(self, a: &Vector, b: &Vector) -> f64 {
        let states = self.duration(0);
        let of_states = a.rows(0, states).dot(&b.rows(0, states)) / (self.arcs + 2) as f64;
        of_states + self.of_parameters(a, b)
    }

    /// What the parameters contribute to it.
    pub fn of_parameters(self, a: &Vector, b: &Vector) -> f64 {
        let first = self.parameter(0);
        a.rows(first, 2).dot(&b.rows(first, 2))
    }

    /// The row with which a displacement's product is this scalar product with another.
    pub fn row(self, direction: &Vector) -> Vector {
        let mut row = direction.clone();
        let states = self.duration(0);
        row.rows_mut(0, states)
            .scale_mut(1.0 / (self.arcs + 2) as f64);
        row.rows_mut(states, self.arcs).fill(0.0);
        row
    }
}

/// The equation of a fold of equilibria: what is zero at it, and how that changes.
pub(super) struct Fold {
    pub value: f64,
    /// With the states, in units of the frame.
    pub in_states: Vector,
    singular: Singular,
}

impl Fold {
    /// At an equilibrium with this Jacobian, in units of the frame.
    pub fn of(field: &AnyField<'_>, x: &Vector, jacobian: &Matrix, frame: &Frame) -> Option<Self> {
        let singular = Singular::of(jacobian)?;
        let sizes = &frame.sizes;
        let right = singular.right.component_mul(sizes);
        let slope = |j: usize| {
            let mut unit = Vector::zeros(sizes.len());
            unit[j] = sizes[j];
            let bent = field.second_derivative(x, &unit, &right);
            singular.left.dot(&bent.component_div(sizes))
        };
        Some(Fold {
            value: singular.value,
            in_states: Vector::from_fn(sizes.len(), |j, _| slope(j)),
            singular,
        })
    }

    /// With the parameter in this place.
    pub fn in_parameter(
        &self,
        field: &AnyField<'_>,
        x: &Vector,
        place: usize,
        frame: &Frame,
    ) -> f64 {
        let right = self.singular.right.component_mul(&frame.sizes);
        let slope = field.parameter_jacobian(x, place) * right;
        self.singular.left.dot(&slope.component_div(&frame.sizes))
    }
}

impl Frame {
    /// The derivative of a map of states in its units.
    pub fn scaled(&self, derivative: &Matrix) -> Matrix {
        let n = self.sizes.len();
        let each = |i: usize, j: usize| derivative[(i, j)] * self.sizes[j] / self.sizes[i];
        Matrix::from_fn(n, n, each)
    }

    /// The sizes of the variables for an orbit. One that comes to move much less than the others, beside what it did at first, keeps a part of its size.
    pub fn resized(&self, connection: &Connection) -> Vector {
        const PART: f64 = 0.01;
        let sizes = connection.sizes();
        let factor = sizes.component_div(&self.first).max().min(1.0);
        sizes.zip_map(&self.first, |size, first| size.max(PART * factor * first))
    }
}

impl Connection {
    pub fn layout(&self) -> Layout {
        Layout {
            dimension: self.saddle.len(),
            arcs: self.durations.len(),
        }
    }

    /// Displaced by this, in units of the frame.
    pub fn moved(&self, by: &Vector, frame: &Frame) -> Self {
        let layout = self.layout();
        let n = layout.dimension;
        let part = |x: &Vector, first: usize| x + by.rows(first, n).component_mul(&frame.sizes);
        let nodes = self.nodes.iter().enumerate();
        let durations = self.durations.iter().enumerate();
        Connection {
            saddle: part(&self.saddle, 0),
            nodes: nodes.map(|(k, x)| part(x, layout.node(k))).collect(),
            durations: durations
                .map(|(k, t)| t * by[layout.duration(k)].exp())
                .collect(),
            at: [0, 1].map(|i| self.at[i] + by[layout.parameter(i)] * frame.widths[i]),
        }
    }

    /// From another one with as many nodes to this one, in units of the frame.
    pub fn from(&self, other: &Self, frame: &Frame) -> Vector {
        let layout = self.layout();
        let mut by = Vector::zeros(layout.count());
        let pairs = std::iter::once((&self.saddle, &other.saddle));
        let pairs = pairs.chain(self.nodes.iter().zip(&other.nodes));
        for (k, (x, y)) in pairs.enumerate() {
            let part = (x - y).component_div(&frame.sizes);
            by.rows_mut(k * layout.dimension, layout.dimension)
                .copy_from(&part);
        }
        for (k, (t, u)) in self.durations.iter().zip(&other.durations).enumerate() {
            by[layout.duration(k)] = (t / u).ln();
        }
        for i in 0..2 {
            by[layout.parameter(i)] = (self.at[i] - other.at[i]) / frame.widths[i];
        }
        by
    }

    /// What the orbit goes through in each variable.
    pub fn sizes(&self) -> Vector {
        extents(std::iter::once(&self.saddle).chain(&self.nodes))
    }

    /// Where its nodes may move: across the flow, or near the equilibrium and where they come nearer to it or leave it, at their distance from it.
    pub fn places(&self, field: &AnyField<'_>, frame: &Frame, splitting: &Splitting) -> Vec<Place> {
        /// Near is this part of the extent of the orbit; the least cosine between the flow and the way from the equilibrium.
        const NEAR: f64 = 0.1;
        const RADIAL: f64 = 0.1;
        let unit = |x: Vector| x.clone().try_normalize(0.0).unwrap_or(x);
        let place = |x: &Vector| {
            let normal = unit(field.f(x).component_div(&frame.sizes));
            let through = x - &self.saddle;
            let away = through.component_div(&frame.sizes);
            let sides = [true, false].map(|leaves| splitting.side(leaves).distance_of(&away));
            let leaves = sides[0].0 > sides[1].0;
            let (distance, gradient) = &sides[usize::from(!leaves)];
            if away.norm() < NEAR && normal.dot(gradient).abs() > RADIAL * gradient.norm() {
                return Place::Distance {
                    leaves,
                    distance: *distance,
                };
            }
            Place::Across { normal, through }
        };
        self.nodes.iter().map(place).collect()
    }
}
