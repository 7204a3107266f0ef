//! Curves thinned to what the eye can see: a run of ten million steps is drawn with some ten thousand points.

use std::collections::HashSet;

/// In pixels; points nearer than this to the one before are not drawn.
const VISIBLE: f64 = 0.35;

/// Columns per pixel: narrower than a line is wide, so that a filled band shows no gaps.
const COLUMNS: f64 = 3.0;

type Point = (f64, f64);

/// A curve in pieces, without what changes nothing in the picture. Breaks where a point can't be drawn.
///
/// Points close to the one before are left out. Of a curve whose x only grows, the points in one narrow column leave the
/// first, the last, the highest and the lowest; of any other, a stretch that was drawn before, as in the cycles of a periodic
/// orbit, is not drawn again.
pub fn thinned(
    points: impl Iterator<Item = Point>,
    per_pixel: Point,
    x_grows: bool,
) -> Vec<Vec<Point>> {
    let mut drawn = HashSet::new();
    let mut pieces = Vec::new();
    let mut column = PixelColumn::default();
    let mut curve = ThinnedCurve {
        per_pixel,
        points: Vec::new(),
        skipped: None,
    };
    let mut ended = |curve: &mut ThinnedCurve| {
        let piece = curve.finish();
        if x_grows {
            pieces.extend((!piece.is_empty()).then_some(piece));
        } else {
            pieces.extend(unrepeated(&piece, per_pixel, &mut drawn));
        }
    };
    for (x, y) in points {
        if !(x.is_finite() && y.is_finite()) {
            column.empty_into(&mut curve);
            ended(&mut curve);
        } else if x_grows {
            let place = (COLUMNS * x / per_pixel.0).floor();
            if !column.holds(place) {
                column.empty_into(&mut curve);
                column.place = Some(place);
            }
            column.take((x, y));
        } else {
            curve.push((x, y));
        }
    }
    column.empty_into(&mut curve);
    ended(&mut curve);
    pieces
}

/// Consecutive points in one column.
#[derive(Default)]
struct PixelColumn {
    place: Option<f64>,
    /// First, lowest, highest, last, with their numbers in the order of coming.
    kept: Option<[(usize, Point); 4]>,
    count: usize,
}

impl PixelColumn {
    fn holds(&self, place: f64) -> bool {
        self.place == Some(place)
    }

    fn take(&mut self, point: Point) {
        let new = (self.count, point);
        self.count += 1;
        let kept = self.kept.get_or_insert([new; 4]);
        if point.1 < kept[1].1.1 {
            kept[1] = new;
        }
        if point.1 > kept[2].1.1 {
            kept[2] = new;
        }
        kept[3] = new;
    }

    fn empty_into(&mut self, curve: &mut ThinnedCurve) {
        if let Some(mut kept) = self.kept.take() {
            kept.sort_by_key(|&(number, _)| number);
            let mut last = None;
            for (number, point) in kept {
                if last != Some(number) {
                    curve.push(point);
                }
                last = Some(number);
            }
        }
        self.count = 0;
        self.place = None;
    }
}

/// Points that are not close to the one before; the last one always.
struct ThinnedCurve {
    per_pixel: Point,
    points: Vec<Point>,
    skipped: Option<Point>,
}

impl ThinnedCurve {
    fn push(&mut self, (x, y): Point) {
        let near = self.points.last().is_some_and(|&(x0, y0)| {
            ((x - x0) / self.per_pixel.0).abs() < VISIBLE
                && ((y - y0) / self.per_pixel.1).abs() < VISIBLE
        });
        if near {
            self.skipped = Some((x, y));
        } else {
            self.points.push((x, y));
            self.skipped = None;
        }
    }

    fn finish(&mut self) -> Vec<Point> {
        self.points.extend(self.skipped.take());
        std::mem::take(&mut self.points)
    }
}

/// The pieces of a curve whose segments were not drawn before, to half a pixel.
fn unrepeated(curve: &[Point], per_pixel: Point, drawn: &mut HashSet<[i64; 4]>) -> Vec<Vec<Point>> {
    let cell = |(x, y): Point| {
        [
            (2.0 * x / per_pixel.0).round() as i64,
            (2.0 * y / per_pixel.1).round() as i64,
        ]
    };
    let Some(&first) = curve.first() else {
        return Vec::new();
    };
    let mut pieces = vec![vec![first]];
    for pair in curve.windows(2) {
        let ([a, b], [c, d]) = (cell(pair[0]), cell(pair[1]));
        if drawn.insert([a, b, c, d]) {
            match pieces.last_mut() {
                Some(piece) if piece.last() == Some(&pair[0]) => piece.push(pair[1]),
                _ => pieces.push(pair.to_vec()),
            }
        }
    }
    // A point alone is a curve only if it is all there is.
    if pieces.len() > 1 {
        pieces.retain(|piece| piece.len() > 1);
    }
    pieces
}

#[cfg(test)]
mod test {
    use super::*;

    #[test]
    fn thinning_keeps_ends_and_breaks() {
        let points = [
            (0.0, 0.0),
            (0.1, 0.0),
            (0.2, 0.0),
            (5.0, 1.0),
            (6.0, f64::NAN),
            (7.0, 2.0),
        ];
        let pieces = thinned(points.into_iter(), (1.0, 1.0), true);
        assert_eq!(pieces, vec![vec![(0.0, 0.0), (5.0, 1.0)], vec![(7.0, 2.0)]]);
    }

    #[test]
    fn a_spike_within_a_pixel_is_kept() {
        let points = (0..1000).map(|i| (f64::from(i) * 3e-4, if i == 617 { 50.0 } else { 0.0 }));
        let pieces = thinned(points, (1.0, 1.0), true);
        assert_eq!(pieces.len(), 1);
        assert!(pieces[0].contains(&(617.0 * 3e-4, 50.0)) && pieces[0].len() <= 4);
    }

    #[test]
    fn a_cycle_is_drawn_once() {
        let circle = |i: i32| {
            let angle = f64::from(i % 100) * std::f64::consts::TAU / 100.0;
            (100.0 * angle.cos(), 100.0 * angle.sin())
        };
        let once: usize = thinned((0..101).map(circle), (1.0, 1.0), false)
            .iter()
            .map(Vec::len)
            .sum();
        let often: usize = thinned((0..100_001).map(circle), (1.0, 1.0), false)
            .iter()
            .map(Vec::len)
            .sum();
        assert!(
            once > 60 && often <= once + 10,
            "{once} points, {often} for a thousand turns"
        );
    }
}
