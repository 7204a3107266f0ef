//! The steps of velocity that a record of the load point shows.
//!
//! The displacement is cut in two where two straight lines fit it best, as long as their slopes differ; then each part again.

use twinslip::fit::{Motion, Stretch};

/// Samples that a line goes through, at least.
pub(super) const LEAST: usize = 8;
/// A part of fewer samples may be what a cut beside a step has left.
const SHORT: usize = 4 * LEAST;
/// Samples on each side of a step that say when it was.
const NEXT: usize = 40;
/// Velocities nearer to each other than this factor are one: motors hunt.
const STEP: f64 = 1.25;
/// A slope that is smaller, in its standard errors, may be none.
const CERTAIN: f64 = 4.0;
/// By so much two lines must lessen the sum of squares, in variances of a sample about them.
const DECIDED: f64 = 100.0;

/// A part of a record in which the load point has one velocity.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Steady {
    /// From when to when, in s.
    pub span: (f64, f64),
    /// In m/s: none where the scatter of the transducer alone may be seen, as in a hold.
    pub velocity: f64,
    /// Its standard error, or half the difference between its halves, whichever is larger: motors hunt.
    pub error: f64,
}

/// The motion of a load point in steps, from its displacement at ascending times.
pub(super) fn motion_in_steps(times: &[f64], displacement: &[f64]) -> Motion {
    let stretch = |one: Steady| Stretch {
        span: one.span,
        velocity: (one.velocity, one.velocity),
    };
    let stretches: Vec<Stretch> = steady_parts(times, displacement)
        .into_iter()
        .map(stretch)
        .collect();
    Motion {
        before: stretches[0].velocity.0,
        stretches,
    }
}

/// The parts of a record between steps of velocity, from the displacement at ascending times.
pub(super) fn steady_parts(times: &[f64], displacement: &[f64]) -> Vec<Steady> {
    let mut cuts = Vec::new();
    let sums = Sums::of(times, displacement);
    sums.cut(0, times.len(), &mut cuts);
    sums.unite(times.len(), &mut cuts);
    sums.join(times.len(), &mut cuts);
    let mut edges = vec![0];
    edges.extend(&cuts);
    edges.push(times.len());
    let origin = times[0];
    let mut parts = Vec::with_capacity(edges.len() - 1);
    let mut begin = origin;
    for (i, pair) in edges.windows(2).enumerate() {
        let (from, at) = (pair[0], pair[1]);
        let end = match edges.get(i + 2) {
            None => times[times.len() - 1],
            Some(&next) => {
                // Where lines through the samples next to it meet, if that is near: motors hunt, and lines through all are not straight.
                let before = sums.line(from.max(at.saturating_sub(NEXT)), at);
                let after = sums.line(at, next.min(at + NEXT));
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
        let (line, middle) = (sums.line(from, at), from.midpoint(at));
        let halves = if middle > from {
            sums.line(from, middle).slope - sums.line(middle, at).slope
        } else {
            0.0
        };
        parts.push(Steady {
            span: (begin, end),
            velocity: line.velocity(),
            error: line.error.max(0.5 * halves.abs()),
        });
        begin = end;
    }
    parts
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

/// Sums over the first samples, of t, x, t^2, t x and x^2, from the first sample on. Times and displacements are whole numbers of a small
/// part of their largest, so that all sums are exact: lines through few samples are differences of sums over a million.
pub(super) struct Sums {
    sums: Vec<[i128; 5]>,
    /// What 1 is, of t in s and of x in m.
    units: (f64, f64),
}

impl Sums {
    pub fn of(times: &[f64], displacement: &[f64]) -> Self {
        /// Bits that n sum t^2 may have, for i128 to hold it; and those of a double.
        const BITS: (u32, u32) = (124, 52);
        let (t_0, x_0) = (times[0], displacement[0]);
        let bits = (BITS.0 / 2 - times.len().next_power_of_two().ilog2()).min(BITS.1);
        let unit = |all: &[f64], first: f64| {
            let most = all
                .iter()
                .fold(0.0, |most: f64, x| most.max((x - first).abs()));
            let unit = most / (1_i64 << bits) as f64;
            if unit > 0.0 { unit } else { 1.0 }
        };
        let units = (unit(times, t_0), unit(displacement, x_0));
        let whole = |x: f64| x.round() as i128;
        let mut last = [0; 5];
        let mut sums = Vec::with_capacity(times.len() + 1);
        sums.push(last);
        for (t, x) in times.iter().zip(displacement) {
            let (t, x) = (whole((t - t_0) / units.0), whole((x - x_0) / units.1));
            let terms = [t, x, t * t, t * x, x * x];
            for (sum, term) in last.iter_mut().zip(terms) {
                *sum += term;
            }
            sums.push(last);
        }
        Sums { sums, units }
    }

    pub fn line(&self, from: usize, to: usize) -> Line {
        let count = (to - from) as i128;
        let [t, x, tt, tx, xx]: [i128; 5] =
            std::array::from_fn(|i| self.sums[to][i] - self.sums[from][i]);
        let moment = |sum: i128, one: i128, other: i128| (count * sum - one * other) as f64;
        let (n, (t_unit, x_unit)) = (count as f64, self.units);
        let spread = moment(tt, t, t) / n * t_unit * t_unit;
        let together = moment(tx, t, x) / n * t_unit * x_unit;
        let slope = if spread > 0.0 { together / spread } else { 0.0 };
        let squares = moment(xx, x, x) / n * x_unit * x_unit - slope * together;
        let squares = squares.max(0.0);
        let error = if n > 2.0 && spread > 0.0 {
            (squares / (n - 2.0) / spread).sqrt()
        } else {
            f64::INFINITY
        };
        Line {
            level: (x as f64 * x_unit - slope * (t as f64 * t_unit)) / n,
            slope,
            error,
            squares,
        }
    }

    /// Puts one cut in place of two that are next to each other where it fits as well: a cut that was beside a step has left it to a short part.
    fn unite(&self, count: usize, cuts: &mut Vec<usize>) {
        let squares = |edges: &[usize]| -> f64 {
            let parts = edges.windows(2).filter(|pair| pair[1] > pair[0]);
            parts.map(|pair| self.line(pair[0], pair[1]).squares).sum()
        };
        let mut at = 0;
        while at + 1 < cuts.len() {
            let (first, second) = (cuts[at], cuts[at + 1]);
            let from = if at == 0 { 0 } else { cuts[at - 1] };
            let to = cuts.get(at + 2).copied().unwrap_or(count);
            let both = squares(&[from, first, second, to]);
            let places = (first..=second).take_while(|_| second - first < SHORT);
            let each = places.map(|one| (squares(&[from, one, to]), one));
            let best = each.min_by(|(one, _), (other, _)| one.total_cmp(other));
            let allowed = DECIDED * both / (to - from) as f64;
            match best {
                Some((alone, one)) if alone - both <= allowed => {
                    cuts.splice(at..at + 2, [one]);
                    at = at.saturating_sub(1);
                }
                _ => at += 1,
            }
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

    /// Adds the steps between two samples, in the order in which they come.
    fn cut(&self, from: usize, to: usize, cuts: &mut Vec<usize>) {
        if let Some(at) = self.step(from, to) {
            self.cut(from, at, cuts);
            cuts.push(at);
            self.cut(at, to, cuts);
        }
    }

    /// A step between two samples. Where velocities rise and fall in turn the best two lines through all may have one slope: then it is the
    /// plainest step of ever smaller parts.
    fn step(&self, from: usize, to: usize) -> Option<usize> {
        /// Parts, to either side of which the next ones overlap by half.
        const PARTS: [usize; 4] = [1, 2, 4, 8];
        let found = PARTS.iter().map(|&parts| {
            let length = (to - from) / parts;
            let begins = (0..2 * parts - 1).map(|i| from + i * length / 2);
            let each = begins.filter_map(|begin| self.step_within(begin, (begin + length).min(to)));
            each.max_by(|(one, _), (other, _)| one.total_cmp(other))
        });
        let mut found = found.flatten();
        found.next().map(|(_, at)| at)
    }

    /// Where two lines fit the samples best, with how much less the sum of squares is then, if that decides that there is a step.
    fn step_within(&self, from: usize, to: usize) -> Option<(f64, usize)> {
        /// Places at most at which it is looked for, before all near the best of them are.
        const LOOKED_AT: usize = 2048;
        if to < from + 2 * LEAST {
            return None;
        }
        let both = |at: usize| self.line(from, at).squares + self.line(at, to).squares;
        let best = |places: &mut dyn Iterator<Item = usize>| {
            let each = places.map(|at| (both(at), at));
            each.min_by(|(one, _), (other, _)| one.total_cmp(other))
        };
        let (first, last) = (from + LEAST, to - LEAST);
        let stride = ((last - first) / LOOKED_AT).max(1);
        let (_, near) = best(&mut (first..=last).step_by(stride))?;
        let near = near.saturating_sub(stride).max(first)..=(near + stride).min(last);
        let (squares, at) = best(&mut near.into_iter())?;
        let whole = self.line(from, to).squares;
        let variance = squares / (to - from) as f64;
        let is_step = self.line(from, at).differs(&self.line(at, to));
        (is_step && whole - squares > DECIDED * variance).then_some((whole - squares, at))
    }
}
