//! How wide words are, and where long ones are broken.

use super::canvas::BACKEND;
use super::{FONT, unrendered};
use crate::error::Result;
use plotters::prelude::*;

/// The names by which a viewer of the SVG finds a font like ours.
pub const FAMILY: &str = "DejaVu Sans, Verdana, Arial, sans-serif";
/// Size of words.
pub const TEXT: f64 = 13.0;
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

/// Subscripts are so much smaller, and so much lower as a part of the size.
pub const SUBSCRIPT: f64 = 0.74;
pub const LOWER: f64 = 0.22;

/// The text in parts, each with whether it is a subscript: what follows a single letter and an underscore, as in `V_H` and `μ_ss`.
pub fn parts(text: &str) -> Vec<(String, bool)> {
    let letters: Vec<char> = text.chars().collect();
    let mut parts = vec![(String::new(), false)];
    let mut i = 0;
    while i < letters.len() {
        let symbol = |i: usize| i >= 1 && letters[i - 1].is_alphabetic();
        let alone = i < 2 || !(letters[i - 2].is_alphanumeric() || letters[i - 2] == '_');
        let ends = letters[i + 1..]
            .iter()
            .take_while(|c| c.is_alphanumeric())
            .count();
        if letters[i] == '_' && symbol(i) && alone && ends > 0 {
            parts.push((letters[i + 1..=i + ends].iter().collect(), true));
            parts.push((String::new(), false));
            i += ends + 1;
        } else {
            if let Some((last, _)) = parts.last_mut() {
                last.push(letters[i]);
            }
            i += 1;
        }
    }
    parts.retain(|(part, _)| !part.is_empty());
    parts
}

/// Width of words on one line, in pixels. plotters takes the size for the height of the font, not of its em, and gives 1.065
/// times of what ours is; that leaves room for others.
pub fn width(text: &str, size: f64) -> Result<f64> {
    let font = (FAMILY, MEASURED * BACKEND).into_font();
    let mut all = 0.0;
    for (part, subscript) in parts(text) {
        let (wide, _) = font.box_size(&part).map_err(unrendered)?;
        let size = if subscript { SUBSCRIPT * size } else { size };
        all += f64::from(wide) * size / MEASURED;
    }
    Ok(all)
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
    fn one_letter_has_a_subscript_and_a_word_has_none() {
        let shown = |text| -> Vec<String> {
            let part =
                |(part, lower): (String, bool)| if lower { format!("[{part}]") } else { part };
            parts(text).into_iter().map(part).collect()
        };
        assert_eq!(shown("2 V_M = 0.05"), ["2 V", "[M]", " = 0.05"]);
        assert_eq!(shown("τ_ss(V_H/2)"), ["τ", "[ss]", "(V", "[H]", "/2)"]);
        assert_eq!(shown("Q₃, K = k_c*"), ["Q₃, K = k", "[c]", "*"]);
        for plain in ["slip_rate_1", "_a", "V_", "V_ x", "plain"] {
            assert_eq!(shown(plain), [plain]);
        }
    }

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
