//! Detection of zeros between two points of a curve: none missed, none invented.
//!
//! A change of sign shows a zero. Two zeros in one step show by the slopes: the cubic with the values and slopes at both ends
//! dips to zero, or is so bent that it may; the step is then halved for a look, and at last looked at where the cubic dips.

use super::{CurveStep, SolutionCurve, Watched};

/// A value with its slope along the curve, where there is one.
pub(super) type Value = (f64, Option<f64>);

/// The values of all that is watched at a point.
#[derive(Clone)]
pub(super) struct Known {
    values: Vec<Value>,
    /// Whether they have all slopes, and not the cheap ones alone.
    is_whole: bool,
}

/// A place on a step: its distance, the point, and what is known there.
#[derive(Clone)]
pub(super) struct Sample<P, V> {
    pub at: f64,
    pub point: P,
    pub value: V,
}

/// A change of sign between two places.
pub(super) struct Bracket<C: SolutionCurve> {
    pub watch: Watched<C>,
    pub ends: [Sample<C::Point, f64>; 2],
}

/// Halvings of a step, and looks at a dip that is left.
const DEPTH: usize = 6;
const LOOKS: usize = 3;
/// An extremum of the cubic below this part of the values at both ends is looked at.
const DIP: f64 = 0.25;
/// So is a step whose cubic turns by more than this part of them.
const BENT: f64 = 0.6;
/// A function that is costly to differentiate and changes by less than this part of it, on a step and by its slope where that is known, has no
/// two zeros there.
const CALM: f64 = 0.2;
/// Between smaller values it may be noise that dips.
const NOISE: f64 = 1e-14;

/// All changes of sign on a step, at the beginning of which the values may be known; and the values at its end.
pub(super) fn sign_changes<C: SolutionCurve>(
    curve: &mut C,
    step: &CurveStep<C::Point>,
    known: Option<Known>,
    watches: &[Watched<C>],
) -> (Vec<Bracket<C>>, Known) {
    let mut look = Look {
        curve,
        step,
        watches,
        found: Vec::new(),
    };
    let mut start = known.unwrap_or_else(|| look.known(&step.from));
    let mut end = look.known(&step.to);
    if !look.is_calm(&start, &end) {
        look.complete(&mut start, &step.from);
        look.complete(&mut end, &step.to);
    }
    let start = Sample {
        at: 0.0,
        point: step.from.clone(),
        value: start.values,
    };
    let at_end = Sample {
        at: step.length,
        point: step.to.clone(),
        value: end.values.clone(),
    };
    look.between(&start, &at_end, 0);
    (look.found, end)
}

struct Look<'a, C: SolutionCurve> {
    curve: &'a mut C,
    step: &'a CurveStep<C::Point>,
    watches: &'a [Watched<C>],
    found: Vec<Bracket<C>>,
}

impl<C: SolutionCurve> Look<'_, C> {
    /// The values at a point, with those slopes that are cheap.
    fn known(&mut self, point: &C::Point) -> Known {
        let watches = self.watches.iter().copied();
        let cheap: Vec<_> = watches.filter(|&w| !self.curve.is_costly(w)).collect();
        let mut slopes = self
            .curve
            .slopes(point, &cheap, self.step.length)
            .into_iter();
        let value = |&watch: &Watched<C>| {
            let is_costly = self.curve.is_costly(watch);
            let slope = if is_costly {
                None
            } else {
                slopes.next().flatten()
            };
            (self.curve.value(point, watch), slope)
        };
        Known {
            values: self.watches.iter().map(value).collect(),
            is_whole: cheap.len() == self.watches.len(),
        }
    }

    /// With all slopes.
    fn complete(&mut self, known: &mut Known, point: &C::Point) {
        if known.is_whole {
            return;
        }
        let slopes = self.curve.slopes(point, self.watches, self.step.length);
        for ((_, slope), found) in known.values.iter_mut().zip(slopes) {
            *slope = found;
        }
        known.is_whole = true;
    }

    /// Whether no function that is costly to differentiate can have two zeros on the step, as little as they change.
    fn is_calm(&self, start: &Known, end: &Known) -> bool {
        if !self.curve.is_straight(self.step) {
            return false;
        }
        let values = start.values.iter().zip(&end.values);
        let mut costly = values
            .zip(self.watches)
            .filter(|(_, w)| self.curve.is_costly(**w));
        costly.all(|((&(p, slope), &(q, _)), _)| {
            let allowed = CALM * p.abs().min(q.abs());
            let by_slope = slope.map_or(0.0, |slope| slope * self.step.length);
            (q - p).abs() < allowed && by_slope.abs() < allowed
        })
    }

    fn sample(&mut self, at: f64, point: C::Point) -> Sample<C::Point, Vec<Value>> {
        let mut known = self.known(&point);
        self.complete(&mut known, &point);
        Sample {
            at,
            point,
            value: known.values,
        }
    }

    fn between(
        &mut self,
        a: &Sample<C::Point, Vec<Value>>,
        b: &Sample<C::Point, Vec<Value>>,
        depth: usize,
    ) {
        let length = b.at - a.at;
        let pairs = a.value.iter().zip(&b.value);
        let mut pairs = pairs.zip(self.watches.iter().map(|&w| self.curve.is_scaled(w)));
        let at = if depth < DEPTH {
            let halve = pairs.any(|((a, b), scaled)| suspicious((*a, *b), length, scaled));
            halve.then_some(0.5 * (a.at + b.at))
        } else if depth < DEPTH + LOOKS {
            let noise = self.curve.flat().max(NOISE);
            let part = pairs
                .find_map(|((a, b), scaled)| dip(*a, *b, length, if scaled { noise } else { 0.0 }));
            part.map(|part| a.at + part * length)
        } else {
            None
        };
        let known = [(a.at, &a.point), (b.at, &b.point)];
        if let Some(at) = at
            && let Ok(point) = self.curve.between(&self.step.from, known, at)
        {
            let middle = self.sample(at, point);
            self.between(a, &middle, depth + 1);
            self.between(&middle, b, depth + 1);
            return;
        }
        for (i, &watch) in self.watches.iter().enumerate() {
            if crosses(a.value[i].0, b.value[i].0) {
                let ends = [a, b].map(|x| Sample {
                    at: x.at,
                    point: x.point.clone(),
                    value: x.value[i].0,
                });
                self.found.push(Bracket { watch, ends });
            }
        }
    }
}

/// Whether a function has a zero after one value and up to the other: one at the first belongs to what came before.
fn crosses(a: f64, b: f64) -> bool {
    a.is_finite() && b.is_finite() && (a * b < 0.0 || (b == 0.0 && a != 0.0))
}

/// The cubic with these values and slopes at the ends of a step, p + u s + c s^2 + d s^3 on 0 <= s <= 1.
struct Cubic {
    p: f64,
    q: f64,
    u: f64,
    c: f64,
    d: f64,
}

impl Cubic {
    fn new(a: Value, b: Value, length: f64) -> Option<Self> {
        let ((p, Some(u)), (q, Some(v))) = (a, b) else {
            return None;
        };
        let (u, v) = (u * length, v * length);
        let (c, d) = (3.0 * (q - p) - 2.0 * u - v, 2.0 * (p - q) + u + v);
        Some(Cubic { p, q, u, c, d })
    }

    /// The lesser of both values.
    fn least(&self) -> f64 {
        self.p.abs().min(self.q.abs())
    }

    /// The place of an extremum away from the straight way between both ends: at zero or beyond, or farther out than both.
    fn aside(&self) -> Option<f64> {
        let &Cubic { p, q, u, c, d } = self;
        let discriminant = c * c - 3.0 * d * u;
        if discriminant < 0.0 {
            return None;
        }
        let root = discriminant.sqrt();
        let turns = [
            (-c + root) / (3.0 * d),
            (-c - root) / (3.0 * d),
            -0.5 * u / c,
        ];
        turns.into_iter().find(|&s| {
            let value = p + s * (u + s * (c + s * d));
            let dips = value * p < DIP * self.least() * p.abs();
            let overshoots = value.abs() > p.abs().max(q.abs());
            s > 0.0 && s < 1.0 && if p * q > 0.0 { dips } else { overshoots }
        })
    }
}

/// Whether something may hide between two values: a function begins or ends, or its cubic is bent or turns. Where values are of order one, those
/// that are not small are not looked at for a bend.
fn suspicious((a, b): (Value, Value), length: f64, scaled: bool) -> bool {
    if a.0.is_nan() != b.0.is_nan() {
        return true;
    }
    let Some(cubic) = Cubic::new(a, b, length) else {
        return false;
    };
    let Cubic { p, q, c, d, .. } = cubic;
    let bent = (c.abs() + d.abs()) > BENT * (p.abs() + q.abs()) && (!scaled || cubic.least() < 0.5);
    bent || cubic.aside().is_some()
}

/// Where the cubic dips between two values of one sign that are greater than this.
fn dip(a: Value, b: Value, length: f64, noise: f64) -> Option<f64> {
    let cubic = Cubic::new(a, b, length)?;
    let clear = a.0 * b.0 > 0.0 && cubic.least() > noise;
    cubic.aside().filter(|_| clear)
}
