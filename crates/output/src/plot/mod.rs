//! Pictures: panels of curves and maps, as SVG or PNG. A PNG is the SVG rendered with a font that is built in, so it looks the same on
//! a machine without fonts.

mod areas;
mod bands;
mod canvas;
mod cells;
mod clip;
mod curves;
mod describe;
mod draw;
mod frame;
mod layout;
mod legend;
mod marks;
mod names;
mod panel;
mod reach;
mod scale;
mod smooth;
mod strokes;
mod symbols;
mod text;
mod thin;
mod ticks;

pub use panel::{
    Area, Axis, Bars, Block, Cells, Key, Mark, Note, Panel, PlotSeries, Shade, Side, Stroke,
    Swatch, Symbol,
};

use crate::error::{Error, Result};
use crate::write_whole;
use canvas::Words;
use resvg::{tiny_skia, usvg};
use std::path::Path;

/// DejaVu Sans, reduced to what labels need.
static FONT: &[u8] = include_bytes!("../../../../assets/font/plot.ttf");
/// Pixels of a PNG per unit of the SVG.
const PNG_ZOOM: f32 = 2.0;

/// Which kind of picture a file name asks for.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum PictureFormat {
    /// Vector graphics.
    Svg,
    /// Pixels.
    Png,
}

impl PictureFormat {
    /// By the extension.
    ///
    /// # Errors
    /// [`Error::Input`] for any other than svg and png.
    pub fn of(path: &Path) -> Result<Self> {
        let ending = path.extension().map(|e| e.to_string_lossy().to_lowercase());
        match ending.as_deref() {
            Some("svg") => Ok(PictureFormat::Svg),
            Some("png") => Ok(PictureFormat::Png),
            _ => Err(Error::Input(format!(
                "`plot` {}: the name must end in .svg or .png",
                path.display()
            ))),
        }
    }
}

/// A picture: blocks of panels, one below the other.
#[derive(Debug, Clone, PartialEq)]
pub struct Drawing {
    blocks: Vec<Block>,
}

impl Drawing {
    /// One block without a title: columns from left to right, each from top to bottom.
    pub fn columns(columns: Vec<Vec<Panel>>) -> Self {
        let title = String::new();
        Drawing::blocks(vec![Block { title, columns }])
    }

    /// Blocks from top to bottom.
    pub fn blocks(blocks: Vec<Block>) -> Self {
        Drawing { blocks }
    }

    /// The panels, block by block, each column by column from its top.
    pub fn panels_mut(&mut self) -> impl Iterator<Item = &mut Panel> {
        let columns = self.blocks.iter_mut().flat_map(|block| &mut block.columns);
        columns.flatten()
    }

    /// The picture as SVG.
    ///
    /// # Errors
    /// [`Error::Input`] if there is nothing that can be drawn.
    pub fn svg(&self) -> Result<String> {
        draw::svg(&self.blocks, Words::Text)
    }

    /// The picture as an object, from which another program draws the same one with its own means: all ranges, colours, breadths,
    /// curves and places of names are decided in it.
    ///
    /// - `size`: width and height in pixels, to which all lengths below refer; letters are 13 high.
    /// - `blocks`, from top to bottom, each with its `title` and `columns` of panels from left to right.
    ///
    /// A panel has `title`, `frame` (width and height), the axes `x` and `y` (`label`, `log`, `range`), `zero_line`, and
    /// - `cells`: null, or a map (`x_edges`, `y_edges`, `fills` with a list of colours for each cell, the lowest row first, and `swatches`
    ///   with `colours` and `label`), behind
    /// - `areas`: `label`, `colour`, `opacity` and `pieces`, each the `x` and the `y` of its corners,
    /// - `series`: `label`, `x`, `y` (null where a curve breaks), `dots` or a line, `stroke`, `width` (of dots the radius) and `colour`,
    /// - `marks`: `x`, `y`, `label` with the `offset` of its middle to the right and downwards, `symbol`, `filled`, `colour` and `behind`,
    ///   with `bars` (`x` and `y`, the ends of each, or null),
    /// - `notes`: `x`, `y`, `text`, `offset` and `colour`, and more of the legend:
    /// - `strokes` (`stroke`, `label`) and `keys` (`symbol`, `filled`, `colour`, `label`).
    ///
    /// # Errors
    /// As [`Drawing::svg`].
    pub fn describe(&self) -> Result<serde_json::Value> {
        describe::described(&self.blocks)
    }

    /// The picture as PNG.
    ///
    /// # Errors
    /// As [`Drawing::svg`].
    pub fn png(&self) -> Result<Vec<u8>> {
        // With outlines for words: no font is asked for.
        let svg = draw::svg(&self.blocks, Words::Outlines)?;
        let tree = usvg::Tree::from_str(&svg, &usvg::Options::default()).map_err(unrendered)?;
        let size = tree.size().to_int_size();
        let zoomed = |x: u32| (x as f32 * PNG_ZOOM) as u32;
        let mut pixels = tiny_skia::Pixmap::new(zoomed(size.width()), zoomed(size.height()))
            .ok_or_else(|| unrendered("it has no area"))?;
        let zoom = tiny_skia::Transform::from_scale(PNG_ZOOM, PNG_ZOOM);
        resvg::render(&tree, zoom, &mut pixels.as_mut());
        pixels.encode_png().map_err(unrendered)
    }
}

/// Draws into a file, which appears complete or not at all.
///
/// # Errors
/// [`Error::Input`] for an extension that is none of ours or nothing to draw; [`Error::File`] if the file can't be written.
pub fn write(path: &Path, drawing: &Drawing) -> Result<()> {
    let bytes = match PictureFormat::of(path)? {
        PictureFormat::Svg => drawing.svg()?.into_bytes(),
        PictureFormat::Png => drawing.png()?,
    };
    write_whole(path, &bytes).map_err(|error| Error::File {
        action: "write",
        path: path.to_owned(),
        reason: error.to_string(),
    })
}

fn unrendered(reason: impl ToString) -> Error {
    Error::Input(format!(
        "the picture can't be drawn: {}",
        reason.to_string()
    ))
}
