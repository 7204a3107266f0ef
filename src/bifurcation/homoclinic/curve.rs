//! Homoclinic orbits as a curve that can be followed in the plane of both parameters.

use super::codimension_two::{Ends, Test};
use super::connection::{Frame, Layout, Place};
use super::linear::{Condition, Solved, Solver};
use super::saddle::Kind;
use crate::continuation::{CurveStep, SolutionCurve, StepControl, Stop, WatchedFunction};
use crate::error::{Error, Result};
use crate::field::Vector;

/// A homoclinic orbit with the direction of the curve.
#[derive(Debug, Clone)]
pub(super) struct HomoclinicPoint {
    pub solved: Solved,
    pub tangent: Vector,
    /// The same with its nodes in the places of the point that it was found from.
    arrived: Vector,
    places: Vec<Place>,
    /// The durations of its arcs where its nodes were chosen.
    chosen: Vec<f64>,
    ends: Ends,
    /// What the curve may be off by across itself, in units of the ranges.
    pub off: f64,
}

/// The curve, with what solves for its points.
pub(super) struct HomoclinicCurve<'s, 'f> {
    pub solver: &'s mut Solver<'f>,
    /// Factor on the step limits.
    pub step: f64,
}

/// The longest step and the first one, in units of the ranges and of the orbit.
const LONGEST: f64 = 0.05;
const FIRST: f64 = 1e-3;
const SHORTEST: f64 = 1e-9;
/// What a prediction may be off by.
const OFF: f64 = 0.01;
/// The least cosine between the directions before and after a step.
const COSINE: f64 = 0.9;
/// ln of what an arc may grow by before the nodes are chosen again.
const GROWN: f64 = 8.0;
/// By what factor the orbit may change its size before, and an arc become longer.
const RESIZED: f64 = 2.0;
const LONGER: f64 = 2.0;

impl HomoclinicPoint {
    pub fn layout(&self) -> Layout {
        self.solved.connection.layout()
    }

    /// What each parameter may be off by at the nearest point of the true curve, in its coordinate.
    pub fn uncertainty(&self, widths: [f64; 2]) -> [f64; 2] {
        let layout = self.layout();
        let along = [0, 1].map(|i| self.tangent[layout.parameter(i)]);
        let length = along[0].hypot(along[1]);
        [0, 1].map(|i| self.off * along[1 - i].abs() / length * widths[i])
    }

    /// The same of one parameter where the other one is exact.
    pub fn uncertainty_at(&self, i: usize, widths: [f64; 2]) -> f64 {
        let layout = self.layout();
        let along = [0, 1].map(|i| self.tangent[layout.parameter(i)]);
        self.off * along[0].hypot(along[1]) / along[1 - i].abs() * widths[i]
    }
}

impl Solver<'_> {
    /// A solved connection as a point of the curve, which goes on in this direction.
    pub fn point(
        &self,
        solved: Solved,
        along: &Vector,
        before: Option<&HomoclinicPoint>,
    ) -> Option<HomoclinicPoint> {
        let layout = solved.connection.layout();
        let arrived = solved.linear.tangent(layout, along)?;
        let places = {
            let field = self.family.field(solved.connection.at);
            solved
                .connection
                .places(&field, &self.frame, &solved.linear.splitting)
        };
        let linear = solved
            .linear
            .placed(&solved.connection, &places, &self.frame);
        let solved = Solved { linear, ..solved };
        let tangent = solved.linear.tangent(layout, &arrived)?;
        let (adjoint, slopes) = solved.linear.adjoint(layout, &tangent)?;
        let chosen = match before {
            Some(before) if before.layout().arcs == layout.arcs => before.chosen.clone(),
            _ => solved.connection.durations.clone(),
        };
        let errors = adjoint.iter().zip(&solved.linear.errors);
        let off: f64 = errors.map(|(y, error)| y.abs() * error).sum();
        let frame = &self.frame;
        Some(HomoclinicPoint {
            ends: Ends::new(&solved, &frame.sizes, &adjoint, before.map(|one| &one.ends)),
            places,
            chosen,
            off: off / slopes[0].hypot(slopes[1]),
            tangent,
            arrived,
            solved,
        })
    }
}

/// A non-central homoclinic orbit to a saddle-node, with what its parameters may be off by.
pub(super) struct NonCentral {
    pub solved: Solved,
    pub off: [f64; 2],
}

impl NonCentral {
    /// Near a homoclinic orbit to a saddle or to a saddle-node; `None` where there is none.
    pub fn near(point: &HomoclinicPoint, solver: &mut Solver<'_>) -> Option<Self> {
        let frame = solver.frame.clone();
        let found = Self::solved(point, solver);
        solver.frame = frame;
        found
    }

    fn solved(point: &HomoclinicPoint, solver: &mut Solver<'_>) -> Option<Self> {
        /// How far from it, in parts of the ranges.
        const NEAR: f64 = 0.1;
        let old = &point.solved.connection;
        let before = solver.frame.clone();
        solver.frame = Frame {
            sizes: before.sizes.clone(),
            first: before.first.clone(),
            widths: before.widths,
            ..Frame::new(old.saddle.len(), [(0.0, 1.0); 2], Kind::NonCentral)
        };
        let mut guess = old.clone();
        if before.kind == Kind::Saddle {
            // It leaves along the direction of the eigenvalue 0 now, which is slow.
            let away = |x: &Vector| (x - &old.saddle).component_div(&before.sizes).norm();
            let far = guess
                .nodes
                .iter()
                .position(|x| away(x) > solver.frame.radii[0])?;
            guess.nodes.drain(..far);
            guess.durations.drain(..far);
        } else {
            let splitting = solver.splitting(&guess.saddle, guess.at)?;
            guess = solver.extended(guess, &splitting, [false, true]);
        }
        let places = solver.places(&guess)?;
        let solved = solver.correct(guess, &places, &Condition::None).ok()?;
        let mut ways = (0..2).map(|i| (solved.connection.at[i] - old.at[i]) / before.widths[i]);
        if ways.any(|way| way.abs() > NEAR) {
            return None;
        }
        let off = solved.linear.off(solved.connection.layout());
        Some(NonCentral {
            off: [0, 1].map(|i| off[i] * before.widths[i]),
            solved,
        })
    }
}

impl HomoclinicCurve<'_, '_> {
    /// The point, or one beside it where a test function is zero at it.
    pub fn regular(&mut self, point: HomoclinicPoint) -> HomoclinicPoint {
        /// A value that is not zero.
        const CLEAR: f64 = 1e-6;
        let is_clear = |curve: &Self, point: &HomoclinicPoint| {
            let value = |test| {
                curve
                    .value(point, WatchedFunction::TestFunction(test))
                    .abs()
            };
            // Of what is not defined nothing is zero.
            !Test::ALL.iter().any(|&test| value(test) < CLEAR)
        };
        if is_clear(self, &point) {
            return point;
        }
        let beside = self.correct(&point, LONGEST * self.step).ok();
        beside.map_or(point, |(beside, _)| beside)
    }

    /// How far along the curve a zero of a test function may be off; infinite where its slope can't be told.
    pub fn off_along(&mut self, at: &HomoclinicPoint, test: Test) -> f64 {
        /// Where the slope is measured, in parts of the longest step.
        const BESIDE: f64 = 1e-3;
        let watch = WatchedFunction::TestFunction(test);
        let distance = BESIDE * LONGEST * self.step;
        let sides = [-distance, distance].map(|distance| {
            let beside = self.correct(at, distance).ok();
            beside.map_or(f64::NAN, |(beside, _)| self.value(&beside, watch))
        });
        let slope = (sides[1] - sides[0]).abs() / (2.0 * distance);
        let error = test.error(&at.solved, &self.solver.frame);
        let off = (self.value(at, watch).abs() + error) / slope;
        if off.is_finite() { off } else { f64::INFINITY }
    }

    /// The connection at a value of a parameter, near a point.
    fn landed(&mut self, near: &HomoclinicPoint, i: usize, value: f64) -> Option<HomoclinicPoint> {
        let guess = near.solved.connection.clone();
        let condition = Condition::Parameter(i, value);
        let solved = self.solver.correct(guess, &near.places, &condition).ok()?;
        let mut point = self.solver.point(solved, &near.tangent, Some(near))?;
        point.solved.connection.at[i] = value;
        Some(point)
    }

    /// Whether its nodes and units need to be chosen again.
    fn is_uneven(&self, point: &HomoclinicPoint) -> bool {
        let sizes = self.solver.frame.resized(&point.solved.connection);
        let mut pairs = sizes.iter().zip(&self.solver.frame.sizes);
        let resized = pairs.any(|(a, b)| !(b / RESIZED..=b * RESIZED).contains(a));
        let mut growths = point.solved.linear.growths.iter();
        let durations = &point.solved.connection.durations;
        let mut longer = durations.iter().zip(&point.chosen);
        resized
            || growths.any(|growth| *growth > GROWN)
            || longer.any(|(duration, chosen)| *duration > LONGER * chosen)
    }

    /// The same connection over other nodes.
    fn renewed(&mut self, point: &HomoclinicPoint) -> Option<HomoclinicPoint> {
        let old = &point.solved;
        let guess = self
            .solver
            .spread(&old.connection, &old.linear.growths)
            .ok()?;
        self.solver.frame.sizes = self.solver.frame.resized(&guess);
        let layout = guess.layout();
        let places = self.solver.places(&guess)?;
        // The parameter that varies more along the curve is where it was.
        let from = point.layout();
        let along = [0, 1].map(|i| point.tangent[from.parameter(i)]);
        let held = usize::from(along[0].abs() < along[1].abs());
        let condition = Condition::Parameter(held, guess.at[held]);
        let solved = self.solver.correct(guess, &places, &condition).ok()?;
        let mut direction = Vector::zeros(layout.count());
        direction
            .rows_mut(0, layout.dimension)
            .copy_from(&point.tangent.rows(0, layout.dimension));
        for i in 0..2 {
            direction[layout.parameter(i)] = along[i];
        }
        let before = Some(point);
        let mut new = self.solver.point(solved, &direction, before)?;
        if layout.of_parameters(&new.tangent, &direction) < 0.0 {
            let turned = -&new.tangent;
            new = self.solver.point(new.solved, &turned, before)?;
        }
        new.chosen = new.solved.connection.durations.clone();
        Some(new)
    }
}

impl SolutionCurve for HomoclinicCurve<'_, '_> {
    type Point = HomoclinicPoint;
    type TestFunction = Test;

    fn control(&self) -> StepControl {
        StepControl {
            first: FIRST * self.step,
            longest: LONGEST * self.step,
            shortest: SHORTEST,
            error: OFF,
            cosine: COSINE,
            progress: 1e-6,
        }
    }

    fn correct(&mut self, from: &HomoclinicPoint, distance: f64) -> Result<(HomoclinicPoint, f64)> {
        let origin = &from.solved.connection;
        let frame = self.solver.frame.clone();
        let guess = origin.moved(&(&from.tangent * distance), &frame);
        let condition = Condition::Along(&from.tangent, origin, distance);
        let solved = self
            .solver
            .correct(guess.clone(), &from.places, &condition)?;
        let layout = from.layout();
        let missed = solved.connection.from(&guess, &frame);
        let missed = layout.dot(&missed, &missed).sqrt();
        let point = self.solver.point(solved, &from.tangent, Some(from));
        let point = point.ok_or(Error::NotConverged {
            what: "the direction of the curve of homoclinic orbits",
            iterations: 1,
            residual: missed,
            tolerance: OFF,
        })?;
        Ok((point, missed))
    }

    fn cosine(&self, a: &HomoclinicPoint, b: &HomoclinicPoint) -> f64 {
        a.layout().dot(&a.tangent, &b.arrived)
    }

    fn failed(
        &mut self,
        here: &HomoclinicPoint,
        again: bool,
    ) -> std::result::Result<Option<HomoclinicPoint>, Stop> {
        Ok(if again { None } else { self.renewed(here) })
    }

    fn taken(
        &mut self,
        to: &HomoclinicPoint,
    ) -> std::result::Result<Option<HomoclinicPoint>, Stop> {
        let renewed = self.is_uneven(to).then(|| self.renewed(to));
        Ok(renewed.flatten())
    }

    fn value(&self, at: &HomoclinicPoint, watch: WatchedFunction<Test>) -> f64 {
        let layout = at.layout();
        match watch {
            WatchedFunction::TestFunction(test) => {
                test.value(&at.solved.linear.splitting, &at.ends)
            }
            WatchedFunction::Turn(i) => at.tangent[layout.parameter(i)],
            WatchedFunction::Value(i, value) => {
                (at.solved.connection.at[i] - value) / self.solver.frame.widths[i]
            }
            WatchedFunction::UserFunction(_) => f64::NAN,
        }
    }

    /// Zero all along a curve within its error is no zero of it.
    fn certain(
        &mut self,
        (watch, values): (WatchedFunction<Test>, [f64; 2]),
        at: &HomoclinicPoint,
        _: &CurveStep<HomoclinicPoint>,
    ) -> bool {
        /// How many times their error values are that are none of it.
        const CLEAR: f64 = 10.0;
        let WatchedFunction::TestFunction(test) = watch else {
            return true;
        };
        let error = test.error(&at.solved, &self.solver.frame);
        values.iter().all(|value| value.abs() > CLEAR * error)
    }

    fn slopes(
        &mut self,
        at: &HomoclinicPoint,
        watches: &[WatchedFunction<Test>],
        _: f64,
    ) -> Vec<Option<f64>> {
        let layout = at.layout();
        let slope = |watch: &WatchedFunction<Test>| match *watch {
            WatchedFunction::Value(i, _) => Some(at.tangent[layout.parameter(i)]),
            _ => None,
        };
        watches.iter().map(slope).collect()
    }

    fn solves(&self, watch: WatchedFunction<Test>) -> bool {
        matches!(watch, WatchedFunction::Value(..))
    }

    fn solve(
        &mut self,
        from: &HomoclinicPoint,
        near: &HomoclinicPoint,
        watch: WatchedFunction<Test>,
    ) -> Option<(f64, HomoclinicPoint)> {
        let WatchedFunction::Value(i, value) = watch else {
            return None;
        };
        let point = self.landed(near, i, value)?;
        let way = point
            .solved
            .connection
            .from(&from.solved.connection, &self.solver.frame);
        Some((from.layout().dot(&from.tangent, &way), point))
    }
}
