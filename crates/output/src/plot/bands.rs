//! Oscillations too close for the eye: where a curve fills an area, its envelope is drawn instead.

use super::canvas::Pixel;

/// Breadth of the columns in which oscillations are counted, in pixels.
const COLUMN: f64 = 4.0;
/// A column with so many extrema is filled: lines 1.9 pixels broad at a distance of 2 leave no gaps.
const FILLED: usize = 4;
/// Fewer columns than this beside one another are no band.
const FEW: usize = 4;
/// Changes of height smaller than this, in pixels, are no oscillation.
const SMALL: f64 = 3.0;

/// A part of a curve.
#[derive(Debug, Clone, PartialEq)]
pub enum Part {
    /// Drawn as it is.
    Line(Vec<Pixel>),
    /// Its envelope, from left to right: lower and upper side.
    Band(Vec<Pixel>, Vec<Pixel>),
}

/// The parts of a curve whose x only grows, in pixels.
pub fn parts(line: &[Pixel]) -> Vec<Part> {
    let place = |at: &Pixel| (at.0 / COLUMN).floor();
    let columns: Vec<&[Pixel]> = line.chunk_by(|a, b| place(a) == place(b)).collect();
    let filled: Vec<bool> = columns
        .iter()
        .map(|column| extrema(column) >= FILLED)
        .collect();
    let mut parts: Vec<Part> = Vec::new();
    let mut start = 0;
    for run in filled.chunk_by(|a, b| a == b) {
        let stretch = &columns[start..start + run.len()];
        let before = start.checked_sub(1).and_then(|i| columns[i].last());
        start += run.len();
        if run[0] && run.len() >= FEW {
            // The line goes on into the band, and out of it.
            if let Some(Part::Line(line)) = parts.last_mut() {
                line.push(stretch[0][0]);
            }
            parts.push(band(stretch));
            continue;
        }
        let points = stretch.concat();
        match parts.last_mut() {
            Some(Part::Line(line)) => line.extend(points),
            _ => parts.push(Part::Line(
                before.into_iter().copied().chain(points).collect(),
            )),
        }
    }
    parts
}

/// How often the height turns.
fn extrema(column: &[Pixel]) -> usize {
    let Some(&(_, first)) = column.first() else {
        return 0;
    };
    let (mut low, mut high, mut rising, mut count) = (first, first, None, 0);
    for &(_, y) in column {
        let (falls, rises) = (high - y > SMALL, y - low > SMALL);
        match rising {
            None | Some(false) if rises => {
                count += usize::from(rising.is_some());
                (rising, high) = (Some(true), y);
            }
            None | Some(true) if falls => {
                count += usize::from(rising.is_some());
                (rising, low) = (Some(false), y);
            }
            None => (low, high) = (low.min(y), high.max(y)),
            Some(true) => high = high.max(y),
            Some(false) => low = low.min(y),
        }
    }
    count
}

fn band(columns: &[&[Pixel]]) -> Part {
    let extreme = |of: fn(f64, f64) -> f64| -> Vec<Pixel> {
        let each = columns.iter().map(|column| {
            let y = column.iter().map(|at| at.1).reduce(of).unwrap_or(f64::NAN);
            (0.5 * (column[0].0 + column[column.len() - 1].0), y)
        });
        let mut side: Vec<Pixel> = each.collect();
        // Up to both ends.
        if let (Some(first), Some(last)) = (columns.first(), columns.last()) {
            side.insert(0, (first[0].0, side[0].1));
            side.push((last[last.len() - 1].0, side[side.len() - 1].1));
        }
        side
    };
    Part::Band(extreme(f64::max), extreme(f64::min))
}

#[cfg(test)]
mod test {
    use super::*;

    fn wave(from: f64, to: f64, period: f64) -> Vec<Pixel> {
        let steps = (10.0 * (to - from)) as usize;
        let x = |i: usize| from + 0.1 * i as f64;
        let y = |x: f64| 50.0 + 30.0 * (std::f64::consts::TAU * x / period).sin();
        (0..steps).map(|i| (x(i), y(x(i)))).collect()
    }

    #[test]
    fn what_the_eye_can_follow_is_a_line() {
        let line = wave(0.0, 300.0, 9.0);
        assert_eq!(parts(&line), [Part::Line(line)]);
    }

    #[test]
    fn what_fills_an_area_is_a_band_between_its_extremes() {
        let mut line = wave(0.0, 100.0, 30.0);
        line.extend(wave(100.0, 200.0, 1.5));
        line.extend(wave(200.0, 300.0, 30.0));
        let found = parts(&line);
        let [
            Part::Line(before),
            Part::Band(lower, upper),
            Part::Line(after),
        ] = &found[..]
        else {
            panic!("{found:?}")
        };
        assert!(
            (before[before.len() - 1].0 - 100.0).abs() < 4.1 && (after[0].0 - 200.0).abs() < 4.1
        );
        assert!(
            lower.iter().all(|at| (at.1 - 80.0).abs() < 1.0),
            "{lower:?}"
        );
        assert!(
            upper.iter().all(|at| (at.1 - 20.0).abs() < 1.0),
            "{upper:?}"
        );
    }
}
