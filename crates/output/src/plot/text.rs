//! How wide words are, and where long ones are broken.

use super::FONT;
use std::fmt::Write;
use std::sync::LazyLock;
use ttf_parser::{Face, GlyphId, OutlineBuilder};

/// The names by which a viewer of the SVG finds a font like ours.
pub const FAMILY: &str = "DejaVu Sans, Verdana, Arial, sans-serif";
/// Size of words.
pub const TEXT: f64 = 13.0;
/// Of the titles of blocks.
pub const TITLE: f64 = 15.5;
/// From line to line, as a part of the size.
const LINE: f64 = 1.5;
/// Room for viewers whose font is wider than ours.
const WIDER: f64 = 1.065;

/// Our font.
static FACE: LazyLock<Face<'static>> =
    LazyLock::new(|| Face::parse(FONT, 0).expect("the font that is built in"));

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

/// The letters of a part, and how far each moves on as a part of the size.
fn letters(part: &str) -> impl Iterator<Item = (GlyphId, f64)> {
    let em = f64::from(FACE.units_per_em());
    part.chars().map(move |letter| {
        let glyph = FACE.glyph_index(letter).unwrap_or_default();
        let on = FACE.glyph_hor_advance(glyph).unwrap_or_default();
        (glyph, f64::from(on) / em)
    })
}

/// The size of a part of words of this size.
fn size_of(subscript: bool, size: f64) -> f64 {
    if subscript { SUBSCRIPT * size } else { size }
}

/// Width of words on one line in our font, in units of the size.
pub fn advance(parts: &[(String, bool)], size: f64) -> f64 {
    let of = |(part, subscript): &(String, bool)| {
        size_of(*subscript, size) * letters(part).map(|(_, on)| on).sum::<f64>()
    };
    parts.iter().map(of).sum()
}

/// Width of words on one line, in pixels, with some room.
pub fn width(text: &str, size: f64) -> f64 {
    WIDER * advance(&parts(text), size)
}

/// The outlines of words that begin at this place on their line, in the language of paths.
pub fn outlines(parts: &[(String, bool)], (mut x, y): (f64, f64), size: f64) -> String {
    let mut path = String::new();
    for (part, subscript) in parts {
        let low = if *subscript { LOWER * size } else { 0.0 };
        let size = size_of(*subscript, size);
        for (glyph, on) in letters(part) {
            let mut outline = Outline {
                path: &mut path,
                at: (x, y + low),
                scale: size / f64::from(FACE.units_per_em()),
            };
            // A space has none.
            FACE.outline_glyph(glyph, &mut outline);
            x += on * size;
        }
    }
    path
}

/// The outline of a letter, from the units of the font with y upwards to those of the picture.
struct Outline<'p> {
    path: &'p mut String,
    at: (f64, f64),
    scale: f64,
}

impl Outline<'_> {
    fn put(&mut self, step: char, points: &[(f32, f32)]) {
        self.path.push(step);
        for (x, y) in points {
            let x = self.at.0 + self.scale * f64::from(*x);
            let y = self.at.1 - self.scale * f64::from(*y);
            write!(self.path, "{x:.2} {y:.2} ").expect("a string takes all");
        }
    }
}

impl OutlineBuilder for Outline<'_> {
    fn move_to(&mut self, x: f32, y: f32) {
        self.put('M', &[(x, y)]);
    }
    fn line_to(&mut self, x: f32, y: f32) {
        self.put('L', &[(x, y)]);
    }
    fn quad_to(&mut self, x1: f32, y1: f32, x: f32, y: f32) {
        self.put('Q', &[(x1, y1), (x, y)]);
    }
    fn curve_to(&mut self, x1: f32, y1: f32, x2: f32, y2: f32, x: f32, y: f32) {
        self.put('C', &[(x1, y1), (x2, y2), (x, y)]);
    }
    fn close(&mut self) {
        self.path.push('z');
    }
}

/// The words of a text; a symbol and its value, as in `K = 0.14`, are one.
fn words(text: &str) -> Vec<String> {
    let mut words: Vec<String> = Vec::new();
    let mut joined = false;
    for word in text.split_whitespace() {
        let sign = word == "=";
        match words.last_mut() {
            Some(last) if sign || joined => {
                last.push(' ');
                last.push_str(word);
            }
            _ => words.push(word.to_owned()),
        }
        joined = sign;
    }
    words
}

/// The lines of a text none of which is wider than `limit`: broken between words, and within one that is too long alone.
pub fn wrapped(text: &str, size: f64, limit: f64) -> Vec<String> {
    let mut lines: Vec<String> = Vec::new();
    let mut line = String::new();
    for word in words(text) {
        let longer = if line.is_empty() {
            word.clone()
        } else {
            format!("{line} {word}")
        };
        if width(&longer, size) <= limit {
            line = longer;
            continue;
        }
        if !line.is_empty() {
            lines.push(std::mem::take(&mut line));
        }
        for letter in word.chars() {
            line.push(letter);
            if width(&line, size) > limit && line.chars().count() > 1 {
                line.pop();
                lines.push(std::mem::replace(&mut line, letter.to_string()));
            }
        }
    }
    lines.extend((!line.is_empty()).then_some(line));
    lines
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
        let text = "symmetric and asymmetric periodic orbits of Pneumonoultramicroscopicsilicovolcanoconiosis";
        let lines = wrapped(text, TEXT, 120.0);
        assert!(lines.len() > 4);
        for line in &lines {
            assert!(width(line, TEXT) <= 120.0, "{line}");
        }
        assert_eq!(lines.concat().replace(' ', ""), text.replace(' ', ""));
        assert_eq!(wrapped("short", TEXT, 120.0), ["short"]);
        // A value stays with its symbol.
        let lines = wrapped("return map, V_H = 0.102", TEXT, 120.0);
        assert_eq!(lines, ["return map,", "V_H = 0.102"]);
    }
}
