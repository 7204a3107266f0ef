//! Fig. 12: torus and period-doubling curves with the strong resonances.

use super::plane::{in_plane, method, resonances};
use crate::pieces::Pieces;
use crate::product::{Made, Make, Product};
use crate::sheet::Sheet;
use twinslip::error::Result;
use twinslip_output::plot::{Axis, Drawing, Note, Panel, PlotSeries, Stroke};

/// The figure.
pub const FIGURE: Product = Product {
    id: "fig12",
    title: "Torus and period-doubling curves",
    caption: "(a) The loop within which asymmetric orbits are unstable: the torus curve (TR) with its strong resonances 1:4, 1:3 and 1:2, and the period-doubling curve (PD), which the torus curve meets at 1:2. Both lie between the Hopf curves of the asymmetric (H_a) and the symmetric equilibrium (H_s), right of the pitchfork at 2 V_M. (b) Enlarged about the resonance 1:2: the torus curve comes down and ends on the period-doubling curve.",
    alt: "Two panels in the plane of driving velocity and stiffness: the closed loop of torus and period-doubling curves with marked resonances, and an enlargement where both curves meet.",
    scenes: &[
        "fig12-period-doubling",
        "fig12",
        "fig06",
        "fig06-pitchforks",
    ],
    make: Make::Figure(make),
};

/// The frames: V_H and K of (a) and (b).
const WHOLE: [(f64, f64); 2] = [(0.045, 0.13), (0.0, 0.24)];
const NEAR: [(f64, f64); 2] = [(0.0985, 0.1015), (0.130, 0.146)];

fn make(pieces: &Pieces<'_>) -> Result<Made> {
    let torus = pieces.curves("fig12")?;
    let doubling = pieces.curves("fig12-period-doubling")?;
    let (hopf, forks) = (pieces.curves("fig06")?, pieces.curves("fig06-pitchforks")?);
    let mut sheet = Sheet::new();
    sheet.add_curves("TR", &torus);
    sheet.add_curves("PD", &doubling);
    let panel = |title: &str, [x, y]: [(f64, f64); 2]| Panel {
        series: vec![
            in_plane(&torus, "TR: torus", (2, Stroke::Solid)).wide(),
            PlotSeries {
                wide: true,
                ..in_plane(&doubling, "PD: period doubling", (3, Stroke::Dotted))
            },
            in_plane(
                &hopf,
                "H: Hopf points, H_a asymmetric, H_s symmetric",
                (1, Stroke::DashDot),
            ),
            in_plane(&forks, "pf: pitchforks of equilibria", (0, Stroke::Solid)),
        ],
        marks: resonances(&torus),
        ..Panel::new(
            title,
            Axis::linear("driving velocity V_H [V*]").within(x.0, x.1),
            Axis::linear("stiffness K [aσ/L]").within(y.0, y.1),
        )
    };
    let mut whole = panel("(a)", WHOLE);
    whole.notes = vec![
        Note::new(0.088, 0.12, "unstable"),
        Note::new(0.0634, 0.14, "H_a"),
        Note::new(0.1235, 0.118, "H_s"),
        Note::new(0.0545, 0.225, "2 V_M"),
    ];
    let mut near = panel("(b) near 1:2", NEAR);
    for series in &mut near.series {
        series.label.clear();
    }
    Ok(Made {
        sheet,
        drawing: Some(Drawing::columns(vec![vec![whole, near]])),
        method: method(torus.plan.following.tolerance),
    })
}
