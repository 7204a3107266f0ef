//! Positive doubles by their logarithms, from the smallest to the largest: b/a may be no double.

/// ln(b/a).
#[doc(hidden)]
#[must_use]
pub fn log_ratio(a: f64, b: f64) -> f64 {
    let ratio = b / a;
    if ratio.is_normal() {
        ratio.ln()
    } else {
        b.ln() - a.ln()
    }
}

/// What lies at this part of the way from a to b, in the logarithm.
#[doc(hidden)]
#[must_use]
pub fn between_in_log(a: f64, b: f64, part: f64) -> f64 {
    let width = log_ratio(a, b);
    if width.abs() < f64::MAX.ln() {
        a * (part * width).exp()
    } else {
        (a.ln() + part * width).exp()
    }
}
