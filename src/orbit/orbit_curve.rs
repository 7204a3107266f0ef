//! Periodic orbits as a curve that can be followed: along a branch, one parameter free, or a curve of bifurcations, with both.

use super::certain::{CLEAR, certain};
use super::conditions::Condition;
use super::continuation_point::{ContinuationPoint, TangentVector};
use super::correct::{Corrector, Regular};
use super::goal::Goal;
use super::new_nodes::no_nodes;
use super::test_function::TestFunction;
use super::user_function::{self, of_orbit_beyond_noise};
use super::winding::{Turns, quarter_turn};
use crate::continuation::{
    self, Continuation, CurveStep, SolutionCurve, StepControl, Stop, changes_sign,
};
use crate::error::{Error, Result};
use std::sync::Arc as Shared;

/// Where a continuation stands.
#[derive(Debug, Clone)]
#[non_exhaustive]
pub struct DirectedPoint {
    /// The orbit and its surroundings.
    pub here: Regular,
    /// The direction of the continuation.
    pub direction: TangentVector,
}

/// What is followed.
#[derive(Debug, Clone, PartialEq)]
pub struct PalcSettings {
    /// The free parameters: one for a branch, both for a bifurcation.
    pub free: Vec<usize>,
    /// The condition of a curve: a test function of its bifurcation, or the user's function of its orbits, vanishes.
    pub condition: Option<WatchedFunction>,
    /// The longest step.
    pub longest: f64,
}

/// What is watched along a continuation of orbits, and the condition that it is zero.
pub type WatchedFunction = continuation::WatchedFunction<TestFunction>;

impl WatchedFunction {
    /// Along a branch a turn is a fold.
    pub(crate) fn condition<'a>(self) -> Condition<'a> {
        match self {
            WatchedFunction::TestFunction(test_function) => Condition::TestFunction(test_function),
            WatchedFunction::Value(i, value) => Condition::Parameter(i, value),
            WatchedFunction::Turn(_) => Condition::TestFunction(TestFunction::Fold),
            WatchedFunction::UserFunction(which) => Condition::UserFunction(which),
        }
    }
}

/// Orbits that meet the conditions of a branch or of a bifurcation.
pub struct OrbitCurve<'c, 'f> {
    /// What makes its orbits.
    pub corrector: &'c mut Corrector<'f>,
    /// What it is along.
    pub settings: PalcSettings,
}

/// The pseudo-arclength continuation of periodic orbits.
pub type Palc<'c, 'f> = Continuation<OrbitCurve<'c, 'f>>;

/// Lengths of the first and of the shortest steps; of orbits smaller than 1 the shortest is this part of their extent.
const FIRST: f64 = 0.02;
const SHORTEST: f64 = 1e-9;
/// What a first correction is to be.
const OFF: f64 = 0.03;
/// The least cosine between the directions before and after a step.
const TURN: f64 = 0.7;
/// And where a step has gone straight on.
const STRAIGHT: f64 = 0.95;
/// Progress of the last steps, as a part of the way.
const PROGRESS: f64 = 2e-7;
/// By how much the time to the next plane is expected to change in a step, at most; and the period, which a second time around doubles.
const STRETCH: f64 = 2.0;
const LONGER: f64 = 1.8;
/// By how much the way of a variable may grow or shrink in a step.
const LARGER: f64 = 2.5;
/// Shorter steps are not looked at for their sense.
const ANY_SENSE: f64 = 1e-5;
/// A slope along a parameter that is small enough where it has no condition of its own.
const FLAT: f64 = 1e-3;

impl PalcSettings {
    /// A branch along this parameter.
    pub fn branch(parameter: usize, longest: f64) -> Self {
        PalcSettings {
            free: vec![parameter],
            condition: None,
            longest,
        }
    }

    /// A curve of bifurcations.
    pub fn locus(test_function: TestFunction, longest: f64) -> Self {
        PalcSettings {
            free: vec![0, 1],
            condition: Some(WatchedFunction::TestFunction(test_function)),
            longest,
        }
    }

    /// A curve of orbits at which the user's function of this number vanishes.
    pub fn held(which: usize, longest: f64) -> Self {
        PalcSettings {
            free: vec![0, 1],
            condition: Some(WatchedFunction::UserFunction(which)),
            longest,
        }
    }

    /// Of a curve of torus bifurcations on which a second pair may come to the unit circle: by the pair that is on it at an orbit, or that goes on from there.
    pub(crate) fn with_pair(mut self, here: &Regular) -> Self {
        self.take_pair(here);
        self
    }

    /// Where pairs become real, at the resonances 1:1 and 1:2, none is followed.
    fn take_pair(&mut self, here: &Regular) {
        let spectrum = &here.spectrum;
        let sum = match self.condition {
            Some(WatchedFunction::TestFunction(TestFunction::Torus)) => spectrum.two_pairs(None),
            Some(WatchedFunction::TestFunction(TestFunction::Pair(last))) => {
                spectrum.two_pairs(Some(last))
            }
            _ => return,
        };
        let condition = sum.map_or(TestFunction::Torus, |[own, _]| TestFunction::Pair(own));
        self.condition = Some(WatchedFunction::TestFunction(condition));
    }

    /// What is zero, along this curve, where something that is watched is zero near an orbit; `None` where there can be none.
    pub(crate) fn meaning(
        &self,
        watch: WatchedFunction,
        near: &Regular,
    ) -> Option<WatchedFunction> {
        match (watch, self.condition) {
            (
                WatchedFunction::TestFunction(TestFunction::SecondPair),
                Some(WatchedFunction::TestFunction(TestFunction::Pair(own))),
            ) => {
                let [_, second] = near.spectrum.two_pairs(Some(own))?;
                Some(WatchedFunction::TestFunction(TestFunction::Pair(second)))
            }
            _ => Some(watch),
        }
    }

    /// The curve's own conditions: none on a branch.
    pub(crate) fn own<'a>(&self) -> Vec<Condition<'a>> {
        let own = self.condition.map(WatchedFunction::condition);
        own.into_iter().collect()
    }

    /// The curve's own conditions and one more.
    pub fn and<'a>(&self, last: Condition<'a>) -> Vec<Condition<'a>> {
        self.own().into_iter().chain([last]).collect()
    }

    /// The direction of the curve at an orbit, with the sign that makes the product with `before` positive.
    pub fn direction(&self, at: &Regular, before: &TangentVector) -> Option<TangentVector> {
        let direction = match (&at.along[..], at.gradients.first()) {
            ([only], _) => only.clone(),
            // Where the test function does not change.
            ([first, second], Some(gradient)) => {
                let (a, b) = (gradient.dot(first), gradient.dot(second));
                first.clone().scaled(b).plus(-a, second).normalised()?
            }
            _ => return None,
        };
        let sign = if direction.dot(before) < 0.0 {
            -1.0
        } else {
            1.0
        };
        Some(direction.scaled(sign))
    }
}

impl<'c, 'f> Palc<'c, 'f> {
    /// From an orbit nearby into a direction: the first correction is across it.
    ///
    /// # Errors
    /// Those of [`Corrector::correct`].
    pub fn from(
        corrector: &'c mut Corrector<'f>,
        settings: PalcSettings,
        site: ContinuationPoint,
        direction: TangentVector,
    ) -> Result<Self> {
        let conditions = settings.and(Condition::Plane(&direction, &site));
        let here = corrector.correct(site.clone(), &settings.free, &conditions, Goal::STEP)?;
        Self::at(corrector, settings, here, &direction)
    }

    /// From an orbit of the curve itself.
    ///
    /// # Errors
    /// [`Error::NotConverged`] where the curve has no direction there.
    pub(crate) fn at(
        corrector: &'c mut Corrector<'f>,
        settings: PalcSettings,
        here: Regular,
        direction: &TangentVector,
    ) -> Result<Self> {
        let direction = settings
            .direction(&here, direction)
            .ok_or_else(no_direction)?;
        let curve = OrbitCurve {
            corrector,
            settings,
        };
        let first = DirectedPoint { here, direction };
        Ok(Continuation::new(curve, first))
    }

    /// Going on where another continuation stands, after a change of variables to those of this orbit, with steps up to `longest`.
    pub(crate) fn resumed(
        corrector: &'c mut Corrector<'f>,
        other: &Palc<'_, '_>,
        site: ContinuationPoint,
        longest: f64,
    ) -> Option<Self> {
        let settings = PalcSettings {
            longest,
            ..other.curve.settings.clone()
        };
        let DirectedPoint { here, direction } = &other.now;
        let afar = direction.seen_from_afar(&here.site.shooting);
        // Closed in the new variables, with the parameter in which it moves most held.
        let fixed = if afar[1].abs() > afar[0].abs() && settings.free.contains(&1) {
            1
        } else {
            settings.free[0]
        };
        let held = Condition::Parameter(fixed, site.at[fixed]);
        let here = corrector
            .correct(site, &settings.free, &settings.and(held), Goal::STEP)
            .ok()?;
        let mut curve = OrbitCurve {
            corrector,
            settings,
        };
        let linear = Shared::unwrap_or_clone(here.linear);
        let now = curve.arrived(here.site, linear, |site, new| {
            product(&afar, &new.seen_from_afar(&site.shooting))
        })?;
        let now = curve.cut(&now)?;
        Some(Continuation::new(curve, now).resuming(other))
    }
}

impl SolutionCurve for OrbitCurve<'_, '_> {
    type Point = DirectedPoint;
    type TestFunction = TestFunction;

    fn control(&self) -> StepControl {
        let longest = self.settings.longest;
        StepControl {
            first: FIRST.min(longest),
            longest,
            shortest: SHORTEST,
            error: OFF,
            cosine: TURN,
            progress: PROGRESS,
        }
    }

    fn correct(&mut self, from: &DirectedPoint, distance: f64) -> Result<(DirectedPoint, f64)> {
        let DirectedPoint { here, direction } = from;
        let field = self.corrector.family.field(here.site.at);
        let nodes = here.site.shooting.nodes.iter();
        let flows: Vec<_> = nodes.map(|x| field.f(x)).collect();
        let quarter_turn = quarter_turn(&field, &here.site.shooting, &flows);
        let turns = Turns::of(&here.site.shooting, &flows);
        drop(field);
        let predicted = here.site.moved(direction, distance);
        let mut predicted = predicted.moved_along(&here.site, &flows);
        let durations = here.site.shooting.durations.iter();
        for (now, then) in durations.zip(&mut predicted.shooting.durations) {
            *then = now * (*then / now).clamp(1.0 / STRETCH, STRETCH);
        }
        let conditions = self.settings.and(Condition::Plane(direction, &predicted));
        // The gradients there, and not those of the orbit here: the direction depends on them.
        let next = self.corrected(here, predicted.clone(), &conditions)?;
        let [period, to] = [&here, &&next].map(|orbit| orbit.site.shooting.period());
        if (to / period).ln().abs() > LONGER.ln() {
            return Err(not_near("a step to an orbit of about the same period"));
        }
        let [before, then] = [&here, &&next].map(|orbit| &orbit.site.shooting.durations[..]);
        if quarter_turn.is_some_and(|most| (to - period).abs() > most)
            || turns.is_some_and(|turns| turns.may_be_more(before, then))
        {
            return Err(not_near("a step to an orbit with as many turns"));
        }
        if !here.site.shooting.is_like(&next.site.shooting, LARGER) {
            return Err(not_near("a step to an orbit of about the same shape"));
        }
        if self.settings.condition.is_none() {
            self.goes_on(from, distance, (&predicted, &next))?;
        }
        let first = next.first;
        let direction = self
            .settings
            .direction(&next, direction)
            .ok_or_else(no_direction)?;
        let to = DirectedPoint {
            here: next,
            direction,
        };
        if distance > ANY_SENSE && !self.keeps_its_sense(from, &to) {
            return Err(not_near("a step that goes on in the same sense"));
        }
        if distance > ANY_SENSE && !self.comes_back(from, &to) {
            return Err(not_near("a step that stays on its branch"));
        }
        Ok((to, first))
    }

    fn cosine(&self, a: &DirectedPoint, b: &DirectedPoint) -> f64 {
        b.direction.dot(&a.direction)
    }

    fn scale(&self, at: &DirectedPoint) -> f64 {
        at.here.site.shooting.extent().min(1.0)
    }

    /// Often a node's plane lies badly: nodes elsewhere may do.
    fn failed(&mut self, here: &DirectedPoint, again: bool) -> Result<Option<DirectedPoint>, Stop> {
        if let Some(steps) = self.corrector.tracer.used_up() {
            return Err(Stop::Failed(format!(
                "the limit of {steps} steps of the integrator was reached"
            )));
        }
        if again {
            return Ok(None);
        }
        self.cut(here).map(Some).ok_or_else(no_nodes)
    }

    /// With the orbit's arcs cut anew where they have become uneven.
    fn taken(&mut self, to: &DirectedPoint) -> Result<Option<DirectedPoint>, Stop> {
        self.settings.take_pair(&to.here);
        if !self.is_uneven(&to.here) {
            return Ok(None);
        }
        self.cut(to).map(Some).ok_or_else(no_nodes)
    }

    fn checked(&self, watch: WatchedFunction) -> Result<()> {
        match watch {
            WatchedFunction::TestFunction(test_function) => {
                test_function.checked(self.corrector.family.dimension())
            }
            _ => Ok(()),
        }
    }

    fn value(&self, at: &DirectedPoint, watch: WatchedFunction) -> f64 {
        match watch {
            WatchedFunction::Turn(i) => at.direction.parameters[i],
            WatchedFunction::Value(i, value) => at.here.site.at[i] - value,
            WatchedFunction::UserFunction(which) => {
                of_orbit_beyond_noise(self.corrector.family, which, &at.here.site)
            }
            WatchedFunction::TestFunction(test_function) => {
                let at = &at.here.spectrum;
                test_function.of(at) / test_function.size(at)
            }
        }
    }

    fn slopes(
        &mut self,
        at: &DirectedPoint,
        watches: &[WatchedFunction],
        _: f64,
    ) -> Vec<Option<f64>> {
        let mut watched = watches.iter();
        let by = watched
            .any(|w| matches!(w, WatchedFunction::TestFunction(_)))
            .then(|| self.corrector.slope(&at.here, &at.direction))
            .flatten();
        let spectrum = &at.here.spectrum;
        let slope = |watch: &WatchedFunction| match *watch {
            WatchedFunction::Turn(_) => None,
            WatchedFunction::Value(i, _) => Some(at.direction.parameters[i]),
            WatchedFunction::UserFunction(which) => {
                let family = self.corrector.family;
                let slope = user_function::slope(family, which, &at.here.site, &at.direction);
                Some(slope)
            }
            WatchedFunction::TestFunction(test_function) => {
                let change = test_function.change_along(spectrum, by.as_ref()?);
                Some(change / test_function.size(spectrum))
            }
        };
        watches.iter().map(slope).collect()
    }

    fn is_costly(&self, watch: WatchedFunction) -> bool {
        matches!(
            watch,
            WatchedFunction::TestFunction(_) | WatchedFunction::UserFunction(_)
        )
    }

    fn is_straight(&self, step: &CurveStep<DirectedPoint>) -> bool {
        let goes_on =
            |&i: &usize| step.from.direction.parameters[i] * step.to.direction.parameters[i] > 0.0;
        self.cosine(&step.from, &step.to) > STRAIGHT && self.settings.free.iter().all(goes_on)
    }

    /// Along a curve of bifurcations a turn has no condition of its own.
    fn solves(&self, watch: WatchedFunction) -> bool {
        !matches!(watch, WatchedFunction::Turn(_)) || self.settings.condition.is_none()
    }

    fn solve(
        &mut self,
        from: &DirectedPoint,
        near: &DirectedPoint,
        watch: WatchedFunction,
    ) -> Option<(f64, DirectedPoint)> {
        let meaning = self.settings.meaning(watch, &near.here)?;
        let conditions = self.settings.and(meaning.condition());
        let site = near.here.site.clone();
        let found = self.corrected(&near.here, site, &conditions);
        let here = found.ok()?;
        let direction = self.settings.direction(&here, &near.direction);
        let direction = direction.unwrap_or_else(|| near.direction.clone());
        let distance = self.distance(from, &here.site);
        Some((distance, DirectedPoint { here, direction }))
    }

    fn is_clear(&self, (watch, values): (WatchedFunction, [f64; 2])) -> bool {
        matches!(watch, WatchedFunction::TestFunction(_))
            && values.iter().all(|value| value.abs() > CLEAR)
    }

    fn error(&self, at: &DirectedPoint) -> f64 {
        at.here.residual
    }

    fn flat(&self) -> f64 {
        FLAT
    }

    /// Of a curve of bifurcations K alone is watched for turns, and each is looked at by who is told.
    fn certain(
        &mut self,
        change: (WatchedFunction, [f64; 2]),
        at: &DirectedPoint,
        step: &CurveStep<DirectedPoint>,
    ) -> bool {
        if let (watch @ WatchedFunction::UserFunction(_), _) = change {
            return changes_sign(self, watch, at, step.length);
        }
        self.settings.condition.is_some() || certain(self, change, &at.here, step)
    }
}

impl OrbitCurve<'_, '_> {
    /// The orbit near a guess that meets the conditions.
    pub(super) fn corrected(
        &mut self,
        nearby: &Regular,
        guess: ContinuationPoint,
        conditions: &[Condition<'_>],
    ) -> Result<Regular> {
        let free = &self.settings.free;
        self.corrector
            .correct_beside(nearby, guess, free, conditions, Goal::STEP)
    }
}

impl OrbitCurve<'_, '_> {
    /// How far an orbit is in the direction of a point, as [`SolutionCurve::correct`] measures it: without what nodes are moved along the flow.
    pub(super) fn distance(&self, from: &DirectedPoint, to: &ContinuationPoint) -> f64 {
        let DirectedPoint { here, direction } = from;
        let way = self.corrector.in_planes(here, &to.from(&here.site));
        direction.dot(&way)
    }
}

pub(super) fn product(a: &[f64], b: &[f64]) -> f64 {
    a.iter().zip(b).map(|(a, b)| a * b).sum()
}

/// Where the continuation begins the curve has no direction.
fn no_direction() -> Error {
    not_near("the direction of the curve")
}

pub(super) fn not_near(what: &'static str) -> Error {
    Error::NotConverged {
        what,
        iterations: 0,
        residual: f64::INFINITY,
        tolerance: Goal::STEP.done,
    }
}
