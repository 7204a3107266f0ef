//! A picture as plain values, from which another program draws the same one: see [`super::Drawing::describe`].

use super::areas::{OPACITY, pieces};
use super::canvas::{Colour, INK, MARK, Pixel, Words, colour, picture};
use super::cells::tint;
use super::curves::{curves, drawn_widths, series_colour, through};
use super::frame::Frame;
use super::layout::{Placed, page};
use super::marks::{self, Written};
use super::scale::Scale;
use super::{Area, Axis, Block, Cells, Panel, PlotSeries, Stroke, Symbol, unrendered};
use crate::error::Result;
use serde_json::{Value, json};

/// The picture as an object.
///
/// # Errors
/// [`crate::error::Error::Input`] if there is nothing that can be drawn.
pub fn described(blocks: &[Block]) -> Result<Value> {
    let page = page(blocks)?;
    if page.panels.is_empty() {
        return Err(unrendered("there are no panels"));
    }
    // They come block by block, each column by column.
    let mut placed = page.panels.iter();
    let mut block = |block: &Block| {
        let column = |column: &Vec<Panel>| -> Vec<Value> {
            placed.by_ref().take(column.len()).map(panel).collect()
        };
        let columns: Vec<Vec<Value>> = block.columns.iter().map(column).collect();
        json!({ "title": block.title, "columns": columns })
    };
    let blocks: Vec<Value> = blocks.iter().map(&mut block).collect();
    Ok(json!({ "size": [page.size.0, page.size.1], "blocks": blocks }))
}

fn panel(placed: &Placed<'_>) -> Value {
    let (panel, frame) = (placed.panel, &placed.frame);
    // Names keep off the curves: where these go is known when they are drawn.
    let mut seen = Vec::new();
    picture((0.0, 0.0), Words::Text, |canvas| {
        seen = curves(canvas, panel, frame);
    });
    let written = marks::notes(panel, frame, &seen);
    let (inside, (x, y)) = (frame.inside(), frame.scales());
    let (numbered, widths) = (panel.series.iter().enumerate(), drawn_widths(panel, frame));
    json!({
        "title": panel.title,
        "frame": [inside.x.1 - inside.x.0, inside.y.1 - inside.y.0],
        "x": axis(&panel.x, x),
        "y": axis(&panel.y, y),
        "zero_line": panel.zero_line,
        "cells": panel.cells.as_ref().map(cells),
        "areas": panel.areas.iter().map(|area| areas(area, frame)).collect::<Vec<_>>(),
        "series": numbered.map(|(i, one)| series((i, one), widths[i], frame)).collect::<Vec<_>>(),
        "marks": named_marks(panel, frame, &seen, &written),
        "notes": notes(frame, &written),
        "strokes": panel.strokes.iter().map(|(broken, label)| json!({
            "stroke": stroke(*broken),
            "label": label,
        })).collect::<Vec<_>>(),
        "keys": panel.keys.iter().map(|key| json!({
            "symbol": symbol(key.symbol),
            "filled": key.filled,
            "colour": told(key.colour.map_or(MARK, colour)),
            "label": key.label,
        })).collect::<Vec<_>>(),
    })
}

fn axis(axis: &Axis, scale: &Scale) -> Value {
    json!({
        "label": axis.label,
        "log": axis.log,
        "range": [scale.value(scale.lo), scale.value(scale.hi)],
    })
}

fn cells(map: &Cells) -> Value {
    let colours = |shades: &[super::Shade]| -> Vec<String> {
        shades.iter().map(|&shade| told(tint(shade))).collect()
    };
    let fills = map.fills.iter().map(|fill| colours(fill));
    let swatches = map.swatches.iter();
    json!({
        "x_edges": map.x_edges,
        "y_edges": map.y_edges,
        "fills": fills.collect::<Vec<_>>(),
        "swatches": swatches.map(|swatch| json!({
            "colours": colours(&swatch.shades),
            "label": swatch.label,
        })).collect::<Vec<_>>(),
    })
}

fn series((number, series): (usize, &PlotSeries), width: f64, frame: &Frame) -> Value {
    let (x, y) = if series.dots {
        (series.x.clone(), series.y.clone())
    } else {
        let (x, y) = frame.scales();
        let points = through(series, frame).into_iter();
        points.map(|at| (x.value(at.0), y.value(at.1))).unzip()
    };
    json!({
        "label": series.label,
        "x": x,
        "y": y,
        "dots": series.dots,
        "stroke": stroke(series.stroke),
        "width": width,
        "colour": told(series_colour(series, number)),
    })
}

fn areas(area: &Area, frame: &Frame) -> Value {
    let (x, y) = frame.scales();
    let piece = |corners: Vec<(f64, f64)>| {
        let (xs, ys): (Vec<f64>, Vec<f64>) = corners
            .into_iter()
            .map(|at| (x.value(at.0), y.value(at.1)))
            .unzip();
        json!({ "x": xs, "y": ys })
    };
    let pieces = pieces(area, frame).into_iter();
    json!({
        "label": area.label,
        "colour": told(colour(area.colour)),
        "opacity": OPACITY,
        "pieces": pieces.map(piece).collect::<Vec<_>>(),
    })
}

fn named_marks(
    panel: &Panel,
    frame: &Frame,
    seen: &[Pixel],
    written: &[Written<'_>],
) -> Vec<Value> {
    let named = marks::named(panel, frame, seen, written).into_iter();
    named
        .map(|(mark, name, offset)| {
            json!({
                "x": mark.x,
                "y": mark.y,
                "label": name,
                "offset": [offset.0, offset.1],
                "symbol": symbol(mark.symbol),
                "filled": mark.filled,
                "colour": told(mark.colour.map_or(MARK, colour)),
                "behind": mark.behind,
                "bars": { "x": mark.bars.x, "y": mark.bars.y },
            })
        })
        .collect()
}

fn notes(frame: &Frame, written: &[Written<'_>]) -> Vec<Value> {
    let one = |&(note, (middle, _)): &Written<'_>| {
        let at = frame.place(note.x, note.y)?;
        Some(json!({
            "x": note.x,
            "y": note.y,
            "text": note.text,
            "offset": [middle.0 - at.0, middle.1 - at.1],
            "colour": told(note.colour.map_or(INK, colour)),
        }))
    };
    written.iter().filter_map(one).collect()
}

fn told(colour: Colour) -> String {
    colour.to_string()
}

fn stroke(stroke: Stroke) -> &'static str {
    match stroke {
        Stroke::Solid => "solid",
        Stroke::Dashed => "dashed",
        Stroke::DashDot => "dash-dot",
        Stroke::DashDotDot => "dash-dot-dot",
        Stroke::Dotted => "dotted",
    }
}

fn symbol(symbol: Symbol) -> &'static str {
    match symbol {
        Symbol::Circle => "circle",
        Symbol::Square => "square",
        Symbol::Diamond => "diamond",
        Symbol::Triangle => "triangle",
        Symbol::Plus => "plus",
        Symbol::Cross => "cross",
        Symbol::Star => "star",
        Symbol::Dot => "dot",
    }
}

#[cfg(test)]
mod test {
    use super::super::{Drawing, Key, Mark, Note, Shade, Swatch};
    use super::*;

    fn everything() -> Panel {
        let mut panel = Panel::new("all", Axis::log("V_H"), Axis::linear("x").within(-1.0, 3.0));
        let broken = PlotSeries {
            left_out: vec![false, true, false],
            ..PlotSeries::new(
                "curve",
                vec![1.0, 10.0, 100.0, 1000.0],
                vec![0.0, 1.0, 2.0, 2.0],
            )
        };
        panel.series = vec![
            broken.stroke(Stroke::DashDot).wide(),
            PlotSeries::dots("points", vec![2.0, f64::NAN], vec![0.5, 0.5]).colour(3),
        ];
        panel.marks = vec![
            Mark::new(10.0, 1.0, "A").symbol(Symbol::Star).open(),
            Mark::new(10.0, 1.0, "B"),
            Mark::new(1e9, 1.0, "outside"),
        ];
        panel.notes = vec![Note::new(30.0, 2.5, "words")];
        panel.keys = vec![Key {
            symbol: Symbol::Square,
            filled: true,
            colour: Some(0),
            label: "squares".into(),
        }];
        panel.areas = vec![Area {
            label: "likely".into(),
            x: vec![1.0, 10.0, 100.0, 1000.0],
            lower: vec![-0.5, 0.5, f64::NAN, 1.0],
            upper: vec![0.5, 1.5, 2.0, 2.5],
            colour: 1,
            left_out: Vec::new(),
        }];
        panel.marks[0].bars.x = Some((5.0, 20.0));
        panel.strokes = vec![(Stroke::Dotted, "dotted ones".into())];
        panel.x = panel.x.within(1.0, 1e3);
        panel
    }

    #[test]
    fn a_description_has_all_that_is_drawn() {
        let drawing = Drawing::columns(vec![vec![everything()]]);
        let made = drawing.describe().unwrap();
        let panel = &made["blocks"][0]["columns"][0][0];
        assert_eq!(panel["title"], "all");
        assert_eq!(panel["x"]["label"], "V_H");
        assert_eq!(panel["x"]["log"], true);
        let right = panel["x"]["range"][1].as_f64().unwrap();
        assert!((right - 1e3).abs() < 1e-9, "{right}");
        assert_eq!(panel["y"]["range"], json!([-1.0, 3.0]));
        let curve = &panel["series"][0];
        assert_eq!(
            (&curve["stroke"], &curve["colour"]),
            (&json!("dash-dot"), &json!("#0072B2"))
        );
        let (x, y) = (
            curve["x"].as_array().unwrap(),
            curve["y"].as_array().unwrap(),
        );
        assert_eq!(x.len(), y.len());
        // What is left out is a break; all else is drawn from the first point to the last.
        let breaks = x.iter().filter(|x| x.is_null()).count();
        assert!(x.len() > 4 && breaks >= 1 && !x[0].is_null(), "{x:?}");
        let between = |x: &Value| x.as_f64().is_some_and(|x| x > 10.5 && x < 99.5);
        assert!(!x.iter().any(between), "{x:?}");
        let dots = &panel["series"][1];
        assert_eq!(dots["x"], json!([2.0, null]));
        assert_eq!(
            (&dots["dots"], &dots["colour"]),
            (&json!(true), &json!("#CC79A7"))
        );
        // One name for two marks at one place, and none for what lies outside.
        let names: Vec<&Value> = panel["marks"]
            .as_array()
            .unwrap()
            .iter()
            .map(|mark| &mark["label"])
            .collect();
        assert_eq!(names, ["A, B", ""]);
        assert_eq!(panel["marks"][0]["symbol"], "star");
        assert_eq!(panel["marks"][0]["filled"], false);
        assert!(
            panel["marks"][0]["offset"]
                .as_array()
                .unwrap()
                .iter()
                .any(|x| x != 0.0)
        );
        // The area breaks where a side is no number; of what is beyond it a point alone has no breadth.
        let area = &panel["areas"][0];
        assert_eq!(
            (&area["label"], &area["colour"]),
            (&json!("likely"), &json!("#D55E00"))
        );
        let first = &area["pieces"][0];
        assert_eq!(first["y"].as_array().unwrap().len(), 4);
        assert_eq!(first["y"][0], json!(-0.5));
        assert_eq!(first["y"][3], json!(0.5));
        let ends = panel["marks"][0]["bars"]["x"].as_array().unwrap();
        assert_eq!(ends, &[json!(5.0), json!(20.0)]);
        assert!(panel["marks"][0]["bars"]["y"].is_null());
        assert_eq!(panel["notes"][0]["text"], "words");
        assert_eq!(panel["keys"][0]["label"], "squares");
        assert_eq!(panel["strokes"][0]["stroke"], "dotted");
        assert!(panel["cells"].is_null());
    }

    #[test]
    fn a_map_has_the_colours_of_its_cells() {
        let mut panel = Panel::new("", Axis::linear("a"), Axis::linear("b"));
        let (red, pale) = (
            Shade::new([255, 0, 0]),
            Shade::new([255, 0, 0]).lighter(0.5),
        );
        panel.cells = Some(Cells {
            x_edges: vec![0.0, 1.0, 2.0],
            y_edges: vec![0.0, 1.0],
            fills: vec![vec![red], vec![red, pale]],
            swatches: vec![Swatch {
                shades: vec![pale],
                label: "pale".into(),
            }],
        });
        let made = Drawing::columns(vec![vec![panel]]).describe().unwrap();
        let cells = &made["blocks"][0]["columns"][0][0]["cells"];
        assert_eq!(cells["fills"], json!([["#FF0000"], ["#FF0000", "#FF8080"]]));
        assert_eq!(
            cells["swatches"][0],
            json!({ "colours": ["#FF8080"], "label": "pale" })
        );
    }

    #[test]
    fn nothing_has_no_description() {
        assert!(Drawing::blocks(Vec::new()).describe().is_err());
        let empty = Panel::new("empty", Axis::linear("a"), Axis::linear("b"));
        assert!(Drawing::columns(vec![vec![empty]]).describe().is_err());
    }
}
