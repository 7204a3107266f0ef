//! Fig. 16: K = 0.14 past the torus bifurcation and near the resonance 1:4.

use super::runs::of_runs;
use crate::pieces::Pieces;
use crate::product::{Made, Make, Product};
use twinslip::error::Result;

/// The figure.
pub const FIGURE: Product = Product {
    id: "fig16",
    title: "Large excursions past the torus bifurcation at K = 0.14",
    caption: "(a) V_H = 0.0768, just past the torus point 0.07674: the run settles on no small torus, but makes large excursions, as after a subcritical bifurcation, and its largest Lyapunov exponent is positive. The cubic coefficient says that the bifurcation is supercritical, but only just: the small torus exists up to V_H = 0.076742 or so, and then is gone. (b) V_H = 0.079: near the strong resonance 1:4 three little loops and one long excursion with a fast drop of stress follow one another; the returns have four branches. The fast interface is solid, the slow one dashed. The text gives no V_H; both are chosen.",
    alt: "Two rows of panels: stress, states and slip rates in time, the phase plane and the return map. The upper row shows irregular large excursions, the lower one a pattern of three small loops and a large one.",
    scenes: &["fig16a", "fig16a-map", "fig16b", "fig16b-map"],
    make: Make::Figure(make),
};

/// So much time of the end is shown.
const SHOWN: f64 = 6000.0;

fn make(pieces: &Pieces<'_>) -> Result<Made> {
    let scenes = [("fig16a", "(a) "), ("fig16b", "(b) ")];
    of_runs(pieces, &scenes, SHOWN)
}
