//! Aligned columns for the eye.

use super::{Cell, RowWriter};
use std::io::{Result, Write};

/// Widest number: `-1.234567e-300`.
const WIDTH: usize = 14;
/// Digits after the point.
const DIGITS: usize = 6;

/// Writes rows as a table.
pub struct TableRows<W: Write> {
    to: W,
    widths: Vec<usize>,
}

impl<W: Write> TableRows<W> {
    /// Writes the header: names above, units below.
    ///
    /// # Errors
    /// Those of the file or pipe.
    pub fn new(mut to: W, columns: &[String], units: &[String]) -> Result<Self> {
        let widths: Vec<usize> = columns
            .iter()
            .map(|name| name.chars().count().max(WIDTH))
            .collect();
        line(&mut to, columns.iter().map(String::as_str), &widths)?;
        let units: Vec<String> = units
            .iter()
            .map(|unit| match unit.as_str() {
                "" | "1" => String::new(),
                unit => format!("[{unit}]"),
            })
            .collect();
        if units.iter().any(|unit| !unit.is_empty()) {
            line(&mut to, units.iter().map(String::as_str), &widths)?;
        }
        Ok(TableRows { to, widths })
    }
}

impl<W: Write> RowWriter for TableRows<W> {
    fn row(&mut self, cells: &[Cell]) -> Result<()> {
        let texts: Vec<String> = cells.iter().map(text).collect();
        line(&mut self.to, texts.iter().map(String::as_str), &self.widths)
    }
}

fn line<'a>(
    to: &mut impl Write,
    texts: impl Iterator<Item = &'a str>,
    widths: &[usize],
) -> Result<()> {
    let mut line = String::new();
    for (text, &width) in texts.zip(widths) {
        if !line.is_empty() {
            line.push_str("  ");
        }
        line.push_str(&format!("{text:>width$}"));
    }
    writeln!(to, "{}", line.trim_end())?;
    to.flush()
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
