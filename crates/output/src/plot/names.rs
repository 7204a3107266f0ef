//! Where the names of points stand: where they cover neither each other nor the curves nor other words, as near as that allows.

use super::Side;
use super::canvas::Pixel;
use super::clip::Window;

/// A point with the size of its name.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Named {
    /// The point.
    pub at: Pixel,
    /// Width and height of the name.
    pub size: (f64, f64),
    /// Where it may stand.
    pub side: Side,
}

/// Gaps between a point and its name that are tried.
const GAPS: [f64; 6] = [6.0, 16.0, 28.0, 42.0, 60.0, 82.0];
/// Directions that are tried, the most usual first.
const DIRECTIONS: [(f64, f64); 16] = [
    (0.0, -1.0),
    (0.0, 1.0),
    (0.7, -0.7),
    (-0.7, -0.7),
    (0.7, 0.7),
    (-0.7, 0.7),
    (1.0, 0.0),
    (-1.0, 0.0),
    (0.4, -0.9),
    (-0.4, -0.9),
    (0.4, 0.9),
    (-0.4, 0.9),
    (0.9, -0.4),
    (-0.9, -0.4),
    (0.9, 0.4),
    (-0.9, 0.4),
];
/// Price of standing below though it should stand above, or the other way round; less than that of leaving the frame.
const WRONG: f64 = 500.0;
/// Price of covering another name.
const NAME: f64 = 1000.0;
/// Of leaving the frame.
const FRAME: f64 = 1000.0;
/// Of covering another point, or a part of its symbol, half as large as this.
const POINT: f64 = 200.0;
const SYMBOL: f64 = 5.0;
/// Of a tie across a name, or of ties that cross.
const TIE: f64 = 400.0;
/// Of covering a stretch of curve.
const CURVE: f64 = 12.0;
/// Price of a pixel of distance.
const FAR: f64 = 0.25;
/// Of being later in the list of directions.
const UNUSUAL: f64 = 0.05;

/// The centres of the names, in order; `curves` are points along all curves, densely, and `words` the middles and sizes of
/// what is written in the frame already. A name of no size takes no room. All names lie within the frame if they can.
pub fn placed(
    names: &[Named],
    curves: &[Pixel],
    words: &[(Pixel, (f64, f64))],
    frame: &Window,
) -> Vec<Pixel> {
    let area = |&(centre, size): &(Pixel, (f64, f64))| Area {
        centre,
        half: half(size),
    };
    let mut taken: Vec<Area> = words.iter().map(area).collect();
    let mut ties: Vec<(Pixel, Pixel)> = Vec::new();
    let mut centres = Vec::new();
    for (i, name) in names.iter().enumerate() {
        let other = |&(j, _): &(usize, &Named)| j != i;
        let points = names.iter().enumerate().filter(other);
        let around = Obstacles {
            taken: &taken,
            ties: &ties,
            points: points.map(|(_, other)| other.at).collect(),
            curves,
            frame,
        };
        // A name of no size needs no place.
        let candidates = candidates(name).into_iter().enumerate();
        let best = candidates
            .filter(|_| name.size != (0.0, 0.0))
            .map(|(number, place)| (around.price(name, number, &place), place))
            .min_by(|a, b| a.0.total_cmp(&b.0));
        match best {
            Some((_, mut place)) => {
                place.centre = frame.without(place.half).nearest(place.centre);
                centres.push(place.centre);
                ties.push((name.at, place.centre));
                taken.push(place);
            }
            None => centres.push(name.at),
        }
    }
    centres
}

/// What a name should not cover.
struct Obstacles<'a> {
    taken: &'a [Area],
    /// From the points to the middles of their names.
    ties: &'a [(Pixel, Pixel)],
    points: Vec<Pixel>,
    curves: &'a [Pixel],
    frame: &'a Window,
}

impl Obstacles<'_> {
    /// What the candidate of that number costs.
    fn price(&self, name: &Named, number: usize, place: &Area) -> f64 {
        let on = |places: &[Pixel]| places.iter().filter(|&&at| place.holds(at)).count() as f64;
        let symbols: Vec<Area> = self.points.iter().map(|&at| Area::symbol(at)).collect();
        let met = symbols.iter().filter(|other| place.meets(other)).count();
        let tie = (name.at, place.centre);
        // Symbols upon that of the name are in the way of every tie.
        let apart = symbols
            .iter()
            .filter(|other| !other.meets(&Area::symbol(name.at)));
        let others = self.taken.iter().chain(apart);
        let ties = self.ties.iter();
        let crossed = others.filter(|other| other.crossed(tie)).count()
            + ties
                .filter(|&&other| place.crossed(other) || cross(other, tie))
                .count();
        let covered = self.taken.iter().filter(|other| place.meets(other)).count() as f64;
        let outside = f64::from(u8::from(!place.within(self.frame)));
        let (dx, dy) = (place.centre.0 - name.at.0, place.centre.1 - name.at.1);
        let wrong = match name.side {
            Side::Above => dy > 0.0,
            Side::Below => dy < 0.0,
            Side::Free => false,
        };
        NAME * covered
            + FRAME * outside
            + POINT * met as f64
            + TIE * crossed as f64
            + CURVE * on(self.curves)
            + FAR * dx.hypot(dy)
            + UNUSUAL * number as f64
            + WRONG * f64::from(u8::from(wrong))
    }
}

fn half(size: (f64, f64)) -> (f64, f64) {
    (0.5 * size.0, 0.5 * size.1)
}

fn candidates(name: &Named) -> Vec<Area> {
    let directions = match name.side {
        Side::Above | Side::Below => &DIRECTIONS[..2],
        Side::Free => &DIRECTIONS[..],
    };
    let gaps = match name.side {
        Side::Free => &GAPS[..],
        _ => &GAPS[..1],
    };
    let half = half(name.size);
    gaps.iter()
        .flat_map(|gap| directions.iter().map(move |direction| (gap, direction)))
        .map(|(gap, (dx, dy))| Area {
            centre: (
                name.at.0 + dx * gap + dx.signum() * half.0 * f64::from(u8::from(*dx != 0.0)),
                name.at.1 + dy * gap + dy.signum() * half.1 * f64::from(u8::from(*dy != 0.0)),
            ),
            half,
        })
        .collect()
}

/// The area of a name.
#[derive(Debug, Clone, Copy)]
struct Area {
    centre: Pixel,
    half: (f64, f64),
}

impl Area {
    fn symbol(centre: Pixel) -> Self {
        Area {
            centre,
            half: (SYMBOL, SYMBOL),
        }
    }

    fn meets(&self, other: &Area) -> bool {
        (self.centre.0 - other.centre.0).abs() < self.half.0 + other.half.0
            && (self.centre.1 - other.centre.1).abs() < self.half.1 + other.half.1
    }

    fn holds(&self, at: Pixel) -> bool {
        (self.centre.0 - at.0).abs() < self.half.0 && (self.centre.1 - at.1).abs() < self.half.1
    }

    /// By a line.
    fn crossed(&self, (a, b): (Pixel, Pixel)) -> bool {
        let inside = Window {
            x: (self.centre.0 - self.half.0, self.centre.0 + self.half.0),
            y: (self.centre.1 - self.half.1, self.centre.1 + self.half.1),
        };
        inside.segment(a, b).is_some()
    }

    fn within(&self, frame: &Window) -> bool {
        frame.without(self.half).holds(self.centre)
    }
}

/// Whether two lines cross.
fn cross((a, b): (Pixel, Pixel), (c, d): (Pixel, Pixel)) -> bool {
    let side = |a: Pixel, b: Pixel, p: Pixel| (b.0 - a.0) * (p.1 - a.1) - (b.1 - a.1) * (p.0 - a.0);
    side(a, b, c) * side(a, b, d) < 0.0 && side(c, d, a) * side(c, d, b) < 0.0
}

/// What words stand beside: the points of curves, other points, and the middles and sizes of words.
type Surroundings<'a> = (&'a [Pixel], &'a [Pixel], &'a [(Pixel, (f64, f64))]);

/// Where words of that size with their middle at a place cover neither curves nor points nor other words, as near as that allows.
pub fn beside(
    at: Pixel,
    size: (f64, f64),
    (curves, points, words): Surroundings<'_>,
    frame: &Window,
) -> Pixel {
    /// Distances that are tried.
    const STEP: f64 = 6.0;
    const RINGS: usize = 14;
    /// Price of standing beyond a curve, and how near a point of it is to the way there.
    const BEYOND: f64 = 400.0;
    const NEAR: f64 = 2.0;
    let half = half(size);
    let taken: Vec<Area> = words
        .iter()
        .map(|&(centre, (width, height))| Area {
            centre,
            half: (0.5 * width, 0.5 * height),
        })
        .collect();
    let ring = |ring: usize| {
        let around = DIRECTIONS.iter().filter(move |_| ring > 0);
        let far = STEP * ring as f64;
        around.map(move |(dx, dy)| (at.0 + far * dx, at.1 + far * dy))
    };
    let near = |&(x, y): &Pixel| {
        let mut seen = curves.iter();
        seen.any(|&(a, b)| (a - x).abs() < NEAR && (b - y).abs() < NEAR)
    };
    // What is named on a curve may stand on either side of it.
    let crossed = |from: Pixel, to: Pixel| {
        let way = along(&[from, to], NEAR);
        way.iter().skip_while(|&at| near(at)).any(near)
    };
    let places = std::iter::once(at).chain((1..=RINGS).flat_map(ring));
    let priced = places.map(|centre| {
        let place = Area { centre, half };
        let on = |places: &[Pixel]| places.iter().filter(|&&at| place.holds(at)).count() as f64;
        let covered = taken.iter().filter(|other| place.meets(other)).count() as f64;
        let outside = f64::from(u8::from(!place.within(frame)));
        let far = (centre.0 - at.0).hypot(centre.1 - at.1);
        // Beyond a curve the words would name another region.
        let crosses = f64::from(u8::from(far > 0.0 && crossed(at, centre)));
        let price = NAME * covered + FRAME * outside + POINT * on(points) + CURVE * on(curves);
        (price + BEYOND * crosses + FAR * far, centre)
    });
    let best = priced.min_by(|a, b| a.0.total_cmp(&b.0));
    best.map_or(at, |(_, centre)| centre)
}

/// Where the line from a point to the middle of its name, `off` away, meets the name; the point itself if it lies inside.
pub fn edge(off: (f64, f64), size: (f64, f64)) -> (f64, f64) {
    let inside = (0.5 * size.0 / off.0.abs()).min(0.5 * size.1 / off.1.abs());
    let part = (1.0 - inside).max(0.0);
    (part * off.0, part * off.1)
}

/// Points along a curve, no farther apart than this many pixels.
pub fn along(curve: &[Pixel], spacing: f64) -> Vec<Pixel> {
    let mut points: Vec<Pixel> = curve.first().copied().into_iter().collect();
    for pair in curve.windows(2) {
        let ((x, y), (to_x, to_y)) = (pair[0], pair[1]);
        let pieces = ((to_x - x).hypot(to_y - y) / spacing).ceil().max(1.0);
        points.extend((1..=pieces as usize).map(|i| {
            let part = i as f64 / pieces;
            (x + part * (to_x - x), y + part * (to_y - y))
        }));
    }
    points
}

#[cfg(test)]
mod test {
    use super::*;

    #[test]
    fn names_of_a_crowd_cover_neither_each_other_nor_the_curve() {
        let frame = Window {
            x: (0.0, 400.0),
            y: (0.0, 200.0),
        };
        let curve = along(&[(0.0, 100.0), (400.0, 100.0)], 3.0);
        let names: Vec<Named> = (0..9)
            .map(|i| Named {
                at: (200.0 + 5.0 * f64::from(i), 100.0),
                size: (24.0, 14.0),
                side: Side::Free,
            })
            .collect();
        let centres = placed(&names, &curve, &[], &frame);
        for (i, a) in centres.iter().enumerate() {
            assert!((a.1 - 100.0).abs() >= 7.0, "{a:?} is on the curve");
            assert!(a.0 > 12.0 && a.0 < 388.0 && a.1 > 7.0 && a.1 < 193.0);
            for b in &centres[..i] {
                let apart = (a.0 - b.0).abs() >= 24.0 || (a.1 - b.1).abs() >= 14.0;
                assert!(apart, "{a:?} covers {b:?}");
            }
        }
    }
}
