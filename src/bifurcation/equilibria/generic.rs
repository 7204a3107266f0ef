//! Equilibria of any small system with a parameter: f(y; p) = 0 followed in p, with folds, branch points and Hopf points.
//!
//! A family of fields is a function of one parameter. Test functions: the tangent's component along p (fold); the determinant
//! of the extended Jacobian over the tangent (branch point); the determinant of the bialternate product 2 J (.) 1, the product of
//! all sums of two eigenvalues (Hopf; Kuznetsov 2004, section 10.2.2). The derivative in p is that of the field, or where
//! the field has no parameter of this name a difference of fourth order, with some 11 digits of special points; third derivatives,
//! for the first Lyapunov coefficient, are differences too.
//!
//! Where symmetry makes several eigenvalues vanish together, that is found ahead, and the branches that begin there (`multiple`).

use super::bialternate::{bialternate, lyapunov, rounding_of};
use super::generic_crossing::{BranchCrossing, BranchPoint, branch_point};
use super::multiple::MultiplePoint;
use super::unexplained::{crossings, unstable};
use crate::bifurcation::Label;
use crate::continuation::{
    Branch, CurveObserver, CurvePoint, PointKind, Settings, Start, Stop, ZeroProblem, follow,
};
use crate::error::{Error, Result};
use crate::field::{Matrix, Vector, place};
use crate::integrate::{AnyExact, AnyField, of_dimension};
use crate::number::{self, null_vector, singular_values};
use nalgebra::Complex;
use std::f64::consts::TAU;
use std::ops::ControlFlow;

/// The field at a value of the parameter.
pub type Fields<'a> = &'a dyn Fn(f64) -> AnyField<'a>;

/// The equilibria of a family of fields along one parameter.
#[derive(Clone, Copy)]
pub struct FieldEquilibria<'a> {
    /// The fields.
    pub fields: Fields<'a>,
    /// The parameter's name, by which the fields know its derivatives.
    pub along: &'a str,
    /// The derivative of the parameter in what the fields are a function of, where that is another coordinate of it.
    pub scale: Option<&'a dyn Fn(f64) -> f64>,
    /// The range of each variable, at whose ends branches end; empty where nothing bounds them.
    pub bounds: &'a [(f64, f64)],
}

impl std::fmt::Debug for FieldEquilibria<'_> {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        f.debug_struct("Family")
            .field("along", &self.along)
            .finish_non_exhaustive()
    }
}

/// A point of a branch of equilibria.
#[derive(Debug, Clone, PartialEq)]
#[non_exhaustive]
pub struct FoundEquilibrium {
    /// The state.
    pub state: Vector,
    /// The varied parameter.
    pub parameter: f64,
    /// It may be off by this; known of branch points.
    pub uncertainty: Option<f64>,
    /// How branches cross at a branch point.
    pub crossing: Option<BranchCrossing>,
    /// By real part, the largest first.
    pub eigenvalues: Vec<Complex<f64>>,
    /// `LP`, `BP`, `HB`, `UZ`, `EP`, where the point is one of these.
    pub label: Option<Label>,
    /// Of eigenvalues that cross the imaginary axis together, more than one or one pair, how many there are; else 0.
    pub together: usize,
    /// Where several eigenvalues are 0, that point as far as branches that begin there need it.
    pub multiple: Option<MultiplePoint>,
    /// At a bound of a variable, where the branch leaves the box: which variable, and whether the bound is the upper one.
    pub leaves: Option<(usize, bool)>,
    /// Of the oscillation at a Hopf point.
    pub period: Option<f64>,
    /// The first Lyapunov coefficient of a Hopf point, with <q, q> = 1: positive where the small orbits are unstable.
    pub coefficient: Option<f64>,
    /// The unit tangent of the branch in (state, parameter).
    pub tangent: Vector,
}

/// Where a branch begins, and which way it goes.
#[derive(Debug, Clone, PartialEq)]
pub struct Onward {
    /// Nearly an equilibrium.
    pub state: Vector,
    /// The varied parameter there.
    pub parameter: f64,
    /// One longer than the state, in (state, parameter).
    pub direction: Vector,
    /// Whether the first point may have another parameter, and lies across the direction.
    pub across: bool,
}

impl Onward {
    /// With the parameter growing, or falling.
    pub fn along(state: Vector, parameter: f64, growing: bool) -> Self {
        let n = state.len();
        let mut direction = Vector::zeros(n + 1);
        direction[n] = if growing { 1.0 } else { -1.0 };
        Onward {
            state,
            parameter,
            direction,
            across: false,
        }
    }
}

/// Part of 1 + |p| by which the parameter is changed for a derivative.
const CHANGE: f64 = 1e-3;

impl<'a> FieldEquilibria<'a> {
    fn field(&self, parameter: f64) -> AnyField<'a> {
        (self.fields)(parameter)
    }

    /// df/dp.
    pub(super) fn in_parameter(&self, y: &Vector, p: f64) -> Vector {
        let here = self.field(p);
        if let Ok(place) = place(here.parameter_names(), self.along) {
            let scale = self.scale.map_or(1.0, |scale| scale(p));
            return here.parameter_derivative(y, place) * scale;
        }
        let h = CHANGE * (1.0 + p.abs());
        let f = |p: f64| self.field(p).f(y);
        ((f(p + h) - f(p - h)) * 8.0 - (f(p + 2.0 * h) - f(p - 2.0 * h))) / (12.0 * h)
    }

    fn jacobian(&self, y: &Vector, p: f64) -> Matrix {
        self.field(p).jacobian(y)
    }

    /// f and J, from 31 digits where the fields have these.
    pub(super) fn exact(&self, y: &Vector, p: f64) -> AnyExact {
        self.field(p).exact(y)
    }

    /// D2f along two directions.
    pub(super) fn second(&self, y: &Vector, p: f64, (u, v): (&Vector, &Vector)) -> Vector {
        self.field(p).second_derivative(y, u, v)
    }

    /// The equilibrium near a state; `None` where Newton's method does not find it.
    pub(in crate::bifurcation) fn corrected(&self, near: &Vector, p: f64) -> Option<Vector> {
        /// Iterations, and a correction that is the last, in units of 1 + |y|.
        const ITERATIONS: usize = 20;
        const DONE: f64 = 1e-13;
        let mut y = near.clone();
        for _ in 0..ITERATIONS {
            let step = self.jacobian(&y, p).lu().solve(&self.field(p).f(&y))?;
            let size = step
                .zip_map(&y, |d: f64, x: f64| (d / (1.0 + x.abs())).abs())
                .max();
            y -= step;
            if size < DONE {
                return Some(y);
            }
        }
        None
    }

    pub(super) fn eigenvalues(&self, y: &Vector, p: f64) -> Option<Vec<Complex<f64>>> {
        let mut all = number::eigenvalues(&self.jacobian(y, p))?;
        all.sort_by(|a, b| b.re.total_cmp(&a.re).then(b.im.total_cmp(&a.im)));
        Some(all)
    }

    /// omega of the pair whose real part is nearest to zero, if it is a pair: the test function vanishes for two real
    /// eigenvalues of opposite sign too.
    fn frequency(&self, y: &Vector, p: f64) -> Option<f64> {
        let all = self.eigenvalues(y, p)?;
        let pair = all.into_iter().filter(|z| z.im > 0.0);
        let nearest = pair.min_by(|a, b| a.re.abs().total_cmp(&b.re.abs()))?;
        (nearest.re.abs() < 1e-6 * nearest.im).then_some(nearest.im)
    }

    /// The equilibria from a start until the range ends.
    ///
    /// # Errors
    /// [`Error::Parameter`] for a start of another dimension than the fields'; those of [`follow`].
    pub fn follow(
        &self,
        onward: &Onward,
        settings: &Settings,
        seen: &mut dyn FnMut(&FoundEquilibrium) -> ControlFlow<()>,
    ) -> Result<Branch> {
        let dimension = self.field(onward.parameter).dimension();
        of_dimension(onward.state.len(), dimension)?;
        let start = Start {
            u: onward.state.clone(),
            lambda: onward.parameter,
            direction: onward.direction.clone(),
            across: onward.across,
        };
        let problem = Equations {
            family: self,
            dimension,
        };
        let mut look = EquilibriumObserver {
            family: self,
            jumped: false,
            last: None,
            longest: settings.longest_step,
            norm: 0.0,
            ahead: None,
            slope: f64::INFINITY,
            fallen: None,
            branch_point: None,
            seen,
        };
        let mut branch = follow(&problem, &start, settings, &mut look)?;
        if look.jumped {
            branch.stopped = Stop::Failed(
                "another branch comes so near that steps can't keep to this one".into(),
            );
        }
        Ok(branch)
    }

    /// The two ways that leave a branch point, on the branch that crosses the one it was found on.
    ///
    /// The first point lies at `distance`, which should be small: at right angles to the first branch the second one is met
    /// where it is a pitchfork, and nearly so elsewhere.
    ///
    /// # Errors
    /// [`Error::Parameter`] for a point of another dimension than the fields'; [`Error::NotConverged`] if the singular value
    /// decomposition fails.
    pub fn switch(&self, point: &FoundEquilibrium, distance: f64) -> Result<[Onward; 2]> {
        let (y, p) = (&point.state, point.parameter);
        let n = y.len();
        of_dimension(n, self.field(p).dimension())?;
        let matrix = self.bordered(y, p, &point.tangent);
        let Some(null) = null_vector(matrix) else {
            return Err(Error::NotConverged {
                what: "the direction of the second branch",
                iterations: 0,
                residual: f64::INFINITY,
                tolerance: 0.0,
            });
        };
        Ok([1.0, -1.0].map(|sign| {
            let direction: Vector = &null * sign;
            Onward {
                state: y + direction.rows(0, n) * distance,
                parameter: p + direction[n] * distance,
                direction,
                across: true,
            }
        }))
    }

    /// The equilibrium near another one at which this variable is the same, and the error bound of the parameter.
    fn landed(
        &self,
        (state, parameter): (&Vector, f64),
        held: usize,
    ) -> Option<(Vector, f64, f64)> {
        /// Corrections, which end in the last digits; so many changes in the last digits, and what their largest residual counts.
        const ITERATIONS: usize = 4;
        const TRIED: usize = 8;
        const SAFETY: f64 = 4.0;
        let n = state.len();
        let exact = |x: &Vector| self.exact(&x.rows(0, n).into_owned(), x[n]);
        let square = |x: &Vector| {
            let rows = self.extended(&x.rows(0, n).into_owned(), x[n]);
            rows.remove_column(held)
        };
        let mut x = state.push(parameter);
        for _ in 0..ITERATIONS {
            let step = square(&x).lu().solve(&exact(&x).f[0])?;
            x -= step.insert_row(held, 0.0);
        }
        let mut noise = exact(&x).f[1].abs();
        for time in 0..TRIED {
            let moved = Vector::from_fn(n + 1, |i, _| {
                let up = ((i + 2) * (2 * time + 3) / 2).is_multiple_of(2);
                x[i] * (1.0 + if up { f64::EPSILON } else { -f64::EPSILON })
            });
            let left = &exact(&moved).f[0];
            noise = noise.zip_map(left, |most: f64, x: f64| most.max(x.abs()));
        }
        let off = square(&x).try_inverse()?.abs() * noise * SAFETY;
        let off = off[n - 1] + f64::EPSILON * x[n].abs();
        let finite = off.is_finite() && x.iter().all(|x| x.is_finite());
        finite.then(|| (x.rows(0, n).into_owned(), x[n], off))
    }

    /// The derivatives of f in (state, parameter).
    pub(super) fn extended(&self, y: &Vector, p: f64) -> Matrix {
        let n = y.len();
        let mut all = self.jacobian(y, p).insert_column(n, 0.0);
        all.set_column(n, &self.in_parameter(y, p));
        all
    }

    /// The same, and the tangent below.
    fn bordered(&self, y: &Vector, p: f64, tangent: &Vector) -> Matrix {
        let n = y.len();
        let mut square = self.extended(y, p).insert_row(n, 0.0);
        square.set_row(n, &tangent.transpose());
        square
    }
}

/// f(y; p) = 0 in so many variables.
struct Equations<'a, 'b> {
    family: &'a FieldEquilibria<'b>,
    dimension: usize,
}

impl ZeroProblem for Equations<'_, '_> {
    fn dimension(&self) -> usize {
        self.dimension
    }

    fn residual(&self, u: &Vector, lambda: f64) -> Result<Vector> {
        Ok(self.family.field(lambda).f(u))
    }

    fn jacobian(&self, u: &Vector, lambda: f64) -> Result<Matrix> {
        Ok(self.family.extended(u, lambda))
    }
}

/// Zero where nothing but rounding is left: of a function that is zero throughout, as the sums of eigenvalues of a conservative
/// system or the slope of a branch at one parameter, rounding has signs that mean nothing.
fn certain(x: f64, rounding: f64) -> f64 {
    if x.abs() < rounding { 0.0 } else { x }
}

/// The product of all sums of two eigenvalues.
fn sums(jacobian: &Matrix) -> f64 {
    /// Units in the last place of the entries that are rounding.
    const UNITS: f64 = 32.0;
    let product = |jacobian: &Matrix| bialternate(jacobian).determinant();
    certain(product(jacobian), rounding_of(jacobian, UNITS, product))
}

/// The test functions' order.
const LABELS: [Label; 3] = [Label::Lp, Label::Bp, Label::Hb];

struct EquilibriumObserver<'a, 'b> {
    family: &'a FieldEquilibria<'b>,
    /// Whether a step has come onto another branch.
    jumped: bool,
    /// The longest step.
    longest: f64,
    /// The largest norm of the Jacobian so far.
    norm: f64,
    /// A multiple branch point to which the branch leads, and whether it turns back there.
    ahead: Option<(MultiplePoint, bool)>,
    /// [`slope`] at the last point.
    slope: f64,
    /// [`EquilibriumObserver::side`] at the last point, and how long the branch was there.
    fallen: Option<(f64, f64)>,
    /// The last branch point, in (state, parameter).
    branch_point: Option<Vector>,
    /// The last point whose unstable eigenvalues are certain, and their number; none behind a point that changes it.
    last: Option<(usize, FoundEquilibrium)>,
    seen: &'a mut dyn FnMut(&FoundEquilibrium) -> ControlFlow<()>,
}

impl EquilibriumObserver<'_, '_> {
    /// Whether the derivatives in state and parameter together lose a rank: at a branch point.
    fn crosses(&self, y: &Vector, p: f64) -> bool {
        /// What is left of a singular value that is zero, of rows of length 1.
        const ZERO: f64 = 1e-5;
        let mut rows = self.family.extended(y, p);
        for mut row in rows.row_iter_mut() {
            let length = row.norm();
            if length > 0.0 {
                row /= length;
            }
        }
        singular_values(rows, [false, false]).is_some_and(|of| of.singular_values.min() < ZERO)
    }

    /// Its sign changes at branch points, and where a step has come onto another branch.
    fn side(&self, point: &CurvePoint) -> f64 {
        let square = self.family.bordered(&point.u, point.lambda, &point.tangent);
        square.determinant()
    }

    /// A multiple branch point that the branch comes to straight from here, and whether it turns back there: the parameter then depends on the way to it
    /// by an even power. [`EquilibriumObserver::side`], which may keep its sign there, has fallen since the point before.
    fn look_ahead(&mut self, point: &CurvePoint) -> Option<(MultiplePoint, bool)> {
        /// In longest steps.
        const AHEAD: f64 = 2.0;
        /// The cosine of a direction that leads there.
        const STRAIGHT: f64 = 0.9;
        let n = point.u.len();
        let (side, here) = (self.side(point), point.arclength);
        let (before, from) = self.fallen.replace((side, here))?;
        let left = side * (here - from) / (before - side);
        if !(left >= 0.0 && left < AHEAD * self.longest) {
            return None;
        }
        let found = MultiplePoint::near(self.family, &point.u, point.lambda, self.norm)?;
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
            sums(&self.family.jacobian(y, p)),
        ];
        tests.extend(self.inside(y));
        Ok(tests)
    }

    fn ends(&self, test: usize) -> bool {
        test >= LABELS.len()
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
            PointKind::Zero(0) if self.crosses(y, p) || self.slope < FLAT => {
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
            PointKind::Zero(i) => Some(LABELS.get(i).copied().unwrap_or(Label::Ep)),
            PointKind::Wanted(_) => Some(Label::Uz),
            PointKind::Begin | PointKind::Lowest | PointKind::Highest => Some(Label::Ep),
        };
        let Some(found) = self.found((y, p), &point.tangent) else {
            return ControlFlow::Continue(());
        };
        let mut found = FoundEquilibrium { label, ..found };
        if let PointKind::Zero(i) = mark
            && let Some(bound) = i.checked_sub(LABELS.len())
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
