//! The words of a picture: read from the SVG, and measured in the font that is built in by nothing of what drew them.

use resvg::tiny_skia::Transform;
use resvg::usvg::Rect;
use resvg::usvg::roxmltree::{Document, Node};
use std::str::FromStr;
use ttf_parser::Face;

static FONT: &[u8] = include_bytes!("../../assets/font/plot.ttf");

/// What is read of words. Whatever else would be said of them could move their letters or change their size.
const KNOWN: [&str; 9] = [
    "x",
    "y",
    "dy",
    "text-anchor",
    "font-family",
    "font-size",
    "fill",
    "transform",
    // Keeps the spaces beside subscripts, which our measure has anyway.
    "space",
];

/// Words on one line.
pub struct Words {
    /// A subscript is read with an underscore, which is never drawn.
    pub text: String,
    /// From the highest to the lowest that letters of the font reach, and as wide as they move on. Pairs that a viewer draws nearer
    /// to each other are not: the outlines of a PNG have none.
    pub place: Rect,
    /// Of all but subscripts.
    pub size: f32,
}

/// All words of an SVG, in the units in which it is shown.
pub fn words(svg: &str) -> Vec<Words> {
    let face = Face::parse(FONT, 0).expect("the font");
    let svg = Document::parse(svg).expect("XML");
    let root = svg.root_element();
    let units = root.attribute("viewBox").expect("its own units");
    let width: f32 = parsed(units.split(' ').nth(2).expect("a width"));
    let scale = number(root, "width") / width;
    let all = root.descendants();
    all.filter(|node| node.has_tag_name("text"))
        .map(|text| {
            assert_eq!(text.parent(), Some(root), "words in a group");
            read(&face, text, scale)
        })
        .collect()
}

fn read(face: &Face, words: Node, scale: f32) -> Words {
    let size = number(words, "font-size");
    let em = f32::from(face.units_per_em());
    let [ascender, descender] = [face.ascender(), face.descender()].map(|y| f32::from(y) / em);
    let mut text = String::new();
    let (mut width, mut low) = (0.0, number(words, "dy"));
    let (mut top, mut bottom) = (f32::INFINITY, f32::NEG_INFINITY);
    assert_known(words);
    for part in words.children() {
        let mut part_size = size;
        if part.has_tag_name("tspan") {
            assert_known(part);
            low += number(part, "dy");
            part_size = part.attribute("font-size").map_or(size, parsed);
        }
        let letters = part.text().expect("letters");
        assert!(!letters.contains('_'), "an underscore is drawn: {letters}");
        if part_size < size {
            text.push('_');
        }
        text.push_str(letters);
        for letter in letters.chars() {
            let glyph = face.glyph_index(letter);
            let glyph = glyph.unwrap_or_else(|| panic!("{letter:?} is not in the font"));
            let on = face.glyph_hor_advance(glyph).expect("a width");
            width += f32::from(on) / em * part_size;
        }
        top = top.min(low - ascender * part_size);
        bottom = bottom.max(low - descender * part_size);
    }
    assert_eq!(text, text.trim(), "viewers leave out spaces at the ends");
    assert!(!text.contains("  "), "viewers make one space of {text:?}");
    let (x, y) = (number(words, "x"), number(words, "y"));
    let left = match words.attribute("text-anchor").expect("an anchor") {
        "start" => x,
        "middle" => x - 0.5 * width,
        "end" => x - width,
        other => panic!("{other}"),
    };
    let straight = Rect::from_ltrb(left, y + top, left + width, y + bottom);
    let turn = words
        .attribute("transform")
        .map_or_else(Transform::identity, turn);
    let place = straight.and_then(|place| place.transform(turn.post_scale(scale, scale)));
    Words {
        text,
        place: place.expect("an area"),
        size: scale * size,
    }
}

fn assert_known(node: Node) {
    for attribute in node.attributes() {
        let name = attribute.name();
        assert!(KNOWN.contains(&name), "{name} is not measured");
    }
}

/// A rotation about a point, by degrees.
fn turn(text: &str) -> Transform {
    let inner = text
        .strip_prefix("rotate(")
        .and_then(|rest| rest.strip_suffix(')'));
    let inner = inner.unwrap_or_else(|| panic!("{text} is not measured"));
    let [angle, x, y] = inner.split(',').map(parsed).collect::<Vec<f32>>()[..] else {
        panic!("{text} is no rotation about a point");
    };
    Transform::from_rotate_at(angle, x, y)
}

fn number(node: Node, name: &str) -> f32 {
    parsed(node.attribute(name).unwrap_or_else(|| panic!("no {name}")))
}

fn parsed<T: FromStr>(text: &str) -> T {
    let number = text.trim().parse().ok();
    number.unwrap_or_else(|| panic!("{text} is no number"))
}
