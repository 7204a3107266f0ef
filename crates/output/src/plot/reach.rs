//! Which ranges the axes of a panel get from what it shows.

use super::clip::Window;
use super::scale::{Reach, Scale, coordinate, ends};
use super::{Panel, PlotSeries, Side, unrendered};
use crate::error::Result;

/// Room between the curves and the frame, as a part of the range.
const MARGIN: f64 = 0.04;
/// The same where points have names above or below.
const MARKED_MARGIN: f64 = 0.26;
/// The same where the names stand where there is room.
const FREE_MARGIN: f64 = 0.1;

/// The ranges of both axes.
///
/// # Errors
/// [`crate::error::Error::Input`] if the panel shows nothing and has no fixed ranges.
pub fn scales(panel: &Panel) -> Result<(Scale, Scale)> {
    // A function of time ends with its data, and so does a map; a phase plane needs air around it, and so do names above and
    // below.
    let function = |series: &PlotSeries| !series.dots && series.x.is_sorted();
    let tight = panel.cells.is_some() || panel.series.iter().all(function);
    let margin = match panel.marks.first().map(|mark| mark.side) {
        _ if panel.cells.is_some() => 0.0,
        None => MARGIN,
        Some(Side::Free) => FREE_MARGIN,
        Some(_) => MARKED_MARGIN,
    };
    let (xs, mut ys) = reaches(panel);
    if panel.zero_line {
        ys.take(coordinate(panel.y.log, 0.0));
    }
    let x = Scale::new(&panel.x, xs, if tight { 0.0 } else { MARGIN });
    let y = Scale::new(&panel.y, ys, margin);
    x.zip(y)
        .ok_or_else(|| unrendered(format!("there is no point for the panel {:?}", panel.title)))
}

/// Of all that is shown; where one axis is fixed, of what its ends leave on the other.
fn reaches(panel: &Panel) -> (Reach, Reach) {
    let all = (f64::NEG_INFINITY, f64::INFINITY);
    let fixed = (ends(&panel.x), ends(&panel.y));
    let window = Window {
        x: fixed.0.unwrap_or(all),
        y: fixed.1.unwrap_or(all),
    };
    let (mut xs, mut ys) = (Reach::none(), Reach::none());
    let outside = |x: f64, (lo, hi): (f64, f64)| x < lo || x > hi;
    let mut take = |(x, y): (f64, f64)| {
        // A value that can't be drawn on one axis still says how far the other goes: panels one below the other agree.
        if !outside(y, window.y) {
            xs.take(x);
        }
        if !outside(x, window.x) {
            ys.take(y);
        }
    };
    let at = |x: f64, y: f64| (coordinate(panel.x.log, x), coordinate(panel.y.log, y));
    for series in &panel.series {
        let points = series.x.iter().zip(&series.y).map(|(&x, &y)| at(x, y));
        let mut before = None;
        for point in points {
            take(point);
            // Where the curve enters and leaves.
            if let (Some(before), false, true) = (before, series.dots, fixed != (None, None)) {
                let inside = window.segment(before, point);
                inside.into_iter().for_each(|(start, end)| {
                    take(start);
                    take(end);
                });
            }
            let finite = point.0.is_finite() && point.1.is_finite();
            before = finite.then_some(point);
        }
    }
    if let Some(map) = &panel.cells {
        let corners = |edges: &[f64]| edges.first().copied().zip(edges.last().copied());
        if let (Some(x), Some(y)) = (corners(&map.x_edges), corners(&map.y_edges)) {
            take(at(x.0, y.0));
            take(at(x.1, y.1));
        }
    }
    for mark in &panel.marks {
        let (x, y) = (mark.bars.x, mark.bars.y);
        x.into_iter().for_each(|(low, high)| {
            take(at(low, mark.y));
            take(at(high, mark.y));
        });
        y.into_iter().for_each(|(low, high)| {
            take(at(mark.x, low));
            take(at(mark.x, high));
        });
    }
    let places = panel.marks.iter().map(|mark| (mark.x, mark.y));
    let notes = panel.notes.iter().map(|note| (note.x, note.y));
    places.chain(notes).for_each(|(x, y)| take(at(x, y)));
    // What is likely of a curve may go far beyond all: the frame then cuts it.
    let room = ys.widened(1.0);
    for area in &panel.areas {
        let sides = [&area.lower, &area.upper];
        let points = sides.iter().flat_map(|side| area.x.iter().zip(*side));
        for (&x, &y) in points {
            let (x, y) = at(x, y);
            if !outside(x, window.x) && room.holds(y) {
                ys.take(y);
            }
        }
    }
    (xs, ys)
}
