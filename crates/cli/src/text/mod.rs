//! The commands of a user-defined system.

pub mod equilibria;
