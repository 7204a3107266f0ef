//! Fits of laboratory data from options: the record, the motion of the load point, the laws.

mod cells;
mod data;
mod given;
mod heading;
mod law;
mod motion;
mod options;
mod plan;
mod priors;
mod recorded;
mod records;
mod sizes;
mod steps;
mod table;
mod unit;

pub use data::Measured;
pub use law::LawToFit;
pub use options::FitOptions;
pub use plan::{FitPlan, Piece, Recording, WithProblem};
pub use records::{FittedRecords, OwnRecord};
