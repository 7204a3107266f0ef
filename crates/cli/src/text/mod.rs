//! The commands of a user-defined system.

pub mod equilibria;
pub mod integrate;
pub mod law;
pub mod orbit;
pub mod section;
