//! Figure 4: the spinodal law (35), (36) beside the Dieterich-Ruina law, and where one interface with it slides steadily (16).

use super::curve::{cells, geometric};
use crate::{Made, Make, Pieces, Product, Sheet};
use twinslip::error::Result;
use twinslip::friction::{
    Extremum, ExtremumKind, Law, Parameters, Spinodal, critical_stiffness,
    critical_stiffness_maximum, steady_stress,
};
use twinslip::model::scales::Material;
use twinslip_output::plot::{Axis, Drawing, Mark, Note, Panel, PlotSeries, Side, Stroke};

/// The figure.
pub const FIGURE: Product = Product {
    id: "fig04",
    title: "Spinodal friction law and stability domain of one interface",
    caption: "(a) Steady friction coefficient of the spinodal law (36), solid, with its maximum at V_M and its minimum at V_m, and \
of the Dieterich-Ruina law (4), dash-dotted. The measurements of Heslot et al. (1994) that the paper's figure shows are not \
given in its text; none are drawn.\n\n(b) Stability domain of one interface in the (V, K) plane. Steady sliding is unstable \
below the curve K = k_c(V), which vanishes at V_M and V_m, and stable above it and outside of them; its maximum is marked. \
Dash-dotted: k_c = b/a − 1 of the Dieterich-Ruina law.",
    alt: "Two panels over slip rate. The spinodal friction curve rises, falls and rises again, and follows the straight line of \
the Dieterich-Ruina law between. The critical stiffness is an arch between both extrema.",
    scenes: &[],
    make: Make::Figure(make),
};

/// Slip rates in V*.
const RATES: (f64, f64) = (1e-4, 1e6);
const POINTS: usize = 1001;

fn make(_: &Pieces<'_>) -> Result<Made> {
    let (_, scales) = Material::heslot_1994(1.0).dimensionless()?;
    let parameters = Parameters::heslot_1994();
    let (spinodal, ruina) = (parameters.spinodal(), parameters.dieterich_ruina());
    let mut sheet = Sheet::new();
    let mut friction = friction_panel(&spinodal, scales.friction, &mut sheet);
    let mut stability = stability_panel(&spinodal, &mut sheet)?;

    let ends = [RATES.0, RATES.1];
    let mu = ends.map(|v| scales.friction * steady_stress(&ruina, v));
    let k_c = ends.map(|v| critical_stiffness(&ruina, v));
    let line = |y: [f64; 2]| {
        PlotSeries::new("Dieterich-Ruina (4)", ends.to_vec(), y.to_vec())
            .stroke(Stroke::DashDot)
            .colour(1)
    };
    friction.series.push(line(mu));
    stability.series.push(line(k_c));
    let rows = (0..2).map(|i| [ends[i], mu[i], k_c[i]]);
    sheet.add(
        "dieterich-ruina",
        &["slip_rate", "friction", "critical_stiffness"],
        cells(rows),
    );
    Ok(Made {
        sheet,
        drawing: Some(Drawing::columns(vec![vec![friction, stability]])),
        method: "closed formulas (36), (4) and (16); extrema in closed form and enclosed by interval arithmetic, the maximum of \
k_c by a bracketed zero of its exact derivative"
            .into(),
    })
}

fn rate_axis() -> Axis {
    Axis::log("slip rate V [V*]").within(RATES.0, RATES.1)
}

fn friction_panel(law: &Spinodal, a: f64, sheet: &mut Sheet) -> Panel {
    let y = Axis::linear("steady friction coefficient μ_ss").within(0.24, 0.52);
    let mut panel = Panel::new("(a) spinodal law", rate_axis(), y);
    let rates = geometric(RATES.0, RATES.1, POINTS);
    let mu: Vec<f64> = rates.iter().map(|&v| a * steady_stress(law, v)).collect();
    let rows = rates.iter().zip(&mu).map(|(&v, &mu)| [v, mu, mu / a]);
    sheet.add(
        "spinodal",
        &["slip_rate", "friction", "stress"],
        cells(rows),
    );
    panel
        .series
        .push(PlotSeries::new("spinodal law (36)", rates, mu).colour(0));
    for extremum in Extremum::all(law) {
        let (v, tau) = (extremum.slip_rate.value, extremum.stress.value);
        let (part, label) = match extremum.kind {
            ExtremumKind::Maximum => ("maximum", format!("V_M = {v:.4} V*")),
            ExtremumKind::Minimum => ("minimum", format!("V_m = {v:.1} V*")),
        };
        panel.marks.push(Mark::new(v, a * tau, label));
        sheet.add(
            part,
            &["slip_rate", "friction", "stress"],
            cells([[v, a * tau, tau]]),
        );
    }
    panel
}

fn stability_panel(law: &Spinodal, sheet: &mut Sheet) -> Result<Panel> {
    let y = Axis::linear("stiffness K [aσ/L]").within(-0.017, 0.5);
    let mut panel = Panel::new("(b) stability of one interface", rate_axis(), y);
    let extrema = law.steady_extrema();
    // Between the extrema, with more points next to them, where the curve is steep.
    let rates = geometric(extrema[0], extrema[1], POINTS);
    let mut k_c: Vec<f64> = rates.iter().map(|&v| critical_stiffness(law, v)).collect();
    (k_c[0], k_c[POINTS - 1]) = (0.0, 0.0);
    let rows = rates.iter().zip(&k_c).map(|(&v, &k)| [v, k]);
    sheet.add(
        "stability",
        &["slip_rate", "critical_stiffness"],
        cells(rows),
    );
    panel
        .series
        .push(PlotSeries::new("k_c(V)", rates, k_c).colour(0));
    for (v, name) in extrema.into_iter().zip(["V_M", "V_m"]) {
        panel.marks.push(Mark::new(v, 0.0, name));
    }
    if let Some(maximum) = critical_stiffness_maximum(law)? {
        let (v, k) = (maximum.slip_rate.value, maximum.stiffness.value);
        let label = format!("K = {k:.4}, V = {v:.3} V*");
        panel.marks.push(Mark::new(v, k, label).side(Side::Below));
        sheet.add(
            "largest",
            &["slip_rate", "critical_stiffness"],
            cells([[v, k]]),
        );
    }
    panel.notes = vec![
        Note::new(3.0, 0.17, "unstable: stick-slip"),
        Note::new(1.5e-3, 0.3, "stable"),
        Note::new(5e4, 0.3, "stable"),
    ];
    Ok(panel)
}
