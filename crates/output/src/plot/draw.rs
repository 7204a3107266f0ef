//! Draws all panels, each from what lies behind to what lies before.

use super::areas::areas;
use super::canvas::{Align, Canvas, INK, Words, picture};
use super::cells::cells;
use super::curves::curves;
use super::layout::{Placed, page};
use super::marks::{behind, marks, notes, write};
use super::text::TITLE;
use super::{Block, unrendered};
use crate::error::Result;

/// The picture as SVG.
///
/// # Errors
/// [`crate::error::Error::Input`] if there is nothing that can be drawn.
pub fn svg(blocks: &[Block], words: Words) -> Result<String> {
    let page = page(blocks)?;
    if page.panels.is_empty() {
        return Err(unrendered("there are no panels"));
    }
    Ok(picture(page.size, words, |canvas| {
        for (line, at) in &page.titles {
            canvas.words(line, *at, Align::Left, TITLE, INK);
        }
        page.panels.iter().for_each(|placed| draw(canvas, placed));
    }))
}

fn draw(canvas: &Canvas, placed: &Placed<'_>) {
    let (panel, frame) = (placed.panel, &placed.frame);
    let corner = (frame.inside().x.0, frame.inside().y.0);
    placed.heading.draw(canvas, corner);
    frame.draw_names(canvas, (&placed.names.0, &placed.names.1), placed.left);
    frame.draw_grid(canvas, panel.zero_line);
    if let Some(map) = &panel.cells {
        cells(canvas, map, frame);
    }
    areas(canvas, panel, frame);
    behind(canvas, panel, frame);
    let seen = curves(canvas, panel, frame);
    let notes = notes(panel, frame, &seen);
    write(canvas, frame, &notes);
    marks(canvas, panel, frame, &seen, &notes);
    // Last, as the white edges of symbols would cover it.
    frame.draw_border(canvas);
}
