//! Landing on a zero between two points of a curve.

use super::detect::{Bracket, Sample};
use super::{CurveStep, SolutionCurve, Watched};
use crate::error::Result;

/// How often a zero is tried to be landed on by Newton's method.
const ATTEMPTS: usize = 12;
/// Part of the step by which the zero may lie outside its bracket: what corrections err by, but within the step another zero may be
/// next to it.
const BEYOND: f64 = 0.1;
const WITHIN: f64 = 1e-6;
/// What the values at both ends of a bracket have shrunk to, as a part of what they were, where there is a zero within.
const SHRUNK: f64 = 0.05;
/// Evaluations for one zero in a bracket, which at least halves with every third.
const EVALUATIONS: usize = 100;

/// The point at a zero with its distance: by Newton's method, which may find none, where the curve knows the condition; else in the
/// bracket.
pub(super) fn landed<C: SolutionCurve>(
    curve: &mut C,
    step: &CurveStep<C::Point>,
    zero: &Bracket<C>,
) -> Result<Option<(f64, C::Point)>> {
    if !curve.solves(zero.watch) {
        return bracketed(curve, step, zero).map(Some);
    }
    let [mut low, mut high] = zero.ends.clone();
    let part = first_fraction(low.value, high.value);
    let near = if part < 0.5 { &low } else { &high }.point.clone();
    let width = high.at - low.at;
    let margin = step.length * if width < step.length { WITHIN } else { BEYOND };
    let margin = margin + curve.error(&low.point).max(curve.error(&high.point));
    let inside = low.at - margin..high.at + margin;
    let mut at = low.at + part * width;
    for _ in 0..ATTEMPTS {
        let guess = curve.correct(&step.from, at).ok().map(|found| found.0);
        let starts = match &guess {
            Some(guess) => vec![guess],
            None => vec![&near, &low.point, &high.point],
        };
        for start in starts {
            let found = curve.solve(&step.from, start, zero.watch);
            if let Some(found) = found.filter(|found| inside.contains(&found.0)) {
                return Ok(Some(found));
            }
        }
        // By halves, then, until Newton's method stays; and from elsewhere where it does not even find a point.
        let Some(point) = guess else {
            let lower = at - low.at > high.at - at;
            at = 0.5 * (at + if lower { low.at } else { high.at });
            continue;
        };
        let value = curve.value(&point, zero.watch);
        let end = if value * zero.ends[0].value > 0.0 {
            &mut low
        } else {
            &mut high
        };
        *end = Sample { at, point, value };
        at = 0.5 * (low.at + high.at);
    }
    // At a branch point Newton's method fails, as the condition is singular there. The values then tend to zero from both sides; at a pole, or in
    // noise, they do not.
    let all = zero.ends.each_ref().map(|end| end.value);
    let least = SHRUNK * all[0].abs().min(all[1].abs());
    if low.value.abs().max(high.value.abs()) > least {
        return Ok(None);
    }
    let nearer = if low.value.abs() < high.value.abs() {
        low
    } else {
        high
    };
    Ok(Some((nearer.at, nearer.point)))
}

/// Whether a function has another sign before a point at which it was landed on than behind it, on a step of this length: where it only touches zero
/// it has not, nor where it is zero within its noise.
pub(crate) fn changes_sign<C: SolutionCurve>(
    curve: &mut C,
    watch: Watched<C>,
    at: &C::Point,
    length: f64,
) -> bool {
    /// Parts of the step, the nearest first: another zero may be next to this one.
    const ASIDE: [f64; 4] = [1e-4, 1e-3, 1e-2, 0.1];
    for aside in ASIDE {
        let mut side = |distance: f64| {
            let (there, _) = curve.correct(at, distance).ok()?;
            Some(curve.value(&there, watch))
        };
        let [Some(a), Some(b)] = [-aside * length, aside * length].map(&mut side) else {
            continue;
        };
        if a * b != 0.0 {
            return a * b < 0.0;
        }
    }
    false
}

/// In the bracket, by inverse quadratic interpolation on the distance (Chandrupatla 1997).
fn bracketed<C: SolutionCurve>(
    curve: &mut C,
    step: &CurveStep<C::Point>,
    zero: &Bracket<C>,
) -> Result<(f64, C::Point)> {
    let [mut a, mut b] = zero.ends.clone();
    let nearer = |a: &Sample<C::Point, f64>, b: &Sample<C::Point, f64>| {
        if a.value.abs() < b.value.abs() { a } else { b }.clone()
    };
    let mut best = nearer(&a, &b);
    let mut t = first_fraction(a.value, b.value).clamp(0.01, 0.99);
    let flat = curve.flat();
    for _ in 0..EVALUATIONS {
        let width = (b.at - a.at).abs();
        let limit = 2.0 * f64::EPSILON * (best.at.abs() + 0.01 * step.length);
        if best.value.abs() <= flat || width <= 2.0 * limit {
            break;
        }
        let margin = (limit / width).min(0.5);
        let x = beside(curve, step, zero, [&a, &b], t.clamp(margin, 1.0 - margin))?;
        let c = if x.value.signum() == a.value.signum() {
            std::mem::replace(&mut a, x)
        } else {
            std::mem::replace(&mut b, std::mem::replace(&mut a, x))
        };
        best = nearer(&a, &b);
        t = next_fraction([a.at, b.at, c.at], [a.value, b.value, c.value]);
    }
    Ok((best.at, best.point))
}

/// At this part of the bracket, or beside it: next to a branch point, which may be just where a zero is supposed, no point can be
/// corrected.
fn beside<C: SolutionCurve>(
    curve: &mut C,
    step: &CurveStep<C::Point>,
    zero: &Bracket<C>,
    [a, b]: [&Sample<C::Point, f64>; 2],
    t: f64,
) -> Result<Sample<C::Point, f64>> {
    /// Parts of the bracket.
    const ASIDE: [f64; 6] = [1e-3, -1e-3, 0.03, -0.03, 0.3, -0.3];
    let mut sample = |t: f64| {
        let at = a.at + t * (b.at - a.at);
        let known = [(a.at, &a.point), (b.at, &b.point)];
        let point = curve.between(&step.from, known, at)?;
        let value = curve.value(&point, zero.watch);
        Ok(Sample { at, point, value })
    };
    sample(t).or_else(|error| {
        let inside = ASIDE.map(|aside| t + aside).into_iter();
        let mut inside = inside.filter(|t| *t > 0.0 && *t < 1.0);
        inside.find_map(|t| sample(t).ok()).ok_or(error)
    })
}

/// The zero of the straight line between two values, as a part of the way from the first.
fn first_fraction(a: f64, b: f64) -> f64 {
    a / (a - b)
}

/// Where in the bracket to look next, as a part of it from its first end.
fn next_fraction([a, b, c]: [f64; 3], [fa, fb, fc]: [f64; 3]) -> f64 {
    let xi = (a - b) / (c - b);
    let phi = (fa - fb) / (fc - fb);
    if phi * phi < xi && (1.0 - phi) * (1.0 - phi) < 1.0 - xi {
        fa / (fb - fa) * fc / (fb - fc) + (c - a) / (b - a) * fa / (fc - fa) * fb / (fc - fb)
    } else {
        0.5
    }
}
