//! Branches and curves of bifurcations of any system with named parameters, from its fields alone.
//!
//! Equilibria begin at those that the system knows at both ends of a range, and go on through branch points; orbits begin at the
//! Hopf points met on them, or at an orbit that is given. What is met is told as it comes.

pub(super) mod curves;
pub(super) mod equilibria;
mod multiple;
mod runaway;
pub(super) mod splits;

pub use super::orbits::{HopfBeginning, OrbitSeeds, orbit_curves, orbits};
pub use curves::equilibrium_curves;
pub(super) use curves::{Exchanged, in_order};
pub use equilibria::equilibria;
pub use splits::WithinClusters;

use super::orbits::SpecialOrbit;
use super::{Criticality, Label, less_accurate, zero_note};
use crate::bifurcation::equilibria::generic_crossing::BranchCrossing;
use crate::bifurcation::equilibria::generic_curve::EquilibriumBifurcation;
use crate::bifurcation::equilibria::normal_form::NormalFormCoefficient;
use crate::equilibrium::{Symmetry, Verdict};
use crate::error::{Error, Result};
use crate::field::Vector;
use crate::number::Uncertain;
use crate::orbit::{
    ContinuationPoint, ParametrisedField, ShootingNodes, Solution, TestFunction, WithinCluster,
};
use nalgebra::Complex;
use std::cmp::Ordering;
use std::ops::ControlFlow;

/// Points nearer to each other than this, in units of 1 + |x|, are one; so are orbits whose coordinates, and ln T, differ by less.
pub(super) const SAME: f64 = 1e-6;
/// The parameter that varies along a branch, among the coordinates.
pub(super) const FREE: usize = 0;

/// The equilibria that are known at some coordinates of the parameters.
pub type KnownEquilibria<'a> = &'a (dyn Fn([f64; 2]) -> Result<Vec<Vector>> + Sync);

/// The range of a variable in a box that branches of equilibria do not leave.
#[derive(Debug, Clone, PartialEq)]
pub struct StateRange {
    /// The least and the greatest value.
    pub range: (f64, f64),
    /// What is said of a branch that leaves it at either of these.
    pub said: [String; 2],
}

/// The Hopf points of equilibria of a symmetry, by their coordinate.
pub type KnownHopfPoints<'a> = &'a dyn Fn(Symmetry) -> Result<Vec<HopfBeginning>>;

/// Periodic orbits that can be found at values of the parameter that varies.
#[derive(Clone, Copy)]
pub struct FoundOrbits<'a> {
    /// Those at a coordinate of it.
    pub at: &'a dyn Fn(f64) -> Vec<ContinuationPoint>,
    /// A coordinate other than the ends of the range at which they may be looked for.
    pub within: Option<f64>,
}

/// A system over one or two of its parameters.
#[derive(Clone, Copy)]
pub struct GeneralSystem<'a> {
    /// Its fields.
    pub family: &'a dyn ParametrisedField,
    /// Of two equal parts the family of states in which they move alike, in the same coordinates.
    pub alike: Option<&'a dyn ParametrisedField>,
    /// For two equal parts, the family in variables that keep the digits of their difference.
    pub difference: Option<&'a dyn ParametrisedField>,
    /// Groups of parts, each by its variables, whose exchange changes nothing: solutions that are mirror images of each other are one.
    pub interchangeable: &'a [Vec<Vec<usize>>],
    /// The names of the parameters, by which fields know their derivatives.
    pub names: [&'a str; 2],
    /// Where branches of equilibria begin.
    pub equilibria: KnownEquilibria<'a>,
    /// Where they end, for each variable; empty where nothing bounds them.
    pub bounds: &'a [StateRange],
}

/// A branch that is asked for. All values of parameters are coordinates of the family.
#[derive(Clone)]
pub struct GeneralBranch<'a> {
    /// The system; the first parameter varies.
    pub system: GeneralSystem<'a>,
    /// From where to where; the larger one may come first.
    pub range: (f64, f64),
    /// Where orbits may begin, at a Hopf point, if there is none in the range; it holds the range.
    pub beyond: (f64, f64),
    /// The second coordinate.
    pub held: f64,
    /// Values to land on.
    pub at: Vec<f64>,
    /// The user's functions of its solutions whose zeros are special points, as `EXPRESSION` or `EXPRESSION = VALUE`: those of the families, in this
    /// order.
    pub watch: Vec<String>,
    /// An orbit at the beginning of the range, where one is known.
    pub orbit: Option<ContinuationPoint>,
    /// Where orbits begin if no Hopf point leads to any.
    pub found: Option<FoundOrbits<'a>>,
    /// The Hopf points of two equal parts, where they are known without branches of equilibria.
    pub hopfs: Option<KnownHopfPoints<'a>>,
    /// For two equal parts: one symmetry, or both.
    pub symmetry: Option<Symmetry>,
    /// How many times orbits may double their period.
    pub doublings: usize,
    /// Of interfaces in clusters what a split of each grows by.
    pub within: Option<WithinClusters<'a>>,
    /// How it is followed.
    pub following: GeneralFollowing,
}

/// A curve of bifurcations that is asked for, in the plane of both parameters.
#[derive(Clone)]
pub struct GeneralCurve<'a> {
    /// The system.
    pub system: GeneralSystem<'a>,
    /// What bifurcates.
    pub kind: GeneralBifurcation,
    /// From where to where in both.
    pub ranges: [(f64, f64); 2],
    /// As of a branch, in both.
    pub beyond: [(f64, f64); 2],
    /// Values to land on.
    pub at: [Vec<f64>; 2],
    /// As of a branch.
    pub watch: Vec<String>,
    /// An orbit with its coordinates, where one is known.
    pub orbit: Option<ContinuationPoint>,
    /// The orbits that a search finds at two coordinates: homoclinic orbits are looked for on their branches where there are no Hopf points.
    pub found: Option<&'a (dyn Fn([f64; 2]) -> Vec<ContinuationPoint> + Sync)>,
    /// The coordinates of the system's own values, where it has such in the ranges: where homoclinic orbits are looked for first.
    pub own: Option<[f64; 2]>,
    /// The point of codimension two at which the curves begin, where one is given: others are not looked for.
    pub begin: Option<GeneralPoint>,
    /// Where curves of orbits begin, where that is known otherwise than from branches of orbits.
    pub seeds: Option<&'a dyn OrbitSeeds>,
    /// For two equal parts: orbits of one symmetry, or of both.
    pub symmetry: Option<Symmetry>,
    /// Where the way is told that bifurcations of orbits go.
    pub criticality: Classified,
    /// How it is followed.
    pub following: GeneralFollowing,
}

/// The points of a curve at which the way is told that a bifurcation of orbits goes: a normal form takes as long as some points.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Classified {
    /// None.
    Never,
    /// Special points.
    Special,
    /// All.
    Every,
}

/// How branches and curves are followed.
#[derive(Debug, Clone, PartialEq)]
pub struct GeneralFollowing {
    /// Factor on the step limits.
    pub step: f64,
    /// Numbers of branches that are known already and not told of again.
    pub skip: Vec<usize>,
    /// More points than this are an error, of all branches together.
    pub max_points: usize,
}

/// What bifurcates along a curve.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum GeneralBifurcation {
    /// Equilibria.
    Equilibrium(EquilibriumBifurcation),
    /// Orbits.
    Orbit(TestFunction),
    /// None: the curve is of the orbits at which the first of the user's functions that are watched vanishes.
    Held,
    /// Homoclinic orbits, in all of their points.
    Homoclinic,
}

/// What is found at a point.
#[derive(Debug, Clone, PartialEq)]
pub enum GeneralSolution {
    /// An equilibrium.
    Equilibrium {
        /// Its state.
        state: Vector,
        /// By real part, the largest first.
        eigenvalues: Vec<Complex<f64>>,
    },
    /// A periodic orbit.
    Orbit {
        /// Its nodes.
        shooting: ShootingNodes,
        /// ln |mu| of its nontrivial multipliers, the largest first.
        log_multipliers: Vec<f64>,
        /// Below this the largest is none that decides.
        neutral: f64,
    },
}

/// A point of a branch or of a curve.
#[derive(Debug, Clone, PartialEq)]
#[non_exhaustive]
pub struct GeneralPoint {
    /// The number of the branch or curve, from 0.
    pub number: usize,
    /// What is special here.
    pub label: Option<Label>,
    /// For two equal parts, whether both move in phase on the branch or curve, where that is known.
    pub symmetry: Option<Symmetry>,
    /// The coordinates.
    pub at: [f64; 2],
    /// The parameters; of points that are not special their uncertainty is not known.
    pub parameters: [Uncertain; 2],
    /// What is there.
    pub solution: GeneralSolution,
    /// The period of the orbit, or of the oscillation at a Hopf point.
    pub period: Option<Uncertain>,
    /// The angle of the multipliers of a torus bifurcation, over pi.
    pub angle_over_pi: Option<f64>,
    /// How branches of equilibria cross at a branch point.
    pub crossing: Option<BranchCrossing>,
    /// At a branch point or Hopf point of equilibria, how many eigenvalues, or pairs, are on the imaginary axis together.
    pub multiplicity: Option<usize>,
    /// Where the period grows without bound, whether that is at a saddle-node on the cycle.
    pub saddle_node: bool,
    /// To which side the bifurcation goes.
    pub criticality: Option<Criticality>,
    /// The normal form's coefficient.
    pub coefficient: Option<f64>,
    /// It may be off by this, where that is known.
    pub coefficient_uncertainty: Option<f64>,
    /// Of equilibria at points of codimension two the coefficients of the normal form, where they are known.
    pub normal_form: Vec<NormalFormCoefficient>,
    /// Of interfaces in clusters what a small split of each that can split grows by: ln mu on an orbit, an eigenvalue at an equilibrium.
    pub within: Vec<WithinCluster>,
    /// What else is to be said.
    pub note: Option<String>,
    /// Of a special orbit that is known in its last digits, what is needed to compute it once more.
    pub orbit: Option<SpecialOrbit>,
}

impl GeneralSolution {
    /// The same as functions of it see it.
    pub fn seen(&self, period: Option<f64>) -> Solution<'_> {
        match self {
            GeneralSolution::Equilibrium { state, .. } => Solution::Equilibrium { state, period },
            GeneralSolution::Orbit { shooting, .. } => Solution::Orbit(shooting),
        }
    }

    /// Whether the last two of three variables, or the one that stands for both, are equal all along.
    pub fn symmetry(&self) -> Symmetry {
        match self {
            GeneralSolution::Equilibrium { state, .. } => {
                let apart = (state[1] - state[state.len() - 1]).abs();
                match apart < SAME * (1.0 + state[1].abs()) {
                    true => Symmetry::Symmetric,
                    false => Symmetry::Asymmetric,
                }
            }
            GeneralSolution::Orbit { shooting, .. } => symmetry_of(shooting),
        }
    }
}

/// Whether the last two of three variables of an orbit, or the one that stands for both, are equal all along.
pub(super) fn symmetry_of(shooting: &ShootingNodes) -> Symmetry {
    /// A difference along an orbit as a part of how far it goes: beside a pitchfork, where the difference is neutral, Newton's method leaves
    /// about the third root of its tolerance.
    const NEUTRAL: f64 = 1e-4;
    let apart = |x: &Vector| (x[1] - x[x.len() - 1]).abs();
    let apart = shooting.nodes.iter().map(apart).fold(0.0, f64::max);
    match apart < NEUTRAL * shooting.extents()[1] {
        true => Symmetry::Symmetric,
        false => Symmetry::Asymmetric,
    }
}

impl GeneralSystem<'_> {
    /// Whether there are solutions of this symmetry.
    pub(super) fn has(&self, symmetry: Symmetry) -> bool {
        let alike = self.alike.map(ParametrisedField::dimension);
        match symmetry {
            Symmetry::Symmetric => alike.is_some(),
            Symmetry::Asymmetric => alike.is_none_or(|alike| alike < self.family.dimension()),
        }
    }

    /// One of a solution and its mirror images, the same whichever is given: numbers of interchangeable parts in ascending order.
    pub(super) fn representative(&self, numbers: &Vector) -> Vector {
        let mut representative = numbers.clone();
        for group in self.interchangeable {
            let of_part = |part: &Vec<usize>| part.iter().map(|&i| numbers[i]).collect();
            let mut sorted: Vec<Vec<f64>> = group.iter().map(of_part).collect();
            sorted.sort_by(|one, other| {
                let pairs = one.iter().zip(other);
                let each = pairs.map(|(x, y)| x.total_cmp(y));
                each.fold(Ordering::Equal, Ordering::then)
            });
            for (part, numbers) in group.iter().zip(sorted) {
                for (&i, x) in part.iter().zip(numbers) {
                    representative[i] = x;
                }
            }
        }
        representative
    }

    /// Whether a branch that has come from one point to another has its own mirror image before it: just two interchangeable parts, which
    /// differed, have become equal.
    fn mirrors(&self, from: &Vector, here: &Vector) -> bool {
        let equal = |x: &Vector, one: &[usize], other: &[usize]| {
            let same = |(&i, &j): (&usize, &usize)| (x[i] - x[j]).abs() < SAME * (1.0 + x[i].abs());
            one.iter().zip(other).all(same)
        };
        let pairs = self.interchangeable.iter().flat_map(|group| {
            let firsts = group.iter().enumerate();
            firsts.flat_map(|(k, one)| group[k + 1..].iter().map(move |other| (one, other)))
        });
        let met = pairs.filter(|(one, other)| equal(here, one, other) && !equal(from, one, other));
        met.count() == 1
    }
}

/// What is found on the way.
#[derive(Debug, Clone, PartialEq)]
pub enum GeneralEvent {
    /// A point of a branch or curve.
    Row(GeneralPoint),
    /// A special point.
    Special(GeneralPoint),
}

/// Whether to go on.
pub type GeneralObserver<'a> = &'a mut dyn FnMut(GeneralEvent) -> ControlFlow<()>;

impl GeneralPoint {
    /// The point with a word in its note where one of its parameters is less accurate than was asked for, relative to these sizes.
    pub fn against(mut self, tolerance: f64, sizes: &[f64]) -> Self {
        let mut all = self.parameters.iter().zip(sizes);
        if all.any(|(x, size)| x.uncertainty > tolerance * size) {
            self.note = Some(less_accurate(self.note));
        }
        self
    }

    /// The same with which function is zero there.
    pub(super) fn at_zero_of(mut self, watch: &[String], which: usize) -> Self {
        self.note = watch.get(which).map(|text| zero_note(text));
        self
    }

    /// A point of a branch or curve of this number, of which no more is known.
    pub fn new(number: usize, at: [f64; 2], solution: GeneralSolution) -> Self {
        GeneralPoint {
            number,
            label: None,
            symmetry: None,
            at,
            parameters: [Uncertain::new(0.0, f64::INFINITY); 2],
            solution,
            period: None,
            angle_over_pi: None,
            crossing: None,
            multiplicity: None,
            saddle_node: false,
            criticality: None,
            coefficient: None,
            coefficient_uncertainty: None,
            normal_form: Vec::new(),
            within: Vec::new(),
            note: None,
            orbit: None,
        }
    }

    /// With the parameters of its coordinates, which may be off by so much.
    pub(super) fn placed(mut self, family: &dyn ParametrisedField, uncertainty: [f64; 2]) -> Self {
        let (values, scale) = (family.parameters(self.at), family.scale(self.at));
        for i in 0..2 {
            let off = uncertainty[i] * scale[i].abs() + 2.0 * f64::EPSILON * values[i].abs();
            self.parameters[i] = Uncertain::new(values[i], off);
        }
        self
    }

    /// Stability.
    pub fn verdict(&self) -> Verdict {
        let largest = match &self.solution {
            GeneralSolution::Equilibrium { eigenvalues, .. } => {
                eigenvalues.first().map_or(f64::NAN, |z| z.re)
            }
            GeneralSolution::Orbit {
                log_multipliers, ..
            } => log_multipliers.first().copied().unwrap_or(f64::NAN),
        };
        let neutral = self.neutral();
        let within = self.within.iter().map(|within| within.ln_abs.value);
        // Of what is not known nothing is larger.
        let larger = |a: f64, b: f64| if a > b || a.is_nan() { a } else { b };
        let largest = within.fold(largest, larger);
        if largest > neutral {
            Verdict::Unstable
        } else if largest < -neutral {
            Verdict::Stable
        } else {
            Verdict::Undecided
        }
    }

    /// How many eigenvalues of an equilibrium have positive real parts, those within clusters as often as they count.
    pub fn unstable(&self) -> Option<usize> {
        let GeneralSolution::Equilibrium { eigenvalues, .. } = &self.solution else {
            return None;
        };
        let neutral = self.neutral();
        let together = eigenvalues.iter().filter(|z| z.re > neutral).count();
        let within = self.within.iter().filter(|one| one.ln_abs.value > neutral);
        Some(together + within.map(|one| one.multiplicity).sum::<usize>())
    }

    /// Threshold below which the real part of an eigenvalue, or ln |mu|, counts as zero.
    fn neutral(&self) -> f64 {
        /// Rounding of an eigenvalue that is zero, as a fraction of the largest.
        const NEUTRAL: f64 = 1e-12;
        match &self.solution {
            GeneralSolution::Equilibrium { eigenvalues, .. } => {
                NEUTRAL * eigenvalues.iter().map(|z| z.norm()).fold(0.0, f64::max)
            }
            GeneralSolution::Orbit { neutral, .. } => *neutral,
        }
    }
}

/// Tells of rows as long as there are no more than allowed, and of those branches only that are asked for.
pub(super) struct Teller<'t> {
    seen: GeneralObserver<'t>,
    skip: &'t [usize],
    left: usize,
    limit: usize,
    beyond: bool,
    pub told: ControlFlow<()>,
}

impl<'t> Teller<'t> {
    pub fn new(seen: GeneralObserver<'t>, following: &'t GeneralFollowing) -> Self {
        Teller {
            seen,
            skip: &following.skip,
            left: following.max_points,
            limit: following.max_points,
            beyond: false,
            told: ControlFlow::Continue(()),
        }
    }

    pub fn tell(&mut self, event: GeneralEvent) -> ControlFlow<()> {
        self.told?;
        let (GeneralEvent::Row(point) | GeneralEvent::Special(point)) = &event;
        if self.skip.contains(&point.number) {
            return ControlFlow::Continue(());
        }
        if matches!(event, GeneralEvent::Row(_)) {
            self.beyond = self.left == 0;
            self.left = self.left.saturating_sub(1);
        }
        self.told = if self.beyond {
            ControlFlow::Break(())
        } else {
            (self.seen)(event)
        };
        self.told
    }

    /// A point, with a row, and special or not.
    pub fn point(&mut self, point: GeneralPoint, special: bool) -> ControlFlow<()> {
        match special {
            true => self.special(point),
            false => self.tell(GeneralEvent::Row(point)),
        }
    }

    /// A special point and its row.
    pub fn special(&mut self, point: GeneralPoint) -> ControlFlow<()> {
        self.tell(GeneralEvent::Special(point.clone()))?;
        self.tell(GeneralEvent::Row(point))
    }

    /// # Errors
    /// [`Error::TooManyPoints`] where there were more than allowed.
    pub fn end(self) -> Result<()> {
        match self.beyond {
            true => Err(Error::TooManyPoints { limit: self.limit }),
            false => Ok(()),
        }
    }
}
