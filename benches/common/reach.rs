//! The time that a method needs for an error, from points (error, time) at several tolerances.

/// A time to reach an error.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Reached {
    pub seconds: f64,
    /// Whether even the loosest tolerance erred less: the time for the error itself is less, nobody knows by how much.
    pub at_most: bool,
}

/// Log-log interpolation of the time at `error`; `None` if no point reaches it.
///
/// Points that another one beats in both error and time are left out first: a method is not charged for a tolerance that
/// nobody would choose.
pub fn time_to_reach(points: &[(f64, f64)], error: f64) -> Option<Reached> {
    let reached = |seconds, at_most| Some(Reached { seconds, at_most });
    let front = front(points);
    // From the largest error to the smallest, times rise.
    let &(loosest, time) = front.first()?;
    if loosest <= error {
        return reached(time, loosest < error);
    }
    let pair = front
        .windows(2)
        .find(|pair| pair[0].0 > error && error >= pair[1].0)?;
    let (e0, t0) = (pair[0].0.ln(), pair[0].1.ln());
    let (e1, t1) = (pair[1].0.ln(), pair[1].1.ln());
    let seconds = (t0 + (t1 - t0) * (error.ln() - e0) / (e1 - e0)).exp();
    reached(seconds, false)
}

/// Points that no other point beats, from the largest error to the smallest.
fn front(points: &[(f64, f64)]) -> Vec<(f64, f64)> {
    /// An error of zero has no logarithm: half a spacing stands for it.
    const LEAST: f64 = 0.5 * f64::EPSILON;
    let mut sorted: Vec<(f64, f64)> = points
        .iter()
        .filter(|(error, time)| error.is_finite() && *time > 0.0)
        .map(|&(error, time)| (error.max(LEAST), time))
        .collect();
    sorted.sort_by(|a, b| a.1.total_cmp(&b.1));
    let mut front: Vec<(f64, f64)> = Vec::new();
    for point in sorted {
        if front.last().is_none_or(|last| point.0 < last.0) {
            front.push(point);
        }
    }
    front
}

/// The median; of an even number of values the lower one in the middle.
pub fn median(mut values: Vec<f64>) -> Option<f64> {
    values.sort_by(f64::total_cmp);
    values.get(values.len().saturating_sub(1) / 2).copied()
}
