//! A number with its error budget.

use std::fmt;

/// The truth lies within `uncertainty` of `value`.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Uncertain {
    /// Best value.
    pub value: f64,
    /// Bound on the error; infinite where none could be established.
    pub uncertainty: f64,
}

impl Uncertain {
    /// A value and the bound on its error; a bound that came out as no number is none.
    pub fn new(value: f64, uncertainty: f64) -> Self {
        let known = uncertainty >= 0.0 && !value.is_nan();
        Uncertain {
            value,
            uncertainty: if known { uncertainty } else { f64::INFINITY },
        }
    }
}

/// For a reader: two digits of the uncertainty, and the value down to the second of them, as `472.0092645867 ± 3.5e-9`. The
/// uncertainty is rounded up, so that the truth lies within it of the value as it is written. Where there is no uncertainty the
/// value stands alone.
impl fmt::Display for Uncertain {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let Uncertain { value, uncertainty } = *self;
        if !(uncertainty > 0.0 && uncertainty.is_finite() && value.is_finite()) {
            return f.write_str(&shortest(value));
        }
        let text = rounded(value, exponent(uncertainty, 1) - 1);
        let shown: f64 = text.parse().unwrap_or(value);
        write!(
            f,
            "{text} ± {}",
            two_digits(uncertainty + (shown - value).abs())
        )
    }
}

/// Plain notation is easy to read within this range.
const PLAIN: std::ops::Range<f64> = 1e-3..1e6;
/// Decimal digits that tell all doubles apart.
const DIGITS: i32 = 17;

fn shortest(x: f64) -> String {
    if x == 0.0 || PLAIN.contains(&x.abs()) {
        format!("{x}")
    } else {
        format!("{x:e}")
    }
}

/// The power of ten of a number's first digit, once it is rounded to so many digits after it.
fn exponent(x: f64, digits: usize) -> i32 {
    let text = format!("{x:.digits$e}");
    let power = text
        .split_once('e')
        .and_then(|(_, power)| power.parse().ok());
    power.unwrap_or(0)
}

/// The value to a digit that counts 10^place, or all its digits where they end before.
fn rounded(x: f64, place: i32) -> String {
    let digits = exponent(x, 1) - place;
    if x == 0.0 || digits + 1 >= DIGITS {
        return shortest(x);
    }
    if PLAIN.contains(&x.abs()) {
        format!("{x:.0$}", (-place).max(0) as usize)
    } else {
        format!("{x:.0$e}", digits.max(0) as usize)
    }
}

/// Two digits, not below the number.
fn two_digits(x: f64) -> String {
    let second = 10f64.powi(exponent(x, 1) - 1);
    let nearest = format!("{x:.1e}").parse().unwrap_or(x);
    let shown = if nearest < x {
        nearest + second
    } else {
        nearest
    };
    if PLAIN.contains(&shown) {
        format!("{shown:.0$}", (1 - exponent(shown, 1)).max(0) as usize)
    } else {
        format!("{shown:.1e}")
    }
}
