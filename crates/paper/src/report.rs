//! The report: one page of all that lies complete in the directory, made of the files themselves.

use super::product::{Make, PRODUCTS, Product};
use super::record::{ProductEntry, Record};
use serde_json::Value;
use std::path::Path;
use twinslip::error::Result;
use twinslip_output::Head;
use twinslip_output::page::{Figure, FileRow, Page, Score, Table, percent};
use twinslip_tasks::scene::shipped;

/// Its file.
pub const FILE: &str = "report.html";
/// A value with a tiny uncertainty is shown with so many digits.
const DIGITS: i32 = 12;

const TITLE: &str = "Sliding modes of two interacting frictional interfaces, computed again";

/// Writes it.
///
/// # Errors
/// [`twinslip::Error::File`].
pub fn write(dir: &Path, record: &Record) -> Result<()> {
    super::run::write(&dir.join(FILE), page(dir, record).html().as_bytes())
}

fn page(dir: &Path, record: &Record) -> Page {
    let mut page = Page {
        title: TITLE.into(),
        manifest: manifest(record),
        ..Page::default()
    };
    for product in PRODUCTS {
        let Some(entry) = record.products.get(product.id) else {
            continue;
        };
        if !entry.files.iter().all(|file| file.stands(dir)) {
            continue;
        }
        page.files.extend(entry.files.iter().map(|file| FileRow {
            name: file.name.clone(),
            bytes: file.bytes,
            sha256: file.sha256.clone(),
        }));
        match product.make {
            Make::Figure(_) => page.figures.push(figure(dir, product, entry)),
            Make::Table(_) => page.tables.push(table(dir, product)),
            Make::Scorecard => page.scores = scores(&text(dir, "scorecard.json")),
        }
    }
    page.lead = lead(&page);
    page.facts = facts(&page, record);
    page
}

fn text(dir: &Path, name: &str) -> String {
    std::fs::read_to_string(dir.join(name)).unwrap_or_default()
}

fn lead(page: &Page) -> Vec<String> {
    let mut lead = vec![
        "Two parallel frictional interfaces in an elastic slab, sheared at a constant velocity, obey a rate-and-state friction law. Putelat, Willis and Dawes (2008) found what they do: they slide alike or one for both, in stick-slip cycles, on tori, in resonances and in complicated ways. This report computes their figures and their table again, from the equations, and holds every number and every claim that a computation can decide against the text.".to_owned(),
    ];
    if !page.scores.is_empty() {
        lead.push("Each computed value comes with a bound on its error, and where there is an unlike second method, with the value by that one. A number agrees if the computed one, rounded to the digits that are printed, is the printed one; a bound if it is right and tight; a claim if it holds. What differs is sorted by how much: a claim that fails first, then numbers from the largest difference to the smallest.".to_owned());
    }
    lead
}

fn facts(page: &Page, record: &Record) -> Vec<(String, String)> {
    let mut facts = Vec::new();
    let count = |verdict: &str| {
        page.scores
            .iter()
            .filter(|one| one.verdict == verdict)
            .count()
    };
    if !page.scores.is_empty() {
        let all = page.scores.len();
        facts.push((
            "entries that agree".into(),
            format!("{} of {all}", count("agrees")),
        ));
        facts.push(("differ from the text".into(), count("differs").to_string()));
        let off = page.scores.iter().filter(|one| one.verdict == "differs");
        let off = off.filter_map(|one| one.difference).map(f64::abs);
        let (least, most) = off.fold((f64::INFINITY, 0.0_f64), |(least, most), x| {
            (least.min(x), most.max(x))
        });
        if least <= most {
            facts.push((
                "by which numbers that differ are off".into(),
                format!("{} to {}", percent(least), percent(most)),
            ));
        }
        facts.push(("misprints".into(), count("misprint").to_string()));
    }
    if !page.figures.is_empty() {
        facts.push(("figures".into(), page.figures.len().to_string()));
    }
    if let Some(seconds) = record.seconds {
        facts.push((
            "seconds by the clock for what was made last".into(),
            format!("{seconds:.1}"),
        ));
    }
    facts
}

fn manifest(record: &Record) -> Vec<(String, String)> {
    let mut manifest: Vec<(String, String)> = record
        .machine
        .iter()
        .map(|(name, value)| (name.clone(), value.clone()))
        .collect();
    manifest.push((
        "parameters".into(),
        "a_v = 0.369, a = 0.0349, b = 0.0489, R = 100, c = 0.001 (Heslot et al. 1994), V* = 1 um/s, L = 0.9 um, unless a scene says otherwise".into(),
    ));
    manifest.push((
        "units".into(),
        "stress in a sigma, slip rate in V*, time in L/V*, stiffness in a sigma/L".into(),
    ));
    manifest
}

fn figure(dir: &Path, product: &Product, entry: &ProductEntry) -> Figure {
    let scenes = product.scenes.iter().map(|scene| {
        let text = shipped(scene).unwrap_or_default();
        (format!("{scene}.toml"), text.to_owned())
    });
    let svg_file = format!("{}.svg", product.id);
    Figure {
        id: product.id.into(),
        title: product.title.into(),
        caption: product.caption.into(),
        alt: product.alt.into(),
        svg: text(dir, &svg_file),
        svg_file,
        csv_file: format!("{}.csv", product.id),
        method: entry.method.clone(),
        seconds: Some(entry.seconds),
        scenes: scenes.collect(),
    }
}

fn table(dir: &Path, product: &Product) -> Table {
    let csv_file = format!("{}.csv", product.id);
    let text = text(dir, &csv_file);
    let mut rows = text.as_bytes();
    let head = Head::read(&mut rows).unwrap_or_default();
    // The first column only names the part of the file.
    let cells = |line: std::io::Result<String>| {
        let line = line.unwrap_or_default();
        let cells = line.split(',').skip(1);
        cells.map(str::to_owned).collect::<Vec<String>>()
    };
    Table {
        id: product.id.into(),
        title: product.title.into(),
        caption: product.caption.into(),
        columns: head
            .columns
            .iter()
            .skip(1)
            .map(|name| name.replace('_', " "))
            .collect(),
        rows: std::io::BufRead::lines(rows).map(cells).collect(),
        csv_file,
    }
}

/// The entries of `scorecard.json`.
fn scores(json: &str) -> Vec<Score> {
    let all: Value = serde_json::from_str(json).unwrap_or_default();
    let entries = all["entries"].as_array().cloned().unwrap_or_default();
    entries.iter().map(score).collect()
}

fn score(entry: &Value) -> Score {
    let word = |name: &str| entry[name].as_str().unwrap_or_default().to_owned();
    let unit = word("unit");
    let with_unit = |value: String| match unit.as_str() {
        "" => value,
        unit => format!("{value} {unit}"),
    };
    let second = &entry["second"];
    let second = match second["method"].as_str() {
        Some(method) => format!("{} ({method})", answer(&second["computed"])),
        None => String::new(),
    };
    Score {
        id: word("id"),
        place: word("where"),
        quantity: word("quantity"),
        printed: word("printed"),
        computed: with_unit(answer(&entry["computed"])),
        second,
        // That of what agrees is rounding.
        difference: entry["relative_difference"]
            .as_f64()
            .filter(|_| entry["verdict"] != "agrees"),
        verdict: word("verdict"),
        note: word("note"),
    }
}

/// A word, or a number with its uncertainty.
fn answer(value: &Value) -> String {
    if let Some(word) = value.as_str() {
        return word.to_owned();
    }
    let number = |value: &Value| value.as_f64();
    match (number(&value["value"]), number(&value["uncertainty"])) {
        (Some(x), Some(u)) => within(x, u),
        (Some(x), None) => digits(x, DIGITS),
        _ => number(value).map_or_else(String::new, |x| digits(x, DIGITS)),
    }
}

/// As many digits as the uncertainty leaves, and that with one.
fn within(x: f64, uncertainty: f64) -> String {
    if uncertainty == 0.0 {
        return digits(x, DIGITS);
    }
    let known = (x.abs().log10().floor() - uncertainty.log10().floor()) as i32 + 1;
    format!("{} ± {uncertainty:.0e}", digits(x, known.clamp(1, DIGITS)))
}

/// A number with so many significant digits; plain unless that is hard to read.
fn digits(x: f64, number: i32) -> String {
    if x == 0.0 || !x.is_finite() {
        return "0".into();
    }
    let exponent = x.abs().log10().floor() as i32;
    if (-4..7).contains(&exponent) {
        format!("{x:.*}", (number - 1 - exponent).max(0) as usize)
    } else {
        format!("{x:.*e}", (number - 1).max(0) as usize)
    }
}
