//! Fits of laboratory data from options: the record, the motion of the load point, the laws.

mod cells;
mod data;
mod given;
mod heading;
mod law;
mod motion;
mod options;
mod plan;
mod recorded;
mod sizes;
mod steps;
mod table;
mod unit;

pub use data::Measured;
pub use law::LawToFit;
pub use options::FitOptions;
pub use plan::{FitPlan, WithProblem};
