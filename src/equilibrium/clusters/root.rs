//! The equilibrium of a share in its bracket, in 31 digits, and how far its rates may be off.
//!
//! As in `refine`, what is left in 31 digits is the rounding of V_H and of the law's parameters. What it does to the difference
//! quotients moves the other rates under the stress of x, and with V_H the sum of the rates; how far x moves in turn the slope of the
//! sum over a small cell around it tells for certain.

use super::super::refine::newton;
use super::cell::{Cell, weighted};
use super::curve::{FAST, MIDDLE, Rates, SLOW, SteadyCurve, quotient};
use crate::error::Result;
use crate::friction::effects;
use crate::number::{DoubleDouble, Interval, Jet, Real, bracketed_root};

/// How far the true rates may be.
#[derive(Debug, Clone, Copy)]
pub(super) struct Reach {
    /// The distances within which they lie: infinite where there are no bounds, as at a fold.
    pub radii: Rates<f64>,
    /// The part of these by which the rates move together, as the middle one does.
    pub together: Rates<f64>,
}

impl Reach {
    /// No more than distances.
    pub fn apart(radii: Rates<f64>) -> Self {
        Reach {
            radii,
            together: [0.0; 3],
        }
    }
}

/// The rates of a share, and how far the true ones may be.
pub(super) fn in_bracket(
    curve: &SteadyCurve<'_>,
    counts: &Rates<usize>,
    driving: f64,
    (low, high, left): (f64, f64, f64),
) -> Result<(Rates<DoubleDouble>, Reach)> {
    let along = |x: f64| {
        let rates = curve.rates(x);
        let excess = weighted(counts, &rates) - driving;
        (excess, weighted(counts, &changes(curve, &rates)) / x)
    };
    let x = bracketed_root("the steady state of a share", low, high, |x| {
        // of the ends the signs are known
        if x == low {
            (left, f64::NAN)
        } else if x == high {
            (-left, f64::NAN)
        } else {
            along(x)
        }
    })?;
    let near = DoubleDouble::from(x);
    let precise = newton(near, high, |x: Jet<DoubleDouble, 1>| {
        let rates = curve.precise(x.value, curve.rates(x.value.to_f64()));
        Jet {
            value: weighted(counts, &rates) - DoubleDouble::from(driving),
            gradient: [weighted(counts, &changes(curve, &rates)) / x.value],
        }
    });
    let x = if precise.is_finite() { precise } else { near };
    let rates = curve.precise(x, curve.rates(x.to_f64()));
    Ok((rates, reach(curve, counts, driving, &rates)))
}

/// d v/d ln x on each branch.
fn changes<T: Real>(curve: &SteadyCurve<'_>, rates: &Rates<T>) -> Rates<T> {
    std::array::from_fn(|i| change(curve, i, rates[MIDDLE], rates[i]))
}

/// d v/d ln x of the rate on one branch.
pub(super) fn change<T: Real>(curve: &SteadyCurve<'_>, branch: usize, middle: T, rate: T) -> T {
    match branch {
        MIDDLE => middle,
        _ if curve.has()[branch] && rate.leading() > 0.0 => rate * curve.log_ratio(middle, rate),
        _ => T::constant(0.0),
    }
}

pub(super) fn reach(
    curve: &SteadyCurve<'_>,
    counts: &Rates<usize>,
    driving: f64,
    rates: &Rates<DoubleDouble>,
) -> Reach {
    /// Times that a larger cell is tried.
    const TRIALS: usize = 8;
    let curve = &curve.cut_for(counts);
    let doubles = rates.map(DoubleDouble::to_f64);
    let x = doubles[MIDDLE];
    let moved = moved(curve, &doubles);
    let of_laws: f64 = moved
        .iter()
        .map(|shift| weighted(counts, shift).abs())
        .sum();
    let left = weighted(counts, rates) - DoubleDouble::from(driving);
    let unknown = left.to_f64().abs() + driving * f64::EPSILON + of_laws;
    let slope = weighted(counts, &changes(curve, rates)).to_f64().abs();
    let mut radius = (2.0 * unknown / slope * x).max(x * f64::EPSILON);
    for _ in 0..TRIALS {
        if radius.is_nan() || radius >= 0.5 * x {
            break;
        }
        let (low, high) = (x - radius, x + radius);
        // the rate falls or rises by this much at the least over the radius
        let least = |slope: Interval| slope.lo().max(-slope.hi()) * (radius / high);
        let mut changes = self::changes(curve, &curve.enclosed(Interval::new(low, high)));
        let mut falls = least(weighted(counts, &changes));
        // beside an extremum a cell knows more of the slope
        if falls.is_nan() || falls <= unknown {
            let [low, high] = [low, high].map(|x| curve.enclosed(Interval::constant(x)));
            let cell = Cell::new(curve, low, high);
            (changes, falls) = (cell.changes(), least(cell.slope(counts)));
        }
        if falls > unknown {
            let together: Rates<f64> = std::array::from_fn(|i| match i {
                MIDDLE => radius,
                _ => changes[i].leading() * (radius / x),
            });
            let radii = std::array::from_fn(|i| {
                let far = match i {
                    MIDDLE => radius,
                    _ => changes[i].distance_from(0.0) * (radius / low),
                };
                // the change is one within its bounds, on either side of that in the middle
                let spread = 2.0 * (far - together[i].abs());
                let own: f64 = moved.iter().map(|shift| shift[i].abs()).sum();
                together[i].abs() + spread + own + doubles[i] * f64::EPSILON + f64::MIN_POSITIVE
            });
            return Reach { radii, together };
        }
        radius *= 4.0;
    }
    Reach::apart([f64::INFINITY; 3])
}

/// How the rates on the other branches move under the stress of x where a parameter of the law is off by its rounding, for each.
fn moved(curve: &SteadyCurve<'_>, rates: &Rates<f64>) -> Vec<Rates<f64>> {
    let has = curve.has();
    let x = rates[MIDDLE];
    let within = |i: usize| has[i] && rates[i] > 0.0;
    let ordered = |v: f64| if v < x { (v, x) } else { (x, v) };
    let shifts = effects(curve.law, |law| {
        [SLOW, FAST].map(|i| {
            if within(i) {
                let (a, b) = ordered(rates[i]);
                quotient(law, a, b)
            } else {
                0.0
            }
        })
    });
    let slopes = [SLOW, FAST].map(|i| curve.quotient_at(rates[i], x).1);
    let moved = |shift: [f64; 2]| {
        let by = |k: usize, i: usize| if within(i) { shift[k] / slopes[k] } else { 0.0 };
        [by(0, SLOW), 0.0, by(1, FAST)]
    };
    shifts.into_iter().map(moved).collect()
}
