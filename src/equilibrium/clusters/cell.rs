//! What is certain of a range of middle rates x: the rates on the other branches under the stresses of the range, and how they change
//! with x. Neither depends on how many interfaces slide on which branch.
//!
//! Next to an extremum the rate p on its other side changes by dp/d ln x = p g'(x)/g'(p), 0/0 at the extremum itself. With e half of the
//! distance of ln x and ln p, m their middle and h, k the lower and the upper of them, g(h) = g(k) makes
//! g'(m) = -e^2 g'''/6, so that g'(k)/e = g''(m) + e (g'''/2 - g'''/6), g'(h)/e = -g''(m) + e (g'''/2 - g'''/6) and
//! (g'(h) + g'(k))/e^2 = g''' - g'''/3, each g''' being one of its values between h and k. What of the derivatives does not cancel is then a multiple of e, with bounds that
//! are sharp.

use super::curve::{FAST, MIDDLE, Rates, SLOW, SteadyCurve, log_slopes, meet};
use crate::number::{Interval, Real};

/// Middle rates from one to another.
#[derive(Debug, Clone, Copy)]
pub(super) struct Cell {
    pub low: Rates<Interval>,
    pub high: Rates<Interval>,
    /// Of one rate in between.
    pub middle: Rates<Interval>,
    /// Of all in between.
    rates: Rates<Interval>,
    /// d ln v/d ln x on each branch.
    log_ratio: Rates<Interval>,
    beside: Option<BesideExtremum>,
}

/// What is known next to an extremum.
#[derive(Debug, Clone, Copy)]
struct BesideExtremum {
    /// The branch on its other side, and the one that is left.
    partner: usize,
    other: usize,
    /// Half of the distance of ln x from the partner's.
    distance: Interval,
    /// (x + dp/d ln x) over the distance.
    sum: Interval,
    /// d v/d ln x of the other branch over the distance.
    change: Interval,
}

/// The largest distance at which a cell is looked at as one beside an extremum.
const BESIDE: f64 = 1.0;

impl Cell {
    pub fn new(curve: &SteadyCurve<'_>, low: Rates<Interval>, high: Rates<Interval>) -> Self {
        let (from, to) = (low[MIDDLE], high[MIDDLE]);
        let between = from.leading().sqrt() * to.leading().sqrt();
        let middle = curve.enclosed(Interval::constant(between));
        let rates = between_nodes(&low, &high);
        let [at_x, ..] = log_slopes(curve.law, rates[MIDDLE]);
        let one = Interval::constant(1.0);
        let mut cell = Cell {
            low,
            high,
            middle,
            rates,
            log_ratio: [one; 3],
            beside: None,
        };
        for i in [SLOW, FAST] {
            cell.log_ratio[i] = if curve.has()[i] {
                let [slope, ..] = log_slopes(curve.law, rates[i]);
                at_x / slope
            } else {
                Interval::constant(0.0)
            };
        }
        cell.beside = cell.beside(curve);
        cell
    }

    fn beside(&self, curve: &SteadyCurve<'_>) -> Option<BesideExtremum> {
        let distance = |i: usize| {
            let apart = |at: &Rates<Interval>| (at[MIDDLE] / at[i]).ln().abs() * 0.5;
            let (a, b) = (apart(&self.low), apart(&self.high));
            Interval::new(a.lo().min(b.lo()).max(0.0), a.hi().max(b.hi()))
        };
        let nearest = [SLOW, FAST].into_iter().filter(|&i| curve.has()[i]);
        let nearest = nearest.map(|i| (i, distance(i)));
        let close = nearest.filter(|(_, distance)| distance.hi() < BESIDE);
        let (partner, distance) = { close }.min_by(|a, b| a.1.hi().total_cmp(&b.1.hi()))?;
        let other = SLOW + FAST - partner;
        let [x, p, o] = [MIDDLE, partner, other].map(|i| self.rates[i]);
        let around = Interval::new(x.lo().min(p.lo()), x.hi().max(p.hi()));
        let [_, second, third] = log_slopes(curve.law, around);
        let curved = distance * (third * 0.5 - third / 6.0);
        // x lies above its partner on the slow branch, and below that on the fast one
        let up = if partner == SLOW { 1.0 } else { -1.0 };
        let (at_x, at_partner) = (second * up + curved, -(second * up) + curved);
        let one = Interval::constant(1.0);
        let stretched = Interval::new(1.0, (distance / 2.0).cosh().hi().powi(2).next_up());
        // x - p = 2 sqrt(x p) sinh(e), and sinh(e) < e cosh(e/2)^2
        let apart = (x * p).sqrt() * stretched * (2.0 * up);
        let sum = apart + p * (third - third / 3.0) / at_partner;
        let direct = (x + p * self.log_ratio[partner]) / distance;
        let change = if curve.has()[other] {
            let [slope, ..] = log_slopes(curve.law, o);
            meet(o * at_x / slope, o * self.log_ratio[other] / distance)
        } else {
            one * 0.0
        };
        Some(BesideExtremum {
            partner,
            other,
            distance,
            sum: meet(sum, direct),
            change,
        })
    }

    /// d v/d ln x on each branch.
    pub fn changes(&self) -> Rates<Interval> {
        let mut all: Rates<Interval> = std::array::from_fn(|i| self.rates[i] * self.log_ratio[i]);
        if let Some(beside) = &self.beside {
            let of_partner = beside.sum * beside.distance - self.rates[MIDDLE];
            let (partner, other) = (beside.partner, beside.other);
            all[partner] = meet(all[partner], of_partner);
            all[other] = meet(all[other], beside.change * beside.distance);
        }
        all
    }

    /// d/d ln x of the sum of the rates of so many interfaces on each branch.
    pub fn slope(&self, counts: &Rates<usize>) -> Interval {
        let direct = weighted(counts, &self.changes());
        let Some(beside) = &self.beside else {
            return direct;
        };
        let unbalanced = counts[MIDDLE] as f64 - counts[beside.partner] as f64;
        let small = self.small(beside, counts) * beside.distance;
        meet(direct, self.rates[MIDDLE] * unbalanced + small)
    }

    fn small(&self, beside: &BesideExtremum, counts: &Rates<usize>) -> Interval {
        let term = |i: usize, x: Interval| match counts[i] {
            0 => Interval::constant(0.0),
            n => x * n as f64,
        };
        term(beside.partner, beside.sum) + term(beside.other, beside.change)
    }

    /// Its certain sign, but at the extremum itself, where it may vanish.
    pub fn slope_sign(&self, counts: &Rates<usize>) -> Option<f64> {
        let balanced = |beside: &&BesideExtremum| counts[MIDDLE] == counts[beside.partner];
        let small = { self.beside.as_ref() }
            .filter(balanced)
            .and_then(|beside| self.small(beside, counts).sign());
        small.or_else(|| self.slope(counts).sign())
    }

    /// The sum of the rates less V_H.
    pub fn excess(&self, counts: &Rates<usize>, driving: f64) -> Interval {
        let direct = weighted(counts, &self.rates) - driving;
        if direct.sign().is_some() {
            return direct;
        }
        let off = (self.rates[MIDDLE] / self.middle[MIDDLE]).ln();
        let from_middle = weighted(counts, &self.middle) - driving + self.slope(counts) * off;
        meet(direct, from_middle)
    }
}

/// All rates from those of one middle rate to those of a larger one: the stress falls on the way, and the other rates with it.
pub(super) fn between_nodes(low: &Rates<Interval>, high: &Rates<Interval>) -> Rates<Interval> {
    let falling = |i: usize| Interval::new(high[i].lo(), low[i].hi());
    let middle = Interval::new(low[MIDDLE].lo(), high[MIDDLE].hi());
    [falling(SLOW), middle, falling(FAST)]
}

/// The sum of what so many interfaces on each branch have.
pub(super) fn weighted<T: Real>(counts: &Rates<usize>, each: &Rates<T>) -> T {
    let present = (0..3).filter(|&i| counts[i] > 0);
    let terms = present.map(|i| each[i] * counts[i] as f64);
    terms.fold(T::constant(0.0), |sum, term| sum + term)
}
