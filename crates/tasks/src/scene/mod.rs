//! From what a user asks for to a run: options, checked once, make a plan that holds only what the outputs need.
//!
//! A scene file and the flags of the command line are the same options: a file is turned into flags.
//!
//! ```
//! use twinslip::integrate::Control;
//! use twinslip::scene::{IntegrateOptions, Plan, Sink, run};
//!
//! #[derive(clap::Parser)]
//! struct Line { #[command(flatten)] options: IntegrateOptions }
//! let line = <Line as clap::Parser>::parse_from(
//!     ["line", "--driving=0.2", "--stiffness=0.05", "--start=near-symmetric:0", "--until=10", "--final-only"]);
//!
//! struct Last(Vec<f64>);
//! impl Sink for Last {
//!     fn row(&mut self, row: &[f64]) -> Control { self.0 = row.to_vec(); Control::Continue }
//!     fn reached(&mut self, _: f64) -> Control { Control::Continue }
//! }
//! let plan = Plan::new(&line.options)?;
//! assert_eq!(plan.start.len(), 2);
//! let mut last = Last(Vec::new());
//! let outcome = run(&plan, &mut last)?;
//! assert!(outcome.failure.is_none());
//! assert_eq!(last.0[0], 10.0);
//! # Ok::<(), twinslip::Error>(())
//! ```

mod any_system;
mod branch;
mod column;
mod command;
mod continuation;
mod description;
mod ensemble;
mod equations;
mod equilibria;
mod estimate;
mod event;
mod explain;
mod file;
mod fit;
mod following;
mod general;
mod holds;
mod instant;
mod ivp;
mod law;
mod locus;
mod many;
mod observer;
mod options;
mod orbit;
mod plan;
mod program;
mod run;
mod section;
mod set;
mod shipped;
mod slip;
mod summary;
mod sweep;
mod system;
mod text;
mod unequal;
mod units;
mod warnings;
mod words;

pub use any_system::AnySystem;
pub use branch::{BranchKind, BranchParameter, BranchPlan};
pub use column::{CellValue, Column};
pub use command::Command;
pub use command::sentence;
pub use continuation::{BranchOptions, ContinuationOptions, LocusOptions, SearchOptions};
pub use description::{
    LawDescription, ModelDescription, ModelKind, ParameterDescription, StateDescription,
    symbol_of_state,
};
pub use ensemble::{EnsembleFile, EnsembleOptions, EnsemblePlan, FittedParameter, FrictionFit};
pub use equations::Subspace;
pub use equilibria::{ClassifiedEquilibria, ClassifiedEquilibrium, EquilibriaPlan};
pub use event::SlipEvent;
pub use explain::{Keeping, explain};
pub use file::SceneFile;
pub use fit::{
    FitOptions, FitPlan, FittedRecords, LawToFit, Look, LookStretch, Measured, MeasuredFriction,
    OwnRecord, Piece, Recording, Role, TakenColumn, WithProblem,
};
pub use following::Following;
pub use general::{
    Free, GeneralBranchPlan, GeneralFound, GeneralLocusPlan, GeneralRow, RowKind, SlabSubject,
    SpecialRow, Subject, TextSubject, plane, shown,
};
pub use holds::HoldOfRun;
pub use instant::{Instant, run_columns};
pub use ivp::{
    Halt, IvpAsked, IvpError, IvpEvent, IvpFormula, IvpOutcome, IvpParts, IvpPlan, IvpSolution,
};
pub use law::{LawCurve, LawLandmarks, LawPlan, LawPoint, Together};
pub use locus::{CurveChoice, LocusPlan};
pub use many::{
    Catalogue, CataloguePlan, Drawn, FoundManyEquilibrium, ManyCheckpoint, ManyEquilibriumPlan,
    ManyInstant, ManyPlan, Participant, Saving, SteadyInterface, many_run_columns, run_many,
};
pub use options::{
    EquilibriaOptions, IntegrateOptions, LawOptions, ModelOptions, NumericsOptions, OrbitOptions,
    OutputOptions, SectionOptions, SlabOptions,
};
pub use orbit::SECOND_METHOD;
pub use orbit::{OrbitDerivatives, OrbitPlan};
pub use plan::{Plan, Point, Sampling, start, tolerances};
pub use program::{Change, Program, Stretch};
pub use run::{RunOutcome, Sink, run};
pub use section::{
    CheckedExponents, SectionOutcome, SectionPlan, SectionRow, explain_section, run_section,
    section_columns,
};
pub use shipped::{about, shipped, shipped_laws, shipped_names, shipped_systems};
pub use summary::{Criticality, FaultSummary, Spread};
pub use sweep::{BasinStates, Diagram, Moving, Shard, SweepLayout, SweepOptions, SweepPlan, Swept};
pub use system::{Described, System};
pub use text::{
    Friction, LawFile, SearchPlace, Steady, SystemFile, TextEquilibria, TextEquilibriaPlan,
    TextEquilibrium, TextModel, TextOptions, TextSlab, TextSlider,
};
pub use units::{Quantity, TimeUnit, Units};
pub use words::{Plain, plain};
