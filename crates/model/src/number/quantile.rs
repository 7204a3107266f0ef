//! Quantiles of numbers.

/// The value below which a part of ascending numbers lies, between two of them on a straight line.
///
/// # Panics
/// Where there are none.
#[must_use]
pub fn quantile(ascending: &[f64], part: f64) -> f64 {
    let last = ascending.len() - 1;
    let place = part * last as f64;
    let (below, rest) = (place.floor() as usize, place.fract());
    let above = (below + 1).min(last);
    ascending[below] + rest * (ascending[above] - ascending[below])
}
