//! Branches of equilibria of N interfaces: which shares they pass, what of them lies in the range, and rows of it.

use super::course::{Course, Station, parting};
use super::special::{ShareHopf, meeting};
use super::{ClusterOfRow, ClusterRow};
use crate::bifurcation::equilibria::special::Teller;
use crate::bifurcation::{BranchRequest, EventObserver, Label, Parameter, Special};
use crate::equilibrium::{
    Equilibrium, EquilibriumCurve, FAST, MIDDLE, SLOW, Share, ShareState, SteadyCurve, SteadyPoint,
    Symmetry, cluster_stability, share_states, shares,
};
use crate::error::{Error, Result};
use crate::friction::AnyLaw;
use crate::number::Uncertain;
use std::ops::ControlFlow;

/// See [`super::branch()`].
pub(super) fn branch(request: &BranchRequest, seen: EventObserver<'_>) -> Result<()> {
    let most = match request.along {
        Parameter::Driving => request.range.0.max(request.range.1),
        Parameter::Stiffness => request.slab.loading.driving,
    };
    let law = &request.slab.law;
    let steady = steady_curve(law, most)?;
    let mut run = Run {
        request,
        steady,
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

/// The steady curve, for V_H up to a largest one.
///
/// # Errors
/// [`Error::Input`] where an extremum is not certainly one.
pub(super) fn steady_curve(law: &AnyLaw, most: f64) -> Result<SteadyCurve<'_>> {
    SteadyCurve::new(law, 4.0 * most).ok_or_else(|| {
        Error::Input("an extremum of the steady stress is not certainly one: what branches there are is not known".into())
    })
}

/// A share as it is told: of interfaces that all slide alike the branch is that of their rate.
pub(super) fn told_share(steady: &SteadyCurve<'_>, share: &Share, point: &SteadyPoint) -> Share {
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
        let alike = Course::alike(law, interfaces, range, request.step);
        let apart = Course::shares(self.steady, most, request.step);
        let apart = apart.filter(|_| self.wants(Symmetry::Asymmetric));
        let branches = branches_apart(self.steady.has(), interfaces);
        if let Some(course) = &apart {
            let legs = branches.iter().flatten();
            let rows: usize = legs.map(|leg| course.rows(&leg.share, range)).sum();
            if rows > request.max_points {
                let must = format!(
                    "at least about {rows}: so many points have all branches of {interfaces} interfaces"
                );
                return Err(Error::parameter("max-points", request.max_points, must));
            }
        }
        if self.wants(Symmetry::Symmetric) {
            let mut stations = alike.stations(&[0, interfaces, 0], request)?;
            self.meetings(&alike, &mut stations);
            if from > to {
                stations.reverse();
            }
            if self.whole(&alike, &stations)?.is_break() {
                return Ok(ControlFlow::Break(()));
            }
        }
        let Some(course) = &apart else {
            return Ok(ControlFlow::Continue(()));
        };
        for legs in branches {
            let mut stations: Vec<Station> = Vec::new();
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
    fn meetings(&self, alike: &Course<'_>, stations: &mut Vec<Station>) {
        let interfaces = self.request.slab.interfaces;
        for branch in [SLOW, FAST] {
            let mut all = [0; 3];
            all[branch] = interfaces;
            let curve = EquilibriumCurve::Shares(self.steady);
            if let Some((point, driving)) = meeting(&curve, &all, branch) {
                let point = alike.curve.point(point.rates[MIDDLE].value);
                let special = parting(driving, self.request, interfaces);
                stations.push(Station::special(&[0, interfaces, 0], &point, special));
            }
        }
        stations.sort_by(|a, b| a.point.rate().total_cmp(&b.point.rate()));
    }

    /// A branch point is told of by the branch that passes it whole: that on which all slide alike, else that of two clusters.
    fn told_once(&self, legs: &[Leg], stations: &mut [Station]) {
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

    /// All of a branch that lies in the range.
    fn whole(&mut self, course: &Course<'_>, stations: &[Station]) -> Result<ControlFlow<()>> {
        let (from, to) = self.request.range;
        let inside = |station: &Station| (from.min(to)..=from.max(to)).contains(&station.driving);
        for piece in stations.chunk_by(|a, b| inside(a) == inside(b)) {
            let shown = || piece.iter().filter(|station| station.shown);
            if !inside(&piece[0]) || shown().count() < 2 {
                continue;
            }
            let number = self.branches;
            self.branches += 1;
            if self.request.skip.contains(&number) {
                continue;
            }
            for station in shown() {
                let state = course
                    .curve
                    .state(&station.share, station.driving, &station.point);
                let stiffness = self.request.slab.loading.stiffness;
                let at = (&station.share, &station.point);
                let row = self.row(at, &state, station.driving, stiffness)?;
                let row = ClusterRow {
                    label: station.label,
                    ..row
                };
                if self.tell(row, station.special.clone()).is_break() {
                    return Ok(ControlFlow::Break(()));
                }
            }
        }
        Ok(ControlFlow::Continue(()))
    }

    fn tell(&mut self, row: ClusterRow, special: Option<Special>) -> ControlFlow<()> {
        if self.teller.cluster(row).is_break() {
            return ControlFlow::Break(());
        }
        special.map_or(ControlFlow::Continue(()), |special| {
            self.teller.special(special)
        })
    }

    fn row(
        &self,
        (share, point): (&Share, &SteadyPoint),
        state: &Equilibrium,
        driving: f64,
        stiffness: f64,
    ) -> Result<ClusterRow> {
        let law = &self.request.slab.law;
        let stability = cluster_stability(law, state, stiffness)?;
        let clusters = state.counts.iter().zip(state.state()).zip(&state.slip_rate);
        let clusters = clusters.map(|((&count, state), &slip_rate)| ClusterOfRow {
            count,
            state,
            slip_rate,
        });
        Ok(ClusterRow {
            branch: self.branches - 1,
            share: told_share(&self.steady, share, point),
            driving,
            stiffness,
            stress: state.stress.value,
            clusters: clusters.collect(),
            unstable: stability.unstable(),
            verdict: stability.verdict,
            label: None,
        })
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
        let steps = ((to / from).ln().abs() / (LONGEST * request.step)).ceil();
        let between = (1..steps as usize).map(|i| from * (to / from).powf(i as f64 / steps));
        let mut all: Vec<(f64, Option<Special>)> = between.map(|k| (k, None)).collect();
        let ends = [from, to].into_iter().filter(|k| !request.at.contains(k));
        all.extend(ends.map(|k| (k, Some(plain(Label::Ep, k)))));
        all.extend(request.at.iter().map(|&k| (k, Some(plain(Label::Uz, k)))));
        let (curve, point) = self.place_of(one);
        for hopf in hopf_at(curve, one, &point) {
            let special = hopf.special();
            let special = Special {
                driving: exact(driving),
                ..special
            };
            let k = special.stiffness.value;
            if (from.min(to)..=from.max(to)).contains(&k) {
                all.push((k, Some(special)));
            }
        }
        all.sort_by(|a, b| a.0.total_cmp(&b.0));
        if from > to {
            all.reverse();
        }
        for (k, special) in all {
            let row = ClusterRow {
                label: special.as_ref().map(|special| special.label),
                ..self.row((&one.share, &point), &one.state, driving, k)?
            };
            if self.tell(row, special).is_break() {
                return Ok(ControlFlow::Break(()));
            }
        }
        Ok(ControlFlow::Continue(()))
    }

    fn place_of(&self, one: &ShareState) -> (EquilibriumCurve<'a>, SteadyPoint) {
        let curve = match one.state.symmetry {
            Symmetry::Symmetric => EquilibriumCurve::Alike(&self.request.slab.law),
            Symmetry::Asymmetric => EquilibriumCurve::Shares(self.steady),
        };
        (curve, curve.point(one.rate))
    }
}

/// The Hopf points of a state along K.
fn hopf_at<'a>(
    curve: EquilibriumCurve<'a>,
    one: &ShareState,
    point: &SteadyPoint,
) -> Vec<ShareHopf<'a>> {
    let all = point.oscillation(&one.share).stiffnesses().into_iter();
    let at = |stiffness| ShareHopf {
        curve,
        share: one.share,
        point: point.clone(),
        stiffness,
        along: Parameter::Stiffness,
    };
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
