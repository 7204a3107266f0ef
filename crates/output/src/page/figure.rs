//! A figure with its caption and what it was computed by, and a table of numbers.

use super::words::{anchor, duration, label, link, paragraphs, prose};
use super::{Figure, Table};
use base64::Engine;
use base64::engine::general_purpose::STANDARD;
use maud::{Markup, html};

/// The section of one figure, with the ways to the one before and the one after.
pub fn figure(figure: &Figure, beside: [Option<&Figure>; 2]) -> Markup {
    let place = anchor(&figure.id);
    html! {
        section.figure id=(place) aria-labelledby={ (place) "-title" } {
            (heading(&figure.id, &figure.title))
            figure {
                @if !figure.svg.is_empty() { (picture(figure)) }
                figcaption { @for text in paragraphs(&figure.caption) { p { (prose(&text)) } } }
            }
            dl.made {
                @if !figure.method.is_empty() || figure.seconds.is_some() {
                    div { dt { "Computed" } dd { (prose(&figure.method)) (time(figure.seconds)) } }
                }
                @if !figure.csv_file.is_empty() { div { dt { "Numbers" } dd { (link(&figure.csv_file)) } } }
                @if !figure.svg_file.is_empty() { div { dt { "Picture" } dd { (link(&figure.svg_file)) "; a click on it here enlarges it" } } }
            }
            @for (name, text) in &figure.scenes {
                details.scene {
                    summary { "Scene " code { (name) } }
                    pre { code { (text) } }
                }
            }
            (ways(beside))
        }
    }
}

/// To the figure before, to the contents, to the figure after.
fn ways([before, after]: [Option<&Figure>; 2]) -> Markup {
    html! {
        p.ways {
            @if let Some(other) = before { a href={ "#" (anchor(&other.id)) } { "← " (label(&other.id)) } " " }
            a href="#contents" { "Contents" }
            @if let Some(other) = after { " " a href={ "#" (anchor(&other.id)) } { (label(&other.id)) " →" } }
        }
    }
}

fn heading(id: &str, title: &str) -> Markup {
    let place = anchor(id);
    html! {
        h3 id={ (place) "-title" } {
            a.number href={ "#" (place) } { (label(id)) }
            " " (prose(title))
        }
    }
}

fn time(seconds: Option<f64>) -> Markup {
    let seconds = seconds.filter(|s| s.is_finite() && *s >= 0.0);
    html! { @if let Some(s) = seconds { " " span.time { "Took\u{a0}" (duration(s)) " of processor time." } } }
}

/// The picture, which fits the page; a click, or a tap, or the space bar enlarges it in a frame that scrolls, and the next one
/// takes that back. No script: a box that is checked, and the style.
fn picture(figure: &Figure) -> Markup {
    let source = format!("data:image/svg+xml;base64,{}", STANDARD.encode(&figure.svg));
    let (width, height) = size(&figure.svg);
    let image = html! { img src=(source) alt=(figure.alt) width=[width] height=[height]; };
    let zoom = format!("{}-zoom", anchor(&figure.id));
    html! {
        input.zoom type="checkbox" id=(zoom) aria-label={ "Enlarge " (label(&figure.id)) };
        label.picture for=(zoom) title="Enlarge, and back" { (image) }
    }
}

/// Width and height that the picture declares, so that the page has room for it before it is drawn.
fn size(svg: &str) -> (Option<u32>, Option<u32>) {
    let head = svg.find("<svg").map_or("", |start| &svg[start..]);
    let head = head.split('>').next().unwrap_or("");
    let number = |name: &str| -> Option<u32> {
        let value = head
            .split_once(&format!(" {name}=\""))?
            .1
            .split('"')
            .next()?;
        let pixels: f64 = value.trim_end_matches("px").parse().ok()?;
        (pixels >= 1.0).then_some(pixels.round() as u32)
    };
    (number("width"), number("height"))
}

/// The section of one table.
pub fn table(table: &Table) -> Markup {
    let place = anchor(&table.id);
    html! {
        section.numbers id=(place) aria-labelledby={ (place) "-title" } {
            (heading(&table.id, &table.title))
            @for text in paragraphs(&table.caption) { p { (prose(&text)) } }
            div.scroll role="region" aria-labelledby={ (place) "-title" } tabindex="0" {
                table {
                    thead { tr { @for name in &table.columns { th scope="col" { (prose(name)) } } } }
                    tbody { @for row in &table.rows { (cells(row)) } }
                }
            }
            @if !table.csv_file.is_empty() {
                dl.made { div { dt { "Numbers" } dd { (link(&table.csv_file)) } } }
            }
        }
    }
}

/// A row: its first cell names it, numbers stand to the right.
fn cells(row: &[String]) -> Markup {
    let class = |cell: &str| cell.trim().parse::<f64>().is_ok().then_some("value");
    html! {
        tr {
            @for (i, cell) in row.iter().enumerate() {
                @if i == 0 { th scope="row" class=[class(cell)] { (prose(cell)) } }
                @else { td class=[class(cell)] { (prose(cell)) } }
            }
        }
    }
}
