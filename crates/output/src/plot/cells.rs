//! Maps: the cells of a grid filled with shades. Equal neighbours are one rectangle, all rectangles of a shade one element.

use super::canvas::{Canvas, Colour, Pixel, rgb};
use super::clip::Window;
use super::frame::Frame;
use super::{Cells, Shade};

/// Breadth of stripes across, at least and at most; between them a part of the breadth of a cell, so that each shows all.
const NARROW: f64 = 1.8;
const BROAD: f64 = 5.0;
const OF_CELL: f64 = 0.2;

/// The colour of a shade.
pub fn tint(shade: Shade) -> Colour {
    let white = shade.lightness.clamp(0.0, 1.0);
    let [r, g, b] = shade.colour.map(|part| {
        let part = f64::from(part);
        (part + white * (255.0 - part)).round() as u8
    });
    rgb(r, g, b)
}

/// Draws the cells in the frame.
pub fn cells(canvas: &Canvas, map: &Cells, frame: &Frame) {
    let patches = patches(map);
    let (mut grounds, mut stripes) = (ByColour::default(), ByColour::default());
    let breadth = stripe(map, frame);
    for (patch, fill) in &patches {
        let (Some((&first, rest)), Some(place)) = (fill.split_first(), patch.place(map, frame))
        else {
            continue;
        };
        grounds.add(tint(first), [place.corners().to_vec()]);
        for (i, &shade) in rest.iter().enumerate() {
            let diagonals = diagonals(&place, breadth, (i + 1, fill.len()));
            stripes.add(tint(shade), diagonals);
        }
    }
    for (colour, areas) in &grounds.0 {
        canvas.areas(areas, *colour, true);
    }
    for (colour, areas) in &stripes.0 {
        canvas.areas(areas, *colour, false);
    }
}

/// Areas by their colours.
#[derive(Default)]
struct ByColour(Vec<(Colour, Vec<Vec<Pixel>>)>);

impl ByColour {
    fn add(&mut self, colour: Colour, areas: impl IntoIterator<Item = Vec<Pixel>>) {
        let known = self.0.iter().position(|(other, _)| *other == colour);
        let at = known.unwrap_or_else(|| {
            self.0.push((colour, Vec::new()));
            self.0.len() - 1
        });
        self.0[at].1.extend(areas);
    }
}

/// Cells that are filled alike: columns and rows from the first to before the last.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
struct Patch {
    columns: (usize, usize),
    rows: (usize, usize),
}

impl Patch {
    /// What of it the frame shows, on the picture.
    fn place(&self, map: &Cells, frame: &Frame) -> Option<Window> {
        let (x, y) = (&map.x_edges, &map.y_edges);
        let (columns, rows) = (self.columns, self.rows);
        let corner = |i: usize, j: usize| {
            let at = frame.coordinates(x[i], y[j]);
            // A logarithmic axis has zero infinitely far off: the cell reaches the frame.
            let known = !at.0.is_nan() && !at.1.is_nan();
            known.then(|| frame.pixel(frame.window().nearest(at)))
        };
        let ((left, bottom), (right, top)) =
            corner(columns.0, rows.0).zip(corner(columns.1, rows.1))?;
        (left < right && top < bottom).then_some(Window {
            x: (left, right),
            y: (top, bottom),
        })
    }
}

/// All that is filled, in rectangles: each run of equal cells in a row goes on upwards as long as the rows above have the same.
fn patches(map: &Cells) -> Vec<(Patch, &[Shade])> {
    let columns = map.x_edges.len().saturating_sub(1);
    let mut patches: Vec<(Patch, &[Shade])> = Vec::new();
    // Those that the row before has, from left to right.
    let mut open: Vec<usize> = Vec::new();
    if columns == 0 {
        return patches;
    }
    let rows = map.y_edges.len().saturating_sub(1);
    for (j, row) in map.fills.chunks_exact(columns).take(rows).enumerate() {
        let (mut going, mut i) = (Vec::new(), 0);
        for run in row.chunk_by(|a, b| a == b) {
            let columns = (i, i + run.len());
            i = columns.1;
            let same = open.binary_search_by_key(&columns.0, |&k| patches[k].0.columns.0);
            let below = same.ok().map(|at| open[at]).filter(|&k| {
                let (patch, fill) = patches[k];
                patch.columns == columns && fill == run[0].as_slice()
            });
            let k = below.unwrap_or(patches.len());
            if k == patches.len() {
                let rows = (j, j);
                patches.push((Patch { columns, rows }, &run[0]));
            }
            patches[k].0.rows.1 = j + 1;
            going.push(k);
        }
        open = going;
    }
    patches.retain(|(_, fill)| !fill.is_empty());
    patches
}

/// How broad stripes are in cells of that size.
fn stripe(map: &Cells, frame: &Frame) -> f64 {
    let inside = frame.inside();
    let each = |(lo, hi): (f64, f64), edges: &[f64]| (hi - lo) / edges.len().max(2) as f64;
    let cell = each(inside.x, &map.x_edges).min(each(inside.y, &map.y_edges));
    (OF_CELL * cell).clamp(NARROW, BROAD)
}

/// The stripe of that number of so many, again and again across a rectangle, at the same places in all rectangles.
fn diagonals(
    place: &Window,
    breadth: f64,
    (number, many): (usize, usize),
) -> impl Iterator<Item = Vec<Pixel>> {
    let period = breadth * many as f64;
    let (first, last) = (place.x.0 + place.y.0, place.x.1 + place.y.1);
    let turn = move |k: i64| k as f64 * period + number as f64 * breadth;
    let from = (first / period).floor() as i64 - 1;
    let to = (last / period).ceil() as i64;
    let place = *place;
    (from..=to).filter_map(move |k| {
        let (a, b) = (turn(k).max(first), (turn(k) + breadth).min(last));
        // Where x + y lies between a and b, within the rectangle.
        let (top, bottom) = place.y;
        let corners = [
            (a - top, top),
            (b - top, top),
            (b - bottom, bottom),
            (a - bottom, bottom),
        ];
        let area = place.area(&corners);
        (a < b && area.len() > 2).then_some(area)
    })
}
