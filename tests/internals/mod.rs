//! Arithmetic that the crate keeps to itself, apart from `twinslip::internals`.

mod arguments;
mod branch;
mod clock;
mod control;
mod cyclic;
mod ensembles;
mod exact_products;
mod factors;
mod floquet;
mod hopf_special;
#[cfg(feature = "sundials")]
mod linked;
mod singularity;
mod tints;
#[cfg(feature = "mpi")]
mod wire;
mod words;
