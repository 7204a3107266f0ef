//! The picture of a run of many interfaces.

use crate::scene::ManyPlan;
use twinslip_output::RowList;
use twinslip_output::plot::{Axis, Drawing, Panel, PlotSeries, Stroke};

/// Stress, slip rates, states and how many slide, in time.
pub fn many_run(plan: &ManyPlan, rows: &RowList) -> Drawing {
    let series = |label: &str, name: &str| {
        let column = |name: &str| rows.column(name).unwrap_or_default();
        PlotSeries::new(label, column("time"), column(name))
    };
    let time = || Axis::linear("time t");
    let panel = |title: String, axis: Axis, series: Vec<PlotSeries>| Panel {
        series,
        ..Panel::new(title, time(), axis)
    };
    let count = plan.interfaces.count();
    Drawing::columns(vec![
        vec![
            panel(
                format!("{count} interfaces"),
                Axis::linear("stress τ"),
                vec![series("", "stress")],
            ),
            panel(
                "slip rate".into(),
                Axis::log("slip rate v"),
                vec![
                    series("all together", "slip_rate"),
                    series("fastest", "slip_rate_max").stroke(Stroke::Dashed),
                ],
            ),
        ],
        vec![
            panel(
                "state".into(),
                Axis::log("state ψ"),
                vec![
                    series("least", "state_min"),
                    series("greatest", "state_max").stroke(Stroke::Dashed),
                ],
            ),
            panel(
                "faster than V_H/N".into(),
                Axis::linear("interfaces"),
                vec![series("", "sliding")],
            ),
        ],
    ])
}
