//! What happens between two orbits of a walk: zeros of what is watched, none missed, none invented.
//!
//! A change of sign shows a zero. Two zeros in one step show by the slopes: the cubic with the values and slopes at both ends
//! dips to zero, or does not fit the midpoint; the step is then halved for a look.

use crate::orbit::{Condition, Corrector, Family, Goal, Indicator, Pace, Regular, Spectrum, Walk};

/// What is watched along a walk.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Watch {
    /// An indicator.
    Indicator(Indicator),
    /// The direction's component along a parameter: zero at folds of a branch, at tops of a curve.
    Turn(usize),
    /// A parameter's coordinate less this value.
    Value(usize, f64),
}

/// A zero between two orbits.
#[derive(Debug, Clone)]
pub(super) struct Zero<const N: usize> {
    pub watch: Watch,
    /// The distance from the orbit before, along the direction there.
    pub at: f64,
    /// An orbit near it.
    pub near: Pace<N>,
    /// Whether the values at both ends are far from zero, so that no noise changes their signs.
    pub clear: bool,
}

/// What is watched, with the slopes along the walk where there are such.
pub(super) type Values = Vec<(f64, Option<f64>)>;

/// A place on the step, with what is watched there.
#[derive(Debug, Clone)]
struct Place<const N: usize> {
    at: f64,
    pace: Pace<N>,
    values: Values,
}

/// Values beyond this are no noise. Of turns nothing can be said by their values.
const CLEAR: f64 = 1e-5;
/// How often a zero is tried to be landed on.
const ATTEMPTS: usize = 12;
/// Halvings of a step.
const DEPTH: usize = 6;
/// An extremum of the cubic below this part of the values at both ends is looked at.
const DIP: f64 = 0.25;
/// So is a step whose cubic turns by more than this part of them.
const BENT: f64 = 0.6;

impl Watch {
    /// The value, scaled to be of order one, and its slope where there is one.
    fn value<const N: usize>(self, pace: &Pace<N>, slope: Option<&Spectrum>) -> (f64, Option<f64>) {
        match self {
            Watch::Turn(i) => (pace.direction.parameters[i], None),
            Watch::Value(i, value) => (
                pace.here.site.at[i] - value,
                Some(pace.direction.parameters[i]),
            ),
            Watch::Indicator(indicator) => {
                let at = &pace.here.spectrum;
                let (value, size) = (indicator.of::<N>(at), size::<N>(indicator, at));
                let slope = slope.map(|by| indicator.change_along::<N>(at, by) / size);
                (value / size, slope)
            }
        }
    }
}

pub(super) fn size<const N: usize>(indicator: Indicator, at: &Spectrum) -> f64 {
    match indicator {
        Indicator::Fold | Indicator::Doubling if N > 2 => 1.0 + at.trace.abs() + at.volume.exp(),
        _ => 1.0,
    }
}

/// All zeros on the step from `before`, where the values may be known, to where the walk stands, by distance; and the values
/// there.
pub(super) fn zeros<F: Family<N>, const N: usize>(
    walk: &mut Walk<'_, '_, F, N>,
    (before, known): (&Pace<N>, Option<Values>),
    length: f64,
    watches: &[Watch],
) -> (Vec<Zero<N>>, Values) {
    let start = match known {
        Some(values) => Place {
            at: 0.0,
            pace: before.clone(),
            values,
        },
        None => place(walk.corrector, before.clone(), 0.0, watches),
    };
    let end = place(walk.corrector, walk.pace.clone(), length, watches);
    let mut found = Vec::new();
    look(walk, before, &start, &end, watches, DEPTH, &mut found);
    found.sort_by(|a: &Zero<N>, b| a.at.total_cmp(&b.at));
    (found, end.values)
}

fn place<F: Family<N>, const N: usize>(
    corrector: &mut Corrector<'_, F, N>,
    pace: Pace<N>,
    at: f64,
    watches: &[Watch],
) -> Place<N> {
    let indicators = watches.iter().any(|w| matches!(w, Watch::Indicator(_)));
    let slope = indicators
        .then(|| corrector.slope(&pace.here, &pace.direction))
        .flatten();
    let values = watches.iter().map(|w| w.value(&pace, slope.as_ref()));
    Place {
        at,
        values: values.collect(),
        pace,
    }
}

fn look<F: Family<N>, const N: usize>(
    walk: &mut Walk<'_, '_, F, N>,
    before: &Pace<N>,
    a: &Place<N>,
    b: &Place<N>,
    watches: &[Watch],
    depth: usize,
    found: &mut Vec<Zero<N>>,
) {
    let length = b.at - a.at;
    let pairs = a.values.iter().zip(&b.values);
    if depth > 0 && pairs.clone().any(|(a, b)| suspicious(*a, *b, length)) {
        let middle = 0.5 * (a.at + b.at);
        if let Some(pace) = walk.beyond(before, middle) {
            let m = place(walk.corrector, pace, middle, watches);
            look(walk, before, a, &m, watches, depth - 1, found);
            look(walk, before, &m, b, watches, depth - 1, found);
            return;
        }
    }
    for (i, (&(left, _), &(right, _))) in pairs.enumerate() {
        // A value that is zero at an end belongs to the piece before.
        if left * right < 0.0 || (right == 0.0 && left != 0.0) {
            let part = left / (left - right);
            let clear = left.abs().min(right.abs()) > CLEAR;
            found.push(Zero {
                clear: match watches[i] {
                    Watch::Turn(_) => false,
                    Watch::Indicator(_) => clear,
                    Watch::Value(..) => true,
                },
                watch: watches[i],
                at: a.at + part * length,
                near: if part < 0.5 {
                    a.pace.clone()
                } else {
                    b.pace.clone()
                },
            });
        }
    }
}

/// Whether the cubic with these values and slopes at the ends of a step hides something.
fn suspicious(a: (f64, Option<f64>), b: (f64, Option<f64>), length: f64) -> bool {
    let ((p, Some(u)), (q, Some(v))) = (a, b) else {
        return false;
    };
    let (u, v) = (u * length, v * length);
    // p + u s + c s^2 + d s^3 on 0 <= s <= 1.
    let (c, d) = (3.0 * (q - p) - 2.0 * u - v, 2.0 * (p - q) + u + v);
    let least = p.abs().min(q.abs());
    if (c.abs() + d.abs()) > BENT * (p.abs() + q.abs()) && least < 0.5 {
        return true;
    }
    let discriminant = c * c - 3.0 * d * u;
    if discriminant < 0.0 {
        return false;
    }
    let root = discriminant.sqrt();
    let turns = [
        (-c + root) / (3.0 * d),
        (-c - root) / (3.0 * d),
        -0.5 * u / c,
    ];
    turns.into_iter().any(|s| {
        let value = p + s * (u + s * (c + s * d));
        // Away from the straight way between both ends: at zero or beyond, or farther out than both.
        let dips = value * p < DIP * least * p.abs();
        let overshoots = value.abs() > p.abs().max(q.abs());
        s > 0.0 && s < 1.0 && if p * q > 0.0 { dips } else { overshoots }
    })
}

/// The orbit at a zero, to the accuracy of the walk's corrector or of another, found by Newton's method on the condition itself.
pub(super) fn landed<F: Family<N>, const N: usize>(
    walk: &mut Walk<'_, '_, F, N>,
    before: &Pace<N>,
    length: f64,
    zero: &Zero<N>,
    goal: Goal,
) -> Option<Regular<N>> {
    if zero.watch == Watch::Turn(1) && walk.path.indicator.is_some() {
        // Along a curve of bifurcations a turn has no condition of its own.
        return turned(walk, before, length, zero.at);
    }
    let condition = match zero.watch {
        Watch::Indicator(indicator) => Condition::Indicator(indicator),
        Watch::Value(i, value) => Condition::Parameter(i, value),
        // Along a branch a turn is a fold.
        Watch::Turn(_) => Condition::Indicator(Indicator::Fold),
    };
    let conditions = walk.path.and(condition);
    let free = walk.path.free.clone();
    let mut ends = (before.clone(), walk.pace.clone());
    let mut at = zero.at;
    let (mut low, mut high) = (0.0, length);
    for _ in 0..ATTEMPTS {
        let guess = walk.beyond(before, at);
        let starts = [
            guess.as_ref(),
            Some(&zero.near),
            Some(&ends.0),
            Some(&ends.1),
        ];
        for start in starts.into_iter().flatten() {
            let site = start.here.site.clone();
            let found = walk.corrector.correct(site, &free, &conditions, goal);
            if let Ok(found) = found {
                let there = before.direction.dot(&found.site.from(&before.here.site));
                if there > -0.1 * length && there < 1.1 * length {
                    return Some(found);
                }
            }
            if guess.is_some() {
                break;
            }
        }
        // By halves, then, until Newton's method stays; and from elsewhere where it does not even find an orbit.
        let Some(guess) = guess else {
            at = 0.5 * (at + if at - low > high - at { low } else { high });
            continue;
        };
        let value = |pace: &Pace<N>| zero.watch.value(pace, None).0;
        if value(&guess) * value(before) > 0.0 {
            (low, ends.0) = (at, guess);
        } else {
            (high, ends.1) = (at, guess);
        }
        at = 0.5 * (low + high);
    }
    None
}

/// Where K turns on the step, by false position from a first guess: long steps bend by more than one straight line tells.
fn turned<F: Family<N>, const N: usize>(
    walk: &mut Walk<'_, '_, F, N>,
    before: &Pace<N>,
    length: f64,
    first: f64,
) -> Option<Regular<N>> {
    /// Iterations, and a slope that is small enough.
    const ITERATIONS: usize = 8;
    const FLAT: f64 = 1e-3;
    let slope = |pace: &Pace<N>| pace.direction.parameters[1];
    let mut low = (0.0, slope(before));
    let mut high = (length, slope(&walk.pace));
    let (mut at, mut found) = (first, None);
    for _ in 0..ITERATIONS {
        let Some(pace) = walk.beyond(before, at) else {
            break;
        };
        let here = slope(&pace);
        found = Some(pace.here);
        if here.abs() < FLAT {
            break;
        }
        if here * low.1 > 0.0 {
            low = (at, here);
        } else {
            high = (at, here);
        }
        at = (low.0 * high.1 - high.0 * low.1) / (high.1 - low.1);
    }
    found
}
