//! What is drawn, in pixels with fractions: lines, areas and words, written as SVG.

use super::text::{self, FAMILY};
use std::cell::RefCell;
use std::fmt::{self, Display, Write};

/// A place in pixels, y downwards.
pub type Pixel = (f64, f64);
/// Red, green, blue.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Colour(u8, u8, u8);

impl Display for Colour {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let Colour(r, g, b) = self;
        write!(f, "#{r:02X}{g:02X}{b:02X}")
    }
}

/// Axes and words.
pub const INK: Colour = Colour(40, 40, 40);
/// Lines at the ticks.
pub const GRID: Colour = Colour(228, 228, 228);
/// Behind all.
pub const PAPER: Colour = Colour(255, 255, 255);
/// Points that are pointed out, and their names.
pub const MARK: Colour = Colour(150, 30, 30);
/// Okabe and Ito: told apart by all. Grey is darker than theirs would be beside the grid, sky blue and orange come late as they
/// are pale.
const COLOURS: [Colour; 8] = [
    Colour(0, 114, 178),
    Colour(213, 94, 0),
    Colour(0, 158, 115),
    Colour(204, 121, 167),
    Colour(86, 180, 233),
    Colour(230, 159, 0),
    Colour(120, 120, 120),
    Colour(0, 0, 0),
];
/// Coordinates are whole numbers of this part of a pixel: the files are half as long.
const FINE: f64 = 10.0;
/// Letters are centred by half of their height without ascenders, as a part of the size.
const MIDDLE: f64 = 0.273;

/// The colour with these parts.
pub fn rgb(red: u8, green: u8, blue: u8) -> Colour {
    Colour(red, green, blue)
}

/// A colour with a part of another one in it.
pub fn mixed(one: Colour, other: Colour, part: f64) -> Colour {
    let mix = |a: u8, b: u8| (f64::from(a) + part * (f64::from(b) - f64::from(a))).round() as u8;
    Colour(
        mix(one.0, other.0),
        mix(one.1, other.1),
        mix(one.2, other.2),
    )
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

impl Align {
    /// The part of the words that stands before their place.
    fn before(self) -> f64 {
        match self {
            Align::Left => 0.0,
            Align::Right => 1.0,
            Align::Middle | Align::Upwards => 0.5,
        }
    }
}

/// How words are written.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Words {
    /// As text, in the font that a viewer has.
    Text,
    /// As the outlines of their letters in the font that is built in.
    Outlines,
}

/// A picture in the making.
pub struct Canvas {
    svg: RefCell<String>,
    words: Words,
}

/// The SVG of that size.
pub fn picture(size: (f64, f64), words: Words, draw: impl FnOnce(&Canvas)) -> String {
    let (width, height) = fine(size);
    let canvas = Canvas {
        svg: RefCell::default(),
        words,
    };
    canvas.put(format_args!(
        "<svg width=\"{}\" height=\"{}\" viewBox=\"0 0 {width} {height}\" xmlns=\"http://www.w3.org/2000/svg\">\n\
        <rect x=\"0\" y=\"0\" width=\"{width}\" height=\"{height}\" fill=\"{PAPER}\"/>\n",
        f64::from(width) / FINE,
        f64::from(height) / FINE
    ));
    draw(&canvas);
    canvas.put(format_args!("</svg>\n"));
    canvas.svg.into_inner()
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

/// Corners, one after the other.
fn points(line: &[Pixel]) -> String {
    let mut points = String::with_capacity(12 * line.len());
    for (x, y) in line.iter().copied().map(fine) {
        write!(points, "{x},{y} ").expect("a string takes all");
    }
    points.pop();
    points
}

impl Canvas {
    fn put(&self, element: fmt::Arguments<'_>) {
        let mut svg = self.svg.borrow_mut();
        svg.write_fmt(element).expect("a string takes all");
    }

    /// A line through these places.
    pub fn line(&self, line: &[Pixel], colour: Colour, width: f64) {
        self.put(format_args!(
            "<polyline fill=\"none\" stroke=\"{colour}\" stroke-width=\"{:.0}\" points=\"{}\"/>\n",
            width * FINE,
            points(line)
        ));
    }

    /// The area within these corners.
    pub fn area(&self, corners: &[Pixel], colour: Colour) {
        self.put(format_args!(
            "<polygon fill=\"{colour}\" points=\"{}\"/>\n",
            points(corners)
        ));
    }

    /// Areas in one colour that share sides without a seam; `upright` ones, with all sides along the axes, also with areas of
    /// other colours.
    pub fn areas(&self, areas: &[Vec<Pixel>], colour: Colour, upright: bool) {
        // A side between two pixels would be drawn by both neighbours in part, and let the ground through.
        let edges = if upright {
            r#" shape-rendering="crispEdges""#
        } else {
            ""
        };
        let mut path = String::new();
        areas.iter().for_each(|area| outline(&mut path, area));
        self.put(format_args!(
            "<path fill=\"{colour}\"{edges} d=\"{path}\"/>\n"
        ));
    }

    /// An area through which what lies behind is seen.
    pub fn veil(&self, corners: &[Pixel], colour: Colour, opacity: f64) {
        let mut path = String::new();
        outline(&mut path, corners);
        self.put(format_args!(
            "<path fill=\"{colour}\" fill-opacity=\"{opacity}\" d=\"{path}\"/>\n"
        ));
    }

    /// A full circle.
    pub fn circle(&self, at: Pixel, radius: f64, colour: Colour) {
        let (x, y) = fine(at);
        self.put(format_args!(
            "<circle cx=\"{x}\" cy=\"{y}\" r=\"{:.0}\" fill=\"{colour}\"/>\n",
            radius * FINE
        ));
    }

    /// Words on one line.
    pub fn words(&self, text: &str, at: Pixel, align: Align, size: f64, colour: Colour) {
        let (x, y) = fine(at);
        let turned = if align == Align::Upwards {
            format!(" transform=\"rotate(270, {x}, {y})\"")
        } else {
            String::new()
        };
        let size = size * FINE;
        let parts = text::parts(text);
        // Some viewers drop the spaces at the ends of each part, as that after a subscript.
        let spaces = if parts.len() > 1 {
            " xml:space=\"preserve\""
        } else {
            ""
        };
        if self.words == Words::Outlines {
            let begin = f64::from(x) - align.before() * text::advance(&parts, size);
            let path = text::outlines(&parts, (begin, f64::from(y) + MIDDLE * size), size);
            self.put(format_args!(
                "<path fill=\"{colour}\"{turned} d=\"{path}\"/>\n"
            ));
            return;
        }
        let anchor = match align {
            Align::Left => "start",
            Align::Right => "end",
            Align::Middle | Align::Upwards => "middle",
        };
        self.put(format_args!(
            "<text x=\"{x}\" y=\"{y}\" dy=\"{:.0}\" text-anchor=\"{anchor}\" font-family=\"{FAMILY}\" font-size=\"{size}\" \
            fill=\"{colour}\"{turned}{spaces}>",
            MIDDLE * size
        ));
        // How far below the line the part before ended.
        let mut low = 0.0;
        for (part, subscript) in &parts {
            let now = if *subscript { text::LOWER * size } else { 0.0 };
            let part = escaped(part);
            let step = now - low;
            low = now;
            match (*subscript, step == 0.0) {
                (true, _) => self.put(format_args!(
                    "<tspan dy=\"{step:.0}\" font-size=\"{:.0}\">{part}</tspan>",
                    text::SUBSCRIPT * size
                )),
                (false, true) => self.put(format_args!("{part}")),
                (false, false) => {
                    self.put(format_args!("<tspan dy=\"{step:.0}\">{part}</tspan>"));
                }
            }
        }
        self.put(format_args!("</text>\n"));
    }
}
