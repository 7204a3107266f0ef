//! The number types: differences keep relative accuracy, intervals contain the truth, jets differentiate exactly.

use proptest::prelude::*;
use twinslip::number::{
    Difference, Interval, Jet, Real, Uncertain, bracketed_root, enclosing_radius,
};

/// A formula that uses every operation, for positive x.
fn formula<T: Real>(x: T) -> T {
    let s = (x + 1.0).sqrt() * 0.5 + x.powf(1.4) / 3.0;
    let t = (x * 0.1).sinh() - (x * 0.2).cosh() + (x - 0.5).exp() * (-x).exp_m1();
    let u = x.sin() * x.cos() * 0.1 + (x * 0.5).tanh() - (x * 0.3).atan() + (x + 2.0).log10();
    (s.asinh() + x.ln_1p()) / (x.ln().abs() + 2.0) - t * 0.01 + u * 0.1
}

/// Its derivative by jets.
fn slope(x: f64) -> f64 {
    formula(Jet::<f64, 1>::variable(x, 0)).gradient[0]
}

#[test]
fn an_uncertainty_has_two_digits_and_ends_the_value() {
    for (value, uncertainty, text) in [
        (472.0092645867038, 3.5e-9, "472.0092645867 ± 3.6e-9"),
        (-0.002595547022, 4.9e-9, "-0.0025955470 ± 5.0e-9"),
        (7.414e-8, 8.1e-8, "7.4e-8 ± 8.2e-8"),
        (1234567.8, 20.0, "1.234568e6 ± 21"),
        (5.0, 0.0, "5"),
        (5.0, f64::INFINITY, "5"),
        (0.0, 1e-300, "0 ± 1.0e-300"),
        (1e-12, 3.0, "1e-12 ± 3.0"),
        (0.1, 1e-17, "0.1 ± 1.0e-17"),
        (123456.7, 2000.0, "123457 ± 2100"),
        (0.25, 0.0031, "0.2500 ± 0.0031"),
    ] {
        let shown = Uncertain::new(value, uncertainty).to_string();
        assert_eq!(shown, text);
    }
}

proptest! {
    /// What a reader sees still holds: rounding never takes the truth out of the interval.
    #[test]
    fn shown_intervals_contain_the_exact_ones(digits in -9.9..9.9_f64, power in -12..9_i32, ln_u in -30.0..3.0_f64) {
        let (value, uncertainty) = (digits * 10f64.powi(power), ln_u.exp() * 10f64.powi(power));
        let text = Uncertain::new(value, uncertainty).to_string();
        let (shown, budget) = text.split_once(" ± ").expect("both");
        let (shown, budget): (f64, f64) = (shown.parse().expect("a number"), budget.parse().expect("a number"));
        let needed = uncertainty + (shown - value).abs();
        prop_assert!(budget >= needed * (1.0 - 1e-14), "{} {} as {}", value, uncertainty, text);
        prop_assert!(budget <= 1.2 * uncertainty + 4.0 * f64::EPSILON * value.abs(), "{} {} as {}", value, uncertainty, text);
    }

    #[test]
    fn jets_match_differences(x in 0.1..5.0_f64) {
        prop_assume!((x - 1.0_f64).abs() > 1e-2); // |ln x| has a corner at 1
        let h = 1e-4;
        let five_point = (8.0 * (formula(x + h) - formula(x - h)) - (formula(x + 2.0 * h) - formula(x - 2.0 * h))) / (12.0 * h);
        prop_assert!((slope(x) - five_point).abs() < 1e-9);
    }

    #[test]
    fn differences_keep_their_accuracy_however_close(x in 0.1..5.0_f64, ln_gap in -300.0..-9.0_f64) {
        prop_assume!((x - 1.0_f64).abs() > 1e-2);
        let gap = x * ln_gap.exp();
        let d = formula(Difference::new(x + gap, x, gap)).gap;
        // against the slope in the middle, which differs from the mean slope in second order
        prop_assert!((d / gap - slope(x + 0.5 * gap)).abs() <= (gap / x).powi(2) + 1e-13, "{} {}", d / gap, slope(x));
    }

    #[test]
    fn differences_agree_with_subtraction_far_apart(x in 0.1..5.0_f64, y in 0.1..5.0_f64) {
        let d = formula(Difference::new(x, y, x - y));
        prop_assert!((d.gap - (formula(x) - formula(y))).abs() < 1e-13);
        prop_assert!(d.first == formula(x) && d.second == formula(y));
    }

    #[test]
    fn ordered_differences_keep_it_at_any_distance(y in 0.01..5.0_f64, ln_gap in -300.0..8.0_f64) {
        let gap = y * ln_gap.exp();
        let x = Difference::ordered(y + gap, y, gap);
        // A rate that falls times a state that rises: x^-0.4.
        let made = (x.powf(-1.4).abs() * x).gap;
        let exact = y.powf(-0.4) * (-0.4 * (gap / y).ln_1p()).exp_m1();
        prop_assert!((made / exact - 1.0).abs() < 1e-13, "{made} {exact}");
        let made = (x * 3.0 + 0.5).ln().gap;
        let exact = (3.0 * gap / (3.0 * y + 0.5)).ln_1p();
        prop_assert!((made / exact - 1.0).abs() < 1e-14, "{made} {exact}");
    }

    #[test]
    fn intervals_contain_the_values_of_their_points(x in 0.1..5.0, radius in 0.0..0.05, inside in -1.0..1.0) {
        let bounds = formula(Interval::around(x, radius));
        let value = formula(x + radius * inside);
        prop_assert!(bounds.lo() <= value && value <= bounds.hi());
        let point = formula(Interval::constant(x));
        prop_assert!(point.hi() - point.lo() < 1e-13, "{point:?}");
    }

    #[test]
    fn waves_are_enclosed_over_intervals_of_any_width(lo in -20.0..20.0_f64, width in 0.0..8.0_f64) {
        let x = Interval::new(lo, lo + width);
        for (bounds, f) in [
            (x.sin(), f64::sin as fn(f64) -> f64),
            (x.cos(), f64::cos),
            (x.tanh(), f64::tanh),
            (x.atan(), f64::atan),
        ] {
            let values = (0..=1000).map(|i| f((lo + width * f64::from(i) / 1000.0).min(lo + width)));
            let (least, largest) = values.fold((f64::INFINITY, f64::NEG_INFINITY), |(a, b), v| (a.min(v), b.max(v)));
            prop_assert!(bounds.lo() <= least && largest <= bounds.hi());
            prop_assert!(bounds.lo() >= least - 1e-4 && bounds.hi() <= largest + 1e-4, "{bounds:?}");
        }
    }

    /// Slope and differences are far below the rounding of values that are nearly 1.
    #[test]
    fn saturated_hyperbolic_tangents_keep_their_digits(x in 0.0..150.0_f64, ln_gap in -300.0..0.0_f64) {
        let e = |x: f64| (-2.0 * x).exp();
        let slope = Jet::<f64, 1>::variable(-x, 0).tanh().gradient[0];
        prop_assert!((slope / (4.0 * e(x) / (1.0 + e(x)).powi(2)) - 1.0).abs() < 1e-14);
        let gap = ln_gap.exp();
        let made = Difference::new(x + gap, x, gap).tanh().gap;
        let exact = -2.0 * e(x) * (-2.0 * gap).exp_m1() / (1.0 + e(x)) / (1.0 + e(x + gap));
        prop_assert!((made / exact - 1.0).abs() < 1e-12, "{made:e} {exact:e}");
    }

    #[test]
    fn interval_arithmetic_contains_the_exact_result(a in -1e3..1e3_f64, b in -1e3..1e3_f64) {
        // exact sums and products of doubles, from integers that i128 holds
        let scaled = |x: f64| (x * 2f64.powi(40)).trunc();
        let (m, n) = (scaled(a), scaled(b));
        let exact = (m as i128) * (n as i128);
        let product = Interval::constant(m) * Interval::constant(n);
        prop_assert!((product.lo() as i128) <= exact && exact <= (product.hi() as i128));
        let sum = Interval::constant(m) + Interval::constant(n);
        prop_assert!((sum.lo() as i128) <= m as i128 + n as i128 && m as i128 + n as i128 <= (sum.hi() as i128));
    }

    #[test]
    fn roots_are_found_to_the_last_digits(root in 0.2..4.0_f64, curl in 0.1..50.0_f64) {
        let g = |x: f64| ((curl * (x - root)).sinh(), curl * (curl * (x - root)).cosh());
        let x = bracketed_root("a test", 0.1, 5.0, g).expect("bracketed");
        prop_assert!((x - root).abs() <= f64::EPSILON * root);
    }
}

/// sinh and cosh by exponentials against the library's, over the whole range and across the seams.
#[test]
fn hyperbolic_functions_are_those_of_the_library() {
    for i in -7200..=7200 {
        let x = f64::from(i) * 0.1 + 1e-3;
        let (sinh, cosh) = (Real::sinh(x), Real::cosh(x));
        if x.abs() < 700.0 {
            assert!((sinh / f64::sinh(x) - 1.0).abs() < 1e-15, "sinh({x})");
            assert!((cosh / f64::cosh(x) - 1.0).abs() < 1e-15, "cosh({x})");
        } else {
            assert!(sinh == f64::sinh(x) && cosh == f64::cosh(x));
        }
        assert!(
            Real::sinh(-x) == -sinh && Real::cosh(-x) == cosh,
            "odd and even at {x}"
        );
        let back = Real::asinh(sinh);
        assert!(
            x.abs() > 700.0 || (back - x).abs() <= 4e-16 * x.abs().max(1.0),
            "asinh(sinh({x})) = {back}"
        );
    }
}

#[test]
fn division_by_an_interval_around_zero_certifies_nothing() {
    let q = Interval::constant(1.0) / Interval::new(-1.0, 1.0);
    assert_eq!(q.sign(), None);
    assert_eq!(
        (Interval::constant(f64::NAN) * Interval::constant(1.0)).sign(),
        None
    );
    assert_eq!(
        Interval::constant(1e-200).powf(2.0).sign(),
        None,
        "underflow is not certainly positive"
    );
    assert_eq!(
        (Interval::constant(1e-200) * Interval::constant(1e-200)).sign(),
        None
    );
}

#[test]
fn a_bracket_without_sign_change_is_refused() {
    assert!(bracketed_root("x^2 + 1", -1.0, 1.0, |x| (x * x + 1.0, 2.0 * x)).is_err());
    assert!(bracketed_root("not a number", -1.0, 1.0, |_| (f64::NAN, 1.0)).is_err());
}

#[test]
fn enclosing_radius_is_infinite_where_nothing_changes_sign() {
    assert_eq!(enclosing_radius(1.0, |x| x * x), f64::INFINITY);
    let radius = enclosing_radius(2.0, |x| x * x - 4.0);
    assert!(radius < 1e-14, "{radius:e}");
}

/// An end of a bracket at 0 has no logarithm to be half-way to: where the first step of Newton's method leaves the bracket, and the
/// function falls from 0 or rises from it, the root is found and not the end.
#[test]
fn a_bracket_that_ends_at_zero_is_halved() {
    for sign in [1.0, -1.0] {
        for end in [2.0, -2.0] {
            let falling = |t: f64| {
                let t = t / end;
                let value = (-5.0 * t).exp() - (-0.5_f64).exp();
                (sign * value, -5.0 * sign * (-5.0 * t).exp() / end)
            };
            for (a, b) in [(0.0, end), (end, 0.0), (-0.0, end)] {
                let root = bracketed_root("a test", a, b, falling).expect("bracketed");
                assert!((root / end - 0.1).abs() < 1e-15, "{a} {b}: {root}");
            }
        }
    }
}
