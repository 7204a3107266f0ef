//! What lies along the equilibria of a share: points for rows, folds, Hopf points, wanted values of V_H.

use super::hopf::ShareHopf;
use super::stationary::{Fold, meeting, parting};
use crate::bifurcation::{BranchRequest, Label, Special};
use crate::equilibrium::{
    Bracket, EquilibriumCurve, FAST, MIDDLE, SLOW, Share, SteadyCurve, SteadyPoint, constant,
};
use crate::error::{Error, Result};
use crate::friction::AnyLaw;
use crate::number::{DoubleDouble, Interval, Real, Uncertain, log_ratio};
use crate::orbit::InterfaceSystem;

/// The longest step in the logarithm of the rate.
const LONGEST: f64 = 0.1;
/// The first one from an extremum, and how much larger each is than the one before.
const SHORTEST: f64 = 1e-3;
const GRADING: f64 = 1.3;
/// One point of so many has a row: of two interfaces, which have few branches, and of more.
const THINNING: [usize; 2] = [2, 3];

/// The steady curve, for V_H up to a largest one; of a single interface without branches, as it slides alike with itself on all of them.
///
/// # Errors
/// [`Error::Input`] where an extremum is not certainly one.
pub(super) fn steady_curve(slab: &InterfaceSystem, most: f64) -> Result<SteadyCurve<'_>> {
    if slab.interfaces == 1 {
        return Ok(SteadyCurve::whole(&slab.law));
    }
    SteadyCurve::new(&slab.law, 4.0 * most).ok_or_else(|| {
        Error::Input("an extremum of the steady stress could not be certified, so the number of branches is unknown".into())
    })
}

fn thinning(interfaces: usize) -> usize {
    THINNING[usize::from(interfaces > 2)]
}

/// A place along a share.
#[derive(Debug, Clone)]
pub(super) struct Station<'a> {
    pub share: Share,
    pub point: SteadyPoint<'a>,
    /// V_H, as it is told.
    pub driving: f64,
    /// Whether it has a row.
    pub shown: bool,
    pub label: Option<Label>,
    pub special: Option<Special>,
}

impl<'a> Station<'a> {
    fn plain(share: &Share, point: &SteadyPoint<'a>, driving: f64) -> Self {
        Station {
            share: *share,
            driving,
            point: point.clone(),
            shown: true,
            label: None,
            special: None,
        }
    }

    /// A special point, at its V_H.
    pub fn special(share: &Share, point: &SteadyPoint<'a>, special: Special) -> Self {
        Station {
            label: Some(special.label),
            special: Some(special.clone()),
            ..Station::plain(share, point, special.driving.value)
        }
    }
}

/// A curve of equilibria, whatever the share, at rates between which nothing is missed.
pub(super) struct Course<'a> {
    pub curve: EquilibriumCurve<'a>,
    pub points: Vec<SteadyPoint<'a>>,
}

impl<'a> Course<'a> {
    /// All alike, over a range of V_H and a little more.
    pub fn alike(law: &'a AnyLaw, interfaces: usize, (from, to): (f64, f64), step: Step) -> Self {
        /// In the logarithm.
        const MORE: f64 = 1e-3;
        let n = interfaces as f64;
        let ends = (from / n * (-MORE).exp(), to / n * MORE.exp());
        let curve = EquilibriumCurve::Alike(law);
        let inside = rates(ends, [false; 2], step);
        let all = std::iter::once(ends.0).chain(inside).chain([ends.1]);
        let points = all.map(|x| curve.point(DoubleDouble::from(x))).collect();
        Course { curve, points }
    }

    /// The middle branch, as far as V_H up to a largest one needs it. `None` where there is none.
    pub fn shares(steady: SteadyCurve<'a>, most: f64, step: Step) -> Option<Self> {
        let curve = EquilibriumCurve::Shares(steady);
        let at = |branch: usize| steady.extremum(branch).map(Interval::leading);
        let (peak, trough) = (at(SLOW), at(FAST));
        let low = peak.or_else(|| {
            let mut x = trough?;
            while x > f64::MIN_POSITIVE && steady.rates(x)[FAST] < 2.0 * most {
                x = (x / 2.0).max(f64::MIN_POSITIVE);
            }
            Some(x)
        })?;
        let high = trough.unwrap_or((2.0 * most).max(2.0 * low).min(f64::MAX));
        let inside = rates((low, high), [peak.is_some(), trough.is_some()], step);
        let plain = |x: f64| curve.point(DoubleDouble::from(x));
        let first = curve.end(SLOW).unwrap_or_else(|| plain(low));
        let last = curve.end(FAST).unwrap_or_else(|| plain(high));
        let between = inside.into_iter().map(plain);
        let points = std::iter::once(first).chain(between).chain([last]);
        Some(Course {
            curve,
            points: points.collect(),
        })
    }

    /// About how many rows a share has within a range of V_H.
    pub fn rows(&self, share: &Share, (from, to): (f64, f64)) -> usize {
        let inside = |point: &&SteadyPoint<'a>| (from..=to).contains(&point.driving_near(share));
        self.points.iter().filter(inside).count() / thinning(share.iter().sum())
    }

    /// What lies along a share within a range of V_H, by the rate ascending; beside it nothing but where it is.
    ///
    /// # Errors
    /// [`crate::Error::NotConverged`] if a search fails.
    pub fn stations(&self, share: &Share, request: &BranchRequest) -> Result<Vec<Station<'a>>> {
        let (low, high) = ends_of(request);
        let thinning = thinning(share.iter().sum());
        let plain = |(i, point): (usize, &SteadyPoint<'a>)| {
            let near = point.driving_near(share);
            let shown = i % thinning == 0;
            // what has a row is as the rates in 31 digits have it
            let driving = match shown && (0.5 * low..=2.0 * high).contains(&near) {
                true => point.driving(share).value.to_f64(),
                false => near,
            };
            Station {
                shown,
                ..Station::plain(share, point, driving)
            }
        };
        let mut all: Vec<Station<'a>> = self.points.iter().enumerate().map(plain).collect();
        self.ends(share, request, &mut all);
        let folds = self.folds(share, (low, high))?.into_iter();
        all.extend(folds.map(|fold| {
            let special = Special::new(Label::Lp, fold.driving, exact_stiffness(request));
            Station::special(share, &fold.point, special)
        }));
        all.sort_by(|a, b| a.point.rate().total_cmp(&b.point.rate()));
        let wanted = self.wanted(&all, request)?;
        let hopf = self.hopf(share, request)?;
        all.extend(wanted.into_iter().chain(hopf));
        all.sort_by(|a, b| a.point.rate().total_cmp(&b.point.rate()));
        Ok(all)
    }

    /// The branch points at which the middle branch meets another one.
    fn ends(&self, share: &Share, request: &BranchRequest, all: &mut [Station<'a>]) {
        let EquilibriumCurve::Shares(steady) = self.curve else {
            return;
        };
        let (last, (low, high)) = (all.len() - 1, ends_of(request));
        for (i, branch) in [(0, SLOW), (last, FAST)] {
            let together = share[branch] + share[MIDDLE];
            all[i].shown = true;
            if together < 2 || !(low..=high).contains(&all[i].driving) {
                continue;
            }
            if let Some((point, driving)) = meeting(&self.curve, share, branch) {
                let at = [driving, exact_stiffness(request)];
                let of_all = (together, share.iter().sum());
                let special = parting(&steady, branch, at, of_all);
                all[i] = Station::special(share, &point, special);
            }
        }
    }

    /// Neighbours between which a number changes its sign.
    fn changes(&self, values: &[f64], number: impl Fn(&SteadyPoint<'a>) -> f64) -> Vec<Bracket> {
        let mut found = Vec::new();
        for (i, pair) in values.windows(2).enumerate() {
            let ends = [&self.points[i], &self.points[i + 1]].map(SteadyPoint::rate);
            if pair[0] * pair[1] < 0.0 {
                found.push((ends[0], ends[1], pair[0].signum()));
            }
        }
        // twice between neighbours: it touches zero nearly, and the least of it lies beyond
        for (i, three) in values.windows(3).enumerate() {
            let [a, b, c] = [three[0], three[1], three[2]];
            let dips = a * b > 0.0 && b * c > 0.0 && b.abs() < a.abs() && b.abs() < c.abs();
            if dips
                && self.nears_zero(i, [a, b, c].map(f64::abs))
                && let Some(x) = self.beyond_zero(i, b.signum(), &number)
            {
                let sign = b.signum();
                found.push((self.points[i].rate(), x, sign));
                found.push((x, self.points[i + 2].rate(), -sign));
            }
        }
        found
    }

    /// Whether the parabola through three points comes much nearer to zero than the middle one.
    fn nears_zero(&self, first: usize, [a, b, c]: [f64; 3]) -> bool {
        /// So much nearer.
        const NEARER: f64 = 0.5;
        let [x, y, z] = [0, 1, 2].map(|i| self.points[first + i].rate().ln());
        let (left, right) = ((b - a) / (y - x), (c - b) / (z - y));
        let curvature = (right - left) / (z - x);
        let slope = left + curvature * (y - x);
        b - slope * slope / (4.0 * curvature) < NEARER * b
    }

    /// A rate between two points with one between them at which a number has the other sign, by golden section.
    fn beyond_zero(
        &self,
        first: usize,
        sign: f64,
        number: &impl Fn(&SteadyPoint<'a>) -> f64,
    ) -> Option<f64> {
        const STEPS: usize = 40;
        const GOLDEN: f64 = 0.618_033_988_749_894_9;
        let at = |x: f64| sign * number(&self.curve.point(DoubleDouble::from(x.exp())));
        let end = |i: usize| self.points[i].rate().ln();
        let (mut a, mut b) = (end(first), end(first + 2));
        let (mut c, mut d) = (b - GOLDEN * (b - a), a + GOLDEN * (b - a));
        let (mut at_c, mut at_d) = (at(c), at(d));
        for _ in 0..STEPS {
            if at_c < 0.0 {
                return Some(c.exp());
            }
            if at_d < 0.0 {
                return Some(d.exp());
            }
            if at_c < at_d {
                (b, d, at_d) = (d, c, at_c);
                c = b - GOLDEN * (b - a);
                at_c = at(c);
            } else {
                (a, c, at_c) = (c, d, at_d);
                d = a + GOLDEN * (b - a);
                at_d = at(d);
            }
        }
        None
    }

    /// Bisects between a point with a solution and one without, and returns the last point that has one.
    pub fn up_to<T>(
        &self,
        inside: &SteadyPoint<'a>,
        outside: &SteadyPoint<'a>,
        there: impl Fn(SteadyPoint<'a>) -> Option<T>,
    ) -> Vec<T> {
        const HALVINGS: usize = 40;
        let (mut near, mut far) = (inside.rate(), outside.rate());
        let mut found = Vec::new();
        for _ in 0..HALVINGS {
            let middle = 0.5 * near + 0.5 * far;
            match there(self.curve.point(DoubleDouble::from(middle))) {
                Some(one) => {
                    near = middle;
                    found.push(one);
                }
                None => far = middle,
            }
        }
        found
    }

    /// The folds of a share within a range of V_H, by the rate ascending.
    ///
    /// # Errors
    /// [`crate::Error::NotConverged`] if a search fails.
    pub fn folds(&self, share: &Share, (low, high): (f64, f64)) -> Result<Vec<Fold<'a>>> {
        let sign = |point: &SteadyPoint<'a>| point.slope_sign(share);
        let values: Vec<f64> = self.points.iter().map(sign).collect();
        let driving = |x: f64| self.curve.point(DoubleDouble::from(x)).driving_near(share);
        // a largest V_H is no less than those beside it, a least one no more
        let inside = |&(from, to, left): &Bracket| {
            let [a, b] = [from, to].map(driving);
            match left > 0.0 {
                true => a.max(b) <= high,
                false => a.min(b) >= low,
            }
        };
        let brackets = self.changes(&values, sign).into_iter().filter(inside);
        let fold = |bracket| Fold::new(self.curve, share, bracket);
        let mut found: Vec<Fold<'a>> = brackets.map(fold).collect::<Result<_>>()?;
        found.retain(|fold| (low..=high).contains(&fold.driving.value));
        Ok(found)
    }

    fn hopf(&self, share: &Share, request: &BranchRequest) -> Result<Vec<Station<'a>>> {
        let (k, (low, high)) = (request.slab.loading.stiffness, ends_of(request));
        let drivings: Vec<f64> = self
            .points
            .iter()
            .map(|one| one.driving_near(share))
            .collect();
        let determinant = |point: &SteadyPoint<'a>| point.relative_determinant(share, k);
        // beside the range nothing is looked at
        let looked_at = |i: usize| {
            let from = i.saturating_sub(2);
            let near = drivings[from..(i + 3).min(drivings.len())].iter();
            let least = near.clone().copied().fold(f64::INFINITY, f64::min);
            least <= high && near.copied().fold(0.0, f64::max) >= low
        };
        let value = |(i, point)| match looked_at(i) {
            true => determinant(point),
            false => f64::NAN,
        };
        let values: Vec<f64> = self.points.iter().enumerate().map(value).collect();
        let mut found = Vec::new();
        for bracket in self.changes(&values, determinant) {
            if let Some(hopf) = ShareHopf::at_stiffness(&self.curve, share, k, bracket)? {
                let driving = hopf.place()[0];
                if (low..=high).contains(&driving) {
                    found.push(Station::special(share, &hopf.point, hopf.special()));
                }
            }
        }
        Ok(found)
    }

    /// Where V_H has a value that is asked for, or that of an end of the range; between two of these stations it is monotonic.
    fn wanted(&self, all: &[Station<'a>], request: &BranchRequest) -> Result<Vec<Station<'a>>> {
        let (from, to) = request.range;
        let asked = request.at.iter().map(|&v| (v, Label::Uz));
        let ends = [from, to].into_iter().filter(|v| !request.at.contains(v));
        let values: Vec<_> = asked.chain(ends.map(|v| (v, Label::Ep))).collect();
        let mut found = Vec::new();
        for pair in all.windows(2) {
            let (a, b) = (&pair[0], &pair[1]);
            for &(value, label) in &values {
                if (a.driving - value) * (b.driving - value) >= 0.0 {
                    continue;
                }
                let sign = (a.driving - value).signum();
                let bracket = (a.point.rate(), b.point.rate(), sign);
                let share = &a.share;
                let point = self.curve.zero("a wanted V_H", bracket, |point| {
                    point.driving(share) - constant(DoubleDouble::from(value))
                })?;
                let exact = Uncertain::new(value, 0.0);
                let special = Special::new(label, exact, exact_stiffness(request));
                found.push(Station::special(share, &point, special));
            }
        }
        Ok(found)
    }
}

/// The ends of the range of V_H, the smaller one first.
fn ends_of(request: &BranchRequest) -> (f64, f64) {
    let (from, to) = request.range;
    (from.min(to), from.max(to))
}

pub(super) fn exact_stiffness(request: &BranchRequest) -> Uncertain {
    Uncertain::new(request.slab.loading.stiffness, 0.0)
}

/// The factor on the lengths of steps, and how many points are allowed.
#[derive(Debug, Clone, Copy)]
pub(super) struct Step {
    factor: f64,
    most: usize,
}

impl Step {
    pub fn new(factor: f64, most: usize) -> Self {
        Step { factor, most }
    }

    /// More intervals than this have more points than are allowed, also where only some of them are within the range.
    pub fn most_intervals(self) -> f64 {
        4.0 * self.most as f64 + 1e3
    }
}

/// Rates between two, finer towards those that are extrema.
fn rates((low, high): (f64, f64), extrema: [bool; 2], step: Step) -> Vec<f64> {
    let width = log_ratio(low, high);
    let factor = step.factor;
    /// A narrow range has so many steps at least.
    const STEPS: f64 = 10.0;
    let longest = (LONGEST.min(width / STEPS) * factor).max(width / step.most_intervals());
    let shortest = SHORTEST * factor.min(1.0);
    // from the end at 0 up to the middle
    let half = |extremum: bool| {
        let mut at = Vec::new();
        let mut next = if extremum { shortest } else { longest }.min(0.1 * width);
        let mut place = next;
        while place < 0.5 * width {
            at.push(place);
            next = (GRADING * next).min(longest);
            place += next;
        }
        at
    };
    let lower = half(extrema[0]).into_iter().map(|at| low * at.exp());
    let upper = half(extrema[1]).into_iter().rev();
    let upper = upper.map(|at| high * (-at).exp());
    lower.chain(upper).collect()
}
