//! What the benchmarks, their report and the comparison with peers share.
#![allow(
    dead_code,
    missing_docs,
    reason = "none of them needs all, and none is documented for others"
)]

pub mod exact;
pub mod methods;
pub mod reach;
pub mod results;
pub mod scene;
