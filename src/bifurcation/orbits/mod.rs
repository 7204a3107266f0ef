//! Branches of periodic orbits and the curves of their bifurcations.

mod detect;
mod follow;
mod sharp;
mod branch;
mod chart;
mod course;
mod curve;
mod leg;
mod locus;
pub mod normal_form;
mod rows;
mod top;

pub use branch::branch;
pub use locus::locus;
pub use sharp::{SpecialOrbit, crosscheck};
