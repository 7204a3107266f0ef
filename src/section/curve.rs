//! Invariant curves of a return map in the plane: sections of tori, and how fast the flow winds around them.
//!
//! Weighted Birkhoff averages converge faster than any power of the number of returns along a quasi-periodic orbit, and
//! no faster than its square root along a chaotic one: that tells the two apart, and gives the rotation number to many
//! digits. Das, S., Saiki, Y., Sander, E. and Yorke, J. A. (2017). Quantitative quasiperiodicity. Nonlinearity 30, 4111-4140.

use crate::number::Uncertain;
use std::f64::consts::TAU;

/// A torus may cross the section in up to so many closed curves, visited in turn.
const MOST_CURVES: usize = 8;
/// Points of each curve without which nothing is said.
const FEWEST_POINTS: usize = 60;
/// Parts of a turn below which the order of two points may be wrong by rounding.
const ROUNDING: f64 = 1e-7;

/// An invariant curve, or several that are visited in turn.
#[derive(Debug, Clone, Copy, PartialEq)]
#[non_exhaustive]
pub struct InvariantCurve {
    /// How many there are.
    pub curves: usize,
    /// Turns around the centre of one of them per `curves` returns, from 0 to 1/2: the direction depends on which interface is
    /// called the first. It compares with the angle of the multipliers of the periodic orbit inside, over 2 pi.
    pub rotation: Uncertain,
}

/// The average with the weights exp(-1/(t (1 - t))), t from 0 to 1 along the values; of none it is 0.
pub fn weighted_mean(values: impl ExactSizeIterator<Item = f64>) -> f64 {
    let n = values.len();
    let (mut sum, mut weights) = (0.0, 0.0);
    for (k, x) in values.enumerate() {
        let t = (k + 1) as f64 / (n + 1) as f64;
        let weight = (-1.0 / (t * (1.0 - t))).exp();
        sum += weight * x;
        weights += weight;
    }
    if n == 0 { 0.0 } else { sum / weights }
}

/// How well the averages over the two halves of the returns agree, of each coordinate and its square, relative to their
/// spread: below 1e-5 for a few hundred points of a quasi-periodic orbit, above 1e-2 for a chaotic one. Where there is no
/// spread, 0.
pub fn regularity(points: &[[f64; 2]]) -> f64 {
    let n = points.len() / 2;
    let halves = [&points[..n], &points[points.len() - n..]];
    let mut worst = 0.0_f64;
    for i in 0..2 {
        let mean = points.iter().map(|p| p[i]).sum::<f64>() / points.len().max(1) as f64;
        let spread = points
            .iter()
            .map(|p| (p[i] - mean).abs())
            .fold(0.0, f64::max);
        if spread == 0.0 {
            continue;
        }
        let of = |f: &dyn Fn(f64) -> f64| {
            let [first, second] =
                halves.map(|half| weighted_mean(half.iter().map(|p| f((p[i] - mean) / spread))));
            (first - second).abs()
        };
        worst = worst.max(of(&|x| x)).max(of(&|x| x * x));
    }
    worst
}

/// The invariant curve on which the points of a planar map lie, if their angles about the centre have a cyclic order that the
/// map keeps; `None` if not, as for chaos, for curves that bend too much, and for too few points.
pub fn invariant_curve(points: &[[f64; 2]]) -> Option<InvariantCurve> {
    (1..=MOST_CURVES)
        .take_while(|curves| points.len() / curves >= FEWEST_POINTS)
        .find_map(|curves| {
            let one: Vec<[f64; 2]> = points.iter().step_by(curves).copied().collect();
            let rotation = rotation(&angles(&one)?)?;
            Some(InvariantCurve { curves, rotation })
        })
}

/// Angles in turns about the mean, where both principal axes are made equally long.
fn angles(points: &[[f64; 2]]) -> Option<Vec<f64>> {
    let n = points.len() as f64;
    let mean = [0, 1].map(|i| points.iter().map(|p| p[i]).sum::<f64>() / n);
    let moment = |i: usize, j: usize| {
        let sum: f64 = points
            .iter()
            .map(|p| (p[i] - mean[i]) * (p[j] - mean[j]))
            .sum();
        sum / n
    };
    // The Cholesky factor of the covariance; a curve encloses an area.
    let a = moment(0, 0).sqrt();
    let b = moment(0, 1) / a;
    let c = (moment(1, 1) - b * b).sqrt();
    let thin = !(a > 0.0 && c > f64::EPSILON.sqrt() * (b.abs() + c));
    if thin {
        return None;
    }
    let angle = |p: &[f64; 2]| {
        let x = (p[0] - mean[0]) / a;
        let y = (p[1] - mean[1] - b * x) / c;
        (y.atan2(x) / TAU).rem_euclid(1.0)
    };
    Some(points.iter().map(angle).collect())
}

/// The rotation number of a sequence of angles in turns, if the map from each to the next keeps their cyclic order.
fn rotation(angles: &[f64]) -> Option<Uncertain> {
    let n = angles.len() - 1;
    let mut order: Vec<usize> = (0..n).collect();
    order.sort_by(|&i, &j| angles[i].total_cmp(&angles[j]));
    // Going once around, the images go around once too: they step back only where they pass 0.
    let mut around = 0.0;
    for (k, &i) in order.iter().enumerate() {
        let j = order[(k + 1) % n];
        let forward = (angles[j + 1] - angles[i + 1]).rem_euclid(1.0);
        around += if forward > 1.0 - ROUNDING {
            0.0
        } else {
            forward
        };
    }
    if around > 1.5 {
        return None;
    }
    let mut turns: Vec<f64> = (0..n)
        .map(|i| (angles[i + 1] - angles[i]).rem_euclid(1.0))
        .collect();
    // A map that keeps the order turns no two points by amounts a whole turn apart: there is a gap to cut at.
    let mut sorted = turns.clone();
    sorted.sort_by(f64::total_cmp);
    let (mut cut, mut widest) = (0.0, sorted[0] + 1.0 - sorted[n - 1]);
    for pair in sorted.windows(2) {
        if pair[1] - pair[0] > widest {
            (cut, widest) = (pair[1], pair[1] - pair[0]);
        }
    }
    for turn in &mut turns {
        *turn = (*turn - cut).rem_euclid(1.0) + cut;
    }
    let average = |part: &[f64]| weighted_mean(part.iter().copied());
    let (whole, first, second) = (
        average(&turns),
        average(&turns[..n / 2]),
        average(&turns[n / 2..]),
    );
    let folded = {
        let part = whole.rem_euclid(1.0);
        part.min(1.0 - part)
    };
    // The halves are much less accurate than the whole; but a count of turns alone is good to one in n.
    let apart = (first - second).abs().max((whole - first).abs());
    Some(Uncertain::new(folded, apart.min(1.0 / n as f64)))
}
