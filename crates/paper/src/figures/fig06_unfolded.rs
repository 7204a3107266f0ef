//! Beside Fig. 6: the folds of steady states of interfaces that differ, with the pitchforks of equal ones as their cusps.

use crate::product::{Made, Make, Product};
use crate::sheet::Sheet;
use crate::{GeneralCurves, Pieces};
use twinslip::bifurcation::Label;
use twinslip::error::Result;
use twinslip_output::plot::{Axis, Block, Drawing, Mark, Note, Panel, PlotSeries, Stroke, Symbol};

/// The figure.
pub const FIGURE: Product = Product {
    id: "fig06-unfolded",
    title: "Folds of steady states of interfaces that differ",
    caption: "(a) The curves of folds in the plane of driving velocity and residual strength c_2 of the second interface, that of the first one being c_1 = 0.001. Where both are equal (dotted line) the pitchforks of Fig. 6 at 2 V_M and 2 V_m are cusps of these curves, and the saddle-node V_sn is two folds at one place. One of these hardly knows of c_2: there the first interface slides fast, and the second one creeps. On the other one it is the second that slides fast. No steady state depends on K.

(b) The cusp at 2 V_M and (c) that at 2 V_m enlarged: near them the folds lie at a distance as |c_2 - c_1|^(2/3).",
    alt: "Curves of folds in the plane of driving velocity and residual strength of the second interface: two curves with a cusp on the line of equal strengths, and two that cross on it at a larger velocity; below, both cusps enlarged.",
    scenes: &["fig06-unfolded"],
    make: Make::Figure(make),
};

/// c_1.
const EQUAL: f64 = 1e-3;
/// The frames about the cusps: V_H and c_2.
const FIRST: [(f64, f64); 2] = [(0.04985, 0.04995), (7e-4, 1.4e-3)];
const SECOND: [(f64, f64); 2] = [(700.0, 1500.0), (7e-4, 1.4e-3)];

fn make(pieces: &Pieces<'_>) -> Result<Made> {
    let folds = pieces.general("fig06-unfolded")?;
    let mut sheet = Sheet::new();
    sheet.add_general("folds", &folds);
    let mut whole = panel(
        &folds,
        "(a)",
        Axis::log("driving velocity V_H [V*]").within(1e-2, 1e6),
        Axis::log("residual strength c₂").within(5e-4, 2e-3),
    );
    whole.series[0].label = "c₂ = c₁".into();
    whole.series[1].label = "folds".into();
    whole.notes = vec![
        Note::new(0.055, 1.6e-3, "2 V_M"),
        Note::new(2e3, 1.6e-3, "2 V_m"),
        Note::new(5e4, 1.6e-3, "V_sn"),
    ];
    let near = |title: &str, [x, y]: [(f64, f64); 2]| {
        let mut panel = panel(
            &folds,
            title,
            Axis::linear("driving velocity V_H [V*]").within(x.0, x.1),
            Axis::linear("residual strength c₂").within(y.0, y.1),
        );
        panel.marks.retain(|mark| (x.0..=x.1).contains(&mark.x));
        panel
    };
    let block = |columns| Block {
        title: String::new(),
        columns,
    };
    Ok(Made {
        sheet,
        drawing: Some(Drawing::blocks(vec![
            block(vec![vec![whole]]),
            block(vec![
                vec![near("(b) near 2 V_M", FIRST)],
                vec![near("(c) near 2 V_m", SECOND)],
            ]),
        ])),
        method: "The steady state and the determinant of its Jacobian with exact derivatives, both parameters unknown, followed by pseudo-arclength; special points to 1e-11".into(),
    })
}

/// The folds above the line of equal interfaces.
fn panel(folds: &GeneralCurves, title: &str, x: Axis, y: Axis) -> Panel {
    let (from, to) = x.range.unwrap_or((1e-2, 1e6));
    let equal = PlotSeries::new("", vec![from, to], vec![EQUAL; 2]).stroke(Stroke::Dotted);
    let (mut xs, mut ys) = (Vec::new(), Vec::new());
    for curve in folds.rows.chunk_by(|a, b| a.number == b.number) {
        let of = |i: usize| curve.iter().map(move |row| row.parameters[i].value);
        xs.extend(of(0).chain([f64::NAN]));
        ys.extend(of(1).chain([f64::NAN]));
    }
    let mut panel = Panel::new(title, x, y);
    panel.series = vec![equal.colour(6), PlotSeries::new("", xs, ys).colour(0)];
    let cusps = folds.special.iter();
    let cusps = cusps.filter(|one| one.label == Some(Label::Cp));
    panel.marks = cusps
        .map(|one| {
            let [v, c] = [0, 1].map(|i| one.parameters[i].value);
            Mark::new(v, c, "cusp").symbol(Symbol::Circle)
        })
        .collect();
    panel
}
