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

/// How far a band may widen the range on either side, in lengths of that of all else, or as a multiple of its usual breadth.
const BAND: f64 = 2.0;
const BREADTH: f64 = 1.5;

/// The ranges of both axes.
///
/// # Errors
/// [`crate::error::Error::Input`] if the panel shows nothing and has no fixed ranges.
pub fn scales(panel: &Panel) -> Result<(Scale, Scale)> {
    // A function of time ends with its data, and so does a map; a phase plane needs air around it, and so do names above and
    // below.
    let level = |x: &[f64]| x.first() == x.last();
    let function = |series: &PlotSeries| !series.dots && series.x.is_sorted() && !level(&series.x);
    let drawn = || panel.series.iter().filter(|series| !series.x.is_empty());
    let in_time = drawn().next().is_some() && drawn().all(function);
    let tight = panel.cells.is_some() || in_time;
    let margin = match panel.marks.first().map(|mark| mark.side) {
        _ if panel.cells.is_some() => 0.0,
        None => MARGIN,
        Some(Side::Free) => FREE_MARGIN,
        Some(_) => MARKED_MARGIN,
    };
    let (xs, ys) = reaches(panel);
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
    if panel.zero_line {
        ys.take(coordinate(panel.y.log, 0.0));
    }
    // What is likely of a curve may go far beyond all in places: the frame then cuts it. Where it does so everywhere it sets the range.
    for area in &panel.areas {
        let sides = area.lower.iter().zip(&area.upper);
        let breadths = sides.map(|(&low, &high)| {
            let (_, low) = at(1.0, low);
            let (_, high) = at(1.0, high);
            high - low
        });
        let room = ys.widened(BAND, BREADTH * median(breadths));
        let sides = [&area.lower, &area.upper];
        let points = sides.iter().flat_map(|side| area.x.iter().zip(*side));
        for (&x, &y) in points {
            let (x, y) = at(x, y);
            if !outside(x, window.x) {
                ys.take(room.nearest(y));
            }
        }
    }
    (xs, ys)
}

/// The middle one of the numbers that are finite; zero if none is.
fn median(numbers: impl Iterator<Item = f64>) -> f64 {
    let mut numbers: Vec<f64> = numbers.filter(|x| x.is_finite()).collect();
    numbers.sort_by(f64::total_cmp);
    numbers.get(numbers.len() / 2).copied().unwrap_or(0.0)
}

#[cfg(test)]
mod test {
    use super::super::{Area, Axis};
    use super::*;

    /// A level line at -1 below a line at zero, with a band around it that is broader by a factor at the last of its points.
    fn range_with_band(side: f64, last: f64) -> (f64, f64) {
        let x: Vec<f64> = (0..10).map(f64::from).collect();
        let mut sides = [side; 10];
        sides[9] *= last;
        let panel = Panel {
            series: vec![PlotSeries::new("", x.clone(), vec![-1.0; 10])],
            areas: vec![Area {
                label: String::new(),
                x,
                lower: sides.iter().map(|side| -1.0 - side).collect(),
                upper: sides.iter().map(|side| -1.0 + side).collect(),
                colour: 0,
                left_out: Vec::new(),
            }],
            zero_line: true,
            ..Panel::new("", Axis::linear("x"), Axis::linear("y"))
        };
        let (_, y) = scales(&panel).expect("points");
        (y.lo, y.hi)
    }

    #[test]
    fn a_band_is_seen_whole_unless_it_goes_far_beyond_all_else_in_places() {
        let (low, high) = range_with_band(0.5, 1.0);
        assert!((-1.7..=-1.5).contains(&low) && high == 0.0);
        let (low, high) = range_with_band(1.9, 1.0);
        assert!((-3.2..=-2.9).contains(&low) && (0.9..1.1).contains(&high));
        // In one place: it is cut.
        let (low, high) = range_with_band(0.5, 1e6);
        assert!((-3.4..=-3.0).contains(&low) && (2.0..2.4).contains(&high));
        // Everywhere: the frame is not a rectangle of its colour.
        let (low, high) = range_with_band(1e6, 1.0);
        assert!(low < -1.04e6 && high > 1.04e6, "{low}, {high}");
    }
}
