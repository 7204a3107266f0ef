//! Fig. 13: the torus at K = 0.2, V_H = 0.102.

use super::runs::of_runs;
use crate::pieces::Pieces;
use crate::product::{Made, Make, Product};
use twinslip::error::Result;

/// The figure.
pub const FIGURE: Product = Product {
    id: "fig13",
    title: "A torus just past its bifurcation, K = 0.2, V_H = 0.102",
    caption: "The asymmetric orbit has lost its stability to a torus: the extremes of stress and slip rate are modulated in time, and the returns to the section τ = τ_ss(V_H/2) lie on a closed curve. The fast interface is solid, the slow one dashed. The rotation number, the part of a turn that a return goes around, is 0.2109; two Lyapunov exponents vanish within their budgets.",
    alt: "Modulated oscillations of stress, states and slip rates in time, the phase plane, and the closed curves of the return map.",
    scenes: &["fig13-map", "fig13"],
    make: Make::Figure(make),
};

/// So much time of the end is shown.
const SHOWN: f64 = 3500.0;

fn make(pieces: &Pieces<'_>) -> Result<Made> {
    of_runs(pieces, &[("fig13", "")], SHOWN)
}
