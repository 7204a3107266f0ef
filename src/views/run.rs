//! Pictures of a run in time.

use crate::output::Rows;
use crate::output::plot::{Axis, Panel, Series};
use crate::scene::{Dimension, Plan, Quantity};

/// Stress, states and slip rates against time, from points in the columns [`crate::scene::Column::pictured`].
pub fn panels_in_time(plan: &Plan, rows: &Rows) -> Vec<Panel> {
    let units = &plan.system.units;
    let time = Axis::linear(format!("time t [{}]", units.short_name(Quantity::Time)));
    let state_unit = match units.short_name(Quantity::State).as_str() {
        "1" => String::new(),
        unit => format!(" [{unit}]"),
    };
    let column = |name: &str| rows.column(name).unwrap_or_default();
    let of_each = |name: &str, field: &str| {
        each(plan, name, &|i| {
            (column("time"), column(&format!("{field}_{i}")))
        })
    };
    let panel = |title: &str, y, series| Panel {
        series,
        ..Panel::new(title, time.clone(), y)
    };
    let over_time = Series::new("", column("time"), column("stress"));
    vec![
        panel("stress", stress_axis(plan), vec![over_time]),
        panel(
            "state",
            Axis::log(format!("state ψ{state_unit}")),
            of_each("ψ", "state"),
        ),
        panel("slip rate", rate_axis(plan), of_each("v", "slip_rate")),
    ]
}

/// Stress against the slip rates.
pub fn phase_plane(plan: &Plan, rows: &Rows) -> Panel {
    let column = |name: &str| rows.column(name).unwrap_or_default();
    let series = each(plan, "v", &|i| {
        (column(&format!("slip_rate_{i}")), column("stress"))
    });
    Panel {
        series,
        ..Panel::new("phase plane", rate_axis(plan), stress_axis(plan))
    }
}

fn stress_axis(plan: &Plan) -> Axis {
    let unit = plan.system.units.short_name(Quantity::Stress);
    Axis::linear(format!("stress τ [{unit}]"))
}

fn rate_axis(plan: &Plan) -> Axis {
    let unit = plan.system.units.short_name(Quantity::SlipRate);
    Axis::log(format!("slip rate v [{unit}]"))
}

/// A curve for each interface; equal interfaces are one curve, not one that hides another.
fn each(plan: &Plan, name: &str, of: &dyn Fn(usize) -> (Vec<f64>, Vec<f64>)) -> Vec<Series> {
    let curves = match plan.dimension {
        Dimension::Single => vec![(1, "")],
        Dimension::Symmetric => vec![(1, "₁ = ₂")],
        Dimension::Full => vec![(1, "₁"), (2, "₂")],
    };
    let series = curves.iter().map(|(i, marks)| {
        let (x, y) = of(*i);
        Series::new(label(name, marks), x, y)
    });
    series.collect()
}

/// `v₁ = v₂` from `v` and `₁ = ₂`.
fn label(name: &str, marks: &str) -> String {
    let parts = marks.split(" = ").filter(|mark| !mark.is_empty());
    let parts: Vec<String> = parts.map(|mark| format!("{name}{mark}")).collect();
    parts.join(" = ")
}
