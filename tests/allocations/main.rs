//! What is allocated: nothing where a step or a point is made.
#![allow(missing_docs)]

mod arcs;
mod rosenbrock;
mod series;
#[cfg(feature = "sundials")]
mod sundials;
mod sweep;
