//! The shapes of points, each with a white edge that sets it off from the lines it lies on. All look about equally large.

use super::Symbol;
use super::canvas::{Canvas, Colour, PAPER, Pixel};
use super::clip::Window;
use crate::error::Result;
use std::f64::consts::TAU;

/// Radius of a circle.
const RADIUS: f64 = 3.9;
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
///
/// # Errors
/// Those of the canvas.
pub fn draw(canvas: &Canvas<'_>, look: Look, at: Pixel, window: &Window) -> Result<()> {
    let around = |radius: f64, angle: f64| {
        (
            at.0 + radius * (TAU * angle).sin(),
            at.1 - radius * (TAU * angle).cos(),
        )
    };
    let regular = |corners: usize, radius: f64, first: f64| -> Vec<Pixel> {
        let angle = |i: usize| first + i as f64 / corners as f64;
        (0..corners).map(|i| around(radius, angle(i))).collect()
    };
    let line = |line: &[Pixel], colour, width| {
        let mut pieces = window.line(line).into_iter();
        pieces.try_for_each(|piece| canvas.line(&piece, colour, width))
    };
    let corners = match look.symbol {
        Symbol::Plus | Symbol::Cross => {
            let first = if look.symbol == Symbol::Plus {
                0.0
            } else {
                0.125
            };
            let arms = |radius: f64| {
                let arm = move |i: f64| {
                    let angle = first + 0.25 * i;
                    [around(radius, angle), around(radius, angle + 0.5)]
                };
                [arm(0.0), arm(1.0)]
            };
            for arm in arms(1.2 * RADIUS + EDGE) {
                line(&arm, PAPER, ARM + 2.0 * EDGE)?;
            }
            let mut arms = arms(1.2 * RADIUS).into_iter();
            return arms.try_for_each(|arm| line(&arm, look.colour, ARM));
        }
        Symbol::Circle => regular(ROUND, RADIUS, 0.0),
        Symbol::Square => regular(4, 1.25 * RADIUS, 0.125),
        Symbol::Diamond => regular(4, 1.35 * RADIUS, 0.0),
        Symbol::Triangle => regular(3, 1.4 * RADIUS, 0.0),
        Symbol::Star => {
            let tips = regular(5, 1.65 * RADIUS, 0.0);
            let dents = regular(5, 0.68 * RADIUS, 0.1);
            tips.into_iter()
                .zip(dents)
                .flat_map(|(a, b)| [a, b])
                .collect()
        }
    };
    let mut outline = corners.clone();
    // Past the first corner again, so that the line has a corner there too.
    outline.extend(corners.iter().take(2));
    line(&outline, PAPER, OUTLINE + 2.0 * EDGE)?;
    let inside = window.area(&corners);
    let ground = if look.filled { look.colour } else { PAPER };
    if inside.len() > 2 {
        canvas.area(&inside, ground)?;
    }
    line(&outline, look.colour, OUTLINE)
}

/// Draws a small full circle, what of it lies in the window.
///
/// # Errors
/// Those of the canvas.
pub fn dot(
    canvas: &Canvas<'_>,
    at: Pixel,
    radius: f64,
    colour: Colour,
    window: &Window,
) -> Result<()> {
    if window.without((radius, radius)).holds(at) {
        return canvas.circle(at, radius, colour);
    }
    let corner = |i: usize| {
        let angle = TAU * i as f64 / ROUND as f64;
        (at.0 + radius * angle.cos(), at.1 + radius * angle.sin())
    };
    let corners: Vec<Pixel> = (0..ROUND).map(corner).collect();
    let inside = window.area(&corners);
    if inside.len() > 2 {
        canvas.area(&inside, colour)?;
    }
    Ok(())
}
