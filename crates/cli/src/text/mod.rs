//! The commands of a system of one's own.

pub mod equilibria;
pub mod integrate;
pub mod law;
pub mod orbit;
pub mod section;
