//! The curves of a panel in its frame.

use super::canvas::{Canvas, Colour, PAPER, Pixel, colour};
use super::frame::Frame;
use super::thin::thinned;
use super::{Panel, Series, Stroke, names, strokes, symbols};
use crate::error::Result;
use std::collections::HashSet;

/// Breadths of lines.
const LINE: f64 = 1.1;
const USUAL: f64 = 1.9;
/// Of lines that are broken or beside broader ones, and of those.
const NARROW: f64 = 1.4;
const WIDE: f64 = 2.7;
/// Room between a curve and the map that it lies on.
const CASING: f64 = 1.0;
/// Distance of the points along curves that names avoid.
const SAMPLES: f64 = 2.5;

/// The colour of a series, the one of that number in its panel.
pub fn series_colour(series: &Series, number: usize) -> Colour {
    colour(series.colour.unwrap_or(number))
}

/// How broad the line of a series is, or the radius of its points.
pub fn line_width(panel: &Panel, number: usize) -> f64 {
    let series = &panel.series[number];
    if panel.series.iter().any(|series| series.wide) {
        return if series.wide { WIDE } else { NARROW };
    }
    // The curve below is wider where another one follows, so that both are seen where they coincide.
    let last = number + 1 == panel.series.len();
    match series.stroke {
        _ if series.dots || !last || series.colour.is_some() => USUAL,
        Stroke::Solid => LINE,
        _ => NARROW,
    }
}

/// Draws the curves and gives points along them, densely.
///
/// # Errors
/// Those of the canvas.
pub fn curves(canvas: &Canvas<'_>, panel: &Panel, frame: &Frame) -> Result<Vec<Pixel>> {
    let mut seen = Vec::new();
    for (number, series) in panel.series.iter().enumerate() {
        if panel.cells.is_some() {
            let breadth = line_width(panel, number);
            casing(canvas, series, frame, breadth)?;
        }
        let look = (series_colour(series, number), line_width(panel, number));
        if series.dots {
            seen.extend(dots(canvas, series, frame, look)?);
        } else {
            seen.extend(line(canvas, series, frame, look)?);
        }
    }
    Ok(seen)
}

/// What sets a curve off from a map: the same, broader, in white.
fn casing(canvas: &Canvas<'_>, series: &Series, frame: &Frame, breadth: f64) -> Result<()> {
    if series.dots {
        return dots(canvas, series, frame, (PAPER, breadth + CASING)).map(drop);
    }
    let whole = series.clone().stroke(Stroke::Solid);
    line(canvas, &whole, frame, (PAPER, breadth + 2.0 * CASING)).map(drop)
}

fn line(
    canvas: &Canvas<'_>,
    series: &Series,
    frame: &Frame,
    (colour, width): (Colour, f64),
) -> Result<Vec<Pixel>> {
    let (x, y) = (&series.x, &series.y);
    let points = x.iter().zip(y).map(|(&a, &b)| frame.coordinates(a, b));
    let (mut seen, mut been) = (Vec::new(), strokes::Been::default());
    for curve in thinned(points, frame.per_pixel(), x.is_sorted()) {
        for piece in frame.window().line(&curve) {
            let piece: Vec<Pixel> = piece.into_iter().map(|at| frame.pixel(at)).collect();
            seen.extend(names::along(&piece, SAMPLES));
            let stretches = if series.stroke == Stroke::Solid || x.is_sorted() {
                vec![piece]
            } else {
                strokes::first_times(&piece, &mut been)
            };
            for stretch in stretches {
                strokes::draw(canvas, &stretch, series.stroke, width, colour)?;
            }
        }
    }
    Ok(seen)
}

fn dots(
    canvas: &Canvas<'_>,
    series: &Series,
    frame: &Frame,
    (colour, radius): (Colour, f64),
) -> Result<Vec<Pixel>> {
    let mut seen = Vec::new();
    let mut drawn = HashSet::new();
    for (&a, &b) in series.x.iter().zip(&series.y) {
        let at = frame.coordinates(a, b);
        if !frame.window().holds(at) {
            continue;
        }
        let at = frame.pixel(at);
        // Again to a quarter of a pixel: it would only make the file longer.
        if drawn.insert(((4.0 * at.0).round() as i64, (4.0 * at.1).round() as i64)) {
            symbols::dot(canvas, at, radius, colour, frame.inside())?;
            seen.push(at);
        }
    }
    Ok(seen)
}
