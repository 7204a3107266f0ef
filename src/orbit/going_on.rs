//! Whether a step along a branch of orbits has come to the next orbit: Newton's method may find one on another sheet of the branch, or on the way
//! back. Both have been seen behind the sharp turns of canards and where a branch winds (Hindmarsh and Rose's model).

use super::conditions::Condition;
use super::continuation_point::{ContinuationPoint, TangentVector};
use super::correct::Regular;
use super::goal::Goal;
use super::orbit_curve::{DirectedPoint, OrbitCurve, not_near};
use super::test_function::TestFunction;
use crate::error::Result;

/// What a first correction may be.
const FAR_OFF: f64 = 0.15;
/// From where on the period is looked at half way too: what it is off its prediction by, in parts of its predicted change and of itself. And
/// what it may be off there from a smooth change, in parts of what a jump would make.
const AHEAD: f64 = 0.3;
const LATE: f64 = 0.005;
const OFF_SMOOTH: f64 = 0.6;
/// A slope of the parameter along a branch that is rounding.
const FLAT_OUT: f64 = 1e-7;
/// How near to the begin of a step the way back from its end comes, in parts of the step. Nodes that are moved far along the flow are off by some hundredths; on
/// another branch the way back ends a step and more away.
const SAME_BRANCH: f64 = 0.3;
/// Newton's method for that: mostly one iteration.
const LOOK: Goal = Goal {
    done: 0.1,
    iterations: 8,
    largest: 1.0,
};
/// Orbits of fewer variables, but of forced systems, are no pitchforks: of two in the plane that are mirror images neither would lie within the other.
const LEAST_VARIABLES: usize = 3;

impl OrbitCurve<'_, '_> {
    /// Whether a step of a branch has come to the next orbit, and not to another that Newton's method has found.
    pub(super) fn goes_on(
        &mut self,
        from: &DirectedPoint,
        distance: f64,
        (predicted, next): (&ContinuationPoint, &Regular),
    ) -> Result<()> {
        let DirectedPoint { here, direction } = from;
        let [period, to] = [here, next].map(|orbit| orbit.site.shooting.period());
        if next.first > FAR_OFF {
            return Err(not_near("a step whose end is near the predicted one"));
        }
        // Another sheet of a branch that winds may be near by everything but its period.
        let expected = predicted.shooting.period();
        let (change, late) = (expected - period, to - expected);
        let slope = direction.parameters[self.settings.free[0]].abs();
        if slope > FLAT_OUT && late.abs() > AHEAD * change.abs() + LATE * period.abs() {
            let middle = self.orbit_at(here, direction, 0.5 * distance)?;
            let middle = middle.site.shooting.period();
            let smooth = period + 0.5 * change + 0.25 * late;
            if (middle - smooth).abs() > OFF_SMOOTH * 0.25 * late.abs() {
                return Err(not_near("a step along which the period changes smoothly"));
            }
        }
        Ok(())
    }

    /// Whether branches of a system whose symmetry is not known may cross at a pitchfork beside these orbits.
    fn may_be_pitchfork(&self, ends: [&DirectedPoint; 2]) -> bool {
        let family = self.corrector.family;
        let is_forced = || family.field(ends[0].here.site.at).phase().is_some();
        family.is_any_system()
            && ends.iter().all(|at| at.here.branches_nearby())
            && (family.dimension() >= LEAST_VARIABLES || is_forced())
    }

    /// Whether a step back from the end of a step of a branch comes to where it began. Next to a crossing a step from one branch may come to the other, which
    /// is as near to the prediction where it is long.
    pub(super) fn comes_back(&mut self, from: &DirectedPoint, to: &DirectedPoint) -> bool {
        if self.settings.condition.is_some() || !self.may_be_pitchfork([from, to]) {
            return true;
        }
        let DirectedPoint { here, direction } = to;
        // The plane across the direction in which the step began.
        let way = self.distance(to, &from.here.site);
        let predicted = here.site.moved(direction, way);
        let conditions = self.settings.and(Condition::Plane(direction, &predicted));
        let free = &self.settings.free;
        let back = self
            .corrector
            .correct_beside(here, predicted.clone(), free, &conditions, LOOK);
        let Ok(back) = back else {
            return true;
        };
        let off = back.site.from(&from.here.site);
        let off = self.corrector.in_planes(&from.here, &off);
        off.dot(&off).sqrt() < SAME_BRANCH * way.abs()
    }

    /// Whether a step of a branch goes on in the same sense. The parameter's change along it times 1 - mu of all multipliers changes its sign at
    /// branch points alone, by a multiplier that passes 1 (Keller 1977); but it does not where orbits that are no mirror images of themselves come to their
    /// pitchfork. Behind a sharp turn that a step has jumped across, and behind the Hopf point at its end, a branch would be followed back.
    pub(super) fn keeps_its_sense(&mut self, from: &DirectedPoint, to: &DirectedPoint) -> bool {
        /// Of the test function: next to a Hopf point its sign is rounding.
        const SMALL: f64 = 1e-6;
        let (None, &[free]) = (self.settings.condition, &self.settings.free[..]) else {
            return true;
        };
        let [a, b] = [from, to].map(|at| {
            let slope = at.direction.parameters[free];
            let spectrum = &at.here.spectrum;
            let fold = TestFunction::Fold;
            (slope, fold.of(spectrum) / fold.size(spectrum))
        });
        let [slope, fold] = [(a.0, b.0), (a.1, b.1)].map(|(a, b)| a.abs().min(b.abs()));
        let known = slope > FLAT_OUT && fold > SMALL;
        let turns = a.0 * b.0 < 0.0;
        let passes = a.1 * b.1 < 0.0;
        !known
            || turns == passes
            || (!turns && [from, to].iter().all(|at| at.here.branches_nearby()))
            || (turns && self.may_be_pitchfork([from, to]) && self.own_image(from, to).is_some())
    }

    /// Of a step on which the parameter turns: an orbit about where it does, and one half way between two orbits of one parameter to both sides. There is one,
    /// which is its own image, where these are mirror images of each other, or the same orbit half a period later; not between both sides of a fold.
    pub(crate) fn own_image(
        &mut self,
        from: &DirectedPoint,
        to: &DirectedPoint,
    ) -> Option<(Regular, Regular)> {
        /// How often the two are taken nearer to each other; and how near to half way the orbit between them is, in parts of the way.
        const HALVINGS: usize = 6;
        const HALF_WAY: f64 = 0.1;
        let free = *self.settings.free.first()?;
        let DirectedPoint { here, direction } = from;
        let slopes = [from, to].map(|one| one.direction.parameters[free]);
        let way = self.distance(from, &to.here.site);
        let turn = way * slopes[0] / (slopes[0] - slopes[1]);
        let near = self.orbit_at(here, direction, turn).ok()?;
        let mut reach = 0.5 * way;
        for _ in 0..HALVINGS {
            let sides = [turn - reach, turn + reach].map(|way| self.orbit_at(here, direction, way));
            reach *= 0.5;
            let [Ok(one), Ok(other)] = sides else {
                continue;
            };
            let held = [Condition::Parameter(free, one.site.at[free])];
            let Ok(other) = self.corrected(here, other.site, &held) else {
                continue;
            };
            let apart = other.site.from(&one.site);
            let middle = one.site.moved(&apart, 0.5);
            let Ok(found) = self.corrected(here, middle, &held) else {
                continue;
            };
            let part = found.site.from(&one.site).dot(&apart) / apart.dot(&apart);
            if (part - 0.5).abs() < HALF_WAY {
                return Some((near, found));
            }
        }
        None
    }

    /// The orbit at a distance into a direction.
    fn orbit_at(
        &mut self,
        here: &Regular,
        direction: &TangentVector,
        distance: f64,
    ) -> Result<Regular> {
        let predicted = here.site.moved(direction, distance);
        let conditions = self.settings.and(Condition::Plane(direction, &predicted));
        self.corrected(here, predicted.clone(), &conditions)
    }
}
