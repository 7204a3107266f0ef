//! Pictures of a run in time.

use super::diagram::{axis_label, number};
use super::heat_map::{MOST_PANELS, states_in_time};
use super::last_part::with_last_part;
use super::text::{parameters_of, titled};
use crate::scene::{CellValue, Change, Column, Described, Plan, Quantity, SlipEvent, Subspace};
use twinslip_output::RowList;
use twinslip_output::plot::{Axis, Drawing, Key, Mark, Panel, PlotSeries, Stroke, Symbol};

/// The columns of stick-slip events; a single interface has no second slip, and neither it nor equal ones have a leader.
pub fn event_columns(interfaces: usize) -> Vec<Column<SlipEvent>> {
    use Quantity::{Length, Number, SlipRate, Stress, Time};
    let two = interfaces == 2;
    vec![
        Column::new("onset", Time, |event: &SlipEvent| event.onset.into())
            .meaning("time at which the event begins"),
        Column::new("recurrence", Time, |event: &SlipEvent| {
            event.recurrence.into()
        })
        .meaning("time since the onset of the event before"),
        Column::new("duration", Time, |event: &SlipEvent| event.duration.into())
            .meaning("time from the beginning of the event to its end"),
        Column::new("stress_drop", Stress, |event: &SlipEvent| {
            event.stress_drop.into()
        })
        .meaning("stress at the beginning of the event minus that at its end"),
        Column::new("peak_slip_rate", SlipRate, |event: &SlipEvent| {
            event.peak_slip_rate.into()
        })
        .meaning("largest slip rate of all interfaces together"),
        Column::new("slip_1", Length, |event: &SlipEvent| event.slip[0].into())
            .meaning("slip of interface i in the event"),
        Column::new("slip_2", Length, move |event: &SlipEvent| {
            two.then_some(event.slip[1]).into()
        })
        .meaning("slip of interface i in the event")
        .in_table_if(two),
        Column::new("leader", Number, move |event: &SlipEvent| {
            let leader = event.leader().filter(|_| two);
            leader.map_or(CellValue::Word(None), CellValue::Count)
        })
        .meaning("interface that slips farthest in the event")
        .in_table_if(two),
    ]
}

/// A run in time, and its phase plane beside it; below it where the last part of a long run is beside it.
pub fn picture_of_run(plan: &Plan, rows: &RowList) -> Drawing {
    let column = |name: &str| rows.column(name).unwrap_or_default();
    if !plan.system.slides() {
        return picture_of_states(plan, rows);
    }
    with_last_part(
        panels_in_time(plan, rows),
        vec![vec![phase_plane(plan, rows)]],
        (&column("time"), &column("stress")),
    )
}

/// The states in time, each in a panel or, of many, all in one, and beside them the first two against each other.
fn picture_of_states(plan: &Plan, rows: &RowList) -> Drawing {
    let column = |name: &str| rows.column(name).unwrap_or_default();
    let states = plan.system.states();
    let in_time = states.iter().enumerate().map(|(i, name)| Panel {
        series: vec![PlotSeries::new("", column("time"), column(name))],
        ..Panel::new(
            match i {
                0 => parameters_of(&plan.system),
                _ => String::new(),
            },
            Axis::linear("time t"),
            Axis::linear(name.to_string()),
        )
    });
    let in_time = match states.len() > MOST_PANELS {
        true => vec![states_in_time(&plan.system, rows)],
        false => in_time.collect(),
    };
    let plane = match &states[..] {
        [first, second, ..] => vec![vec![Panel {
            series: vec![PlotSeries::new("", column(first), column(second))],
            ..Panel::new(
                "phase plane",
                Axis::linear(first.to_string()),
                Axis::linear(second.to_string()),
            )
        }]],
        _ => Vec::new(),
    };
    let first = states.first().map_or(Vec::new(), |name| column(name));
    with_last_part(in_time, plane, (&column("time"), &first))
}

/// Stress, states and slip rates against time, from points in the columns [`crate::scene::Plan::pictured`].
pub fn panels_in_time(plan: &Plan, rows: &RowList) -> Vec<Panel> {
    let units = plan.system.units();
    let time = Axis::linear(axis_label("time t", Quantity::Time, units));
    let column = |name: &str| column(plan, rows, name);
    let of_each = |name: &str, field: &str| {
        each(plan, rows, name, &|i| {
            (column("time"), column(&format!("{field}_{i}")))
        })
    };
    let panel = |title: &str, y, series| Panel {
        series,
        ..Panel::new(title, time.clone(), y)
    };
    let mut parameters = plan.system.parameters();
    if plan.program.is_some() {
        // V_H, which changes, is the first of them.
        parameters.remove(0);
    }
    let parameters = titled(plan.system.name(), &parameters, units);
    let mut rates = of_each("v", "slip_rate");
    rates.extend(rows.column("driving").map(|driving| {
        let time = rows.column("time").unwrap_or_default();
        let series = PlotSeries::new("V_H", time, driving);
        series.stroke(Stroke::Dotted).colour(DRIVEN)
    }));
    let over_time = PlotSeries::new("", column("time"), column("stress"));
    vec![
        Panel {
            keys: meaning_of_changes(plan),
            marks: changes(plan, rows),
            ..panel(
                &format!("stress, {parameters}"),
                stress_axis(plan),
                vec![over_time],
            )
        },
        panel(
            "state",
            Axis::log(axis_label("state ψ", Quantity::State, units)),
            of_each("ψ", "state"),
        ),
        panel("slip rate", rate_axis(plan), rates),
    ]
}

/// More changes of V_H than this have no names.
const NAMED: usize = 12;

/// What the points at changes of V_H mean.
fn meaning_of_changes(plan: &Plan) -> Vec<Key> {
    let changes = plan.program.as_ref().map_or(0, |all| all.changes.len());
    let label = match changes {
        0 => return Vec::new(),
        1..=NAMED => "V_H from there on",
        _ => "V_H changes",
    };
    let label = match plan.system.units().si() {
        true => label.to_owned(),
        false => axis_label(label, Quantity::SlipRate, plan.system.units()),
    };
    vec![Key {
        symbol: Symbol::Dot,
        filled: true,
        colour: None,
        label,
    }]
}

/// Where V_H changes: points on the curve of the stress, with V_H from then on where that is legible.
fn changes(plan: &Plan, rows: &RowList) -> Vec<Mark> {
    let Some(program) = &plan.program else {
        return Vec::new();
    };
    let (time, stress) = (rows.column("time"), rows.column("stress"));
    let (time, stress) = (time.unwrap_or_default(), stress.unwrap_or_default());
    let (named, units) = (program.changes.len() <= NAMED, plan.system.units());
    let mark = |change: &Change| {
        // The picture has a point at the ends of all stretches, and none beyond where the run has come to.
        let at = time.iter().position(|&t| t >= change.time)?;
        let driving = units.inward(Quantity::SlipRate, change.driving);
        let driving = number(Quantity::SlipRate, driving, units);
        let name = match (named, change.until) {
            (false, _) => String::new(),
            (true, None) => driving,
            (true, Some(_)) => format!("to {driving}"),
        };
        Some(Mark::new(change.time, stress[at], name).symbol(Symbol::Dot))
    };
    program.changes.iter().filter_map(mark).collect()
}

/// Stress against the slip rates.
pub fn phase_plane(plan: &Plan, rows: &RowList) -> Panel {
    let column = |name: &str| column(plan, rows, name);
    let series = each(plan, rows, "v", &|i| {
        (column(&format!("slip_rate_{i}")), column("stress"))
    });
    Panel {
        series,
        ..Panel::new("phase plane", rate_axis(plan), stress_axis(plan))
    }
}

/// A column as curves take it: broken between the sides of a change of V_H, where they have corners.
fn column(plan: &Plan, rows: &RowList, name: &str) -> Vec<f64> {
    let values = rows.column(name).unwrap_or_default();
    if plan.program.is_none() {
        return values;
    }
    let time = rows.column("time").unwrap_or_default();
    let mut broken = Vec::with_capacity(values.len());
    for (i, &value) in values.iter().enumerate() {
        if i > 0 && time[i] == time[i - 1] {
            // An axis of time ends where the curve does only if that has all times.
            broken.push(if name == "time" { value } else { f64::NAN });
        }
        broken.push(value);
    }
    broken
}

fn stress_axis(plan: &Plan) -> Axis {
    Axis::linear(axis_label(
        "stress τ",
        Quantity::Stress,
        plan.system.units(),
    ))
}

fn rate_axis(plan: &Plan) -> Axis {
    Axis::log(axis_label(
        "slip rate v",
        Quantity::SlipRate,
        plan.system.units(),
    ))
}

/// Colours of the faster interface and of the slower one.
const FAST: usize = 1;
const SLOW: usize = 0;
/// Grey, of V_H.
const DRIVEN: usize = 6;

/// A curve for each interface, of the slower one dashed and above that of the faster one, so that both are seen where they coincide;
/// equal interfaces are one curve, not one that hides another. The faster one is that with the larger slip rate at its fastest:
/// which of both it is depends on the start, and its look doesn't.
fn each(
    plan: &Plan,
    rows: &RowList,
    name: &str,
    of: &dyn Fn(usize) -> (Vec<f64>, Vec<f64>),
) -> Vec<PlotSeries> {
    let one = |i: usize, marks: &str| {
        let (x, y) = of(i);
        PlotSeries::new(label(name, marks), x, y)
    };
    let most = |name: &str| {
        let rates = rows.column(name).unwrap_or_default();
        rates.into_iter().fold(f64::NEG_INFINITY, f64::max)
    };
    match (plan.subspace, plan.system.clusters().len()) {
        (_, 1) => vec![one(1, "")],
        (Subspace::Symmetric, _) => vec![one(1, "₁ = ₂")],
        (Subspace::Whole, 2) => {
            let (fast, slow) = if most("slip_rate_1") >= most("slip_rate_2") {
                ((1, "₁"), (2, "₂"))
            } else {
                ((2, "₂"), (1, "₁"))
            };
            let named = |(i, mark): (usize, &str), role: &str| {
                let series = one(i, mark);
                let label = format!("{}, {role}", series.label);
                PlotSeries { label, ..series }
            };
            vec![
                named(fast, "fast").colour(FAST),
                named(slow, "slow").colour(SLOW).stroke(Stroke::Dashed),
            ]
        }
        (Subspace::Whole, count) => (1..=count).map(|i| one(i, SUBSCRIPTS[i])).collect(),
    }
}

/// One series for each interface or cluster, counted from 1.
const SUBSCRIPTS: [&str; 10] = ["₀", "₁", "₂", "₃", "₄", "₅", "₆", "₇", "₈", "₉"];

/// `v₁ = v₂` from `v` and `₁ = ₂`.
fn label(name: &str, marks: &str) -> String {
    let parts = marks.split(" = ").filter(|mark| !mark.is_empty());
    let parts: Vec<String> = parts.map(|mark| format!("{name}{mark}")).collect();
    parts.join(" = ")
}
