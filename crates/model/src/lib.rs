//! What twinslip computes with, bottom up: numbers in which a formula can be evaluated, formulas that are read, power series, friction laws, vector
//! fields, and the paper's systems. A crate of its own so that it is compiled once, whatever changes above it; to be used as
//! part of the crate `twinslip`.

pub mod number;

pub mod expression;

pub mod series;

pub mod friction;

pub mod field;

pub mod model;

/// What the tests of this repository reach for. Nothing here is kept as it is.
#[doc(hidden)]
pub mod internals {
    pub use crate::series::element::Element;
    #[cfg(target_arch = "x86_64")]
    pub use crate::series::lanes::{Eight, Four, Pair};
    pub use crate::series::{BothWays, both_ways, columns_both_ways};
}

pub(crate) use twinslip_error as error;
