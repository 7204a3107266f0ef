//! Lines broken into dashes and dots, whose pattern runs on around the corners of the line.

use super::Stroke;
use super::canvas::{Canvas, Colour, Pixel};
use crate::error::Result;

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

/// Draws a line so; a point alone as a dot.
///
/// # Errors
/// Those of the canvas.
pub fn draw(
    canvas: &Canvas<'_>,
    line: &[Pixel],
    stroke: Stroke,
    width: f64,
    colour: Colour,
) -> Result<()> {
    if let [only] = line {
        return canvas.circle(*only, 0.5 * width, colour);
    }
    dashes(line, &pattern(stroke, width))
        .iter()
        .try_for_each(|dash| canvas.line(dash, colour, width))
}

#[cfg(test)]
mod test {
    use super::*;

    fn length(line: &[Pixel]) -> f64 {
        let steps = line.windows(2);
        steps
            .map(|p| (p[1].0 - p[0].0).hypot(p[1].1 - p[0].1))
            .sum()
    }

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
