//! Pictures of a return map.

use super::diagram::{axis_label, value};
use super::text::parameters_of;
use crate::scene::{Described, Quantity, SectionPlan};
use twinslip_output::RowList;
use twinslip_output::plot::{Axis, Drawing, Panel, PlotSeries};

/// Slip rates that differ by more than this factor are drawn on logarithmic axes.
const DECADES: f64 = 30.0;

/// The map, and beside it the states at the returns where there are two that are free; `None` where there are too few returns.
pub fn picture_of_section(plan: &SectionPlan, rows: &RowList) -> Option<Drawing> {
    let slides = plan.system.slides();
    if rows.iter().len() < if slides { 1 } else { 2 } {
        return None;
    }
    let mut columns = vec![vec![if slides {
        return_map(plan, rows)
    } else {
        map_of_state(plan, rows)
    }]];
    if slides && plan.system.clusters().len() > 1 {
        columns.push(vec![states_at_returns(rows)]);
    } else if let [first, second, ..] = &free_states(plan)[..] {
        let column = |name: &str| rows.column(name).unwrap_or_default();
        columns.push(vec![Panel {
            series: vec![PlotSeries::dots("", column(first), column(second))],
            ..Panel::new(
                "states at the returns",
                Axis::linear(first.as_str()),
                Axis::linear(second.as_str()),
            )
        }]);
    }
    Some(Drawing::columns(columns))
}

/// The states that differ from return to return.
fn free_states(plan: &SectionPlan) -> Vec<String> {
    let states = plan.system.states().into_iter().enumerate();
    let free = states.filter(|(i, _)| *i != plan.state);
    free.map(|(_, name)| name.into_owned()).collect()
}

/// Where the section is, and what the map is of.
fn title(plan: &SectionPlan) -> String {
    let name = plan.state_name();
    let symbol = match plan.system.slides() && plan.state == 0 {
        true => "τ",
        false => &name,
    };
    let quantity = plan.system.quantity(plan.state);
    let units = plan.system.units();
    let value = value(symbol, quantity, plan.value, units);
    format!("return map at {value}, {}", parameters_of(&plan.system))
}

/// The slip rate of all interfaces at a return against that at the next one.
pub fn return_map(plan: &SectionPlan, rows: &RowList) -> Panel {
    let units = plan.system.units();
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
    let sum = match plan.system.clusters() {
        [1] => "v",
        [1, 1] => "v₁ + v₂",
        _ => "slip rate of all",
    };
    let rate = |name: String| axis_label(&name, Quantity::SlipRate, units);
    Panel {
        series: vec![
            PlotSeries::dots("", sums, next),
            PlotSeries::new("diagonal", vec![least, most], vec![least, most]),
        ],
        ..Panel::new(
            title(plan),
            axis(rate(format!("{sum} at return n"))),
            axis(rate(format!("{sum} at return n + 1"))),
        )
    }
}

/// A state at each return against itself at the next.
fn map_of_state(plan: &SectionPlan, rows: &RowList) -> Panel {
    let name = &free_states(plan)[0];
    let values = rows.column(name).unwrap_or_default();
    let (here, next) = (values[..values.len() - 1].to_vec(), values[1..].to_vec());
    let least = values.iter().copied().fold(f64::INFINITY, f64::min);
    let most = values.iter().copied().fold(f64::NEG_INFINITY, f64::max);
    Panel {
        series: vec![
            PlotSeries::dots("", here, next),
            PlotSeries::new("diagonal", vec![least, most], vec![least, most]),
        ],
        ..Panel::new(
            title(plan),
            Axis::linear(format!("{name} at return n")),
            Axis::linear(format!("{name} at return n + 1")),
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
