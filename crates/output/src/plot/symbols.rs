//! The shapes of points, each with a white edge that sets it off from the lines it lies on. All look about equally large.

use super::Symbol;
use super::canvas::{Canvas, Colour, PAPER, Pixel};
use super::clip::Window;
use std::f64::consts::TAU;

/// Radius of a circle.
const RADIUS: f64 = 3.9;
/// That of a dot.
const DOT: f64 = 1.2;
/// Breadth of outlines, and of the arms of crosses.
const OUTLINE: f64 = 1.5;
const ARM: f64 = 2.0;
/// Breadth of the white edge.
const EDGE: f64 = 1.3;
/// Corners of a circle that is cut off.
const ROUND: usize = 36;
/// Half of the room that a symbol takes in the legend.
pub const HALF: f64 = 6.0;

/// A symbol with its look.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Look {
    /// The shape.
    pub symbol: Symbol,
    /// Whether it is filled.
    pub filled: bool,
    /// In that colour.
    pub colour: Colour,
}

/// Draws a symbol, what of it lies in the window.
pub fn draw(canvas: &Canvas, look: Look, at: Pixel, window: &Window) {
    let line = |line: &[Pixel], colour, width| {
        let pieces = window.line(line).into_iter();
        pieces.for_each(|piece| canvas.line(&piece, colour, width))
    };
    if let Some(first) = cross(look.symbol) {
        for arm in arms(at, 1.2 * RADIUS + EDGE, first) {
            line(&arm, PAPER, ARM + 2.0 * EDGE);
        }
        let arms = arms(at, 1.2 * RADIUS, first).into_iter();
        return arms.for_each(|arm| line(&arm, look.colour, ARM));
    }
    let corners = corners(look.symbol, at);
    let mut outline = corners.clone();
    // Past the first corner again, so that the line has a corner there too.
    outline.extend(corners.iter().take(2));
    line(&outline, PAPER, OUTLINE + 2.0 * EDGE);
    let inside = window.area(&corners);
    let ground = if look.filled { look.colour } else { PAPER };
    if inside.len() > 2 {
        canvas.area(&inside, ground);
    }
    line(&outline, look.colour, OUTLINE)
}

/// The place at that distance and angle, in turns from straight up.
fn around(at: Pixel, radius: f64, turns: f64) -> Pixel {
    let angle = TAU * turns;
    (at.0 + radius * angle.sin(), at.1 - radius * angle.cos())
}

/// The angle of the first arm of a cross; none for a symbol that encloses something.
fn cross(symbol: Symbol) -> Option<f64> {
    match symbol {
        Symbol::Plus => Some(0.0),
        Symbol::Cross => Some(0.125),
        _ => None,
    }
}

/// The two lines of a cross.
fn arms(at: Pixel, radius: f64, first: f64) -> [[Pixel; 2]; 2] {
    [first, first + 0.25].map(|turns| [around(at, radius, turns), around(at, radius, turns + 0.5)])
}

/// The corners of a symbol that encloses something.
fn corners(symbol: Symbol, at: Pixel) -> Vec<Pixel> {
    let regular = |corners: usize, radius: f64, first: f64| -> Vec<Pixel> {
        let turns = |i: usize| first + i as f64 / corners as f64;
        (0..corners).map(|i| around(at, radius, turns(i))).collect()
    };
    match symbol {
        Symbol::Dot => regular(ROUND, DOT, 0.0),
        Symbol::Square => regular(4, 1.25 * RADIUS, 0.125),
        Symbol::Diamond => regular(4, 1.35 * RADIUS, 0.0),
        Symbol::Triangle => regular(3, 1.4 * RADIUS, 0.0),
        Symbol::Star => {
            let (tips, dents) = (
                regular(5, 1.65 * RADIUS, 0.0),
                regular(5, 0.68 * RADIUS, 0.1),
            );
            let both = tips.into_iter().zip(dents);
            both.flat_map(|(tip, dent)| [tip, dent]).collect()
        }
        Symbol::Circle | Symbol::Plus | Symbol::Cross => regular(ROUND, RADIUS, 0.0),
    }
}

/// Draws a small full circle, what of it lies in the window.
pub fn dot(canvas: &Canvas, at: Pixel, radius: f64, colour: Colour, window: &Window) {
    if window.without((radius, radius)).holds(at) {
        return canvas.circle(at, radius, colour);
    }
    let corner = |i: usize| around(at, radius, i as f64 / ROUND as f64);
    let corners: Vec<Pixel> = (0..ROUND).map(corner).collect();
    let inside = window.area(&corners);
    if inside.len() > 2 {
        canvas.area(&inside, colour);
    }
}
