//! Branches of periodic orbits and the curves of their bifurcations.

mod branch;
mod chart;
mod crosscheck;
mod cubic_coefficient;
mod curve;
mod half_curve;
mod locus;
pub mod normal_form;
mod orbit_branch;
mod refine;
mod rows;
mod scan;
mod top;
mod vertical;

pub use branch::branch;
pub(super) use branch::{ARC, LONGEST, ROUGH, WORK};
pub use chart::embedded;
pub(super) use chart::middle;
pub use crosscheck::crosscheck;
pub(super) use crosscheck::second;
pub(super) use cubic_coefficient::{CoefficientCurve, Decided};
pub use locus::{loci, locus};
pub use refine::SpecialOrbit;
pub(super) use refine::refined;
pub(super) use vertical::Vertical;
