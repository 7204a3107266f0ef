//! Two-parameter continuation of bifurcations of periodic orbits in the (V_H, K) plane: folds, period doublings, Neimark-Sacker
//! bifurcations and pitchforks, with what is special on them.
//!
//! They start from the bifurcations met along a few branches, and are followed both ways with V_H and K free: past their tops,
//! through resonances, to where the bifurcation ceases to be one.

use super::curve::through;
use super::half_curve::Pass;
use super::scan::Scan;
use super::slab_chart::Chart;
use crate::bifurcation::{Event, EventObserver, LocusKind, LocusRequest, within};
use crate::equilibrium::Symmetry;
use crate::error::{Error, Result};
use crate::orbit::{ContinuationPoint, InterfaceSystem, TestFunction};
use std::ops::ControlFlow::{self, Break, Continue};

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
    for (i, (request, own)) in ordered.iter().enumerate() {
        let mut scan = match scans.take() {
            Some(scans) if scans.serves(request) => scans,
            _ => Scans::new(&ordered[i..]),
        };
        let (mut count, mut stopped) = (0, false);
        let mut hand_on = |event| {
            let onward = seen(i, event);
            stopped |= onward.is_break();
            onward
        };
        within(request.max_points, &mut hand_on, |seen| {
            for symmetry in own {
                if Locus::all(request, scan.of(*symmetry), &mut count, seen)?.is_break() {
                    break;
                }
            }
            Ok(())
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
        };
        for (request, symmetries) in requests {
            if !scans.serves(request) {
                break;
            }
            for symmetry in symmetries {
                scans.of(*symmetry).also(of_kind(request.kind));
            }
        }
        scans
    }

    fn of(&mut self, symmetry: Symmetry) -> &mut Scan {
        match symmetry {
            Symmetry::Symmetric => &mut self.symmetric,
            Symmetry::Asymmetric => &mut self.asymmetric,
        }
    }

    /// Whether the branches of a request are these.
    fn serves(&self, request: &LocusRequest) -> bool {
        self.slab == request.slab && self.driving == request.driving
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
                "equilibria have curves of their own: this one is of orbits".into(),
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

/// The longest step along a curve.
const LONGEST: f64 = 0.3;
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

/// The curves of one kind and symmetry.
pub(super) struct Locus<'r> {
    /// The values of ln K at which bifurcations are looked for.
    pub scan: &'r [f64],
    pub request: &'r LocusRequest,
    pub chart: Chart,
    pub test_function: TestFunction,
    /// Where the curves so far pass these.
    known: Vec<Pass>,
}

impl<'r> Locus<'r> {
    fn all(
        request: &'r LocusRequest,
        branches: &mut Scan,
        count: &mut usize,
        seen: EventObserver<'_>,
    ) -> Result<ControlFlow<()>> {
        let scan = scanned(request.stiffness);
        branches.along(&scan);
        let branches = &*branches;
        let mut locus = Locus {
            scan: &scan.iter().map(|k| k.ln()).collect::<Vec<_>>(),
            request,
            chart: Chart::new(request.slab, branches.symmetry),
            test_function: of_kind(request.kind),
            known: Vec::new(),
        };
        branches.beside(|| locus.follow(branches, &scan, count, seen))
    }

    fn follow(
        &mut self,
        branches: &Scan,
        scan: &[f64],
        count: &mut usize,
        seen: EventObserver<'_>,
    ) -> Result<ControlFlow<()>> {
        for &stiffness in scan {
            for seed in branches.at(stiffness, self.test_function)? {
                if self.is_known(&seed) {
                    continue;
                }
                let number = *count;
                *count += 1;
                // A curve that is not to be told of is followed all the same: what lies on it would be taken for another one.
                let found = if self.request.skip.contains(&number) {
                    through(self, number, seed, &mut |_| Continue(()))?
                } else {
                    through(self, number, seed, seen)?
                };
                let Some(curve) = found else {
                    *count -= 1;
                    continue;
                };
                if curve.told.is_break() {
                    return Ok(Break(()));
                }
                self.known.extend(curve.passes);
            }
        }
        Ok(Continue(()))
    }

    /// Whether a curve that was followed passes there.
    fn is_known(&self, seed: &ContinuationPoint) -> bool {
        let here = Pass::of(seed);
        self.known.iter().any(|pass| pass.is(&here))
    }

    /// The longest step.
    pub fn longest(&self) -> f64 {
        LONGEST * self.request.step
    }
}
