//! Slip events of many interfaces: their rows and their picture.

use super::diagram::axis_label;
use super::many::nominal;
use crate::scene::{CellValue, Column, Drawn, ManyPlan, Participant, Quantity};
use twinslip::many::ManyEvent;
use twinslip_output::plot::{Axis, Drawing, Panel, PlotSeries};

/// The columns of slip events of so many interfaces.
pub fn many_event_columns(count: usize) -> Vec<Column<ManyEvent>> {
    use Quantity::{Length, Number, SlipRate, Stress, Time};
    type Row = ManyEvent;
    vec![
        Column::new("onset", Time, |event: &Row| event.onset.into())
            .meaning("time at which the event begins"),
        Column::new("recurrence", Time, |event: &Row| event.recurrence.into())
            .meaning("time since the onset of the event before"),
        Column::new("duration", Time, |event: &Row| event.duration.into())
            .meaning("time from the beginning of the event to its end"),
        Column::new("stress_before", Stress, |event: &Row| {
            event.stress_before.into()
        })
        .meaning("stress at the onset"),
        Column::new("stress_drop", Stress, |event: &Row| {
            event.stress_drop.into()
        })
        .meaning("stress at the beginning of the event minus that at its end"),
        Column::new("peak_slip_rate", SlipRate, |event: &Row| {
            event.peak_slip_rate.into()
        })
        .meaning("largest slip rate of all interfaces together"),
        Column::new("participants", Number, |event: &Row| {
            event.participants.into()
        })
        .meaning("number of interfaces that slip in the event"),
        Column::new("participation", Number, move |event: &Row| {
            participation(event, count).into()
        })
        .meaning("participants over the number of interfaces"),
        Column::new("slip", Length, |event: &Row| event.slip.into())
            .meaning("slip of all participants together, each while it slips"),
        Column::new("slip_mean", Length, |event: &Row| {
            (event.slip / event.participants as f64).into()
        })
        .meaning("mean slip of the participants"),
        Column::new("magnitude", Number, |event: &Row| event.magnitude().into())
            .meaning("log10 of the slip of the event"),
        Column::new("leader", Number, |event: &Row| {
            CellValue::Count(event.leader + 1)
        })
        .meaning("interface that slips farthest in the event"),
        Column::new("first", Number, |event: &Row| {
            CellValue::Count(event.first + 1)
        })
        .meaning("interface that begins the event"),
    ]
}

/// The columns of what each interface does in the events, with its constants that are drawn.
pub fn participation_columns(drawn: &[Drawn]) -> Vec<Column<Participant>> {
    let mut columns = vec![
        Column::new("interface", Quantity::Number, |row: &Participant| {
            row.interface.into()
        })
        .meaning("number of the interface"),
        Column::new("events", Quantity::Number, |row: &Participant| {
            row.did.events.into()
        })
        .meaning("number of events in which the interface slipped"),
        Column::new("slip", Quantity::Length, |row: &Participant| {
            row.did.slip.into()
        })
        .meaning("slip of the interface in these events"),
    ];
    let constants = drawn.iter().enumerate().map(|(i, drawn)| {
        Column::new(drawn.name, Quantity::Number, move |row: &Participant| {
            row.drawn[i].into()
        })
    });
    columns.extend(constants);
    columns
}

fn participation(event: &ManyEvent, count: usize) -> f64 {
    event.participants as f64 / count as f64
}

/// How many events are at least as large as each, and how many interfaces slip in each.
pub fn picture_of_events(plan: &ManyPlan, events: &[ManyEvent]) -> Drawing {
    /// So many points need not be small.
    const FEW: usize = 50;
    let count = plan.interfaces.count();
    let mut slips: Vec<f64> = events.iter().map(|event| event.slip).collect();
    slips.sort_by(f64::total_cmp);
    let larger = (1..=slips.len()).rev().map(|n| n as f64).collect();
    let onsets = events.iter().map(|event| event.onset).collect();
    let shares = events.iter().map(|event| participation(event, count));
    let several = match events.len() {
        0 => "no events".to_owned(),
        1 => "1 event".to_owned(),
        n => format!("{} events", twinslip::error::count(n)),
    };
    let points = |x: Vec<f64>, y: Vec<f64>| {
        let points = PlotSeries::dots("", x, y);
        let few = events.len() <= FEW;
        vec![if few { points.wide() } else { points }]
    };
    let label = |name: &str, quantity| axis_label(name, quantity, &nominal());
    let size = Axis::log(label("slip of all participants S", Quantity::Length));
    // Without points an axis has no ends of its own.
    let size = match events {
        [] => size.within(1.0, 10.0),
        _ => size,
    };
    let most = 10.0_f64.max(1.25 * events.len() as f64);
    Drawing::columns(vec![
        vec![Panel {
            series: points(slips, larger),
            ..Panel::new(
                format!("{several} of {} interfaces", twinslip::error::count(count)),
                size,
                Axis::log("events with at least this S").within(0.8, most),
            )
        }],
        vec![Panel {
            series: points(onsets, shares.collect()),
            ..Panel::new(
                "share that slips",
                Axis::linear(label("onset t", Quantity::Time)).within(0.0, plan.until),
                Axis::log("participants / N").within(0.8 / count as f64, 1.25),
            )
        }],
    ])
}
