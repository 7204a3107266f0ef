//! Branches of periodic orbits and the curves of their bifurcations.

mod branch_end;
mod branch_zero;
mod branches;
mod chart;
mod codimension_two;
mod crosscheck;
mod cubic_coefficient;
mod curve;
mod degenerate_hopf;
mod ends;
mod growing_period;
mod half_curve;
mod hopf;
mod loadings;
mod locus;
mod multipliers_together;
pub mod normal_form;
mod orbit_branch;
mod orbit_curves;
mod orbit_point;
mod refine;
mod scan;
mod top;
mod turning;
mod vertical;

pub use branches::orbits;
pub(super) use chart::Chart;
pub use crosscheck::crosscheck;
pub use hopf::HopfBeginning;
pub use loadings::branch;
pub use locus::{loci, locus};
pub use orbit_curves::{OrbitSeeds, orbit_curves};
pub(super) use orbit_point::orbit_point;
pub use refine::SpecialOrbit;
