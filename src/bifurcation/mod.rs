//! Branches of equilibria and of periodic orbits, their bifurcations, and the curves of these in the (V_H, K) plane.
//!
//! Everything found is handed on as soon as it is known, as an [`Event`]: what was computed before an interruption is not lost.

mod begin;
pub mod equilibria;
pub mod general;
mod homoclinic;
mod label;
pub mod orbits;
mod request;
pub mod strong_resonance;
mod user_function;

use crate::equilibrium::{Symmetry, Verdict};
use crate::error::{Error, Result};
use crate::number::Uncertain;
use crate::orbit::InterfaceSystem;
use std::ops::ControlFlow;

pub use crate::model::Parameter;
pub use begin::curves_that_leave;
pub use label::Label;
use user_function::zero_note;
pub use user_function::{ProfileFunction, UserFunction};

/// To which side the bifurcating solutions lie.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Criticality {
    /// They are stable where what they come from is unstable.
    Supercritical,
    /// They are unstable where what they come from is stable.
    Subcritical,
    /// The coefficient is zero within its error.
    Undecided,
}

impl Criticality {
    /// In a word.
    pub fn name(self) -> &'static str {
        match self {
            Criticality::Supercritical => "supercritical",
            Criticality::Subcritical => "subcritical",
            Criticality::Undecided => "undecided",
        }
    }
}

/// A special point.
#[derive(Debug, Clone, PartialEq)]
pub struct Special {
    /// What it is.
    pub label: Label,
    /// The number of the branch or curve that it is on.
    pub branch: usize,
    /// The symmetry of the states or orbits of that branch.
    pub symmetry: Option<Symmetry>,
    /// V_H.
    pub driving: Uncertain,
    /// K.
    pub stiffness: Uncertain,
    /// The period of the orbit, or of the oscillation at a Hopf point.
    pub period: Option<Uncertain>,
    /// Where the bifurcation has one.
    pub criticality: Option<Criticality>,
    /// The normal form's coefficient whose sign that is. Of orbits that of [`orbits::normal_form::normal_form`], for an eigenvector whose
    /// mean square over the period is 1.
    pub coefficient: Option<f64>,
    /// The coefficient may be off by this, where that is known.
    pub coefficient_uncertainty: Option<f64>,
    /// Why the branch ends here, or what else is to be said.
    pub note: Option<String>,
    /// Of an orbit a point on it: (tau, ln psi) or (tau, ln psi_1, ln psi_2).
    pub state: Option<Vec<f64>>,
    /// The orbit there, where it is one of an orbit: what a second method begins with.
    pub orbit: Option<orbits::SpecialOrbit>,
}

impl Special {
    /// A special point of which no more is known yet than where it is.
    pub fn new(label: Label, driving: Uncertain, stiffness: Uncertain) -> Self {
        Special {
            label,
            branch: 0,
            symmetry: None,
            driving,
            stiffness,
            period: None,
            criticality: None,
            coefficient: None,
            coefficient_uncertainty: None,
            note: None,
            state: None,
            orbit: None,
        }
    }

    /// With a word in its note where it is less accurate, relatively, than was asked for.
    fn against(mut self, tolerance: f64) -> Self {
        let off = |x: &Uncertain| x.uncertainty > tolerance * x.value.abs();
        if off(&self.driving) || off(&self.stiffness) {
            self.note = Some(less_accurate(self.note));
        }
        self
    }
}

/// The note of a special point that is less accurate than was asked for.
fn less_accurate(note: Option<String>) -> String {
    note.map_or(String::new(), |note| note + "; ") + "less accurate than asked for"
}

/// A point of a branch.
#[derive(Debug, Clone, PartialEq)]
pub struct BranchRow {
    /// The number of the branch, from 0: one run may follow several.
    pub branch: usize,
    /// The symmetry of its states or orbits.
    pub symmetry: Symmetry,
    /// V_H.
    pub driving: f64,
    /// K.
    pub stiffness: f64,
    /// The stress of an equilibrium, or the mean over an orbit.
    pub stress: f64,
    /// Least and largest stress.
    pub stress_range: (f64, f64),
    /// The period of an orbit.
    pub period: Option<f64>,
    /// psi of both interfaces, of more of the slowest and the fastest one: of an equilibrium, or where the orbit's stress is largest.
    pub state: [f64; 2],
    /// The slip rates there.
    pub slip_rate: [f64; 2],
    /// ln |mu| of both nontrivial multipliers of an orbit, the larger one first.
    pub ln_abs_multiplier: [Option<f64>; 2],
    /// Stability.
    pub verdict: Verdict,
    /// What is special here.
    pub label: Option<Label>,
    /// The fields that only equilibria have.
    pub equilibrium: Option<equilibria::EquilibriumOfRow>,
}

/// A point of a curve in the (V_H, K) plane.
#[derive(Debug, Clone, PartialEq)]
pub struct LocusRow {
    /// The number of the curve, from 0: a locus may consist of several.
    pub curve: usize,
    /// The symmetry of the states or orbits that bifurcate.
    pub symmetry: Symmetry,
    /// V_H.
    pub driving: Uncertain,
    /// K.
    pub stiffness: Uncertain,
    /// The period of the orbit, or of the oscillation at a Hopf point.
    pub period: Option<f64>,
    /// The angle of the multipliers of a torus bifurcation.
    pub angle_over_pi: Option<f64>,
    /// Where it was asked for.
    pub criticality: Option<Criticality>,
    /// What is special here.
    pub label: Option<Label>,
    /// Of more than two interfaces: how many slide on the slow, the middle and the fast branch of the steady curve.
    pub share: Option<[usize; 3]>,
}

impl LocusRow {
    /// A point of which nothing else is known.
    pub fn new(curve: usize, symmetry: Symmetry, driving: Uncertain, stiffness: Uncertain) -> Self {
        LocusRow {
            curve,
            symmetry,
            driving,
            stiffness,
            period: None,
            angle_over_pi: None,
            criticality: None,
            label: None,
            share: None,
        }
    }
}

/// What is found on the way.
#[derive(Debug, Clone, PartialEq)]
pub enum Event {
    /// A point of a branch.
    Branch(BranchRow),
    /// A point of a curve.
    Locus(LocusRow),
    /// A special point.
    Special(Special),
}

impl Event {
    /// A special point with the branch or curve that it is on; what else there is as it is.
    fn on(self, branch: usize, symmetry: Symmetry) -> Self {
        match self {
            Event::Special(special) => Event::Special(Special {
                branch,
                symmetry: Some(symmetry),
                ..special
            }),
            row => row,
        }
    }

    /// A special point with a word where it is less accurate than was asked for; what else there is as it is.
    fn against(self, tolerance: f64) -> Self {
        match self {
            Event::Special(special) => Event::Special(special.against(tolerance)),
            row => row,
        }
    }
}

/// Whether to go on.
pub type EventObserver<'a> = &'a mut dyn FnMut(Event) -> ControlFlow<()>;

/// A branch that is asked for.
#[derive(Debug, Clone, PartialEq)]
pub struct BranchRequest {
    /// Law and interfaces; its loading has the fixed parameter.
    pub slab: InterfaceSystem,
    /// What is varied.
    pub along: Parameter,
    /// From where to where; the larger one may come first.
    pub range: (f64, f64),
    /// One symmetry, or both.
    pub symmetry: Option<Symmetry>,
    /// Values to land on.
    pub at: Vec<f64>,
    /// Functions whose zeros are special points.
    pub watch: Vec<UserFunction>,
    /// Factor on the step limits.
    pub step: f64,
    /// The accuracy of special points, relative.
    pub tolerance: f64,
    /// Numbers of branches that are known already and not told of again.
    pub skip: Vec<usize>,
    /// How many times orbits may double their period: the branches of all these are followed too.
    pub doublings: usize,
    /// More points than this are an error, of all branches together.
    pub max_points: usize,
}

impl BranchRequest {
    /// A range of a parameter, with everything else as it is by default.
    pub fn new(slab: InterfaceSystem, along: Parameter, range: (f64, f64)) -> Self {
        BranchRequest {
            slab,
            along,
            range,
            symmetry: None,
            at: Vec::new(),
            watch: Vec::new(),
            step: 1.0,
            tolerance: TOLERANCE,
            skip: Vec::new(),
            doublings: 0,
            max_points: MAX_POINTS,
        }
    }
}

impl LocusRequest {
    /// Ranges of V_H and K, with everything else as it is by default.
    pub fn new(
        slab: InterfaceSystem,
        kind: LocusKind,
        driving: (f64, f64),
        stiffness: (f64, f64),
    ) -> Self {
        LocusRequest {
            slab,
            kind,
            symmetry: None,
            driving,
            stiffness,
            at_driving: Vec::new(),
            at_stiffness: Vec::new(),
            watch: Vec::new(),
            step: 1.0,
            tolerance: TOLERANCE,
            criticality: false,
            skip: Vec::new(),
            max_points: MAX_POINTS,
        }
    }
}

/// Accuracy of special points where nobody says otherwise.
const TOLERANCE: f64 = 1e-11;

/// How many points branches and curves may have where nothing else is asked for: a hundred times as many as they usually have.
pub const MAX_POINTS: usize = 20_000;

/// Hands rows on as long as there are no more than `limit`.
///
/// # Errors
/// [`Error::TooManyPoints`] where there are more, after these; those of `follow`.
fn within(
    limit: usize,
    seen: EventObserver<'_>,
    follow: impl FnOnce(EventObserver<'_>) -> Result<()>,
) -> Result<()> {
    let (mut points, mut beyond) = (0, false);
    let ended = follow(&mut |event| {
        points += usize::from(!matches!(event, Event::Special(_)));
        beyond = points > limit;
        if beyond {
            ControlFlow::Break(())
        } else {
            seen(event)
        }
    });
    if beyond {
        return Err(Error::TooManyPoints { limit });
    }
    ended
}

/// The curves that there are.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum LocusKind {
    /// Pitchforks of equilibria.
    Pitchfork,
    /// Folds of equilibria.
    SaddleNode,
    /// Hopf points.
    Hopf,
    /// Pitchforks of orbits.
    OrbitPitchfork,
    /// Folds of orbits.
    OrbitSaddleNode,
    /// Period doublings.
    PeriodDoubling,
    /// Torus bifurcations.
    Torus,
    /// Homoclinic orbits; these are followed as those of any system.
    Homoclinic,
}

/// A curve that is asked for.
#[derive(Debug, Clone, PartialEq)]
pub struct LocusRequest {
    /// Law and interfaces; its loading does not matter.
    pub slab: InterfaceSystem,
    /// Of what.
    pub kind: LocusKind,
    /// One symmetry, or both where there are two.
    pub symmetry: Option<Symmetry>,
    /// V_H from, to.
    pub driving: (f64, f64),
    /// K from, to.
    pub stiffness: (f64, f64),
    /// Values to land on.
    pub at_driving: Vec<f64>,
    /// Values to land on.
    pub at_stiffness: Vec<f64>,
    /// Functions whose zeros are special points.
    pub watch: Vec<UserFunction>,
    /// Factor on the step limits.
    pub step: f64,
    /// The accuracy of all points, relative.
    pub tolerance: f64,
    /// Whether normal form coefficients are computed.
    pub criticality: bool,
    /// Numbers of curves that are known already and not told of again.
    pub skip: Vec<usize>,
    /// More points than this are an error, of all curves together.
    pub max_points: usize,
}
