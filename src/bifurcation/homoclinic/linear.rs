//! The equations of a connection, linearised, and Newton's method on them.

use super::connection::{Connection, Fold, Frame, Layout, Place};
use super::saddle::{Kind, Splitting};
use crate::error::{Error, Result};
use crate::field::{Matrix, Vector};
use crate::orbit::{ParametrisedField, Tracer};

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

/// What solves for connections.
pub(super) struct Solver<'f> {
    pub family: &'f dyn ParametrisedField,
    pub tracer: Tracer,
    pub frame: Frame,
}

/// Iterations of Newton's method, at most; after the first ones corrections shrink.
const ITERATIONS: usize = 25;
const STRAYING: usize = 8;
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
        let in_frame = |a: &Matrix| frame.scaled(a);
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
            let fold = Fold::of(&field, &at.saddle, &jacobian, frame).ok_or_else(lost)?;
            rows.view_mut((row, 0), (1, n))
                .copy_from(&fold.in_states.transpose());
            for i in 0..2 {
                let slope = fold.in_parameter(&field, &at.saddle, places[i], frame);
                rows[(row, layout.parameter(i))] = slope * units[i];
            }
            gaps[row] = fold.value;
            errors[row] = 4.0 * f64::EPSILON + fold.value.abs();
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
                Condition::None => connection.layout().solved(&linear.rows, &-&linear.gaps),
                _ => {
                    let right = -linear.gaps.clone().push(missing);
                    linear.solve(connection.layout(), &row, right)
                }
            };
            let by = by.ok_or_else(|| failed(last))?;
            let size = by.amax();
            if !size.is_finite() || (iteration > STRAYING && size > last) {
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
fn lost() -> Error {
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
    pub fn solve(&self, layout: Layout, row: &Vector, right: Vector) -> Option<Vector> {
        layout.solved(&self.with(row), &right)
    }

    /// What each parameter of an isolated connection may be off by, in units of the frame.
    pub fn off(&self, layout: Layout) -> [f64; 2] {
        let solved = layout.solved_transposed(&self.rows, &layout.units());
        solved.map_or([f64::INFINITY; 2], |both| {
            [0, 1].map(|i| {
                let pairs = both[i].iter().zip(&self.errors);
                pairs.map(|(y, error)| y.abs() * error).sum()
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
        let tangent = self.solve(layout, &layout.row(along), right)?;
        let length = layout.dot(&tangent, &tangent).sqrt();
        (length > 0.0).then(|| tangent / length)
    }

    /// The vector that the equations without the parameters map to zero from the left: along the arcs it is the bounded solution of the adjoint equation. With it the
    /// slopes in both parameters of what it makes of the equations, which is the direction to the right of the tangent.
    pub fn adjoint(&self, layout: Layout, tangent: &Vector) -> Option<(Vector, [f64; 2])> {
        let count = self.rows.nrows();
        let all = self.with(&layout.row(tangent));
        let both = layout.solved_transposed(&all, &layout.units())?;
        let [first, second] = <[Vector; 2]>::try_from(both).ok()?;
        let [a, b] = [first[count], second[count]];
        let adjoint = (first * b - second * a).rows(0, count).into_owned();
        adjoint
            .iter()
            .all(|x| x.is_finite())
            .then_some((adjoint, [b, -a]))
    }
}
