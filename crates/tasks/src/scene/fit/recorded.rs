//! The motion of the load point as it was recorded, smoothed.
//!
//! A transducer scatters, and where it sits it moves as the sample need not: from sample to sample a displacement has velocities that no load point
//! has, and k times its scatter would be friction. What the displacement has beside its steps is smoothed by straight lines through the samples
//! of a moving window; the steps stay sharp.

use super::steps::{LEAST, Sums};
use twinslip::fit::{Motion, Stretch};

/// The factor between windows.
const THINNER: f64 = 3.0;
/// Parts of a window in which the smoothed displacement is straight.
const PARTS: f64 = 8.0;

/// A motion that a record shows at some smoothing.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct Recorded {
    /// The length of the window, in s; 0 for the displacement from sample to sample.
    pub window: f64,
    pub motion: Motion,
}

/// The motion at windows from a third of the record down to a few samples, and without smoothing. `steps` is what the displacement shows.
pub(super) fn motions_as_recorded(
    times: &[f64],
    displacement: &[f64],
    steps: &Motion,
) -> Vec<Recorded> {
    let in_steps = steps.displacement(times);
    let beside: Vec<f64> = displacement
        .iter()
        .zip(&in_steps)
        .map(|(x, in_steps)| x - displacement[0] - in_steps)
        .collect();
    let lasts = times[times.len() - 1] - times[0];
    let least = LEAST as f64 * lasts / times.len() as f64;
    let thinner = |window: &f64| Some(window / THINNER).filter(|window| *window > least);
    let windows = std::iter::successors(thinner(&lasts), thinner);
    let sums = Sums::of(times, &beside);
    let mut all: Vec<Recorded> = windows
        .map(|window| Recorded {
            window,
            motion: moved(
                times,
                &smoothed(times, &sums, window),
                steps,
                window / PARTS,
            ),
        })
        .collect();
    all.push(Recorded {
        window: 0.0,
        motion: moved(times, &beside, steps, 0.0),
    });
    all
}

/// At each time what the line through the samples of a window about it has there.
fn smoothed(times: &[f64], sums: &Sums, window: f64) -> Vec<f64> {
    let count = times.len();
    let of = |&t: &f64| {
        let from = times.partition_point(|&own| own < t - 0.5 * window);
        let to = times.partition_point(|&own| own <= t + 0.5 * window);
        // Where samples are sparse, the few that are next.
        let missing = LEAST.saturating_sub(to - from);
        let from = from.saturating_sub(missing);
        let line = sums.line(from, (to + missing).min(count));
        line.level + line.slope * (t - times[0])
    };
    times.iter().map(of).collect()
}

/// The steps, and beside them the displacement `beside`, straight over `straight` seconds at least.
fn moved(times: &[f64], beside: &[f64], steps: &Motion, straight: f64) -> Motion {
    let mut stretches = Vec::new();
    let mut from = 0;
    for to in 1..times.len() {
        let (begin, end) = (times[from], times[to]);
        if end - begin < straight && to + 1 < times.len() {
            continue;
        }
        let rate = (beside[to] - beside[from]) / (end - begin);
        for step in &steps.stretches {
            let span = (step.span.0.max(begin), step.span.1.min(end));
            let velocity = (step.velocity.0 + rate, step.velocity.1 + rate);
            if span.1 > span.0 {
                stretches.push(Stretch { span, velocity });
            }
        }
        from = to;
    }
    Motion {
        before: steps.before,
        stretches,
    }
}
