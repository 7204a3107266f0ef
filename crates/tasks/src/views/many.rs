//! The picture of a run of many interfaces.

use super::diagram::{axis_label, parameters};
use super::last_part::{enlarged, last_part};
use crate::scene::{ManyPlan, Quantity, Units};
use twinslip_output::RowList;
use twinslip_output::plot::{Axis, Block, Drawing, Panel, PlotSeries, Stroke};

/// The units of many interfaces: a sigma, V* and L of what all have in common, whatever is drawn for each.
pub(super) fn nominal() -> Units {
    Units::new(None, false)
}

/// Stress, slip rates, states and how many slide, in time.
pub fn many_run(plan: &ManyPlan, rows: &RowList) -> Drawing {
    let series = |label: &str, name: &str| {
        let column = |name: &str| rows.column(name).unwrap_or_default();
        PlotSeries::new(label, column("time"), column(name))
    };
    let units = &nominal();
    let label = |name: &str, quantity| axis_label(name, quantity, units);
    let time = || Axis::linear(label("time t", Quantity::Time));
    let panel = |title: String, axis: Axis, series: Vec<PlotSeries>| Panel {
        series,
        ..Panel::new(title, time(), axis)
    };
    let (count, loading) = (plan.interfaces.count(), plan.interfaces.loading);
    let panels = vec![
        panel(
            format!(
                "{count} interfaces at {}",
                parameters(loading.driving, loading.stiffness, units)
            ),
            Axis::linear(label("stress τ", Quantity::Stress)),
            vec![series("", "stress")],
        ),
        panel(
            "slip rate".into(),
            Axis::log(label("slip rate v", Quantity::SlipRate)),
            vec![
                series("all together", "slip_rate"),
                series("fastest", "slip_rate_max").stroke(Stroke::Dashed),
            ],
        ),
        panel(
            "state".into(),
            Axis::log(label("state ψ", Quantity::State)),
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
    ];
    let column = |name: &str| rows.column(name).unwrap_or_default();
    let last = last_part(&column("time"), &column("stress"));
    let last = last.map(|ends| enlarged(&panels, ends));
    let blocks = [Some(panels), last].into_iter().flatten();
    let two_by_two = |mut panels: Vec<Panel>| {
        let right = panels.split_off(2);
        Block {
            title: String::new(),
            columns: vec![panels, right],
        }
    };
    Drawing::blocks(blocks.map(two_by_two).collect())
}
