//! Fig. 5: the steady states of two spinodal interfaces at K = 0.45 over nine decades of V_H.

use super::plane::{keys, labels, marks};
use crate::product::{Made, Make, Product};
use crate::sheet::Sheet;
use crate::{Branches, Pieces};
use twinslip::bifurcation::BranchRow;
use twinslip::error::Result;
use twinslip::friction::steady_stress;
use twinslip_output::plot::{Axis, Block, Drawing, Panel, PlotSeries, Stroke};
use twinslip_tasks::views::{branch_lines, named_strokes};

/// The figure.
pub const FIGURE: Product = Product {
    id: "fig05",
    title: "Steady states at K = 0.45",
    caption: "All steady states of the two interfaces: stable solid, unstable dashed. Both share the slip (blue) but between the pitchforks at V_H = 2 V_M and 2 V_m, where this state is unstable and an asymmetric one (vermillion) exists with a slow and a fast interface. It comes into being supercritically at 2 V_M and ends at the saddle-node V_sn = 4.298e4 V*, from where an unstable branch leads back to the subcritical pitchfork at 2 V_m.

(a) The stress follows τ_ss(V_H/2) (thin dashed) where both slide, and τ_ss(V_H) (thin dotted) where one slides alone. (b) The same about 2 V_M and (c) about 2 V_m, where the unstable asymmetric state, whose stress is nearly that of the stable one further on, parts from it. (d) The states, (e) the slip rates: the slow interface creeps below V_M, and all but stops where V_H is large.",
    alt: "Five panels of steady states against driving velocity: stress, stress enlarged near both pitchforks, states, and slip rates. The symmetric branch is unstable between two pitchforks; an asymmetric branch connects the first pitchfork with a saddle-node and the second pitchfork.",
    scenes: &["fig05"],
    make: Make::Figure(make),
};

/// The frames about the pitchforks: V_H and stress.
const FIRST: [(f64, f64); 2] = [(0.03, 0.2), (11.3, 11.62)];
pub const SECOND: [(f64, f64); 2] = [(500.0, 3000.0), (8.62, 9.1)];

fn make(pieces: &Pieces<'_>) -> Result<Made> {
    let branches = pieces.branches("fig05")?;
    let mut sheet = Sheet::new();
    sheet.add_branches("steady states", &branches);
    let rates = panel(
        &branches,
        "(e) slip rates",
        Axis::log("slip rates V₁, V₂ [V*]"),
        &[&|row| row.slip_rate[0], &|row| row.slip_rate[1]],
    );
    let states = panel(
        &branches,
        "(d) states",
        Axis::log("states ψ₁, ψ₂"),
        &[&|row| row.state[0], &|row| row.state[1]],
    );
    let mut all = stress(&branches, "(a) stress, K = 0.45");
    all.keys = keys(labels([&*branches]));
    all.strokes = named_strokes(&all.series[2..]);
    let near = |title: &str, [x, y]: [(f64, f64); 2]| {
        let mut panel = stress(&branches, title);
        panel.x = panel.x.within(x.0, x.1);
        panel.y = panel.y.within(y.0, y.1);
        panel.marks.retain(|mark| (x.0..=x.1).contains(&mark.x));
        for series in &mut panel.series {
            series.label.clear();
        }
        panel
    };
    let block = |columns| Block {
        title: String::new(),
        columns,
    };
    let (first, second) = (
        near("(b) near 2 V_M", FIRST),
        near("(c) near 2 V_m", SECOND),
    );
    Ok(Made {
        sheet,
        drawing: Some(Drawing::blocks(vec![
            block(vec![vec![all]]),
            block(vec![vec![first], vec![second]]),
            block(vec![vec![states], vec![rates]]),
        ])),
        method: "Steady states in closed form or from certain brackets, stability by interval arithmetic on the characteristic polynomials, special points to 1e-11".into(),
    })
}

type Of<'a> = &'a dyn Fn(&BranchRow) -> f64;

fn panel(branches: &Branches, title: &str, y: Axis, of: &[Of<'_>]) -> Panel {
    let rows = &branches.rows;
    let x = |row: &BranchRow| row.driving;
    let mut panel = Panel::new(title, Axis::log("driving velocity V_H [V*]"), y);
    for (i, of) in of.iter().enumerate() {
        panel.series.extend(branch_lines(rows, &x, of, i == 0));
        panel.marks.extend(marks(rows, x, of));
    }
    panel
}

fn stress(branches: &Branches, title: &str) -> Panel {
    let mut panel = panel(
        branches,
        title,
        Axis::linear("stress τ [aσ]"),
        &[&|row| row.stress],
    );
    let law = branches.plan.system.law;
    let driving: Vec<f64> = (0..=360)
        .map(|i| 1e-3 * 10f64.powf(f64::from(i) / 40.0))
        .collect();
    let of = |part: f64| {
        driving
            .iter()
            .map(|&v| steady_stress(&law, part * v))
            .collect()
    };
    let thin = |label: &str, part, stroke| {
        PlotSeries::new(label, driving.clone(), of(part))
            .stroke(stroke)
            .colour(6)
    };
    // Below the others, for the branches lie on them.
    panel
        .series
        .insert(0, thin("τ_ss(V_H)", 1.0, Stroke::Dotted));
    panel
        .series
        .insert(1, thin("τ_ss(V_H/2)", 0.5, Stroke::Dashed));
    panel
}
