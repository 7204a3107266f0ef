//! What is drawn, in pixels with fractions: lines, areas and words. Only this file knows which crate writes the SVG, and what
//! that crate cannot write.

use super::text::{self, FAMILY};
use super::unrendered;
use crate::error::Result;
use plotters::coord::Shift;
use plotters::element::{Drawable, PointCollection};
use plotters::prelude::*;
use std::cell::RefCell;
use std::fmt::Write;

/// A place in pixels, y downwards.
pub type Pixel = (f64, f64);
/// Red, green, blue.
pub type Colour = RGBColor;

/// Axes and words.
pub const INK: Colour = RGBColor(40, 40, 40);
/// Lines at the ticks.
pub const GRID: Colour = RGBColor(228, 228, 228);
/// Behind all.
pub const PAPER: Colour = WHITE;
/// Points that are pointed out, and their names.
pub const MARK: Colour = RGBColor(150, 30, 30);
/// Okabe and Ito: told apart by all. Grey is darker than theirs would be beside the grid, sky blue and orange come late as they
/// are pale.
const COLOURS: [Colour; 8] = [
    RGBColor(0, 114, 178),
    RGBColor(213, 94, 0),
    RGBColor(0, 158, 115),
    RGBColor(204, 121, 167),
    RGBColor(86, 180, 233),
    RGBColor(230, 159, 0),
    RGBColor(120, 120, 120),
    RGBColor(0, 0, 0),
];
/// plotters counts whole pixels: drawn this much larger and shown at normal size, curves are smooth.
const FINE: f64 = 10.0;
/// Letters are centred by half of their height without ascenders, as a part of the size.
const MIDDLE: f64 = 0.273;
/// What plotters calls the size of a font is so much larger than the one that is written.
pub const BACKEND: f64 = 1.24;

/// The colour with these parts.
pub fn rgb(red: u8, green: u8, blue: u8) -> Colour {
    RGBColor(red, green, blue)
}

/// The colour of that number.
pub fn colour(number: usize) -> Colour {
    COLOURS[number % COLOURS.len()]
}

/// Where words stand with respect to their place; always centred across their line.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Align {
    /// They begin there.
    Left,
    /// They are centred there.
    Middle,
    /// They end there.
    Right,
    /// They are centred there, read from below.
    Upwards,
}

/// A picture in the making.
pub struct Canvas<'s> {
    area: DrawingArea<SVGBackend<'s>, Shift>,
    /// Elements that plotters doesn't write, in the places that [`holder`] keeps.
    own: RefCell<Vec<String>>,
}

/// The SVG of that size.
///
/// # Errors
/// Those of the drawing.
pub fn picture(size: (f64, f64), draw: impl FnOnce(&Canvas<'_>) -> Result<()>) -> Result<String> {
    let mut text = String::new();
    let (width, height) = fine(size);
    let own = {
        let root = SVGBackend::with_string(&mut text, (width as u32, height as u32));
        let canvas = Canvas {
            area: root.into_drawing_area(),
            own: RefCell::default(),
        };
        canvas.area.fill(&PAPER).map_err(unrendered)?;
        draw(&canvas)?;
        canvas.area.present().map_err(unrendered)?;
        canvas.own.into_inner()
    };
    let text = completed(&text, &own);
    let drawn = format!(r#"width="{width}" height="{height}""#);
    let shown = format!(
        r#"width="{}" height="{}""#,
        f64::from(width) / FINE,
        f64::from(height) / FINE
    );
    Ok(text.replacen(&drawn, &shown, 1))
}

/// The one point of an area without extent, which keeps the place of one of our own elements: in a corner of the picture, where
/// nothing else is.
fn holder(number: usize) -> (i32, i32) {
    const ROW: usize = 1000;
    ((number % ROW) as i32, (number / ROW) as i32)
}

/// The text with our own elements in their places.
fn completed(text: &str, own: &[String]) -> String {
    let mut whole = String::with_capacity(text.len() + own.iter().map(String::len).sum::<usize>());
    let mut next = own.iter().enumerate().peekable();
    for line in text.split_inclusive('\n') {
        let held = next.next_if(|(number, _)| {
            let (x, y) = holder(*number);
            line.contains(&format!("points=\"{x},{y} {x},{y} {x},{y}"))
        });
        whole.push_str(held.map_or(line, |(_, element)| element));
    }
    whole
}

/// The outline of an area in the language of paths, in steps from corner to corner.
fn outline(path: &mut String, corners: &[Pixel]) {
    let mut before = None;
    for (x, y) in corners.iter().copied().map(fine) {
        let step = match before {
            None => write!(path, "M{x} {y}"),
            Some((a, b)) if b == y => write!(path, "h{}", x - a),
            Some((a, b)) if a == x => write!(path, "v{}", y - b),
            Some((a, b)) => write!(path, "l{} {}", x - a, y - b),
        };
        step.expect("a string takes all");
        before = Some((x, y));
    }
    path.push('z');
}

/// In the language of SVG.
fn escaped(text: &str) -> String {
    let text = text.replace('&', "&amp;");
    text.replace('<', "&lt;").replace('>', "&gt;")
}

fn fine((x, y): Pixel) -> (i32, i32) {
    ((x * FINE).round() as i32, (y * FINE).round() as i32)
}

impl<'s> Canvas<'s> {
    /// A line through these places.
    pub fn line(&self, line: &[Pixel], colour: Colour, width: f64) -> Result<()> {
        let style = colour.stroke_width((width * FINE).round() as u32);
        let line: Vec<_> = line.iter().copied().map(fine).collect();
        self.put(&PathElement::new(line, style))
    }

    /// The area within these corners.
    pub fn area(&self, corners: &[Pixel], colour: Colour) -> Result<()> {
        let corners: Vec<_> = corners.iter().copied().map(fine).collect();
        self.put(&Polygon::new(corners, colour.filled()))
    }

    /// Areas in one colour that share sides without a seam; `upright` ones, with all sides along the axes, also with areas of
    /// other colours.
    pub fn areas(&self, areas: &[Vec<Pixel>], colour: Colour, upright: bool) -> Result<()> {
        let RGBColor(r, g, b) = colour;
        // A side between two pixels would be drawn by both neighbours in part, and let the ground through.
        let edges = if upright {
            r#" shape-rendering="crispEdges""#
        } else {
            ""
        };
        let mut path = format!("<path fill=\"#{r:02X}{g:02X}{b:02X}\"{edges} d=\"");
        areas.iter().for_each(|area| outline(&mut path, area));
        path.push_str("\"/>\n");
        self.element(path)
    }

    /// An area through which what lies behind is seen.
    pub fn veil(&self, corners: &[Pixel], colour: Colour, opacity: f64) -> Result<()> {
        let RGBColor(r, g, b) = colour;
        let mut path =
            format!("<path fill=\"#{r:02X}{g:02X}{b:02X}\" fill-opacity=\"{opacity}\" d=\"");
        outline(&mut path, corners);
        path.push_str("\"/>\n");
        self.element(path)
    }

    /// What plotters doesn't write.
    fn element(&self, text: String) -> Result<()> {
        let place = {
            let mut own = self.own.borrow_mut();
            own.push(text);
            holder(own.len() - 1)
        };
        self.put(&Polygon::new([place; 3], PAPER.filled()))
    }

    /// A full circle.
    pub fn circle(&self, at: Pixel, radius: f64, colour: Colour) -> Result<()> {
        self.put(&Circle::new(
            fine(at),
            (radius * FINE).round() as i32,
            colour.filled(),
        ))
    }

    /// Words on one line.
    pub fn words(
        &self,
        text: &str,
        at: Pixel,
        align: Align,
        size: f64,
        colour: Colour,
    ) -> Result<()> {
        let anchor = match align {
            Align::Left => "start",
            Align::Right => "end",
            Align::Middle | Align::Upwards => "middle",
        };
        let (x, y) = fine(at);
        let turned = if align == Align::Upwards {
            format!(" transform=\"rotate(270, {x}, {y})\"")
        } else {
            String::new()
        };
        let RGBColor(r, g, b) = colour;
        let size = size * FINE;
        let mut element = format!(
            "<text x=\"{x}\" y=\"{y}\" dy=\"{:.0}\" text-anchor=\"{anchor}\" font-family=\"{FAMILY}\" font-size=\"{size}\" \
fill=\"#{r:02X}{g:02X}{b:02X}\"{turned}>",
            MIDDLE * size
        );
        // How far below the line the part before ended.
        let mut low = 0.0;
        for (part, subscript) in text::parts(text) {
            let now = if subscript { text::LOWER * size } else { 0.0 };
            let part = escaped(&part);
            let step = now - low;
            low = now;
            let written = match (subscript, step == 0.0) {
                (true, _) => write!(
                    element,
                    "<tspan dy=\"{step:.0}\" font-size=\"{:.0}\">{part}</tspan>",
                    text::SUBSCRIPT * size
                ),
                (false, true) => write!(element, "{part}"),
                (false, false) => write!(element, "<tspan dy=\"{step:.0}\">{part}</tspan>"),
            };
            written.expect("a string takes all");
        }
        element.push_str("</text>\n");
        self.element(element)
    }

    fn put<E>(&self, element: &E) -> Result<()>
    where
        for<'e> &'e E: PointCollection<'e, (i32, i32)>,
        E: Drawable<SVGBackend<'s>>,
    {
        self.area.draw(element).map_err(unrendered)
    }
}
