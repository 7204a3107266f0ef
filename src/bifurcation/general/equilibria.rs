//! Branches of equilibria along one parameter, with all that branches off.

use super::multiple::Multiple;
use super::runaway::{Runaway, Runs};
use super::splits::with_splits;
use super::{
    GeneralBranch, GeneralEvent, GeneralObserver, GeneralPoint, GeneralSolution, SAME, Teller,
};
use crate::bifurcation::equilibria::generic::{FieldEquilibria, FoundEquilibrium, Onward, Watch};
use crate::bifurcation::equilibria::generic_curve::{EquilibriumBifurcation, EquilibriumCurve};
use crate::bifurcation::{Criticality, Label};
use crate::continuation::{Settings, Stop};
use crate::error::Result;
use crate::field::Vector;
use crate::number::Uncertain;
use crate::orbit::Solution;
use nalgebra::Complex;
use std::f64::consts::TAU;
use std::ops::ControlFlow::{self, Break, Continue};

/// Longest steps, as parts of the range and of 1 + |state|.
const LONGEST: f64 = 0.02;
/// Points nearer to the last one, in longest steps, are no rows.
const SHOWN: f64 = 1e-2;
/// Parts of the range at which branches are looked for that do not come to its ends; no round ones, at which something special may be.
const INSIDE: [f64; 7] = [0.4973, 0.2517, 0.7519, 0.1253, 0.3739, 0.6247, 0.8761];
/// The first step onto a branch that crosses, in units of 1 + |state|.
const ASIDE: f64 = 1e-3;

/// Follows all branches of equilibria over the range and hands on what is found.
///
/// # Errors
/// Those of the known equilibria; [`crate::Error::TooManyPoints`]; [`crate::Error::NotConverged`] where not one equilibrium is
/// found to begin with. That a branch ends early is none: it is told as `MX`.
pub fn equilibria(branch: &GeneralBranch<'_>, seen: GeneralObserver<'_>) -> Result<()> {
    with_splits(branch, seen, |seen| {
        let mut teller = Teller::new(seen, &branch.following);
        EquilibriumBranches::new(branch).all(&mut |point, kind| match kind {
            Reported::Row => teller.point(point, false),
            Reported::Special => teller.point(point, true),
            Reported::Limit => teller.tell(GeneralEvent::Special(point)),
        })?;
        teller.end()
    })
}

/// An observer of points and their kinds.
pub(in crate::bifurcation) type PointObserver<'a> =
    &'a mut dyn FnMut(GeneralPoint, Reported) -> ControlFlow<()>;

/// The kind of a point that is reported.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(in crate::bifurcation) enum Reported {
    /// A row.
    Row,
    /// A special point, with its row.
    Special,
    /// The limit of a branch, which is no point of it.
    Limit,
}

/// All branches, and what is known of them so far.
pub(in crate::bifurcation) struct EquilibriumBranches<'b, 'a> {
    branch: &'b GeneralBranch<'a>,
    count: usize,
    /// Where branches ended, (state, coordinate).
    ends: Vec<Vector>,
    /// Branch points, and how many branches passed each.
    crossings: Vec<(FoundEquilibrium, usize)>,
    /// Branch points at which several eigenvalues are 0.
    pub(super) multiples: Vec<Multiple>,
    /// The points of all branches, (state, coordinate), branch by branch.
    pub(super) traces: Vec<Vec<Vector>>,
}

impl<'b, 'a> EquilibriumBranches<'b, 'a> {
    pub fn new(branch: &'b GeneralBranch<'a>) -> Self {
        EquilibriumBranches {
            branch,
            count: 0,
            ends: Vec::new(),
            crossings: Vec::new(),
            multiples: Vec::new(),
            traces: Vec::new(),
        }
    }

    /// Follows all; whoever is told may break.
    pub fn all(mut self, seen: PointObserver<'_>) -> Result<()> {
        let (range, held) = (self.branch.range, self.branch.held);
        for (begin, end) in [range, (range.1, range.0)] {
            let known = (self.branch.system.equilibria)([begin, held])?;
            for state in known {
                if self.is_known(&state, begin) {
                    continue;
                }
                let onward = Onward::along(state, begin, end > begin);
                if self.follow(&onward, seen)?.is_break() {
                    return Ok(());
                }
            }
        }
        for begin in self.inside_values() {
            for state in (self.branch.system.equilibria)([begin, held])? {
                if !self.is_known(&state, begin) && self.both_ways(&state, begin, seen)?.is_break()
                {
                    return Ok(());
                }
            }
        }
        // The lists grow as they are gone through.
        let (mut i, mut multiple, mut which) = (0, 0, 0);
        loop {
            if multiple < self.multiples.len() {
                if self.begin(multiple, which, seen)?.is_break() {
                    return Ok(());
                }
                which += 1;
                if which >= self.multiples[multiple].begins.len() {
                    (multiple, which) = (multiple + 1, 0);
                }
                continue;
            }
            let Some((point, passed)) = self.crossings.get(i).cloned() else {
                break;
            };
            i += 1;
            if passed > 1 {
                continue;
            }
            let distance = ASIDE * (1.0 + point.state.amax());
            let ways = self.with_family(|family| family.switch(&point, distance));
            let mut begun: Vec<Vector> = Vec::new();
            for onward in ways.into_iter().flatten() {
                if self.crossings[i - 1].1 > 1 {
                    break;
                }
                let begin = self.place(&onward.state, onward.parameter);
                if begun.iter().any(|other| near(other, &begin)) {
                    continue;
                }
                begun.push(begin);
                if self.inside(onward.parameter)
                    && self.in_box(&onward.state)
                    && self.follow(&onward, seen)?.is_break()
                {
                    return Ok(());
                }
            }
        }
        Ok(())
    }

    /// Whether a state is in the box, where there is one.
    pub(super) fn in_box(&self, state: &Vector) -> bool {
        let mut bounds = self.branch.system.bounds.iter().zip(state);
        bounds.all(|(bound, x)| (bound.range.0..=bound.range.1).contains(x))
    }

    pub fn with_family<R>(&self, then: impl FnOnce(&FieldEquilibria<'_>) -> R) -> R {
        let (system, held) = (self.branch.system, self.branch.held);
        let fields = |x: f64| system.family.field([x, held]);
        let scale = |x: f64| system.family.scale([x, held])[0];
        let bounds: Vec<_> = system.bounds.iter().map(|bound| bound.range).collect();
        then(&FieldEquilibria {
            fields: &fields,
            along: system.names[0],
            scale: Some(&scale),
            bounds: &bounds,
        })
    }

    /// (state, coordinate), the same for its mirror images.
    pub(super) fn place(&self, state: &Vector, at: f64) -> Vector {
        self.branch.system.representative(state).push(at)
    }

    pub(super) fn inside(&self, x: f64) -> bool {
        let (a, b) = self.branch.range;
        (a.min(b)..=a.max(b)).contains(&x)
    }

    /// Whether a branch has ended there.
    fn is_known(&self, state: &Vector, at: f64) -> bool {
        let here = self.place(state, at);
        self.ends.iter().any(|end| near(end, &here))
    }

    /// The values inside the range at which branches are looked for.
    fn inside_values(&self) -> [f64; INSIDE.len()] {
        let (from, to) = self.branch.range;
        INSIDE.map(|part| from + (to - from) * part)
    }

    /// The branch through an equilibrium inside the range, from its end on.
    fn both_ways(
        &mut self,
        state: &Vector,
        begin: f64,
        seen: PointObserver<'_>,
    ) -> Result<ControlFlow<()>> {
        let mut back = Vec::new();
        let number = self.count;
        let onward = Onward::along(state.clone(), begin, false);
        let closed = self.half(&onward, number, &mut |point, kind| {
            back.push((point, kind));
            Continue(())
        })?;
        self.count += 1;
        let beginning = back.first().cloned();
        for (point, kind) in back.into_iter().rev() {
            if seen(point, kind).is_break() {
                return Ok(Break(()));
            }
        }
        if closed.stopped == Some(Stop::Closed) {
            return Ok(Continue(()));
        }
        let onward = Onward::along(state.clone(), begin, true);
        let mut first = beginning.is_some();
        let forth = self.half(&onward, number, &mut |point, kind| {
            // Both ways begin with the same point.
            if std::mem::replace(&mut first, false) {
                return Continue(());
            }
            seen(point, kind)
        })?;
        Ok(forth.told)
    }

    /// One branch, both ways round from a branch point being two.
    pub(super) fn follow(
        &mut self,
        onward: &Onward,
        seen: PointObserver<'_>,
    ) -> Result<ControlFlow<()>> {
        let number = self.count;
        let half = self.half(onward, number, seen)?;
        // What was thought to be an equilibrium may be none.
        self.count += usize::from(half.stopped.is_some());
        Ok(half.told)
    }

    /// One way from an equilibrium.
    fn half(&mut self, onward: &Onward, number: usize, seen: PointObserver<'_>) -> Result<Half> {
        let GeneralBranch { range, at, .. } = self.branch;
        let (low, high) = (range.0.min(range.1), range.0.max(range.1));
        let inside = self.inside_values();
        let more = inside.iter().filter(|value| !at.contains(value));
        let wanted: Vec<f64> = at.iter().chain(more).copied().collect();
        let size = (high - low) + 1.0 + onward.state.amax();
        let longest = LONGEST * size * self.branch.following.step;
        let settings = Settings {
            wanted,
            size,
            max_points: self.branch.following.max_points + 1,
            ..Settings::new((low, high), longest)?
        };
        let (mut told, mut last, mut place) = (Continue(()), None, None::<Vector>);
        let (mut ends, mut crossings) = (Vec::new(), Vec::new());
        let (mut multiples, mut trace) = (Vec::<Multiple>::new(), Vec::new());
        let (mut runaway, mut runs) = (Runaway::new(size, (low, high)), None);
        let mut begun = false;
        let mut look = |found: &FoundEquilibrium| {
            let here = found.state.push(found.parameter);
            trace.push(here.clone());
            // From a branch point a branch begins without a label of its own.
            let first = !std::mem::replace(&mut begun, true);
            let begins = first && (onward.across || inside.contains(&onward.parameter));
            let asked = |label: &Label| match label {
                Label::Uz => at.contains(&found.parameter),
                // A closed branch ends where it began.
                Label::Ep => found.leaves.is_some() || [low, high].contains(&found.parameter),
                _ => true,
            };
            let label = match begins {
                // Inside the range a value may have been asked for.
                true => at.contains(&found.parameter).then_some(Label::Uz),
                false => found.label.filter(asked),
            };
            if matches!(found.label, Some(Label::Ep | Label::Uz)) {
                ends.push(self.place(&found.state, found.parameter));
            }
            if label == Some(Label::Bp) && found.together == 0 {
                crossings.push(found.clone());
            }
            let mut note = None;
            if let Some(multiple) = &found.multiple {
                let place = multiple.place();
                let mut known = self.multiples.iter().chain(&multiples);
                let at = known.position(|one| near(&one.point.place(), &place));
                if at.is_none() {
                    multiples.push(self.multiple(multiple, 2.0 * longest));
                }
                let mut known = self.multiples.iter().chain(&multiples);
                note = at
                    .map_or(known.clone().last(), |at| known.nth(at))
                    .map(Multiple::note);
            }
            // The short steps that tell a crossing from a near miss are none to show.
            let short = place
                .as_ref()
                .is_some_and(|last| (last - &here).norm() < SHOWN * longest);
            if label.is_none() && short {
                return Continue(());
            }
            let before = place.replace(here);
            let mirrors = |before: &Vector| self.branch.system.mirrors(before, &found.state);
            let mut point = self.point(number, found, label);
            point.note = note.or(point.note);
            last = Some(point.clone());
            let kind = if label.is_some() {
                Reported::Special
            } else {
                Reported::Row
            };
            told = seen(point, kind);
            if label.is_none() {
                runs = runaway.passes(found.state.norm(), found.parameter);
            }
            if runs.is_some() {
                return Break(());
            }
            match before.as_ref().is_some_and(mirrors) {
                // What follows is the mirror image of what is told.
                true if label == Some(Label::Bp) => Break(()),
                _ => told,
            }
        };
        let held = self.branch.held;
        let system = self.branch.system;
        let watch = Watch {
            count: self.branch.watch.len(),
            of: &|which, state, x| {
                let equilibrium = Solution::Equilibrium {
                    state,
                    period: None,
                };
                system.family.user_function(which, equilibrium, [x, held])
            },
        };
        let followed =
            self.with_family(|family| family.follow_watching(onward, &settings, watch, &mut look));
        let followed = match followed {
            Ok(followed) => followed,
            // What was thought to be an equilibrium is none.
            Err(_) if onward.across => {
                return Ok(Half {
                    told: Continue(()),
                    stopped: None,
                });
            }
            Err(error) => return Err(error),
        };
        self.ends.extend(ends);
        self.multiples.extend(multiples);
        self.traces.push(trace);
        for found in crossings {
            self.cross(found);
        }
        match &followed.stopped {
            Stop::Observer | Stop::RangeEnd | Stop::Ended(_) | Stop::Closed => {}
            other => {
                if let Some(mut point) = last.take() {
                    point.label = Some(Label::Mx);
                    point.note = Some(other.to_string());
                    told = seen(point, Reported::Special);
                }
            }
        }
        if let (Some(runs), Some(last), Continue(())) = (runs, last, told) {
            told = self.to_infinity(runs, last, seen);
        }
        Ok(Half {
            told,
            stopped: Some(followed.stopped),
        })
    }

    /// Reports that a branch runs to infinity after its last point.
    fn to_infinity(
        &self,
        runs: Runs,
        last: GeneralPoint,
        seen: PointObserver<'_>,
    ) -> ControlFlow<()> {
        let system = &self.branch.system;
        let point = GeneralPoint {
            label: Some(Label::Ep),
            ..last
        };
        let Runs::At(limit) = runs else {
            let note = Some("the branch runs to infinity".to_owned());
            return seen(GeneralPoint { note, ..point }, Reported::Special);
        };
        let note = format!(
            "the branch runs to infinity as {} tends to this value",
            system.names[0]
        );
        let point = GeneralPoint {
            at: [limit.value, point.at[1]],
            note: Some(note),
            ..point
        };
        seen(
            point.placed(system.family, [limit.uncertainty, 0.0]),
            Reported::Limit,
        )
    }

    /// One more branch passes a branch point.
    fn cross(&mut self, found: FoundEquilibrium) {
        let here = self.place(&found.state, found.parameter);
        let places = self.crossings.iter();
        let mut places = places.map(|(other, _)| self.place(&other.state, other.parameter));
        match places.position(|other| near(&other, &here)) {
            Some(i) => self.crossings[i].1 += 1,
            None => self.crossings.push((found, 1)),
        }
    }

    fn point(&self, number: usize, found: &FoundEquilibrium, label: Option<Label>) -> GeneralPoint {
        let (system, held) = (self.branch.system, self.branch.held);
        let solution = |state: &Vector| GeneralSolution::Equilibrium {
            state: state.clone(),
            eigenvalues: found.eigenvalues.clone(),
        };
        let multiplicity = match label {
            Some(Label::Bp) => Some(found.together.max(1)),
            Some(Label::Hb) => Some((found.together / 2).max(1)),
            _ => None,
        };
        let leaves = found
            .leaves
            .map(|(variable, upper)| system.bounds[variable].said[usize::from(upper)].clone());
        let rough = GeneralPoint {
            label,
            multiplicity,
            note: leaves,
            crossing: found.crossing,
            period: found.period.map(|t| Uncertain::new(t, f64::INFINITY)),
            coefficient: found.coefficient,
            criticality: found
                .coefficient
                .map(|l_1| criticality(l_1, &found.eigenvalues)),
            ..GeneralPoint::new(number, [found.parameter, held], solution(&found.state))
        };
        if found.together > 0 && found.multiple.is_none() {
            let note = match label {
                Some(Label::Hb) => {
                    format!(
                        "pairs of eigenvalues on the imaginary axis: {}",
                        found.together / 2
                    )
                }
                _ => format!(
                    "zero eigenvalues: {}; other branches through this point are not followed",
                    found.together
                ),
            };
            let off = found.uncertainty.unwrap_or(f64::INFINITY);
            let point = GeneralPoint {
                note: Some(note),
                ..rough
            };
            return point.placed(system.family, [off, 0.0]);
        }
        let kind = match label {
            Some(Label::Lp) => EquilibriumBifurcation::Fold,
            Some(Label::Hb) => EquilibriumBifurcation::Hopf,
            Some(Label::Uz | Label::Ep) if found.leaves.is_none() => {
                return rough.placed(system.family, [0.0; 2]);
            }
            Some(Label::Uf) => {
                let which = found.zero_of.unwrap_or_default();
                let off = found.uncertainty.unwrap_or(f64::INFINITY);
                let point = rough.at_zero_of(&self.branch.watch, which);
                return point.placed(system.family, [off, 0.0]);
            }
            Some(Label::Bp | Label::Ep) => {
                let off = found.uncertainty.unwrap_or(f64::INFINITY);
                return rough.placed(system.family, [off, 0.0]);
            }
            _ => return rough.placed(system.family, [f64::INFINITY, 0.0]),
        };
        let curve = EquilibriumCurve {
            family: system.family,
            kind,
        };
        match curve.sharp(&found.state, rough.at, 1) {
            Some(sharp) if near(&sharp.state, &found.state) => {
                let mut point = GeneralPoint {
                    at: [sharp.at[0], held],
                    solution: solution(&sharp.state),
                    ..rough
                };
                if let Some(omega) = sharp.frequency {
                    let period = TAU / omega.value;
                    let off = period * omega.uncertainty / omega.value;
                    point.period = Some(Uncertain::new(period, off));
                }
                point.placed(system.family, sharp.uncertainty)
            }
            _ => rough.placed(system.family, [f64::INFINITY, 0.0]),
        }
    }
}

/// What one way along a branch came to.
struct Half {
    /// Whether to go on.
    told: ControlFlow<()>,
    /// Why it ended; `None` where it did not begin.
    stopped: Option<Stop>,
}

/// Whether two points of (state, coordinate) are one.
pub(super) fn near(a: &Vector, b: &Vector) -> bool {
    let mut pairs = a.iter().zip(b);
    pairs.all(|(a, b)| (a - b).abs() < SAME * (1.0 + a.abs()))
}

/// Which way a Hopf bifurcation goes, by the first Lyapunov coefficient. Where another eigenvalue is zero that has a pole, and no sign.
pub(super) fn criticality(coefficient: f64, eigenvalues: &[Complex<f64>]) -> Criticality {
    /// What a difference of second derivatives leaves.
    const ZERO: f64 = 1e-9;
    /// An eigenvalue against the largest.
    const NEUTRAL: f64 = 1e-6;
    let largest = eigenvalues.iter().map(|z| z.norm()).fold(0.0, f64::max);
    let at_pole = eigenvalues.iter().any(|z| z.norm() < NEUTRAL * largest);
    if at_pole || coefficient.abs() < ZERO {
        Criticality::Undecided
    } else if coefficient < 0.0 {
        Criticality::Supercritical
    } else {
        Criticality::Subcritical
    }
}
