//! Branches of periodic orbits and the curves of their bifurcations.

mod branch;
mod certain;
mod chart;
mod course;
mod crosscheck;
mod curve;
mod detect;
mod follow;
mod leg;
mod locus;
pub mod normal_form;
mod rows;
mod scan;
mod sharp;
mod top;
mod vertical;
mod way;

pub use branch::branch;
pub use crosscheck::crosscheck;
pub use detect::Watch;
pub use follow::{End, Met, follow};
pub use locus::{loci, locus};
pub use sharp::SpecialOrbit;
