//! Branches of periodic orbits along V_H or K, from every Hopf point, through folds, with all that bifurcates from them.

use super::detect::Watch;
use super::follow::{End, Met, follow};
use super::rows::row;
use super::sharp::{Exactly, rough, sharpened};
use crate::bifurcation::{BranchRequest, Event, Label, Seen, Special};
use crate::equilibrium::Symmetry;
use crate::error::Result;
use crate::field::State;
use crate::model::Parameter;
use crate::number::Uncertain;
use crate::orbit::{
    Corrector, Family, HopfPoint, Indicator, OverLoadings, Path, Polygon, Regular, Site, Walk,
    hopf_points,
};
use std::ops::ControlFlow::{self, Break, Continue};

/// Tolerance of the walk.
pub(super) const ROUGH: f64 = 1e-11;
/// The longest step, and the most steps on a branch.
pub(super) const LONGEST: f64 = 0.7;
const STEPS: usize = 5000;

/// Follows the branches that are asked for and hands on what is found.
///
/// # Errors
/// Those of the equilibria and of the flow; that a branch ends early is none.
pub fn branch(request: &BranchRequest, seen: Seen<'_>) -> Result<()> {
    let both = [Symmetry::Symmetric, Symmetry::Asymmetric];
    let wanted = both.into_iter().filter(|symmetry| {
        let there = *symmetry == Symmetry::Symmetric || request.slab.interfaces == 2;
        there && request.symmetry.is_none_or(|only| only == *symmetry)
    });
    let mut count = 0;
    for symmetry in wanted {
        let told = match symmetry {
            Symmetry::Symmetric => Branches::<2>::of(request, symmetry, &mut count, seen)?,
            Symmetry::Asymmetric => Branches::<3>::of(request, symmetry, &mut count, seen)?,
        };
        if told.is_break() {
            break;
        }
    }
    Ok(())
}

/// The branches of one symmetry.
struct Branches<'r, const N: usize> {
    request: &'r BranchRequest,
    family: OverLoadings,
    /// The free parameter's place and the range of its coordinate.
    free: usize,
    range: (f64, f64),
    hopfs: Vec<HopfPoint>,
    /// Hopf points where a branch has ended.
    reached: Vec<bool>,
}

/// How a branch goes on.
struct Course<const N: usize> {
    number: usize,
    /// The orbit before.
    last: Site<N>,
    /// Whether it has been in the range.
    inside: bool,
    told: bool,
}

impl<'r, const N: usize> Branches<'r, N>
where
    OverLoadings: Family<N>,
{
    fn of(
        request: &'r BranchRequest,
        symmetry: Symmetry,
        count: &mut usize,
        seen: Seen<'_>,
    ) -> Result<ControlFlow<()>> {
        let mut hopfs = hopf_points(&request.slab, symmetry, request.along)?;
        let free = match request.along {
            Parameter::Driving => 0,
            Parameter::Stiffness => 1,
        };
        hopfs.sort_by(|a, b| a.at()[free].total_cmp(&b.at()[free]));
        let (a, b) = (request.range.0.ln(), request.range.1.ln());
        let mut branches = Branches {
            request,
            family: OverLoadings(request.slab),
            free,
            range: (a.min(b), a.max(b)),
            reached: vec![false; hopfs.len()],
            hopfs,
        };
        for i in 0..branches.hopfs.len() {
            if branches.reached[i] {
                continue;
            }
            let number = *count;
            *count += 1;
            if request.skip.contains(&number) {
                branches.reached[i] = true;
                continue;
            }
            if branches.from_hopf(i, number, seen)?.is_break() {
                return Ok(Break(()));
            }
        }
        Ok(Continue(()))
    }

    fn in_range(&self, coordinate: f64) -> bool {
        (self.range.0..=self.range.1).contains(&coordinate)
    }

    fn watches(&self) -> Vec<Watch> {
        let Branches { free, .. } = *self;
        let mut watches = vec![Watch::Turn(free)];
        if N == 3 {
            watches.push(Watch::Indicator(Indicator::Doubling));
            watches.push(Watch::Indicator(Indicator::Torus));
        } else if self.request.slab.interfaces == 2 {
            watches.push(Watch::Indicator(Indicator::Across));
        }
        let ends = [self.range.0, self.range.1];
        let asked = self.request.at.iter().map(|x| x.ln());
        watches.extend(ends.into_iter().chain(asked).map(|x| Watch::Value(free, x)));
        watches
    }

    fn from_hopf(
        &mut self,
        i: usize,
        number: usize,
        seen: Seen<'_>,
    ) -> Result<ControlFlow<()>> {
        let hopf = self.hopfs[i].clone();
        self.reached[i] = true;
        let family = self.family;
        let mut corrector = Corrector::<_, N>::new(&family, ROUGH)?;
        let path = Path::branch(self.free, LONGEST * self.request.step);
        let begin = hopf.at()[self.free];
        let inside = self.in_range(begin);
        if inside && seen(Event::Special(self.hopf(&hopf))).is_break() {
            return Ok(Break(()));
        }
        let Some(mut walk) = Walk::from_hopf(&mut corrector, path, &hopf) else {
            return Ok(Continue(()));
        };
        let mut course = Course {
            number,
            last: walk.pace.here.site.clone(),
            inside,
            told: false,
        };
        let mut failed = None;
        let watches = self.watches();
        let end = follow(&mut walk, &watches, STEPS, &mut |walk, met| {
            let met = match met {
                Met::Zero(watch, at) => self.zero(walk, watch, at, &mut course, seen),
                Met::Orbit(pace) => {
                    let met = self.orbit(walk, &pace.here, &mut course, seen);
                    course.last = pace.here.site.clone();
                    met
                }
            };
            met.unwrap_or_else(|error| {
                failed = Some(error);
                Break(())
            })
        });
        if let Some(error) = failed {
            return Err(error);
        }
        if end != End::Told && course.inside {
            let site = &walk.pace.here.site;
            let mut special = rough(Label::Mx, site);
            special.note = Some(
                match end {
                    End::Count => "as many orbits as are allowed on a branch",
                    _ => "Newton's method finds no next orbit however short the step",
                }
                .into(),
            );
            if seen(Event::Special(special)).is_break() {
                return Ok(Break(()));
            }
        }
        Ok(if course.told { Break(()) } else { Continue(()) })
    }

    /// The next orbit: its row, and whether the branch goes on.
    fn orbit(
        &mut self,
        walk: &Walk<'_, '_, OverLoadings, N>,
        here: &Regular<N>,
        course: &mut Course<N>,
        seen: Seen<'_>,
    ) -> Result<ControlFlow<()>> {
        let site = &here.site;
        if let Some(end) = walk.vanishes(&course.last)
            && let Some(i) = self.hopf_at(end, site.at[self.free])
        {
            return Ok(self.shrunk(i, course, seen));
        }
        if N == 3 && crosses(site, &course.last) {
            return self.merged(course, seen);
        }
        if !self.in_range(site.at[self.free]) {
            return Ok(Continue(()));
        }
        course.inside = true;
        let row = row(&self.request.slab, course.number, here, None)?;
        Ok(self.tell(Event::Branch(row), course, seen))
    }

    fn tell(&self, event: Event, course: &mut Course<N>, seen: Seen<'_>) -> ControlFlow<()> {
        let told = seen(event);
        course.told |= told.is_break();
        told
    }

    /// The Hopf point where the amplitude of the branch, which is at `here` now, is predicted to be zero.
    fn hopf_at(&self, end: f64, here: f64) -> Option<usize> {
        /// What the prediction may err by: part of the way that is left, and rounding.
        const PART: f64 = 0.2;
        const ROUNDING: f64 = 1e-6;
        (0..self.hopfs.len()).find(|&i| {
            let hopf = self.hopfs[i].at()[self.free];
            (end - hopf).abs() < PART * (here - hopf).abs() + ROUNDING
        })
    }

    /// At the other Hopf point of the branch.
    fn shrunk(&mut self, i: usize, course: &mut Course<N>, seen: Seen<'_>) -> ControlFlow<()> {
        self.reached[i] = true;
        let special = self.hopf(&self.hopfs[i]);
        if self.in_range(self.hopfs[i].at()[self.free]) {
            let _ = self.tell(Event::Special(special), course, seen);
        }
        Break(())
    }

    /// An asymmetric branch has met the symmetric one.
    fn merged(
        &mut self,
        course: &mut Course<N>,
        seen: Seen<'_>,
    ) -> Result<ControlFlow<()>> {
        if let Some(special) = self.pitchfork(&course.last) {
            if self.in_range(special_coordinate(&special, self.free)) {
                let _ = self.tell(Event::Special(special), course, seen);
            }
        }
        Ok(Break(()))
    }

    /// Something that is watched is zero here.
    fn zero(
        &mut self,
        walk: &mut Walk<'_, '_, OverLoadings, N>,
        watch: Watch,
        at: &Regular<N>,
        course: &mut Course<N>,
        seen: Seen<'_>,
    ) -> Result<ControlFlow<()>> {
        let coordinate = at.site.at[self.free];
        if N == 3 && matches!(watch, Watch::Turn(_)) && crosses(&walk.pace.here.site, &course.last) {
            // At the pitchfork, where the branch meets its mirror image.
            return Ok(Continue(()));
        }
        let label = match watch {
            Watch::Value(_, value) if value == self.range.0 || value == self.range.1 => Label::Ep,
            Watch::Value(..) => Label::Uz,
            Watch::Turn(_) => Label::Sn,
            Watch::Indicator(Indicator::Doubling) => Label::Pd,
            Watch::Indicator(Indicator::Torus) if at.spectrum.trace.abs() < 2.0 => Label::Tr,
            Watch::Indicator(Indicator::Across) => Label::Pf,
            // A neutral saddle.
            Watch::Indicator(_) => return Ok(Continue(())),
        };
        // Where the branch leaves the range it ends, where it enters it begins.
        let ends = label == Label::Ep && course.inside;
        if label == Label::Ep {
            course.inside = true;
        } else if !self.in_range(coordinate) {
            return Ok(Continue(()));
        }
        let condition = match watch {
            Watch::Value(i, value) => Exactly::Parameter(i, value),
            Watch::Turn(_) => Exactly::Indicator(Indicator::Fold),
            Watch::Indicator(indicator) => Exactly::Indicator(indicator),
        };
        let sharp = sharpened(walk.corrector.family, &at.site, &walk.path.free, &[condition]);
        let special = match &sharp {
            Some(sharp) => sharp.special(label),
            None => rough(label, &at.site),
        };
        let orbit = sharp.as_ref().map_or(at, |sharp| &sharp.orbit);
        let mut row = row(&self.request.slab, course.number, orbit, Some(label))?;
        if let Watch::Value(_, value) = watch {
            // Exactly: what was asked for, not the exponential of its logarithm.
            let asked = [self.request.range.0, self.request.range.1];
            let asked = asked.iter().chain(&self.request.at);
            let exact = asked.copied().find(|x| x.ln() == value);
            let place = if self.free == 0 { &mut row.driving } else { &mut row.stiffness };
            *place = exact.unwrap_or(*place);
        }
        if self.tell(Event::Special(special), course, seen).is_break()
            || self.tell(Event::Branch(row), course, seen).is_break()
        {
            return Ok(Break(()));
        }
        Ok(if ends { Break(()) } else { Continue(()) })
    }

    fn hopf(&self, hopf: &HopfPoint) -> Special {
        /// Of the bisection, relative.
        const KNOWN: f64 = 1e-12;
        let known = |x: f64| Uncertain::new(x, KNOWN * x);
        let of = |i: usize, x: f64| if self.free == i { known(x) } else { Uncertain::new(x, 0.0) };
        Special {
            period: Some(known(std::f64::consts::TAU / hopf.frequency)),
            ..Special::new(Label::Hb, of(0, hopf.driving), of(1, hopf.stiffness))
        }
    }

    /// The pitchfork near an almost symmetric orbit, solved for on the symmetric one.
    fn pitchfork(&self, near: &Site<N>) -> Option<Special> {
        let nodes = near.polygon.nodes.iter();
        let site = Site {
            polygon: Polygon {
                nodes: nodes.map(|x| State::<2>::new(x[0], 0.5 * (x[1] + x[N - 1]))).collect(),
                durations: near.polygon.durations.clone(),
            },
            at: near.at,
        };
        let across = [Exactly::Indicator(Indicator::Across)];
        let sharp = sharpened::<_, 2>(&self.family, &site, &[self.free], &across)?;
        Some(sharp.special(Label::Pf))
    }
}

fn special_coordinate(special: &Special, free: usize) -> f64 {
    [special.driving, special.stiffness][free].value.ln()
}

/// Whether the walk has gone through a symmetric orbit.
pub(super) fn crosses<const N: usize>(here: &Site<N>, last: &Site<N>) -> bool {
    asymmetry(here) * asymmetry(last) <= 0.0
}

/// The mean of ln psi_1 - ln psi_2, which has one sign all along an asymmetric orbit.
fn asymmetry<const N: usize>(site: &Site<N>) -> f64 {
    let apart = site.polygon.nodes.iter().map(|x| x[1] - x[N - 1]);
    apart.sum::<f64>() / site.polygon.nodes.len() as f64
}
