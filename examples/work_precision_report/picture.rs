//! Work-precision diagrams: panels of points joined by lines, both axes logarithmic, with one legend for all.

use crate::common::results::{Row, distinct, time_text};
use plotters::coord::Shift;
use plotters::prelude::*;
use plotters::style::text_anchor::{HPos, Pos, VPos};
use resvg::{tiny_skia, usvg};
use std::error::Error;
use std::sync::Arc;

type Answer<T> = Result<T, Box<dyn Error>>;
type Canvas<'a> = DrawingArea<SVGBackend<'a>, Shift>;

/// plotters counts whole pixels: drawn this much larger and shown at normal size, marks sit where they belong.
const FINE: f64 = 10.0;
/// A panel, its frame within it, and the strip with title and legend above all.
const PANEL: (f64, f64) = (400.0, 330.0);
const FRAME: [f64; 4] = [62.0, 34.0, 388.0, 282.0];
const STRIP: f64 = 66.0;
const COLUMNS: usize = 3;
const TEXT: f64 = 13.0;
/// Decades of errors.
const ERRORS: (f64, f64) = (-16.0, 0.0);
/// From this error on no digit is right: such points are not drawn.
const WRONG: f64 = 0.5;

const FAMILY: &str = "DejaVu Sans, Verdana, Arial, sans-serif";
static FONT: &[u8] = include_bytes!("../../assets/font/plot.ttf");
const INK: RGBColor = RGBColor(40, 40, 40);
const GRID: RGBColor = RGBColor(224, 224, 224);

/// The mark of a point.
#[derive(Clone, Copy, PartialEq)]
enum Mark {
    Disc,
    Ring,
    Polygon(usize),
    Square,
}

/// Colour (Okabe and Ito) and mark of each method; `auto` is a ring around whatever it chose.
const LOOKS: [(&str, RGBColor, Mark); 7] = [
    ("taylor", RGBColor(213, 94, 0), Mark::Disc),
    ("rodas5p", RGBColor(0, 114, 178), Mark::Polygon(4)),
    ("rodas4", RGBColor(86, 180, 233), Mark::Polygon(3)),
    ("rosenbrock23", RGBColor(0, 158, 115), Mark::Polygon(5)),
    ("cvode-bdf", RGBColor(230, 159, 0), Mark::Polygon(6)),
    ("cvode-adams", RGBColor(204, 121, 167), Mark::Square),
    ("auto", RGBColor(0, 0, 0), Mark::Ring),
];

fn look(method: &str) -> (RGBColor, Mark) {
    LOOKS
        .iter()
        .find(|(name, ..)| *name == method)
        .map_or((INK, Mark::Disc), |&(_, colour, mark)| (colour, mark))
}

fn px(x: f64) -> i32 {
    (x * FINE).round() as i32
}

fn text(
    canvas: &Canvas<'_>,
    words: &str,
    at: (f64, f64),
    anchor: (HPos, VPos),
    colour: RGBColor,
) -> Answer<()> {
    let style = (FAMILY, TEXT * FINE).into_font().color(&colour);
    let style = style.pos(Pos::new(anchor.0, anchor.1));
    canvas.draw(&Text::new(words.to_owned(), (px(at.0), px(at.1)), style))?;
    Ok(())
}

fn line(canvas: &Canvas<'_>, points: &[(f64, f64)], colour: RGBColor, width: f64) -> Answer<()> {
    let points: Vec<(i32, i32)> = points.iter().map(|p| (px(p.0), px(p.1))).collect();
    let style = colour.stroke_width(px(width) as u32);
    canvas.draw(&PathElement::new(points, style))?;
    Ok(())
}

fn mark(canvas: &Canvas<'_>, (x, y): (f64, f64), (colour, mark): (RGBColor, Mark)) -> Answer<()> {
    let (corners, first) = match mark {
        Mark::Disc => {
            canvas.draw(&Circle::new((px(x), px(y)), px(3.6), colour.filled()))?;
            return Ok(());
        }
        Mark::Ring => {
            let style = colour.stroke_width(px(1.2) as u32);
            canvas.draw(&Circle::new((px(x), px(y)), px(5.6), style))?;
            return Ok(());
        }
        Mark::Polygon(corners) => (corners, 0.0),
        Mark::Square => (4, 0.5),
    };
    let corner = |i: usize| {
        let turn = (i as f64 + first) / corners as f64 * std::f64::consts::TAU;
        (px(x + 4.3 * turn.sin()), px(y - 4.3 * turn.cos()))
    };
    let points: Vec<(i32, i32)> = (0..corners).map(corner).collect();
    canvas.draw(&Polygon::new(points, colour.filled()))?;
    Ok(())
}

/// The picture of all scenes.
pub fn svg(title: &str, titles: &[(String, String)], rows: &[Row]) -> Answer<String> {
    plotters::style::register_font(FAMILY, FontStyle::Normal, FONT)
        .map_err(|_| "the built-in font is damaged")?;
    let columns = titles.len().min(COLUMNS);
    let lines = titles.len().div_ceil(columns);
    let size = (
        PANEL.0 * columns.max(2) as f64,
        STRIP + PANEL.1 * lines as f64,
    );
    let known = distinct(rows, |row| &row.method);
    let mut methods: Vec<&str> = LOOKS.iter().map(|look| look.0).collect();
    methods.retain(|name| known.iter().any(|method| method == name));
    let decades = decades(rows);
    let mut picture = String::new();
    {
        let fine = (px(size.0) as u32, px(size.1) as u32);
        let canvas = SVGBackend::with_string(&mut picture, fine).into_drawing_area();
        canvas.fill(&WHITE)?;
        let left = (HPos::Left, VPos::Center);
        text(&canvas, title, (FRAME[0], 20.0), left, INK)?;
        for (i, method) in methods.iter().enumerate() {
            let colour = look(method).0;
            let x = FRAME[0] + 112.0 * i as f64;
            line(&canvas, &[(x, 46.0), (x + 20.0, 46.0)], colour, 1.4)?;
            mark(&canvas, (x + 10.0, 46.0), look(method))?;
            text(&canvas, method, (x + 26.0, 46.0), left, INK)?;
        }
        for (i, (scene, title)) in titles.iter().enumerate() {
            let origin = (
                PANEL.0 * (i % columns) as f64,
                STRIP + PANEL.1 * (i / columns) as f64,
            );
            let here: Vec<&Row> = rows.iter().filter(|row| row.scene == *scene).collect();
            panel(&canvas, origin, title, decades, &methods, &here)?;
        }
        canvas.present()?;
    }
    let fine = format!(r#"width="{}" height="{}""#, px(size.0), px(size.1));
    let shown = format!(r#"width="{}" height="{}""#, size.0, size.1);
    Ok(picture.replacen(&fine, &shown, 1))
}

/// (error, time) of a row that is drawn.
fn drawn(row: &Row) -> Option<(f64, f64)> {
    row.point().filter(|&(error, _)| error < WRONG)
}

/// Powers of ten around all times: the same for all panels, so that scenes can be compared.
fn decades(rows: &[Row]) -> (f64, f64) {
    let times = || rows.iter().filter_map(drawn).map(|point| point.1.log10());
    let (lo, hi) = (
        times().fold(f64::INFINITY, f64::min),
        times().fold(f64::NEG_INFINITY, f64::max),
    );
    (lo.floor(), hi.ceil())
}

fn panel(
    canvas: &Canvas<'_>,
    origin: (f64, f64),
    title: &str,
    decades: (f64, f64),
    methods: &[&str],
    rows: &[&Row],
) -> Answer<()> {
    let [x0, y0, x1, y1] = FRAME;
    let (x0, x1) = (origin.0 + x0, origin.0 + x1);
    let (y0, y1) = (origin.1 + y0, origin.1 + y1);
    let x = |time: f64| x0 + (time - decades.0) / (decades.1 - decades.0) * (x1 - x0);
    let y = |error: f64| y1 - (error - ERRORS.0) / (ERRORS.1 - ERRORS.0) * (y1 - y0);
    text(
        canvas,
        title,
        (x0, y0 - 12.0),
        (HPos::Left, VPos::Center),
        INK,
    )?;
    for time in decades.0 as i32..=decades.1 as i32 {
        let at = x(f64::from(time));
        line(canvas, &[(at, y0), (at, y1)], GRID, 0.8)?;
        let label = time_text(10_f64.powi(time))
            .replace(".00", "")
            .replace(".0", "");
        text(
            canvas,
            &label,
            (at, y1 + 6.0),
            (HPos::Center, VPos::Top),
            INK,
        )?;
    }
    for error in ERRORS.0 as i32..=ERRORS.1 as i32 {
        let at = y(f64::from(error));
        line(canvas, &[(x0, at), (x1, at)], GRID, 0.8)?;
        if error % 4 == 0 {
            let label = format!("1e{error}").replace("1e0", "1");
            text(
                canvas,
                &label,
                (x0 - 6.0, at),
                (HPos::Right, VPos::Center),
                INK,
            )?;
        }
    }
    let frame = [(x0, y0), (x1, y0), (x1, y1), (x0, y1), (x0, y0)];
    line(canvas, &frame, INK, 0.9)?;
    let middle = 0.5 * (x0 + x1);
    text(
        canvas,
        "CPU time of a run",
        (middle, y1 + 24.0),
        (HPos::Center, VPos::Top),
        INK,
    )?;
    let style = (FAMILY, TEXT * FINE)
        .into_font()
        .transform(FontTransform::Rotate270)
        .color(&INK)
        .pos(Pos::new(HPos::Center, VPos::Top));
    let at = (px(origin.0 + 6.0), px(0.5 * (y0 + y1)));
    canvas.draw(&Text::new("largest relative error", at, style))?;
    for method in methods {
        let points: Vec<(f64, f64)> = rows
            .iter()
            .filter(|row| row.method == *method)
            .filter_map(|row| drawn(row))
            .map(|(error, time)| (x(time.log10()), y(error.log10().max(ERRORS.0))))
            .collect();
        let (colour, shape) = look(method);
        // What auto chose has a line of its own already.
        if shape != Mark::Ring {
            line(canvas, &points, colour, 1.4)?;
        }
        for &point in &points {
            mark(canvas, point, (colour, shape))?;
        }
    }
    Ok(())
}

/// Pixels, two to a unit.
pub fn png(svg: &str) -> Answer<Vec<u8>> {
    let mut fonts = usvg::fontdb::Database::new();
    fonts.load_font_data(FONT.to_vec());
    let family = fonts.faces().next().and_then(|face| face.families.first());
    let family = family.map_or_else(String::new, |(name, _)| name.clone());
    // None of the names in the SVG is known here, and the last of them, sans-serif, is ours.
    fonts.set_sans_serif_family(family);
    let options = usvg::Options {
        fontdb: Arc::new(fonts),
        ..usvg::Options::default()
    };
    let tree = usvg::Tree::from_str(svg, &options)?;
    let size = tree.size().to_int_size();
    let mut pixels = tiny_skia::Pixmap::new(2 * size.width(), 2 * size.height())
        .ok_or("the picture has no area")?;
    let zoom = tiny_skia::Transform::from_scale(2.0, 2.0);
    resvg::render(&tree, zoom, &mut pixels.as_mut());
    Ok(pixels.encode_png()?)
}
