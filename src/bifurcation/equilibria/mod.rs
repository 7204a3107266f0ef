//! Branches of equilibria, and the curves of their bifurcations in the (V_H, K) plane.
//!
//! Equilibria are the steady states (20); their pitchforks, folds and Hopf points are found by [`continuation`](crate::continuation)
//! and then computed from closed forms and one-dimensional zeros, to the last digits and with error budgets.

mod bialternate;
mod branch;
mod branch_observer;
mod critical;
mod crossing;
mod cubic;
mod curves;
pub mod generic;
pub mod generic_crossing;
pub mod generic_curve;
mod generic_curve_observer;
mod generic_curve_problem;
mod generic_observer;
pub(crate) mod hopf;
mod hopf_curve;
pub(crate) mod hopf_special;
pub(super) mod lyapunov;
pub mod multiple;
mod pieces;
mod rates;
pub(super) mod special;
mod stationary;
mod trace;
mod unexplained;
mod vertical;

use super::{BranchRequest, EventObserver, LocusKind, LocusRequest, Parameter, Special, within};
use crate::equilibrium::Symmetry;
use crate::error::{Error, Result};
use crate::friction::AnyLaw;
use crate::orbit::HopfPoint;
pub use cubic::{CharacteristicCubic, Tangency};
use curves::CurveVariables;
use special::Teller;

/// All branches of equilibria over a range of V_H at fixed K, or of K at fixed V_H, with their special points.
///
/// Symmetric branch first. Labels: `BP` (23), with the coefficient of (24); `LP`, the fold V_sn; `HB` with the first Lyapunov
/// coefficient, where <q, q> = 1 in (tau, psi_1, psi_2), and the period 2 pi / omega; `UZ` and `EP`; `MX` where a branch had to
/// be given up. States that differ by an exchange of the interfaces are one. A branch ends at a pitchfork, as `BP`.
///
/// # Errors
/// [`Error::Parameter`] or [`Error::Input`] for a request that makes no sense; those of
/// [`steady_states`](crate::equilibrium::steady_states); [`Error::TooManyPoints`]. That the observer ended it is none.
pub fn branch(request: &BranchRequest, seen: EventObserver<'_>) -> Result<()> {
    request.checked()?;
    within(request.max_points, seen, |seen| {
        branch::branch(request, seen)
    })
}

/// The curves of pitchforks, of folds or of Hopf points of equilibria within ranges of V_H and K.
///
/// Along Hopf points: `TOP`, the largest K; `GH`, a zero of the first Lyapunov coefficient; `BT`, `ZH`; `UZ` at every crossing of
/// a wanted value; `EP` where a curve leaves the ranges.
///
/// # Errors
/// As of [`branch()`]; [`Error::Input`] for a kind of curve that is not of equilibria.
pub fn locus(request: &LocusRequest, seen: EventObserver<'_>) -> Result<()> {
    request.checked()?;
    within(request.max_points, seen, |seen| curve(request, seen))
}

fn curve(request: &LocusRequest, seen: EventObserver<'_>) -> Result<()> {
    let tolerance = request.tolerance;
    let mut teller = Teller::new(seen, tolerance, &request.skip);
    // an observer's end is no error
    let _ = match request.kind {
        LocusKind::Hopf => hopf_curve::locus(request, &mut teller)?,
        LocusKind::Pitchfork | LocusKind::SaddleNode if request.slab.interfaces == 1 => {
            return Err(Error::Input(
                "a single interface has one steady state, without pitchforks and folds; take two"
                    .into(),
            ));
        }
        LocusKind::Pitchfork | LocusKind::SaddleNode => vertical::locus(request, &mut teller)?,
        _ => {
            return Err(Error::Input(
                "this is a curve of orbits, not of equilibria".into(),
            ));
        }
    };
    Ok(())
}

/// A Hopf point with its budgets and its first Lyapunov coefficient, as [`branch()`] tells of it. `None` where it is not decided
/// that there is one.
pub(super) fn hopf(law: &AnyLaw, along: Parameter, point: &HopfPoint) -> Option<Special> {
    let rates = &point.equilibrium.slip_rate;
    let interfaces = rates.len();
    let curve = match point.equilibrium.symmetry {
        Symmetry::Symmetric => CurveVariables::Symmetric { interfaces },
        Symmetry::Asymmetric => CurveVariables::Asymmetric,
    };
    let pair = [rates[0], rates[interfaces - 1]];
    let at = [point.driving, point.stiffness];
    let found = hopf_special::hopf_point(law, curve, along, at, pair);
    found.map(|(special, _)| special)
}
