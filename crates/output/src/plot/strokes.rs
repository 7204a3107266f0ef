//! Lines broken into dashes and dots, whose pattern runs on around the corners of the line.

use super::Stroke;
use super::canvas::{Canvas, Colour, Pixel};
use super::names::along;
use std::collections::HashMap;

/// Lengths of what is drawn and what is left out in turn, for a line of [`USUAL`] width.
const DASHED: [f64; 2] = [7.0, 4.0];
const DASH_DOT: [f64; 4] = [9.0, 3.2, 2.0, 3.2];
const DASH_DOT_DOT: [f64; 6] = [9.0, 3.0, 2.0, 3.0, 2.0, 3.0];
const DOTTED: [f64; 2] = [2.0, 3.0];
/// A line broader than this has longer dashes.
const USUAL: f64 = 2.0;

/// Lengths of dashes and gaps in turn for a line that broad; none for an unbroken one.
pub fn pattern(stroke: Stroke, width: f64) -> Vec<f64> {
    let pattern: &[f64] = match stroke {
        Stroke::Solid => &[],
        Stroke::Dashed => &DASHED,
        Stroke::DashDot => &DASH_DOT,
        Stroke::DashDotDot => &DASH_DOT_DOT,
        Stroke::Dotted => &DOTTED,
    };
    let longer = (width / USUAL).max(1.0);
    pattern.iter().map(|length| longer * length).collect()
}

/// Distance of the places by which a line knows that it was there before.
const STEP: f64 = 0.5;
/// What comes about as near as this to itself, after and over at least so many steps, is there again. Lines that near look
/// like one.
const NEAR: f64 = 0.7;
const AGAIN: usize = 28;

/// The stretches of a curve that don't follow an earlier one: the cycles of an orbit, drawn one over the other, would fill the
/// gaps of the pattern. That it crosses itself breaks nothing. `been` holds where the curve was already, and when.
pub fn first_times(line: &[Pixel], been: &mut Been) -> Vec<Vec<Pixel>> {
    let places = along(line, STEP);
    let again: Vec<bool> = places.iter().map(|&at| been.visit(at)).collect();
    let mut stretches = Vec::new();
    let mut kept: Vec<Pixel> = Vec::new();
    let mut start = 0;
    for run in again.chunk_by(|a, b| a == b) {
        let stretch = &places[start..start + run.len()];
        start += run.len();
        if run[0] && (run.len() > AGAIN || run.len() == places.len()) {
            stretches.extend((kept.len() > 1).then(|| std::mem::take(&mut kept)));
            kept.clear();
        } else {
            kept.extend(stretch);
        }
    }
    stretches.extend((!kept.is_empty()).then_some(kept));
    stretches
}

/// Where a curve was.
#[derive(Default)]
pub struct Been {
    /// The first visit of each square.
    visits: HashMap<(i64, i64), usize>,
    time: usize,
}

impl Been {
    /// Comes to a place, and says whether it or its surroundings were visited before, not just now.
    fn visit(&mut self, at: Pixel) -> bool {
        let square = |x: f64| (x / NEAR).floor() as i64;
        let (i, j) = (square(at.0), square(at.1));
        let around = (-1..=1).flat_map(|di| (-1..=1).map(move |dj| (i + di, j + dj)));
        let again = around
            .filter_map(|square| self.visits.get(&square))
            .any(|&visit| self.time > visit + AGAIN);
        self.time += 1;
        // What is there again stays there since the first time.
        self.visits.entry((i, j)).or_insert(self.time);
        again
    }
}

/// What of a line is drawn.
pub fn dashes(line: &[Pixel], pattern: &[f64]) -> Vec<Vec<Pixel>> {
    if pattern.is_empty() || line.len() < 2 {
        return vec![line.to_vec()];
    }
    let mut dashes = vec![vec![line[0]]];
    let (mut part, mut left) = (0, pattern[0]);
    for pair in line.windows(2) {
        let (mut from, to) = (pair[0], pair[1]);
        let mut length = (to.0 - from.0).hypot(to.1 - from.1);
        while length > left {
            let share = left / length;
            from = (
                from.0 + share * (to.0 - from.0),
                from.1 + share * (to.1 - from.1),
            );
            length -= left;
            part = (part + 1) % pattern.len();
            left = pattern[part];
            match dashes.last_mut() {
                // A gap begins: the dash ends here.
                Some(dash) if part % 2 == 1 => dash.push(from),
                _ => dashes.push(vec![from]),
            }
        }
        left -= length;
        if let (Some(dash), true) = (dashes.last_mut(), part % 2 == 0) {
            dash.push(to);
        }
    }
    dashes.retain(|dash| dash.len() > 1);
    dashes
}

/// A line longer than this fills an area, where no pattern can be seen: it is drawn unbroken.
const FILLS: f64 = 60_000.0;

/// Draws a line so; a point alone as a dot.
pub fn draw(canvas: &Canvas, line: &[Pixel], stroke: Stroke, width: f64, colour: Colour) {
    if let [only] = line {
        return canvas.circle(*only, 0.5 * width, colour);
    }
    let stroke = if length(line) < FILLS {
        stroke
    } else {
        Stroke::Solid
    };
    dashes(line, &pattern(stroke, width))
        .iter()
        .for_each(|dash| canvas.line(dash, colour, width))
}

fn length(line: &[Pixel]) -> f64 {
    let steps = line.windows(2);
    steps
        .map(|pair| (pair[1].0 - pair[0].0).hypot(pair[1].1 - pair[0].1))
        .sum()
}

#[cfg(test)]
mod test {
    use super::*;

    fn arc(points: i32) -> Vec<Pixel> {
        let angle = |i: i32| 3.0 * f64::from(i) / f64::from(points - 1);
        let place = |i| (200.0 * f64::cos(angle(i)), 200.0 * f64::sin(angle(i)));
        (0..points).map(place).collect()
    }

    #[test]
    fn lengths_add_up() {
        for stroke in [
            Stroke::Dashed,
            Stroke::DashDot,
            Stroke::DashDotDot,
            Stroke::Dotted,
        ] {
            let (line, pattern) = (arc(777), pattern(stroke, 1.5));
            let drawn = dashes(&line, &pattern);
            // All dashes but the last have the lengths of the pattern in turn.
            let inked: Vec<f64> = pattern.iter().copied().step_by(2).collect();
            for (i, dash) in drawn.iter().enumerate().take(drawn.len() - 1) {
                let expected = inked[i % inked.len()];
                assert!((length(dash) - expected).abs() < 1e-9, "{stroke:?}, {i}");
            }
            // What is drawn is the share of the pattern, up to one turn of it.
            let period: f64 = pattern.iter().sum();
            let share = inked.iter().sum::<f64>() / period;
            let sum: f64 = drawn.iter().map(|dash| length(dash)).sum();
            assert!((sum - share * length(&line)).abs() < period);
        }
    }

    #[test]
    fn the_pattern_runs_on_around_corners() {
        // One line with many corners and the same line straight have dashes at the same distances along them.
        let pattern = pattern(Stroke::DashDot, 1.5);
        let stairs: Vec<Pixel> = (0..200)
            .map(|i| (f64::from((i + 1) / 2), f64::from(i / 2)))
            .collect();
        let bent = dashes(&stairs, &pattern);
        let straight = dashes(&[(0.0, 0.0), (199.0, 0.0)], &pattern);
        assert_eq!(bent.len(), straight.len());
        for (a, b) in bent.iter().zip(&straight) {
            // On the stairs the distance along is the sum of the coordinates.
            assert!((a[0].0 + a[0].1 - b[0].0).abs() < 1e-9);
            assert!((length(a) - length(b)).abs() < 1e-9);
        }
    }

    #[test]
    fn an_orbit_keeps_the_gaps_of_its_pattern() {
        let turn = |n: i32, first: i32, last: i32| -> Vec<Pixel> {
            let angle = |i: i32| std::f64::consts::TAU * f64::from(i) / f64::from(n);
            let place = |i| (100.0 * f64::cos(angle(i)), 100.0 * f64::sin(angle(i)));
            (first..=last).map(place).collect()
        };
        let sum = |lines: &[Vec<Pixel>]| -> f64 { lines.iter().map(|line| length(line)).sum() };
        // Steps that don't divide the turn: no cycle repeats the points of another.
        let once = sum(&first_times(&turn(100, 0, 100), &mut Been::default()));
        let often = sum(&first_times(&turn(73, 0, 1000), &mut Been::default()));
        assert!(
            (once - 628.0).abs() < 12.0 && (often - once).abs() < 12.0,
            "{once}, {often}"
        );
        // An eight crosses itself and stays whole.
        let eight = |i: i32| {
            let angle = std::f64::consts::TAU * f64::from(i) / 200.0;
            (100.0 * angle.sin(), 60.0 * (2.0 * angle).sin())
        };
        let eight: Vec<Pixel> = (20..200).map(eight).collect();
        let whole = first_times(&eight, &mut Been::default());
        assert_eq!(whole.len(), 1);
        assert!((sum(&whole) - length(&eight)).abs() < 1e-6);
    }

    #[test]
    fn unbroken_lines_and_short_ones_are_whole() {
        let line = arc(9);
        assert_eq!(dashes(&line, &pattern(Stroke::Solid, 1.0)), [line]);
        let short = [(0.0, 0.0), (3.0, 0.0)];
        assert_eq!(
            dashes(&short, &pattern(Stroke::Dashed, 1.0)),
            [short.to_vec()]
        );
    }
}
