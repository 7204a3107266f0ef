//! Branches of equilibria that run to infinity, and the value that the parameter tends to.
//!
//! Far away the parameter tends to its limit as a power of the norm of the state. Three points say which power and which limit, and two such triples have to
//! agree on both: where the parameter tends to its limit as one over a logarithm, the power falls for ever.

use crate::number::Uncertain;

/// In sizes of the branch: from here on a branch may be one that runs to infinity; earlier, if the coordinate stays.
const FAR: f64 = 1e4;
const NEAR: f64 = 1e2;
/// The states of points that are compared differ by this factor and more.
const APART: f64 = 2.0;
/// The triples of points agree on the limit to this part of the way that is left for the first, and on the power to this part of it.
const AGREE: f64 = 0.2;
const STAYS: f64 = 0.05;
/// A limit known to this part of the range is sharp; for a sharper one a branch is followed to the square of [`FAR`].
const SHARP: f64 = 1e-6;
/// A branch that slows by more than this part from one pair of points to another is faster than an exponential.
const SLOWS: f64 = 0.02;
/// What their difference counts.
const SAFETY: f64 = 4.0;
/// What points of a branch are corrected to, in parts of the range.
const CORRECTED: f64 = 1e-12;
/// The logarithm of a number that no state reaches.
const LARGEST: f64 = 700.0;

/// How a branch runs to infinity.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) enum Runs {
    /// As the coordinate tends to this.
    At(Uncertain),
    /// What the coordinate tends to is not determined.
    Somewhere,
}

/// The norms of the states and the coordinates of a branch, as it goes.
#[derive(Debug)]
pub(super) struct Runaway {
    size: f64,
    range: (f64, f64),
    points: Vec<[f64; 2]>,
}

impl Runaway {
    /// Along a branch of this size, in a range of the coordinate.
    pub fn new(size: f64, range: (f64, f64)) -> Self {
        Runaway {
            size,
            range,
            points: Vec::new(),
        }
    }

    /// The next point: whether the branch runs to infinity before its range ends.
    pub fn passes(&mut self, norm: f64, at: f64) -> Option<Runs> {
        self.points.push([norm, at]);
        if norm < NEAR * self.size {
            return None;
        }
        let [a, b, c, d] = self.apart()?;
        let rounded = CORRECTED * (self.range.1 - self.range.0);
        let rest = (d[1] - b[1]).abs();
        if rest <= rounded {
            // The way left is no more than what the least power leaves.
            let off = SAFETY * SAFETY * rest + rounded;
            return Some(Runs::At(Uncertain::new(d[1], off)));
        }
        if norm < FAR * self.size {
            return None;
        }
        let end = if d[1] > a[1] {
            self.range.1
        } else {
            self.range.0
        };
        let left = (end - d[1]).abs();
        let very_far = norm > FAR * FAR * self.size;
        let limits = limit([a, b, c]).zip(limit([b, c, d]));
        let agreed = limits.filter(|(before, now)| {
            let off = (now.at - before.at).abs();
            let powers = (now.power - before.power).abs() <= STAYS * before.power;
            off <= AGREE * (before.at - c[1]).abs() + rounded && (powers || off <= rounded)
        });
        if let Some((before, now)) = agreed {
            let off = SAFETY * (now.at - before.at).abs() + rounded;
            let way = (now.at - d[1]).abs();
            // The limit may be beyond the range, or too near to its end to say.
            let within = way + off < left || off <= 2.0 * rounded && way <= left + off;
            let sharp = very_far || off <= SHARP * (self.range.1 - self.range.0);
            return (within && sharp).then(|| Runs::At(Uncertain::new(now.at, off)));
        }
        let rate = |from: [f64; 2], to: [f64; 2]| (to[1] - from[1]).abs() / (to[0] / from[0]).ln();
        let slows = rate(c, d) < (1.0 - SLOWS) * rate(a, b);
        let reached = d[0].ln() + left / rate(c, d) < LARGEST;
        (very_far && slows && !reached).then_some(Runs::Somewhere)
    }

    /// The last point and three before it, whose norms are apart; `None` where these do not grow or the coordinate turns.
    fn apart(&self) -> Option<[[f64; 2]; 4]> {
        let mut chosen = [*self.points.last()?; 4];
        let mut i = self.points.len() - 1;
        for place in (0..3).rev() {
            let later = chosen[place + 1][0];
            i = self.points[..i]
                .iter()
                .rposition(|point| APART * point[0] < later)?;
            chosen[place] = self.points[i];
        }
        let way = chosen[3][1] - chosen[0][1];
        let goes_on = self.points[i..]
            .windows(2)
            .all(|pair| pair[1][0] > pair[0][0] && (pair[1][1] - pair[0][1]) * way >= 0.0);
        goes_on.then_some(chosen)
    }
}

/// The limit of the coordinate, and the power of the norm with which it is approached.
struct Limit {
    at: f64,
    power: f64,
}

/// The limit by three points, what is left being a power of the norm.
fn limit([a, b, c]: [[f64; 2]; 3]) -> Option<Limit> {
    /// Powers that are told from a logarithm, and from a coordinate that stays.
    const POWERS: (f64, f64) = (0.25, 20.0);
    const BISECTIONS: usize = 60;
    let (first, second) = ((b[0] / a[0]).ln(), (c[0] / b[0]).ln());
    let (before, now) = (b[1] - a[1], c[1] - b[1]);
    let (mut low, mut high) = POWERS;
    if before == 0.0 || now == 0.0 {
        return Some(Limit {
            at: c[1],
            power: high,
        });
    }
    // By which part of it the way left falls after the first stretch, over that in the first.
    let ratio = |k: f64| (-k * first).exp() * (-k * second).exp_m1() / (-k * first).exp_m1();
    if !(ratio(high) < now / before && now / before < ratio(low)) {
        return None;
    }
    for _ in 0..BISECTIONS {
        let middle = 0.5 * (low + high);
        if ratio(middle) > now / before {
            low = middle;
        } else {
            high = middle;
        }
    }
    let power = 0.5 * (low + high);
    Some(Limit {
        at: c[1] + now / (power * second).exp_m1(),
        power,
    })
}
