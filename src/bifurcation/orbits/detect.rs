//! Detection of bifurcations between two orbits of a continuation: zeros of test functions, none missed, none invented.
//!
//! A change of sign shows a zero. Two zeros in one step show by the slopes: the cubic with the values and slopes at both ends
//! dips to zero, or does not fit the midpoint; the step is then halved for a look.

use crate::model::STIFFNESS;
use crate::orbit::{
    Condition, Corrector, DirectedPoint, Goal, Palc, ParametrisedField, Regular, Spectrum,
    TestFunction,
};

/// What is watched along a continuation.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum WatchedFunction {
    /// A test function.
    TestFunction(TestFunction),
    /// The direction's component along a parameter: zero at folds of a branch, at tops of a curve.
    Turn(usize),
    /// A parameter's coordinate less this value.
    Value(usize, f64),
}

/// A zero between two orbits.
#[derive(Debug, Clone)]
pub(super) struct Zero<const N: usize> {
    pub watch: WatchedFunction,
    /// The distance from the orbit before, along the direction there.
    pub at: f64,
    /// An orbit near it.
    pub near: DirectedPoint<N>,
    /// Whether the values at both ends are far from zero, so that no noise changes their signs.
    pub clear: bool,
}

/// What is watched, with the slopes along the continuation where there are such.
pub(super) type Values = Vec<(f64, Option<f64>)>;

/// A place on the step, with what is watched there.
#[derive(Debug, Clone)]
struct StepPosition<const N: usize> {
    at: f64,
    now: DirectedPoint<N>,
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

impl WatchedFunction {
    /// The value, scaled to be of order one, and its slope where there is one.
    fn value<const N: usize>(
        self,
        now: &DirectedPoint<N>,
        slope: Option<&Spectrum>,
    ) -> (f64, Option<f64>) {
        match self {
            WatchedFunction::Turn(i) => (now.direction.parameters[i], None),
            WatchedFunction::Value(i, value) => (
                now.here.site.at[i] - value,
                Some(now.direction.parameters[i]),
            ),
            WatchedFunction::TestFunction(test_function) => {
                let at = &now.here.spectrum;
                let (value, size) = (test_function.of::<N>(at), size::<N>(test_function, at));
                let slope = slope.map(|by| test_function.change_along::<N>(at, by) / size);
                (value / size, slope)
            }
        }
    }
}

pub(super) fn size<const N: usize>(test_function: TestFunction, at: &Spectrum) -> f64 {
    match test_function {
        TestFunction::Fold | TestFunction::Doubling if N == 3 => {
            1.0 + at.trace.abs() + at.volume.exp()
        }
        _ => 1.0,
    }
}

/// All zeros on the step from `before`, where the values may be known, to where the continuation stands, by distance; and the values
/// there.
pub(super) fn zeros<F: ParametrisedField<N>, const N: usize>(
    palc: &mut Palc<'_, '_, F, N>,
    (before, known): (&DirectedPoint<N>, Option<Values>),
    length: f64,
    watches: &[WatchedFunction],
) -> (Vec<Zero<N>>, Values) {
    let start = match known {
        Some(values) => StepPosition {
            at: 0.0,
            now: before.clone(),
            values,
        },
        None => place(palc.corrector, before.clone(), 0.0, watches),
    };
    let end = place(palc.corrector, palc.now.clone(), length, watches);
    let mut found = Vec::new();
    look(palc, before, &start, &end, watches, DEPTH, &mut found);
    found.sort_by(|a: &Zero<N>, b| a.at.total_cmp(&b.at));
    (found, end.values)
}

fn place<F: ParametrisedField<N>, const N: usize>(
    corrector: &mut Corrector<'_, F, N>,
    now: DirectedPoint<N>,
    at: f64,
    watches: &[WatchedFunction],
) -> StepPosition<N> {
    let test_functions = watches
        .iter()
        .any(|w| matches!(w, WatchedFunction::TestFunction(_)));
    let slope = test_functions
        .then(|| corrector.slope(&now.here, &now.direction))
        .flatten();
    let values = watches.iter().map(|w| w.value(&now, slope.as_ref()));
    StepPosition {
        at,
        values: values.collect(),
        now,
    }
}

fn look<F: ParametrisedField<N>, const N: usize>(
    palc: &mut Palc<'_, '_, F, N>,
    before: &DirectedPoint<N>,
    a: &StepPosition<N>,
    b: &StepPosition<N>,
    watches: &[WatchedFunction],
    depth: usize,
    found: &mut Vec<Zero<N>>,
) {
    let length = b.at - a.at;
    let pairs = a.values.iter().zip(&b.values);
    if depth > 0 && pairs.clone().any(|(a, b)| suspicious(*a, *b, length)) {
        let middle = 0.5 * (a.at + b.at);
        if let Some(now) = palc.correct_from(before, middle) {
            let m = place(palc.corrector, now, middle, watches);
            look(palc, before, a, &m, watches, depth - 1, found);
            look(palc, before, &m, b, watches, depth - 1, found);
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
                    WatchedFunction::Turn(_) => false,
                    WatchedFunction::TestFunction(_) => clear,
                    WatchedFunction::Value(..) => true,
                },
                watch: watches[i],
                at: a.at + part * length,
                near: if part < 0.5 {
                    a.now.clone()
                } else {
                    b.now.clone()
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

/// The orbit at a zero, to the accuracy of the continuation's corrector or of another, found by Newton's method on the condition itself.
pub(super) fn landed<F: ParametrisedField<N>, const N: usize>(
    palc: &mut Palc<'_, '_, F, N>,
    before: &DirectedPoint<N>,
    length: f64,
    zero: &Zero<N>,
    goal: Goal,
) -> Option<Regular<N>> {
    if zero.watch == WatchedFunction::Turn(STIFFNESS) && palc.settings.test_function.is_some() {
        // Along a curve of bifurcations a turn has no condition of its own.
        return turned(palc, before, length, zero.at);
    }
    let condition = match zero.watch {
        WatchedFunction::TestFunction(test_function) => Condition::TestFunction(test_function),
        WatchedFunction::Value(i, value) => Condition::Parameter(i, value),
        // Along a branch a turn is a fold.
        WatchedFunction::Turn(_) => Condition::TestFunction(TestFunction::Fold),
    };
    let conditions = palc.settings.and(condition);
    let free = palc.settings.free.clone();
    let mut ends = (before.clone(), palc.now.clone());
    let mut at = zero.at;
    let (mut low, mut high) = (0.0, length);
    for _ in 0..ATTEMPTS {
        let guess = palc.correct_from(before, at);
        let starts = [
            guess.as_ref(),
            Some(&zero.near),
            Some(&ends.0),
            Some(&ends.1),
        ];
        for start in starts.into_iter().flatten() {
            let site = start.here.site.clone();
            let found = palc.corrector.correct(site, &free, &conditions, goal);
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
        let value = |now: &DirectedPoint<N>| zero.watch.value(now, None).0;
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
fn turned<F: ParametrisedField<N>, const N: usize>(
    palc: &mut Palc<'_, '_, F, N>,
    before: &DirectedPoint<N>,
    length: f64,
    first: f64,
) -> Option<Regular<N>> {
    /// Iterations, and a slope that is small enough.
    const ITERATIONS: usize = 8;
    const FLAT: f64 = 1e-3;
    let slope = |now: &DirectedPoint<N>| now.direction.parameters[STIFFNESS];
    let mut low = (0.0, slope(before));
    let mut high = (length, slope(&palc.now));
    let (mut at, mut found) = (first, None);
    for _ in 0..ITERATIONS {
        let Some(now) = palc.correct_from(before, at) else {
            break;
        };
        let here = slope(&now);
        found = Some(now.here);
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
