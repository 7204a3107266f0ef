//! What a viewer of a picture sees: the words and shapes of its SVG with their places, in the font that is built in.

pub mod looks;
pub mod points;
pub mod sweeps;
mod words;

use resvg::usvg::{Group, Node, Options, Paint, Rect, Tree};
use twinslip_output::plot::{Axis, Drawing, Panel};

pub const INK: [u8; 3] = [40, 40, 40];
pub const GRID: [u8; 3] = [228, 228, 228];
pub const PAPER: [u8; 3] = [255, 255, 255];
pub const BLUE: [u8; 3] = [0, 114, 178];

/// A line or an area.
#[derive(Debug, Clone, Copy)]
pub struct Shape {
    pub stroke: Option<[u8; 3]>,
    pub fill: Option<[u8; 3]>,
    /// Without the breadth of the line.
    pub place: Rect,
}

pub struct Seen {
    pub width: f32,
    pub height: f32,
    pub words: Vec<(String, Rect)>,
    pub shapes: Vec<Shape>,
    /// Of all words but subscripts.
    pub sizes: Vec<f32>,
}

pub fn seen(drawing: &Drawing) -> Seen {
    let svg = drawing.svg().expect("a picture");
    let tree = Tree::from_str(&svg, &Options::default()).expect("SVG");
    let words = words::words(&svg);
    let mut seen = Seen {
        width: tree.size().width(),
        height: tree.size().height(),
        sizes: words.iter().map(|words| words.size).collect(),
        words: words
            .into_iter()
            .map(|words| (words.text, words.place))
            .collect(),
        shapes: Vec::new(),
    };
    seen.collect(tree.root());
    seen
}

fn rgb(paint: &Paint) -> [u8; 3] {
    match paint {
        Paint::Color(colour) => [colour.red, colour.green, colour.blue],
        other => panic!("{other:?}"),
    }
}

impl Seen {
    fn collect(&mut self, group: &Group) {
        for node in group.children() {
            match node {
                Node::Group(group) => self.collect(group),
                Node::Path(path) => self.shapes.push(Shape {
                    stroke: path.stroke().map(|stroke| rgb(stroke.paint())),
                    fill: path.fill().map(|fill| rgb(fill.paint())),
                    place: path.abs_bounding_box(),
                }),
                // Words are read from the SVG itself.
                Node::Text(_) => {}
                Node::Image(_) => panic!("an image"),
            }
        }
    }

    /// The frames: the only lines in ink that enclose something.
    pub fn frames(&self) -> Vec<Rect> {
        let ink = self
            .shapes
            .iter()
            .filter(|shape| shape.stroke == Some(INK) && shape.fill.is_none());
        ink.map(|shape| shape.place)
            .filter(|place| place.width() > 50.0 && place.height() > 50.0)
            .collect()
    }

    pub fn says(&self, words: &str) -> bool {
        self.words.iter().any(|(text, _)| text == words)
    }

    /// Of a picture shown as broad as this, or in its own size where that is smaller.
    pub fn assert_readable(&self, shown: f32, least: f32) {
        let scale = (shown / self.width).min(1.0);
        let smallest = self.sizes.iter().copied().fold(f32::INFINITY, f32::min);
        assert!(
            scale * smallest >= least,
            "words of {} pixels at {shown} of {}",
            scale * smallest,
            self.width
        );
    }

    /// Words stand apart from each other and within the picture.
    pub fn assert_legible(&self) {
        for (i, (text, a)) in self.words.iter().enumerate() {
            let within = a.left() >= 0.0
                && a.top() >= 0.0
                && a.right() <= self.width
                && a.bottom() <= self.height;
            assert!(within, "{text:?} leaves the picture: {a:?}");
            for (other, b) in &self.words[..i] {
                let apart = a.left() >= b.right()
                    || b.left() >= a.right()
                    || a.top() >= b.bottom()
                    || b.top() >= a.bottom();
                assert!(apart, "{text:?} at {a:?} covers {other:?} at {b:?}");
            }
        }
    }
}

/// A picture of one panel.
pub fn alone(panel: Panel) -> Drawing {
    Drawing::columns(vec![vec![panel]])
}

/// A panel whose axes go from 0 to 1.
pub fn unit(title: &str) -> Panel {
    let axis = |name: &str| Axis::linear(name).within(0.0, 1.0);
    Panel::new(title, axis("x"), axis("y"))
}

/// Equally spaced.
pub fn numbers(from: f64, to: f64, many: usize) -> Vec<f64> {
    let step = (to - from) / (many - 1) as f64;
    (0..many).map(|i| from + step * i as f64).collect()
}
