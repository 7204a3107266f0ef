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
/// Parts of a record of each of which the least and the largest value are drawn.
const PARTS: usize = 3000;
/// More stretches than these have no room for their velocity.
const NAMED: usize = 14;

/// Friction and the displacement of the load point against time, with the steps of velocity as lines and the holds shaded.
pub fn picture_of_look(look: &Look) -> Drawing {
    let (times, friction) = (&look.measured.times, &look.measured.friction);
    let x = || Axis::linear("time [s]");
    let (t, mu) = outline(times, friction);
    let margin = 0.04 * f64::max(look.friction[2] - look.friction[1], f64::MIN_POSITIVE);
    let span = (look.friction[1] - margin, look.friction[2] + margin);
    let mut all = vec![
        Panel {
            series: vec![PlotSeries::dots("", t, mu).colour(4)],
            ..Panel::new("friction", x(), Axis::linear("friction coefficient μ"))
        }
        .marked(look, span),
    ];
    if let Some(moved) = &look.measured.displacement {
        let along: Vec<f64> = moved.iter().map(|x| (x - moved[0]) * MICRO).collect();
        let most = along.iter().fold(0.0, |most: f64, x| most.max(*x));
        let (t, along) = outline(times, &along);
        let panel = Panel {
            series: vec![PlotSeries::new("", t, along).colour(0)],
            notes: velocities(look, most),
            ..Panel::new(
                "load point, with its velocities in µm/s",
                x(),
                Axis::linear("displacement [µm]"),
            )
        };
        all.push(panel.marked(look, (0.0, most)));
    }
    Drawing::columns(vec![all])
}

trait Marked {
    fn marked(self, look: &Look, span: (f64, f64)) -> Self;
}

impl Marked for Panel {
    /// With lines where the velocity changes, and the holds shaded, over the height of `span`.
    fn marked(mut self, look: &Look, span: (f64, f64)) -> Self {
        let named = |i: usize, name: &str| {
            if i == 0 {
                name.to_owned()
            } else {
                String::new()
            }
        };
        for (i, (_, after)) in look.steps().enumerate() {
            let at = after.span.0;
            let line = PlotSeries::new(
                named(i, "step of velocity"),
                vec![at, at],
                vec![span.0, span.1],
            );
            // Behind the record.
            self.series.insert(i, line.stroke(Stroke::Dashed).colour(1));
        }
        for (_, hold, _) in look.holds() {
            self.areas.push(Area {
                label: "hold".into(),
                x: vec![hold.span.0, hold.span.1],
                lower: vec![span.0; 2],
                upper: vec![span.1; 2],
                colour: 2,
                left_out: Vec::new(),
            });
        }
        self
    }
}

/// The velocity of each stretch, above the displacement at its middle.
fn velocities(look: &Look, most: f64) -> Vec<Note> {
    if look.stretches.len() > NAMED {
        return Vec::new();
    }
    let times = &look.measured.times;
    let moved = look.measured.displacement.as_deref().unwrap_or_default();
    let note = |one: &LookStretch| {
        let middle = 0.5 * (one.span.0 + one.span.1);
        let at = times.partition_point(|&t| t < middle).min(times.len() - 1);
        let height = (moved.get(at)? - moved.first()?) * MICRO;
        let digits = in_digits(one.velocity.value * MICRO, 3);
        let above = if height > 0.5 * most { -0.12 } else { 0.12 };
        (!one.is_hold).then(|| Note::new(middle, height + above * most, digits))
    };
    look.stretches.iter().filter_map(note).collect()
}

/// The least and the largest value of each part of a long record, all of a short one: the picture is the same.
fn outline(times: &[f64], values: &[f64]) -> (Vec<f64>, Vec<f64>) {
    let length = values.len().div_ceil(PARTS);
    if length <= 2 {
        return (times.to_vec(), values.to_vec());
    }
    let ends = |(i, part): (usize, &[f64])| {
        let by = |one: &&f64, other: &&f64| one.total_cmp(other);
        let place = |x: &f64| part.iter().position(|own| own == x).unwrap_or(0) + i * length;
        let low = part.iter().min_by(by).map(place).unwrap_or(i * length);
        let high = part.iter().max_by(by).map(place).unwrap_or(i * length);
        [low.min(high), low.max(high)]
    };
    let places = values.chunks(length).enumerate().flat_map(ends);
    places.map(|at| (times[at], values[at])).unzip()
}
