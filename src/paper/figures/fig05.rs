//! Fig. 5: the steady states of two spinodal interfaces at K = 0.45 over nine decades of V_H.

use super::plane::{keys, labels, marks};
use crate::bifurcation::BranchRow;
use crate::error::Result;
use crate::friction::steady_stress;
use crate::output::plot::{Axis, Drawing, Panel, Series, Stroke};
use crate::paper::pieces::{Branches, Pieces};
use crate::paper::product::{Made, Make, Product};
use crate::paper::sheet::Sheet;
use crate::views::branch_lines;

/// The figure.
pub const FIGURE: Product = Product {
    id: "fig05",
    title: "Steady states at K = 0.45",
    caption: "All steady states of the two interfaces: stable solid, unstable dashed. Both share the slip (blue) but between the pitchforks at V_H = 2 V_M and 2 V_m, where this state is unstable and an asymmetric one (vermillion) exists with a slow and a fast interface. It comes into being supercritically at 2 V_M and ends at the saddle-node V_sn = 4.298e4 V*, from where an unstable branch leads back to the subcritical pitchfork at 2 V_m.

(a) The stress follows τ_ss(V_H/2) (thin dashed) where both slide, and τ_ss(V_H) (thin dotted) where one slides alone. (b) The same about 2 V_M. (c) The states, (d) the slip rates: the slow interface creeps below V_M, and all but stops where V_H is large.",
    alt: "Four panels of steady states against driving velocity: stress, stress enlarged near the first pitchfork, states, and slip rates. The symmetric branch is unstable between two pitchforks; an asymmetric branch connects the first pitchfork with a saddle-node and the second pitchfork.",
    scenes: &["fig05"],
    make: Make::Figure(make),
};

/// The frame about the first pitchfork: V_H and stress.
const NEAR: [(f64, f64); 2] = [(0.03, 0.2), (11.3, 11.62)];

fn make(pieces: &Pieces<'_>) -> Result<Made> {
    let branches = pieces.branches("fig05")?;
    let mut sheet = Sheet::new();
    sheet.add_branches("steady states", &branches);
    let rates = panel(
        &branches,
        "(d) slip rates",
        Axis::log("slip rates V₁, V₂ [V*]"),
        &[&|row| row.slip_rate[0], &|row| row.slip_rate[1]],
    );
    let states = panel(
        &branches,
        "(c) states",
        Axis::log("states ψ₁, ψ₂"),
        &[&|row| row.state[0], &|row| row.state[1]],
    );
    let mut stress = stress(&branches, "(a) stress");
    stress.keys = keys(labels([&*branches]));
    let mut near = self::stress(&branches, "(b) the same near 2 V_M");
    near.x = near.x.within(NEAR[0].0, NEAR[0].1);
    near.y = near.y.within(NEAR[1].0, NEAR[1].1);
    Ok(Made {
        sheet,
        drawing: Some(Drawing::columns(vec![vec![stress, states], vec![near, rates]])),
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
        Series::new(label, driving.clone(), of(part))
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
