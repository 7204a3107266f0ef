//! Fig. 6: the phase diagram, all curves of bifurcations in the (V_H, K) plane.

use super::plane::{in_plane, method, resonances};
use super::regimes::regimes;
use crate::pieces::Pieces;
use crate::product::{Made, Make, Product};
use crate::sheet::Sheet;
use twinslip::error::Result;
use twinslip_output::plot::{Axis, Drawing, Note, Panel, PlotSeries, Stroke};

/// The figure.
pub const FIGURE: Product = Product {
    id: "fig06",
    title: "Phase diagram of two spinodal interfaces",
    caption: "(a) What slides where, in the plane of driving velocity and stiffness. Equilibria: pitchforks of the symmetric state at V_H = 2 V_M and 2 V_m, the saddle-node of the asymmetric one at V_sn (vertical lines, for no equilibrium depends on K), and the Hopf points of the asymmetric (H_a) and of the symmetric (H_s) state. Orbits: below PF symmetric stick-slip is stable beside asymmetric stick-slip; SN is the fold at which the asymmetric orbits of the second Hopf point end; within the loop of torus (TR) and period-doubling (PD) curves asymmetric orbits are unstable and the motion is complicated. The circle is the strong resonance 1:2. (b) The corner between 2 V_M and H_s enlarged.

The paper found PF at one stiffness after another, for two-parameter continuation failed; here all curves are followed in both parameters.",
    alt: "The plane of driving velocity, logarithmic, and stiffness, with the curves of all bifurcations of equilibria and periodic orbits and the names of the regions between them; below it the corner of small driving velocities enlarged.",
    scenes: &[
        "fig06-orbit-folds",
        "fig12-period-doubling",
        "fig06-orbit-pitchforks",
        "fig12",
        "fig06",
        "fig06-pitchforks",
        "fig06-folds",
    ],
    make: Make::Figure(make),
};

/// Scene, name in sheet and legend, colour, stroke, whether it is broad.
const CURVES: [(&str, &str, usize, Stroke, bool); 7] = [
    (
        "fig06-pitchforks",
        "pf: pitchforks of equilibria",
        0,
        Stroke::Solid,
        false,
    ),
    (
        "fig06-folds",
        "sn: saddle-node of equilibria",
        0,
        Stroke::Dashed,
        false,
    ),
    (
        "fig06",
        "H: Hopf points, H_a asymmetric, H_s symmetric",
        1,
        Stroke::DashDot,
        true,
    ),
    (
        "fig06-orbit-pitchforks",
        "PF: pitchforks of orbits",
        7,
        Stroke::DashDotDot,
        true,
    ),
    (
        "fig06-orbit-folds",
        "SN: saddle-nodes of orbits",
        5,
        Stroke::Dashed,
        false,
    ),
    ("fig12", "TR: torus", 2, Stroke::Solid, false),
    (
        "fig12-period-doubling",
        "PD: period doubling",
        3,
        Stroke::Dotted,
        true,
    ),
];

/// The frame of the corner: V_H and K.
const CORNER: [(f64, f64); 2] = [(0.047, 0.22), (0.0, 0.24)];

fn make(pieces: &Pieces<'_>) -> Result<Made> {
    let mut sheet = Sheet::new();
    let mut panel = Panel::new(
        "(a)",
        Axis::log("driving velocity V_H [V*]").within(1e-3, 1e7),
        Axis::linear("stiffness K [aσ/L]").within(0.0, 0.45),
    );
    for (scene, name, colour, stroke, wide) in CURVES {
        let curves = pieces.curves(scene)?;
        let short = name.split(':').next().unwrap_or(name);
        sheet.add_curves(short, &curves);
        let line = in_plane(&curves, name, (colour, stroke));
        panel.series.push(PlotSeries { wide, ..line });
    }
    let torus = pieces.curves("fig12")?;
    let mut double = resonances(&torus);
    double.retain(|mark| mark.label == "1:2");
    panel.marks = double;
    panel.areas = regimes(pieces)?;
    let mut corner = Panel {
        x: Axis::log("driving velocity V_H [V*]").within(CORNER[0].0, CORNER[0].1),
        y: Axis::linear("stiffness K [aσ/L]").within(CORNER[1].0, CORNER[1].1),
        title: "(b) the corner of TR, PD and SN".into(),
        ..panel.clone()
    };
    for series in &mut corner.series {
        series.label.clear();
    }
    for area in &mut corner.areas {
        area.label.clear();
    }
    corner.notes = vec![
        Note::new(0.052, 0.21, "2 V_M"),
        Note::new(0.079, 0.21, "H_a"),
        Note::new(0.19, 0.165, "H_s"),
        Note::new(0.19, 0.105, "PF"),
        Note::new(0.135, 0.055, "SN"),
        Note::new(0.098, 0.215, "TR"),
        Note::new(0.084, 0.12, "PD"),
    ];
    panel.notes = vec![
        Note::new(7e-3, 0.33, "both"),
        Note::new(7.0, 0.428, "one slides"),
        Note::new(4.0, 0.27, "asymmetric"),
        Note::new(7e5, 0.33, "both slide"),
        Note::new(25.0, 0.06, "symmetric too"),
        Note::new(0.022, 0.4, "2 V_M"),
        Note::new(2000.0, 0.4, "2 V_m"),
        Note::new(1.4e5, 0.4, "V_sn"),
        Note::new(60.0, 0.37, "H_a"),
        Note::new(30.0, 0.205, "H_s"),
    ];
    Ok(Made {
        sheet,
        drawing: Some(Drawing::columns(vec![vec![panel, corner]])),
        method: format!(
            "{}; curves of equilibria from their conditions, in closed form where there is one",
            method(1e-11)
        ),
    })
}
