//! Where to begin: parameters read off a step of velocity or a hold, as one would with a ruler.
//!
//! After a step from V_1 to V_2 friction first rises by nearly a ln(V_2/V_1), as far as the spring allows, then decays over some L of slip
//! to (a - b) ln(V_2/V_1) above what it was. In a hold it falls by nearly a ln(1 + k V t/a), as creep lets the spring out; when the load point
//! moves again, it rises along the spring to a peak nearly b ln(1 + V t/L) above what it was, and decays over some L.

use super::holds::HELD;
use super::record::Record;
use super::slider::{Motion, Stretch};

/// What a step or a hold shows.
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
/// Smaller changes of velocity, in their logarithm, as a record begins are no steps.
const JUMP: f64 = 0.05;
/// Samples on either side that a moving median takes.
const AROUND: usize = 2;

/// What the largest step and the longest hold of the motion show, those of them that there are with samples on both sides.
pub fn guesses(record: &Record, motion: &Motion, reference_rate: f64) -> Vec<Guess> {
    let shown = Shown::of(record);
    let long = long_stretches(record, motion);
    let step = largest_step(&long).and_then(|step| shown.of_step(step, reference_rate));
    let hold = longest_hold(&long).and_then(|hold| shown.of_hold(hold, reference_rate));
    step.into_iter().chain(hold).collect()
}

/// A record with its friction smoothed.
struct Shown<'a> {
    record: &'a Record,
    smooth: Vec<f64>,
}

impl<'a> Shown<'a> {
    fn of(record: &'a Record) -> Self {
        let all = &record.friction;
        let around = |i: usize| &all[i.saturating_sub(AROUND)..all.len().min(i + AROUND + 1)];
        let smooth = (0..all.len()).map(|i| median(around(i))).collect();
        Shown { record, smooth }
    }

    fn moved(&self, i: usize) -> f64 {
        self.record.displacement[i]
    }

    /// The friction before a sample, and its noise.
    fn level(&self, before: usize) -> (f64, f64) {
        let earlier = before - (before / 2).clamp(1, 200);
        let all = &self.record.friction[earlier..before];
        (mean(all), spread(all))
    }

    /// The friction at the end of these samples.
    fn settled(&self, (from, to): (usize, usize)) -> f64 {
        mean(&self.record.friction[to - ((to - from) / 4).max(1)..to])
    }

    /// Over which length friction decays from its peak, upwards or downwards, to what it settles at.
    fn decay(&self, (peak, to): (usize, usize), settled: f64, sign: f64) -> f64 {
        let excess = |i: usize| (self.smooth[i] - settled) * sign;
        let decayed = (peak..to).find(|&i| excess(i) < excess(peak) / std::f64::consts::E);
        decayed.map_or(0.1 * (self.moved(to - 1) - self.moved(peak)), |i| {
            self.moved(i) - self.moved(peak)
        })
    }

    fn of_step(&self, [before, after]: [Stretch; 2], reference_rate: f64) -> Option<Guess> {
        let times = &self.record.times;
        // Where a record begins with the step, or with the hold, its first sample is the level before.
        let step = times.partition_point(|&t| t < before.span.1).max(1);
        let end = times.partition_point(|&t| t < after.span.1);
        if end < step + 5 {
            return None;
        }
        let (slow, fast) = (before.velocity.1, after.velocity.0);
        let ratio = (fast / slow).ln();
        let (level, noise) = self.level(step);
        // Upwards for a step up, downwards for a step down.
        let height = |i: usize| (self.smooth[i] - level) * ratio.signum();
        let peak = (step..end).max_by(|&i, &j| height(i).total_cmp(&height(j)))?;
        let settled = self.settled((step, end));
        let top = f64::max(height(peak), noise);
        let change = (settled - level) / ratio;
        let least = 0.3 * spacing(self.record, step, end);
        let to_peak = f64::max(self.moved(peak) - self.moved(step), least);
        let length = self.decay((peak, end), settled, ratio.signum());
        let direct_effect = 1.2 * top / ratio.abs();
        Some(Guess {
            direct_effect,
            evolution_effect: f64::max(direct_effect - change, 0.1 * direct_effect),
            slip_length: f64::max(length, least),
            stiffness: 2.0 * top / to_peak,
            reference_friction: level + change * (reference_rate / slow).ln(),
        })
    }

    fn of_hold(&self, [before, hold, after]: [Stretch; 3], reference_rate: f64) -> Option<Guess> {
        let times = &self.record.times;
        let [begin, again, end] =
            [before, hold, after].map(|one| times.partition_point(|&t| t < one.span.1).max(1));
        if again < begin + 5 || end < again + 5 {
            return None;
        }
        let (level, noise) = self.level(begin);
        let bottom = self.smooth[again - 1];
        let heights = |&i: &usize, &j: &usize| self.smooth[i].total_cmp(&self.smooth[j]);
        let peak = (again..end).max_by(heights)?;
        let rise = f64::max(self.smooth[peak] - bottom, noise);
        let least = 0.3 * spacing(self.record, again, end);
        // Creep is slow as long as friction is far below its peak: the spring alone is seen.
        let half = (again..=peak).find(|&i| self.smooth[i] - bottom >= 0.5 * rise)?;
        let stretched = f64::max(self.moved(half) - self.moved(again - 1), least);
        let stiffness = 0.5 * rise / stretched;
        let slid = before.velocity.1 * (hold.span.1 - hold.span.0);
        let drop = f64::max(level - bottom, noise);
        // Each pass brings a nearer to what it is, as the logarithm hardly changes.
        let direct_effect = (0..10).fold(0.2 * drop, |a, _| {
            drop / (stiffness * slid / a).ln_1p().max(1.0)
        });
        let settled = self.settled((again, end));
        let slip_length = f64::max(self.decay((peak, end), settled, 1.0), least);
        let healed = f64::max(self.smooth[peak] - level, noise);
        let evolution_effect = healed / (slid / slip_length).ln_1p().max(1.0);
        let change = (direct_effect - evolution_effect) * (reference_rate / before.velocity.1).ln();
        Some(Guess {
            direct_effect,
            evolution_effect: evolution_effect.max(0.1 * direct_effect),
            slip_length,
            stiffness,
            reference_friction: level + change,
        })
    }
}

/// The stretches of one velocity that have samples enough to be more than a part of a step: motors take a moment. The first one may have few, as
/// all begins at steady sliding, and none where the record begins with a step.
fn long_stretches(record: &Record, motion: &Motion) -> Vec<Stretch> {
    let until = |t: f64| record.times.partition_point(|&own| own < t);
    let is_long = |(i, stretch): &(usize, &Stretch)| {
        let (begin, end) = stretch.span;
        let count = until(end) - until(begin);
        let is_first = *i == 0 && stretch.velocity.0 == motion.before;
        stretch.velocity.0 == stretch.velocity.1
            && (is_first || count >= SAMPLES.max(record.times.len() / 50))
    };
    let all = motion.stretches.iter().enumerate().filter(is_long);
    let begin = motion.stretches.first();
    let jump = begin.filter(|one| (one.velocity.0 / motion.before).ln().abs() > JUMP);
    let sliding = jump.map(|first| Stretch {
        span: (first.span.0, first.span.0),
        velocity: (motion.before, motion.before),
    });
    let rest = all.map(|(_, stretch)| *stretch);
    sliding.into_iter().chain(rest).collect()
}

/// The two stretches between which the velocity changes most, in its logarithm.
fn largest_step(long: &[Stretch]) -> Option<[Stretch; 2]> {
    let pairs = long.windows(2).map(|pair| [pair[0], pair[1]]);
    let steps = pairs.filter(|pair| pair.iter().all(|one| one.velocity.0 > 0.0));
    let size = |[before, after]: &[Stretch; 2]| (after.velocity.0 / before.velocity.0).ln().abs();
    let largest = steps.max_by(|one, other| size(one).total_cmp(&size(other)));
    largest.filter(|step| size(step) > 0.0)
}

/// The longest hold, between sliding before and after it.
fn longest_hold(long: &[Stretch]) -> Option<[Stretch; 3]> {
    let three = long.windows(3).map(|all| [all[0], all[1], all[2]]);
    let holds = three.filter(|[before, hold, after]| {
        let most = HELD * f64::min(before.velocity.1, after.velocity.0);
        most > 0.0 && hold.velocity.0 <= most
    });
    let length = |all: &[Stretch; 3]| all[1].span.1 - all[1].span.0;
    holds.max_by(|one, other| length(one).total_cmp(&length(other)))
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
