//! Aligned columns for the eye.

use super::{Cell, RowWriter};
use std::io::{Result, Write};

/// Widest number: `-1.234567e-300`.
const WIDTH: usize = 14;
/// Digits after the point.
const DIGITS: usize = 6;
/// What stands between two columns.
const GAP: &str = "  ";

/// Writes rows as a table.
pub struct TableRows<W: Write> {
    to: W,
    widths: Vec<usize>,
    /// Whether each column is shown.
    shown: Vec<bool>,
    hidden: Vec<String>,
}

impl<W: Write> TableRows<W> {
    /// Writes the header: names above, units below.
    ///
    /// # Errors
    /// Those of the file or pipe.
    pub fn new(to: W, columns: &[String], units: &[String]) -> Result<Self> {
        Self::within(usize::MAX, to, columns, units)
    }

    /// The same in lines of so many characters. Columns without room are left out: those before the last one, which is what a
    /// row comes to.
    ///
    /// # Errors
    /// Those of the file or pipe.
    pub fn within(width: usize, to: W, columns: &[String], units: &[String]) -> Result<Self> {
        let widths: Vec<usize> = columns
            .iter()
            .map(|name| name.chars().count().max(WIDTH))
            .collect();
        let shown = fitting(&widths, width);
        let hidden = columns.iter().zip(&shown).filter(|(_, shown)| !**shown);
        let mut table = TableRows {
            to,
            hidden: hidden.map(|(name, _)| name.clone()).collect(),
            widths,
            shown,
        };
        table.line(columns.iter().map(String::as_str))?;
        let units: Vec<String> = units
            .iter()
            .map(|unit| match unit.as_str() {
                "" | "1" => String::new(),
                unit => format!("[{unit}]"),
            })
            .collect();
        if units.iter().any(|unit| !unit.is_empty()) {
            table.line(units.iter().map(String::as_str))?;
        }
        Ok(table)
    }

    /// The columns for which there is no room.
    pub fn hidden(&self) -> &[String] {
        &self.hidden
    }

    fn line<'a>(&mut self, texts: impl Iterator<Item = &'a str>) -> Result<()> {
        let mut line = String::new();
        let columns = texts.zip(&self.widths).zip(&self.shown);
        for ((text, &width), _) in columns.filter(|(_, shown)| **shown) {
            if !line.is_empty() {
                line.push_str(GAP);
            }
            line.push_str(&format!("{text:>width$}"));
        }
        writeln!(self.to, "{}", line.trim_end())?;
        self.to.flush()
    }
}

impl<W: Write> RowWriter for TableRows<W> {
    fn row(&mut self, cells: &[Cell]) -> Result<()> {
        let texts: Vec<String> = cells.iter().map(text).collect();
        self.line(texts.iter().map(String::as_str))
    }
}

/// Which columns fit: the first and the last one always, then the others from the left.
fn fitting(widths: &[usize], room: usize) -> Vec<bool> {
    let mut shown = vec![false; widths.len()];
    let ends = [0, widths.len().saturating_sub(1)];
    let mut used = 0;
    for i in ends.into_iter().chain(0..widths.len()) {
        if i >= widths.len() || shown[i] {
            continue;
        }
        let gap = if used == 0 { 0 } else { GAP.len() };
        if !ends.contains(&i) && used + gap + widths[i] > room {
            break;
        }
        used += gap + widths[i];
        shown[i] = true;
    }
    shown
}

fn text(cell: &Cell) -> String {
    match cell {
        Cell::Number(x) if x.is_finite() => number(*x),
        Cell::Text(text) => text.clone(),
        Cell::Number(_) | Cell::Missing => "-".into(),
    }
}

/// Seven digits: plain where that is readable, else with an exponent.
pub fn number(x: f64) -> String {
    /// Plain notation from 1e-3 to below 1e6.
    const PLAIN: std::ops::Range<f64> = 1e-3..1e6;
    if x == 0.0 {
        return "0".into();
    }
    if PLAIN.contains(&x.abs()) {
        let before = x.abs().log10().floor() as i32;
        let digits = (DIGITS as i32 - before).max(0) as usize;
        format!("{x:.digits$}")
    } else {
        format!("{x:.DIGITS$e}")
    }
}
