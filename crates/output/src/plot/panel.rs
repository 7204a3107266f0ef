//! What a picture consists of: maps, curves, points and words on a pair of axes, and the panels in their blocks. Colours are numbers:
//! 0 blue, 1 vermillion, 2 green, 3 purple, 4 sky blue, 5 orange, 6 grey, 7 black (Okabe and Ito, told apart by all).

/// One axis.
#[derive(Debug, Clone, PartialEq)]
pub struct Axis {
    /// What it measures, with the unit.
    pub label: String,
    /// Whether it is logarithmic: points that are not positive are then left out.
    pub log: bool,
    /// Its ends, beyond which nothing is drawn; without, it holds all that is shown.
    pub range: Option<(f64, f64)>,
}

impl Axis {
    /// Equal steps are equal differences.
    pub fn linear(label: impl Into<String>) -> Self {
        Axis {
            label: label.into(),
            log: false,
            range: None,
        }
    }

    /// Equal steps are equal ratios.
    pub fn log(label: impl Into<String>) -> Self {
        Axis {
            log: true,
            ..Axis::linear(label)
        }
    }

    /// With fixed ends. Ends that can't be drawn, as zero on a logarithmic axis, are as none.
    #[must_use]
    pub fn within(mut self, lo: f64, hi: f64) -> Self {
        self.range = Some((lo, hi));
        self
    }
}

/// How a line is broken.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub enum Stroke {
    /// Not at all.
    #[default]
    Solid,
    /// Into dashes.
    Dashed,
    /// A dash and a dot in turn.
    DashDot,
    /// A dash and two dots in turn.
    DashDotDot,
    /// Into dots.
    Dotted,
}

/// One curve, drawn smoothly through its points, or points alone.
#[derive(Debug, Clone, PartialEq)]
pub struct PlotSeries {
    /// Its name in the legend; empty for none.
    pub label: String,
    /// Abscissae.
    pub x: Vec<f64>,
    /// Ordinates.
    pub y: Vec<f64>,
    /// Whether its points stand for themselves, without a line.
    pub dots: bool,
    /// How its line is broken.
    pub stroke: Stroke,
    /// Whether its line, or its points, are broader than the others.
    pub wide: bool,
    /// Which of the colours; the next one without.
    pub colour: Option<usize>,
    /// Stretches that are not drawn, by the number of the point at which they begin; the others are drawn as parts of the whole curve.
    /// None if it is empty.
    pub left_out: Vec<bool>,
}

impl PlotSeries {
    /// From two columns.
    pub fn new(label: impl Into<String>, x: Vec<f64>, y: Vec<f64>) -> Self {
        PlotSeries {
            label: label.into(),
            x,
            y,
            dots: false,
            stroke: Stroke::Solid,
            wide: false,
            colour: None,
            left_out: Vec::new(),
        }
    }

    /// Points without a line between them.
    pub fn dots(label: impl Into<String>, x: Vec<f64>, y: Vec<f64>) -> Self {
        PlotSeries {
            dots: true,
            ..PlotSeries::new(label, x, y)
        }
    }

    /// With the line broken so.
    #[must_use]
    pub fn stroke(mut self, stroke: Stroke) -> Self {
        self.stroke = stroke;
        self
    }

    /// In that colour.
    #[must_use]
    pub fn colour(mut self, number: usize) -> Self {
        self.colour = Some(number);
        self
    }

    /// Broader than the others.
    #[must_use]
    pub fn wide(mut self) -> Self {
        self.wide = true;
        self
    }
}

/// The area between two curves, behind all curves.
#[derive(Debug, Clone, PartialEq)]
pub struct Area {
    /// Its name in the legend; empty for none. Areas of one name share an entry.
    pub label: String,
    /// Abscissae.
    pub x: Vec<f64>,
    /// Ordinates of its lower side.
    pub lower: Vec<f64>,
    /// Ordinates of its upper side.
    pub upper: Vec<f64>,
    /// Which of the colours.
    pub colour: usize,
    /// Stretches that are not drawn, as of a curve.
    pub left_out: Vec<bool>,
}

/// Between which values a point may be.
#[derive(Debug, Clone, Copy, Default, PartialEq)]
pub struct Bars {
    /// Abscissae.
    pub x: Option<(f64, f64)>,
    /// Ordinates.
    pub y: Option<(f64, f64)>,
}

/// Where the name of a point stands.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Side {
    /// Above it.
    Above,
    /// Below it.
    Below,
    /// Where there is room.
    Free,
}

/// The shape of a point.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub enum Symbol {
    /// ●
    #[default]
    Circle,
    /// ■
    Square,
    /// ◆
    Diamond,
    /// ▲
    Triangle,
    /// +, always a line
    Plus,
    /// ×, always a line
    Cross,
    /// ★
    Star,
    /// A small ●, to tie a name to a place
    Dot,
}

/// A point that is pointed out.
#[derive(Debug, Clone, PartialEq)]
pub struct Mark {
    /// Abscissa.
    pub x: f64,
    /// Ordinate.
    pub y: f64,
    /// Its name; empty for none.
    pub label: String,
    /// Where that stands: outside of the curve's bend.
    pub side: Side,
    /// Its shape.
    pub symbol: Symbol,
    /// Whether the shape is filled, or white within.
    pub filled: bool,
    /// Which of the colours; dark red without.
    pub colour: Option<usize>,
    /// Whether the curves are drawn over it.
    pub behind: bool,
    /// Between which values it may be.
    pub bars: Bars,
}

impl Mark {
    /// A filled circle, its name where there is room.
    pub fn new(x: f64, y: f64, label: impl Into<String>) -> Self {
        Mark {
            x,
            y,
            label: label.into(),
            side: Side::Free,
            symbol: Symbol::Circle,
            filled: true,
            colour: None,
            behind: false,
            bars: Bars::default(),
        }
    }

    /// With that shape.
    #[must_use]
    pub fn symbol(mut self, symbol: Symbol) -> Self {
        self.symbol = symbol;
        self
    }

    /// White within.
    #[must_use]
    pub fn open(mut self) -> Self {
        self.filled = false;
        self
    }

    /// Below the curves.
    #[must_use]
    pub fn behind(mut self) -> Self {
        self.behind = true;
        self
    }

    /// With its name there.
    #[must_use]
    pub fn side(mut self, side: Side) -> Self {
        self.side = side;
        self
    }

    /// In that colour.
    #[must_use]
    pub fn colour(mut self, number: usize) -> Self {
        self.colour = Some(number);
        self
    }
}

/// What a kind of [`Mark`] means, in the legend.
#[derive(Debug, Clone, PartialEq)]
pub struct Key {
    /// Its shape.
    pub symbol: Symbol,
    /// Whether that is filled.
    pub filled: bool,
    /// Which of the colours; dark red without.
    pub colour: Option<usize>,
    /// The meaning.
    pub label: String,
}

/// Words at a place, as the name of a region; near it, if there they would cover a curve.
#[derive(Debug, Clone, PartialEq)]
pub struct Note {
    /// Abscissa of their middle.
    pub x: f64,
    /// Ordinate of their middle.
    pub y: f64,
    /// The words.
    pub text: String,
    /// Which of the colours; that of the axes without.
    pub colour: Option<usize>,
}

impl Note {
    /// In the colour of the axes.
    pub fn new(x: f64, y: f64, text: impl Into<String>) -> Self {
        Note {
            x,
            y,
            text: text.into(),
            colour: None,
        }
    }
}

/// What fills an area: a colour, mixed with white.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Shade {
    /// Red, green, blue.
    pub colour: [u8; 3],
    /// From 0, the colour, to 1, white.
    pub lightness: f64,
}

impl Shade {
    /// The colour as it is.
    pub const fn new(colour: [u8; 3]) -> Self {
        Shade {
            colour,
            lightness: 0.0,
        }
    }

    /// Mixed with white.
    #[must_use]
    pub fn lighter(mut self, lightness: f64) -> Self {
        self.lightness = lightness;
        self
    }
}

/// What shades mean, in the legend.
#[derive(Debug, Clone, PartialEq)]
pub struct Swatch {
    /// Squares side by side; none for words alone.
    pub shades: Vec<Shade>,
    /// The meaning.
    pub label: String,
}

/// A map: the cells of a grid, filled, behind all curves.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct Cells {
    /// Abscissae of the edges, growing, one more than there are columns.
    pub x_edges: Vec<f64>,
    /// Ordinates of the edges, growing, one more than there are rows.
    pub y_edges: Vec<f64>,
    /// What fills each cell, the lowest row first, each from left to right: nothing, one shade, or several in stripes.
    pub fills: Vec<Vec<Shade>>,
    /// Their entries in the legend.
    pub swatches: Vec<Swatch>,
}

/// One pair of axes with curves.
#[derive(Debug, Clone, PartialEq)]
pub struct Panel {
    /// Above the frame.
    pub title: String,
    /// Horizontal.
    pub x: Axis,
    /// Vertical.
    pub y: Axis,
    /// A map behind the curves.
    pub cells: Option<Cells>,
    /// Areas behind the curves.
    pub areas: Vec<Area>,
    /// The curves.
    pub series: Vec<PlotSeries>,
    /// The points.
    pub marks: Vec<Mark>,
    /// Words in the frame.
    pub notes: Vec<Note>,
    /// Entries of the legend after those of the curves.
    pub keys: Vec<Key>,
    /// Entries of the legend for what several curves have in common, as a stroke: in the colour of the axes.
    pub strokes: Vec<(Stroke, String)>,
    /// Whether zero on the vertical axis deserves a line.
    pub zero_line: bool,
}

impl Panel {
    /// Without any curves yet.
    pub fn new(title: impl Into<String>, x: Axis, y: Axis) -> Self {
        Panel {
            title: title.into(),
            x,
            y,
            cells: None,
            areas: Vec::new(),
            series: Vec::new(),
            marks: Vec::new(),
            notes: Vec::new(),
            keys: Vec::new(),
            strokes: Vec::new(),
            zero_line: false,
        }
    }
}

/// Panels under a common title, in columns from left to right, each from top to bottom.
#[derive(Debug, Clone, PartialEq)]
pub struct Block {
    /// Above them all; empty for none.
    pub title: String,
    /// The panels.
    pub columns: Vec<Vec<Panel>>,
}
