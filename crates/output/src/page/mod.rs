//! A report as one HTML file: a summary, figures with captions, tables, a scorecard, and how it all came about.
//!
//! The file holds its pictures and its style, asks for nothing else and has no script, so it reads the same from a disk,
//! by mail and in ten years; a policy in its head forbids browsers to load anything. What it links to (CSV, SVG, scenes)
//! lies beside it. The same page gives the same bytes.

mod figure;
mod provenance;
mod scorecard;
mod words;

use maud::{DOCTYPE, Markup, PreEscaped, html};
pub use words::percent;
use words::{anchor, label, prose};

const STYLE: &str = include_str!("style.css");
/// Nothing but the style and the pictures that are in the file.
const POLICY: &str = "default-src 'none'; img-src data:; style-src 'unsafe-inline'; base-uri 'none'; form-action 'none'";

/// What the report says, as plain data. Texts are plain too: whatever they hold is shown, not obeyed, but for symbols with
/// an index such as `V_H`, which are typeset.
#[derive(Debug, Clone, Default, PartialEq)]
pub struct Page {
    /// The heading, and the name of the window.
    pub title: String,
    /// The summary, a paragraph each.
    pub lead: Vec<String>,
    /// The figures of merit below the summary: a short label and its value, such as "entries that agree", "52 of 61".
    pub facts: Vec<(String, String)>,
    /// Printed values beside computed ones.
    pub scores: Vec<Score>,
    /// Figures in the order of reading.
    pub figures: Vec<Figure>,
    /// Tables in the order of reading.
    pub tables: Vec<Table>,
    /// What made the report: name and value, such as "version", "0.1.0".
    pub manifest: Vec<(String, String)>,
    /// The files beside the report.
    pub files: Vec<FileRow>,
}

/// One printed value and what was computed for it.
#[derive(Debug, Clone, Default, PartialEq)]
pub struct Score {
    /// Its name in the scorecard file; unique among the scores.
    pub id: String,
    /// Where it is printed, such as "Fig. 16, caption".
    pub place: String,
    /// What it is.
    pub quantity: String,
    /// The printed value.
    pub printed: String,
    /// The computed value with its error budget.
    pub computed: String,
    /// The value by another method, and that method's name; may be empty.
    pub second: String,
    /// By which part the printed value differs from the computed one; of numbers that don't agree.
    pub difference: Option<f64>,
    /// `agrees`, `differs` or `misprint`.
    pub verdict: String,
    /// What there is to say; may be empty.
    pub note: String,
}

/// One figure.
#[derive(Debug, Clone, Default, PartialEq)]
pub struct Figure {
    /// Its place on the page, such as `fig07`, which is read as "Figure 7"; unique among figures and tables.
    pub id: String,
    /// What it shows, without its number.
    pub title: String,
    /// Paragraphs separated by blank lines.
    pub caption: String,
    /// The picture in words, for those who do not see it.
    pub alt: String,
    /// The picture; empty if there is none.
    pub svg: String,
    /// The file of the picture.
    pub svg_file: String,
    /// The file of the numbers.
    pub csv_file: String,
    /// Method and tolerances.
    pub method: String,
    /// How long it took, in seconds.
    pub seconds: Option<f64>,
    /// The scene files it was computed from: name and text.
    pub scenes: Vec<(String, String)>,
}

/// One table.
#[derive(Debug, Clone, Default, PartialEq)]
pub struct Table {
    /// Its place on the page, such as `table1`, which is read as "Table 1"; unique among figures and tables.
    pub id: String,
    /// What it lists, without its number.
    pub title: String,
    /// Paragraphs separated by blank lines.
    pub caption: String,
    /// The file of the numbers.
    pub csv_file: String,
    /// Names of the columns.
    pub columns: Vec<String>,
    /// Rows of as many cells.
    pub rows: Vec<Vec<String>>,
}

/// One file beside the report.
#[derive(Debug, Clone, Default, PartialEq)]
pub struct FileRow {
    /// Its name, relative to the report.
    pub name: String,
    /// Its length.
    pub bytes: u64,
    /// Its SHA-256 in hexadecimal digits.
    pub sha256: String,
}

impl Page {
    /// The whole file.
    pub fn html(&self) -> String {
        html! {
            (DOCTYPE)
            html lang="en" {
                head {
                    meta charset="utf-8";
                    meta name="viewport" content="width=device-width, initial-scale=1";
                    meta http-equiv="Content-Security-Policy" content=(POLICY);
                    meta name="color-scheme" content="light";
                    title { (self.title) }
                    // Without it, a server of the folder is asked for an icon.
                    link rel="icon" href="data:,";
                    style { (PreEscaped(STYLE)) }
                }
                body {
                    (self.header())
                    div.below {
                        (self.contents())
                        (self.main())
                    }
                    footer {
                        p { a href="#top" { "Back to the top" } }
                    }
                }
            }
        }
        .into_string()
    }

    fn header(&self) -> Markup {
        html! {
            header #top {
                h1 { (prose(&self.title)) }
                div.lead {
                    @for text in &self.lead { p { (prose(text)) } }
                }
                @if !self.facts.is_empty() {
                    dl.facts {
                        @for (name, value) in &self.facts {
                            div { dt { (prose(name)) } dd { (prose(value)) } }
                        }
                    }
                }
            }
        }
    }

    fn contents(&self) -> Markup {
        let figures = self
            .figures
            .iter()
            .map(|figure| (&figure.id, &figure.title));
        let tables = self.tables.iter().map(|table| (&table.id, &table.title));
        let places = |places: Vec<(&String, &String)>| {
            html! {
                ol {
                    @for (id, title) in places {
                        li { a href={ "#" (anchor(id)) } { span.number { (label(id)) } " " (prose(title)) } }
                    }
                }
            }
        };
        html! {
            nav #contents aria-label="Contents" {
                @if !self.figures.is_empty() { p { a href="#figures" { "Figures" } } (places(figures.collect())) }
                @if !self.tables.is_empty() { p { a href="#tables" { "Tables" } } (places(tables.collect())) }
                @if !self.scores.is_empty() { p { a href="#scorecard" { "Scorecard" } } (scorecard::places(&self.scores)) }
                @if self.has_provenance() { p { a href="#provenance" { "How to repeat it" } } }
            }
        }
    }

    fn main(&self) -> Markup {
        html! {
            main {
                @if !self.figures.is_empty() {
                    section #figures aria-labelledby="figures-title" {
                        h2 #figures-title { "Figures" }
                        @for (i, figure) in self.figures.iter().enumerate() {
                            @let beside = |j: Option<usize>| j.and_then(|j| self.figures.get(j));
                            (figure::figure(figure, [beside(i.checked_sub(1)), beside(Some(i + 1))]))
                        }
                    }
                }
                @if !self.tables.is_empty() {
                    section #tables aria-labelledby="tables-title" {
                        h2 #tables-title { "Tables" }
                        @for table in &self.tables { (figure::table(table)) }
                    }
                }
                @if !self.scores.is_empty() { (scorecard::section(&self.scores)) }
                @if self.has_provenance() { (provenance::section(&self.manifest, &self.files)) }
            }
        }
    }

    fn has_provenance(&self) -> bool {
        !(self.manifest.is_empty() && self.files.is_empty())
    }
}
