//! The steps of velocity that a record of the load point shows.
//!
//! The displacement is cut in two where two straight lines fit it best, as long as their slopes differ; then each part again.

use twinslip::fit::{Motion, Stretch};

/// Samples that a line goes through, at least.
pub(super) const LEAST: usize = 8;
/// Samples on each side of a step that say when it was.
const NEXT: usize = 40;
/// Velocities nearer to each other than this factor are one: motors hunt.
const STEP: f64 = 1.25;
/// A slope that is smaller, in its standard errors, may be none.
const CERTAIN: f64 = 4.0;
/// By so much two lines must lessen the sum of squares, in variances of a sample about them.
const DECIDED: f64 = 100.0;

/// The motion of a load point in steps, from its displacement at ascending times.
pub(super) fn motion_in_steps(times: &[f64], displacement: &[f64]) -> Motion {
    let mut cuts = Vec::new();
    let sums = Sums::of(times, displacement);
    sums.cut(0, times.len(), &mut cuts);
    sums.join(times.len(), &mut cuts);
    let mut edges = vec![0];
    edges.extend(&cuts);
    edges.push(times.len());
    let lines: Vec<Line> = edges.windows(2).map(|e| sums.line(e[0], e[1])).collect();
    let origin = times[0];
    let mut stretches = Vec::with_capacity(lines.len());
    let mut begin = origin;
    for (i, line) in lines.iter().enumerate() {
        let end = match lines.get(i + 1) {
            None => times[times.len() - 1],
            Some(_) => {
                // Where lines through the samples next to it meet, if that is near: motors hunt, and lines through all are not straight.
                let at = edges[i + 1];
                let before = sums.line(edges[i].max(at.saturating_sub(NEXT)), at);
                let after = sums.line(at, edges[i + 2].min(at + NEXT));
                let meet = (before.level - after.level) / (after.slope - before.slope) + origin;
                let (low, high) = (times[at - 1], times[at]);
                let room = 3.0 * (high - low);
                if meet.is_finite() {
                    meet.clamp(low - room, high + room)
                } else {
                    0.5 * (low + high)
                }
            }
        };
        let velocity = line.velocity();
        stretches.push(Stretch {
            span: (begin, end),
            velocity: (velocity, velocity),
        });
        begin = end;
    }
    Motion {
        before: stretches[0].velocity.0,
        stretches,
    }
}

/// x = level + slope (t - t_0), with the sum of squares about it.
#[derive(Debug, Clone, Copy)]
pub(super) struct Line {
    pub level: f64,
    pub slope: f64,
    /// The standard error of the slope.
    error: f64,
    squares: f64,
}

impl Line {
    /// The velocity of the load point: none where the scatter of the transducer alone may be seen, as in a hold.
    fn velocity(&self) -> f64 {
        if self.slope > CERTAIN * self.error {
            self.slope
        } else {
            0.0
        }
    }

    /// Whether these are two velocities.
    fn differs(&self, other: &Line) -> bool {
        let (slow, fast) = (self.slope.min(other.slope), self.slope.max(other.slope));
        fast > STEP * slow.max(0.0) && fast > 0.0
    }
}

/// Sums over the first samples, of t, x, t^2, t x and x^2, from the first sample on.
pub(super) struct Sums(Vec<[f64; 5]>);

impl Sums {
    pub fn of(times: &[f64], displacement: &[f64]) -> Self {
        let (t_0, x_0) = (times[0], displacement[0]);
        let mut sums = vec![[0.0; 5]];
        for (t, x) in times.iter().zip(displacement) {
            let (t, x) = (t - t_0, x - x_0);
            let last = sums[sums.len() - 1];
            let terms = [t, x, t * t, t * x, x * x];
            sums.push(std::array::from_fn(|i| last[i] + terms[i]));
        }
        Sums(sums)
    }

    pub fn line(&self, from: usize, to: usize) -> Line {
        let n = (to - from) as f64;
        let [t, x, tt, tx, xx] = std::array::from_fn(|i| self.0[to][i] - self.0[from][i]);
        let (spread, together) = (tt - t * t / n, tx - t * x / n);
        let slope = if spread > 0.0 { together / spread } else { 0.0 };
        let squares = (xx - x * x / n - slope * together).max(0.0);
        let error = if n > 2.0 && spread > 0.0 {
            (squares / (n - 2.0) / spread).sqrt()
        } else {
            f64::INFINITY
        };
        Line {
            level: (x - slope * t) / n,
            slope,
            error,
            squares,
        }
    }

    /// Takes cuts away on both sides of which the velocity is the same: where two lines fit a record of several steps best need not be a
    /// step.
    fn join(&self, count: usize, cuts: &mut Vec<usize>) {
        let mut at = 0;
        while at < cuts.len() {
            let from = if at == 0 { 0 } else { cuts[at - 1] };
            let to = cuts.get(at + 1).copied().unwrap_or(count);
            if self.line(from, cuts[at]).differs(&self.line(cuts[at], to)) {
                at += 1;
            } else {
                cuts.remove(at);
                // What is before it has a longer neighbour now.
                at = at.saturating_sub(1);
            }
        }
    }

    fn cut(&self, from: usize, to: usize, cuts: &mut Vec<usize>) {
        if to < from + 2 * LEAST {
            return;
        }
        let both = |at: usize| self.line(from, at).squares + self.line(at, to).squares;
        let places = from + LEAST..=to - LEAST;
        let Some(at) = places.min_by(|&i, &j| both(i).total_cmp(&both(j))) else {
            return;
        };
        let (one, other) = (self.line(from, at), self.line(at, to));
        let whole = self.line(from, to).squares;
        let variance = (one.squares + other.squares) / (to - from) as f64;
        if one.differs(&other) && whole - both(at) > DECIDED * variance {
            self.cut(from, at, cuts);
            cuts.push(at);
            self.cut(at, to, cuts);
        }
    }
}
