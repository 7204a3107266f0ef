//! The fields that only rows of equilibria have.

use crate::equilibrium::ClusterEigenvalue;

/// The clusters and eigenvalues of an equilibrium of equal interfaces.
#[derive(Debug, Clone, PartialEq)]
pub struct EquilibriumOfRow {
    /// The partition: how many of more than two interfaces slide on the slow, the middle and the fast branch of the steady curve.
    pub share: Option<[usize; 3]>,
    /// Interfaces that slide alike, slowest first.
    pub clusters: Vec<ClusterOfRow>,
    /// The eigenvalues, largest real part first; none where a row is read back.
    pub eigenvalues: Vec<ClusterEigenvalue>,
    /// How many eigenvalues have a positive real part, as they are.
    pub unstable: usize,
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
