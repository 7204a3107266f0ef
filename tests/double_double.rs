//! Sums of two doubles: against values of 48 digits, exactness, symmetry, identities, and the ends of the range.

use proptest::prelude::*;
use serde_json::Value;
use twinslip::number::{DoubleDouble, Real};

/// Unit roundoff of a sum of two doubles, about: 2^-106.
const UNIT: f64 = 1.3e-32;

/// Rows of numbers: arguments, and the value as a sum of three doubles.
fn table(name: &str) -> Vec<Vec<f64>> {
    let all: Value =
        serde_json::from_str(include_str!("data/double_double.json")).expect("JSON of the script");
    let rows = all[name].as_array().expect("a table").iter();
    rows.map(|row| {
        let row = row.as_array().expect("a row").iter();
        row.map(|x| x.as_f64().expect("a number")).collect()
    })
    .collect()
}

/// Distance from a value of three parts.
fn error(x: DoubleDouble, value: &[f64]) -> f64 {
    (((x.hi() - value[0]) + (x.lo() - value[1])) - value[2]).abs()
}

/// The worst relative error over rows of a table, beyond what subnormal numbers can't express.
fn worst(rows: Vec<Vec<f64>>, arguments: usize, f: impl Fn(&[f64]) -> DoubleDouble) -> f64 {
    assert!(rows.len() > 60);
    let mut worst = 0.0;
    for row in rows {
        let (at, value) = row.split_at(arguments);
        let off = (error(f(at), value) - 1e-323).max(0.0) / value[0].abs().max(1e-320);
        assert!(!off.is_nan(), "at {at:?}");
        worst = off.max(worst);
    }
    worst
}

fn pair(at: &[f64]) -> DoubleDouble {
    DoubleDouble::new(at[0], at[1])
}

#[test]
fn functions_have_thirty_digits_over_their_domains() {
    type Function = fn(DoubleDouble) -> DoubleDouble;
    let functions: [(&str, Function, f64); 13] = [
        ("exp", Real::exp, 3e-31),
        ("exp_m1", Real::exp_m1, 3e-31),
        ("ln", Real::ln, 3e-31),
        ("ln_1p", Real::ln_1p, 3e-31),
        ("sqrt", Real::sqrt, 3e-32),
        ("sinh", Real::sinh, 5e-31),
        ("cosh", Real::cosh, 5e-31),
        ("asinh", Real::asinh, 3e-31),
        ("sin", Real::sin, 3e-31),
        ("cos", Real::cos, 3e-31),
        ("atan", Real::atan, 3e-31),
        ("tanh", Real::tanh, 5e-31),
        ("log10", Real::log10, 5e-31),
    ];
    for (name, f, bound) in functions {
        let off = worst(table(name), 2, |at| f(pair(at)));
        assert!(off < bound, "{name}: {off:e}");
    }
}

/// The logarithm of the mantissa is rounded before it is multiplied by p, as any rounding of x is.
#[test]
fn powers_are_as_accurate_as_their_logarithms() {
    for (largest, bound) in [(10.0, 3e-31), (151.0, 3e-30)] {
        let rows = table("powf").into_iter();
        let rows = rows.filter(|row| row[0].abs() < largest).collect();
        let off = worst(rows, 3, |at| pair(&at[1..]).powf(at[0]));
        assert!(off < bound, "|p| < {largest}: {off:e}");
    }
}

#[test]
fn values_that_are_exact_are_given_exactly() {
    let x = DoubleDouble::constant(0.1);
    assert!(x.hi() == 0.1 && x.lo() == 0.0 && x.leading() == 0.1);
    let zero = DoubleDouble::ZERO;
    let one = DoubleDouble::ONE;
    assert!(zero.exp() == one && zero.cosh() == one && one.ln() == zero && zero.ln_1p() == zero);
    assert!(zero.cos() == one && one.log10() == zero);
    for f in [
        Real::exp_m1,
        Real::sinh,
        Real::asinh,
        Real::sqrt,
        Real::sin,
        Real::tanh,
        Real::atan,
    ] {
        assert_eq!(f(zero), zero);
    }
    // the low part of an argument counts, however close to the zero of the function
    let near_one = DoubleDouble::new(1.0, 1e-25);
    assert!((near_one.ln().to_f64() / 1e-25 - 1.0).abs() < 1e-15);
    assert_eq!(DoubleDouble::new(1e-25, 1.0), near_one, "normalised");
    assert!(near_one > one && -near_one < -one && near_one.abs() == (-near_one).abs());
    assert!(
        (DoubleDouble::from(2.0).sqrt() * DoubleDouble::from(2.0).sqrt() - 2.0)
            .to_f64()
            .abs()
            < 4.0 * UNIT
    );
}

#[test]
fn the_ends_of_the_range_are_infinite_zero_or_not_numbers() {
    let of = DoubleDouble::from;
    let (inf, nan) = (f64::INFINITY, f64::NAN);
    let is = |x: DoubleDouble, value: f64| {
        assert!(
            x.hi() == value || (x.hi().is_nan() && value.is_nan()),
            "{x:?}, not {value}"
        );
        assert!(x.lo() == 0.0, "{x:?}");
    };
    is(of(710.0).exp(), inf);
    is(of(1e300).exp(), inf);
    is(of(inf).exp(), inf);
    is(of(-746.0).exp(), 0.0);
    is(of(-inf).exp(), 0.0);
    is(of(-inf).exp_m1(), -1.0);
    is(of(-800.0).exp_m1(), -1.0);
    is(of(inf).exp_m1(), inf);
    is(of(0.0).ln(), -inf);
    is(of(inf).ln(), inf);
    is(of(-1.0).ln(), nan);
    is(of(-1.0).ln_1p(), -inf);
    is(of(inf).ln_1p(), inf);
    is(of(-1.0).sqrt(), nan);
    is(of(inf).sqrt(), inf);
    is(of(720.0).sinh(), inf);
    is(of(-720.0).sinh(), -inf);
    is(of(-inf).cosh(), inf);
    is(of(-inf).asinh(), -inf);
    is(of(-inf).tanh(), -1.0);
    is(of(1e300).tanh(), 1.0);
    is(of(inf).sin(), nan);
    is(of(-inf).cos(), nan);
    is(of(0.0).log10(), -inf);
    is(of(inf).log10(), inf);
    assert_eq!(of(-inf).atan(), -(of(1.0).atan() * 2.0));
    is(of(0.0).powf(1.5), 0.0);
    is(of(0.0).powf(-1.5), inf);
    is(of(-2.0).powf(1.5), nan);
    is(of(-2.0).powf(2.0), nan);
    is(of(1e200).powf(2.0), inf);
    is(of(1e200).powf(-2.0), 0.0);
    is(of(7.0).powf(0.0), 1.0);
    is(of(7.0).powf(inf), inf);
    is(of(f64::MAX) + of(f64::MAX), inf);
    is(of(f64::MAX) * 2.0, inf);
    is(of(f64::MAX) * of(-2.0), -inf);
    is(of(f64::MAX) / 0.5, inf);
    is(of(1.0) / of(0.0), inf);
    is(of(1.0) / of(inf), 0.0);
    is(of(0.0) / of(0.0), nan);
    is(of(inf) - of(inf), nan);
    is(of(inf) - 1.0, inf);
    is(of(inf) * 0.0, nan);
    is(of(0.0).recip(), inf);
    for f in [
        Real::exp,
        Real::exp_m1,
        Real::ln,
        Real::ln_1p,
        Real::sqrt,
        Real::sinh,
        Real::cosh,
        Real::asinh,
        Real::sin,
        Real::cos,
        Real::atan,
        Real::tanh,
        Real::log10,
        Real::abs,
    ] {
        let value: DoubleDouble = f(of(nan));
        is(value, nan);
    }
    is(of(nan).powf(2.0), nan);
    assert_eq!(of(nan).partial_cmp(&of(1.0)), None);
}

/// Where the splitting of the product would overflow, and where only an intermediate does.
#[test]
fn the_largest_numbers_keep_their_digits() {
    let largest = DoubleDouble::new(f64::MAX, -1e291);
    assert_eq!(largest * 1.0, largest);
    assert_eq!(largest * DoubleDouble::ONE, largest);
    assert_eq!(largest / 1.0, largest);
    assert_eq!(largest / largest, DoubleDouble::ONE);
    assert_eq!(
        (largest * 0.5).sqrt(),
        (largest * 0.125).sqrt() * 2.0,
        "a power of two is exact"
    );
    let third = largest / 3.0;
    assert!((third / largest * 3.0 - 1.0).to_f64().abs() < 4.0 * UNIT);
    let root = largest.sqrt();
    assert!(((root / largest) * root - 1.0).to_f64().abs() < 8.0 * UNIT);
    assert!((largest.ln().exp() / largest - 1.0).to_f64().abs() < 1e-28);
}

/// Doubles of any size between 1e-e and 1e+e, of both signs.
fn wide(e: f64) -> impl Strategy<Value = f64> {
    (-e..e, any::<bool>())
        .prop_map(|(e, negative)| 10f64.powf(e) * if negative { -1.0 } else { 1.0 })
}

/// Sums of two doubles with all digits in use.
fn wide_pair(e: f64) -> impl Strategy<Value = DoubleDouble> {
    (wide(e), -0.5..0.5_f64).prop_map(|(hi, lo)| DoubleDouble::new(hi, hi * lo * f64::EPSILON))
}

fn relative(x: DoubleDouble, y: DoubleDouble) -> f64 {
    ((x - y).to_f64() / y.to_f64()).abs()
}

proptest! {
    #[test]
    fn sums_and_products_of_doubles_are_exact(a in any::<i64>(), b in any::<i64>()) {
        let (a, b) = (a >> 11, b >> 11);
        let (x, y) = (DoubleDouble::from(a as f64), b as f64);
        let exact = |v: DoubleDouble| v.hi() as i128 + v.lo() as i128;
        prop_assert_eq!(exact(x * y), a as i128 * b as i128);
        prop_assert_eq!(exact(x * DoubleDouble::from(y)), a as i128 * b as i128);
        prop_assert_eq!(exact(x + y), (a + b) as i128);
        prop_assert_eq!(exact(x - DoubleDouble::from(y)), (a - b) as i128);
    }

    #[test]
    fn results_are_normalised(a in wide_pair(100.0), b in wide_pair(100.0)) {
        for x in [a + b, a - b, a * b, a / b, a * b.hi(), a / b.hi(), a + b.hi(), a.abs().sqrt()] {
            prop_assert!(x.hi() == x.hi() + x.lo(), "{x:?}");
        }
    }

    #[test]
    fn operations_undo_each_other(a in wide_pair(140.0), b in wide_pair(140.0)) {
        let back = a + b - b;
        let larger = a.abs().to_f64().max((a + b).abs().to_f64());
        prop_assert!((back - a).to_f64().abs() <= 6.0 * UNIT * larger.max(b.to_f64().abs()));
        prop_assert!(relative(a * b / b, a) <= 8.0 * UNIT);
        prop_assert!(relative(a / b * b, a) <= 8.0 * UNIT);
        prop_assert!(relative(a / b.hi() * b.hi(), a) <= 6.0 * UNIT);
        let root = a.abs().sqrt();
        prop_assert!(relative(root * root, a.abs()) <= 8.0 * UNIT);
    }

    #[test]
    fn the_symmetries_are_exact(a in wide_pair(2.0), b in wide_pair(2.0)) {
        prop_assert_eq!(a + b, b + a);
        prop_assert_eq!(a * b, b * a);
        prop_assert_eq!(a - b, -(b - a));
        prop_assert_eq!((-a) / b, -(a / b));
        prop_assert_eq!(a - a, DoubleDouble::ZERO);
        prop_assert_eq!((-a).sinh(), -a.sinh());
        prop_assert_eq!((-a).cosh(), a.cosh());
        prop_assert_eq!((-a).asinh(), -a.asinh());
        prop_assert_eq!((-a).tanh(), -a.tanh());
        prop_assert_eq!((-a).atan(), -a.atan());
        prop_assert_eq!((-a).sin(), -a.sin());
        prop_assert_eq!((-a).cos(), a.cos());
        prop_assert_eq!(a.partial_cmp(&b), (a - b).to_f64().partial_cmp(&0.0));
    }

    #[test]
    fn functions_invert_each_other(x in wide_pair(300.0), y in wide_pair(2.5)) {
        // rounding ln x by its last unit moves e^(ln x) by |ln x| of them
        let amplified = 8.0 * UNIT * (1.0 + x.to_f64().abs().ln().abs());
        prop_assert!(relative(x.abs().ln().exp(), x.abs()) <= amplified);
        prop_assert!(relative(x.abs().powf(0.5), x.abs().sqrt()) <= 20.0 * UNIT);
        prop_assert!(relative(x.abs().powf(2.0).sqrt(), x.abs()) <= 20.0 * UNIT || !(x * x).is_finite() || (x * x).to_f64() < 1e-280);
        prop_assert!(relative(y.exp().ln(), y) <= 20.0 * UNIT * (1.0 + 1.0 / y.to_f64().abs()));
        prop_assert!(relative(y.sinh().asinh(), y) <= 40.0 * UNIT);
        let ln_1p = y.abs().ln_1p();
        prop_assert!(relative(ln_1p.exp_m1(), y.abs()) <= 40.0 * UNIT * (1.0 + ln_1p.to_f64()));
        let (s, c) = (y.sinh(), y.cosh());
        prop_assert!(relative(c - s.abs(), (-y.abs()).exp()) <= 40.0 * UNIT * (1.0 + (2.0 * y.to_f64().abs()).exp()));
    }
}
