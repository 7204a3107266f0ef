//! Where to begin: parameters read off a step of velocity, as one would with a ruler.
//!
//! Of a step from V_1 to V_2 friction first rises by nearly a ln(V_2/V_1), as far as the spring allows, then decays over some L of slip
//! to (a - b) ln(V_2/V_1) above what it was.

use super::problem::Record;
use super::slider::{Motion, Stretch};

/// What a step shows.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Guess {
    /// a
    pub direct_effect: f64,
    /// b
    pub evolution_effect: f64,
    /// L in m
    pub slip_length: f64,
    /// Friction per metre.
    pub stiffness: f64,
    /// The coefficient at V*.
    pub reference_friction: f64,
}

/// Samples of a velocity, at least, for a step to begin or end with.
const SAMPLES: usize = 8;
/// Samples on either side that a moving median takes.
const AROUND: usize = 2;

/// What the largest step of the motion shows; `None` where there is none with samples on both sides.
pub fn guess(record: &Record, motion: &Motion, reference_rate: f64) -> Option<Guess> {
    let (at, before, after, until) = largest_step(record, motion)?;
    let step = record.times.partition_point(|&t| t < at);
    let end = record.times.partition_point(|&t| t < until);
    if step < 3 || end < step + 5 {
        return None;
    }
    let smooth: Vec<f64> = (0..record.friction.len())
        .map(|i| {
            median(
                &record.friction
                    [i.saturating_sub(AROUND)..record.friction.len().min(i + AROUND + 1)],
            )
        })
        .collect();
    let ratio = (after / before).ln();
    let earlier = step - (step / 2).clamp(1, 200);
    let level = mean(&record.friction[earlier..step]);
    let last = end - ((end - step) / 4).max(1);
    let settled = mean(&record.friction[last..end]);
    // Upwards for a step up, downwards for a step down.
    let height = |i: usize| (smooth[i] - level) * ratio.signum();
    let peak = (step..end).max_by(|&i, &j| height(i).total_cmp(&height(j)))?;
    let noise = spread(&record.friction[earlier..step]);
    let top = f64::max(height(peak), noise);
    let change = (settled - level) / ratio;
    let moved = |i: usize| record.displacement[i];
    let to_peak = f64::max(moved(peak) - moved(step), 0.3 * spacing(record, step, end));
    let excess = |i: usize| (smooth[i] - settled) * ratio.signum();
    let decayed = (peak..end).find(|&i| excess(i) < excess(peak) / std::f64::consts::E);
    let length = decayed.map_or(0.1 * (moved(end - 1) - moved(step)), |i| {
        moved(i) - moved(peak)
    });
    let direct_effect = 1.2 * top / ratio.abs();
    Some(Guess {
        direct_effect,
        evolution_effect: f64::max(direct_effect - change, 0.1 * direct_effect),
        slip_length: f64::max(length, 0.3 * spacing(record, step, end)),
        stiffness: 2.0 * top / to_peak,
        reference_friction: level + change * (reference_rate / before).ln(),
    })
}

/// When the velocity changes most, in its logarithm, from what to what, and until when it stays so. Motors take a moment: stretches with
/// few samples belong to the step.
fn largest_step(record: &Record, motion: &Motion) -> Option<(f64, f64, f64, f64)> {
    let until = |t: f64| record.times.partition_point(|&own| own < t);
    let is_long = |stretch: &&Stretch| {
        let (begin, end) = stretch.span;
        let is_steady = stretch.velocity.0 == stretch.velocity.1 && stretch.velocity.0 > 0.0;
        is_steady && until(end) - until(begin) >= SAMPLES.max(record.times.len() / 50)
    };
    let long: Vec<&Stretch> = motion.stretches.iter().filter(is_long).collect();
    let steps = long.windows(2).map(|pair| {
        let (before, after) = (pair[0].velocity.1, pair[1].velocity.0);
        (pair[0].span.1, before, after, pair[1].span.1)
    });
    let size = |step: &(f64, f64, f64, f64)| (step.2 / step.1).ln().abs();
    let largest = steps.max_by(|one, other| size(one).total_cmp(&size(other)));
    largest.filter(|step| size(step) > 0.0)
}

/// How far the load point moves between samples.
fn spacing(record: &Record, from: usize, to: usize) -> f64 {
    (record.displacement[to - 1] - record.displacement[from]) / (to - from) as f64
}

pub(super) fn median(values: &[f64]) -> f64 {
    let mut sorted = values.to_vec();
    sorted.sort_by(f64::total_cmp);
    sorted[sorted.len() / 2]
}

fn mean(values: &[f64]) -> f64 {
    values.iter().sum::<f64>() / values.len() as f64
}

/// The standard deviation of white noise, from the differences of neighbours, which know nothing of slow changes.
pub fn spread(values: &[f64]) -> f64 {
    /// The standard deviation over the median of the absolute value, of a normal distribution, and of a difference of two.
    const OF_MEDIAN: f64 = 1.4826 / std::f64::consts::SQRT_2;
    if values.len() < 2 {
        return 0.0;
    }
    let steps: Vec<f64> = values
        .windows(2)
        .map(|pair| (pair[1] - pair[0]).abs())
        .collect();
    OF_MEDIAN * median(&steps)
}
