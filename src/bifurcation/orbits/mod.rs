//! Branches of periodic orbits and the curves of their bifurcations.

mod detect;
mod follow;
mod sharp;
mod branch;
mod rows;

pub use branch::branch;
