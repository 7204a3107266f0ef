//! What of lines and areas lies in a window with sides along the axes: Liang and Barsky (1984) for lines, Sutherland and
//! Hodgman (1974) for areas. Ends of a window may be infinite.

/// A place in the coordinates of the window.
pub type Point = (f64, f64);

/// Lower and upper ends in both directions; they belong to it.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Window {
    /// Of the first coordinate.
    pub x: (f64, f64),
    /// Of the second.
    pub y: (f64, f64),
}

impl Window {
    /// Whether a point lies in it.
    pub fn holds(&self, (x, y): Point) -> bool {
        (self.x.0..=self.x.1).contains(&x) && (self.y.0..=self.y.1).contains(&y)
    }

    /// The nearest point of it.
    pub fn nearest(&self, (x, y): Point) -> Point {
        (x.max(self.x.0).min(self.x.1), y.max(self.y.0).min(self.y.1))
    }

    /// The window without a strip along its sides.
    pub fn without(&self, strip: (f64, f64)) -> Self {
        Window {
            x: (self.x.0 + strip.0, self.x.1 - strip.0),
            y: (self.y.0 + strip.1, self.y.1 - strip.1),
        }
    }

    /// Its corners, around.
    pub fn corners(&self) -> [Point; 4] {
        let ((left, right), (top, bottom)) = (self.x, self.y);
        [(left, top), (right, top), (right, bottom), (left, bottom)]
    }

    /// What of a segment lies in it.
    pub fn segment(&self, a: Point, b: Point) -> Option<(Point, Point)> {
        let (mut from, mut to) = (0.0_f64, 1.0_f64);
        for (start, end, (lo, hi)) in [(a.0, b.0, self.x), (a.1, b.1, self.y)] {
            let step = end - start;
            if step == 0.0 {
                if start < lo || start > hi {
                    return None;
                }
                continue;
            }
            let (enters, leaves) = ((lo - start) / step, (hi - start) / step);
            from = from.max(enters.min(leaves));
            to = to.min(enters.max(leaves));
        }
        let along = |part: f64| {
            let exact = (a.0 + part * (b.0 - a.0), a.1 + part * (b.1 - a.1));
            self.nearest(exact)
        };
        (from <= to).then(|| {
            let start = if from == 0.0 { a } else { along(from) };
            let end = if to == 1.0 { b } else { along(to) };
            (start, end)
        })
    }

    /// The pieces of a line in it. One that only touches it leaves nothing; a point alone stays.
    pub fn line(&self, line: &[Point]) -> Vec<Vec<Point>> {
        if let [only] = line {
            return self.holds(*only).then(|| vec![*only]).into_iter().collect();
        }
        let mut pieces: Vec<Vec<Point>> = Vec::new();
        let mut open = false;
        for pair in line.windows(2) {
            let Some((start, end)) = self.segment(pair[0], pair[1]) else {
                open = false;
                continue;
            };
            match pieces.last_mut() {
                Some(piece) if open && start == pair[0] => piece.push(end),
                _ if start != end => pieces.push(vec![start, end]),
                _ => {}
            }
            open = end == pair[1]
                && pieces
                    .last()
                    .is_some_and(|piece| piece.last() == Some(&end));
        }
        pieces
    }

    /// The corners of what of a convex or starlike area lies in it; none if nothing does.
    pub fn area(&self, corners: &[Point]) -> Vec<Point> {
        type Side = (fn(Point) -> f64, f64, f64);
        let sides: [Side; 4] = [
            (|p| p.0, self.x.0, 1.0),
            (|p| p.0, self.x.1, -1.0),
            (|p| p.1, self.y.0, 1.0),
            (|p| p.1, self.y.1, -1.0),
        ];
        sides
            .iter()
            .fold(corners.to_vec(), |area, (of, end, sign)| {
                let depth = |p: Point| sign * (of(p) - end);
                let mut kept = Vec::new();
                for (i, &b) in area.iter().enumerate() {
                    let a = area[(i + area.len() - 1) % area.len()];
                    if (depth(a) < 0.0) != (depth(b) < 0.0) {
                        let part = depth(a) / (depth(a) - depth(b));
                        kept.push((a.0 + part * (b.0 - a.0), a.1 + part * (b.1 - a.1)));
                    }
                    if depth(b) >= 0.0 {
                        kept.push(b);
                    }
                }
                kept
            })
    }
}

#[cfg(test)]
mod test {
    use super::*;

    const UNIT: Window = Window {
        x: (0.0, 1.0),
        y: (0.0, 1.0),
    };

    #[test]
    fn segments_end_at_the_sides() {
        let cut = UNIT.segment((-1.0, 0.25), (3.0, 0.25));
        assert_eq!(cut, Some(((0.0, 0.25), (1.0, 0.25))));
        let diagonal = UNIT.segment((-1.0, -1.0), (2.0, 2.0)).unwrap();
        assert_eq!(diagonal, ((0.0, 0.0), (1.0, 1.0)));
        // It passes the corner at a distance, though both coordinates pass the window.
        assert_eq!(UNIT.segment((-1.0, 0.5), (0.5, 2.5)), None);
        assert_eq!(UNIT.segment((2.0, -1.0), (2.0, 2.0)), None);
    }

    #[test]
    fn a_line_that_leaves_and_returns_is_in_pieces() {
        let line = [
            (0.5, 0.5),
            (0.75, 0.5),
            (1.5, 0.5),
            (1.5, 0.75),
            (0.5, 0.75),
        ];
        let pieces = UNIT.line(&line);
        let expected = vec![
            vec![(0.5, 0.5), (0.75, 0.5), (1.0, 0.5)],
            vec![(1.0, 0.75), (0.5, 0.75)],
        ];
        assert_eq!(pieces, expected);
        // Both ends outside, the middle inside.
        assert_eq!(UNIT.line(&[(-9.0, 0.5), (9.0, 0.5)]).len(), 1);
        assert!(UNIT.line(&[(5.0, 5.0)]).is_empty());
    }

    /// A triangle of area 1, of which x < 1 leaves three quarters.
    #[test]
    fn areas_keep_their_part_within() {
        let area = UNIT.area(&[(0.0, 0.0), (2.0, 0.0), (0.0, 1.0)]);
        let shoelace: f64 = (0..area.len())
            .map(|i| {
                let (a, b) = (area[i], area[(i + 1) % area.len()]);
                0.5 * (a.0 * b.1 - b.0 * a.1)
            })
            .sum();
        assert!((shoelace.abs() - 0.75).abs() < 1e-12, "{area:?}");
        assert!(UNIT.area(&[(2.0, 2.0), (3.0, 2.0), (2.0, 3.0)]).is_empty());
    }

    #[test]
    fn an_open_side_does_not_cut() {
        let strip = Window {
            x: (0.0, 1.0),
            y: (f64::NEG_INFINITY, f64::INFINITY),
        };
        let cut = strip.segment((-1.0, -100.0), (1.0, 100.0));
        assert_eq!(cut, Some(((0.0, 0.0), (1.0, 100.0))));
    }
}
