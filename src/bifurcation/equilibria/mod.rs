//! Branches of equilibria, and the curves of their bifurcations in the (V_H, K) plane.
//!
//! An equilibrium of N equal interfaces (20) is a share of them among the slow, the middle and the fast branch of the steady curve, and
//! the states of a share are a curve: V_H, the eigenvalues and the conditions of all bifurcations are functions of the middle rate that
//! are written down (see [`equilibrium`](crate::equilibrium)). Nothing is followed step by step; every share is looked at between two
//! extrema of the steady stress. Special points are computed in 31 digits, with error budgets.
//!
//! At an extremum a share passes into another one: with k interfaces sticking, (k, N - k, 0), (k, 0, N - k) and (0, k, N - k) are one
//! branch, of two clusters. It begins where the interfaces stop to slide alike, and ends so: of two interfaces at the pitchforks (23).
//! Where n > 1 interfaces pass the extremum together they may part: there the branches of three clusters begin and end, and n - 1
//! eigenvalues within the cluster are zero.
//!
//! Equilibria of any other system are followed by [`generic`].

mod bialternate;
mod branch;
pub(super) mod centre_manifold;
mod course;
mod critical;
mod cubic;
pub mod generic;
pub mod generic_crossing;
pub mod generic_curve;
mod generic_curve_observer;
mod generic_curve_problem;
mod generic_observer;
mod hopf;
mod hopf_curve;
mod locus;
mod lyapunov;
pub mod multiple;
pub mod normal_form;
mod row;
mod special;
mod stationary;
mod unexplained;
mod vertical;

use super::{BranchRequest, EventObserver, LocusKind, LocusRequest, UserFunction, within};
use crate::error::{Error, Result};
pub use cubic::{CharacteristicCubic, Tangency};
pub(super) use hopf::hopf;
pub use row::{ClusterOfRow, EquilibriumOfRow};
use special::Teller;

/// All branches of equilibria of N equal interfaces over a range of V_H at fixed K, or of K at fixed V_H, with their special points.
///
/// The branch on which all slide alike comes first, then those of two clusters by the number of interfaces that stick, then those of
/// three. A branch that leaves the range and comes back has a number for each stretch, which begins at its end nearer to the begin of the
/// range. Labels: `BP` where interfaces that slide alike may part, told once for all branches that meet there: of two interfaces the
/// pitchfork (23) with the coefficient of (24); `LP` a fold, as V_sn; `HB` with the period 2 pi / omega and the first Lyapunov
/// coefficient, where <q, q> = 1 in (tau, psi_1, .., psi_N); `UZ`, `EP`. States that differ by the order of the interfaces are one.
///
/// # Errors
/// [`Error::Parameter`] or [`Error::Input`] for a request that makes no sense, which has more points than it allows, or of a law
/// whose extrema are not certain; [`Error::NotConverged`]; [`Error::TooManyPoints`]. That the observer ended it is none.
pub fn branch(request: &BranchRequest, seen: EventObserver<'_>) -> Result<()> {
    request.checked_of_many()?;
    watches_nothing(&request.watch)?;
    within(request.max_points, seen, |seen| {
        branch::branch(request, seen)
    })
}

/// The zeros of functions are found by [`super::general`], which follows these equilibria as those of any system.
fn watches_nothing(watch: &[UserFunction]) -> Result<()> {
    match watch.first() {
        None => Ok(()),
        Some(function) => Err(Error::Input(format!(
            "`watch` {:?}: the closed forms of equal interfaces know of no functions; follow them as any system",
            function.text
        ))),
    }
}

/// The curves of Hopf points, of folds or of branch points of equilibria of N equal interfaces within ranges of V_H and K, of every share.
///
/// Folds and branch points are lines along K. Along Hopf points: `TOP`, the largest K of a share; `GH`, a zero of the first Lyapunov
/// coefficient; `ZH`, a fold; `BT`, on fold lines too; `UZ` at every crossing of a wanted value; `EP` where a curve leaves the ranges.
///
/// # Errors
/// As of [`branch()`]; [`Error::Input`] for a kind of curve that is not of equilibria, or of which one interface has none.
pub fn locus(request: &LocusRequest, seen: EventObserver<'_>) -> Result<()> {
    request.checked_of_many()?;
    watches_nothing(&request.watch)?;
    let request = &request.ordered();
    within(request.max_points, seen, |seen| {
        let mut teller = Teller::new(seen, request.tolerance, &request.skip);
        // an observer's end is no error
        let _ = match request.kind {
            LocusKind::Hopf => locus::locus(request, &mut teller)?,
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
    })
}
