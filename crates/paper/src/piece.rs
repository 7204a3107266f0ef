//! What one scene computes.

use std::sync::Arc;
use twinslip::bifurcation::{BranchRow, LocusRow, Special};
use twinslip::friction::AnyLaw;
use twinslip::model::Loading;
use twinslip::orbit::{Crosscheck, FoundOrbit};
use twinslip_output::RowList;
use twinslip_tasks::scene::{
    AnySystem, BranchPlan, ClassifiedEquilibria, EquilibriaPlan, GeneralRow, LawCurve, LawPlan,
    LocusPlan, OrbitPlan, Plan, Quantity, RowKind, RunOutcome, SectionOutcome, SectionPlan,
    SlabSubject,
};

/// A run in time, with its points as they are drawn.
#[derive(Debug)]
pub struct Run {
    /// What was run.
    pub plan: Plan,
    /// In the columns of [`Plan::pictured`](twinslip_tasks::scene::Plan::pictured).
    pub rows: RowList,
    /// What it came to.
    pub outcome: RunOutcome,
}

/// The returns of a run.
#[derive(Debug)]
pub struct Map {
    /// What was run.
    pub plan: SectionPlan,
    /// In the columns of [`section_columns`](twinslip_tasks::scene::section_columns).
    pub rows: RowList,
    /// What it came to.
    pub outcome: SectionOutcome,
}

impl Run {
    /// The law of all interfaces.
    pub fn law(&self) -> AnyLaw {
        of_the_paper(&self.plan.system).0
    }

    /// V_H and K.
    pub fn loading(&self) -> Loading {
        of_the_paper(&self.plan.system).1
    }
}

impl Map {
    /// V_H and K.
    pub fn loading(&self) -> Loading {
        of_the_paper(&self.plan.system).1
    }
}

fn of_the_paper(system: &AnySystem) -> (AnyLaw, Loading) {
    let (system, loading) = system
        .closed_forms()
        .expect("scenes of the paper have built-in laws");
    (system.law, loading)
}

/// Branches as a parameter varies.
#[derive(Debug)]
pub struct Branches {
    /// What was followed.
    pub plan: BranchPlan,
    /// The points.
    pub rows: Vec<BranchRow>,
    /// The special ones.
    pub special: Vec<Special>,
}

/// Curves in the (V_H, K) plane.
#[derive(Debug)]
pub struct Curves {
    /// What was followed.
    pub plan: LocusPlan,
    /// The points.
    pub rows: Vec<LocusRow>,
    /// The special ones.
    pub special: Vec<Special>,
}

/// Branches or curves of interfaces that differ, or in parameters other than V_H and K.
#[derive(Debug)]
pub struct GeneralCurves {
    /// What slides.
    pub subject: SlabSubject,
    /// What rows are of.
    pub kind: RowKind,
    /// The parameters that rows tell, those that vary first.
    pub names: Vec<(&'static str, Quantity)>,
    /// The points.
    pub rows: Vec<GeneralRow>,
    /// The special ones.
    pub special: Vec<GeneralRow>,
}

/// A periodic orbit.
#[derive(Debug)]
pub struct PeriodicOrbit {
    /// What was looked for.
    pub plan: OrbitPlan,
    /// What was found.
    pub found: FoundOrbit,
    /// The same by the second method, where the plan has one.
    pub checked: Option<Crosscheck>,
}

/// All steady states at a driving velocity.
#[derive(Debug)]
pub struct Equilibria {
    /// What was looked for.
    pub plan: EquilibriaPlan,
    /// What was found.
    pub found: ClassifiedEquilibria,
}

/// Steady-state friction laws.
#[derive(Debug)]
pub struct Laws {
    /// What was evaluated.
    pub plan: LawPlan,
    /// The law of both interfaces, where they differ of each.
    pub curves: Vec<LawCurve>,
}

/// What a scene computes.
#[derive(Debug, Clone)]
pub(super) enum Piece {
    Run(Arc<Run>),
    Map(Arc<Map>),
    Branches(Arc<Branches>),
    Curves(Arc<Curves>),
    General(Arc<GeneralCurves>),
    Orbit(Arc<PeriodicOrbit>),
    Equilibria(Arc<Equilibria>),
    Law(Arc<Laws>),
}
