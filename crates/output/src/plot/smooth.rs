//! Curves through the points of their rows: cubic Hermite pieces along the length of the chords instead of straight lines, so that a
//! curve followed in long steps has no corners that the solution doesn't have.

use super::clip::Point;

/// Distance of the points that are put in, in pixels.
const SPACING: f64 = 3.0;
/// A piece that stays as near as this to its chord, in pixels, is straight.
const STRAIGHT: f64 = 0.05;
/// Points nearer than this, in pixels, are one: the direction between them is rounding.
const SAME: f64 = 1e-3;
/// Points that are put into one piece, at most.
const MOST: f64 = 256.0;

/// The points with others between them where the curve turns. It breaks at points that can't be drawn, and where `left_out` has
/// the number of the point before; but its direction there is that of the whole curve.
///
/// At each point the direction is that of the parabola through it and its neighbours. Where a coordinate only grows or only falls
/// it is limited so that it does between the points too (Fritsch and Carlson 1980), and what is flat stays flat: nothing
/// overshoots.
pub fn smooth(points: &[Point], per_pixel: Point, left_out: &[bool]) -> Vec<Point> {
    const BREAK: Point = (f64::NAN, f64::NAN);
    let finite = |p: &Point| p.0.is_finite() && p.1.is_finite();
    let mut all = Vec::with_capacity(points.len());
    let mut start = 0;
    for run in points.chunk_by(|a, b| finite(a) == finite(b)) {
        if finite(&run[0]) {
            let hidden = |i: usize| left_out.get(start + i) == Some(&true);
            piece(run, per_pixel, &hidden, &mut all);
        }
        all.push(BREAK);
        start += run.len();
    }
    all
}

/// A stretch without points that can't be drawn.
fn piece(run: &[Point], per_pixel: Point, hidden: &dyn Fn(usize) -> bool, all: &mut Vec<Point>) {
    let pixel = |p: Point| (p.0 / per_pixel.0, p.1 / per_pixel.1);
    // The numbers of the points that differ from the one before.
    let mut kept: Vec<usize> = vec![0];
    for i in 1..run.len() {
        let (a, b) = (pixel(run[kept[kept.len() - 1]]), pixel(run[i]));
        if (b.0 - a.0).hypot(b.1 - a.1) > SAME {
            kept.push(i);
        }
    }
    let at: Vec<Point> = kept.iter().map(|&i| pixel(run[i])).collect();
    let chords: Vec<Chord> = at
        .windows(2)
        .map(|pair| Chord::new(pair[0], pair[1]))
        .collect();
    if chords.is_empty() {
        all.push(run[0]);
    }
    let mut goes_on = false;
    for (k, chord) in chords.iter().enumerate() {
        let (from, to) = (kept[k], kept[k + 1]);
        if (from..to).any(hidden) {
            all.push((f64::NAN, f64::NAN));
            goes_on = false;
            continue;
        }
        if !goes_on {
            all.push(run[from]);
            goes_on = true;
        }
        let before = k.checked_sub(1).map(|i| &chords[i]);
        let after = chords.get(k + 1);
        let second = chords.get(k + 2);
        let start = direction(before, chord, after);
        let end = match after {
            Some(after) => direction(Some(chord), after, second),
            None => backwards(direction(
                None,
                &chord.reversed(),
                before.map(Chord::reversed).as_ref(),
            )),
        };
        for t in chord.parts(start, end) {
            let (x, y) = chord.at(t, start, end);
            all.push((x * per_pixel.0, y * per_pixel.1));
        }
        all.push(run[to]);
    }
}

fn backwards((x, y): Point) -> Point {
    (-x, -y)
}

/// From a point to the next one, in pixels.
struct Chord {
    from: Point,
    length: f64,
    /// Of length one.
    direction: Point,
}

impl Chord {
    fn new(from: Point, to: Point) -> Self {
        let step = (to.0 - from.0, to.1 - from.1);
        let length = step.0.hypot(step.1);
        Chord {
            from,
            length,
            direction: (step.0 / length, step.1 / length),
        }
    }

    fn reversed(&self) -> Self {
        let (x, y) = self.direction;
        Chord {
            from: (self.from.0 + self.length * x, self.from.1 + self.length * y),
            length: self.length,
            direction: (-x, -y),
        }
    }

    /// Where points are put in, as parts of the chord; nowhere if it is as good as straight.
    fn parts(&self, start: Point, end: Point) -> impl Iterator<Item = f64> + use<> {
        let off = |m: Point| (m.0 - self.direction.0).hypot(m.1 - self.direction.1);
        // The largest value of t (1 - t)^2 is 4/27.
        let away = 4.0 / 27.0 * self.length * (off(start) + off(end));
        let many = if away > STRAIGHT {
            (self.length / SPACING).ceil().min(MOST)
        } else {
            1.0
        };
        (1..many as usize).map(move |i| i as f64 / many)
    }

    /// On the cubic with these directions at its ends.
    fn at(&self, t: f64, start: Point, end: Point) -> Point {
        let s = 1.0 - t;
        let of = |from: f64, d: f64, a: f64, b: f64| {
            let step = t * t * (3.0 - 2.0 * t) * d + t * s * s * a - t * t * s * b;
            from + self.length * step
        };
        (
            of(self.from.0, self.direction.0, start.0, end.0),
            of(self.from.1, self.direction.1, start.1, end.1),
        )
    }
}

/// The direction at the start of a chord between its neighbours: of the parabola in the length of the chords. At the end of a curve
/// that of the parabola through the last three points.
fn direction(before: Option<&Chord>, chord: &Chord, after: Option<&Chord>) -> Point {
    let each = |of: fn(&Chord) -> f64| -> f64 {
        let d = of(chord);
        match (before, after) {
            (Some(before), _) => {
                let (h, g) = (before.length, chord.length);
                limited((g * of(before) + h * d) / (h + g), of(before), d)
            }
            (None, Some(after)) => {
                let (h, g) = (chord.length, after.length);
                let inner = (g * d + h * of(after)) / (h + g);
                // Past the first chord as far as the next point turns away from it.
                limited(2.0 * d - inner, d, d)
            }
            (None, None) => d,
        }
    };
    (
        each(|chord| chord.direction.0),
        each(|chord| chord.direction.1),
    )
}

/// A slope between those of two chords that doesn't overshoot.
fn limited(slope: f64, a: f64, b: f64) -> f64 {
    /// At a highest or lowest point the true one lies a little beside: the curve may go past the point as steeply as this.
    const BESIDE: f64 = 0.15;
    let beside = if a * b < 0.0 { BESIDE } else { 0.0 };
    let most = 3.0 * a.abs().min(b.abs()) + beside;
    let slope = slope.clamp(-most, most);
    // Where both rise or both fall, so does the curve.
    if a * b > 0.0 && slope * a < 0.0 {
        0.0
    } else {
        slope
    }
}

#[cfg(test)]
mod test {
    use super::*;

    const PIXELS: Point = (1.0, 1.0);

    fn circle(many: usize, part: f64) -> Vec<Point> {
        let angle = |i: usize| part * std::f64::consts::TAU * i as f64 / many as f64;
        let at = |i| (100.0 * f64::cos(angle(i)), 100.0 * f64::sin(angle(i)));
        (0..=many).map(at).collect()
    }

    /// Twelve straight pieces around a circle are off by 3.4 %.
    #[test]
    fn few_points_of_a_circle_are_a_circle() {
        let points = circle(12, 0.9);
        let drawn = smooth(&points, PIXELS, &[]);
        let drawn: Vec<Point> = drawn.into_iter().filter(|p| !p.0.is_nan()).collect();
        assert!(drawn.len() > 100);
        for (x, y) in &drawn {
            assert!((x.hypot(*y) - 100.0).abs() < 0.9, "{x}, {y}");
        }
        for three in drawn.windows(3) {
            let step = |a: Point, b: Point| (b.0 - a.0, b.1 - a.1);
            let (a, b) = (step(three[0], three[1]), step(three[1], three[2]));
            let turn = (a.0 * b.1 - a.1 * b.0).atan2(a.0 * b.0 + a.1 * b.1);
            assert!(turn.abs() < 0.1, "a corner of {turn} at {:?}", three[1]);
        }
    }

    #[test]
    fn steps_and_plateaus_do_not_overshoot() {
        let points = [
            (0.0, 0.0),
            (50.0, 0.0),
            (60.0, 100.0),
            (110.0, 100.0),
            (200.0, 130.0),
        ];
        let drawn = smooth(&points, PIXELS, &[]);
        let drawn: Vec<Point> = drawn.into_iter().filter(|p| !p.0.is_nan()).collect();
        for pair in drawn.windows(2) {
            assert!(pair[1].0 >= pair[0].0 - 1e-9 && pair[1].1 >= pair[0].1 - 1e-9);
        }
        let flat = drawn.iter().filter(|p| p.0 <= 50.0);
        assert!(flat.into_iter().all(|p| p.1 == 0.0));
        for point in points {
            assert!(drawn.contains(&point), "{point:?}");
        }
    }

    #[test]
    fn straight_lines_stay_as_they_are_and_breaks_remain() {
        let line = [(0.0, 0.0), (100.0, 50.0), (100.0, 50.0), (200.0, 100.0)];
        let drawn = smooth(&line, PIXELS, &[]);
        assert_eq!(drawn[..3], [line[0], line[1], line[3]]);
        let broken = [
            (0.0, 0.0),
            (9.0, 0.0),
            (f64::NAN, 0.0),
            (0.0, 9.0),
            (9.0, 9.0),
        ];
        let drawn = smooth(&broken, PIXELS, &[]);
        let pieces = drawn
            .split(|p| p.0.is_nan())
            .filter(|piece| !piece.is_empty());
        assert_eq!(pieces.count(), 2);
    }

    /// What is left out still says where the curve comes from.
    #[test]
    fn parts_of_a_curve_go_on_into_one_another() {
        let points = circle(12, 0.9);
        let whole = smooth(&points, PIXELS, &[]);
        let mut left_out = vec![false; points.len()];
        left_out[..5].fill(true);
        let part = smooth(&points, PIXELS, &left_out);
        let part: Vec<Point> = part.into_iter().filter(|p| p.0.is_finite()).collect();
        let last = whole.iter().filter(|p| p.0.is_finite()).count() - 1;
        let tail: Vec<Point> = whole.into_iter().filter(|p| p.0.is_finite()).collect();
        let from = tail.iter().position(|p| *p == points[5]).unwrap();
        assert_eq!(part[part.len() - (last - from) - 1..], tail[from..]);
    }
}
