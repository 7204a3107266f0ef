//! A curve of Hopf points along a share: where it lands on what is asked for, and what is special on it.

use super::course::{Course, Step};
use super::hopf::ShareHopf;
use super::lyapunov::FirstLyapunov;
use super::stationary::Fold;
use crate::bifurcation::{Label, LocusRequest, Parameter, Special};
use crate::equilibrium::{Bracket, Share, SteadyPoint, constant};
use crate::error::Result;
use crate::friction::{AnyLaw, rounding};
use crate::number::{DoubleDouble, Jet, bracketed_root};

/// The longest step in ln K, and as a part of its range.
const LONGEST: f64 = 0.1;
const PART: f64 = 0.1;

/// A rate with the stiffnesses of Hopf points there, ascending.
#[derive(Debug, Clone)]
pub(super) struct Knot<'a> {
    pub point: SteadyPoint<'a>,
    pub roots: Vec<DoubleDouble>,
}

impl<'a> Knot<'a> {
    pub fn at(share: &Share, point: SteadyPoint<'a>) -> Self {
        let roots = point.oscillation(share).stiffnesses();
        Knot { point, roots }
    }
}

/// A point of a curve of Hopf points.
#[derive(Debug, Clone)]
pub(super) struct CurvePoint<'a> {
    pub hopf: ShareHopf<'a>,
    pub label: Option<Label>,
}

impl CurvePoint<'_> {
    /// d ln K/d ln x along the curve.
    fn log_slope(&self) -> f64 {
        let slope = self.hopf.slope() * self.hopf.point.x;
        (slope / self.hopf.stiffness).to_f64()
    }
}

/// One root along a stretch of a share on which there are as many throughout.
#[derive(Clone, Copy)]
pub(super) struct Root<'c, 'a> {
    pub course: &'c Course<'a>,
    pub share: Share,
    pub place: usize,
    pub count: usize,
}

impl<'a> Root<'_, 'a> {
    /// The Hopf point at a rate, where it has as many.
    fn found(
        &self,
        knot: &Knot<'a>,
        along: Parameter,
        label: Option<Label>,
    ) -> Option<CurvePoint<'a>> {
        let (curve, point) = (self.course.curve, &knot.point);
        (knot.roots.len() == self.count).then(|| CurvePoint {
            hopf: ShareHopf::new(
                curve,
                self.share,
                point.clone(),
                knot.roots[self.place],
                along,
            ),
            label,
        })
    }

    fn at(&self, point: SteadyPoint<'a>, along: Parameter, label: Label) -> Option<CurvePoint<'a>> {
        self.found(&Knot::at(&self.share, point), along, Some(label))
    }

    fn stiffness(&self, point: &SteadyPoint<'_>) -> DoubleDouble {
        let all = point.oscillation(&self.share).stiffnesses();
        let there = all.get(self.place).copied();
        there.unwrap_or(DoubleDouble::from(f64::NAN))
    }

    /// dK/dx at a rate.
    fn slope(&self, point: &SteadyPoint<'_>) -> DoubleDouble {
        point.oscillation(&self.share).slope(self.stiffness(point))
    }

    /// The curve with the ends of the ranges, what is asked for, the largest K and folds, by the rate ascending.
    pub fn points(
        &self,
        request: &LocusRequest,
        knots: &[Knot<'a>],
        folds: &[Fold<'a>],
    ) -> Result<Vec<CurvePoint<'a>>> {
        /// Rounding in 31 digits of a slope that is zero: a law may have the same K throughout.
        const LEFT: f64 = 1e-22;
        let knots = self.refined(request, knots);
        let plain = knots.iter();
        let plain = plain.filter_map(|knot| self.found(knot, Parameter::Stiffness, None));
        let mut all: Vec<CurvePoint<'a>> = plain.collect();
        let slopes: Vec<f64> = all.iter().map(CurvePoint::log_slope).collect();
        let mut more = Vec::new();
        for (pair, slopes) in knots.windows(2).zip(slopes.windows(2)) {
            let [a, b] = [&pair[0], &pair[1]];
            self.landings(request, [a, b], &mut more)?;
            if slopes[0] > LEFT && slopes[1] < -LEFT {
                more.extend(self.top((a.point.rate(), b.point.rate(), 1.0))?);
            }
            let between =
                |fold: &&Fold<'a>| (a.point.rate()..b.point.rate()).contains(&fold.point.rate());
            let folds = folds.iter().filter(between);
            more.extend(
                folds.filter_map(|fold| self.at(fold.point.clone(), Parameter::Driving, Label::Zh)),
            );
        }
        all.extend(more);
        all.sort_by(|a, b| a.hopf.point.rate().total_cmp(&b.hopf.point.rate()));
        Ok(all)
    }

    /// Knots between which K changes by no more than a step.
    fn refined(&self, request: &LocusRequest, knots: &[Knot<'a>]) -> Vec<Knot<'a>> {
        /// Times that a step is halved.
        const DEEPEST: usize = 8;
        let stiffness = |knot: &Knot<'a>| knot.roots[self.place].to_f64();
        let (low, high) = request.stiffness;
        let longest = LONGEST.min(PART * (high / low).ln()) * request.step;
        let far = |a: &Knot<'a>, b: &Knot<'a>| {
            let [a, b] = [a, b].map(stiffness);
            a.min(b) <= high && a.max(b) >= low && (a / b).ln().abs() > longest
        };
        let most = Step::new(request.step, request.max_points).most_intervals();
        let mut refined = knots[..1].to_vec();
        for knot in &knots[1..] {
            let mut open = vec![(knot.clone(), 0)];
            while let Some((next, depth)) = open.pop() {
                let last = &refined[refined.len() - 1];
                if depth < DEEPEST && (refined.len() as f64) < most && far(last, &next) {
                    let x = (last.point.rate() * next.point.rate()).sqrt();
                    let middle = self.course.curve.point(DoubleDouble::from(x));
                    let middle = Knot::at(&self.share, middle);
                    if middle.roots.len() == self.count {
                        open.extend([(next, depth + 1), (middle, depth + 1)]);
                        continue;
                    }
                }
                refined.push(next);
            }
        }
        refined
    }

    /// Where V_H or K has a value that is asked for, or that of an end of its range, between two knots.
    fn landings(
        &self,
        request: &LocusRequest,
        [a, b]: [&Knot<'a>; 2],
        found: &mut Vec<CurvePoint<'a>>,
    ) -> Result<()> {
        let (curve, share) = (&self.course.curve, &self.share);
        let ends = (a.point.rate(), b.point.rate());
        for (value, label) in asked(&request.at_driving, request.driving) {
            let [left, right] = [a, b].map(|knot| knot.point.driving(share).value.to_f64() - value);
            if left * right < 0.0 {
                let bracket = (ends.0, ends.1, left.signum());
                let point = curve.zero("a wanted V_H", bracket, |point| {
                    point.driving(share) - constant(DoubleDouble::from(value))
                })?;
                found.extend(self.at(point, Parameter::Stiffness, label));
            }
        }
        for (value, label) in asked(&request.at_stiffness, request.stiffness) {
            let [left, right] = [a, b].map(|knot| knot.roots[self.place].to_f64() - value);
            if left * right < 0.0 {
                let bracket = (ends.0, ends.1, left.signum());
                let point = curve.zero("a wanted K", bracket, |point| Jet {
                    value: self.stiffness(point) - value,
                    gradient: [self.slope(point)],
                })?;
                let exact = self.at(point, Parameter::Driving, label);
                found.extend(exact.map(|mut one| {
                    one.hopf.stiffness = DoubleDouble::from(value);
                    one
                }));
            }
        }
        Ok(())
    }

    /// The largest K in a bracket. `None` where that is not certain.
    fn top(&self, bracket: Bracket) -> Result<Option<CurvePoint<'a>>> {
        let curve = self.course.curve;
        let point = curve.zero("the largest K", bracket, |point| Jet {
            value: self.slope(point),
            gradient: [DoubleDouble::from(f64::NAN)],
        })?;
        let x = point.x;
        let of_law = |law: &AnyLaw| Some(self.slope(&curve.of(law)?.point(x)).to_f64());
        let of_inputs = rounding(curve.law(), of_law);
        let off = self.off(point.rate(), of_inputs, &|point| self.slope(point).to_f64());
        let top = self.at(point, Parameter::Stiffness, Label::Top);
        Ok(top.zip(off).map(|(mut top, off)| {
            top.hopf.off = off;
            top
        }))
    }

    /// How far the zero x of a function may be off, which is known to so much. `None` where nothing is left of the zero.
    fn off(&self, x: f64, known: f64, f: &dyn Fn(&SteadyPoint<'a>) -> f64) -> Option<f64> {
        /// Relative change of the rate by which the change of the function is measured.
        const CHANGE: f64 = 1e-6;
        /// A zero that may be off by a larger part of the rate is none.
        const PLACED: f64 = 1e-3;
        let at = |part: f64| f(&self.course.curve.point(DoubleDouble::from(x * part)));
        let steepness = (at(1.0 + CHANGE) - at(1.0 - CHANGE)) / (2.0 * CHANGE * x);
        let off = known / steepness.abs() + x * f64::EPSILON;
        (off < PLACED * x).then_some(off)
    }

    /// A stretch of the curve with the zeros of l_1 on it.
    pub fn with_degenerate(&self, piece: &[CurvePoint<'a>]) -> Result<Vec<CurvePoint<'a>>> {
        let l_1: Vec<_> = piece.iter().map(|one| one.hopf.lyapunov()).collect();
        let mut all = Vec::with_capacity(piece.len());
        for (i, one) in piece.iter().enumerate() {
            all.push(one.clone());
            let Some(next) = piece.get(i + 1) else {
                continue;
            };
            let signs = [l_1[i].sign(), l_1[i + 1].sign()];
            if let [Some(left), Some(right)] = signs
                && left != right
            {
                let ends = (one.hopf.point.rate(), next.hopf.point.rate());
                all.extend(self.degenerate((ends.0, ends.1, left))?);
            }
        }
        Ok(all)
    }

    /// The zero of l_1 in a bracket. `None` for a pole.
    fn degenerate(&self, (low, high, left): Bracket) -> Result<Option<CurvePoint<'a>>> {
        let part = |point: &SteadyPoint<'a>| {
            let knot = Knot::at(&self.share, point.clone());
            let there = self.found(&knot, Parameter::Stiffness, None);
            there.map_or(f64::NAN, |one| one.hopf.lyapunov().part())
        };
        let at = |x: f64| self.course.curve.point(DoubleDouble::from(x));
        let x = bracketed_root("a degenerate Hopf point", low, high, |x| match x {
            _ if x == low => (left, f64::NAN),
            _ if x == high => (-left, f64::NAN),
            _ => (part(&at(x)), f64::NAN),
        })?;
        let off = self.off(x, FirstLyapunov::ROUNDING, &part);
        let found = self.at(at(x), Parameter::Stiffness, Label::Gh);
        Ok(found.zip(off).map(|(mut found, off)| {
            found.hopf.off = off;
            found
        }))
    }

    /// The Bogdanov-Takens points at the ends of the curve: where omega vanishes, which it does at a fold before the next knot.
    pub fn double_zeros(
        &self,
        points: &[CurvePoint<'a>],
        ends: [Option<f64>; 2],
        folds: &[Fold<'a>],
    ) -> [Option<Special>; 2] {
        /// K at the fold and at the last point of the curve, relative: that the curve ends there.
        const CLOSE: f64 = 1e-2;
        let at = |point: Option<&CurvePoint<'a>>, end: Option<f64>| {
            let hopf = &point?.hopf;
            let (x, end) = (hopf.point.rate(), end?);
            let between = |fold: &&Fold<'a>| (x.min(end)..=x.max(end)).contains(&fold.point.rate());
            let fold = folds.iter().find(between)?;
            let stiffness = fold.bogdanov_takens()?;
            let apart = (stiffness.value / hopf.stiffness.to_f64() - 1.0).abs();
            (apart < CLOSE).then(|| Special {
                note: Some("a curve of Hopf points ends here".into()),
                ..Special::new(Label::Bt, fold.driving, stiffness)
            })
        };
        [at(points.first(), ends[0]), at(points.last(), ends[1])]
    }
}

/// The values of a parameter to land on, and the ends of its range.
fn asked(values: &[f64], (from, to): (f64, f64)) -> Vec<(f64, Label)> {
    let ends = [from, to].into_iter().filter(|x| !values.contains(x));
    let asked = values.iter().filter(|x| (from..=to).contains(*x));
    let asked = asked.map(|&x| (x, Label::Uz));
    asked.chain(ends.map(|x| (x, Label::Ep))).collect()
}
