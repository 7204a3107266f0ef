//! Where everything stands on the picture: blocks one below the other, each with its columns of panels.

use super::canvas::Pixel;
use super::clip::Window;
use super::frame::{self, Frame};
use super::legend::Heading;
use super::reach::scales;
use super::scale::Scale;
use super::text::{self, TEXT, TITLE};
use super::{Block, Panel};
use crate::error::Result;

/// Width of a picture with one column of panels, and of each of several: so narrow that words stay legible where the picture is shown
/// smaller, those of one column at least 11 pixels high on a screen of 390.
const COLUMN: f64 = 460.0;
const NARROW: f64 = 390.0;
/// Height of a block per panel of its highest column, and at least, if it is all the picture.
const ROW: f64 = 215.0;
const LEAST: f64 = 400.0;
/// Of one or two panels one below the other across the whole picture.
const HIGH_ROW: f64 = 320.0;
/// Least height of one that is narrow, or one of several.
const LOW_LEAST: f64 = 300.0;
/// Room at the left and the right of a column; more where the labels need it.
const LEFT: f64 = 70.0;
const RIGHT: f64 = 18.0;
/// Room between the edge of the picture and words.
const EDGE: f64 = 8.0;
/// Room between the name of the vertical axis and the labels of its ticks.
const GAP: f64 = 5.0;
/// Room below a panel.
const BOTTOM: f64 = 5.0;
/// Room above the title of a block.
const ABOVE: f64 = 12.0;

/// The picture.
pub struct PictureLayout<'a> {
    /// Width and height.
    pub size: (f64, f64),
    /// Lines of titles with the places where they begin.
    pub titles: Vec<(String, Pixel)>,
    /// The panels.
    pub panels: Vec<Placed<'a>>,
}

/// A panel with its place.
pub struct Placed<'a> {
    /// The panel.
    pub panel: &'a Panel,
    /// Its title and legend, which begin at the left of the frame and end above it.
    pub heading: Heading,
    /// The frame with its axes.
    pub frame: Frame,
    /// Names of the axes in lines.
    pub names: (Vec<String>, Vec<String>),
    /// Where the name of the vertical axis begins.
    pub left: f64,
}

/// Places all panels.
///
/// # Errors
/// [`crate::error::Error::Input`] for a panel that shows nothing.
pub fn page(blocks: &[Block]) -> Result<PictureLayout<'_>> {
    let most = blocks.iter().map(|block| block.columns.len()).max();
    let most = most.unwrap_or(0).max(1);
    let column = if most > 1 { NARROW } else { COLUMN };
    let mut page = PictureLayout {
        size: (column * most as f64, 0.0),
        titles: Vec::new(),
        panels: Vec::new(),
    };
    for block in blocks {
        page.add_title(&block.title)?;
        let rows = block.columns.iter().map(Vec::len).max().unwrap_or(0);
        let row = if most == 1 && rows <= 2 {
            HIGH_ROW
        } else {
            ROW
        };
        let least = if most > 1 || blocks.len() > 1 {
            LOW_LEAST
        } else {
            LEAST
        };
        // A block of fewer columns has wider ones.
        let width = page.size.0 / block.columns.len().max(1) as f64;
        page.add_columns(&block.columns, width, (row * rows as f64).max(least))?;
    }
    Ok(page)
}

impl<'a> PictureLayout<'a> {
    fn add_title(&mut self, title: &str) -> Result<()> {
        if title.is_empty() {
            return Ok(());
        }
        self.size.1 += ABOVE;
        for line in text::wrapped(title, TITLE, self.size.0 - 2.0 * EDGE) {
            let high = text::height(1, TITLE);
            let at = (EDGE, self.size.1 + 0.5 * high);
            self.titles.push((line, at));
            self.size.1 += high;
        }
        Ok(())
    }

    /// Panels in columns as wide as this; the height is that without what headings and names need beyond one line.
    fn add_columns(&mut self, columns: &'a [Vec<Panel>], width: f64, height: f64) -> Result<()> {
        let mut drafts = Vec::new();
        for (i, column) in columns.iter().enumerate() {
            let left = width * i as f64;
            drafts.push(PanelColumn::draft(column, left, width, height)?);
        }
        align(&mut drafts);
        let more = drafts.iter().map(|draft| draft.furniture() - draft.usual());
        let height = height + more.fold(0.0, f64::max);
        for draft in drafts {
            self.panels.extend(draft.place(self.size.1, height));
        }
        self.size.1 += height;
        Ok(())
    }
}

/// Headings at the top of a block are equally high, and so are those of panels side by side: the frames below begin there.
fn align(columns: &mut [PanelColumn<'_>]) {
    let strips: Vec<Vec<f64>> = columns
        .iter()
        .map(|column| column.panels.iter().map(|draft| draft.strip).collect())
        .collect();
    for column in columns {
        let panels = column.panels.len();
        for other in &strips {
            let beside = if other.len() == panels { panels } else { 1 };
            for (draft, strip) in column
                .panels
                .iter_mut()
                .zip(&other[..beside.min(other.len())])
            {
                draft.strip = draft.strip.max(*strip);
            }
        }
    }
}

/// A column of panels whose heights are not known yet.
struct PanelColumn<'a> {
    panels: Vec<Draft<'a>>,
    /// Ends of all the frames.
    x: (f64, f64),
    /// Where names of vertical axes begin.
    left: f64,
}

struct Draft<'a> {
    panel: &'a Panel,
    scales: (Scale, Scale),
    heading: Heading,
    /// Height of the heading.
    strip: f64,
    names: (Vec<String>, Vec<String>),
}

/// Height of a heading with one line, and of an axis whose name has one.
fn one_line() -> f64 {
    Heading::LEAST + frame::below(1) + BOTTOM
}

impl<'a> PanelColumn<'a> {
    fn draft(panels: &'a [Panel], left: f64, width: f64, height: f64) -> Result<Self> {
        let frame_height = (height / panels.len().max(1) as f64 - one_line()).min(width);
        let (mut inset, mut right) = (LEFT, RIGHT);
        let mut begun = Vec::new();
        for panel in panels {
            let (x, y) = scales(panel)?;
            let name = text::wrapped(&panel.y.label, TEXT, frame_height + Heading::LEAST);
            let ticks = frame::vertical(&y, frame_height, f64::INFINITY);
            inset = inset.max(before_labels(&name) + frame::widest(&ticks) + frame::AIR);
            let ticks = frame::horizontal(&x, width - LEFT - RIGHT);
            right = right.max(0.5 * frame::widest(&ticks) + EDGE);
            begun.push((panel, (x, y), name));
        }
        let frame_width = width - inset - right;
        let finish = |(panel, scales, y_name): (&'a Panel, _, _)| -> Result<Draft<'a>> {
            let heading = Heading::new(panel, frame_width + right - EDGE);
            let limit = frame_width + 2.0 * (right - EDGE);
            Ok(Draft {
                panel,
                scales,
                strip: heading.height(),
                heading,
                names: (text::wrapped(&panel.x.label, TEXT, limit), y_name),
            })
        };
        Ok(PanelColumn {
            panels: begun.into_iter().map(finish).collect::<Result<_>>()?,
            x: (left + inset, left + inset + frame_width),
            left,
        })
    }

    /// Height of all but the frames.
    fn furniture(&self) -> f64 {
        let each = self.panels.iter();
        each.map(|draft| draft.strip + draft.bottom()).sum()
    }

    /// What that would be with one line each.
    fn usual(&self) -> f64 {
        self.panels.len() as f64 * one_line()
    }

    /// The panels from `top` downwards. A frame is not higher than wide: phase planes are square.
    fn place(self, top: f64, height: f64) -> Vec<Placed<'a>> {
        let frames = (height - self.furniture()) / self.panels.len().max(1) as f64;
        let high = frames.min(self.x.1 - self.x.0);
        let mut top = top;
        let place = |draft: Draft<'a>| {
            top += draft.strip;
            let inside = Window {
                x: self.x,
                y: (top, top + high),
            };
            top += high + draft.bottom();
            let labels = self.x.0 - self.left - before_labels(&draft.names.1) - frame::AIR;
            // The widest label may be just as wide, up to rounding.
            let labels = labels + 0.1;
            let named = (!draft.names.0.is_empty(), !draft.names.1.is_empty());
            Placed {
                panel: draft.panel,
                heading: draft.heading,
                frame: Frame::new(inside, draft.scales, named, labels),
                names: draft.names,
                left: self.left + EDGE,
            }
        };
        self.panels.into_iter().map(place).collect()
    }
}

impl Draft<'_> {
    /// Height of what is below the frame.
    fn bottom(&self) -> f64 {
        frame::below(self.names.0.len().max(1)) + BOTTOM
    }
}

/// What the name of the vertical axis takes of the room beside the frame.
fn before_labels(name: &[String]) -> f64 {
    EDGE + text::height(name.len(), TEXT) + GAP
}
