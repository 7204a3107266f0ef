//! Periodic orbits: Newton shooting on many nodes, and Floquet multipliers that can be trusted.

mod arc;
pub(crate) mod branch;
mod correct;
mod crosscheck;
pub mod cyclic;
mod extremes;
mod family;
mod find;
pub(crate) mod floquet;
mod hopf;
mod indicator;
mod jet;
mod linear;
mod motion;
mod noise;
mod polygon;
mod profile;
mod settle;
mod shooting;
mod slab;
mod solve;
mod space;
mod switch;
mod walk;

pub use arc::{Arc, Tracer};
pub use correct::{Condition, Corrector, Goal, Regular};
pub use crosscheck::{Crosscheck, crosscheck};
pub use family::{Family, OverLoadings, OverParameters, OverParted};
pub use find::{Begin, Found, Query, find};
pub use floquet::{Floquet, Kind, Multiplier, floquet, symmetric_floquet};
pub use hopf::{HopfPoint, hopf_points};
pub use indicator::{Indicator, Spectrum};
pub use jet::{Axes, Jet, cut_into, finely_cut, jets, squares};
pub use motion::{Motion, Site};
pub use noise::Noise;
pub use polygon::{EndAndLoss, Mesh, Polygon, of_digits};
pub use profile::{Profile, profile};
pub use shooting::{Closed, close, newton_step};
pub use slab::Slab;
pub use solve::{Accuracy, Orbit};
pub use switch::Switch;
pub use walk::{Pace, Path, Stop, Walk};

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
