//! The bifurcation diagram by brute force: a dot for each value that a state comes back to.

use super::GridSide;
use crate::scene::{Diagram, Units};
use crate::views::axis_label;
use twinslip::sweep::SweepRow;
use twinslip_output::plot::{Axis, Drawing, Panel, PlotSeries};

/// Black.
const BLACK: usize = 7;

/// The values against the parameter, which are in the user's units along the side.
pub fn diagram_picture(
    rows: &[SweepRow],
    (side, label): (&GridSide, String),
    starts: usize,
    (diagram, title): (&Diagram, String),
    units: &Units,
) -> Drawing {
    let (x, _) = side.axis(label, |x| x);
    let at = |row: &SweepRow| side.values.get(row.number / starts.max(1)).copied();
    let pairs = rows.iter().filter_map(|row| Some((at(row)?, &row.dots)));
    let pairs = pairs.flat_map(|(x, dots)| dots.iter().map(move |y| (x, *y)));
    let (xs, ys): (Vec<f64>, Vec<f64>) = pairs
        .map(|(x, y)| (x, units.outward(diagram.quantity, y)))
        .unzip();
    let what = match diagram.is_stroboscopic {
        true => format!("{} once a period", diagram.name),
        false => format!("maxima of {}", diagram.name),
    };
    let panel = Panel {
        series: vec![PlotSeries::dots("", xs, ys).colour(BLACK)],
        ..Panel::new(
            title,
            x,
            Axis::linear(axis_label(&what, diagram.quantity, units)),
        )
    };
    Drawing::columns(vec![vec![panel]])
}
