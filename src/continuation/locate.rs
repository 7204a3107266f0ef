//! What lies within one step: zeros of the test functions, wanted values, the ends of the range.

use super::correct::{Hyperplane, joined, onto, tangent};
use super::signs::{crosses, next_fraction, vertex};
use super::{CurveObserver, CurvePoint, PointKind, Settings, ZeroProblem};
use crate::error::Result;
use nalgebra::DVector;

/// Looks at a supposed dip in a test function, per step.
const LOOKS: usize = 12;
/// A dip is looked at where the parabola falls below this part of the value in the middle.
const DIP: f64 = 0.5;
/// And where it falls below this part of both values outside: the parabola itself errs by some of these.
const DEEP: f64 = 0.02;
/// Nearer to a known value than this part of the step nothing is looked at: two zeros closer than that stay unseen.
const NEAR: f64 = 1e-7;
/// Where points can no longer be corrected, as next to a branch point, the chord of a bracket narrower than this part of the
/// step is as good.
const NARROW: f64 = 1e-4;
/// Evaluations for one zero: the bracket at least halves with every third.
const EVALUATIONS: usize = 100;

/// One step of a curve, on which every point can be had.
pub(super) struct CurveStep<'a> {
    pub problem: &'a dyn ZeroProblem,
    pub settings: &'a Settings,
    pub from: &'a CurvePoint,
    pub to: &'a CurvePoint,
    pub length: f64,
}

/// A point within the step, the distance to its plane, and all functions that are watched.
#[derive(Debug, Clone)]
struct Sample {
    s: f64,
    point: CurvePoint,
    values: Vec<f64>,
}

/// Something met on the way.
#[derive(Debug, Clone)]
pub(super) struct Located {
    pub s: f64,
    pub point: CurvePoint,
    pub mark: PointKind,
}

impl CurveStep<'_> {
    /// Both ends.
    fn ends(&self, watch: &dyn CurveObserver) -> Result<[Sample; 2]> {
        let sample = |s: f64, point: &CurvePoint| {
            let values = values(self.settings, watch, point)?;
            let point = point.clone();
            Ok(Sample { s, point, values })
        };
        Ok([sample(0.0, self.from)?, sample(self.length, self.to)?])
    }

    /// At distance s along the tangent of the first point, between two places that are known.
    fn sample(&self, watch: &dyn CurveObserver, a: &Sample, b: &Sample, s: f64) -> Result<Sample> {
        let (guess, along) = self.between(a, b, s);
        let point = self.corrected(&guess, &Hyperplane::ahead(self.from, s), s, &along)?;
        let values = values(self.settings, watch, &point)?;
        Ok(Sample { s, point, values })
    }

    /// Hermite's cubic between two samples, and the mean of their tangents.
    fn between(&self, a: &Sample, b: &Sample, s: f64) -> (DVector<f64>, DVector<f64>) {
        let h = b.s - a.s;
        let (t, r) = ((s - a.s) / h, (b.s - s) / h);
        let [x0, x1] = [a, b].map(|x| joined(&x.point.u, x.point.lambda));
        let slope = |x: &Sample| &x.point.tangent * (h / x.point.tangent.dot(&self.from.tangent));
        let (d0, d1) = (slope(a), slope(b));
        let across = x1 - &x0;
        let place = x0 + &across * (t * t * (3.0 - 2.0 * t)) + d0 * (t * r * r) - d1 * (t * t * r);
        // of places that differ by rounding the difference has no direction
        let direction = &a.point.tangent * r + &b.point.tangent * t;
        let length = direction.norm();
        (place, direction / length)
    }

    fn corrected(
        &self,
        guess: &DVector<f64>,
        plane: &Hyperplane,
        s: f64,
        along: &DVector<f64>,
    ) -> Result<CurvePoint> {
        let n = self.problem.dimension();
        let (x, _) = onto(self.problem, guess, plane, self.settings.tolerance)?;
        // at a branch point there is more than one tangent: the interpolant's is that of this curve
        let tangent = tangent(self.problem, &x, along)
            .ok()
            .filter(|t| t.dot(along) > self.settings.largest_turn.cos())
            .unwrap_or_else(|| along.clone());
        Ok(CurvePoint {
            u: x.rows(0, n).into_owned(),
            lambda: x[n],
            tangent,
            arclength: self.from.arclength + s,
        })
    }

    /// Where the step comes back to the curve's first point.
    fn closing(&self, [a, b]: [&Sample; 2], first: &CurvePoint) -> Option<Located> {
        /// Two points are one if they differ by no more than this many tolerances.
        const SAME: f64 = 1e5;
        let x = joined(&first.u, first.lambda);
        let s = self
            .from
            .tangent
            .dot(&(&x - joined(&self.from.u, self.from.lambda)));
        let onward = first.tangent.dot(&self.from.tangent) > 0.0;
        if !(onward && s > 0.0 && s <= self.length) {
            return None;
        }
        let (guess, along) = self.between(a, b, s);
        let plane = Hyperplane::ahead(self.from, s);
        let point = self.corrected(&guess, &plane, s, &along).ok()?;
        let apart = (&x - joined(&point.u, point.lambda)).amax();
        let same = apart <= SAME * self.settings.tolerance * (1.0 + x.amax());
        same.then_some(Located {
            s,
            point,
            mark: PointKind::Begin,
        })
    }

    /// All that the step meets, in order; `first` is where the curve began, unless it begins here.
    pub fn met(
        &self,
        watch: &dyn CurveObserver,
        first: Option<&CurvePoint>,
    ) -> Result<Vec<Located>> {
        let [from, mut to] = self.ends(watch)?;
        let closing = first.and_then(|first| self.closing([&from, &to], first));
        // what lies behind an end of the curve is of no interest, and its mirror image before it may hide in it
        if let Some(end) = self.end(watch, &from, &to)? {
            to = end;
        }
        let middle = self.sample(watch, &from, &to, 0.5 * to.s)?;
        let mut samples = vec![from, middle, to];
        for _ in 0..LOOKS {
            let Some(s) = self.dip(&samples) else { break };
            let place = samples.partition_point(|x| x.s < s);
            let new = self.sample(watch, &samples[place - 1], &samples[place], s)?;
            samples.insert(place, new);
        }
        let mut found = self.zeros(watch, samples)?;
        found.extend(closing);
        // the curve's end last, so that what lies on it is met
        let after = |mark: PointKind| {
            matches!(
                mark,
                PointKind::Lowest | PointKind::Highest | PointKind::Begin
            )
        };
        found.sort_by(|a, b| a.s.total_cmp(&b.s).then(after(a.mark).cmp(&after(b.mark))));
        Ok(found)
    }

    /// The first end of the curve, moved behind by next to nothing, so that it is found again.
    fn end(&self, watch: &dyn CurveObserver, from: &Sample, to: &Sample) -> Result<Option<Sample>> {
        /// Part of the step.
        const BEHIND: f64 = 1e-3;
        let functions = from.values.len();
        let mut nearest = None;
        for i in 0..functions {
            let ends = match meaning(self.settings, i, functions).0 {
                PointKind::Zero(i) => watch.ends(i),
                mark => matches!(mark, PointKind::Lowest | PointKind::Highest),
            };
            if ends && crosses(from.values[i], to.values[i]) {
                let s = self.zero(watch, i, from, to)?.s + BEHIND * self.length;
                nearest = Some(nearest.map_or(s, |other: f64| other.min(s)));
            }
        }
        let within = nearest.filter(|s| *s < self.length);
        within.map(|s| self.sample(watch, from, to, s)).transpose()
    }

    /// The zeros of all functions. At each one all others are looked at too.
    fn zeros(&self, watch: &dyn CurveObserver, samples: Vec<Sample>) -> Result<Vec<Located>> {
        /// New zeros come to light by others, and these by others again: not often.
        const ROUNDS: usize = 4;
        let functions = samples[0].values.len();
        // with each sample the function of which it is a zero: that one's sign there is rounding
        let mut known: Vec<(Sample, Option<usize>)> =
            samples.into_iter().map(|x| (x, None)).collect();
        let mut found = Vec::new();
        for _ in 0..ROUNDS {
            let mut new = Vec::new();
            for i in 0..functions {
                let others: Vec<_> = known.iter().filter(|(_, of)| *of != Some(i)).collect();
                for pair in others.windows(2) {
                    let (a, b) = (&pair[0].0, &pair[1].0);
                    let inside = |(x, of): &(Sample, Option<usize>)| {
                        *of == Some(i) && x.s > a.s && x.s <= b.s
                    };
                    if crosses(a.values[i], b.values[i]) && !known.iter().any(inside) {
                        new.push((self.zero(watch, i, a, b)?, Some(i)));
                    }
                }
            }
            if new.is_empty() {
                break;
            }
            for (sample, of) in &new {
                found.push(self.landed(of.unwrap_or(0), sample.clone())?);
            }
            known.extend(new);
            known.sort_by(|(a, _), (b, _)| a.s.total_cmp(&b.s));
        }
        Ok(found)
    }

    /// Where a test function without a change of sign in three neighbours may dip through zero.
    fn dip(&self, samples: &[Sample]) -> Option<f64> {
        for three in samples.windows(3) {
            let s = [three[0].s, three[1].s, three[2].s];
            for i in 0..three[0].values.len() {
                let f = [three[0].values[i], three[1].values[i], three[2].values[i]];
                let Some((at, value)) = vertex(s, f) else {
                    continue;
                };
                let low = value * f[1].signum() < DIP * f[1].abs()
                    || value.abs() < DEEP * f[0].abs().min(f[2].abs());
                let fresh = samples
                    .iter()
                    .all(|x| (x.s - at).abs() > NEAR * self.length);
                if low && fresh {
                    return Some(at);
                }
            }
        }
        None
    }

    /// The zero of one function between two samples, by inverse quadratic interpolation in a bracket (Chandrupatla 1997).
    fn zero(&self, watch: &dyn CurveObserver, i: usize, a: &Sample, b: &Sample) -> Result<Sample> {
        let (mut a, mut b) = (b.clone(), a.clone());
        let mut best = a.clone();
        // both ends may be one point, where another function was found to be zero
        let apart = (a.s - b.s).abs() > 8.0 * f64::EPSILON * self.length;
        if best.values[i] == 0.0 || !apart {
            return Ok(best);
        }
        let mut t = (a.values[i] / (a.values[i] - b.values[i])).clamp(0.01, 0.99);
        for _ in 0..EVALUATIONS {
            let x = match self.sample_beside(watch, &a, &b, t) {
                Ok(x) => x,
                Err(_) if (b.s - a.s).abs() < NARROW * self.length => {
                    return Ok(chord(&a, &b, i));
                }
                Err(error) => return Err(error),
            };
            let c = if x.values[i].signum() == a.values[i].signum() {
                std::mem::replace(&mut a, x)
            } else {
                std::mem::replace(&mut b, std::mem::replace(&mut a, x))
            };
            best = if a.values[i].abs() < b.values[i].abs() {
                a.clone()
            } else {
                b.clone()
            };
            let width = (b.s - a.s).abs();
            let limit = 2.0 * f64::EPSILON * (best.s.abs() + 0.01 * self.length);
            if best.values[i] == 0.0 || width <= 2.0 * limit {
                break;
            }
            t = next_fraction([a.s, b.s, c.s], [a.values[i], b.values[i], c.values[i]]);
            let margin = (limit / width).min(0.5);
            t = t.clamp(margin, 1.0 - margin);
        }
        Ok(best)
    }

    /// A sample at this part of the bracket, or beside it: next to a branch point, which may be just where a zero is supposed, no
    /// point can be corrected.
    fn sample_beside(
        &self,
        watch: &dyn CurveObserver,
        a: &Sample,
        b: &Sample,
        t: f64,
    ) -> Result<Sample> {
        /// Parts of the bracket.
        const BESIDE: [f64; 6] = [1e-3, -1e-3, 0.03, -0.03, 0.3, -0.3];
        let at = |t: f64| self.sample(watch, a, b, a.s + t * (b.s - a.s));
        let beside = || {
            let inside = BESIDE.iter().map(|aside| t + aside);
            let mut inside = inside.filter(|t| *t > 0.0 && *t < 1.0);
            inside.find_map(|t| at(t).ok())
        };
        at(t).or_else(|error| beside().ok_or(error))
    }

    /// A zero as what it means; with exactly the value of lambda where it means one.
    fn landed(&self, i: usize, sample: Sample) -> Result<Located> {
        let (mark, value) = meaning(self.settings, i, sample.values.len());
        let Sample { s, mut point, .. } = sample;
        if let Some(value) = value {
            let guess = joined(&point.u, value);
            let plane = Hyperplane::lambda(self.problem.dimension(), value);
            // at a fold lambda alone does not say where; the point is there already
            if let Ok(exact) = self.corrected(&guess, &plane, s, &point.tangent) {
                point = exact;
            }
            point.lambda = value;
        }
        Ok(Located { s, point, mark })
    }
}

/// Where the i-th function is zero on the chord between two samples.
fn chord(a: &Sample, b: &Sample, i: usize) -> Sample {
    let t = a.values[i] / (a.values[i] - b.values[i]);
    let mix = |x: f64, y: f64| x + t * (y - x);
    let point = CurvePoint {
        u: &a.point.u + (&b.point.u - &a.point.u) * t,
        lambda: mix(a.point.lambda, b.point.lambda),
        tangent: a.point.tangent.clone(),
        arclength: mix(a.point.arclength, b.point.arclength),
    };
    Sample {
        s: mix(a.s, b.s),
        point,
        values: a.values.clone(),
    }
}

/// The test functions, then lambda less each wanted value, then less both ends of the range.
fn values(settings: &Settings, watch: &dyn CurveObserver, point: &CurvePoint) -> Result<Vec<f64>> {
    let mut all = watch.tests(point)?;
    all.extend(settings.wanted.iter().map(|w| point.lambda - w));
    all.push(point.lambda - settings.range.0);
    all.push(point.lambda - settings.range.1);
    Ok(all)
}

/// What the zero of the i-th function is, and its value of lambda.
fn meaning(settings: &Settings, i: usize, count: usize) -> (PointKind, Option<f64>) {
    let wanted = settings.wanted.len();
    let tests = count - wanted - 2;
    if i < tests {
        (PointKind::Zero(i), None)
    } else if i < tests + wanted {
        (
            PointKind::Wanted(i - tests),
            Some(settings.wanted[i - tests]),
        )
    } else if i == tests + wanted {
        (PointKind::Lowest, Some(settings.range.0))
    } else {
        (PointKind::Highest, Some(settings.range.1))
    }
}
