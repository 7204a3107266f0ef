//! The zeros of a small dense problem as a curve that can be followed.

use super::correct::{Hyperplane, failed, from_afar, joined, onto, tangent};
use super::{
    Branch, Continuation, CurveObserver, CurvePoint, CurveStep, Met, PointKind, Settings,
    SolutionCurve, Start, StepControl, Stop, WatchedFunction, ZeroProblem, changes_sign,
};
use crate::error::{Error, Result};
use nalgebra::DVector;
use std::ops::ControlFlow::{self, Break, Continue};

/// Where points can no longer be corrected, as next to a branch point, the interpolant between points nearer to each other than
/// this part of the longest step is as good.
const NARROW: f64 = 1e-4;
/// Slopes of test functions are differences over this part of the step.
const BESIDE: f64 = 1e-7;
/// Two points are one if they differ by no more than this many tolerances.
const SAME: f64 = 1e5;

/// Follows the curve of zeros through `start`.
///
/// Points come to `watch` in the order of the curve.
///
/// # Errors
/// [`Error::Parameter`] for settings that make no sense or a start outside the range; [`Error::NotConverged`], or the problem's
/// own error, if there is no zero near the start or it has no test functions. Whatever happens later is a [`Stop`].
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
    let curve = ZeroCurve {
        problem,
        settings: &settings,
        first: first.clone(),
        watch,
    };
    let now = curve.tested(first.clone())?;
    let watches = watches(&settings, now.tests.len());
    let mut told = Told {
        settings: &settings,
        points: Vec::new(),
        stopped: Stop::Observer,
    };
    let mut continuation = Continuation::new(curve, now);
    let (curve, first) = (&mut continuation.curve, &first);
    let begun = told.show(curve, first, PointKind::Begin);
    let stopped = if begun.is_break() || told.wanted(curve, first).is_break() {
        Stop::Observer
    } else {
        let most = settings.max_points.saturating_sub(1);
        continuation.follow(&watches, most, &mut |continuation, _, met| {
            told.met(&mut continuation.curve, met)
        })?
    };
    Ok(Branch {
        points: told.points,
        stopped: match stopped {
            Stop::Observer => told.stopped,
            Stop::MaxPoints(_) => Stop::MaxPoints(settings.max_points),
            other => other,
        },
    })
}

fn begin(problem: &dyn ZeroProblem, start: &Start, settings: &Settings) -> Result<CurvePoint> {
    let n = problem.dimension();
    let guess = joined(&start.u, start.lambda);
    let mut plane = Hyperplane::lambda(n, start.lambda);
    if start.across {
        plane.offset = start.direction.dot(&guess);
        plane.normal = start.direction.clone();
    }
    let near = onto(problem, &guess, &plane, settings.tolerance);
    let mut x = near.or_else(|_| from_afar(problem, &guess, &plane, settings.tolerance))?;
    x[n] = x[n].clamp(settings.range.0, settings.range.1);
    Ok(point(&x, tangent(problem, &x, &start.direction)?, 0.0))
}

/// A test function of a curve of zeros.
#[derive(Debug, Clone, Copy, PartialEq)]
enum ZeroTest {
    /// The observer's of this number.
    Observed(usize),
    /// The distance to the plane across the first point, where the curve may close.
    Closing,
}

/// All test functions, lambda at the wanted values and at both ends of the range.
fn watches(settings: &Settings, tests: usize) -> Vec<WatchedFunction<ZeroTest>> {
    let (lowest, highest) = settings.range;
    let tests = (0..tests).map(ZeroTest::Observed);
    let tests = tests.chain([ZeroTest::Closing]);
    let mut watches: Vec<_> = tests.map(WatchedFunction::TestFunction).collect();
    for &value in settings.wanted.iter().chain([&lowest, &highest]) {
        let watch = WatchedFunction::Value(0, value);
        if !watches.contains(&watch) {
            watches.push(watch);
        }
    }
    watches
}

fn point(x: &DVector<f64>, tangent: DVector<f64>, arclength: f64) -> CurvePoint {
    let n = x.len() - 1;
    CurvePoint {
        u: x.rows(0, n).into_owned(),
        lambda: x[n],
        tangent,
        arclength,
    }
}

/// A point with the observer's test functions.
#[derive(Debug, Clone)]
struct TestedPoint {
    point: CurvePoint,
    tests: Vec<f64>,
}

impl TestedPoint {
    fn place(&self) -> DVector<f64> {
        joined(&self.point.u, self.point.lambda)
    }
}

struct ZeroCurve<'a> {
    problem: &'a dyn ZeroProblem,
    settings: &'a Settings,
    watch: &'a mut dyn CurveObserver,
    first: CurvePoint,
}

impl ZeroCurve<'_> {
    fn tested(&self, point: CurvePoint) -> Result<TestedPoint> {
        let tests = self.watch.tests(&point)?;
        Ok(TestedPoint { point, tests })
    }

    /// What leads here from the first point.
    fn past_first(&self, at: &TestedPoint) -> DVector<f64> {
        at.place() - joined(&self.first.u, self.first.lambda)
    }

    /// Whether a test function is the user's.
    fn is_users(&self, watch: WatchedFunction<ZeroTest>) -> bool {
        match watch {
            WatchedFunction::TestFunction(ZeroTest::Observed(i)) => self.watch.is_users(i),
            _ => false,
        }
    }

    /// Whether this is the first point once more.
    fn closes(&self, at: &TestedPoint) -> bool {
        let size = 1.0 + at.place().amax();
        self.first.tangent.dot(&at.point.tangent) > 0.0
            && self.past_first(at).amax() <= SAME * self.settings.tolerance * size
    }

    /// The point in a plane, with the tangent that goes on along this one: at a branch point there is more than one.
    fn corrected(
        &self,
        guess: &DVector<f64>,
        plane: &Hyperplane,
        along: &DVector<f64>,
        arclength: f64,
    ) -> Result<TestedPoint> {
        let x = onto(self.problem, guess, plane, self.settings.tolerance)?;
        let tangent = tangent(self.problem, &x, along)
            .ok()
            .filter(|t| t.dot(along) > self.settings.largest_turn.cos())
            .unwrap_or_else(|| along.clone());
        self.tested(point(&x, tangent, arclength))
    }
}

impl SolutionCurve for ZeroCurve<'_> {
    type Point = TestedPoint;
    type TestFunction = ZeroTest;

    /// The error is the square of the angle by which the prediction misses, half of what the tangent turns by; half of the largest
    /// turn is aimed at.
    fn control(&self) -> StepControl {
        StepControl {
            first: self.settings.first_step,
            longest: self.settings.longest_step,
            shortest: self.settings.shortest_step,
            error: (0.25 * self.settings.largest_turn).powi(2),
            cosine: self.settings.largest_turn.cos(),
            progress: 0.0,
        }
    }

    fn stretch(&self, at: &TestedPoint) -> f64 {
        (at.point.u.norm() / self.settings.size).powi(2).max(1.0)
    }

    fn correct(&mut self, from: &TestedPoint, distance: f64) -> Result<(TestedPoint, f64)> {
        let CurvePoint {
            tangent: along,
            arclength,
            ..
        } = &from.point;
        let straight = from.place() + along * distance;
        let plane = Hyperplane::ahead(&from.point, distance);
        let x = onto(self.problem, &straight, &plane, self.settings.tolerance)?;
        let missed = (&x - &straight).norm() / distance;
        let next = point(&x, tangent(self.problem, &x, along)?, arclength + distance);
        // Farther aside there is another part of the curve, or another curve.
        let fine = distance < self.watch.finest() * self.settings.longest_step;
        if missed > self.settings.largest_turn || !fine && self.watch.too_far(&from.point, &next) {
            return Err(failed(0, missed, self.settings.largest_turn));
        }
        Ok((self.tested(next)?, missed * missed))
    }

    /// By Hermite's cubic.
    fn between(
        &mut self,
        from: &TestedPoint,
        [(s_a, a), (s_b, b)]: [(f64, &TestedPoint); 2],
        s: f64,
    ) -> Result<TestedPoint> {
        let h = s_b - s_a;
        let (t, r) = ((s - s_a) / h, (s_b - s) / h);
        let slope = |x: &TestedPoint| {
            let along = &x.point.tangent;
            along * (h / along.dot(&from.point.tangent))
        };
        let across = b.place() - a.place();
        let guess = a.place() + across * (t * t * (3.0 - 2.0 * t)) + slope(a) * (t * r * r)
            - slope(b) * (t * t * r);
        let along = (&a.point.tangent * r + &b.point.tangent * t).normalize();
        let arclength = from.point.arclength + s;
        let plane = Hyperplane::ahead(&from.point, s);
        self.corrected(&guess, &plane, &along, arclength)
            .or_else(|error| {
                if h.abs() > NARROW * self.settings.longest_step {
                    return Err(error);
                }
                self.tested(point(&guess, along, arclength))
            })
    }

    fn cosine(&self, a: &TestedPoint, b: &TestedPoint) -> f64 {
        a.point.tangent.dot(&b.point.tangent)
    }

    fn is_scaled(&self, watch: WatchedFunction<ZeroTest>) -> bool {
        !self.is_users(watch)
    }

    fn certain(
        &mut self,
        (watch, _): (WatchedFunction<ZeroTest>, [f64; 2]),
        at: &TestedPoint,
        step: &CurveStep<TestedPoint>,
    ) -> bool {
        !self.is_users(watch) || changes_sign(self, watch, at, step.length)
    }

    fn value(&self, at: &TestedPoint, watch: WatchedFunction<ZeroTest>) -> f64 {
        match watch {
            WatchedFunction::TestFunction(ZeroTest::Observed(i)) => at.tests[i],
            WatchedFunction::TestFunction(ZeroTest::Closing) => {
                self.first.tangent.dot(&self.past_first(at))
            }
            WatchedFunction::Turn(_) => at.point.lambda_slope(),
            WatchedFunction::Value(_, value) => at.point.lambda - value,
            // They are among the observer's test functions.
            WatchedFunction::UserFunction(_) => f64::NAN,
        }
    }

    fn slopes(
        &mut self,
        at: &TestedPoint,
        watches: &[WatchedFunction<ZeroTest>],
        length: f64,
    ) -> Vec<Option<f64>> {
        let (along, apart) = (&at.point.tangent, BESIDE * length);
        let beside = (!at.tests.is_empty()).then(|| {
            let plane = Hyperplane::ahead(&at.point, apart);
            let guess = at.place() + along * apart;
            self.corrected(&guess, &plane, along, at.point.arclength)
        });
        let beside = beside.and_then(Result::ok);
        let slope = |watch: &WatchedFunction<ZeroTest>| match *watch {
            WatchedFunction::TestFunction(ZeroTest::Observed(i)) => {
                let beside = beside.as_ref()?;
                Some((beside.tests[i] - at.tests[i]) / apart)
            }
            WatchedFunction::TestFunction(ZeroTest::Closing) => Some(self.first.tangent.dot(along)),
            WatchedFunction::Turn(_) | WatchedFunction::UserFunction(_) => None,
            WatchedFunction::Value(..) => Some(at.point.lambda_slope()),
        };
        watches.iter().map(slope).collect()
    }
}

/// What has been told of a curve so far.
struct Told<'a> {
    settings: &'a Settings,
    points: Vec<(CurvePoint, PointKind)>,
    /// Why there is no more.
    stopped: Stop,
}

impl Told<'_> {
    fn show(
        &mut self,
        curve: &mut ZeroCurve<'_>,
        point: &CurvePoint,
        mark: PointKind,
    ) -> ControlFlow<()> {
        self.points.push((point.clone(), mark));
        curve.watch.seen(point, mark)
    }

    /// The same at each wanted value.
    fn wanted(&mut self, curve: &mut ZeroCurve<'_>, point: &CurvePoint) -> ControlFlow<()> {
        for (i, &value) in self.settings.wanted.iter().enumerate() {
            if value == point.lambda {
                self.show(curve, point, PointKind::Wanted(i))?;
            }
        }
        Continue(())
    }

    fn met(&mut self, curve: &mut ZeroCurve<'_>, met: Met<'_, ZeroCurve<'_>>) -> ControlFlow<()> {
        let (lowest, highest) = self.settings.range;
        let (mark, point, ends) = match met {
            // The curve left the range at the point where it began.
            Met::Point(at) if !(lowest..=highest).contains(&at.point.lambda) => {
                self.stopped = Stop::RangeEnd;
                return Break(());
            }
            Met::Point(at) => (PointKind::Step, &at.point, None),
            Met::Zero(WatchedFunction::TestFunction(ZeroTest::Observed(i)), at) => {
                let ends = curve.watch.ends(i).then_some(Stop::Ended(i));
                (PointKind::Zero(i), &at.point, ends)
            }
            Met::Zero(WatchedFunction::Value(_, lambda), at) => {
                let point = CurvePoint {
                    lambda,
                    ..at.point.clone()
                };
                self.wanted(curve, &point)?;
                let mark = if lambda == lowest {
                    PointKind::Lowest
                } else if lambda == highest {
                    PointKind::Highest
                } else {
                    return Continue(());
                };
                (mark, &point.clone(), Some(Stop::RangeEnd))
            }
            Met::Zero(_, at) if curve.closes(at) => {
                (PointKind::Begin, &at.point, Some(Stop::Closed))
            }
            Met::Zero(..) => return Continue(()),
        };
        self.show(curve, point, mark)?;
        ends.map_or(Continue(()), |stop| {
            self.stopped = stop;
            Break(())
        })
    }
}
