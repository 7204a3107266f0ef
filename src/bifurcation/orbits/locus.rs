//! Curves of bifurcations of periodic orbits in the (V_H, K) plane, with what is special on them.
//!
//! They start from the bifurcations met along a few branches, and are followed both ways with V_H and K free: past their tops,
//! through resonances, to where the bifurcation ceases to be one.

use super::chart::Chart;
use super::curve::through;
use super::detect::Watch;
use super::follow::{Met, follow};
use super::leg::Pass;
use crate::bifurcation::{LocusKind, LocusRequest, Seen};
use crate::equilibrium::Symmetry;
use crate::error::{Error, Result};
use crate::model::Parameter;
use crate::orbit::{Corrector, Indicator, OverLoadings, Path, Site, Walk, hopf_points};
use std::ops::ControlFlow::{self, Break, Continue};

/// Follows all curves of the kind that is asked for, and hands on what is found.
///
/// # Errors
/// [`Error::Input`] for kinds of equilibria, and for bifurcations that orbits of the symmetry don't have; those of
/// [`LocusRequest::checked`], of the equilibria and of the flow.
pub fn locus(request: &LocusRequest, seen: Seen<'_>) -> Result<()> {
    request.checked()?;
    let request = &request.ordered();
    let mut count = 0;
    for symmetry in symmetries(request)? {
        let told = match symmetry {
            Symmetry::Symmetric => Locus::<2>::all(request, symmetry, &mut count, seen)?,
            Symmetry::Asymmetric => Locus::<3>::all(request, symmetry, &mut count, seen)?,
        };
        if told.is_break() {
            break;
        }
    }
    Ok(())
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

/// The longest step along a curve, and along the branches where curves are looked for.
const LONGEST: f64 = 0.3;
const LONGEST_OF_BRANCH: f64 = 0.7;
/// Steps on such a branch.
const STEPS: usize = 2000;
/// Tolerance of such a branch: what is found there is corrected with that of the curves.
const SCAN: f64 = 1e-8;
/// Below this K no branch is followed for seeds, unless the range ends there: the curves that there are come down from above.
const LOWEST: f64 = 0.03;
/// From one such branch to the next K is divided by this.
const APART: f64 = 2.0;

/// The values of K at which bifurcations are looked for.
fn scanned((from, to): (f64, f64)) -> Vec<f64> {
    let least = from.max(LOWEST.min(to));
    let halves = std::iter::successors(Some(to), |k| Some(k / APART));
    // The least one too: a curve whose top is below the last but one would not be met.
    halves.take_while(|&k| k > least).chain([least]).collect()
}

/// The curves of one kind and symmetry.
pub(super) struct Locus<'r, const N: usize> {
    /// The values of ln K at which bifurcations are looked for.
    pub scan: &'r [f64],
    pub request: &'r LocusRequest,
    pub family: OverLoadings,
    pub indicator: Indicator,
    /// Where the curves so far pass these.
    known: Vec<Pass>,
}

impl<'r, const N: usize> Locus<'r, N>
where
    OverLoadings: Chart<N>,
{
    fn all(
        request: &'r LocusRequest,
        symmetry: Symmetry,
        count: &mut usize,
        seen: Seen<'_>,
    ) -> Result<ControlFlow<()>> {
        let scan = scanned(request.stiffness);
        let mut locus = Locus {
            scan: &scan.iter().map(|k| k.ln()).collect::<Vec<_>>(),
            request,
            family: OverLoadings(request.slab),
            indicator: match request.kind {
                LocusKind::OrbitPitchfork => Indicator::Across,
                LocusKind::PeriodDoubling => Indicator::Doubling,
                LocusKind::Torus => Indicator::Torus,
                _ => Indicator::Fold,
            },
            known: Vec::new(),
        };
        for stiffness in scan {
            for seed in locus.seeds(symmetry, stiffness)? {
                if locus.is_known(&seed) {
                    continue;
                }
                let number = *count;
                *count += 1;
                // A curve that is not to be told of is followed all the same: what lies on it would be taken for another one.
                let found = if request.skip.contains(&number) {
                    through(&locus, number, seed, &mut |_| Continue(()))?
                } else {
                    through(&locus, number, seed, seen)?
                };
                let Some(curve) = found else {
                    *count -= 1;
                    continue;
                };
                if curve.told.is_break() {
                    return Ok(Break(()));
                }
                locus.known.extend(curve.passes);
            }
        }
        Ok(Continue(()))
    }

    /// The bifurcations on the branches at this K.
    fn seeds(&self, symmetry: Symmetry, stiffness: f64) -> Result<Vec<Site<N>>> {
        let slab = self.request.slab.of_stiffness(stiffness);
        let family = OverLoadings(slab);
        let (from, to) = self.request.driving;
        let (from, to) = (from.ln(), to.ln());
        let watch = match self.indicator {
            Indicator::Fold => Watch::Turn(0),
            other => Watch::Indicator(other),
        };
        let mut seeds = Vec::new();
        let mut reached = Vec::new();
        let hopfs = hopf_points(&slab, symmetry, Parameter::Driving)?;
        for (i, hopf) in hopfs.iter().enumerate() {
            if reached.contains(&i) {
                continue;
            }
            let begin = hopf.at()[0];
            // On to the other Hopf point of the branch, or the whole branch would be followed from there too.
            let last_one = i + 1 == hopfs.len();
            let mut corrector = Corrector::<_, N>::new(&family, SCAN)?;
            let path = Path::branch(0, LONGEST_OF_BRANCH);
            let Some(mut walk) = Walk::from_hopf(&mut corrector, path, hopf) else {
                continue;
            };
            let mut last = walk.pace.here.site.clone();
            let mut been = (from..=to).contains(&begin);
            follow(&mut walk, &[watch], STEPS, &mut |walk, _, met| match met {
                Met::Zero(_, at) => {
                    let inside = (from..=to).contains(&at.site.at[0]);
                    let pitchfork = family.merges(&walk.pace.here.site, &last);
                    let torus = self.indicator != Indicator::Torus || at.spectrum.trace.abs() < 2.0;
                    if inside && torus && !(pitchfork && self.indicator == Indicator::Fold) {
                        seeds.push(at.site.clone());
                    }
                    Continue(())
                }
                Met::Orbit(pace) => {
                    let here = &pace.here.site;
                    let inside = (from..=to).contains(&here.at[0]);
                    let left = been && !inside;
                    been |= inside;
                    let end = walk.ends_at(&last, &hopfs);
                    reached.extend(end);
                    let merged = family.merges(here, &last);
                    last = here.clone();
                    if left && last_one || end.is_some() || merged {
                        Break(())
                    } else {
                        Continue(())
                    }
                }
            });
        }
        Ok(seeds)
    }

    /// Whether a curve that was followed passes there.
    fn is_known(&self, seed: &Site<N>) -> bool {
        let here = Pass::of(seed);
        self.known.iter().any(|pass| pass.is(&here))
    }

    /// The longest step.
    pub fn longest(&self) -> f64 {
        LONGEST * self.request.step
    }
}
