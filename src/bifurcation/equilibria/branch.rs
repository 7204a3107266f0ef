//! Branches of equilibria of N interfaces: which shares they pass, what of them lies in the range, and rows of it.

use super::course::{Course, Station, Step, exact_stiffness, steady_curve};
use super::hopf::ShareHopf;
use super::special::Teller;
use super::stationary::{meeting, parting};
use super::{ClusterOfRow, EquilibriumOfRow};
use crate::bifurcation::{BranchRequest, BranchRow, EventObserver, Label, Parameter, Special};
use crate::equilibrium::{
    Equilibrium, EquilibriumCurve, FAST, MIDDLE, SLOW, Share, ShareState, SteadyCurve, SteadyPoint,
    Symmetry, cluster_stability, share_states, shares,
};
use crate::error::{Error, Result};
use crate::number::Uncertain;
use std::ops::ControlFlow;

/// See [`super::branch()`].
pub(super) fn branch(request: &BranchRequest, seen: EventObserver<'_>) -> Result<()> {
    let most = match request.along {
        Parameter::Driving => request.range.0.max(request.range.1),
        Parameter::Stiffness => request.slab.loading.driving,
    };
    let mut run = Run {
        request,
        steady: steady_curve(&request.slab, most)?,
        teller: Teller::new(seen, request.tolerance, &request.skip),
        branches: 0,
    };
    // an observer's end is no error
    let _ = match request.along {
        Parameter::Driving => run.along_driving(most)?,
        Parameter::Stiffness => run.along_stiffness()?,
    };
    Ok(())
}

/// A share as it is told: of interfaces that all slide alike the branch is that of their rate.
pub(super) fn told_share(
    steady: &SteadyCurve<'_>,
    share: &Share,
    point: &SteadyPoint<'_>,
) -> Share {
    let alike = share.iter().filter(|&&n| n > 0).count() == 1;
    let mut told = *share;
    if alike {
        told = [0; 3];
        told[steady.branch(point.rate()).unwrap_or(MIDDLE)] = share.iter().sum();
    }
    told
}

/// A stretch of a branch: a share, and whether its middle rate falls on the way.
#[derive(Debug, Clone, Copy, PartialEq)]
struct Leg {
    share: Share,
    falling: bool,
}

struct Run<'a> {
    request: &'a BranchRequest,
    steady: SteadyCurve<'a>,
    teller: Teller<'a>,
    branches: usize,
}

impl<'a> Run<'a> {
    fn wants(&self, symmetry: Symmetry) -> bool {
        self.request
            .symmetry
            .is_none_or(|wanted| wanted == symmetry)
    }

    fn along_driving(&mut self, most: f64) -> Result<ControlFlow<()>> {
        let request = self.request;
        let (law, interfaces) = (&request.slab.law, request.slab.interfaces);
        let (from, to) = request.range;
        let range = (from.min(to), most);
        let step = Step::new(request.step, request.max_points);
        let alike = Course::alike(law, interfaces, range, step);
        let apart = Course::shares(self.steady, most, step);
        let apart = apart.filter(|_| self.wants(Symmetry::Asymmetric));
        let branches = branches_apart(self.steady.has(), interfaces);
        if let Some(course) = &apart {
            let legs = branches.iter().flatten();
            let rows: usize = legs.map(|leg| course.rows(&leg.share, range)).sum();
            // Shorter steps than usual end at the limit, with the points up to there.
            if rows > request.max_points && request.step >= 1.0 {
                let must = format!(
                    "at least about {rows}, the number of points of all branches of {interfaces} interfaces"
                );
                return Err(Error::parameter("max-points", request.max_points, must));
            }
        }
        if self.wants(Symmetry::Symmetric) {
            let mut stations = alike.stations(&[0, interfaces, 0], request)?;
            self.meetings(&alike, &mut stations);
            if self.whole(&alike, &stations)?.is_break() {
                return Ok(ControlFlow::Break(()));
            }
        }
        let Some(course) = &apart else {
            return Ok(ControlFlow::Continue(()));
        };
        for legs in branches {
            let mut stations: Vec<Station<'_>> = Vec::new();
            for leg in &legs {
                let mut own = course.stations(&leg.share, request)?;
                if leg.falling {
                    own.reverse();
                }
                // where it begins the one before has ended
                stations.extend(own.into_iter().skip(usize::from(!stations.is_empty())));
            }
            self.told_once(&legs, &mut stations);
            if self.whole(course, &stations)?.is_break() {
                return Ok(ControlFlow::Break(()));
            }
        }
        Ok(ControlFlow::Continue(()))
    }

    /// The branch points of the state in which all slide alike.
    fn meetings(&self, alike: &Course<'a>, stations: &mut Vec<Station<'a>>) {
        let interfaces = self.request.slab.interfaces;
        for branch in [SLOW, FAST] {
            let mut all = [0; 3];
            all[branch] = interfaces;
            let curve = EquilibriumCurve::Shares(self.steady);
            if let Some((point, driving)) = meeting(&curve, &all, branch) {
                let point = alike.curve.point(point.x);
                let at = [driving, exact_stiffness(self.request)];
                let special = parting(&self.steady, branch, at, (interfaces, interfaces));
                stations.push(Station::special(&[0, interfaces, 0], &point, special));
            }
        }
        stations.sort_by(|a, b| a.point.rate().total_cmp(&b.point.rate()));
    }

    /// A branch point is told of by the branch that passes it whole: that on which all slide alike, else that of two clusters.
    fn told_once(&self, legs: &[Leg], stations: &mut [Station<'_>]) {
        let three = legs.iter().any(|leg| leg.share.iter().all(|&n| n > 0));
        let first = self.request.symmetry.is_none();
        let last = stations.len() - 1;
        for (i, station) in stations.iter_mut().enumerate() {
            let end = i == 0 || i == last;
            if station.label == Some(Label::Bp) && (three || end && first) {
                station.special = None;
            }
        }
    }

    /// All of a branch that lies in the range, each stretch from its end nearer to the begin of the range.
    fn whole(&mut self, course: &Course<'_>, stations: &[Station<'_>]) -> Result<ControlFlow<()>> {
        let (from, to) = self.request.range;
        let inside =
            |station: &Station<'_>| (from.min(to)..=from.max(to)).contains(&station.driving);
        let far = |station: &Station<'_>| (station.driving / from).ln().abs();
        let pieces = stations.chunk_by(|a, b| inside(a) == inside(b));
        let shown = pieces.map(|piece| piece.iter().filter(|one| one.shown && inside(one)));
        let mut shown: Vec<Vec<&Station<'_>>> = shown.map(Iterator::collect).collect();
        shown.retain(|piece| piece.len() > 1);
        for piece in &mut shown {
            if far(piece[piece.len() - 1]) < far(piece[0]) {
                piece.reverse();
            }
        }
        shown.sort_by(|a, b| far(a[0]).total_cmp(&far(b[0])));
        for piece in shown {
            let number = self.branches;
            self.branches += 1;
            if self.request.skip.contains(&number) {
                continue;
            }
            for (i, station) in piece.iter().enumerate() {
                let (share, point) = (&station.share, &station.point);
                let state = course.curve.state(share, station.driving, point);
                let stiffness = self.request.slab.loading.stiffness;
                let at = [station.driving, stiffness];
                let special = station.special.clone().map(|one| end_of_range(one, i == 0));
                let told = self.tell((share, point), &state, at, station.label)?;
                if told.is_break() || self.special(special).is_break() {
                    return Ok(ControlFlow::Break(()));
                }
            }
        }
        Ok(ControlFlow::Continue(()))
    }

    fn special(&mut self, special: Option<Special>) -> ControlFlow<()> {
        special.map_or(ControlFlow::Continue(()), |special| {
            self.teller.special(special)
        })
    }

    /// Tells of the row of a state.
    fn tell(
        &mut self,
        (share, point): (&Share, &SteadyPoint<'_>),
        state: &Equilibrium,
        [driving, stiffness]: [f64; 2],
        label: Option<Label>,
    ) -> Result<ControlFlow<()>> {
        let slab = &self.request.slab;
        let stability = cluster_stability(&slab.law, state, stiffness)?;
        let (stress, states) = (state.stress.value, state.state());
        let pair = |all: &[f64]| [all[0], all[all.len() - 1]];
        let clusters = state.counts.iter().zip(&states).zip(&state.slip_rate);
        let clusters = clusters.map(|((&count, &state), &slip_rate)| ClusterOfRow {
            count,
            state,
            slip_rate,
        });
        let many = slab.interfaces > 2;
        Ok(self.teller.branch(BranchRow {
            branch: self.branches - 1,
            symmetry: state.symmetry,
            driving,
            stiffness,
            stress,
            stress_range: (stress, stress),
            period: None,
            state: pair(&states),
            slip_rate: pair(&state.slip_rate),
            ln_abs_multiplier: [None; 2],
            verdict: stability.verdict,
            label,
            equilibrium: Some(EquilibriumOfRow {
                share: many.then(|| told_share(&self.steady, share, point)),
                clusters: clusters.collect(),
                unstable: stability.unstable(),
                eigenvalues: stability.eigenvalues,
            }),
        }))
    }

    /// Along K the states stay; what changes is their stability.
    fn along_stiffness(&mut self) -> Result<ControlFlow<()>> {
        let (slab, mut states) = (&self.request.slab, Vec::new());
        share_states(&slab.law, slab.loading.driving, slab.interfaces, |one| {
            states.push(one);
        })?;
        let stress = |one: &ShareState| one.state.stress.value;
        states.sort_by(|a, b| {
            let apart = |one: &ShareState| one.state.symmetry == Symmetry::Asymmetric;
            let by_symmetry = apart(a).cmp(&apart(b));
            by_symmetry.then(stress(b).total_cmp(&stress(a)))
        });
        for one in states {
            if !self.wants(one.state.symmetry) {
                continue;
            }
            self.branches += 1;
            let known = self.request.skip.contains(&(self.branches - 1));
            if !known && self.over_stiffness(&one)?.is_break() {
                return Ok(ControlFlow::Break(()));
            }
        }
        Ok(ControlFlow::Continue(()))
    }

    fn over_stiffness(&mut self, one: &ShareState) -> Result<ControlFlow<()>> {
        /// The longest step in ln K.
        const LONGEST: f64 = 0.2;
        let request = self.request;
        let driving = request.slab.loading.driving;
        let (from, to) = request.range;
        let exact = |k: f64| Uncertain::new(k, 0.0);
        let plain = |label, k| Special::new(label, exact(driving), exact(k));
        let step = Step::new(request.step, request.max_points);
        let steps = ((to / from).ln().abs() / (LONGEST * request.step)).ceil();
        let steps = steps.min(step.most_intervals());
        let between = (1..steps as usize).map(|i| from * (to / from).powf(i as f64 / steps));
        let mut all: Vec<(f64, Option<Special>)> = between.map(|k| (k, None)).collect();
        let ends = [from, to].into_iter().filter(|k| !request.at.contains(k));
        all.extend(ends.map(|k| (k, Some(plain(Label::Ep, k)))));
        let inside = |k: &f64| (from.min(to)..=from.max(to)).contains(k);
        let wanted = request.at.iter().copied().filter(inside);
        all.extend(wanted.map(|k| (k, Some(plain(Label::Uz, k)))));
        let (curve, point) = self.place_of(one);
        for hopf in hopf_at(curve, one, &point) {
            let special = hopf.special();
            let special = Special {
                driving: exact(driving),
                ..special
            };
            let k = special.stiffness.value;
            if inside(&k) {
                all.push((k, Some(special)));
            }
        }
        all.sort_by(|a, b| a.0.total_cmp(&b.0));
        if from > to {
            all.reverse();
        }
        for (i, (k, special)) in all.into_iter().enumerate() {
            let special = special.map(|one| end_of_range(one, i == 0));
            let label = special.as_ref().map(|special| special.label);
            let told = self.tell((&one.share, &point), &one.state, [driving, k], label)?;
            if told.is_break() || self.special(special).is_break() {
                return Ok(ControlFlow::Break(()));
            }
        }
        Ok(ControlFlow::Continue(()))
    }

    fn place_of(&self, one: &ShareState) -> (EquilibriumCurve<'a>, SteadyPoint<'a>) {
        let curve = match one.state.symmetry {
            Symmetry::Symmetric => EquilibriumCurve::Alike(&self.request.slab.law),
            Symmetry::Asymmetric => EquilibriumCurve::Shares(self.steady),
        };
        (curve, curve.point(one.rate))
    }
}

/// An end of the range with a word which one it is.
fn end_of_range(special: Special, first: bool) -> Special {
    let note = match first {
        true => "begin of the range",
        false => "end of the range",
    };
    match special.label {
        Label::Ep => Special {
            note: Some(note.into()),
            ..special
        },
        _ => special,
    }
}

/// The Hopf points of a state along K.
fn hopf_at<'a>(
    curve: EquilibriumCurve<'a>,
    one: &ShareState,
    point: &SteadyPoint<'a>,
) -> Vec<ShareHopf<'a>> {
    let all = point.oscillation(&one.share).stiffnesses().into_iter();
    let at = |k| ShareHopf::new(curve, one.share, point.clone(), k, Parameter::Stiffness);
    all.map(at).collect()
}

/// The branches on which not all slide alike, those of two clusters first.
fn branches_apart(has: [bool; 3], interfaces: usize) -> Vec<Vec<Leg>> {
    let leg = |share: Share, falling| Leg { share, falling };
    let there = |leg: &Leg| (0..3).all(|i| has[i] || leg.share[i] == 0);
    let two = (1..interfaces).map(|slower| {
        let faster = interfaces - slower;
        let legs = [
            leg([slower, faster, 0], false),
            leg([slower, 0, faster], true),
            leg([0, slower, faster], false),
        ];
        legs.into_iter().filter(there).collect()
    });
    let three = shares(has, interfaces).into_iter();
    let three = three.filter(|share| share.iter().all(|&n| n > 0));
    two.chain(three.map(|share| vec![leg(share, false)]))
        .filter(|legs: &Vec<Leg>| !legs.is_empty())
        .collect()
}
