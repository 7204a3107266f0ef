//! Figure 1: the steady friction of the Dieterich-Ruina law (4) and of the law (6), whose state is bounded, and the stiffness
//! below which one interface sticks and slips (16), in SI units.

use super::curve::{cells, geometric};
use crate::{Made, Make, Pieces, Product, Sheet};
use twinslip::error::Result;
use twinslip::friction::{Law, Parameters, critical_stiffness, steady_stress};
use twinslip::model::scales::{Material, Scales};
use twinslip_output::plot::{Axis, Drawing, Mark, Note, Panel, PlotSeries, Stroke};

/// The figure.
pub const FIGURE: Product = Product {
    id: "fig01",
    title: "Steady-state friction laws and their stability",
    caption: "(a) Steady friction coefficient μ_ss(V) of the Dieterich-Ruina law (4), dashed, and of the law (6) with t** = 100 t*, \
solid. Law (6) strengthens up to V_M (7), where the coefficient is largest.\n\n(b) Critical stiffness k_c of one interface over \
the normal stress (16). Steady sliding is unstable below each curve. Law (6) is stable at any stiffness for V < V_M, where k_c \
would be negative and nothing is drawn.",
    alt: "Two panels over slip rate. The friction of law 4 falls throughout; that of law 6 rises to a maximum and then falls \
along it. The critical stiffness of law 4 is constant; that of law 6 rises from zero at the maximum and tends to it.",
    scenes: &[],
    make: Make::Figure(make),
};

/// Slip rates in m/s.
const RATES: (f64, f64) = (1e-10, 1e-3);
const POINTS: usize = 701;

fn make(_: &Pieces<'_>) -> Result<Made> {
    // Over the normal stress: that of 1 Pa.
    let (_, scales) = Material::heslot_1994(1.0).dimensionless()?;
    let parameters = Parameters::heslot_1994();
    let (ruina, bounded) = (parameters.dieterich_ruina(), parameters.bounded());
    let mut sheet = Sheet::new();
    let mut friction = friction_panel();
    let mut stiffness = stiffness_panel();
    let strokes = [Stroke::Dashed, Stroke::Solid];
    let rows = [sampled(&ruina, &scales), sampled(&bounded, &scales)];
    let names = ["Dieterich-Ruina (4)", "law (6)"];
    for (i, rows) in rows.iter().enumerate() {
        let column = |j: usize| rows.iter().map(|row| row[j]).collect::<Vec<f64>>();
        let line = |y: Vec<f64>| {
            PlotSeries::new(names[i], column(0), y)
                .stroke(strokes[i])
                .colour(1 - i)
        };
        friction.series.push(line(column(1)));
        let unstable = |k: f64| if k >= 0.0 { k } else { f64::NAN };
        stiffness
            .series
            .push(line(column(2).into_iter().map(unstable).collect()));
        let part = ["dieterich-ruina", "bounded"][i];
        sheet.add(
            part,
            &["slip_rate", "friction", "critical_stiffness"],
            cells(rows.iter().copied()),
        );
    }
    for v in bounded.steady_extrema() {
        let mu = scales.friction * steady_stress(&bounded, v);
        let rate = v * scales.slip_rate;
        sheet.add("maximum", &["slip_rate", "friction"], cells([[rate, mu]]));
        let label = format!("V_M = {:.2}×10⁻⁸ m/s: μ_ss = {mu:.3}", rate / 1e-8);
        friction.marks.push(Mark::new(rate, mu, label));
        stiffness.marks.push(Mark::new(rate, 0.0, "V_M"));
    }
    Ok(Made {
        sheet,
        drawing: Some(Drawing::columns(vec![vec![friction, stiffness]])),
        method: "closed formulas (4), (6), (7) and (16), derivatives exact".into(),
    })
}

/// [V, mu_ss, k_c/sigma] in SI units; where the stress has an extremum among the others, for k_c is zero there.
fn sampled(law: &impl Law, scales: &Scales) -> Vec<[f64; 3]> {
    let grid = geometric(RATES.0, RATES.1, POINTS);
    let mut rates: Vec<f64> = grid.iter().map(|v| v / scales.slip_rate).collect();
    let extrema = law.steady_extrema();
    rates.extend(&extrema);
    rates.sort_by(f64::total_cmp);
    let row = |&v: &f64| {
        let k = if extrema.contains(&v) {
            0.0
        } else {
            critical_stiffness(law, v)
        };
        let mu = scales.friction * steady_stress(law, v);
        [v * scales.slip_rate, mu, k * scales.stiffness]
    };
    rates.iter().map(row).collect()
}

fn rate_axis() -> Axis {
    Axis::log("slip rate V [m/s]").within(RATES.0, RATES.1)
}

fn friction_panel() -> Panel {
    let y = Axis::linear("steady friction coefficient μ_ss").within(0.26, 0.52);
    Panel::new("(a) steady friction", rate_axis(), y)
}

fn stiffness_panel() -> Panel {
    let y = Axis::linear("critical stiffness k_c/σ [1/m]").within(-700.0, 2e4);
    let mut panel = Panel::new("(b) stability", rate_axis(), y);
    panel.notes = vec![
        Note::new(3e-6, 7e3, "unstable: stick-slip"),
        Note::new(3e-6, 1.8e4, "stable"),
        Note::new(1.5e-9, 4.5e3, "stable for any k"),
    ];
    panel
}
