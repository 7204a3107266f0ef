//! Branches of equilibria of N equal interfaces, and their bifurcations.
//!
//! An equilibrium is a share of the interfaces among the slow, the middle and the fast branch of the steady curve, and the states of a
//! share are a curve: V_H, the eigenvalues and the conditions of all bifurcations are functions of the middle rate that are written down
//! (see [`equilibrium`](crate::equilibrium)). Nothing is followed step by step; every share is looked at between two extrema of the
//! steady stress.
//!
//! At an extremum a share passes into another one: with k interfaces sticking, (k, N - k, 0), (k, 0, N - k) and (0, k, N - k) are one
//! branch, of two clusters. It begins where the interfaces stop to slide alike, and ends so. Where n > 1 interfaces pass the extremum
//! together they may part: there the branches of three clusters begin and end, and n - 1 eigenvalues within the cluster are zero.

mod branch;
mod course;
mod locus;
mod special;

use super::equilibria::special::Teller;
use super::{BranchRequest, EventObserver, Label, LocusKind, LocusRequest, within};
use crate::equilibrium::{Symmetry, Verdict};
use crate::error::{Error, Result};

/// A point of a branch of equilibria of N interfaces.
#[derive(Debug, Clone, PartialEq)]
pub struct ClusterRow {
    /// The number of the branch, from 0.
    pub branch: usize,
    /// How many interfaces slide on the slow, the middle and the fast branch of the steady curve.
    pub share: [usize; 3],
    /// V_H.
    pub driving: f64,
    /// K.
    pub stiffness: f64,
    /// The stress.
    pub stress: f64,
    /// Interfaces that slide alike, slowest first.
    pub clusters: Vec<ClusterOfRow>,
    /// How many eigenvalues have a positive real part, as they are.
    pub unstable: usize,
    /// Stability among all motions.
    pub verdict: Verdict,
    /// What is special here.
    pub label: Option<Label>,
}

/// Interfaces that slide alike.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct ClusterOfRow {
    /// How many they are.
    pub count: usize,
    /// psi.
    pub state: f64,
    /// The slip rate of each.
    pub slip_rate: f64,
}

impl ClusterRow {
    /// Whether all slide alike.
    pub fn symmetry(&self) -> Symmetry {
        match self.clusters.len() {
            1 => Symmetry::Symmetric,
            _ => Symmetry::Asymmetric,
        }
    }
}

/// All branches of equilibria of N equal interfaces over a range of V_H at fixed K, or of K at fixed V_H, with their special points.
///
/// The branch on which all slide alike comes first, then those of two clusters by the number of interfaces that stick, then those of
/// three. A branch that leaves the range and comes back has a number for each stretch. Labels as of
/// [`equilibria::branch`](super::equilibria::branch()): `LP` a fold, `HB` with the period and the first Lyapunov coefficient in
/// (tau, psi_1, .., psi_N), `BP` where a cluster may part, told once for all branches that meet there; `UZ`, `EP`.
///
/// # Errors
/// [`crate::Error::Parameter`] or [`crate::Error::Input`] for a request that makes no sense, which has more points than it allows, or of a law
/// whose extrema are not certain; [`crate::Error::NotConverged`]. That the observer ended it is none.
pub fn branch(request: &BranchRequest, seen: EventObserver<'_>) -> Result<()> {
    request.checked_of_many()?;
    within(request.max_points, seen, |seen| {
        branch::branch(request, seen)
    })
}

/// The curves of Hopf points, of folds or of branch points of equilibria of N equal interfaces within ranges of V_H and K, of every share.
///
/// Folds and branch points are lines along K. Labels of Hopf points: `TOP`, the largest K of a share; `UZ`, `EP`.
///
/// # Errors
/// As of [`branch()`]; [`Error::Input`] for a kind of curve that is not of equilibria.
pub fn locus(request: &LocusRequest, seen: EventObserver<'_>) -> Result<()> {
    request.checked_of_many()?;
    let request = &request.ordered();
    let of_equilibria = [LocusKind::Hopf, LocusKind::Pitchfork, LocusKind::SaddleNode];
    if !of_equilibria.contains(&request.kind) {
        return Err(Error::Input(
            "this is a curve of orbits, not of equilibria".into(),
        ));
    }
    within(request.max_points, seen, |seen| {
        let mut teller = Teller::new(seen, request.tolerance, &request.skip);
        // an observer's end is no error
        let _ = locus::locus(request, &mut teller)?;
        Ok(())
    })
}
