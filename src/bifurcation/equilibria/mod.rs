//! Branches of equilibria, and the curves of their bifurcations in the (V_H, K) plane.

mod branch;
mod crossing;
mod curves;
mod hopf;
mod lyapunov;
mod pieces;
mod rates;
mod stationary;

use super::{BranchRequest, Seen};
use crate::error::{Error, Result};

fn positive(name: &str, value: f64) -> Result<f64> {
    if value > 0.0 && value.is_finite() {
        Ok(value)
    } else {
        Err(Error::parameter(name, value, "positive and finite"))
    }
}

pub fn branch(request: &BranchRequest, seen: Seen<'_>) -> Result<()> {
    branch::branch(request, seen)
}
