//! How a look at a record is shown: its stretches as rows, friction and displacement as a picture.

use super::fit::in_digits;
use crate::scene::{Column, Look, LookStretch, Quantity};
use twinslip_output::plot::{Area, Axis, Drawing, Note, Panel, PlotSeries, Stroke};

/// The columns of the stretches of one velocity.
pub fn look_columns() -> Vec<Column<LookStretch>> {
    use Quantity::{Number, SlipRate, Time};
    let kind = |at: &LookStretch| if at.is_hold { "hold" } else { "slide" };
    let bound = |of: fn(&LookStretch) -> Option<twinslip::number::Uncertain>| {
        move |at: &LookStretch| of(at).map(|x| x.uncertainty).into()
    };
    vec![
        Column::new("start", Time, |at: &LookStretch| at.span.0.into())
            .meaning("when the stretch begins"),
        Column::new("duration", Time, |at: &LookStretch| {
            (at.span.1 - at.span.0).into()
        })
        .meaning("how long it lasts"),
        Column::new("kind", Number, move |at: &LookStretch| kind(at).into())
            .meaning("slide, or hold where the load point is stopped between slides"),
        Column::new("driving", SlipRate, |at: &LookStretch| {
            at.velocity.value.into()
        })
        .meaning("velocity of the load point"),
        Column::new("friction", Number, |at: &LookStretch| {
            at.settled.map(|x| x.value).into()
        })
        .meaning("mean friction coefficient of the last quarter of the stretch"),
        Column::new("lowest", Number, |at: &LookStretch| {
            at.lowest.map(|x| x.value).into()
        })
        .meaning("least friction coefficient of a sample"),
        Column::new("highest", Number, |at: &LookStretch| {
            at.highest.map(|x| x.value).into()
        })
        .meaning("largest friction coefficient of a sample"),
        Column::new(
            "driving_uncertainty",
            SlipRate,
            bound(|at| Some(at.velocity)),
        )
        .meaning(
            "standard error of the velocity, or half the difference between that of both halves",
        )
        .not_in_table(),
        Column::new("friction_uncertainty", Number, bound(|at| at.settled))
            .meaning("standard error of that mean, from the means of eight parts")
            .not_in_table(),
        Column::new("extremum_uncertainty", Number, bound(|at| at.highest))
            .meaning("how far noise may have taken the least and the largest friction")
            .not_in_table(),
    ]
}

/// Metres, as laboratories have them.
const MICRO: f64 = 1e6;
/// A hold that is narrower than this part of the picture is a line.
const NARROW: f64 = 2e-3;
/// Parts of a record of each of which the least and the largest value are drawn.
const PARTS: usize = 3000;
/// More stretches than these have no room for their velocity.
const NAMED: usize = 20;

/// Friction against time, and against the displacement of the load point, with its steps of velocity as lines and its holds shaded.
pub fn picture_of_look(look: &Look) -> Drawing {
    let (times, friction) = (&look.measured.times, &look.measured.friction);
    let margin = 0.04 * f64::max(look.friction[2] - look.friction[1], f64::MIN_POSITIVE);
    let span = (look.friction[1] - margin, look.friction[2] + margin);
    let panel = |title: &str, axis: &str, x: &[f64]| {
        let (x, mu) = outline(x, friction);
        Panel {
            series: vec![PlotSeries::dots("", x, mu).colour(4)],
            ..Panel::new(
                title,
                Axis::linear(axis),
                Axis::linear("friction coefficient μ"),
            )
        }
    };
    let (begin, end) = (times[0], times[times.len() - 1]);
    let in_time = |t: f64| t.clamp(begin, end);
    let mut all = vec![marked(
        panel("friction", "time [s]", times),
        look,
        span,
        &in_time,
    )];
    if let Some(moved) = &look.measured.displacement {
        let along: Vec<f64> = moved.iter().map(|x| (x - moved[0]) * MICRO).collect();
        let at = |t: f64| along[times.partition_point(|&own| own < t).min(along.len() - 1)];
        let title = "the same, with velocities in µm/s";
        let mut second = panel(title, "load-point displacement [µm]", &along);
        second.notes = velocities(look, &at, span.0);
        all.push(marked(second, look, (span.0 - 2.0 * margin, span.1), &at));
    }
    Drawing::columns(vec![all])
}

/// With lines where the velocity changes, and the holds shaded, over the height of `span`; `at` is where a time is drawn.
fn marked(mut panel: Panel, look: &Look, span: (f64, f64), at: &dyn Fn(f64) -> f64) -> Panel {
    for (i, (_, after)) in look.steps().enumerate() {
        let x = at(after.span.0);
        let name = if i == 0 { "step of velocity" } else { "" };
        let line = PlotSeries::new(name, vec![x, x], vec![span.0, span.1]);
        // Behind the record.
        panel
            .series
            .insert(i, line.stroke(Stroke::Dashed).colour(1));
    }
    for (i, (_, hold, _)) in look.holds().enumerate() {
        let (from, to) = (at(hold.span.0), at(hold.span.1));
        if to - from > NARROW * (at(f64::INFINITY) - at(f64::NEG_INFINITY)).abs() {
            panel.areas.push(Area {
                label: "hold".into(),
                x: vec![from, to],
                lower: vec![span.0; 2],
                upper: vec![span.1; 2],
                colour: 2,
                left_out: Vec::new(),
            });
        } else {
            let name = if i == 0 { "hold" } else { "" };
            let line = PlotSeries::new(name, vec![from, from], vec![span.0, span.1]);
            panel.series.insert(i, line.colour(2));
        }
    }
    panel
}

/// The velocity of each stretch below the record, in the middle of the stretch.
fn velocities(look: &Look, at: &dyn Fn(f64) -> f64, height: f64) -> Vec<Note> {
    let slides = look.stretches.iter().filter(|one| !one.is_hold);
    let note = |one: &LookStretch| {
        let middle = 0.5 * (at(one.span.0) + at(one.span.1));
        Note::new(middle, height, in_digits(one.velocity.value * MICRO, 3))
    };
    match look.stretches.len() > NAMED {
        true => Vec::new(),
        false => slides.map(note).collect(),
    }
}

/// The least and the largest value of each part of a long record, all of a short one: the picture is the same.
fn outline(along: &[f64], values: &[f64]) -> (Vec<f64>, Vec<f64>) {
    let (first, last) = (along[0], along[along.len() - 1]);
    let width = (last - first).abs() / PARTS as f64;
    if values.len() <= 2 * PARTS || width <= 0.0 {
        return (along.to_vec(), values.to_vec());
    }
    let points: Vec<(f64, f64)> = along.iter().copied().zip(values.iter().copied()).collect();
    let part = |x: f64| ((x - first) / width).floor();
    let parts = points.chunk_by(|one, other| part(one.0) == part(other.0));
    let ends = parts.flat_map(|part| {
        let by = |one: &&(f64, f64), other: &&(f64, f64)| one.1.total_cmp(&other.1);
        let ends = [part.iter().min_by(by), part.iter().max_by(by)];
        ends.into_iter().flatten().take(part.len()).copied()
    });
    ends.unzip()
}
