//! Along a curve of orbits: pseudo-arclength continuation of a branch, one parameter free, or of a bifurcation, with both.

use super::correct::{Condition, Corrector, Goal, Regular};
use super::family::Family;
use super::indicator::Indicator;
use super::linear::Linear;
use super::motion::{Motion, Site};
use super::polygon::Mesh;
use crate::error::{Error, Result};
use std::collections::VecDeque;
use std::fmt;

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

/// Lengths of the first and of the shortest steps; of orbits smaller than 1 the shortest is this part of their extent.
const FIRST: f64 = 0.02;
const SHORTEST: f64 = 1e-7;
/// So many steps in a row that do not grow and together are shorter than this part of the way so far are no progress.
const WINDOW: usize = 12;
const PROGRESS: f64 = 1e-3;
/// What a prediction may be off by, which grows with the square of the step; and the least and largest ratio of one step to
/// the one before.
const OFF: f64 = 0.03;
const RATIO: (f64, f64) = (0.5, 2.0);
/// A step that fails is shortened to this.
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
    /// How often they have been.
    cuts: usize,
    /// The way so far, and the last steps' lengths.
    travelled: f64,
    lengths: VecDeque<f64>,
}

/// Why a walk goes no further.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Stop {
    /// Newton's method fails, down to steps of this length.
    NoOrbit {
        /// The length of the last step that was tried.
        length: f64,
    },
    /// Steps succeed, but lead nowhere.
    NoProgress {
        /// The length of so many steps together.
        steps: usize,
        /// What they add up to.
        length: f64,
        /// The length of the whole way.
        travelled: f64,
    },
    /// So many steps of the integrator are used up: as many as it was given.
    UsedUp {
        /// That number.
        steps: usize,
    },
    /// The orbit can't be cut into arcs anew: the flow along it, or its linear equations fail.
    NoNodes,
}

impl fmt::Display for Stop {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Stop::NoOrbit { length } => write!(
                f,
                "Newton's method finds no next orbit, down to steps of {length:.1e}"
            ),
            Stop::NoProgress {
                steps,
                length,
                travelled,
            } => write!(
                f,
                "no progress: the last {steps} steps are {length:.1e} long together, the way before {travelled:.1e}"
            ),
            Stop::UsedUp { steps } => {
                write!(f, "the bound of {steps} steps of the integrator is used up")
            }
            Stop::NoNodes => write!(
                f,
                "the orbit can't be cut into arcs anew: the integration along it fails"
            ),
        }
    }
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
        let sign = if direction.dot(before) < 0.0 {
            -1.0
        } else {
            1.0
        };
        Some(direction.scaled(sign))
    }
}

impl<'c, 'f, F: Family<N>, const N: usize> Walk<'c, 'f, F, N> {
    /// From an orbit nearby into a direction: the first correction is across it.
    ///
    /// # Errors
    /// Those of [`Corrector::correct`].
    pub fn from(
        corrector: &'c mut Corrector<'f, F, N>,
        path: Path,
        site: Site<N>,
        direction: Motion<N>,
    ) -> Result<Self> {
        let conditions = path.and(Condition::Plane(&direction, &site));
        let here = corrector.correct(site.clone(), &path.free, &conditions, Goal::STEP)?;
        let direction = path.direction(&here, &direction).ok_or_else(no_direction)?;
        Ok(Walk {
            corrector,
            pace: Pace { here, direction },
            length: FIRST.min(path.longest),
            path,
            fresh: false,
            cuts: 0,
            travelled: 0.0,
            lengths: VecDeque::new(),
        })
    }

    /// From an orbit, in the direction that looks so from afar: after a change of variables.
    pub fn resumed(
        corrector: &'c mut Corrector<'f, F, N>,
        path: Path,
        site: Site<N>,
        afar: [f64; 3],
        (length, travelled): (f64, f64),
    ) -> Option<Self> {
        // Closed in the new variables, with the parameter in which it moves most held.
        let fixed = if afar[1].abs() > afar[0].abs() && path.free.contains(&1) {
            1
        } else {
            path.free[0]
        };
        let held = Condition::Parameter(fixed, site.at[fixed]);
        let here = corrector
            .correct(site, &path.free, &path.and(held), Goal::STEP)
            .ok()?;
        let mut walk = Walk {
            pace: Pace {
                direction: here.along[0].clone(),
                here,
            },
            corrector,
            path,
            length,
            fresh: false,
            cuts: 0,
            travelled,
            lengths: VecDeque::new(),
        };
        let site = walk.pace.here.site.clone();
        let linear = walk.pace.here.linear.clone();
        walk.pace = walk.arrived(site, linear, afar)?;
        walk.cut()?;
        Some(walk)
    }

    /// The length of the way so far.
    pub fn travelled(&self) -> f64 {
        self.travelled
    }

    /// How often the nodes have been cut anew.
    pub fn cuts(&self) -> usize {
        self.cuts
    }

    /// What of the walk's direction does not depend on the variables: the change of the parameters and of ln T.
    pub fn afar(&self) -> [f64; 3] {
        let Pace { here, direction } = &self.pace;
        direction.seen_from_afar(&here.site.polygon)
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
        // The gradients there, and not those of the orbit here: the direction depends on them.
        let next = self
            .corrector
            .correct(predicted.clone(), &self.path.free, &conditions, Goal::STEP)
            .ok()?;
        let along = self.path.direction(&next, direction)?;
        Some(Pace {
            here: next,
            direction: along,
        })
    }

    /// Whether the last steps lead nowhere: measured by the way so far, whatever the units of the variables.
    fn progresses(&self) -> Result<(), Stop> {
        let length: f64 = self.lengths.iter().sum();
        let grow = self.lengths.back() > self.lengths.front();
        if self.lengths.len() < WINDOW || grow || length > PROGRESS * self.travelled {
            return Ok(());
        }
        Err(Stop::NoProgress {
            steps: WINDOW,
            length,
            travelled: self.travelled,
        })
    }

    /// The next orbit, which the walk then stands at; returns where it stood and how far that was.
    ///
    /// # Errors
    /// Why there is none.
    pub fn step(&mut self) -> Result<(Pace<N>, f64), Stop> {
        self.progresses()?;
        loop {
            let length = self.length;
            let next = self
                .at(length)
                .filter(|next| next.direction.dot(&self.pace.direction) > TURN);
            let Some(next) = next else {
                // Often a node's plane lies badly: nodes elsewhere may do.
                if let Some(steps) = self.corrector.tracer.used_up() {
                    return Err(Stop::UsedUp { steps });
                }
                if !self.fresh {
                    self.cut().ok_or(Stop::NoNodes)?;
                    continue;
                }
                self.length *= SHORTER;
                let extent = self.pace.here.site.polygon.extent();
                if self.length < SHORTEST * extent.min(1.0) {
                    return Err(Stop::NoOrbit { length });
                }
                continue;
            };
            self.fresh = false;
            let ratio = (OFF / next.here.first).sqrt().clamp(RATIO.0, RATIO.1);
            self.length = (length * ratio).min(self.path.longest);
            let before = std::mem::replace(&mut self.pace, next);
            self.travelled += length;
            self.lengths.push_back(length);
            if self.lengths.len() > WINDOW {
                self.lengths.pop_front();
            }
            return Ok((before, length));
        }
    }

    /// Cuts the orbit's arcs anew where they have become uneven. After that the walk's last orbit has other nodes than the one
    /// before.
    ///
    /// # Errors
    /// [`Stop::NoNodes`].
    pub fn mesh(&mut self) -> Result<(), Stop> {
        if uneven(&self.pace.here) {
            self.cut().ok_or(Stop::NoNodes)
        } else {
            Ok(())
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
        let mut site = Site {
            polygon,
            at: site.at,
        };
        let mut linear = self.corrector.linear(&site)?;
        for _ in 0..SPLITS {
            if linear.growth().all(|growth| growth < GROWTH) {
                break;
            }
            let parts = linear.parts(GROWTH);
            let field = self.corrector.family.field(site.at);
            let tracer = &mut self.corrector.tracer;
            site.polygon = site.polygon.split(tracer, &*field, &parts).ok()?;
            drop(field);
            linear = self.corrector.linear(&site)?;
        }
        let scale = self.corrector.family.scale(site.at);
        let (_, along) = linear.solutions(&self.path.free, scale)?;
        let first = most_moved(&along);
        site.polygon = site.polygon.beginning_at(first);
        self.pace = self.arrived(site, linear.beginning_at(first), old)?;
        self.fresh = true;
        self.cuts += 1;
        Some(())
    }

    /// At an orbit that has other nodes than those before, going on in the direction that looked so from afar.
    fn arrived(&mut self, site: Site<N>, linear: Linear<N>, old: [f64; 3]) -> Option<Pace<N>> {
        let own: Vec<Condition<'_, N>> = self
            .path
            .indicator
            .map(Condition::Indicator)
            .into_iter()
            .collect();
        let here = self
            .corrector
            .look_with(site, linear, &self.path.free, &own)?;
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

/// Where the walk begins the path has no direction.
fn no_direction() -> Error {
    Error::NotConverged {
        what: "the direction of the curve",
        iterations: 0,
        residual: f64::INFINITY,
        tolerance: Goal::STEP.done,
    }
}

/// ln of what an arc of a new mesh may grow by, and one of an old mesh.
const GROWTH: f64 = 5.0;
const GROWN: f64 = 8.0;
/// How often arcs are split for it.
const SPLITS: usize = 6;

/// The node that the motions left to the orbit move most. All others are found from the first one: from the small end of a
/// motion that grows by many decades nothing is found.
fn most_moved<const N: usize>(along: &[Motion<N>]) -> usize {
    let moved = |k: usize| -> f64 {
        let each = along.iter().map(|motion| motion.nodes[k].norm_squared());
        each.sum()
    };
    let count = along.first().map_or(0, |motion| motion.nodes.len());
    (0..count)
        .max_by(|&a, &b| moved(a).total_cmp(&moved(b)))
        .unwrap_or(0)
}

/// Whether arcs take far more work than the others or than they should, or grow by too much.
fn uneven<const N: usize>(orbit: &Regular<N>) -> bool {
    /// Steps of an arc over the mean, and of the mean over what it should be.
    const WORST: f64 = 2.5;
    const MEAN: f64 = 1.6;
    let arcs = &orbit.linear.arcs;
    let count = arcs.len() as f64;
    let mean = arcs.iter().map(|arc| arc.steps).sum::<usize>() as f64 / count;
    let worst = arcs.iter().map(|arc| arc.steps).max().unwrap_or(0) as f64;
    let most = mean.max(Mesh::FINE.steps);
    worst > WORST * most
        || mean > MEAN * Mesh::FINE.steps
        || orbit.linear.growth().any(|g| g > GROWN)
}
