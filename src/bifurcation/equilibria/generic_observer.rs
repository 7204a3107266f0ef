//! What is watched along a branch of equilibria: folds, branch points and Hopf points, multiple branch points ahead, and the ends of the box.

use super::bialternate::{lyapunov, rounding_of};
use super::critical::{is_large, least_of, sum_function};
use super::generic::{FieldEquilibria, FoundEquilibrium, Watch};
use super::generic_crossing::{BranchPoint, branch_point};
use super::generic_curve_problem::sign;
use super::multiple::MultiplePoint;
use super::unexplained::{crossings, unstable};
use crate::bifurcation::Label;
use crate::continuation::{CurveObserver, CurvePoint, PointKind};
use crate::error::Result;
use crate::field::Vector;
use crate::number::singular_values;
use std::f64::consts::TAU;
use std::ops::ControlFlow;

/// Zero where nothing but rounding is left: of a function that is zero throughout, as the sums of eigenvalues of a conservative
/// system or the slope of a branch at one parameter, rounding has signs that mean nothing.
fn certain(x: f64, rounding: f64) -> f64 {
    if x.abs() < rounding { 0.0 } else { x }
}

/// The test functions' order.
const LABELS: [Label; 3] = [Label::Lp, Label::Bp, Label::Hb];

/// What is watched along a branch, and what is known of its last points.
pub(super) struct EquilibriumObserver<'a, 'b> {
    family: &'a FieldEquilibria<'b>,
    watch: Watch<'a>,
    /// Whether a step has come onto another branch.
    pub jumped: bool,
    /// The longest step.
    longest: f64,
    /// The largest norm of the Jacobian so far.
    norm: f64,
    /// Of each equation the largest norm of its derivatives in state and parameter so far.
    longest_rows: Vector,
    /// A multiple branch point to which the branch leads, and whether it turns back there.
    ahead: Option<(MultiplePoint, bool)>,
    /// [`slope`] at the last point.
    slope: f64,
    /// [`EquilibriumObserver::falling`] at the last point, and how long the branch was there.
    fallen: Option<(f64, f64)>,
    /// The last branch point, in (state, parameter).
    branch_point: Option<Vector>,
    /// The last point whose unstable eigenvalues are certain, and their number; none behind a point that changes it.
    last: Option<(usize, FoundEquilibrium)>,
    seen: &'a mut dyn FnMut(&FoundEquilibrium) -> ControlFlow<()>,
}

impl<'a, 'b> EquilibriumObserver<'a, 'b> {
    /// Along a branch with steps up to this length, with the zeros of functions on the way.
    pub fn new(
        family: &'a FieldEquilibria<'b>,
        watch: Watch<'a>,
        longest: f64,
        seen: &'a mut dyn FnMut(&FoundEquilibrium) -> ControlFlow<()>,
    ) -> Self {
        EquilibriumObserver {
            family,
            watch,
            jumped: false,
            longest,
            norm: 0.0,
            longest_rows: Vector::zeros(0),
            ahead: None,
            slope: f64::INFINITY,
            fallen: None,
            branch_point: None,
            last: None,
            seen,
        }
    }
}

impl EquilibriumObserver<'_, '_> {
    /// Whether the derivatives in state and parameter together lose a rank: at a branch point.
    fn crosses(&self, y: &Vector, p: f64) -> bool {
        /// Of its length elsewhere on the branch, what is left of a row that is zero.
        const VANISHED: f64 = 1e-8;
        /// What is left of a singular value that is zero, of rows of length 1.
        const ZERO: f64 = 1e-5;
        let mut rows = self.family.extended(y, p);
        for (i, mut row) in rows.row_iter_mut().enumerate() {
            let longest = self.longest_rows.get(i).copied().unwrap_or(0.0);
            let length = row.norm();
            if length > VANISHED * longest {
                row /= length;
            } else if longest > 0.0 {
                row /= longest;
            }
        }
        singular_values(rows, [false, false]).is_some_and(|of| of.singular_values.min() < ZERO)
    }

    /// The product of all sums of two eigenvalues, or what is zero with it.
    fn sums(&self, y: &Vector, p: f64) -> f64 {
        /// Units in the last place that are rounding, of the entries and of the state: what a sum of entries cancels the entries' own rounding does
        /// not show.
        const UNITS: f64 = 32.0;
        const TRIED: usize = 3;
        /// Of many variables: what rounding can't make of zero.
        const CERTAIN: f64 = 1e-3;
        let jacobian = self.family.jacobian(y, p);
        let here = sum_function(&jacobian);
        if is_large(y.len()) && here.abs() > CERTAIN {
            return here;
        }
        let moved = (0..TRIED).map(|time| {
            let off = |i: usize| 1.0 + sign(i, time) * UNITS * f64::EPSILON;
            let beside = Vector::from_fn(y.len(), |i, _| y[i] * off(i));
            (sum_function(&self.family.jacobian(&beside, p)) - here).abs()
        });
        let of_state = moved.fold(0.0, f64::max);
        certain(here, rounding_of(&jacobian, UNITS, sum_function) + of_state)
    }

    /// Whether the parameter is on one side of its value here, before and behind: where a branch bends but goes on, its slope is zero too. True where
    /// nothing can be told.
    fn turns(&self, point: &CurvePoint) -> bool {
        /// Of the longest step: two folds may be near each other.
        const ASIDE: [f64; 3] = [0.1, 0.01, 0.001];
        const ROUNDING: f64 = 64.0 * f64::EPSILON;
        let least = ROUNDING * (1.0 + point.lambda.abs());
        let mut told = false;
        for aside in ASIDE {
            let distance = aside * self.longest;
            let sides = [-distance, distance].map(|s| self.beside(point, s));
            let [Some(before), Some(behind)] = sides else {
                continue;
            };
            let [a, b] = [before, behind].map(|p| p - point.lambda);
            if a.abs() > least && b.abs() > least {
                if a * b > 0.0 {
                    return true;
                }
                told = true;
            }
        }
        !told
    }

    /// The parameter at this distance along the tangent.
    fn beside(&self, point: &CurvePoint, distance: f64) -> Option<f64> {
        const ITERATIONS: usize = 8;
        let here = point.u.push(point.lambda);
        let n = point.u.len();
        let mut x = &here + &point.tangent * distance;
        let mut last = f64::INFINITY;
        for _ in 0..ITERATIONS {
            let (y, p) = (x.rows(0, n).into_owned(), x[n]);
            let off = distance - point.tangent.dot(&(&x - &here));
            let right = (-self.family.field(p).f(&y)).push(off);
            let matrix = self.family.bordered(&y, p, &point.tangent);
            let step = matrix.lu().solve(&right)?;
            x += &step;
            last = step.amax();
        }
        (last < f64::EPSILON.sqrt() * distance.abs()).then_some(x[n])
    }

    /// Its sign changes at branch points, and where a step has come onto another branch.
    fn side(&self, point: &CurvePoint) -> f64 {
        let square = self.family.bordered(&point.u, point.lambda, &point.tangent);
        match is_large(point.u.len()) {
            false => square.determinant(),
            true => least_of(&square),
        }
    }

    /// What falls to zero at a multiple branch point, and the size below which singular values of the Jacobian may vanish there: of many variables the second
    /// least singular value, as their determinant falls by half and more on any step.
    fn falling(&self, point: &CurvePoint) -> (f64, f64) {
        /// Near the point a singular value that vanishes there is smaller than this part of the Jacobian's norm elsewhere on the branch; or than so many times
        /// another one that does.
        const SMALL: f64 = 0.3;
        const ALIKE: f64 = 3.0;
        if !is_large(point.u.len()) {
            return (self.side(point), SMALL * self.norm);
        }
        let rows = self.family.extended(&point.u, point.lambda);
        let values = singular_values(rows, [false, false]).map(|of| of.singular_values);
        let mut values: Vec<f64> = values.iter().flatten().copied().collect();
        values.sort_by(f64::total_cmp);
        let second = values.get(1).copied().unwrap_or(f64::NAN);
        (second, ALIKE * second)
    }

    /// Whether so far ahead along the tangent two singular values are much less than the second least one is here, as they are near a multiple branch
    /// point: to look for one takes long where there are many variables.
    fn several_vanish(&self, point: &CurvePoint, ahead: f64, second: f64) -> bool {
        const FALLEN: f64 = 0.5;
        let n = point.u.len();
        let there = point.u.push(point.lambda) + &point.tangent * ahead;
        let rows = self
            .family
            .extended(&there.rows(0, n).into_owned(), there[n]);
        let values = singular_values(rows, [false, false]).map(|of| of.singular_values);
        let fallen = values
            .iter()
            .flatten()
            .filter(|value| **value < FALLEN * second);
        fallen.count() > 1
    }

    /// A multiple branch point that the branch comes to straight from here, and whether it turns back there: the parameter then depends on the way to it
    /// by an even power. [`EquilibriumObserver::falling`], which may keep its sign there, has fallen since the point before.
    fn look_ahead(&mut self, point: &CurvePoint) -> Option<(MultiplePoint, bool)> {
        /// In longest steps.
        const AHEAD: f64 = 2.0;
        /// The cosine of a direction that leads there.
        const STRAIGHT: f64 = 0.9;
        let n = point.u.len();
        let ((value, small), here) = (self.falling(point), point.arclength);
        let (before, from) = self.fallen.replace((value, here))?;
        let left = value * (here - from) / (before - value);
        if !(left >= 0.0 && left < AHEAD * self.longest) {
            return None;
        }
        if is_large(n) && !self.several_vanish(point, left, value) {
            return None;
        }
        let found = MultiplePoint::near(self.family, &point.u, point.lambda, small)?;
        let way = found.place() - point.u.push(point.lambda);
        let (distance, along) = (way.norm(), point.tangent.dot(&way));
        if distance > AHEAD * self.longest || along < STRAIGHT * distance {
            return None;
        }
        let power = (point.lambda_slope() * distance / way[n]).round();
        Some((found, power % 2.0 == 0.0))
    }

    /// How far each variable is inside its lower bound and its upper one, in parts of their distance; on these but for rounding 0.
    fn inside(&self, state: &Vector) -> Vec<f64> {
        /// What rounding and corrections make of a branch that lies in the boundary.
        const ON_BOUND: f64 = 1e-10;
        let bounds = self.family.bounds.iter().zip(state);
        let inside = bounds.flat_map(|(&(low, high), &x)| {
            [x - low, high - x].map(|inside| certain(inside / (high - low), ON_BOUND))
        });
        inside.collect()
    }

    /// Whether the branch point before was this one, in (state, parameter).
    fn was_at(&self, place: &Vector) -> bool {
        self.branch_point
            .as_ref()
            .is_some_and(|last| same(last, place))
    }

    /// The number of the user's function that a test function is.
    fn users(&self, test: usize) -> Option<usize> {
        let which = test.checked_sub(LABELS.len())?;
        (which < self.watch.count).then_some(which)
    }

    /// How many test functions there are before those of the bounds of the variables.
    fn before_bounds(&self) -> usize {
        LABELS.len() + self.watch.count
    }

    /// What is known of a point.
    fn found(
        &self,
        (state, parameter): (&Vector, f64),
        tangent: &Vector,
    ) -> Option<FoundEquilibrium> {
        // Without eigenvalues nothing is known of its stability.
        let eigenvalues = self.family.eigenvalues(state, parameter)?;
        Some(FoundEquilibrium {
            state: state.clone(),
            parameter,
            uncertainty: None,
            crossing: None,
            eigenvalues,
            label: None,
            together: 0,
            multiple: None,
            zero_of: None,
            leaves: None,
            period: None,
            coefficient: None,
            tangent: tangent.clone(),
        })
    }

    /// Reports a branch point.
    fn report_crossing(&mut self, point: &CurvePoint, crossing: Crossing) -> ControlFlow<()> {
        let (state, parameter) = match &crossing {
            Crossing::Simple(sharp) => (&sharp.state, sharp.parameter),
            Crossing::Multiple(sharp) => (&sharp.state, sharp.parameter),
        };
        self.branch_point = Some(state.push(parameter));
        let Some(rough) = self.found((state, parameter), &point.tangent) else {
            return ControlFlow::Continue(());
        };
        let found = match crossing {
            Crossing::Simple(sharp) => FoundEquilibrium {
                label: Some(Label::Bp),
                uncertainty: Some(sharp.uncertainty),
                crossing: Some(sharp.crossing),
                ..rough
            },
            Crossing::Multiple(sharp) => FoundEquilibrium {
                label: Some(Label::Bp),
                uncertainty: Some(sharp.uncertainty),
                together: sharp.multiplicity(),
                multiple: Some(sharp),
                ..rough
            },
        };
        self.compare(&found)?;
        (self.seen)(&found)
    }

    /// Reports the multiple branch point ahead if it is passed, and ends the branch if it turns back there.
    fn pass_multiple(&mut self, point: &CurvePoint) -> ControlFlow<()> {
        let here = point.u.push(point.lambda);
        let passed = |(ahead, _): &mut (MultiplePoint, bool)| {
            point.tangent.dot(&(ahead.place() - &here)) <= 0.0
        };
        match self.ahead.take_if(passed) {
            Some((ahead, turns)) => self.report_multiple(point, ahead, turns),
            None => ControlFlow::Continue(()),
        }
    }

    /// Reports a multiple branch point. A branch that turns back there ends: all that begin there are followed on their own.
    fn report_multiple(
        &mut self,
        point: &CurvePoint,
        ahead: MultiplePoint,
        turns: bool,
    ) -> ControlFlow<()> {
        self.report_crossing(point, Crossing::Multiple(ahead))?;
        if turns {
            ControlFlow::Break(())
        } else {
            ControlFlow::Continue(())
        }
    }

    /// Looks for a multiple branch point ahead, and ends a branch that is sure to turn back there.
    fn look_for_multiple(&mut self, point: &CurvePoint) -> ControlFlow<()> {
        let here = point.u.push(point.lambda);
        let norm = self.family.jacobian(&point.u, point.lambda).norm();
        self.norm = self.norm.max(norm);
        let rows = self.family.extended(&point.u, point.lambda);
        let longest = |i: usize| self.longest_rows.get(i).copied().unwrap_or(0.0);
        let longest = Vector::from_fn(rows.nrows(), |i, _| rows.row(i).norm().max(longest(i)));
        self.longest_rows = longest;
        self.ahead = self.look_ahead(point);
        let longest = self.longest;
        let comes = |(ahead, turns): &mut (MultiplePoint, bool)| {
            *turns && (ahead.place() - &here).norm() < longest
        };
        match self.ahead.take_if(comes) {
            Some((ahead, turns)) => self.report_multiple(point, ahead, turns),
            None => ControlFlow::Continue(()),
        }
    }

    /// Whether a sign changes because of the multiple branch point ahead.
    fn is_ahead(&self, point: &CurvePoint) -> bool {
        /// Of the longest step.
        const NEAR: f64 = 0.01;
        let here = point.u.push(point.lambda);
        let near = |(ahead, _): &(MultiplePoint, bool)| {
            (ahead.place() - &here).norm() < NEAR * self.longest
        };
        self.ahead.as_ref().is_some_and(near)
    }
}

/// How fast the parameter changes along the branch, relative to the state.
fn slope(point: &CurvePoint) -> f64 {
    point.lambda_slope() * (1.0 + point.u.norm())
}

/// Whether two points of (state, parameter) are one.
fn same(a: &Vector, b: &Vector) -> bool {
    /// In units of 1 + |x|: what landing on a zero leaves.
    const SAME: f64 = 1e-8;
    (a - b).amax() <= SAME * (1.0 + a.amax())
}

/// A branch point.
enum Crossing {
    Simple(BranchPoint),
    Multiple(MultiplePoint),
}

impl EquilibriumObserver<'_, '_> {
    /// Compares the number of unstable eigenvalues with that of the point before, and reports what crosses between them without a test function that
    /// says so.
    fn compare(&mut self, found: &FoundEquilibrium) -> ControlFlow<()> {
        let explains = matches!(found.label, Some(Label::Lp | Label::Bp | Label::Hb));
        if explains {
            self.last = None;
            return ControlFlow::Continue(());
        }
        let Some(count) = unstable(&found.eigenvalues) else {
            return ControlFlow::Continue(());
        };
        let last = self.last.replace((count, found.clone()));
        let Some((_, from)) = last.filter(|(before, _)| *before != count) else {
            return ControlFlow::Continue(());
        };
        for crossing in crossings(self.family, &from, found) {
            (self.seen)(&crossing)?;
        }
        ControlFlow::Continue(())
    }
}

impl CurveObserver for EquilibriumObserver<'_, '_> {
    fn tests(&self, point: &CurvePoint) -> Result<Vec<f64>> {
        let (y, p) = (&point.u, point.lambda);
        /// Below this a component of the unit tangent is rounding: that of the difference in p.
        const SLOPE: f64 = 1e-12;
        let mut tests = vec![
            certain(slope(point), SLOPE),
            self.side(point),
            self.sums(y, p),
        ];
        tests.extend((0..self.watch.count).map(|which| self.watch.value(which, y, p)));
        tests.extend(self.inside(y));
        Ok(tests)
    }

    fn is_users(&self, test: usize) -> bool {
        self.users(test).is_some()
    }

    fn ends(&self, test: usize) -> bool {
        test >= self.before_bounds()
    }

    fn finest(&self) -> f64 {
        1e-5
    }

    /// Short steps tell a branch that crosses from one that comes near.
    fn too_far(&self, from: &CurvePoint, to: &CurvePoint) -> bool {
        self.side(from) * self.side(to) < 0.0
    }

    fn seen(&mut self, point: &CurvePoint, mark: PointKind) -> ControlFlow<()> {
        let (y, p) = (&point.u, point.lambda);
        /// Relative to the state; of the point before.
        const FLAT: f64 = 1e-9;
        let mut landed = None;
        if mark == PointKind::Step {
            self.slope = slope(point).abs();
        }
        if !matches!(mark, PointKind::Zero(_)) {
            self.pass_multiple(point)?;
        }
        match mark {
            // Where another branch crosses, a turn of this one is no fold; nor is a slope that falls to its rounding, as on the way to infinity.
            PointKind::Zero(0) if self.crosses(y, p) || self.slope < FLAT || !self.turns(point) => {
                return ControlFlow::Continue(());
            }
            PointKind::Zero(1) if self.is_ahead(point) => return ControlFlow::Continue(()),
            PointKind::Zero(1) => {
                return match branch_point(self.family, y, p) {
                    Some(sharp) => self.report_crossing(point, Crossing::Simple(sharp)),
                    None => {
                        self.jumped = true;
                        ControlFlow::Break(())
                    }
                };
            }
            // It begins in the boundary of the box, and leaves it there.
            PointKind::Step if self.inside(y).iter().any(|inside| *inside < 0.0) => {
                return ControlFlow::Break(());
            }
            PointKind::Begin | PointKind::Step => self.look_for_multiple(point)?,
            PointKind::Zero(i) if self.ends(i) => {
                // In the boundary, where it may come after the end.
                let sharp = branch_point(self.family, y, p);
                let here = y.push(p);
                let sharp = sharp.filter(|sharp| same(&sharp.state.push(sharp.parameter), &here));
                if let Some(sharp) = &sharp
                    && !self.was_at(&sharp.state.push(sharp.parameter))
                {
                    self.report_crossing(point, Crossing::Simple(sharp.clone()))?;
                }
                landed = sharp.map(|sharp| (sharp.state, sharp.parameter, sharp.uncertainty));
            }
            _ => {}
        }
        let label = match mark {
            PointKind::Step => None,
            PointKind::Zero(i) if self.is_users(i) => Some(Label::Uf),
            PointKind::Zero(i) => Some(LABELS.get(i).copied().unwrap_or(Label::Ep)),
            PointKind::Wanted(_) => Some(Label::Uz),
            PointKind::Begin | PointKind::Lowest | PointKind::Highest => Some(Label::Ep),
        };
        let Some(found) = self.found((y, p), &point.tangent) else {
            return ControlFlow::Continue(());
        };
        let mut found = FoundEquilibrium { label, ..found };
        if let PointKind::Zero(i) = mark
            && let Some(bound) = i.checked_sub(self.before_bounds())
        {
            let (variable, upper) = (bound / 2, bound % 2 == 1);
            found.leaves = Some((variable, upper));
            let (low, high) = self.family.bounds[variable];
            found.state[variable] = if upper { high } else { low };
            let landed = landed.or_else(|| self.family.landed((&found.state, p), variable));
            if let Some((state, parameter, off)) = landed {
                (found.state, found.parameter) = (state, parameter);
                found.uncertainty = Some(off);
            }
        }
        if let PointKind::Zero(i) = mark
            && let Some(which) = self.users(i)
        {
            let sharp = self.family.zero_of((&self.watch, which), (y, p));
            found.zero_of = Some(which);
            found.uncertainty = Some(f64::INFINITY);
            let here = y.push(p);
            if let Some((state, parameter, off)) = sharp
                && same(&state.push(parameter), &here)
            {
                (found.state, found.parameter) = (state, parameter);
                found.uncertainty = Some(off);
            }
        }
        if label == Some(Label::Hb) {
            let Some(omega) = self.family.frequency(y, p) else {
                return ControlFlow::Continue(());
            };
            found.period = Some(TAU / omega);
            found.coefficient = lyapunov(&self.family.field(p), y, omega);
        }
        self.compare(&found)?;
        (self.seen)(&found)
    }
}
