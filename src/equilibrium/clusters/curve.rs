//! The steady curve tau_ss(v), cut at its extrema into branches: under one stress there is one slip rate on each.
//!
//! Stresses are compared by what they activate, g(v) = ln s(tau_ss(v)), as in `isolate`. The rate on another branch under the stress of the
//! middle rate x is the zero s of the difference quotient (g(x) - g(s))/(x - s), which keeps its digits up to the extremum where both
//! meet.

use super::super::refine::newton;
use crate::friction::{AnyLaw, Law, steady_log_activation, steady_log_slope, steady_slope};
use crate::number::{
    Difference, DoubleDouble, Interval, Jet, Real, bracketed_root, enclosing_radius,
};

/// The places of the slow branch (v < V_M, the stress rises with v), of the middle one (V_M < v < V_m, it falls) and of the fast one
/// (v > V_m, it rises again) in whatever there is for each.
pub(crate) const SLOW: usize = 0;
pub(crate) const MIDDLE: usize = 1;
pub(crate) const FAST: usize = 2;

/// A slip rate on each branch, all under one stress.
pub(crate) type Rates<T> = [T; 3];

/// What a search for a bracket multiplies a rate by.
const STRIDE: f64 = 8.0;

/// The steady curve of a law that weakens between V_M and V_m, or beyond V_M, or from rest to V_m.
#[derive(Debug, Clone, Copy)]
pub(crate) struct SteadyCurve<'a> {
    pub law: &'a AnyLaw,
    /// V_M lies in here, where there is one.
    pub peak: Option<Interval>,
    /// V_m lies in here, where there is one.
    pub trough: Option<Interval>,
    /// A rate of the fast branch beyond this one is any beyond it.
    fastest: f64,
}

impl<'a> SteadyCurve<'a> {
    /// That of a law, as far as rates up to this one are looked for. `None` where an extremum is not certainly one.
    pub fn new(law: &'a AnyLaw, fastest: f64) -> Option<Self> {
        let around = |v: f64| {
            let radius = enclosing_radius(v, |x| steady_log_slope(law, x));
            radius.is_finite().then(|| Interval::around(v, radius))
        };
        let extrema: Option<Vec<_>> = law.steady_extrema().into_iter().map(around).collect();
        Some(Self::cut(law, fastest, &extrema?))
    }

    /// The steady curve with the extrema as doubles.
    pub fn rough(law: &'a AnyLaw, fastest: f64) -> Self {
        let extrema = law.steady_extrema().into_iter().map(Interval::constant);
        Self::cut(law, fastest, &extrema.collect::<Vec<_>>())
    }

    fn cut(law: &'a AnyLaw, fastest: f64, extrema: &[Interval]) -> Self {
        let (peak, trough) = match *extrema {
            [trough] if law.weakens_from_rest() => (None, Some(trough)),
            [peak] => (Some(peak), None),
            [peak, trough] => (Some(peak), Some(trough)),
            _ => (None, None),
        };
        SteadyCurve {
            law,
            peak,
            trough,
            fastest,
        }
    }

    /// With those of its branches alone that so many interfaces slide on, and the middle one.
    pub fn cut_for(&self, counts: &Rates<usize>) -> Self {
        SteadyCurve {
            peak: self.peak.filter(|_| counts[SLOW] > 0),
            trough: self.trough.filter(|_| counts[FAST] > 0),
            ..*self
        }
    }

    /// The curve as one, not cut: where all slide alike it makes no difference on which branch.
    pub fn whole(law: &'a AnyLaw) -> Self {
        SteadyCurve {
            law,
            peak: None,
            trough: None,
            fastest: f64::INFINITY,
        }
    }

    /// Which branches there are.
    pub fn has(&self) -> [bool; 3] {
        let (slow, fast) = (self.peak.is_some(), self.trough.is_some());
        [slow, slow || fast, fast]
    }

    /// The extremum at which the middle branch meets the slow or the fast one.
    pub fn extremum(&self, branch: usize) -> Option<Interval> {
        match branch {
            SLOW => self.peak,
            FAST => self.trough,
            _ => None,
        }
    }

    /// A rate of the fast branch beyond this one is any beyond it.
    pub fn fastest(&self) -> f64 {
        self.fastest
    }

    /// The branch on which a rate certainly lies.
    pub fn branch(&self, v: f64) -> Option<usize> {
        let below = |e: Option<Interval>, none: bool| match e {
            Some(e) if v < e.lo() => Some(true),
            Some(e) if v > e.hi() => Some(false),
            Some(_) => None,
            None => Some(none),
        };
        match (below(self.peak, false)?, below(self.trough, true)?) {
            (true, _) => Some(SLOW),
            (false, true) => Some(MIDDLE),
            (false, false) => Some(FAST),
        }
    }

    /// The rates on all branches under the stress of this middle rate, which may be that of an extremum: there the rate on its other side
    /// is the same.
    pub fn enclosed(&self, middle: Interval) -> Rates<Interval> {
        let near = middle.leading();
        let mut rates = [Interval::constant(0.0); 3];
        rates[MIDDLE] = middle;
        if let Some(peak) = self.peak {
            rates[SLOW] = if middle == peak {
                peak
            } else {
                self.slow_within(middle, self.slow(near), peak)
            };
        }
        if let Some(trough) = self.trough {
            rates[FAST] = if middle == trough {
                trough
            } else {
                self.fast_within(middle, self.fast(near), trough)
            };
        }
        rates
    }

    fn slow_within(&self, middle: Interval, near: f64, peak: Interval) -> Interval {
        let sign = |s: f64| quotient(self.law, Interval::constant(s), middle).sign();
        let reached = |s: f64, wanted: f64| s > 0.0 && sign(s) == Some(wanted);
        let near = near.max(f64::MIN_POSITIVE);
        let low = outward(near, -1.0, 0.0, |s| reached(s, 1.0));
        let high = outward(near, 1.0, peak.hi(), |s| reached(s, -1.0));
        Interval::new(low.max(0.0), high.min(peak.hi()))
    }

    fn fast_within(&self, middle: Interval, near: f64, trough: Interval) -> Interval {
        let sign = |f: f64| quotient(self.law, middle, Interval::constant(f)).sign();
        let low = outward(near, -1.0, trough.lo(), |f| sign(f) == Some(-1.0));
        let high = if near >= self.fastest {
            f64::INFINITY
        } else {
            outward(near, 1.0, f64::INFINITY, |f| sign(f) == Some(1.0))
        };
        Interval::new(low.max(trough.lo()), high)
    }

    /// The same rates as doubles.
    pub fn rates(&self, middle: f64) -> Rates<f64> {
        let slow = self.peak.map_or(0.0, |_| self.slow(middle));
        let fast = self.trough.map_or(0.0, |_| self.fast(middle));
        [slow, middle, fast]
    }

    /// 0 where no double is so small.
    fn slow(&self, middle: f64) -> f64 {
        let peak = self.peak.map_or(middle, Interval::leading);
        let value = |s: f64| self.quotient_at(s, middle);
        let mut low = peak;
        while value(low).0 <= 0.0 {
            if low <= f64::MIN_POSITIVE {
                return 0.0;
            }
            low = (low / STRIDE).max(f64::MIN_POSITIVE);
        }
        let high = (low * STRIDE).min(peak);
        let found = bracketed_root("the slow rate under a stress", low, high, value);
        // So close to the peak that rounding has no sign there, the other rate lies as far on its other side.
        found.unwrap_or(peak - (middle - peak).abs())
    }

    /// What is beyond the fastest rate that is looked for is that one.
    fn fast(&self, middle: f64) -> f64 {
        let trough = self.trough.map_or(middle, Interval::leading);
        let value = |f: f64| self.quotient_at(f, middle);
        let mut high = trough;
        while value(high).0 <= 0.0 {
            if high >= self.fastest {
                return self.fastest;
            }
            high = (high * STRIDE).min(self.fastest.max(trough));
        }
        let low = (high / STRIDE).max(trough);
        let found = bracketed_root("the fast rate under a stress", low, high, value);
        found.unwrap_or(trough + (trough - middle).abs())
    }

    /// The difference quotient between v and the middle rate, with its derivative in v.
    pub fn quotient_at(&self, v: f64, middle: f64) -> (f64, f64) {
        let jet = self.quotient_along(Jet::<f64, 1>::variable(v, 0), middle);
        (jet.value, jet.gradient[0])
    }

    fn quotient_along<T: Real>(&self, v: Jet<T, 1>, middle: T) -> Jet<T, 1> {
        let middle = Jet {
            value: middle,
            gradient: [T::constant(0.0)],
        };
        if v.leading() < middle.leading() {
            quotient(self.law, v, middle)
        } else {
            quotient(self.law, middle, v)
        }
    }

    /// The rates in 31 digits from doubles.
    pub fn precise(&self, middle: DoubleDouble, near: Rates<f64>) -> Rates<DoubleDouble> {
        std::array::from_fn(|i| self.precise_on(i, middle, near[i]))
    }

    /// The rate on one branch in 31 digits from a double.
    pub fn precise_on(&self, branch: usize, middle: DoubleDouble, near: f64) -> DoubleDouble {
        match branch {
            MIDDLE => middle,
            _ if !self.has()[branch] || near == 0.0 => DoubleDouble::ZERO,
            _ => newton(DoubleDouble::from(near), f64::INFINITY, |v| {
                self.quotient_along(v, middle)
            }),
        }
    }

    /// d ln v/d ln x of the rate v on another branch under the stress of x.
    pub fn log_ratio<T: Real>(&self, middle: T, other: T) -> T {
        log_slope(self.law, middle) / log_slope(self.law, other)
    }
}

/// (g(b) - g(a))/(b - a).
pub(super) fn quotient<T: Real>(law: &AnyLaw, a: T, b: T) -> T {
    /// Rates that are so many times another are far from it: there the plain difference has all digits.
    const FAR: f64 = 4.0;
    let gap = b - a;
    if b.leading() > FAR * a.leading() {
        return (steady_log_activation(law, b) - steady_log_activation(law, a)) / gap;
    }
    steady_log_activation(law, Difference::new(b, a, gap)).gap / gap
}

/// dg/d ln v.
fn log_slope<T: Real>(law: &AnyLaw, v: T) -> T {
    if law.damping() == 0.0 {
        steady_log_slope(law, v)
    } else {
        steady_slope(law, v) * v
    }
}

/// dg, d^2 g and d^3 g over powers of d ln v.
pub(super) fn log_slopes(law: &AnyLaw, v: Interval) -> [Interval; 3] {
    let within = log_slopes_over(law, v);
    let middle = Interval::constant(v.leading());
    let off = (v / middle).ln();
    if !(v.lo() > 0.0 && off.hi().is_finite()) {
        return within;
    }
    let at = log_slopes_over(law, middle);
    let by = |i: usize| meet(within[i], at[i] + within[i + 1] * off);
    [by(0), by(1), within[2]]
}

fn log_slopes_over(law: &AnyLaw, v: Interval) -> [Interval; 3] {
    let along = Jet {
        value: v,
        gradient: [v],
    };
    let twice = Jet {
        value: along,
        gradient: [along],
    };
    let slope = log_slope(law, twice);
    let second = slope.gradient[0];
    [slope.value.value, second.value, second.gradient[0]]
}

/// What two enclosures of one number have in common.
pub(super) fn meet(a: Interval, b: Interval) -> Interval {
    Interval::new(a.lo().max(b.lo()), a.hi().min(b.hi()))
}

/// The first of ever larger distances from a rate, in this direction, at which something is certain; the end where it never is.
fn outward(near: f64, direction: f64, end: f64, certain: impl Fn(f64) -> bool) -> f64 {
    let mut radius = near * f64::EPSILON;
    // the first step that leaves it is the last
    while radius > 0.0 && radius < 1e3 * near {
        let v = near + direction * radius;
        if (v - end) * direction >= 0.0 {
            return end;
        }
        if certain(v) {
            return v;
        }
        radius *= 4.0;
    }
    end
}
