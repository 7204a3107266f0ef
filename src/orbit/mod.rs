//! Periodic orbits: Newton shooting on many nodes, and Floquet multipliers that can be trusted.

mod arc;
mod branch;
mod crosscheck;
mod cyclic;
mod extremes;
mod find;
mod floquet;
mod hopf;
mod linear;
mod polygon;
mod settle;
mod shooting;
mod slab;
mod solve;
mod space;

pub use arc::{Arc, Tracer};
pub use crosscheck::{Crosscheck, crosscheck};
pub use find::{Begin, Found, Query, find};
pub use floquet::{Floquet, Kind, Multiplier, floquet, symmetric_floquet};
pub use polygon::{EndAndLoss, Polygon};
pub use shooting::{Closed, close, newton_step};
pub use slab::Slab;
pub use solve::{Accuracy, Orbit};

use crate::error::Error;

/// What was found instead of an orbit, and what to try.
fn no_orbit(what: String, hint: &'static str) -> Error {
    Error::NoOrbit { what, hint }
}
