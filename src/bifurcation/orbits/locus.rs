//! Two-parameter continuation of bifurcations of periodic orbits of equal interfaces in the (V_H, K) plane.
//!
//! The curves are those of any system. They start from the bifurcations met along branches at a few values of K, which are found once for all
//! kinds of curves that are asked for.

use super::loadings::{special, with_system};
use super::orbit_curves::{OrbitSeeds, orbit_curves};
use super::scan::Scan;
use crate::bifurcation::general::{
    Classified, GeneralBifurcation, GeneralCurve, GeneralEvent, GeneralFollowing, GeneralPoint,
};
use crate::bifurcation::{Event, EventObserver, LocusKind, LocusRequest, LocusRow, Parameter};
use crate::equilibrium::Symmetry;
use crate::error::{Error, Result};
use crate::number::Uncertain;
use crate::orbit::{ContinuationPoint, InterfaceSystem, TestFunction};
use std::ops::ControlFlow;

/// Follows all curves of the kind that is asked for, and hands on what is found.
///
/// Where there are several cores, branches on which curves begin and the two halves of a curve are followed side by side; from
/// a thread of a rayon pool all is done on that thread. What is found, and its order, do not depend on this.
///
/// # Errors
/// [`Error::Input`] for kinds of equilibria, and for bifurcations that orbits of the symmetry don't have; those of
/// [`LocusRequest::checked`], of the equilibria and of the flow; [`Error::TooManyPoints`].
pub fn locus(request: &LocusRequest, seen: EventObserver<'_>) -> Result<()> {
    loci(std::slice::from_ref(request), &mut |_, event| seen(event))
}

/// Follows the curves of several requests, one after the other, and hands on what is found with the number of the request. For
/// requests that differ in kind alone the branches on which curves begin are followed once.
///
/// # Errors
/// As of [`locus`].
pub fn loci(
    requests: &[LocusRequest],
    seen: &mut dyn FnMut(usize, Event) -> ControlFlow<()>,
) -> Result<()> {
    let mut ordered = Vec::new();
    for request in requests {
        request.checked()?;
        ordered.push((request.ordered(), symmetries(request)?));
    }
    let mut scans: Option<Scans> = None;
    for (i, (request, _)) in ordered.iter().enumerate() {
        let mut scan = match scans.take() {
            Some(scans) if scans.serves(request) => scans,
            _ => Scans::new(&ordered[i..]),
        };
        scan.along(request.stiffness);
        let mut stopped = false;
        request.follow(&scan, &mut |event| {
            let onward = seen(i, event);
            stopped |= onward.is_break();
            onward
        })?;
        if stopped {
            return Ok(());
        }
        scans = Some(scan);
    }
    Ok(())
}

/// What is looked for along branches of both symmetries.
struct Scans {
    slab: InterfaceSystem,
    driving: (f64, f64),
    symmetric: Scan,
    asymmetric: Scan,
    /// The values of K at which bifurcations are looked for, and their logarithms.
    scanned: Vec<f64>,
    logs: Vec<f64>,
}

impl Scans {
    /// For the first of these requests and all that can share it.
    fn new(requests: &[(LocusRequest, Vec<Symmetry>)]) -> Self {
        let LocusRequest { slab, driving, .. } = requests[0].0;
        let mut scans = Scans {
            slab,
            driving,
            symmetric: Scan::new(slab, driving, Symmetry::Symmetric),
            asymmetric: Scan::new(slab, driving, Symmetry::Asymmetric),
            scanned: Vec::new(),
            logs: Vec::new(),
        };
        for (request, symmetries) in requests {
            if !scans.serves(request) {
                break;
            }
            for symmetry in symmetries {
                scans.of_mut(*symmetry).also(of_kind(request.kind));
            }
        }
        scans
    }

    fn of(&self, symmetry: Symmetry) -> &Scan {
        match symmetry {
            Symmetry::Symmetric => &self.symmetric,
            Symmetry::Asymmetric => &self.asymmetric,
        }
    }

    fn of_mut(&mut self, symmetry: Symmetry) -> &mut Scan {
        match symmetry {
            Symmetry::Symmetric => &mut self.symmetric,
            Symmetry::Asymmetric => &mut self.asymmetric,
        }
    }

    /// Looks in this range of K.
    fn along(&mut self, stiffness: (f64, f64)) {
        let scanned = scanned(stiffness);
        self.symmetric.along(&scanned);
        self.asymmetric.along(&scanned);
        self.logs = scanned.iter().map(|k| k.ln()).collect();
        self.scanned = scanned;
    }

    /// Whether the branches of a request are these.
    fn serves(&self, request: &LocusRequest) -> bool {
        self.slab == request.slab && self.driving == request.driving
    }
}

impl OrbitSeeds for Scans {
    fn values(&self) -> &[f64] {
        &self.logs
    }

    fn at(
        &self,
        held: f64,
        symmetry: Symmetry,
        test_function: TestFunction,
    ) -> Result<Vec<ContinuationPoint>> {
        let scanned = self.logs.iter().zip(&self.scanned);
        let mut there = scanned.filter(|(log, _)| **log == held);
        match there.next() {
            Some((_, stiffness)) => self.of(symmetry).at(*stiffness, test_function),
            None => Ok(Vec::new()),
        }
    }

    fn beside(&self, symmetry: Symmetry, work: &mut dyn FnMut()) {
        self.of(symmetry).beside(work);
    }
}

/// What is zero along curves of a kind.
fn of_kind(kind: LocusKind) -> TestFunction {
    match kind {
        LocusKind::OrbitPitchfork => TestFunction::Transverse,
        LocusKind::PeriodDoubling => TestFunction::Doubling,
        LocusKind::Torus => TestFunction::Torus,
        _ => TestFunction::Fold,
    }
}

/// Orbits of which symmetry have the bifurcation.
fn symmetries(request: &LocusRequest) -> Result<Vec<Symmetry>> {
    let possible: &[Symmetry] = match request.kind {
        LocusKind::OrbitPitchfork => &[Symmetry::Symmetric],
        LocusKind::OrbitSaddleNode => &[Symmetry::Symmetric, Symmetry::Asymmetric],
        LocusKind::PeriodDoubling | LocusKind::Torus => &[Symmetry::Asymmetric],
        _ => {
            return Err(Error::Input(
                "a curve of bifurcations of orbits, not of equilibria".into(),
            ));
        }
    };
    let both = request.slab.interfaces == 2;
    let wanted: Vec<Symmetry> = possible
        .iter()
        .copied()
        .filter(|s| request.symmetry.is_none_or(|only| only == *s))
        .filter(|s| both || *s == Symmetry::Symmetric)
        .collect();
    if wanted.is_empty() || (!both && request.kind == LocusKind::OrbitPitchfork) {
        return Err(Error::Input(
            "orbits of this symmetry do not have this bifurcation: in the plane of symmetric orbits there are folds, and \
             pitchforks out of it; period doublings and tori need asymmetric ones"
                .into(),
        ));
    }
    Ok(wanted)
}

/// Steps, in parts of those along curves of any system: figures show these curves.
const SHORTER: f64 = 3.0 / 7.0;
/// Below this K no branch is followed for seeds, unless the range ends there: the curves that there are come down from above.
const LOWEST: f64 = 0.03;
/// Above this K there is none.
const HIGHEST: f64 = 1e3;
/// From one such branch to the next K is divided by this.
const APART: f64 = 2.0;
/// Unless the least one, by which the range ends, is as near as this.
const CLOSE: f64 = 1.2;

/// The values of K at which bifurcations are looked for.
fn scanned((from, to): (f64, f64)) -> Vec<f64> {
    let to = to.min(HIGHEST);
    let least = from.min(to).max(LOWEST.min(to));
    let halves = std::iter::successors(Some(to), |k| Some(k / APART));
    // The least one too: a curve whose top is below the last but one would not be met. No two stand close together.
    halves
        .take_while(|&k| k > CLOSE * least)
        .chain([least])
        .collect()
}

impl LocusRequest {
    fn follow(&self, seeds: &Scans, seen: EventObserver<'_>) -> Result<()> {
        let logs = |(from, to): (f64, f64)| (from.ln(), to.ln());
        let ranges = [logs(self.driving), logs(self.stiffness)];
        let all = |values: &[f64]| values.iter().map(|x| x.ln()).collect();
        with_system((&self.slab, &self.watch), Parameter::Driving, |system| {
            let test_function = of_kind(self.kind);
            let curve = GeneralCurve {
                begin: None,
                system: *system,
                kind: GeneralBifurcation::Orbit(test_function),
                ranges,
                beyond: ranges,
                at: [all(&self.at_driving), all(&self.at_stiffness)],
                watch: self.watch.iter().map(|one| one.text.clone()).collect(),
                orbit: None,
                own: None,
                found: None,
                seeds: Some(seeds),
                symmetry: self.symmetry,
                criticality: match self.criticality {
                    true => Classified::Every,
                    false => Classified::Never,
                },
                following: GeneralFollowing {
                    step: SHORTER * self.step,
                    skip: self.skip.clone(),
                    max_points: self.max_points,
                },
            };
            orbit_curves(&curve, Some(test_function), &mut |event| {
                seen(match event {
                    GeneralEvent::Row(point) => Event::Locus(self.row(&point)),
                    GeneralEvent::Special(point) => {
                        let special =
                            special(point.clone(), self.given(&point), Parameter::Driving);
                        Event::Special(special.against(self.tolerance))
                    }
                })
            })
        })
    }

    /// V_H and K of a point as they were given, where they were: not the exponentials of their logarithms.
    fn given(&self, point: &GeneralPoint) -> [Option<f64>; 2] {
        let asked = |range: (f64, f64), wanted: &[f64], at: f64| {
            let mut all = [range.0, range.1].into_iter().chain(wanted.iter().copied());
            all.find(|x| x.ln() == at)
        };
        [
            asked(self.driving, &self.at_driving, point.at[0]),
            asked(self.stiffness, &self.at_stiffness, point.at[1]),
        ]
    }

    fn row(&self, point: &GeneralPoint) -> LocusRow {
        let exactly =
            |x: Uncertain, given: Option<f64>| given.map_or(x, |given| Uncertain::new(given, 0.0));
        let [driving, stiffness] = point.parameters;
        let [given_driving, given_stiffness] = self.given(point);
        LocusRow {
            share: None,
            curve: point.number,
            symmetry: point.symmetry.unwrap_or(Symmetry::Symmetric),
            driving: exactly(driving, given_driving),
            stiffness: exactly(stiffness, given_stiffness),
            period: point.period.map(|period| period.value),
            angle_over_pi: point.angle_over_pi,
            criticality: point.criticality,
            label: point.label,
        }
    }
}
