//! Fig. 6: the phase diagram, all curves of bifurcations in the (V_H, K) plane.

use super::plane::{in_plane, method, resonances};
use crate::error::Result;
use crate::output::plot::{Axis, Drawing, Note, Panel, Series, Stroke};
use crate::paper::pieces::Pieces;
use crate::paper::product::{Made, Make, Product};
use crate::paper::sheet::Sheet;

/// The figure.
pub const FIGURE: Product = Product {
    id: "fig06",
    title: "Phase diagram of two spinodal interfaces",
    caption: "What slides where, in the plane of driving velocity and stiffness. Equilibria: pitchforks of the symmetric state at V_H = 2 V_M and 2 V_m, the saddle-node of the asymmetric one at V_sn (vertical lines, for no equilibrium depends on K), and the Hopf points of the asymmetric (H_a) and of the symmetric (H_s) state. Orbits: below PF symmetric stick-slip is stable beside asymmetric stick-slip; SN is the fold at which the asymmetric orbits of the second Hopf point end; within the loop of torus (TR) and period-doubling (PD) curves asymmetric orbits are unstable and the motion is complicated. The circle is the strong resonance 1:2.

The paper found PF at one stiffness after another, for two-parameter continuation failed; here all curves are followed in both parameters.",
    alt: "The plane of driving velocity, logarithmic, and stiffness, with the curves of all bifurcations of equilibria and periodic orbits and the names of the regions between them.",
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
    ("fig06", "H: Hopf points", 1, Stroke::DashDot, true),
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

fn make(pieces: &Pieces<'_>) -> Result<Made> {
    let mut sheet = Sheet::new();
    let mut panel = Panel::new(
        "",
        Axis::log("driving velocity V_H [V*]").within(1e-3, 1e6),
        Axis::linear("stiffness K [aσ/L]").within(0.0, 0.45),
    );
    for (scene, name, colour, stroke, wide) in CURVES {
        let curves = pieces.curves(scene)?;
        let short = name.split(':').next().unwrap_or(name);
        sheet.add_curves(short, &curves);
        let line = in_plane(&curves, name, (colour, stroke));
        panel.series.push(Series { wide, ..line });
    }
    let torus = pieces.curves("fig12")?;
    let double = resonances(&torus);
    panel
        .marks
        .extend(double.into_iter().filter(|mark| mark.label == "1:2"));
    panel.notes = vec![
        Note::new(7e-3, 0.33, "both slide"),
        Note::new(7.0, 0.425, "one slides, steadily"),
        Note::new(4.0, 0.27, "asymmetric stick-slip"),
        Note::new(6e3, 0.2, "one or both"),
        Note::new(2.1e5, 0.33, "both slide"),
        Note::new(8.0, 0.065, "symmetric stick-slip too"),
        Note::new(0.05, 0.4, "2 V_M"),
        Note::new(810.0, 0.4, "2 V_m"),
        Note::new(4.3e4, 0.4, "V_sn"),
        Note::new(30.0, 0.3565, "H_a"),
        Note::new(30.0, 0.1878, "H_s"),
    ];
    Ok(Made {
        sheet,
        drawing: Some(Drawing::columns(vec![vec![panel]])),
        method: format!(
            "{}; curves of equilibria from their conditions, in closed form where there is one",
            method(1e-11)
        ),
    })
}
