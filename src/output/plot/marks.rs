//! The points that are pointed out.

use super::draw::{FINE, INK, Inside, TEXT, font, px};
use super::scale::Scale;
use super::{Mark, Panel, names, unrendered};
use crate::error::Result;
use plotters::prelude::*;
use plotters::style::text_anchor::{HPos, Pos, VPos};

/// Radius of a point that is pointed out.
const RADIUS: f64 = 3.4;
/// Room between a name and its neighbours.
const AIR: f64 = 4.0;
/// A name that begins farther than this from its point is tied to it.
const TIED: f64 = 12.0;
/// Points that are pointed out, and their names.
const MARK: RGBColor = RGBColor(150, 30, 30);

/// Draws the points that are pointed out, with their names where there is room.
pub fn marks(
    area: &Inside<'_, '_>,
    panel: &Panel,
    (x, y): (&Scale, &Scale),
    curves: &[names::Pixel],
) -> Result<()> {
    let (width, height) = area.dim_in_pixel();
    let frame = (f64::from(width) / FINE, f64::from(height) / FINE);
    let style = font(TEXT, INK);
    let shown: Vec<&Mark> = panel
        .marks
        .iter()
        .filter(|mark| x.at(mark.x).is_finite() && y.at(mark.y).is_finite())
        .collect();
    let mut named = Vec::new();
    for mark in &shown {
        let (wide, high) = area
            .estimate_text_size(&mark.label, &style)
            .map_err(unrendered)?;
        named.push(names::Named {
            at: (
                (x.at(mark.x) - x.lo) / (x.hi - x.lo) * frame.0,
                (y.hi - y.at(mark.y)) / (y.hi - y.lo) * frame.1,
            ),
            size: (f64::from(wide) / FINE + AIR, f64::from(high) / FINE + AIR),
            side: mark.side,
        });
    }
    for ((mark, name), centre) in shown
        .iter()
        .zip(&named)
        .zip(names::placed(&named, curves, frame))
    {
        let at = (x.at(mark.x), y.at(mark.y));
        let off = (centre.0 - name.at.0, centre.1 - name.at.1);
        let middle = (px(off.0), px(off.1));
        area.draw(&Circle::new(at, px(RADIUS), MARK.filled()))
            .map_err(unrendered)?;
        if mark.label.is_empty() {
            continue;
        }
        // A name that stands far off is tied to its point, up to its edge.
        let edge = names::edge(off, name.size);
        if edge.0.hypot(edge.1) > TIED {
            let tie = PathElement::new(
                vec![(0, 0), (px(edge.0), px(edge.1))],
                MARK.mix(0.5).stroke_width(px(0.7) as u32),
            );
            area.draw(&(EmptyElement::at(at) + tie))
                .map_err(unrendered)?;
        }
        let text = font(TEXT, MARK).pos(Pos::new(HPos::Center, VPos::Center));
        area.draw(&(EmptyElement::at(at) + Text::new(mark.label.clone(), middle, text)))
            .map_err(unrendered)?;
    }
    Ok(())
}
