//! Pseudo-arclength continuation of periodic orbits: along a branch, one parameter free, or a curve of bifurcations, with both.

use super::continuation_point::{ContinuationPoint, TangentVector};
use super::correct::{Condition, Corrector, Goal, Regular};
use super::family::ParametrisedField;
use super::linear::Linear;
use super::shooting_nodes::ShootingMesh;
use super::test_function::TestFunction;
use crate::error::{Error, Result};
use std::collections::VecDeque;
use std::fmt;

/// Where a continuation stands.
#[derive(Debug, Clone)]
#[non_exhaustive]
pub struct DirectedPoint<const N: usize> {
    /// The orbit and its surroundings.
    pub here: Regular<N>,
    /// The direction of the continuation.
    pub direction: TangentVector<N>,
}

/// What is followed.
#[derive(Debug, Clone, PartialEq)]
pub struct PalcSettings {
    /// The free parameters: one for a branch, both for a bifurcation.
    pub free: Vec<usize>,
    /// The bifurcation.
    pub test_function: Option<TestFunction>,
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

/// A continuation with its next step's length.
pub struct Palc<'c, 'f, F, const N: usize> {
    /// What makes its orbits.
    pub corrector: &'c mut Corrector<'f, F, N>,
    /// What it is along.
    pub settings: PalcSettings,
    /// Where it stands.
    pub now: DirectedPoint<N>,
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

/// Why a continuation goes no further.
#[derive(Debug, Clone, Copy, PartialEq)]
#[non_exhaustive]
pub enum PalcEnd {
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

impl fmt::Display for PalcEnd {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            PalcEnd::NoOrbit { length } => write!(
                f,
                "Newton's method finds no next orbit, down to steps of {length:.1e}"
            ),
            PalcEnd::NoProgress {
                steps,
                length,
                travelled,
            } => write!(
                f,
                "no progress: the last {steps} steps are {length:.1e} long together, the way before {travelled:.1e}"
            ),
            PalcEnd::UsedUp { steps } => {
                write!(f, "the bound of {steps} steps of the integrator is used up")
            }
            PalcEnd::NoNodes => write!(
                f,
                "the orbit can't be cut into arcs anew: the integration along it fails"
            ),
        }
    }
}

impl PalcSettings {
    /// A branch along this parameter.
    pub fn branch(parameter: usize, longest: f64) -> Self {
        PalcSettings {
            free: vec![parameter],
            test_function: None,
            longest,
        }
    }

    /// A curve of bifurcations.
    pub fn locus(test_function: TestFunction, longest: f64) -> Self {
        PalcSettings {
            free: vec![0, 1],
            test_function: Some(test_function),
            longest,
        }
    }

    /// The curve's own conditions and one more.
    pub fn and<'a, const N: usize>(&self, last: Condition<'a, N>) -> Vec<Condition<'a, N>> {
        let own = self.test_function.map(Condition::TestFunction);
        own.into_iter().chain([last]).collect()
    }

    /// The direction of the curve at an orbit, with the sign that makes the product with `before` positive.
    pub fn direction<const N: usize>(
        &self,
        at: &Regular<N>,
        before: &TangentVector<N>,
    ) -> Option<TangentVector<N>> {
        let direction = match (&at.along[..], at.gradients.first()) {
            ([only], _) => only.clone(),
            // Where the test function does not change.
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

impl<'c, 'f, F: ParametrisedField<N>, const N: usize> Palc<'c, 'f, F, N> {
    /// From an orbit nearby into a direction: the first correction is across it.
    ///
    /// # Errors
    /// Those of [`Corrector::correct`].
    pub fn from(
        corrector: &'c mut Corrector<'f, F, N>,
        settings: PalcSettings,
        site: ContinuationPoint<N>,
        direction: TangentVector<N>,
    ) -> Result<Self> {
        let conditions = settings.and(Condition::Plane(&direction, &site));
        let here = corrector.correct(site.clone(), &settings.free, &conditions, Goal::STEP)?;
        let direction = settings
            .direction(&here, &direction)
            .ok_or_else(no_direction)?;
        Ok(Palc {
            corrector,
            now: DirectedPoint { here, direction },
            length: FIRST.min(settings.longest),
            settings,
            fresh: false,
            cuts: 0,
            travelled: 0.0,
            lengths: VecDeque::new(),
        })
    }

    /// From an orbit, in the direction that looks so from afar: after a change of variables.
    pub(crate) fn resumed(
        corrector: &'c mut Corrector<'f, F, N>,
        settings: PalcSettings,
        site: ContinuationPoint<N>,
        afar: [f64; 3],
        (length, travelled): (f64, f64),
    ) -> Option<Self> {
        // Closed in the new variables, with the parameter in which it moves most held.
        let fixed = if afar[1].abs() > afar[0].abs() && settings.free.contains(&1) {
            1
        } else {
            settings.free[0]
        };
        let held = Condition::Parameter(fixed, site.at[fixed]);
        let here = corrector
            .correct(site, &settings.free, &settings.and(held), Goal::STEP)
            .ok()?;
        let mut palc = Palc {
            now: DirectedPoint {
                direction: here.along[0].clone(),
                here,
            },
            corrector,
            settings,
            length,
            fresh: false,
            cuts: 0,
            travelled,
            lengths: VecDeque::new(),
        };
        let site = palc.now.here.site.clone();
        let linear = palc.now.here.linear.clone();
        palc.now = palc.arrived(site, linear, afar)?;
        palc.cut()?;
        Some(palc)
    }

    /// The length of the way so far.
    pub(crate) fn travelled(&self) -> f64 {
        self.travelled
    }

    /// How often the nodes have been cut anew.
    pub(crate) fn cuts(&self) -> usize {
        self.cuts
    }

    /// What of the continuation's direction does not depend on the variables: the change of the parameters and of ln T.
    pub(crate) fn afar(&self) -> [f64; 3] {
        let DirectedPoint { here, direction } = &self.now;
        direction.seen_from_afar(&here.site.shooting)
    }

    /// The same, backwards.
    pub fn turned(mut self) -> Self {
        self.now.direction = self.now.direction.scaled(-1.0);
        self
    }

    /// The orbit at this distance along the direction.
    pub(crate) fn correct_at(&mut self, length: f64) -> Option<DirectedPoint<N>> {
        let now = self.now.clone();
        self.correct_from(&now, length)
    }

    /// The orbit at this distance from where the continuation once stood, along the direction there.
    pub(crate) fn correct_from(
        &mut self,
        now: &DirectedPoint<N>,
        length: f64,
    ) -> Option<DirectedPoint<N>> {
        let DirectedPoint { here, direction } = now;
        let predicted = here.site.moved(direction, length);
        let conditions = self.settings.and(Condition::Plane(direction, &predicted));
        // The gradients there, and not those of the orbit here: the direction depends on them.
        let next = self
            .corrector
            .correct(
                predicted.clone(),
                &self.settings.free,
                &conditions,
                Goal::STEP,
            )
            .ok()?;
        let along = self.settings.direction(&next, direction)?;
        Some(DirectedPoint {
            here: next,
            direction: along,
        })
    }

    /// Whether the last steps lead nowhere: measured by the way so far, whatever the units of the variables.
    fn progresses(&self) -> Result<(), PalcEnd> {
        let length: f64 = self.lengths.iter().sum();
        let grow = self.lengths.back() > self.lengths.front();
        if self.lengths.len() < WINDOW || grow || length > PROGRESS * self.travelled {
            return Ok(());
        }
        Err(PalcEnd::NoProgress {
            steps: WINDOW,
            length,
            travelled: self.travelled,
        })
    }

    /// The next orbit, which the continuation then stands at; returns where it stood and how far that was.
    ///
    /// # Errors
    /// Why there is none.
    pub fn step(&mut self) -> Result<(DirectedPoint<N>, f64), PalcEnd> {
        self.progresses()?;
        loop {
            let length = self.length;
            let next = self
                .correct_at(length)
                .filter(|next| next.direction.dot(&self.now.direction) > TURN);
            let Some(next) = next else {
                // Often a node's plane lies badly: nodes elsewhere may do.
                if let Some(steps) = self.corrector.tracer.used_up() {
                    return Err(PalcEnd::UsedUp { steps });
                }
                if !self.fresh {
                    self.cut().ok_or(PalcEnd::NoNodes)?;
                    continue;
                }
                self.length *= SHORTER;
                let extent = self.now.here.site.shooting.extent();
                if self.length < SHORTEST * extent.min(1.0) {
                    return Err(PalcEnd::NoOrbit { length });
                }
                continue;
            };
            self.fresh = false;
            let ratio = (OFF / next.here.first).sqrt().clamp(RATIO.0, RATIO.1);
            self.length = (length * ratio).min(self.settings.longest);
            let before = std::mem::replace(&mut self.now, next);
            self.travelled += length;
            self.lengths.push_back(length);
            if self.lengths.len() > WINDOW {
                self.lengths.pop_front();
            }
            return Ok((before, length));
        }
    }

    /// Cuts the orbit's arcs anew where they have become uneven. After that the continuation's last orbit has other nodes than the one
    /// before.
    ///
    /// # Errors
    /// [`PalcEnd::NoNodes`].
    pub(crate) fn mesh(&mut self) -> Result<(), PalcEnd> {
        if uneven(&self.now.here) {
            self.cut().ok_or(PalcEnd::NoNodes)
        } else {
            Ok(())
        }
    }

    fn cut(&mut self) -> Option<()> {
        let DirectedPoint { here, direction } = &self.now;
        let site = &here.site;
        let field = self.corrector.family.field(site.at);
        let shooting = site
            .shooting
            .cut(&mut self.corrector.tracer, &*field, &ShootingMesh::FINE)
            .ok()?;
        drop(field);
        let old = direction.seen_from_afar(&site.shooting);
        let mut site = ContinuationPoint {
            shooting,
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
            site.shooting = site.shooting.split(tracer, &*field, &parts).ok()?;
            drop(field);
            linear = self.corrector.linear(&site)?;
        }
        let scale = self.corrector.family.scale(site.at);
        let (_, along) = linear.solutions(&self.settings.free, scale)?;
        let first = most_moved(&along);
        site.shooting = site.shooting.beginning_at(first);
        self.now = self.arrived(site, linear.beginning_at(first), old)?;
        self.fresh = true;
        self.cuts += 1;
        Some(())
    }

    /// At an orbit that has other nodes than those before, going on in the direction that looked so from afar.
    fn arrived(
        &mut self,
        site: ContinuationPoint<N>,
        linear: Linear<N>,
        old: [f64; 3],
    ) -> Option<DirectedPoint<N>> {
        let own: Vec<Condition<'_, N>> = self
            .settings
            .test_function
            .map(Condition::TestFunction)
            .into_iter()
            .collect();
        let here = self
            .corrector
            .look_with(site, linear, &self.settings.free, &own)?;
        let any = here.along.first()?.clone();
        let mut direction = self.settings.direction(&here, &any)?;
        let new = direction.seen_from_afar(&here.site.shooting);
        let along: f64 = old.iter().zip(&new).map(|(a, b)| a * b).sum();
        if along < 0.0 {
            direction = direction.scaled(-1.0);
        }
        Some(DirectedPoint { here, direction })
    }
}

/// Where the continuation begins the curve has no direction.
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

/// The node that the tangent vectors left to the orbit move most. All others are found from the first one: from the small end of a
/// tangent vector that grows by many decades nothing is found.
fn most_moved<const N: usize>(along: &[TangentVector<N>]) -> usize {
    let moved = |k: usize| -> f64 {
        let each = along.iter().map(|tangent| tangent.nodes[k].norm_squared());
        each.sum()
    };
    let count = along.first().map_or(0, |tangent| tangent.nodes.len());
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
    let most = mean.max(ShootingMesh::FINE.steps);
    worst > WORST * most
        || mean > MEAN * ShootingMesh::FINE.steps
        || orbit.linear.growth().any(|g| g > GROWN)
}
