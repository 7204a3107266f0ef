//! Areas between two curves, behind all curves: what is likely of a curve.

use super::canvas::{Canvas, Colour, PAPER, colour, mixed};
use super::clip::Point;
use super::frame::Frame;
use super::smooth::smooth;
use super::{Area, Panel};

/// How dense an area is: the grid shines through.
pub const OPACITY: f64 = 0.22;

/// Draws the areas in the frame.
pub fn areas(canvas: &Canvas, panel: &Panel, frame: &Frame) {
    for area in &panel.areas {
        for corners in pieces(area, frame) {
            let within = frame.window().area(&corners);
            if within.len() > 2 {
                let within: Vec<_> = within.into_iter().map(|at| frame.pixel(at)).collect();
                canvas.veil(&within, colour(area.colour), OPACITY);
            }
        }
    }
}

/// The corners of each piece, in the coordinates of the axes.
pub fn pieces(area: &Area, frame: &Frame) -> Vec<Vec<Point>> {
    let (lowest, highest) = frame.window().y;
    // What can't be drawn on a logarithmic axis is below all.
    let known = |x: f64, y: f64, end: f64| {
        let at = frame.coordinates(x, y);
        match at.1.is_finite() || y.is_nan() {
            true => at,
            false => (at.0, end),
        }
    };
    let sides = area.x.iter().zip(area.lower.iter().zip(&area.upper));
    let (mut lower, mut upper) = (Vec::new(), Vec::new());
    for (&x, (&low, &high)) in sides {
        let pair = [known(x, low, lowest), known(x, high, highest)];
        let both = pair.iter().all(|at| at.0.is_finite() && at.1.is_finite());
        let nothing = (f64::NAN, f64::NAN);
        lower.push(if both { pair[0] } else { nothing });
        upper.push(if both { pair[1] } else { nothing });
    }
    let curve = |side: &[Point]| -> Vec<Vec<Point>> {
        let points = smooth(side, frame.per_pixel(), &area.left_out);
        let pieces = points.split(|at| at.0.is_nan());
        pieces
            .filter(|piece| !piece.is_empty())
            .map(<[Point]>::to_vec)
            .collect()
    };
    let pairs = curve(&lower).into_iter().zip(curve(&upper));
    pairs
        .map(|(lower, upper)| lower.into_iter().chain(upper.into_iter().rev()).collect())
        .collect()
}

/// The entries of the legend: a name with the colours of all areas that have it.
pub fn named(panel: &Panel) -> Vec<(&str, Vec<Colour>)> {
    let mut all: Vec<(&str, Vec<Colour>)> = Vec::new();
    for area in panel.areas.iter().filter(|area| !area.label.is_empty()) {
        let shown = mixed(colour(area.colour), PAPER, 1.0 - OPACITY);
        match all.iter_mut().find(|(label, _)| *label == area.label) {
            Some((_, colours)) if colours.contains(&shown) => {}
            Some((_, colours)) => colours.push(shown),
            None => all.push((&area.label, vec![shown])),
        }
    }
    all
}
