//! Periodic orbits: Newton shooting on many nodes, and Floquet multipliers that can be trusted.

mod arc;
mod arrival;
pub(crate) mod branch;
mod certain;
mod conditions;
mod continuation_point;
mod correct;
mod crosscheck;
pub(crate) mod cyclic;
mod extremes;
mod family;
mod find;
mod find_forced;
mod find_from;
mod find_unequal;
pub(crate) mod floquet;
mod goal;
mod going_on;
mod gradients;
mod hopf;
mod interface_system;
mod jet;
mod linear;
mod motion_units;
pub(crate) mod moved_along;
mod multipliers;
mod new_nodes;
mod noise;
mod orbit_curve;
mod over_interfaces;
mod over_text;
pub(crate) mod periodic_schur;
mod phase_response;
mod profile;
mod sensitivity;
mod settle;
pub(crate) mod shooting;
mod shooting_nodes;
mod small_orbits;
mod solve;
mod space;
mod spread;
mod stiffness;
mod switch;
mod test_function;
mod user_function;
mod winding;
mod within;

pub use arc::{Arc, Tracer};
pub use conditions::Condition;
pub use continuation_point::{ContinuationPoint, TangentVector};
pub use correct::{Corrector, Regular};
pub use crosscheck::{Crosscheck, crosscheck, crosscheck_of};
pub use extremes::ranges;
pub(crate) use family::across_in_units;
pub use family::{
    OverDifferenceChart, OverLoadings, OverLogarithms, OverParameters, ParametrisedField,
};
pub use find::{FoundOrbit, InitialGuess, Query, find, find_either};
pub use find_from::find_from;
pub use find_unequal::find_unequal;
pub use floquet::{Floquet, Kind, Multiplier, WithinCluster, floquet};
pub use goal::Goal;
pub(crate) use hopf::EquilibriaAlong;
pub use hopf::{HopfPoint, hopf_points};
pub use interface_system::InterfaceSystem;
pub(crate) use jet::{Across, Axes, CVector, PoincareMaps, cut_into, finely_cut, squares};
pub(crate) use multipliers::{eigenvalues_of, unit_pair};
pub(crate) use noise::Noise;
pub use orbit_curve::{DirectedPoint, OrbitCurve, Palc, PalcSettings, WatchedFunction};
pub use over_interfaces::OverInterfaces;
pub use over_text::{Coordinate, OverText};
pub(crate) use periodic_schur::LogEigenvalue;
pub use phase_response::{PhaseResponse, phase_response};
pub use profile::{Digits, Profile, profile, profile_of};
pub use sensitivity::{Families, Sensitivity, sensitivity};
pub use shooting::{Closed, close};
pub use shooting_nodes::ShootingNodes;
pub(crate) use shooting_nodes::of_digits;
pub use small_orbits::SmallOrbits;
pub use solve::{Orbit, OrbitAccuracy};
pub(crate) use stiffness::method_for;
pub use switch::Switch;
pub use test_function::{Spectrum, TestFunction};
pub(crate) use user_function::beyond_noise;
pub use user_function::{Solution, UserFunctions, WithFunctions};
pub use within::{AlongArcs, SplitRate, within_clusters};

use crate::error::Error;

/// What was found instead of an orbit, and what to try.
fn no_orbit(what: String, hint: &'static str) -> Error {
    Error::NoOrbit {
        what,
        period: None,
        hint,
    }
}

/// Another orbit that was found instead, of this period, and what to try.
fn other_orbit(what: String, period: f64, hint: &'static str) -> Error {
    Error::NoOrbit {
        what,
        period: Some(period),
        hint,
    }
}
