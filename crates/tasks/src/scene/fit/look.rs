//! A look at a record: what its columns are, how it was sampled, how the load point moved, what friction did.

use super::data::Measured;
use super::motion::by_program;
use super::options::FitOptions;
use super::steps::{Steady, steady_parts};
use twinslip::error::{Error, Result};
use twinslip::fit::{HELD, spread};
use twinslip::number::Uncertain;

/// Parts of the samples by whose means it is known how certain the mean of all is, although noise lasts.
const BATCHES: usize = 8;
/// The part of a stretch at its end, in which friction has settled.
const SETTLED: usize = 4;
/// A record that was looked at.
#[derive(Debug, Clone, PartialEq)]
pub struct Look {
    /// What was measured.
    pub measured: Measured,
    /// The time between two samples in s: the shortest, the median, the longest.
    pub intervals: [f64; 3],
    /// The mean of the friction, the least and the largest.
    pub friction: [f64; 3],
    /// The standard deviation of what the friction scatters from sample to sample.
    pub noise: Uncertain,
    /// The stretches of one velocity; none where the motion of the load point is not known.
    pub stretches: Vec<LookStretch>,
}

/// A stretch in which the load point has one velocity.
#[derive(Debug, Clone, PartialEq)]
pub struct LookStretch {
    /// From when to when, in s.
    pub span: (f64, f64),
    /// The velocity of the load point in m/s, with its standard error.
    pub velocity: Uncertain,
    /// Whether the load point is held: it hardly moves, and has moved before.
    pub is_hold: bool,
    /// The mean friction of its last quarter, with its standard error.
    pub settled: Option<Uncertain>,
    /// The least friction of a sample, with how far noise may have taken it.
    pub lowest: Option<Uncertain>,
    /// And the largest.
    pub highest: Option<Uncertain>,
}

impl Look {
    /// Reads the record that the options name.
    ///
    /// # Errors
    /// Those of [`Measured::read`], but for gaps.
    pub fn new(options: &FitOptions) -> Result<Self> {
        let path = match &options.data[..] {
            [path] => path,
            [] => {
                return Err(Error::Input(
                    "`data`: the file of the record is missing".into(),
                ));
            }
            _ => {
                let what = "`look` takes one record at a time";
                return Err(Error::Input(what.into()));
            }
        };
        let measured = Measured::with_gaps(path, options, false)?;
        let Measured {
            times, friction, ..
        } = &measured;
        let parts = match (&options.program, &measured.displacement) {
            (Some(program), _) => by_program(program, options.driving, times, None)?
                .stretches
                .iter()
                .map(|stretch| Steady {
                    span: stretch.span,
                    velocity: 0.5 * (stretch.velocity.0 + stretch.velocity.1),
                    error: 0.5 * (stretch.velocity.1 - stretch.velocity.0).abs(),
                })
                .collect(),
            (None, Some(moved)) => steady_parts(times, moved),
            (None, None) => Vec::new(),
        };
        let mut intervals: Vec<f64> = times.windows(2).map(|pair| pair[1] - pair[0]).collect();
        intervals.sort_by(f64::total_cmp);
        let last = intervals.len() - 1;
        let count = friction.len() as f64;
        let ends = friction
            .iter()
            .fold((f64::INFINITY, f64::NEG_INFINITY), |(low, high), x| {
                (low.min(*x), high.max(*x))
            });
        // The standard deviation of a median absolute deviation, over itself.
        let scatter = spread(friction);
        let noise = Uncertain::new(scatter, 1.17 * scatter / count.sqrt());
        let shown = |(at, part): (usize, &Steady)| {
            let from = times.partition_point(|&t| t < part.span.0);
            let to = if at + 1 == parts.len() {
                times.len()
            } else {
                times.partition_point(|&t| t < part.span.1)
            };
            let inside = &friction[from..to.max(from)];
            let beside =
                |at: Option<usize>| at.and_then(|at| parts.get(at)).map(|one| one.velocity);
            let (before, after) = (beside(at.checked_sub(1)), beside(Some(at + 1)));
            let slow = |other: Option<f64>| other.is_none_or(|v| part.velocity <= HELD * v);
            // Where the largest of so many normal numbers is, and a standard deviation beyond.
            let farthest = (2.0 * (inside.len().max(1) as f64).ln()).sqrt() + 1.0;
            let extremum = |x: Option<f64>| x.map(|x| Uncertain::new(x, farthest * scatter));
            LookStretch {
                span: part.span,
                velocity: Uncertain::new(part.velocity, part.error),
                is_hold: before.is_some() && slow(before) && slow(after),
                settled: mean(&inside[inside.len() - inside.len() / SETTLED..]),
                lowest: extremum(inside.iter().copied().min_by(f64::total_cmp)),
                highest: extremum(inside.iter().copied().max_by(f64::total_cmp)),
            }
        };
        Ok(Look {
            intervals: [intervals[0], intervals[last / 2], intervals[last]],
            friction: [friction.iter().sum::<f64>() / count, ends.0, ends.1],
            noise,
            stretches: parts.iter().enumerate().map(shown).collect(),
            measured,
        })
    }

    /// The steps of velocity, each with the stretches before and after it.
    pub fn steps(&self) -> impl Iterator<Item = (&LookStretch, &LookStretch)> {
        let pairs = self.stretches.windows(2).map(|pair| (&pair[0], &pair[1]));
        pairs.filter(|(before, after)| !before.is_hold && !after.is_hold)
    }

    /// The holds, each with the stretches before it and, where there is one, after it.
    pub fn holds(
        &self,
    ) -> impl Iterator<Item = (&LookStretch, &LookStretch, Option<&LookStretch>)> {
        let pairs = self.stretches.windows(2).enumerate();
        pairs
            .filter(|(_, pair)| pair[1].is_hold)
            .map(|(i, pair)| (&pair[0], &pair[1], self.stretches.get(i + 2)))
    }
}

impl LookStretch {
    /// The peak of friction after a step from this velocity: the largest value of a step up, the least of a step down.
    pub fn peak_after(&self, before: f64) -> Option<Uncertain> {
        if self.velocity.value > before {
            self.highest
        } else {
            self.lowest
        }
    }
}

/// The mean of samples, with its standard error from the means of their parts; none of too few.
fn mean(all: &[f64]) -> Option<Uncertain> {
    if all.len() < 2 * BATCHES {
        return None;
    }
    let of = |part: &[f64]| part.iter().sum::<f64>() / part.len() as f64;
    let mean = of(all);
    let each: Vec<f64> = all.chunks_exact(all.len() / BATCHES).map(of).collect();
    let count = each.len() as f64;
    let squares: f64 = each.iter().map(|x| (x - mean).powi(2)).sum();
    Some(Uncertain::new(
        mean,
        (squares / (count - 1.0) / count).sqrt(),
    ))
}
