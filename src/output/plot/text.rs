//! How wide words are, and where long ones are broken.

use super::canvas::BACKEND;
use super::{FONT, unrendered};
use crate::error::Result;
use plotters::prelude::*;

/// The names by which a viewer of the SVG finds a font like ours.
pub const FAMILY: &str = "DejaVu Sans, Verdana, Arial, sans-serif";
/// Size of words.
pub const TEXT: f64 = 12.0;
/// Of the titles of blocks.
pub const TITLE: f64 = 15.5;
/// From line to line, as a part of the size.
const LINE: f64 = 1.5;
/// The font is measured at this size, as plotters knows whole pixels only.
const MEASURED: f64 = 100.0;

/// Makes our font known; again changes nothing.
///
/// # Errors
/// [`crate::error::Error::Input`] if it is damaged.
pub fn register() -> Result<()> {
    plotters::style::register_font(FAMILY, FontStyle::Normal, FONT)
        .map_err(|_| unrendered("the built-in font is damaged"))
}

/// Height of so many lines.
pub fn height(lines: usize, size: f64) -> f64 {
    lines as f64 * LINE * size
}

/// Width of words on one line, in pixels. plotters takes the size for the height of the font, not of its em, and gives 1.065
/// times of what ours is; that leaves room for others.
pub fn width(text: &str, size: f64) -> Result<f64> {
    let font = (FAMILY, MEASURED * BACKEND).into_font();
    let (wide, _) = font.box_size(text).map_err(unrendered)?;
    Ok(f64::from(wide) * size / MEASURED)
}

/// The lines of a text none of which is wider than `limit`: broken between words, and within one that is too long alone.
pub fn wrapped(text: &str, size: f64, limit: f64) -> Result<Vec<String>> {
    let mut lines: Vec<String> = Vec::new();
    let mut line = String::new();
    for word in text.split_whitespace() {
        let longer = if line.is_empty() {
            word.to_owned()
        } else {
            format!("{line} {word}")
        };
        if width(&longer, size)? <= limit {
            line = longer;
            continue;
        }
        if !line.is_empty() {
            lines.push(std::mem::take(&mut line));
        }
        for letter in word.chars() {
            line.push(letter);
            if width(&line, size)? > limit && line.chars().count() > 1 {
                line.pop();
                lines.push(std::mem::replace(&mut line, letter.to_string()));
            }
        }
    }
    lines.extend((!line.is_empty()).then_some(line));
    Ok(lines)
}

#[cfg(test)]
mod test {
    use super::*;

    #[test]
    fn long_texts_are_broken_and_nothing_is_lost() {
        register().unwrap();
        let text = "symmetric and asymmetric periodic orbits of Pneumonoultramicroscopicsilicovolcanoconiosis";
        let lines = wrapped(text, TEXT, 120.0).unwrap();
        assert!(lines.len() > 4);
        for line in &lines {
            assert!(width(line, TEXT).unwrap() <= 120.0, "{line}");
        }
        assert_eq!(lines.concat().replace(' ', ""), text.replace(' ', ""));
        assert_eq!(wrapped("short", TEXT, 120.0).unwrap(), ["short"]);
    }
}
