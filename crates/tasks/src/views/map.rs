//! Pictures of a return map.

use super::diagram::{axis_label, value};
use crate::scene::{Quantity, SectionPlan};
use crate::views;
use twinslip_output::RowList;
use twinslip_output::plot::{Axis, Panel, PlotSeries};

/// Slip rates that differ by more than this factor are drawn on logarithmic axes.
const DECADES: f64 = 30.0;

/// The slip rate of both interfaces at a return against that at the next one.
pub fn return_map(plan: &SectionPlan, rows: &RowList) -> Panel {
    let units = &plan.system.units;
    let column = |name: &str| rows.column(name).unwrap_or_default();
    let (sums, next) = (column("slip_rate_sum"), column("next_slip_rate_sum"));
    let all = || sums.iter().chain(&next).copied();
    let least = all().fold(f64::INFINITY, f64::min);
    let most = all().fold(f64::NEG_INFINITY, f64::max);
    let log = least > 0.0 && most > DECADES * least;
    let axis = |label: String| {
        if log {
            Axis::log(label)
        } else {
            Axis::linear(label)
        }
    };
    let sum = if plan.system.interfaces == 2 {
        "v₁ + v₂"
    } else {
        "v"
    };
    let rate = |name: String| axis_label(&name, Quantity::SlipRate, units);
    let title = format!(
        "return map at {}, {}",
        value("τ", Quantity::Stress, plan.stress, units),
        views::parameters(plan.loading.driving, plan.loading.stiffness, units)
    );
    Panel {
        series: vec![
            PlotSeries::dots("", sums, next),
            PlotSeries::new("diagonal", vec![least, most], vec![least, most]),
        ],
        ..Panel::new(
            title,
            axis(rate(format!("{sum} at return n"))),
            axis(rate(format!("{sum} at return n + 1"))),
        )
    }
}

/// The states of both interfaces at the returns.
pub fn states_at_returns(rows: &RowList) -> Panel {
    let state = |i: usize| rows.column(&format!("log_state_{i}")).unwrap_or_default();
    Panel {
        series: vec![PlotSeries::dots("", state(1), state(2))],
        ..Panel::new(
            "states at the returns",
            Axis::linear("ln ψ₁"),
            Axis::linear("ln ψ₂"),
        )
    }
}
