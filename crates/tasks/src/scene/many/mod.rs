//! Runs of many interfaces: more than move on their own elsewhere, or with constants drawn at random.

mod catalogue;
mod draw;
mod equilibrium;
mod plan;
mod run;
mod saved;
mod setup;

pub use catalogue::{Catalogue, CataloguePlan, Participant};
pub use draw::Drawn;
pub use equilibrium::{FoundManyEquilibrium, ManyEquilibriumPlan, SteadyInterface};
pub use plan::{ManyInstant, ManyPlan, many_run_columns};
pub use run::run_many;
pub use saved::{ManyCheckpoint, Saving};
