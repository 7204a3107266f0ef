//! What a continuation knows of a curve: its points, their tangents, and what is watched along it.

use super::{StepControl, Stop};
use crate::error::Result;

/// Something whose zeros are looked for along a curve.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum WatchedFunction<T> {
    /// A test function.
    TestFunction(T),
    /// The tangent's component along a parameter: zero at folds of a branch, at tops of a curve of bifurcations.
    Turn(usize),
    /// A parameter's coordinate less this value.
    Value(usize, f64),
    /// The user's function of this number: in no unit that is known, and zero within its noise.
    UserFunction(usize),
}

/// One step along a curve.
#[derive(Debug, Clone)]
pub struct CurveStep<P> {
    /// Where it began.
    pub from: P,
    /// Where it ended.
    pub to: P,
    /// Their distance along the tangent at the first of them.
    pub length: f64,
}

/// What is watched along a curve.
pub(super) type Watched<C> = WatchedFunction<<C as SolutionCurve>::TestFunction>;

/// A curve of solutions with one degree of freedom, whatever is solved. What it leaves out is as the defaults say.
pub trait SolutionCurve {
    /// A solution with its tangent.
    type Point: Clone;
    /// What names a test function.
    type TestFunction: Copy + PartialEq;

    /// The limits of its steps.
    fn control(&self) -> StepControl;

    /// The solution in the hyperplane at this distance along the tangent of another, and what the tangent's prediction was off
    /// by, in a measure that grows with the square of the distance.
    ///
    /// # Errors
    /// That there is none that the step may lead to: it is shortened.
    fn correct(&mut self, from: &Self::Point, distance: f64) -> Result<(Self::Point, f64)>;

    /// The same between two places that are known, with their distances.
    ///
    /// # Errors
    /// As of [`Self::correct`].
    fn between(
        &mut self,
        from: &Self::Point,
        _known: [(f64, &Self::Point); 2],
        distance: f64,
    ) -> Result<Self::Point> {
        Ok(self.correct(from, distance)?.0)
    }

    /// The scalar product of two tangents.
    fn cosine(&self, a: &Self::Point, b: &Self::Point) -> f64;

    /// Whether a change of sign between these values is no noise, and so is to be landed on.
    fn is_clear(&self, _: (Watched<Self>, [f64; 2])) -> bool {
        false
    }

    /// What a point may be off along the curve.
    fn error(&self, _: &Self::Point) -> f64 {
        0.0
    }

    /// What the shortest step at a point is in units of.
    fn scale(&self, _: &Self::Point) -> f64 {
        1.0
    }

    /// The factor by which steps from a point may be longer than the longest.
    fn stretch(&self, _: &Self::Point) -> f64 {
        1.0
    }

    /// After a step from here has failed: the same point otherwise described, to be tried once more. `again` if it has been
    /// described anew already.
    ///
    /// # Errors
    /// Why it makes no sense to go on.
    fn failed(&mut self, _here: &Self::Point, _again: bool) -> Result<Option<Self::Point>, Stop> {
        Ok(None)
    }

    /// After a step has been taken: the point where it ended otherwise described, if need be.
    ///
    /// # Errors
    /// Why it makes no sense to go on.
    fn taken(&mut self, _to: &Self::Point) -> Result<Option<Self::Point>, Stop> {
        Ok(None)
    }

    /// Whether this can be watched here.
    ///
    /// # Errors
    /// Why not.
    fn checked(&self, _: Watched<Self>) -> Result<()> {
        Ok(())
    }

    /// Whether its values are of order one.
    fn is_scaled(&self, watch: Watched<Self>) -> bool {
        !matches!(watch, WatchedFunction::UserFunction(_))
    }

    /// The value of what is watched. NaN where it is undefined: no sign change then is seen.
    fn value(&self, at: &Self::Point, watch: Watched<Self>) -> f64;

    /// Whether the slope of what is watched takes much work.
    fn is_costly(&self, _: Watched<Self>) -> bool {
        false
    }

    /// Whether the curve goes straight on from a point to the next one. Then slopes that take much work are left out where values change little.
    fn is_straight(&self, _: &CurveStep<Self::Point>) -> bool {
        true
    }

    /// The slopes along the curve of all that is watched, where there are such, on a step of this length.
    fn slopes(
        &mut self,
        at: &Self::Point,
        watches: &[Watched<Self>],
        length: f64,
    ) -> Vec<Option<f64>>;

    /// Whether [`Self::solve`] knows the condition that this is zero.
    fn solves(&self, _: Watched<Self>) -> bool {
        false
    }

    /// By Newton's method on the condition itself, near a point: where this is zero, and its distance along a tangent.
    fn solve(
        &mut self,
        _from: &Self::Point,
        _near: &Self::Point,
        _watch: Watched<Self>,
    ) -> Option<(f64, Self::Point)> {
        None
    }

    /// A value so small is zero, where [`Self::solve`] does not know the condition.
    fn flat(&self) -> f64 {
        0.0
    }

    /// Whether a zero between two values, landed on at a point, is certainly no noise.
    fn certain(
        &mut self,
        (_watch, _values): (Watched<Self>, [f64; 2]),
        _at: &Self::Point,
        _step: &CurveStep<Self::Point>,
    ) -> bool {
        true
    }
}
