//! Fig. 14: the angle of the multipliers along the torus curve.

use super::plane::{lines, mark, method, symbol};
use crate::product::{Made, Make, Product};
use crate::sheet::Sheet;
use crate::{Curves, Pieces};
use twinslip::bifurcation::{Label, LocusRow};
use twinslip::error::Result;
use twinslip_output::plot::{Axis, Drawing, Mark, Panel, PlotSeries, Stroke};

/// The figure.
pub const FIGURE: Product = Product {
    id: "fig14",
    title: "Angle of the Floquet multipliers along the torus curve",
    caption: "Along the torus curve of Fig. 12 the multipliers are exp(±iθ). Their angle passes through π/2 three times (resonance 1:4) and through 2π/3 once (1:3), and reaches π at the end of the curve, the resonance 1:2, with a vertical tangent against V_H. (a) against V_H, (b) against K.",
    alt: "The angle of the multipliers over pi against driving velocity and against stiffness, with horizontal dotted lines at one half and two thirds and the resonances marked.",
    scenes: &["fig12"],
    make: Make::Figure(make),
};

/// theta/pi at the resonances 1:4, 1:3 and 1:2.
const LINES: [f64; 3] = [0.5, 2.0 / 3.0, 1.0];

fn make(pieces: &Pieces<'_>) -> Result<Made> {
    let torus = pieces.curves("fig12")?;
    let mut sheet = Sheet::new();
    sheet.add_curves("TR", &torus);
    let driving = |row: &LocusRow| row.driving.value;
    let stiffness = |row: &LocusRow| row.stiffness.value;
    Ok(Made {
        sheet,
        drawing: Some(Drawing::columns(vec![vec![
            panel(
                &torus,
                "(a)",
                Axis::linear("driving velocity V_H [V*]"),
                driving,
            ),
            panel(&torus, "(b)", Axis::linear("stiffness K [aσ/L]"), stiffness),
        ]])),
        method: method(torus.plan.following.tolerance),
    })
}

fn panel(torus: &Curves, title: &str, x: Axis, of: fn(&LocusRow) -> f64) -> Panel {
    let angle = |row: &LocusRow| row.angle_over_pi.unwrap_or(f64::NAN);
    let xs: Vec<f64> = torus.rows.iter().map(of).collect();
    let least = xs.iter().copied().fold(f64::INFINITY, f64::min);
    let most = xs.iter().copied().fold(f64::NEG_INFINITY, f64::max);
    let mut series = vec![lines(torus, "", (2, Stroke::Solid), of, angle).wide()];
    for height in LINES {
        let line = PlotSeries::new("", vec![least, most], vec![height; 2]);
        series.push(line.stroke(Stroke::Dotted).colour(6));
    }
    let strong = |row: &&LocusRow| matches!(row.label, Some(Label::R2 | Label::R3 | Label::R4));
    let named = |row: &LocusRow| {
        let mark = mark(row.label?, of(row), row.angle_over_pi?)?;
        Some(Mark {
            label: symbol(row.label?)?.2.to_owned(),
            ..mark
        })
    };
    Panel {
        series,
        marks: torus.rows.iter().filter(strong).filter_map(named).collect(),
        ..Panel::new(title, x, Axis::linear("θ/π").within(0.0, 1.05))
    }
}
