//! Stub.

use super::equilibria::{synthetic_branch, synthetic_locus};
use super::{BranchRequest, LocusRequest, Seen, Special};
use crate::equilibrium::Symmetry;
use crate::error::Result;
use crate::integrate::Choice;
use crate::orbit::Slab;

/// Stub: curves that look a little like the real ones.
pub fn branch(request: &BranchRequest, seen: Seen<'_>) -> Result<()> {
    synthetic_branch(request, true, seen)
}

/// Stub.
pub fn locus(request: &LocusRequest, seen: Seen<'_>) -> Result<()> {
    synthetic_locus(request, seen)
}

/// Relative differences in V_H, K and the period; `None` where the label has no second method.
pub fn crosscheck(
    _slab: &Slab,
    _symmetry: Option<Symmetry>,
    special: &Special,
    _method: Choice,
) -> Result<Option<[f64; 3]>> {
    Ok(special.coefficient.map(|_| [1e-9, 0.0, -2e-10]))
}
