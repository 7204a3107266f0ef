//! The heading of a panel: its title and the legend, both outside of the frame so that nothing covers the curves. What has no
//! room on a line goes to the next.

use super::canvas::{Align, Canvas, Colour, INK, MARK, Pixel, colour};
use super::cells::tint;
use super::clip::Window;
use super::curves::{line_width, series_colour};
use super::symbols::{self, Look};
use super::text::{TEXT, width, wrapped};
use super::{Panel, Stroke, areas, strokes};

/// Height of one line.
const LINE: f64 = 20.0;
/// Room above the first line and below the last.
const AROUND: f64 = 6.0;
/// Room after the title, and after an entry.
const AFTER_TITLE: f64 = 22.0;
const AFTER_ENTRY: f64 = 16.0;
/// Length of a line's sample: more than one turn of any pattern.
const SAMPLE: f64 = 32.0;
/// Room between a sample and its name.
const GAP: f64 = 7.0;
/// Side of a square, and breadth of its outline.
const SQUARE: f64 = 11.0;
const OUTLINE: f64 = 0.6;
/// Lines and points of the legend are not finer than this.
const FINEST: f64 = 1.6;

/// What stands before a name.
#[derive(Debug, Clone, PartialEq)]
enum LegendSymbol {
    Nothing,
    Line(Stroke, f64),
    Dots(f64),
    Symbol(Look),
    Squares(Vec<Colour>),
}

/// Words with what stands before them.
#[derive(Debug, Clone, PartialEq)]
struct LegendEntry {
    /// From the left end of the heading, and the middle of its line from the top.
    at: Pixel,
    sample: LegendSymbol,
    text: String,
    colour: Colour,
}

/// Title and legend with their places.
#[derive(Debug, Clone, PartialEq)]
pub struct Heading {
    entries: Vec<LegendEntry>,
    lines: usize,
}

impl Heading {
    /// Height of one line.
    pub const LEAST: f64 = AROUND + LINE;

    /// That of a panel, on lines of this length. A legend that has no room beside the title begins below it.
    pub fn new(panel: &Panel, limit: f64) -> Self {
        let beside = Heading::arranged(panel, limit, false);
        if beside.lines == 1 {
            return beside;
        }
        Heading::arranged(panel, limit, true)
    }

    fn arranged(panel: &Panel, limit: f64, title_alone: bool) -> Self {
        let mut flow = Flow {
            heading: Heading {
                entries: Vec::new(),
                lines: 1,
            },
            used: 0.0,
            limit,
        };
        flow.add(LegendSymbol::Nothing, &panel.title, INK, AFTER_TITLE);
        if title_alone {
            flow.used = flow
                .used
                .max(limit * f64::from(u8::from(!panel.title.is_empty())));
        }
        for swatch in panel.cells.iter().flat_map(|map| &map.swatches) {
            let colours: Vec<Colour> = swatch.shades.iter().copied().map(tint).collect();
            let sample = if colours.is_empty() {
                LegendSymbol::Nothing
            } else {
                LegendSymbol::Squares(colours)
            };
            flow.add(sample, &swatch.label, INK, AFTER_ENTRY);
        }
        for (i, series) in panel.series.iter().enumerate() {
            let colour = series_colour(series, i);
            let width = line_width(panel, i).max(FINEST);
            let sample = if series.dots {
                LegendSymbol::Dots(width)
            } else {
                LegendSymbol::Line(series.stroke, width)
            };
            flow.add(sample, &series.label, colour, AFTER_ENTRY);
        }
        for (label, colours) in areas::named(panel) {
            flow.add(LegendSymbol::Squares(colours), label, INK, AFTER_ENTRY);
        }
        for (stroke, words) in &panel.strokes {
            flow.add(LegendSymbol::Line(*stroke, FINEST), words, INK, AFTER_ENTRY);
        }
        for key in &panel.keys {
            let look = Look {
                symbol: key.symbol,
                filled: key.filled,
                colour: key.colour.map_or(MARK, colour),
            };
            flow.add(LegendSymbol::Symbol(look), &key.label, INK, AFTER_ENTRY);
        }
        flow.heading
    }

    /// How high it is.
    pub fn height(&self) -> f64 {
        AROUND + LINE * self.lines as f64
    }

    /// Draws it with its lower left corner there.
    pub fn draw(&self, canvas: &Canvas, corner: Pixel) {
        let top = corner.1 - self.height();
        self.entries.iter().for_each(|entry| {
            let at = (corner.0 + entry.at.0, top + entry.at.1);
            entry.sample.draw(canvas, at, entry.colour);
            let text = (at.0 + entry.sample.width(), at.1);
            canvas.words(&entry.text, text, Align::Left, TEXT, entry.colour)
        })
    }
}

impl LegendSymbol {
    /// Of the room before the words.
    fn width(&self) -> f64 {
        match self {
            LegendSymbol::Nothing => 0.0,
            LegendSymbol::Line(..) => SAMPLE + GAP,
            LegendSymbol::Dots(_) | LegendSymbol::Symbol(_) => 2.0 * symbols::HALF + GAP,
            LegendSymbol::Squares(colours) => SQUARE * colours.len() as f64 + GAP,
        }
    }

    fn draw(&self, canvas: &Canvas, (x, y): Pixel, colour: Colour) {
        let all = Window {
            x: (f64::NEG_INFINITY, f64::INFINITY),
            y: (f64::NEG_INFINITY, f64::INFINITY),
        };
        match self {
            LegendSymbol::Nothing => (),
            LegendSymbol::Line(stroke, width) => {
                strokes::draw(canvas, &[(x, y), (x + SAMPLE, y)], *stroke, *width, colour)
            }
            LegendSymbol::Dots(radius) => canvas.circle((x + symbols::HALF, y), *radius, colour),
            LegendSymbol::Symbol(look) => {
                symbols::draw(canvas, *look, (x + symbols::HALF, y), &all)
            }
            LegendSymbol::Squares(colours) => squares(canvas, (x, y), colours),
        }
    }
}

/// Squares side by side from there, with an outline around all, as the palest ones are nearly white.
fn squares(canvas: &Canvas, (x, y): Pixel, colours: &[Colour]) {
    let side = |i: usize| x + SQUARE * i as f64;
    let strip = |from: usize, to: usize| {
        let place = Window {
            x: (side(from), side(to)),
            y: (y - 0.5 * SQUARE, y + 0.5 * SQUARE),
        };
        place.corners().to_vec()
    };
    for (i, &colour) in colours.iter().enumerate() {
        canvas.areas(&[strip(i, i + 1)], colour, true);
    }
    let mut outline = strip(0, colours.len());
    outline.push(outline[0]);
    canvas.line(&outline, INK, OUTLINE)
}

/// Entries set one after the other.
struct Flow {
    heading: Heading,
    /// Of the last line.
    used: f64,
    limit: f64,
}

impl Flow {
    fn add(&mut self, sample: LegendSymbol, text: &str, colour: Colour, after: f64) {
        if text.is_empty() {
            return;
        }
        let room = (self.limit - sample.width()).max(1.0);
        for (i, text) in wrapped(text, TEXT, room).into_iter().enumerate() {
            let whole = sample.width() + width(&text, TEXT);
            if self.used > 0.0 && (i > 0 || self.used + whole > self.limit) {
                self.heading.lines += 1;
                self.used = 0.0;
            }
            let middle = AROUND / 2.0 + (self.heading.lines as f64 - 0.5) * LINE;
            let (first, indent) = match i {
                0 => (sample.clone(), 0.0),
                _ => (LegendSymbol::Nothing, sample.width()),
            };
            self.heading.entries.push(LegendEntry {
                at: (self.used + indent, middle),
                sample: first,
                text,
                colour,
            });
            self.used += whole + after;
        }
    }
}
