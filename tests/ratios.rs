//! N(x)/x of functions that are 0 with x, as exprel and sin(x)/x, in every kind of number.
//!
//! `tests/data/ratios.json` is from mpmath.

use crate::common::{data, number as known};
use serde_json::Value;
use std::array::from_fn;
use twinslip::number::{Difference, DoubleDouble, Interval, Jet, Numerator, Ratio, Real};

const ALL: [(&str, Numerator); 5] = [
    ("ExpM1", Numerator::ExpM1),
    ("Sin", Numerator::Sin),
    ("Sinh", Numerator::Sinh),
    ("Tanh", Numerator::Tanh),
    ("Ln1p", Numerator::Ln1p),
];

/// The points of a function with the derivatives there, each as a sum of two doubles.
fn points(all: &Value, name: &str) -> Vec<(f64, [DoubleDouble; 4])> {
    let points = all[name]["points"].as_array().expect("points");
    let of = |point: &Value| {
        let derivative = |d: usize| {
            let [hi, lo] = [0, 1].map(|part| known(&point["derivatives"][d][part]));
            DoubleDouble::new(hi, lo)
        };
        (known(&point["x"]), from_fn(derivative))
    };
    points.iter().map(of).collect()
}

/// The d-th derivative.
fn derivative(numerator: Numerator, d: usize) -> Ratio {
    (0..d).fold(Ratio::from(numerator), |ratio, _| ratio.derived())
}

/// Derivatives of sin(x)/x have zeros of their own, near which they err by what x does.
fn size(numerator: Numerator, x: f64, exact: f64) -> f64 {
    let sums = matches!(numerator, Numerator::Sin) as u8;
    exact.abs().max(f64::from(sums) / (1.0 + x.abs()))
}

#[test]
fn values_and_derivatives_have_all_digits_near_zero_and_away() {
    let all = data("ratios.json");
    for (name, numerator) in ALL {
        for (x, exact) in points(&all, name) {
            for (d, exact) in exact.into_iter().enumerate() {
                let ratio = derivative(numerator, d);
                let size = size(numerator, x, exact.hi());
                let off = (x.ratio(ratio) - exact.hi()).abs();
                assert!(off <= 4e-14 * size, "{name}, {d}, {x}: {off:e} of {size:e}");
                let off = DoubleDouble::from(x).ratio(ratio) - exact;
                assert!(
                    off.hi().abs() <= 4e-29 * size,
                    "{name}, {d}, {x}: {off:?} of {size:e}"
                );
            }
        }
    }
}

#[test]
fn jets_have_the_derivatives_and_intervals_hold_them() {
    let all = data("ratios.json");
    for (name, numerator) in ALL {
        for (x, exact) in points(&all, name) {
            let [value, first, second] = [0, 1, 2].map(|d| exact[d].hi());
            let inner = Jet::<f64, 1>::variable(x, 0);
            let twice = Jet::<_, 1>::variable(inner, 0).ratio(numerator.into());
            let made = [
                twice.value.value,
                twice.value.gradient[0],
                twice.gradient[0].gradient[0],
            ];
            for (made, exact) in made.into_iter().zip([value, first, second]) {
                let size = size(numerator, x, exact);
                assert!(
                    (made - exact).abs() <= 4e-14 * size,
                    "{name}, {x}: {made} for {exact}"
                );
            }
            for half in [0.0, 1e-9, 0.1, 0.7, 3.0] {
                let within = Interval::around(x, half);
                if numerator == Numerator::Ln1p && within.lo() <= -1.0 {
                    continue;
                }
                let jet = Jet::<_, 1>::variable(within, 0).ratio(numerator.into());
                for (within, exact) in [(jet.value, exact[0]), (jet.gradient[0], exact[1])] {
                    let (low, high) = (exact - within.lo(), exact - within.hi());
                    assert!(
                        low.hi() >= 0.0 && high.hi() <= 0.0,
                        "{name}, {x} ± {half}: {exact:?} in {within:?}"
                    );
                    if half < 1e-8 && within == jet.value {
                        let width = within.hi() - within.lo();
                        let size = size(numerator, x, exact.hi()) * (1.0 + x.abs());
                        assert!(
                            width <= 1e-12 * size + 16.0 * half * (size + 1.0) + f64::MIN_POSITIVE,
                            "{name}, {x}: {width:e}"
                        );
                    }
                }
            }
        }
    }
}

/// Every point of a wide interval has its value in the bounds.
#[test]
fn wide_intervals_hold_all_their_values() {
    for (name, numerator) in ALL {
        for (lo, hi) in [
            (-0.9, 0.1),
            (-0.2, 0.3),
            (0.2, 9.0),
            (-0.5, 20.0),
            (3.0, 5.0),
        ] {
            let within = Interval::new(lo, hi);
            for d in 0..2 {
                let ratio = derivative(numerator, d);
                let bounds = within.ratio(ratio);
                for i in 0..=200 {
                    let x = lo + (hi - lo) * f64::from(i) / 200.0;
                    let value = x.ratio(ratio);
                    let rounding = 1e-13 * value.abs();
                    assert!(
                        bounds.lo() <= value + rounding && value - rounding <= bounds.hi(),
                        "{name}, {d}, {x}: {value} in {bounds:?}"
                    );
                }
            }
        }
    }
}

#[test]
fn differences_have_their_own_digits() {
    let all = data("ratios.json");
    for (name, numerator) in ALL {
        for one in all[name]["gaps"].as_array().expect("gaps") {
            let [x, gap, exact] = ["x", "gap", "difference"].map(|part| known(&one[part]));
            let made = Difference::<f64>::new(x + gap, x, gap).ratio(numerator.into());
            // That of an even function, across 0, is as small as the sum of both.
            let allowed = 1e-13 * exact.abs() + 1e-15 * gap * (x + gap).abs();
            let off = (made.gap - exact).abs();
            assert!(off <= allowed, "{name}, {x} + {gap}: {off:e} of {exact:e}");
        }
    }
}
