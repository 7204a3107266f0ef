//! Pseudo-arclength continuation of a curve of zeros: predictor, corrector and step control.

use super::correct::{Hyperplane, from_afar, joined, onto, tangent};
use super::locate::{CurveStep, Located};
use super::{Branch, CurveObserver, CurvePoint, PointKind, Settings, Start, Stop, ZeroProblem};
use crate::error::{Error, Result};
use nalgebra::DVector;
use std::ops::ControlFlow;

/// A step that took so few corrections may be followed by a longer one.
const EASY: usize = 4;
/// By this factor.
const LONGER: f64 = 1.7;
/// A step that failed is repeated at this part of its length.
const SHORTER: f64 = 0.5;
/// For the eye alone no step is made shorter than this part of the longest.
const FINE: f64 = 0.01;

/// Follows the curve of zeros through `start`.
///
/// Points come to `watch` in the order of the curve.
///
/// # Errors
/// [`Error::Parameter`] for settings that make no sense or a start outside the range; [`Error::NotConverged`], or the problem's
/// own error, if there is no zero near the start. Whatever happens later is a [`Stop`].
pub fn follow(
    problem: &dyn ZeroProblem,
    start: &Start,
    settings: &Settings,
    watch: &mut dyn CurveObserver,
) -> Result<Branch> {
    let settings = settings.clone().checked()?;
    let (lowest, highest) = settings.range;
    if !(lowest..=highest).contains(&start.lambda) {
        return Err(Error::parameter("start", start.lambda, "within the range"));
    }
    let first = begin(problem, start, &settings)?;
    let mut continuation = CurveContinuation {
        problem,
        length: settings.first_step,
        settings: &settings,
        watch,
        points: Vec::new(),
        before: None,
        bend: DVector::zeros(problem.dimension() + 1),
    };
    let stopped = continuation.whole(first);
    Ok(Branch {
        points: continuation.points,
        stopped,
    })
}

fn begin(problem: &dyn ZeroProblem, start: &Start, settings: &Settings) -> Result<CurvePoint> {
    let n = problem.dimension();
    let guess = joined(&start.u, start.lambda);
    let fixed = Hyperplane::lambda(n, start.lambda);
    let across = Hyperplane {
        offset: start.direction.dot(&guess),
        normal: start.direction.clone(),
    };
    let plane = if start.across { &across } else { &fixed };
    let near = onto(problem, &guess, plane, settings.tolerance).map(|(x, _)| x);
    let mut x = near.or_else(|_| from_afar(problem, &guess, plane, settings.tolerance))?;
    x[n] = x[n].clamp(settings.range.0, settings.range.1);
    Ok(CurvePoint {
        u: x.rows(0, n).into_owned(),
        lambda: x[n],
        tangent: tangent(problem, &x, &start.direction)?,
        arclength: 0.0,
    })
}

struct CurveContinuation<'a> {
    problem: &'a dyn ZeroProblem,
    settings: &'a Settings,
    watch: &'a mut dyn CurveObserver,
    points: Vec<(CurvePoint, PointKind)>,
    length: f64,
    /// (u, lambda) of the point before.
    before: Option<DVector<f64>>,
    /// The change of the tangent per length in the last step: the predictor's second order.
    bend: DVector<f64>,
}

impl CurveContinuation<'_> {
    fn show(&mut self, point: &CurvePoint, mark: PointKind) -> ControlFlow<Stop> {
        self.points.push((point.clone(), mark));
        match self.watch.seen(point, mark) {
            ControlFlow::Break(()) => ControlFlow::Break(Stop::Observer),
            ControlFlow::Continue(()) => ControlFlow::Continue(()),
        }
    }

    fn whole(&mut self, first: CurvePoint) -> Stop {
        if let ControlFlow::Break(stop) = self.first(&first) {
            return stop;
        }
        let mut here = first;
        for _ in 1..self.settings.max_points {
            match self.step(&here) {
                ControlFlow::Continue(next) => {
                    self.before = Some(joined(&here.u, here.lambda));
                    here = next;
                }
                ControlFlow::Break(stop) => return stop,
            }
        }
        Stop::MaxPoints
    }

    fn first(&mut self, first: &CurvePoint) -> ControlFlow<Stop> {
        self.show(first, PointKind::Begin)?;
        for (i, &value) in self.settings.wanted.iter().enumerate() {
            if value == first.lambda {
                self.show(first, PointKind::Wanted(i))?;
            }
        }
        ControlFlow::Continue(())
    }

    /// One step, as long as it can be, with all that it meets.
    fn step(&mut self, here: &CurvePoint) -> ControlFlow<Stop, CurvePoint> {
        loop {
            match self.tried(here) {
                Ok(Some((next, met))) => return self.taken(next, met),
                Ok(None) if self.length > self.settings.shortest_step => self.length *= SHORTER,
                Err(_) if self.length > self.settings.shortest_step => self.length *= SHORTER,
                failed => {
                    if let Some(here) = self.by_secant(here) {
                        return self.step(&here);
                    }
                    return ControlFlow::Break(Stop::StepTooSmall {
                        lambda: here.lambda,
                        because: failed.err(),
                    });
                }
            }
        }
    }

    /// The same point with the direction from the one before: next to a branch point, by an accident of the steps, a tangent is
    /// lost to rounding or to the errors of the derivatives. Once only.
    fn by_secant(&mut self, here: &CurvePoint) -> Option<CurvePoint> {
        let across = joined(&here.u, here.lambda) - self.before.take()?;
        let length = across.norm();
        let tangent = across / length;
        if !(length > self.settings.shortest_step && tangent.dot(&here.tangent) > 0.0) {
            return None;
        }
        self.length = length.min(self.settings.longest_step);
        self.bend.fill(0.0);
        let here = here.clone();
        Some(CurvePoint { tangent, ..here })
    }

    /// The next point and what lies before it; nothing where the step is too long.
    fn tried(&mut self, here: &CurvePoint) -> Result<Option<(CurvePoint, Vec<Located>)>> {
        let (h, n) = (self.length, self.problem.dimension());
        let x = joined(&here.u, here.lambda);
        let guess = &x + &here.tangent * h + &self.bend * (0.5 * h * h);
        let plane = Hyperplane::ahead(here, h);
        let (at, corrections) = onto(self.problem, &guess, &plane, self.settings.tolerance)?;
        let next = CurvePoint {
            u: at.rows(0, n).into_owned(),
            lambda: at[n],
            tangent: tangent(self.problem, &at, &here.tangent)?,
            arclength: here.arclength + h,
        };
        let turn = next.tangent.dot(&here.tangent).min(1.0).acos();
        let sideways = (&at - &x - &here.tangent * h).norm();
        if turn > self.settings.largest_turn || sideways > h * self.settings.largest_turn {
            return Ok(None);
        }
        if self.watch.too_far(here, &next) && h > FINE * self.settings.longest_step {
            return Ok(None);
        }
        let step = CurveStep {
            problem: self.problem,
            settings: self.settings,
            from: here,
            to: &next,
            length: h,
        };
        let first = self.points.first().map(|(point, _)| point);
        let met = step.met(
            self.watch,
            first.filter(|first| first.arclength < here.arclength),
        )?;
        self.bend = (&next.tangent - &here.tangent) / h;
        if corrections <= EASY && turn < 0.5 * self.settings.largest_turn {
            self.length = (h * LONGER).min(self.settings.longest_step);
        }
        Ok(Some((next, met)))
    }

    fn taken(&mut self, next: CurvePoint, met: Vec<Located>) -> ControlFlow<Stop, CurvePoint> {
        for Located { point, mark, .. } in met {
            if let ControlFlow::Break(stop) = self.show(&point, mark) {
                return ControlFlow::Break(stop);
            }
            match mark {
                PointKind::Lowest | PointKind::Highest => {
                    return ControlFlow::Break(Stop::RangeEnd);
                }
                PointKind::Begin => return ControlFlow::Break(Stop::Closed),
                PointKind::Zero(i) if self.watch.ends(i) => {
                    return ControlFlow::Break(Stop::Ended(i));
                }
                _ => {}
            }
        }
        let (lowest, highest) = self.settings.range;
        if !(lowest..=highest).contains(&next.lambda) {
            // The curve left the range at the point where it began.
            return ControlFlow::Break(Stop::RangeEnd);
        }
        if let ControlFlow::Break(stop) = self.show(&next, PointKind::Step) {
            return ControlFlow::Break(stop);
        }
        ControlFlow::Continue(next)
    }
}
