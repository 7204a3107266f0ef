//! What is said of an orbit on a branch.

use super::chart::Chart;
use crate::bifurcation::{BranchRow, Label};
use crate::equilibrium::Verdict;
use crate::error::Result;
use crate::orbit::{Profile, Regular, profile};

/// An orbit of a slab, in any of its variables.
pub(super) fn row<F: Chart<N>, const N: usize>(
    family: &F,
    branch: usize,
    orbit: &Regular<N>,
    label: Option<Label>,
) -> Result<BranchRow> {
    /// ln |mu| that is zero within the accuracy of a walk.
    const NEUTRAL: f64 = 1e-6;
    let here = family.slab().slab(orbit.site.at);
    let Profile {
        mean_stress,
        stress_range,
        state,
        slip_rate,
    } = profile(&here, &family.usual(&orbit.site).polygon)?;
    let spectrum = &orbit.spectrum;
    let logs = if N == 3 {
        spectrum.log_multipliers().map(Some)
    } else {
        // Within the plane, and across it.
        let mut both = vec![spectrum.volume];
        both.extend((here.interfaces == 2).then_some(spectrum.across));
        both.sort_by(|a, b| b.total_cmp(a));
        [both.first().copied(), both.get(1).copied()]
    };
    let largest = logs[0].unwrap_or(f64::NAN);
    let verdict = if largest > NEUTRAL {
        Verdict::Unstable
    } else if largest < -NEUTRAL {
        Verdict::Stable
    } else {
        Verdict::Undecided
    };
    let [driving, stiffness] = [here.loading.driving, here.loading.stiffness];
    Ok(BranchRow {
        branch,
        driving,
        stiffness,
        stress: mean_stress,
        stress_range,
        period: Some(orbit.site.polygon.period()),
        state,
        slip_rate,
        ln_abs_multiplier: logs,
        verdict,
        label,
    })
}
