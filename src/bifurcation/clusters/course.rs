//! What lies along the equilibria of a share: points for rows, folds, Hopf points, wanted values of V_H.

use super::special::{ShareHopf, fold, meeting};
use crate::bifurcation::{BranchRequest, Label, Special};
use crate::equilibrium::{
    Bracket, EquilibriumCurve, FAST, MIDDLE, SLOW, Share, SteadyCurve, SteadyPoint, constant,
};
use crate::error::Result;
use crate::friction::AnyLaw;
use crate::number::{DoubleDouble, Interval, Real, Uncertain, log_ratio};

/// The longest step in the logarithm of the rate.
const LONGEST: f64 = 0.1;
/// The first one from an extremum, and how much larger each is than the one before.
const SHORTEST: f64 = 1e-3;
const GRADING: f64 = 1.3;
/// One point of so many has a row.
const THINNING: usize = 3;

/// A place along a share.
#[derive(Debug, Clone)]
pub(super) struct Station {
    pub share: Share,
    pub point: SteadyPoint,
    /// V_H, as it is told.
    pub driving: f64,
    /// Whether it has a row.
    pub shown: bool,
    pub label: Option<Label>,
    pub special: Option<Special>,
}

impl Station {
    fn plain(share: &Share, point: &SteadyPoint) -> Self {
        Station {
            share: *share,
            driving: point.driving(share).value.to_f64(),
            point: point.clone(),
            shown: true,
            label: None,
            special: None,
        }
    }

    /// A special point, at its V_H.
    pub fn special(share: &Share, point: &SteadyPoint, special: Special) -> Self {
        Station {
            driving: special.driving.value,
            label: Some(special.label),
            special: Some(special),
            ..Station::plain(share, point)
        }
    }
}

/// A curve of equilibria, whatever the share, at rates between which nothing is missed.
pub(super) struct Course<'a> {
    pub curve: EquilibriumCurve<'a>,
    pub points: Vec<SteadyPoint>,
}

impl<'a> Course<'a> {
    /// All alike, over a range of V_H and a little more.
    pub fn alike(law: &'a AnyLaw, interfaces: usize, (from, to): (f64, f64), step: f64) -> Self {
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
    pub fn shares(steady: SteadyCurve<'a>, most: f64, step: f64) -> Option<Self> {
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
        let driving = |point: &SteadyPoint| point.driving(share).value.to_f64();
        let inside = |point: &&SteadyPoint| (from..=to).contains(&driving(point));
        self.points.iter().filter(inside).count() / THINNING
    }

    /// What lies along a share within a range of V_H, by the rate ascending; beside it nothing but where it is.
    ///
    /// # Errors
    /// [`crate::Error::NotConverged`] if a search fails.
    pub fn stations(&self, share: &Share, request: &BranchRequest) -> Result<Vec<Station>> {
        let mut all: Vec<Station> = (0..self.points.len())
            .map(|i| Station {
                shown: i % THINNING == 0,
                ..Station::plain(share, &self.points[i])
            })
            .collect();
        self.ends(share, request, &mut all);
        all.extend(self.folds(share, request)?);
        all.sort_by(|a, b| a.point.rate().total_cmp(&b.point.rate()));
        let wanted = self.wanted(&all, request)?;
        let hopf = self.hopf(share, request)?;
        all.extend(wanted.into_iter().chain(hopf));
        all.sort_by(|a, b| a.point.rate().total_cmp(&b.point.rate()));
        Ok(all)
    }

    /// The points at which the middle branch meets another one.
    fn ends(&self, share: &Share, request: &BranchRequest, all: &mut [Station]) {
        let last = all.len() - 1;
        for (i, branch) in [(0, SLOW), (last, FAST)] {
            if let Some((point, driving)) = meeting(&self.curve, share, branch) {
                let together = share[branch] + share[MIDDLE];
                all[i] = match together {
                    0 | 1 => Station {
                        driving: driving.value,
                        ..Station::plain(share, &point)
                    },
                    _ => Station::special(share, &point, parting(driving, request, together)),
                };
            }
        }
    }

    /// Neighbours between which a number changes its sign.
    fn changes(&self, number: impl Fn(&SteadyPoint) -> f64) -> Vec<Bracket> {
        let values: Vec<f64> = self.points.iter().map(&number).collect();
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
            if dips && let Some(x) = self.beyond_zero(i, b.signum(), &number) {
                let sign = b.signum();
                found.push((self.points[i].rate(), x, sign));
                found.push((x, self.points[i + 2].rate(), -sign));
            }
        }
        found
    }

    /// A rate between two points with one between them at which a number has the other sign, by golden section.
    fn beyond_zero(
        &self,
        first: usize,
        sign: f64,
        number: &impl Fn(&SteadyPoint) -> f64,
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

    /// Points from one at which something holds towards one at which it does not, as close as it holds.
    pub fn up_to(
        &self,
        inside: &SteadyPoint,
        outside: &SteadyPoint,
        holds: impl Fn(&SteadyPoint) -> bool,
    ) -> Vec<SteadyPoint> {
        const HALVINGS: usize = 40;
        let (mut near, mut far) = (inside.rate(), outside.rate());
        let mut found = Vec::new();
        for _ in 0..HALVINGS {
            let middle = 0.5 * near + 0.5 * far;
            let point = self.curve.point(DoubleDouble::from(middle));
            if holds(&point) {
                near = middle;
                found.push(point);
            } else {
                far = middle;
            }
        }
        found
    }

    /// Where V_H of a share has an extremum.
    pub fn fold_brackets(&self, share: &Share) -> Vec<Bracket> {
        self.changes(|point| point.driving(share).gradient[0].to_f64())
    }

    fn folds(&self, share: &Share, request: &BranchRequest) -> Result<Vec<Station>> {
        let at = |bracket| {
            let (point, driving) = fold(&self.curve, share, bracket)?;
            let special = Special::new(Label::Lp, driving, exact_stiffness(request));
            Ok(Station::special(share, &point, special))
        };
        self.fold_brackets(share).into_iter().map(at).collect()
    }

    fn hopf(&self, share: &Share, request: &BranchRequest) -> Result<Vec<Station>> {
        let k = request.slab.loading.stiffness;
        let determinant = |point: &SteadyPoint| point.oscillation(share).relative_determinant(k);
        let mut found = Vec::new();
        for bracket in self.changes(determinant) {
            if let Some(hopf) = ShareHopf::at_stiffness(&self.curve, share, k, bracket)? {
                found.push(Station::special(share, &hopf.point, hopf.special()));
            }
        }
        Ok(found)
    }

    /// Where V_H has a value that is asked for, or that of an end of the range; between two of these stations it is monotonic.
    fn wanted(&self, all: &[Station], request: &BranchRequest) -> Result<Vec<Station>> {
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

/// The branch point at which so many interfaces that slide alike may part.
pub(super) fn parting(driving: Uncertain, request: &BranchRequest, together: usize) -> Special {
    let mut special = Special::new(Label::Bp, driving, exact_stiffness(request));
    special.note = Some(format!("{together} interfaces that slide alike may part"));
    special
}

fn exact_stiffness(request: &BranchRequest) -> Uncertain {
    Uncertain::new(request.slab.loading.stiffness, 0.0)
}

/// Rates between two, finer towards those that are extrema.
fn rates((low, high): (f64, f64), extrema: [bool; 2], step: f64) -> Vec<f64> {
    let width = log_ratio(low, high);
    let (longest, shortest) = (LONGEST * step, SHORTEST * step.min(1.0));
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
