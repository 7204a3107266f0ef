//! Fits of laboratory data from options: the record, the motion of the load point, the laws.

mod cells;
mod clock;
mod columns;
mod data;
mod given;
mod heading;
mod law;
mod look;
mod motion;
mod numeral;
mod options;
mod plan;
mod priors;
mod rates;
mod recorded;
mod records;
mod roles;
mod sizes;
mod steps;
mod table;
mod unit;

pub use data::{Measured, TakenColumn};
pub use law::LawToFit;
pub use look::{Look, LookStretch};
pub use options::FitOptions;
pub use plan::{FitPlan, Piece, Recording, WithProblem};
pub use rates::MeasuredFriction;
pub(super) use rates::measured_friction;
pub use records::{FittedRecords, OwnRecord};
pub use roles::Role;
