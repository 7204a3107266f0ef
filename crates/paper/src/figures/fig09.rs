//! Fig. 9: the bifurcation diagram at a small stiffness, of which the paper has a sketch.

use super::fig07::amplitudes;
use super::plane::{marks, method};
use crate::product::{Made, Make, Product};
use crate::sheet::Sheet;
use crate::{Branches, Pieces};
use twinslip::bifurcation::{BranchRow, Label};
use twinslip::error::Result;
use twinslip_output::plot::{Axis, Block, Drawing, Mark, Panel};
use twinslip_tasks::views::branch_lines;

/// The figure.
pub const FIGURE: Product = Product {
    id: "fig09",
    title: "Bifurcation diagram at small stiffness, K = 0.05, computed",
    caption: "The paper sketches this diagram, because symmetric and asymmetric orbits lie too near one another to be drawn. Here it is computed. (a) Extremes of stress of orbits and equilibria over the whole range of V_H. Names are the paper's, without those of the points that the next panel shows. (b) The same near 2 V_M, where almost everything happens, and (c) within the thousandth of V_H in which the symmetric orbit grows to full size.

(d) to (f) tell the orbits apart: how unlike the two interfaces are where stress is greatest, |ln ψ₁ − ln ψ₂|, on a logarithmic axis, on which asymmetric orbits fall steeply towards the pitchforks where they meet the symmetric ones (not drawn, for theirs is zero). The branch from the first Hopf point does so after a torus point, two period doublings and a fold; the one from the second Hopf point comes down in V_H, folds at the saddle-node and goes back, unstable, to the symmetric branch. Between the two pitchforks the symmetric orbits are stable, beside the asymmetric ones from the fold on.",
    alt: "Six panels against driving velocity: extremes of stress over the whole range and twice enlarged near the first Hopf points, and below them the asymmetry of the orbits, which vanishes at the pitchforks of orbits.",
    scenes: &["fig09", "fig09-equilibria"],
    make: Make::Figure(make),
};

/// V_H in the frames: all, the crowd, and the thick of it.
const ALL: (f64, f64) = (0.03, 1000.0);
const CROWD: (f64, f64) = (0.0495, 0.085);
const THICK: (f64, f64) = (0.06635, 0.06655);
/// Special points in the next frame stand there only; in the last one all do.
const NONE: (f64, f64) = (0.0, 0.0);

/// Asymmetries in the frames.
const APART: (f64, f64) = (1e-9, 20.0);

fn make(pieces: &Pieces<'_>) -> Result<Made> {
    let (orbits, rest) = (
        pieces.branches("fig09")?,
        pieces.branches("fig09-equilibria")?,
    );
    let mut sheet = Sheet::new();
    sheet.add_branches("orbits", &orbits);
    sheet.add_branches("equilibria", &rest);
    let stress = |title: &str, frame, (from, to): (f64, f64)| {
        let mut panel = amplitudes(title, &orbits, &rest, frame);
        panel.marks.retain(|mark| !(from..=to).contains(&mark.x));
        let most = |row: &BranchRow| row.stress_range.1;
        for row in rest.rows.iter().chain(&orbits.rows) {
            let same = |mark: &&mut Mark| mark.x == row.driving && mark.y == most(row);
            if let (Some(mark), Some(name)) = (panel.marks.iter_mut().find(same), name(row)) {
                mark.label = name.to_owned();
            }
        }
        panel
    };
    let bare = |mut panel: Panel| {
        panel.keys.clear();
        panel.strokes.clear();
        panel.series.iter_mut().for_each(|one| one.label.clear());
        panel
    };
    let block = |panels: Vec<Panel>| Block {
        title: String::new(),
        columns: panels.into_iter().map(|panel| vec![panel]).collect(),
    };
    let unlike = |title: &str, frame, next| asymmetry(title, &orbits, frame, next);
    let blocks = vec![
        block(vec![stress("(a) extremes of stress, K = 0.05", ALL, CROWD)]),
        block(vec![
            bare(stress("(b) near 2 V_M", CROWD, THICK)),
            bare(stress("(c) nearer", THICK, NONE)),
        ]),
        block(vec![unlike("(d) asymmetry at greatest stress", ALL, CROWD)]),
        block(vec![
            unlike("(e) near 2 V_M", CROWD, THICK),
            unlike("(f) nearer", THICK, NONE),
        ]),
    ];
    Ok(Made {
        sheet,
        drawing: Some(Drawing::blocks(blocks)),
        method: method(orbits.plan.following.tolerance),
    })
}

/// What the paper calls a special point.
fn name(row: &BranchRow) -> Option<&'static str> {
    let symmetric = row.slip_rate[0] == row.slip_rate[1];
    Some(match row.label? {
        Label::Hb if symmetric => "H_s",
        Label::Hb => "H_a",
        Label::Bp => "pf",
        Label::Lp => "sn",
        Label::Sn => "SN",
        Label::Pf => "PF",
        Label::Pd => "PD",
        Label::Tr => "TR",
        _ => return None,
    })
}

/// How unlike the states are where stress is greatest.
fn asymmetry(
    title: &str,
    orbits: &Branches,
    (lo, hi): (f64, f64),
    (from, to): (f64, f64),
) -> Panel {
    let x = |row: &BranchRow| row.driving;
    let apart = |row: &BranchRow| (row.state[0] / row.state[1]).ln().abs();
    let mut points = marks(&orbits.rows, x, apart);
    points.retain(|mark| (lo..=hi).contains(&mark.x) && !(from..=to).contains(&mark.x));
    let mut series = branch_lines(&orbits.rows, &x, &apart, false);
    series.iter_mut().for_each(|orbits| orbits.wide = true);
    Panel {
        series,
        marks: points,
        ..Panel::new(
            title,
            Axis::log("driving velocity V_H [V*]").within(lo, hi),
            Axis::log("|ln ψ₁ − ln ψ₂|").within(APART.0, APART.1),
        )
    }
}
