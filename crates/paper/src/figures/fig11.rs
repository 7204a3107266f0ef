//! Fig. 11: at K = 0.01 an asymmetric start ends on the symmetric orbit.

use super::runs::{method, title, with_phase_space};
use crate::pieces::Pieces;
use crate::product::{Made, Make, Product};
use crate::sheet::Sheet;
use twinslip::error::Result;
use twinslip_output::plot::Drawing;

/// The figure.
pub const FIGURE: Product = Product {
    id: "fig11",
    title: "An asymmetric start ends on the symmetric orbit, K = 0.01, V_H = 0.2",
    caption: "Where the slab is soft enough, the interfaces synchronise. A start with unequal states is attracted by the symmetric orbit; the fast interface (solid) and the slow one (dashed) soon coincide, and w₁ − w₂ goes to zero in the phase space. The orbit is a relaxation oscillation whose slow part follows the steady-state law (dotted).",
    alt: "Stress, states and slip rates in time, the phase plane with the steady-state law, and three projections of the phase space, in which the asymmetry decays.",
    scenes: &["fig11"],
    make: Make::Figure(make),
};

fn make(pieces: &Pieces<'_>) -> Result<Made> {
    let run = pieces.run("fig11")?;
    let mut sheet = Sheet::new();
    sheet.add_run("run", &run);
    Ok(Made {
        sheet,
        drawing: Some(Drawing::blocks(with_phase_space(
            &title("", &run),
            &run,
            &run.rows,
        ))),
        method: method(&run),
    })
}
