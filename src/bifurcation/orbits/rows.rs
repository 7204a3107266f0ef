//! What is said of an orbit on a branch or on a curve.

use super::chart::Chart;
use crate::bifurcation::{BranchRow, Label, Special};
use crate::equilibrium::Verdict;
use crate::error::Result;
use crate::number::Uncertain;
use crate::orbit::{Profile, Regular, profile};

/// An orbit of a slab, in any of its variables.
pub(super) fn row(
    chart: Chart,
    branch: usize,
    orbit: &Regular,
    label: Option<Label>,
) -> Result<BranchRow> {
    /// ln |mu| that is zero within the accuracy of a continuation.
    const NEUTRAL: f64 = 1e-6;
    let here = chart.slab().slab(orbit.site.at);
    let Profile {
        mean_stress,
        stress_range,
        state,
        slip_rate,
    } = profile(&here, &chart.usual(&orbit.site).shooting)?;
    let spectrum = &orbit.spectrum;
    let logs = if spectrum.dimension == 3 {
        spectrum.log_multipliers()?.map(Some)
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
        symmetry: chart.symmetry(),
        driving,
        stiffness,
        stress: mean_stress,
        stress_range,
        period: Some(orbit.site.shooting.period()),
        state,
        slip_rate,
        ln_abs_multiplier: logs,
        verdict,
        label,
    })
}

/// V_H and K as they were given, where they were: not the exponentials of their logarithms.
pub(super) type GivenParameters = [Option<f64>; 2];

/// The number that was asked for and has this logarithm, of a range's ends and the wanted values.
pub(super) fn asked(log: f64, range: (f64, f64), wanted: &[f64]) -> Option<f64> {
    let mut all = [range.0, range.1].into_iter().chain(wanted.iter().copied());
    all.find(|x| x.ln() == log)
}

impl BranchRow {
    pub(super) fn given(&mut self, [driving, stiffness]: GivenParameters) {
        self.driving = driving.unwrap_or(self.driving);
        self.stiffness = stiffness.unwrap_or(self.stiffness);
    }
}

impl Special {
    pub(super) fn given(&mut self, given: GivenParameters) {
        let places = [&mut self.driving, &mut self.stiffness];
        for (place, given) in places.into_iter().zip(given) {
            if let Some(exact) = given {
                *place = Uncertain::new(exact, 0.0);
            }
        }
    }
}
