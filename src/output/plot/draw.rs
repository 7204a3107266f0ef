//! Panels on a plotters canvas.

use super::marks::marks;
use super::scale::Scale;
use super::thin::thinned;
use super::{Block, FAMILY, FONT, Panel, Series, Side, Stroke, names, unrendered};
use crate::error::Result;
use plotters::coord::Shift;
use plotters::coord::cartesian::Cartesian2d;
use plotters::coord::ranged1d::{KeyPointHint, NoDefaultFormatting, Ranged, ValueFormatter};
use plotters::prelude::*;
use plotters::style::text_anchor::{HPos, Pos, VPos};

/// plotters counts whole pixels: drawn this much larger and shown at normal size, curves are smooth.
pub const FINE: f64 = 10.0;
/// plotters takes text to be wider than it is drawn, by 1.24; some of that is left for other fonts.
const WIDER: f64 = 1.15;
/// Width of one column of panels.
const COLUMN: f64 = 560.0;
/// Height of the picture per panel of the highest column.
const ROW: f64 = 235.0;
/// Least height of the picture.
const LEAST: f64 = 470.0;
/// Height of the strip with title and legend.
const STRIP: f64 = 26.0;
const LEFT_MARGIN: f64 = 10.0;
const LEFT_LABELS: f64 = 74.0;
const BOTTOM_LABELS: f64 = 44.0;
pub const TEXT: f64 = 15.0;
const LINE: f64 = 1.1;
const WIDE: f64 = 1.9;
/// Radius of a point.
const DOT: f64 = 1.9;
/// Room between the curves and the frame, as a part of the range.
const MARGIN: f64 = 0.04;
/// The same where points have names.
const MARKED_MARGIN: f64 = 0.26;
/// The same where the names stand where there is room.
const FREE_MARGIN: f64 = 0.1;
/// Dashes and the gaps between.
const DASH: f64 = 6.0;
const GAP: f64 = 3.5;
/// Distance of the points along curves that names avoid.
const SAMPLES: f64 = 2.5;
/// Okabe and Ito: told apart by all.
const COLOURS: [RGBColor; 8] = [
    RGBColor(0, 114, 178),
    RGBColor(213, 94, 0),
    RGBColor(0, 158, 115),
    RGBColor(204, 121, 167),
    RGBColor(86, 180, 233),
    RGBColor(230, 159, 0),
    RGBColor(125, 125, 125),
    RGBColor(0, 0, 0),
];
pub const INK: RGBColor = RGBColor(40, 40, 40);
const GRID: RGBColor = RGBColor(228, 228, 228);

type Canvas<'a> = DrawingArea<SVGBackend<'a>, Shift>;

pub fn px(x: f64) -> i32 {
    (x * FINE).round() as i32
}

pub fn font(size: f64, colour: RGBColor) -> TextStyle<'static> {
    // The backend divides by 1.24 what plotters calls the size.
    (FAMILY, size * FINE).into_font().color(&colour)
}

pub fn svg(blocks: &[Block]) -> Result<String> {
    let columns: Vec<Vec<Panel>> = blocks
        .iter()
        .flat_map(|block| block.columns.clone())
        .collect();
    // Registering again the same font under the same name changes nothing.
    plotters::style::register_font(FAMILY, FontStyle::Normal, FONT)
        .map_err(|_| unrendered("the built-in font is damaged"))?;
    let rows = columns.iter().map(Vec::len).max().unwrap_or(0);
    let size = (
        COLUMN * columns.len() as f64,
        (ROW * rows as f64).max(LEAST),
    );
    let mut text = String::new();
    {
        let root = SVGBackend::with_string(&mut text, (px(size.0) as u32, px(size.1) as u32))
            .into_drawing_area();
        root.fill(&WHITE).map_err(unrendered)?;
        for (area, panels) in root.split_evenly((1, columns.len())).iter().zip(&columns) {
            for (area, panel) in area.split_evenly((panels.len(), 1)).iter().zip(panels) {
                draw(area, panel)?;
            }
        }
        root.present().map_err(unrendered)?;
    }
    let fine = format!(r#"width="{}" height="{}""#, px(size.0), px(size.1));
    let shown = format!(r#"width="{}" height="{}""#, size.0, size.1);
    Ok(text.replacen(&fine, &shown, 1))
}

fn draw(area: &Canvas<'_>, panel: &Panel) -> Result<()> {
    let xs = panel.series.iter().flat_map(|series| &series.x);
    let ys = panel.series.iter().flat_map(|series| &series.y);
    let zero = [0.0];
    let zero = zero.iter().filter(|_| panel.zero_line);
    // A function of time ends with its data; a phase plane needs air around it, and so do names above and below.
    let tight = panel
        .series
        .iter()
        .all(|series| !series.dots && series.x.is_sorted());
    let margin = match panel.marks.first().map(|mark| mark.side) {
        None => MARGIN,
        Some(Side::Free) => FREE_MARGIN,
        Some(_) => MARKED_MARGIN,
    };
    let scales = (
        Scale::new(&panel.x, xs, if tight { 0.0 } else { MARGIN }),
        Scale::new(&panel.y, ys.chain(zero), margin),
    );
    let (Some(x), Some(y)) = scales else {
        return Err(unrendered(format!(
            "there is no point for the panel {:?}",
            panel.title
        )));
    };
    let (strip, frame) = area.split_vertically(px(STRIP));
    heading(&strip, panel)?;
    let mut chart = ChartBuilder::on(&frame)
        .margin_left(px(LEFT_MARGIN))
        .margin_right(px(22.0))
        .margin_bottom(px(6.0))
        .x_label_area_size(px(BOTTOM_LABELS))
        .y_label_area_size(px(LEFT_LABELS))
        .build_cartesian_2d(Ticked(&x), Ticked(&y))
        .map_err(unrendered)?;
    chart
        .configure_mesh()
        .x_desc(panel.x.label.as_str())
        .y_desc(panel.y.label.as_str())
        .x_labels(x.ticks.len())
        .y_labels(y.ticks.len())
        .x_label_formatter(&|tick| x.label(*tick))
        .y_label_formatter(&|tick| y.label(*tick))
        .label_style(font(TEXT, INK))
        .axis_desc_style(font(TEXT, INK))
        .axis_style(INK.stroke_width(px(0.9) as u32))
        .bold_line_style(GRID.stroke_width(px(0.8) as u32))
        .light_line_style(TRANSPARENT)
        .set_all_tick_mark_size(px(4.0))
        .draw()
        .map_err(unrendered)?;
    if panel.zero_line {
        let line = [(x.lo, 0.0), (x.hi, 0.0)];
        chart
            .draw_series(LineSeries::new(line, INK.stroke_width(px(0.7) as u32)))
            .map_err(unrendered)?;
    }
    let area = chart.plotting_area();
    let seen = curves(area, panel, (&x, &y))?;
    marks(area, panel, (&x, &y), &seen)
}

/// The frame's inside, with our axes.
pub type Inside<'a, 'b> = DrawingArea<SVGBackend<'a>, Cartesian2d<Ticked<'b>, Ticked<'b>>>;

/// Draws the curves and gives points along them in pixels of the frame.
fn curves(
    area: &Inside<'_, '_>,
    panel: &Panel,
    (x, y): (&Scale, &Scale),
) -> Result<Vec<names::Pixel>> {
    let (width, height) = area.dim_in_pixel();
    let per_pixel = (
        (x.hi - x.lo) / (f64::from(width) / FINE),
        (y.hi - y.lo) / (f64::from(height) / FINE),
    );
    let mut seen = Vec::new();
    for (i, series) in panel.series.iter().enumerate() {
        // The curve below is wider where another one follows, so that both are seen where they coincide.
        let width = if i + 1 < panel.series.len() || series.colour.is_some() {
            WIDE
        } else {
            LINE
        };
        let points = series
            .x
            .iter()
            .zip(&series.y)
            .map(|(&a, &b)| (x.at(a), y.at(b)));
        if series.dots {
            let shown = points.filter(|(a, b)| a.is_finite() && b.is_finite());
            let dots = shown.map(|at| Circle::new(at, px(DOT), colour(series, i).filled()));
            dots.into_iter()
                .try_for_each(|dot| area.draw(&dot))
                .map_err(unrendered)?;
            continue;
        }
        let style = colour(series, i).stroke_width(px(width) as u32);
        for piece in thinned(points, per_pixel, series.x.is_sorted()) {
            let pixels =
                |&(a, b): &(f64, f64)| ((a - x.lo) / per_pixel.0, (y.hi - b) / per_pixel.1);
            let piece_in_pixels: Vec<names::Pixel> = piece.iter().map(pixels).collect();
            seen.extend(names::along(&piece_in_pixels, SAMPLES));
            if series.stroke != Stroke::Solid {
                let dashes = DashedLineSeries::new(piece, px(DASH), px(GAP), style);
                dashes.into_iter().try_for_each(|dash| area.draw(&dash))
            } else {
                let line = LineSeries::new(piece, style);
                line.into_iter().try_for_each(|line| area.draw(&line))
            }
            .map_err(unrendered)?;
        }
    }
    Ok(seen)
}

fn colour(series: &Series, number: usize) -> RGBColor {
    COLOURS[series.colour.unwrap_or(number) % COLOURS.len()]
}

/// An axis of plotters with our ticks.
pub struct Ticked<'a>(&'a Scale);

impl Ranged for Ticked<'_> {
    type FormatOption = NoDefaultFormatting;
    type ValueType = f64;

    fn map(&self, value: &f64, limit: (i32, i32)) -> i32 {
        let part = (value - self.0.lo) / (self.0.hi - self.0.lo);
        limit.0 + (part * f64::from(limit.1 - limit.0)).round() as i32
    }

    fn key_points<H: KeyPointHint>(&self, _: H) -> Vec<f64> {
        self.0.ticks.clone()
    }

    fn range(&self) -> std::ops::Range<f64> {
        self.0.lo..self.0.hi
    }
}

impl ValueFormatter<f64> for Ticked<'_> {
    fn format(tick: &f64) -> String {
        tick.to_string()
    }
}

/// The title, and beside it the legend, both outside of the frame: nothing covers the curves.
fn heading(strip: &Canvas<'_>, panel: &Panel) -> Result<()> {
    let middle = px(0.62 * STRIP);
    let centred = |style: TextStyle<'static>| style.pos(Pos::new(HPos::Left, VPos::Center));
    let title = centred(font(TEXT, INK));
    let mut left = px(LEFT_MARGIN + LEFT_LABELS);
    strip
        .draw(&Text::new(
            panel.title.clone(),
            (left, middle),
            title.clone(),
        ))
        .map_err(unrendered)?;
    left += width(strip, &panel.title, &title)? + px(28.0);
    for (i, series) in panel.series.iter().enumerate() {
        if series.label.is_empty() {
            continue;
        }
        let colour = colour(series, i);
        let style = colour.stroke_width(px(2.2) as u32);
        let ends: &[(f64, f64)] = if series.stroke != Stroke::Solid {
            &[(0.0, 6.0), (9.0, 15.0), (18.0, 24.0)]
        } else {
            &[(0.0, 22.0)]
        };
        for (from, to) in ends {
            let line = vec![(left + px(*from), middle), (left + px(*to), middle)];
            strip
                .draw(&PathElement::new(line, style))
                .map_err(unrendered)?;
        }
        left += px(28.0);
        let style = centred(font(TEXT, colour));
        strip
            .draw(&Text::new(
                series.label.clone(),
                (left, middle),
                style.clone(),
            ))
            .map_err(unrendered)?;
        left += width(strip, &series.label, &style)? + px(18.0);
    }
    Ok(())
}

fn width(strip: &Canvas<'_>, text: &str, style: &TextStyle<'static>) -> Result<i32> {
    strip
        .estimate_text_size(text, style)
        .map(|(width, _)| (f64::from(width) / WIDER) as i32)
        .map_err(unrendered)
}
