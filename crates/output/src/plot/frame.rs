//! The frame of a panel on the picture, with its axes: where values are drawn, the grid, ticks and names of the axes.

use super::canvas::{Align, Canvas, GRID, INK, Pixel};
use super::clip::{Point, Window};
use super::scale::Scale;
use super::text::{self, TEXT};
use super::ticks::{Tick, Ticks};

/// Lengths of ticks with a label and without.
const TICK: f64 = 4.0;
const SMALL_TICK: f64 = 2.5;
/// Room between the frame and the labels of ticks.
pub const AIR: f64 = 8.0;
/// Least room between the labels of ticks side by side.
const BESIDE: f64 = 10.0;
/// Least distance of labels one below the other.
const BELOW: f64 = 18.0;
/// Middle of the horizontal labels below the frame.
const LABELS: f64 = 16.5;
/// Where the name of the horizontal axis begins below the frame.
const NAME: f64 = 28.0;
/// Breadths of the frame, of grid lines and of the line at zero.
const BORDER: f64 = 0.9;
const GRID_LINE: f64 = 0.8;
const ZERO_LINE: f64 = 0.7;

/// The frame with its axes.
#[derive(Debug, Clone, PartialEq)]
pub struct Frame {
    inside: Window,
    x: Scale,
    y: Scale,
    ticks: (Ticks, Ticks),
}

/// The ticks of a horizontal axis that wide.
pub fn horizontal(scale: &Scale, width: f64) -> Ticks {
    Ticks::fitting(scale, width, |ticks| {
        ticks.windows(2).all(|pair| {
            let half = |tick: &Tick| 0.5 * label_width(tick);
            let apart = (scale.part(pair[1].at) - scale.part(pair[0].at)) * width;
            apart >= half(&pair[0]) + half(&pair[1]) + BESIDE
        })
    })
}

/// Those of a vertical one that high, with labels not wider than `limit`.
pub fn vertical(scale: &Scale, height: f64, limit: f64) -> Ticks {
    Ticks::fitting(scale, height, |ticks| {
        let apart = |pair: &[Tick]| (scale.part(pair[1].at) - scale.part(pair[0].at)) * height;
        ticks.windows(2).all(|pair| apart(pair) >= BELOW)
            && ticks.iter().all(|tick| label_width(tick) <= limit)
    })
}

/// The width of the widest label.
pub fn widest(ticks: &Ticks) -> f64 {
    ticks.named.iter().map(label_width).fold(0.0, f64::max)
}

fn label_width(tick: &Tick) -> f64 {
    // What can't be measured will fail when it is drawn.
    text::width(&tick.label, TEXT)
}

/// How much room the horizontal axis needs below the frame, with a name of so many lines.
pub fn below(lines: usize) -> f64 {
    NAME + text::height(lines, TEXT) + 3.0
}

impl Frame {
    /// With the ticks that have room; vertical labels not wider than `limit`. An axis without a name has none.
    pub fn new(inside: Window, (x, y): (Scale, Scale), named: (bool, bool), limit: f64) -> Self {
        let width = inside.x.1 - inside.x.0;
        let height = inside.y.1 - inside.y.0;
        Frame {
            inside,
            x,
            y,
            ticks: (
                Some(horizontal(&x, width))
                    .filter(|_| named.0)
                    .unwrap_or_default(),
                Some(vertical(&y, height, limit))
                    .filter(|_| named.1)
                    .unwrap_or_default(),
            ),
        }
    }

    /// Its inside on the picture.
    pub fn inside(&self) -> &Window {
        &self.inside
    }

    /// Its axes, horizontal and vertical.
    pub fn scales(&self) -> (&Scale, &Scale) {
        (&self.x, &self.y)
    }

    /// Its inside in the coordinates of the axes.
    pub fn window(&self) -> Window {
        Window {
            x: (self.x.lo, self.x.hi),
            y: (self.y.lo, self.y.hi),
        }
    }

    /// Values in the coordinates of the axes; not finite if they can't be drawn.
    pub fn coordinates(&self, x: f64, y: f64) -> Point {
        (self.x.at(x), self.y.at(y))
    }

    /// Where coordinates are on the picture.
    pub fn pixel(&self, (x, y): Point) -> Pixel {
        let ((left, right), (top, bottom)) = (self.inside.x, self.inside.y);
        (
            left + self.x.part(x) * (right - left),
            bottom - self.y.part(y) * (bottom - top),
        )
    }

    /// Where values are drawn, if within the frame.
    pub fn place(&self, x: f64, y: f64) -> Option<Pixel> {
        let at = self.coordinates(x, y);
        self.window().holds(at).then(|| self.pixel(at))
    }

    /// Coordinates per pixel.
    pub fn per_pixel(&self) -> Point {
        let Window { x, y } = self.inside;
        (
            (self.x.hi - self.x.lo) / (x.1 - x.0),
            (self.y.hi - self.y.lo) / (y.1 - y.0),
        )
    }

    /// What lies behind the curves.
    pub fn draw_grid(&self, canvas: &Canvas, zero_line: bool) {
        let Window { x, y } = self.inside;
        for tick in &self.ticks.0.named {
            let (at, _) = self.pixel((tick.at, self.y.lo));
            canvas.line(&[(at, y.0), (at, y.1)], GRID, GRID_LINE);
        }
        for tick in &self.ticks.1.named {
            let (_, at) = self.pixel((self.x.lo, tick.at));
            canvas.line(&[(x.0, at), (x.1, at)], GRID, GRID_LINE);
        }
        let zero = self.y.at(0.0);
        if zero_line && zero >= self.y.lo && zero <= self.y.hi {
            let (_, at) = self.pixel((self.x.lo, zero));
            canvas.line(&[(x.0, at), (x.1, at)], INK, ZERO_LINE);
        }
    }

    /// The frame itself with ticks and their labels.
    pub fn draw_border(&self, canvas: &Canvas) {
        let mut border = self.inside.corners().to_vec();
        border.push(border[0]);
        canvas.line(&border, INK, BORDER);
        let (left, bottom) = (self.inside.x.0, self.inside.y.1);
        let below = |at: f64, length| {
            let (at, _) = self.pixel((at, self.y.lo));
            canvas.line(&[(at, bottom), (at, bottom + length)], INK, BORDER)
        };
        let beside = |at: f64, length| {
            let (_, at) = self.pixel((self.x.lo, at));
            canvas.line(&[(left - length, at), (left, at)], INK, BORDER)
        };
        for tick in &self.ticks.0.named {
            below(tick.at, TICK);
            let at = (self.pixel((tick.at, self.y.lo)).0, bottom + LABELS);
            canvas.words(&tick.label, at, Align::Middle, TEXT, INK);
        }
        for tick in &self.ticks.1.named {
            beside(tick.at, TICK);
            let at = (left - AIR, self.pixel((self.x.lo, tick.at)).1);
            canvas.words(&tick.label, at, Align::Right, TEXT, INK);
        }
        let small = self.ticks.0.small.iter();
        small.for_each(|&at| below(at, SMALL_TICK));
        let small = self.ticks.1.small.iter();
        small.for_each(|&at| beside(at, SMALL_TICK))
    }

    /// The names of the axes, the vertical one with its first line at `left`.
    pub fn draw_names(&self, canvas: &Canvas, (x, y): (&[String], &[String]), left: f64) {
        let middle = |(a, b): (f64, f64)| 0.5 * (a + b);
        let line = |i: usize| text::height(1, TEXT) * (i as f64 + 0.5);
        for (i, name) in x.iter().enumerate() {
            let at = (middle(self.inside.x), self.inside.y.1 + NAME + line(i));
            canvas.words(name, at, Align::Middle, TEXT, INK);
        }
        for (i, name) in y.iter().enumerate() {
            let at = (left + line(i), middle(self.inside.y));
            canvas.words(name, at, Align::Upwards, TEXT, INK);
        }
    }
}
