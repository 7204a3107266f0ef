//! Branches of periodic orbits and the curves of their bifurcations.

mod branch_end;
mod branch_zero;
mod branches;
mod chart;
mod crosscheck;
mod cubic_coefficient;
mod curve;
mod ends;
mod growing_period;
mod half_curve;
mod loadings;
mod locus;
mod multipliers_together;
pub mod normal_form;
mod orbit_branch;
mod orbit_curves;
mod orbit_point;
mod refine;
mod rows;
mod scan;
mod slab_chart;
mod top;
mod turning;
mod vertical;

pub use branches::{HopfBeginning, orbits};
pub(super) use chart::Chart;
pub use crosscheck::crosscheck;
pub(super) use crosscheck::second;
pub use loadings::branch;
pub use locus::{loci, locus};
pub use orbit_curves::orbit_curves;
pub(super) use orbit_point::orbit_point;
pub use refine::SpecialOrbit;
