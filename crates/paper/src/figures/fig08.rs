//! Fig. 8: two runs at K = 0.14 from the symmetric equilibrium to the asymmetric orbit.

use super::runs::of_runs;
use crate::pieces::Pieces;
use crate::product::{Made, Make, Product};
use twinslip::error::Result;

/// The figure.
pub const FIGURE: Product = Product {
    id: "fig08",
    title: "From the symmetric equilibrium to asymmetric stick-slip, K = 0.14",
    caption: "Two runs from beside the symmetric equilibrium. They leave it across the symmetric subspace, pass by the asymmetric equilibrium, which is unstable too, and end on the stable asymmetric orbit. Stress, states and slip rates in time; the paths of both interfaces, the fast one solid and the slow one dashed, in the plane of slip rate and stress (the dotted line is the steady-state law); the path in the asymmetric subspace; the return map to the section τ = τ_ss(V_H/2), where the returns run onto a fixed point on the diagonal.

(a) V_H = 0.07, just above the Hopf point: soft oscillations. (b) V_H = 10: stick-slip, a saw-tooth of stress whose drops are carried by one interface. Its state falls far below c = 0.001 while the other one stays of order 0.1. The text gives no V_H for this figure; these are chosen.",
    alt: "Two rows of panels, each with stress, states and slip rates in time, the phase plane, the asymmetric subspace and the return map. The upper row shows small growing oscillations, the lower row a saw-tooth of stress.",
    scenes: &["fig08a", "fig08a-map", "fig08b", "fig08b-map"],
    make: Make::Figure(make),
};

fn make(pieces: &Pieces<'_>) -> Result<Made> {
    let scenes = [("fig08a", "(a) "), ("fig08b", "(b) ")];
    of_runs(pieces, &scenes, f64::INFINITY)
}
