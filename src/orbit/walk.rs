//! Along a curve of orbits: pseudo-arclength continuation of a branch, one parameter free, or of a bifurcation, with both.

use super::correct::{Condition, Corrector, Goal, Regular};
use super::family::Family;
use super::indicator::Indicator;
use super::motion::{Motion, Site};
use super::polygon::Mesh;

/// Where a walk stands.
#[derive(Debug, Clone)]
pub struct Pace<const N: usize> {
    /// The orbit and its surroundings.
    pub here: Regular<N>,
    /// The direction of the walk.
    pub direction: Motion<N>,
}

/// What is walked along.
#[derive(Debug, Clone, PartialEq)]
pub struct Path {
    /// The free parameters: one for a branch, both for a bifurcation.
    pub free: Vec<usize>,
    /// The bifurcation.
    pub indicator: Option<Indicator>,
    /// The longest step.
    pub longest: f64,
}

/// Lengths of steps.
const FIRST: f64 = 0.02;
const SHORTEST: f64 = 1e-9;
/// After fewer iterations than this the next step is longer.
const EASY: usize = 3;
const LONGER: f64 = 1.7;
const SHORTER: f64 = 0.4;
/// The least cosine between the directions before and after a step.
const TURN: f64 = 0.8;

/// A walk with its next step's length.
pub struct Walk<'c, 'f, F, const N: usize> {
    /// What makes its orbits.
    pub corrector: &'c mut Corrector<'f, F, N>,
    /// What it is along.
    pub path: Path,
    /// Where it stands.
    pub pace: Pace<N>,
    /// The next step.
    pub length: f64,
    /// Whether the nodes have been cut anew where it stands.
    fresh: bool,
}

impl Path {
    /// A branch along this parameter.
    pub fn branch(parameter: usize, longest: f64) -> Self {
        Path {
            free: vec![parameter],
            indicator: None,
            longest,
        }
    }

    /// A curve of bifurcations.
    pub fn locus(indicator: Indicator, longest: f64) -> Self {
        Path {
            free: vec![0, 1],
            indicator: Some(indicator),
            longest,
        }
    }

    /// The path's own conditions and one more.
    pub fn and<'a, const N: usize>(&self, last: Condition<'a, N>) -> Vec<Condition<'a, N>> {
        let own = self.indicator.map(Condition::Indicator);
        own.into_iter().chain([last]).collect()
    }

    /// The direction of the path at an orbit, with the sign that makes the product with `before` positive.
    pub fn direction<const N: usize>(
        &self,
        at: &Regular<N>,
        before: &Motion<N>,
    ) -> Option<Motion<N>> {
        let direction = match (&at.along[..], at.gradients.first()) {
            ([only], _) => only.clone(),
            // Where the indicator does not change.
            ([first, second], Some(gradient)) => {
                let (a, b) = (gradient.dot(first), gradient.dot(second));
                first.clone().scaled(b).plus(-a, second).normalised()?
            }
            _ => return None,
        };
        let sign = if direction.dot(before) < 0.0 { -1.0 } else { 1.0 };
        Some(direction.scaled(sign))
    }
}

impl<'c, 'f, F: Family<N>, const N: usize> Walk<'c, 'f, F, N> {
    /// From an orbit nearby into a direction: the first correction is across it.
    pub fn from(
        corrector: &'c mut Corrector<'f, F, N>,
        path: Path,
        site: Site<N>,
        direction: Motion<N>,
    ) -> Option<Self> {
        let conditions = path.and(Condition::Plane(&direction, &site));
        let here = corrector.correct(site.clone(), &path.free, &conditions, None, Goal::STEP)?;
        let direction = path.direction(&here, &direction)?;
        Some(Walk {
            corrector,
            pace: Pace { here, direction },
            length: FIRST.min(path.longest),
            path,
            fresh: false,
        })
    }

    /// The same, backwards.
    pub fn turned(mut self) -> Self {
        self.pace.direction = self.pace.direction.scaled(-1.0);
        self
    }

    /// The orbit at this distance along the direction.
    pub fn at(&mut self, length: f64) -> Option<Pace<N>> {
        let pace = self.pace.clone();
        self.beyond(&pace, length)
    }

    /// The orbit at this distance from where the walk once stood, along the direction there.
    pub fn beyond(&mut self, pace: &Pace<N>, length: f64) -> Option<Pace<N>> {
        let Pace { here, direction } = pace;
        let predicted = here.site.moved(direction, length);
        let conditions = self.path.and(Condition::Plane(direction, &predicted));
        let old = (!here.gradients.is_empty()).then(|| here.gradients.clone());
        let next = self.corrector.correct(
            predicted.clone(),
            &self.path.free,
            &conditions,
            old,
            Goal::STEP,
        )?;
        let along = self.path.direction(&next, direction)?;
        Some(Pace {
            here: next,
            direction: along,
        })
    }

    /// The next orbit, which the walk then stands at; returns where it stood and how far that was. `None` where the steps
    /// shrink to nothing.
    pub fn step(&mut self) -> Option<(Pace<N>, f64)> {
        loop {
            let length = self.length;
            let next = self
                .at(length)
                .filter(|next| next.direction.dot(&self.pace.direction) > TURN);
            let Some(next) = next else {
                // Often a node's plane lies badly: nodes elsewhere may do.
                if !self.fresh {
                    self.cut()?;
                    continue;
                }
                self.length *= SHORTER;
                if self.length < SHORTEST {
                    return None;
                }
                continue;
            };
            self.fresh = false;
            if next.here.iterations <= EASY {
                self.length = (length * LONGER).min(self.path.longest);
            } else if next.here.iterations > EASY + 2 {
                self.length *= SHORTER;
            }
            let before = std::mem::replace(&mut self.pace, next);
            return Some((before, length));
        }
    }

    /// Cuts the orbit's arcs anew where they have become uneven. After that the walk's last orbit has other nodes than the one
    /// before.
    pub fn mesh(&mut self) -> Option<()> {
        if uneven(&self.pace.here) {
            self.cut()
        } else {
            Some(())
        }
    }

    fn cut(&mut self) -> Option<()> {
        let Pace { here, direction } = &self.pace;
        let site = &here.site;
        let field = self.corrector.family.field(site.at);
        let polygon = site
            .polygon
            .cut(&mut self.corrector.tracer, &*field, &Mesh::FINE)
            .ok()?;
        drop(field);
        let old = direction.seen_from_afar(&site.polygon);
        let site = Site {
            polygon,
            at: site.at,
        };
        self.pace = self.arrived(site, old)?;
        self.fresh = true;
        Some(())
    }

    /// At an orbit that has other nodes than those before, going on in the direction that looked so from afar.
    fn arrived(&mut self, site: Site<N>, old: [f64; 3]) -> Option<Pace<N>> {
        let own: Vec<Condition<'_, N>> = self
            .path
            .indicator
            .map(Condition::Indicator)
            .into_iter()
            .collect();
        let here = self.corrector.look(site, &self.path.free, &own)?;
        let any = here.along.first()?.clone();
        let mut direction = self.path.direction(&here, &any)?;
        let new = direction.seen_from_afar(&here.site.polygon);
        let along: f64 = old.iter().zip(&new).map(|(a, b)| a * b).sum();
        if along < 0.0 {
            direction = direction.scaled(-1.0);
        }
        Some(Pace { here, direction })
    }
}

/// Whether arcs take far more work than the others or than they should, or grow by too much.
fn uneven<const N: usize>(orbit: &Regular<N>) -> bool {
    /// Steps of an arc over the mean, and of the mean over what it should be, either way.
    const WORST: f64 = 2.5;
    const MEAN: f64 = 1.6;
    /// ln of an arc's largest growth: beyond, Newton's method converges from nearby only.
    const GROWTH: f64 = 7.0;
    let arcs = &orbit.linear.arcs;
    let count = arcs.len() as f64;
    let mean = arcs.iter().map(|arc| arc.steps).sum::<usize>() as f64 / count;
    let worst = arcs.iter().map(|arc| arc.steps).max().unwrap_or(0) as f64;
    let maps = orbit.linear.maps.iter();
    let growth = maps.map(|map| map.amax()).fold(0.0, f64::max).ln();
    let least = arcs.len() <= Mesh::FINE.nodes.0;
    let coarse = mean > MEAN * Mesh::FINE.steps;
    // The volume cuts arcs too, so that few steps alone are no fault.
    let fine = mean < Mesh::FINE.steps / (MEAN * MEAN * MEAN) && !least;
    worst > WORST * mean + 1.0 || coarse || fine || growth > GROWTH
}
