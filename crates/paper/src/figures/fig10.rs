//! Fig. 10: the symmetric and the asymmetric orbit at K = 0.05, V_H = 0.2, both stable.

use super::runs::{last, method, title, with_phase_space};
use crate::pieces::Pieces;
use crate::product::{Made, Make, Product};
use crate::sheet::Sheet;
use twinslip::error::Result;
use twinslip_output::plot::Drawing;

/// The figure.
pub const FIGURE: Product = Product {
    id: "fig10",
    title: "Symmetric and asymmetric stick-slip, both stable, at K = 0.05, V_H = 0.2",
    caption: "The last three cycles of two runs that differ in their start alone. (a) A symmetric start stays symmetric for ever, and so does the orbit it ends on. (b) An asymmetric start finds the asymmetric orbit. Both look alike in stress; what differs are the peaks of the slip rates, and, while both interfaces creep through the slow part of the cycle, next to nothing. In time; in the plane of slip rate and stress with the steady-state law; the phase space (τ, w₁ + w₂, w₁ − w₂), w = log₁₀ ψ, in (b) from three sides and in space. The fast interface is solid, the slow one dashed.",
    alt: "Two rows of panels: stress, states and slip rates in time, the phase plane, and two projections of the phase space. In the upper row both interfaces are one curve, in the lower row their slip rates differ at the peaks.",
    scenes: &["fig10a", "fig10b"],
    make: Make::Figure(make),
};

/// So much time of the end is shown: three cycles.
const SHOWN: f64 = 1450.0;

fn make(pieces: &Pieces<'_>) -> Result<Made> {
    let (a, b) = (pieces.run("fig10a")?, pieces.run("fig10b")?);
    let mut sheet = Sheet::new();
    sheet.add_run("a", &a);
    sheet.add_run("b", &b);
    Ok(Made {
        sheet,
        drawing: Some(Drawing::blocks(
            [
                with_phase_space(&title("(a) symmetric: ", &a), &a, &last(&a, SHOWN)),
                with_phase_space(&title("(b) asymmetric: ", &b), &b, &last(&b, SHOWN)),
            ]
            .concat(),
        )),
        method: format!("(a) {}, in two dimensions; (b) {}", method(&a), method(&b)),
    })
}
