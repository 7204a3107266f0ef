//! What is allocated: nothing where a step or a point is made.
#![allow(missing_docs)]

mod arcs;
mod rosenbrock;
#[cfg(feature = "sundials")]
mod sundials;
mod sweep;
