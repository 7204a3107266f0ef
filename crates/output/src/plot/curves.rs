//! The curves of a panel in its frame.

use super::bands::{self, Part};
use super::canvas::{Canvas, Colour, PAPER, Pixel, colour};
use super::clip::Point;
use super::frame::Frame;
use super::smooth::smooth;
use super::thin::thinned;
use super::{Panel, PlotSeries, Stroke, names, strokes, symbols};
use std::collections::{HashMap, HashSet};

/// Breadths of lines: of one, of one of several, of one beside broader ones, and of those.
const LINE: f64 = 1.3;
const USUAL: f64 = 1.7;
const NARROW: f64 = 1.2;
const WIDE: f64 = 2.7;
/// A path that covers more than this part of a square of that side, in pixels, is drawn finer, down to the finest.
const COVERED: f64 = 0.35;
const SQUARE: f64 = 16.0;
const FINEST: f64 = 0.4;
/// More lines than this in a panel are drawn finer, down to the finest of many, if they run close beside each other.
const MANY: usize = 24;
const FINEST_OF_MANY: f64 = 0.6;
/// How dense the area between the envelopes of oscillations is.
const VEIL: f64 = 0.3;
/// Room between a curve and the map that it lies on.
const CASING: f64 = 1.0;
/// Distance of the points along curves that names avoid.
const SAMPLES: f64 = 2.5;

/// The colour of a series, the one of that number in its panel.
pub fn series_colour(series: &PlotSeries, number: usize) -> Colour {
    colour(series.colour.unwrap_or(number))
}

/// How broad the line of a series is, or the radius of its points.
pub fn line_width(panel: &Panel, number: usize) -> f64 {
    /// So many points are a crowd, of which each is small.
    const CROWD: usize = 3000;
    const CROWDED: f64 = 0.6;
    let series = &panel.series[number];
    if series.dots && series.x.len() > CROWD {
        return CROWDED;
    }
    if panel.series.iter().any(|series| series.wide) {
        return if series.wide { WIDE } else { NARROW };
    }
    if panel.series.len() == 1 && series.colour.is_none() {
        LINE
    } else {
        USUAL
    }
}

/// Draws the curves and gives points along them, densely.
pub fn curves(canvas: &Canvas, panel: &Panel, frame: &Frame) -> Vec<Pixel> {
    let mut seen = Vec::new();
    let widths = drawn_widths(panel, frame);
    for ((number, series), width) in panel.series.iter().enumerate().zip(widths) {
        if panel.cells.is_some() {
            casing(canvas, series, frame, width);
        }
        let look = (series_colour(series, number), width);
        if series.dots {
            seen.extend(dots(canvas, series, frame, look));
        } else {
            seen.extend(line(canvas, series, frame, look));
        }
    }
    seen
}

/// What sets a curve off from a map: the same, broader, in white.
fn casing(canvas: &Canvas, series: &PlotSeries, frame: &Frame, breadth: f64) {
    if series.dots {
        dots(canvas, series, frame, (PAPER, breadth + CASING));
        return;
    }
    let whole = series.clone().stroke(Stroke::Solid);
    line(canvas, &whole, frame, (PAPER, breadth + 2.0 * CASING));
}

/// The curve through the points of a series, in the coordinates of the axes; where it breaks there is a point that is no number.
pub fn through(series: &PlotSeries, frame: &Frame) -> Vec<Point> {
    let points = series.x.iter().zip(&series.y);
    let points: Vec<Point> = points.map(|(&a, &b)| frame.coordinates(a, b)).collect();
    smooth(&points, frame.per_pixel(), &series.left_out)
}

/// What of it is drawn, in pixels.
fn pieces(series: &PlotSeries, frame: &Frame) -> Vec<Vec<Pixel>> {
    let points = through(series, frame).into_iter();
    let curves = thinned(points, frame.per_pixel(), series.x.is_sorted());
    let pieces = curves.iter().flat_map(|curve| frame.window().line(curve));
    pieces
        .map(|piece| piece.into_iter().map(|at| frame.pixel(at)).collect())
        .collect()
}

/// How broad the line of each series is drawn, or the radius of its points.
pub fn drawn_widths(panel: &Panel, frame: &Frame) -> Vec<f64> {
    let all = || panel.series.iter().enumerate();
    let lines = || all().filter(|(_, series)| !series.dots);
    if lines().count() > MANY {
        let pieces: Vec<Vec<Pixel>> = lines().flat_map(|(_, line)| pieces(line, frame)).collect();
        let usual = lines().map(|(i, _)| line_width(panel, i));
        let usual = usual.fold(0.0, f64::max);
        let part = finer(usual, FINEST_OF_MANY, &pieces) / usual;
        let width = |(i, series): (usize, &PlotSeries)| match series.dots {
            true => line_width(panel, i),
            false => part * line_width(panel, i),
        };
        return all().map(width).collect();
    }
    let width = |(i, series): (usize, &PlotSeries)| match series.dots || series.x.is_sorted() {
        true => line_width(panel, i),
        false => finer(line_width(panel, i), FINEST, &pieces(series, frame)),
    };
    all().map(width).collect()
}

fn line(
    canvas: &Canvas,
    series: &PlotSeries,
    frame: &Frame,
    (colour, width): (Colour, f64),
) -> Vec<Pixel> {
    let grows = series.x.is_sorted();
    let (mut seen, mut been) = (Vec::new(), strokes::Been::default());
    let pieces = pieces(series, frame);
    for piece in pieces {
        seen.extend(names::along(&piece, SAMPLES));
        let stretches = if grows {
            bands::parts(&piece)
        } else if series.stroke == Stroke::Solid {
            vec![Part::Line(piece)]
        } else {
            let stretches = strokes::first_times(&piece, &mut been).into_iter();
            stretches.map(Part::Line).collect()
        };
        for stretch in stretches {
            match stretch {
                Part::Line(line) => strokes::draw(canvas, &line, series.stroke, width, colour),
                Part::Band(lower, upper) => {
                    let mut area = lower.clone();
                    area.extend(upper.iter().rev());
                    canvas.veil(&area, colour, VEIL);
                    for side in [lower, upper] {
                        strokes::draw(canvas, &side, series.stroke, width, colour);
                    }
                }
            }
        }
    }
    seen
}

/// The breadth of paths that go around again and again: so fine that their turns stand apart, if they can.
fn finer(width: f64, finest: f64, pieces: &[Vec<Pixel>]) -> f64 {
    let mut lengths: HashMap<(i64, i64), f64> = HashMap::new();
    let places = pieces.iter().map(|piece| names::along(piece, SAMPLES));
    for place in places {
        for pair in place.windows(2) {
            let (a, b) = (pair[0], pair[1]);
            let square = |x: f64| (x / SQUARE).floor() as i64;
            let length = lengths.entry((square(a.0), square(a.1)));
            *length.or_default() += (b.0 - a.0).hypot(b.1 - a.1);
        }
    }
    let longest = lengths.into_values().fold(0.0, f64::max);
    let covered = longest * width / (SQUARE * SQUARE);
    (width * (COVERED / covered).min(1.0)).max(finest.min(width))
}

fn dots(
    canvas: &Canvas,
    series: &PlotSeries,
    frame: &Frame,
    (colour, radius): (Colour, f64),
) -> Vec<Pixel> {
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
            symbols::dot(canvas, at, radius, colour, frame.inside());
            seen.push(at);
        }
    }
    seen
}
