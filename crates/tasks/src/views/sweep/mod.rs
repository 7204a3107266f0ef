//! Pictures of sweeps: which regime there is at each point of a plane, and where starts end.

mod attractors;
mod basin;
mod diagram;
mod line;
mod plane;
pub mod tints;

pub use basin::{Basins, basin_map, basins_of_states};
pub use diagram::diagram_picture;
pub use line::regime_line;
pub use plane::{parameter_map, regime_map};

use twinslip::equilibrium::Symmetry;
use twinslip::number::Uncertain;
use twinslip::section::Regime;
use twinslip_output::plot::Axis;

/// What a run settled on at a point of a sweep, as far as pictures show it.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct PointOutcome {
    /// The number of the point: k = (j N + i) S + s for the i-th of N values across, the j-th upwards, the s-th of S starts.
    pub number: usize,
    /// What it is.
    pub regime: Regime,
    /// Whether both interfaces slide alike; none where that isn't known or there is one interface.
    pub symmetry: Option<Symmetry>,
    /// Returns to the section after which an orbit closes.
    pub returns_per_period: Option<usize>,
    /// The period of an orbit.
    pub period: Option<f64>,
    /// Least and largest stress, or value of the state that the section is in.
    pub stress_range: Option<(f64, f64)>,
    /// The largest Lyapunov exponent.
    pub lyapunov_max: Option<Uncertain>,
}

/// The values along one side of a grid, growing.
#[derive(Debug, Clone, PartialEq)]
pub struct GridSide {
    /// The values, dimensionless.
    pub values: Vec<f64>,
    /// Whether they are in equal ratios: so is then the axis.
    pub log: bool,
}

impl GridSide {
    /// The edges of cells around the values: halfway to the neighbours, and as far beyond the ends.
    fn edges(&self) -> Vec<f64> {
        /// What a single value reaches to both sides, as a part of it.
        const ALONE: f64 = 0.05;
        let on = |x: f64| if self.log { x.ln() } else { x };
        let off = |x: f64| if self.log { x.exp() } else { x };
        let at: Vec<f64> = self.values.iter().copied().map(on).collect();
        let (first, last) = match at[..] {
            [] => return Vec::new(),
            [only] if self.log => (ALONE, only),
            [only] => (ALONE * only.abs().max(f64::MIN_POSITIVE), only),
            [a, b, ..] => (0.5 * (b - a), at[at.len() - 1]),
        };
        let end = at
            .len()
            .checked_sub(2)
            .map_or(first, |i| 0.5 * (last - at[i]));
        let between = at.windows(2).map(|pair| 0.5 * (pair[0] + pair[1]));
        let edges = std::iter::once(at[0] - first).chain(between);
        edges.chain([last + end]).map(off).collect()
    }

    /// The axis of that name that ends where the cells do.
    fn axis(&self, label: String, outward: impl Fn(f64) -> f64) -> (Axis, Vec<f64>) {
        let edges: Vec<f64> = self.edges().into_iter().map(outward).collect();
        let axis = if self.log {
            Axis::log(label)
        } else {
            Axis::linear(label)
        };
        let ends = edges.first().copied().zip(edges.last().copied());
        let axis = ends.map_or(axis.clone(), |(lo, hi)| axis.within(lo, hi));
        (axis, edges)
    }
}
