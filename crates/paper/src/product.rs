//! What is made of the paper: its figures, its table and the scorecard, each with the scenes that it needs.

use super::figures;
use super::pieces::Pieces;
use super::scorecard;
use super::sheet::Sheet;
use twinslip::error::{Error, Result};
use twinslip_output::plot::Drawing;

/// What a product is made into.
#[derive(Debug, Clone, PartialEq)]
pub struct Made {
    /// The numbers.
    pub sheet: Sheet,
    /// The picture, of a figure.
    pub drawing: Option<Drawing>,
    /// How it was computed: method and tolerances, in a sentence or two.
    pub method: String,
}

/// How a product is made.
#[derive(Debug, Clone, Copy)]
pub enum Make {
    /// A figure: CSV and picture.
    Figure(fn(&Pieces<'_>) -> Result<Made>),
    /// A table: CSV.
    Table(fn(&Pieces<'_>) -> Result<Made>),
    /// The scorecard: JSON.
    Scorecard,
}

/// One of them.
#[derive(Debug)]
pub struct Product {
    /// Its name in file names and on the command line: fig07, table1, scorecard.
    pub id: &'static str,
    /// What it shows, in a few words.
    pub title: &'static str,
    /// What is to be seen, paragraphs with empty lines between.
    pub caption: &'static str,
    /// What somebody who can't see the picture should know of it.
    pub alt: &'static str,
    /// The scenes whose pieces it needs, the longest first.
    pub scenes: &'static [&'static str],
    /// How it is made.
    pub make: Make,
}

/// All, in the order of the paper.
pub const PRODUCTS: &[&Product] = &[
    &figures::fig01::FIGURE,
    &figures::fig02::FIGURE,
    &figures::fig03::FIGURE,
    &figures::fig04::FIGURE,
    &figures::fig05::FIGURE,
    &figures::fig05_unfolded::FIGURE,
    &figures::fig06::FIGURE,
    &figures::fig06_unfolded::FIGURE,
    &figures::fig07::FIGURE,
    &figures::fig08::FIGURE,
    &figures::fig09::FIGURE,
    &figures::fig10::FIGURE,
    &figures::fig11::FIGURE,
    &figures::fig12::FIGURE,
    &figures::fig13::FIGURE,
    &figures::fig14::FIGURE,
    &figures::fig15::FIGURE,
    &figures::fig16::FIGURE,
    &figures::fig17::FIGURE,
    &scorecard::TABLE1,
    &scorecard::SCORECARD,
];

impl Product {
    /// The product of that name; figures may be called by their number alone, as 7, fig7 or fig07, and what is beside one as
    /// 5-unfolded.
    ///
    /// # Errors
    /// [`Error::Parameter`] with the names that there are.
    pub fn named(name: &str) -> Result<&'static Product> {
        let plain = name.to_lowercase();
        let digits = plain
            .trim_start_matches("fig")
            .trim_start_matches(['.', ' ']);
        let (digits, beside) = digits.split_at(digits.find('-').unwrap_or(digits.len()));
        let number = digits.parse::<u8>();
        let id = number.map_or_else(|_| name.to_owned(), |n| format!("fig{n:02}{beside}"));
        let found = PRODUCTS.iter().find(|product| product.id == id);
        found.copied().ok_or_else(|| {
            let ids: Vec<&str> = PRODUCTS.iter().map(|product| product.id).collect();
            Error::unknown("figure", name, &ids)
        })
    }

    /// The products of a comma-separated list, each once, in the order of the paper.
    ///
    /// # Errors
    /// As of [`Product::named`].
    pub fn listed(names: &str) -> Result<Vec<&'static Product>> {
        let wanted: Vec<&Product> = names
            .split(',')
            .map(|name| Product::named(name.trim()))
            .collect::<Result<_>>()?;
        let all = PRODUCTS.iter().copied();
        Ok(all
            .filter(|one| wanted.iter().any(|other| other.id == one.id))
            .collect())
    }

    /// The files that it is made into.
    pub fn files(&self, png: bool) -> Vec<String> {
        let extensions: &[&str] = match (self.make, png) {
            (Make::Figure(_), true) => &["csv", "svg", "png"],
            (Make::Figure(_), false) => &["csv", "svg"],
            (Make::Table(_), _) => &["csv"],
            (Make::Scorecard, _) => &["json"],
        };
        extensions
            .iter()
            .map(|extension| format!("{}.{extension}", self.id))
            .collect()
    }
}
