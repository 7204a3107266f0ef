//! An orbit from near an equilibrium back to near it, with the equilibrium and both parameters, and the equations that these meet.
//!
//! The orbit begins in the unstable subspace of the linearisation at the equilibrium and ends in the stable one, at small distances (Beyn 1990, IMA J. Numer. Anal. 10,
//! 379). Between them it is shot over many nodes, which move across the flow. What the subspaces differ by from the invariant manifolds is estimated from
//! the curvature of the flow and the eigenvalues, and is part of the bound.

use super::saddle::{Kind, Singular, Splitting};
use crate::error::{Error, Result};
use crate::field::{Matrix, Vector};
use crate::integrate::AnyField;
use crate::orbit::{ParametrisedField, Tracer};

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

/// Where a node may move, beside the equilibrium: nodes near it go with it.
#[derive(Debug, Clone)]
pub(super) enum Place {
    /// Across a direction, in units of the frame, through a point.
    Across { normal: Vector, through: Vector },
    /// At this distance, of what leaves the equilibrium or of what comes to it. Near the equilibrium the orbit may turn from one of its directions to
    /// another.
    Distance { leaves: bool, distance: f64 },
}

/// A last equation.
pub(super) enum Condition<'a> {
    /// It is so far from another connection along a direction.
    Along(&'a Vector, &'a Connection, f64),
    /// A parameter's coordinate has this value.
    Parameter(usize, f64),
    /// No more is needed: it is isolated.
    None,
}

/// The equations of a connection, linearised: one fewer than there are unknowns, or as many where it is isolated.
#[derive(Debug, Clone)]
pub(super) struct Linear {
    pub rows: Matrix,
    /// What each equation misses.
    pub gaps: Vector,
    /// What each may be off by: rounding, the flow's error, and at both ends the curvature of the invariant manifolds.
    pub errors: Vector,
    /// ln of what each arc grows by.
    pub growths: Vec<f64>,
    pub splitting: Splitting,
    /// The first of the equations that hold the nodes in their places.
    first_of_places: usize,
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

impl Frame {
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

/// What solves for connections.
pub(super) struct Solver<'f> {
    pub family: &'f dyn ParametrisedField,
    pub tracer: Tracer,
    pub frame: Frame,
}

/// Iterations of Newton's method, at most.
const ITERATIONS: usize = 25;
/// The largest correction that is made whole, of nodes in units of the orbit, of times as a factor's logarithm.
const TRUSTED: f64 = 0.3;
/// A correction after which the next one is rounding.
const LAST: f64 = 1e-7;

/// A connection with its surroundings.
#[derive(Debug, Clone)]
pub(super) struct Solved {
    pub connection: Connection,
    pub linear: Linear,
}

impl Solver<'_> {
    /// The equations at a guess.
    pub fn linear(&mut self, at: &Connection, allowed: &[Place]) -> Result<Linear> {
        let frame = &self.frame;
        let layout = at.layout();
        let (n, m) = (layout.dimension, layout.arcs);
        let field = self.family.field(at.at);
        let places = self.family.plane();
        let scale = self.family.scale(at.at);
        let units = [0, 1].map(|i| scale[i] * frame.widths[i]);
        let inward = |x: Vector| x.component_div(&frame.sizes);
        let in_frame =
            |a: &Matrix| Matrix::from_fn(n, n, |i, j| a[(i, j)] * frame.sizes[j] / frame.sizes[i]);
        let jacobian = in_frame(&field.jacobian(&at.saddle));
        let splitting = Splitting::new(jacobian.clone(), frame.kind).ok_or_else(lost)?;
        let equations = match frame.kind {
            Kind::NonCentral => layout.count(),
            _ => layout.count() - 1,
        };
        let mut rows = Matrix::zeros(equations, layout.count());
        let mut gaps = Vector::zeros(equations);
        let mut errors = gaps.clone();
        let rounding = |x: &Vector| f64::EPSILON * x.component_div(&frame.sizes).amax();
        // The equilibrium.
        let size = jacobian.norm();
        rows.view_mut((0, 0), (n, n)).copy_from(&(&jacobian / size));
        let missing = inward(field.f(&at.saddle)) / size;
        gaps.rows_mut(0, n).copy_from(&missing);
        errors.rows_mut(0, n).fill(4.0 * rounding(&at.saddle));
        for i in 0..2 {
            let slope = inward(field.parameter_derivative(&at.saddle, places[i]));
            let slope = slope * (units[i] / size);
            rows.view_mut((0, layout.parameter(i)), (n, 1))
                .copy_from(&slope);
        }
        // The arcs.
        let mut growths = Vec::with_capacity(m);
        let mut arcs = self.tracer.arcs(&field, &places)?;
        for k in 0..m {
            let (first, here, next) = (layout.arc(k), layout.node(k), layout.node(k + 1));
            let arc = arcs.arc(&at.nodes[k], at.durations[k])?;
            let tangent = in_frame(&arc.tangent);
            growths.push(tangent.norm().ln());
            rows.view_mut((first, next), (n, n)).fill_with_identity();
            rows.view_mut((first, here), (n, n)).copy_from(&-tangent);
            let speed = inward(field.f(&arc.end)) * -at.durations[k];
            rows.view_mut((first, layout.duration(k)), (n, 1))
                .copy_from(&speed);
            for (i, unit) in units.iter().enumerate() {
                let slope = inward(arc.parameters.column(i).into_owned()) * -*unit;
                rows.view_mut((first, layout.parameter(i)), (n, 1))
                    .copy_from(&slope);
            }
            gaps.rows_mut(first, n)
                .copy_from(&inward(&at.nodes[k + 1] - &arc.end));
            /// Standard deviations that are claimed.
            const DEVIATIONS: f64 = 3.0;
            for i in 0..n {
                let size = (1.0 + arc.end[i].abs()) / frame.sizes[i];
                errors[first + i] = DEVIATIONS * arc.noise() * size;
            }
        }
        drop(arcs);
        // Both ends, and what is beside the subspaces there: the part of the flow that is not linear, over the rate at which it is left or forgotten.
        let mut row = layout.ends();
        let at_zero = field.f(&at.saddle);
        for (node, own, other) in [
            (0, &splitting.unstable, &splitting.stable),
            (m, &splitting.stable, &splitting.unstable),
        ] {
            let away = inward(&at.nodes[node] - &at.saddle);
            let bent = inward(field.f(&at.nodes[node]) - &at_zero) - &jacobian * &away;
            let across = &own.across;
            let count = across.nrows();
            let place = layout.node(node);
            rows.view_mut((row, place), (count, n)).copy_from(across);
            rows.view_mut((row, 0), (count, n)).copy_from(&-across);
            gaps.rows_mut(row, count).copy_from(&(across * &away));
            let own_rate = match frame.kind {
                Kind::Saddle => own.rates[0],
                _ => 0.0,
            };
            let rate = other.rates[0] + 2.0 * own_rate;
            let off = (across * bent).norm() / rate + 4.0 * rounding(&at.nodes[node]);
            errors.rows_mut(row, count).fill(off);
            row += count;
            let radius = frame.radii[usize::from(node > 0)];
            let (distance, unit) = own.distance_of(&away);
            rows.view_mut((row, place), (1, n))
                .copy_from(&unit.transpose());
            rows.view_mut((row, 0), (1, n))
                .copy_from(&-unit.transpose());
            gaps[row] = distance - radius;
            row += 1;
        }
        let first_of_places = row;
        row += m - 1;
        if frame.kind != Kind::Saddle {
            let singular = Singular::of(&jacobian).ok_or_else(lost)?;
            let outward = |x: &Vector| x.component_mul(&frame.sizes);
            let right = outward(&singular.right);
            for j in 0..n {
                let mut unit = Vector::zeros(n);
                unit[j] = frame.sizes[j];
                let bent = inward(field.second_derivative(&at.saddle, &unit, &right));
                rows[(row, j)] = singular.left.dot(&bent);
            }
            for i in 0..2 {
                let slope = inward(field.parameter_jacobian(&at.saddle, places[i]) * &right);
                let slope = slope * (units[i]);
                rows[(row, layout.parameter(i))] = singular.left.dot(&slope);
            }
            gaps[row] = singular.value;
            errors[row] = 4.0 * f64::EPSILON + singular.value.abs();
        }
        let linear = Linear {
            rows,
            gaps,
            errors,
            growths,
            splitting,
            first_of_places,
        };
        Ok(linear.placed(at, allowed, frame))
    }

    /// The connection near a guess, with its surroundings, its nodes where they may move.
    ///
    /// # Errors
    /// [`Error::NotConverged`]; those of the flow.
    pub fn correct(
        &mut self,
        guess: Connection,
        allowed: &[Place],
        condition: &Condition<'_>,
    ) -> Result<Solved> {
        let mut connection = guess;
        let mut last = f64::INFINITY;
        for iteration in 1..=ITERATIONS {
            let linear = self.linear(&connection, allowed)?;
            let (row, missing) = self.condition(&connection, condition);
            let failed = |residual| Error::NotConverged {
                what: "the homoclinic orbit",
                iterations: iteration,
                residual,
                tolerance: LAST,
            };
            let by = match condition {
                Condition::None => linear.rows.clone().lu().solve(&-&linear.gaps),
                _ => linear.solve(&row, -linear.gaps.clone().push(missing)),
            };
            let by = by.ok_or_else(|| failed(last))?;
            let size = by.amax();
            if !size.is_finite() || (iteration > 8 && size > last) {
                return Err(failed(size));
            }
            let part = (TRUSTED / size).min(1.0);
            connection = connection.moved(&(by * part), &self.frame);
            if size < LAST {
                let mut linear = self.linear(&connection, allowed)?;
                // What is left is part of what the equations may be off by.
                for (error, gap) in linear.errors.iter_mut().zip(&linear.gaps) {
                    *error += gap.abs();
                }
                return Ok(Solved { connection, linear });
            }
            last = size;
        }
        Err(Error::NotConverged {
            what: "the homoclinic orbit",
            iterations: ITERATIONS,
            residual: last,
            tolerance: LAST,
        })
    }

    /// The row of a condition, and what is missing to it.
    fn condition(&self, at: &Connection, condition: &Condition<'_>) -> (Vector, f64) {
        let layout = at.layout();
        match *condition {
            Condition::Along(direction, origin, distance) => {
                let here = at.from(origin, &self.frame);
                let row = layout.row(direction);
                let missing = layout.dot(direction, &here) - distance;
                (row, missing)
            }
            Condition::Parameter(i, value) => {
                let mut row = Vector::zeros(layout.count());
                row[layout.parameter(i)] = 1.0;
                (row, (at.at[i] - value) / self.frame.widths[i])
            }
            Condition::None => (Vector::zeros(layout.count()), 0.0),
        }
    }
}

/// The equilibrium is no saddle any more.
pub(super) fn lost() -> Error {
    Error::NoOrbit {
        what: "the equilibrium of the homoclinic orbit is no saddle".into(),
        period: None,
        hint: "give another range",
    }
}

impl Linear {
    /// The same with the nodes in these places.
    pub fn placed(mut self, at: &Connection, allowed: &[Place], frame: &Frame) -> Self {
        let layout = at.layout();
        let n = layout.dimension;
        let inward = |x: Vector| x.component_div(&frame.sizes);
        for (k, place) in allowed.iter().enumerate().take(layout.arcs).skip(1) {
            let row = self.first_of_places + k - 1;
            let away = inward(&at.nodes[k] - &at.saddle);
            let (normal, gap) = match place {
                Place::Across { normal, through } => {
                    let gap = normal.dot(&(&away - inward(through.clone())));
                    (normal.clone(), gap)
                }
                Place::Distance { leaves, distance } => {
                    let (here, gradient) = self.splitting.side(*leaves).distance_of(&away);
                    (gradient, here - distance)
                }
            };
            self.rows.row_mut(row).fill(0.0);
            let transposed = normal.transpose();
            self.rows
                .view_mut((row, layout.node(k)), (1, n))
                .copy_from(&transposed);
            self.rows.view_mut((row, 0), (1, n)).copy_from(&-transposed);
            self.gaps[row] = gap;
        }
        self
    }

    /// The displacement with these right-hand sides, of which the last is that of this row.
    pub fn solve(&self, row: &Vector, right: Vector) -> Option<Vector> {
        let solution = self.with(row).lu().solve(&right)?;
        solution.iter().all(|x| x.is_finite()).then_some(solution)
    }

    /// What each parameter of an isolated connection may be off by, in units of the frame.
    pub fn off(&self, layout: Layout) -> [f64; 2] {
        let transposed = self.rows.transpose().lu();
        [0, 1].map(|i| {
            let mut unit = Vector::zeros(self.rows.ncols());
            unit[layout.parameter(i)] = 1.0;
            let adjoint = transposed.solve(&unit);
            adjoint.map_or(f64::INFINITY, |adjoint| {
                adjoint
                    .iter()
                    .zip(&self.errors)
                    .map(|(y, error)| y.abs() * error)
                    .sum()
            })
        })
    }

    fn with(&self, row: &Vector) -> Matrix {
        let count = self.rows.nrows();
        let mut all = self.rows.clone().insert_row(count, 0.0);
        all.row_mut(count).copy_from(&row.transpose());
        all
    }

    /// The unit tangent, in the direction in which this one goes.
    pub fn tangent(&self, layout: Layout, along: &Vector) -> Option<Vector> {
        let mut right = Vector::zeros(self.rows.ncols());
        right[self.rows.ncols() - 1] = 1.0;
        let tangent = self.solve(&layout.row(along), right)?;
        let length = layout.dot(&tangent, &tangent).sqrt();
        (length > 0.0).then(|| tangent / length)
    }

    /// The vector that the equations without the parameters map to zero from the left: along the arcs it is the bounded solution of the adjoint equation. With it the
    /// slopes in both parameters of what it makes of the equations, which is the direction to the right of the tangent.
    pub fn adjoint(&self, layout: Layout, tangent: &Vector) -> Option<(Vector, [f64; 2])> {
        let count = self.rows.nrows();
        let transposed = self.with(&layout.row(tangent)).transpose().lu();
        let of = |i: usize| {
            let mut unit = Vector::zeros(count + 1);
            unit[layout.parameter(i)] = 1.0;
            transposed.solve(&unit)
        };
        let [first, second] = [of(0)?, of(1)?];
        let [a, b] = [first[count], second[count]];
        let adjoint = (first * b - second * a).rows(0, count).into_owned();
        adjoint
            .iter()
            .all(|x| x.is_finite())
            .then_some((adjoint, [b, -a]))
    }
}
