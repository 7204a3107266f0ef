//! Curves of homoclinic orbits in the plane of two parameters.
//!
//! They begin at the ends of branches of periodic orbits whose period grows without bound, and are followed both ways with both parameters free, past their turns, to
//! where the equilibrium ceases to be a saddle.

mod begin;
mod bogdanov_takens;
mod codimension_two;
mod connection;
mod curve;
mod elimination;
mod linear;
mod locus;
mod saddle;

pub(super) use locus::homoclinic_curve_of;
pub use locus::homoclinic_curves;
